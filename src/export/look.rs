//! What people look like: skin, hair and clothes, dealt out like shuffled cards, so that people next to each other in
//! number differ in everything. `studio/src/draw/palette.ts` deals the same, so that a person is the same everywhere.

use std::collections::BTreeSet;

/// The parts of the mannequin that have a colour of their own, or are not there at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Region {
    /// Face, neck, hands.
    Skin,
    /// The hair on the skull, or a cap.
    Hair,
    /// Torso and upper arms.
    Shirt,
    /// Forearms.
    Sleeve,
    /// Thighs, unless under a skirt.
    Trousers,
    /// Shins.
    Shin,
    /// Shoes.
    Shoe,
    /// Their soles.
    Sole,
    /// Hair down to the neck.
    LongHair,
    /// A bun at the back of the head.
    Bun,
    /// A cap's visor.
    Visor,
    /// A skirt.
    Skirt,
    /// The hips under shirt and skirt.
    Seat,
}

impl Region {
    /// Number of regions.
    pub const COUNT: usize = 13;
    /// All regions, in the order of [`Look`].
    pub const ALL: [Self; Self::COUNT] = [
        Self::Skin,
        Self::Hair,
        Self::Shirt,
        Self::Sleeve,
        Self::Trousers,
        Self::Shin,
        Self::Shoe,
        Self::Sole,
        Self::LongHair,
        Self::Bun,
        Self::Visor,
        Self::Skirt,
        Self::Seat,
    ];
}

/// sRGB colour of every [`Region`]; `None` where the person has no such thing.
pub type Look = [Option<u32>; Region::COUNT];

const SKIN: [u32; 7] = [0xf2c9ac, 0xe5b08d, 0xd49a74, 0xb97a56, 0x8d5a3c, 0x6a422d, 0x4b2f22];
const HAIR: [u32; 8] = [0x2a211c, 0x3d2b20, 0x5b3d28, 0x7d5a3c, 0xa98657, 0x1b1a1c, 0x8b8783, 0x9b4a2c];
const SHIRT: [u32; 18] = [
    0xd0644a, 0xe2a13f, 0x4a8c86, 0x3d6d9e, 0x87608f, 0xa9b9c2, 0xefeae0, 0x6b8a57, 0xc98297, 0x33425a, 0x78a6c6,
    0xd6bd8c, 0xb5483f, 0x5aa18a, 0x2b2d33, 0xe3c7b0, 0x5d5a94, 0x9fb27a,
];
const TROUSERS: [u32; 10] =
    [0x2f3a4d, 0x46546a, 0x6a5a4a, 0x857b6b, 0x262a31, 0x3d4c45, 0x5c4f5e, 0x9a9484, 0x6d8299, 0x4a3a33];
const SHOES: [u32; 6] = [0xf0ede6, 0x3a2f29, 0x23252a, 0x8a5a3a, 0xb3b6bb, 0x7a3b36];
const SOLE: [u32; 3] = [0xdedad2, 0x2a2725, 0xe9e6df];

/// Shirts of teams.
const TEAM: [u32; 6] = [0x2456a6, 0xd4572a, 0x2f8f5b, 0xe0b12f, 0x8a3fa0, 0x1f9aa8];

/// What a person looks like who may be of a team: then the shirt is the team's, with long sleeves.
pub fn look_in_team(person: usize, team: Option<u32>) -> Look {
    let mut look = look(person);
    if let Some(team) = team {
        let shirt = Some(TEAM[team as usize % TEAM.len()]);
        (look[Region::Shirt as usize], look[Region::Sleeve as usize]) = (shirt, shirt);
    }
    look
}

/// What a person looks like; the same for the same number.
pub fn look(person: usize) -> Look {
    let pick = |list: &[u32], salt| Some(list[dealt(person, salt, list.len())]);
    let (skin, shirt, trousers) = (pick(&SKIN, 1), pick(&SHIRT, 4), pick(&TROUSERS, 5));
    let (bottoms, style) = (dealt(person, 7, 8), dealt(person, 10, 8));
    let (shorts, skirt) = (bottoms == 0, bottoms == 1);
    let (long, bun) = (style < 2 || (skirt && style > 2), style == 2);
    let (bald, cap) = (style == 3 && !long, style == 4 && !long);
    let hair = if cap { pick(&SHIRT, 11) } else { pick(&HAIR, 3) };
    let mut look: Look = [None; Region::COUNT];
    let mut set = |region: Region, color: Option<u32>| look[region as usize] = color;
    set(Region::Skin, skin);
    set(Region::Hair, hair.filter(|_| !bald));
    set(Region::Shirt, shirt);
    set(Region::Sleeve, if dealt(person, 6, 2) == 0 { skin } else { shirt });
    set(Region::Trousers, trousers.filter(|_| !skirt));
    set(Region::Shin, if skirt || shorts { skin } else { trousers });
    set(Region::Shoe, pick(&SHOES, 8));
    set(Region::Sole, pick(&SOLE, 9));
    set(Region::LongHair, hair.filter(|_| long));
    set(Region::Bun, hair.filter(|_| bun && !long));
    set(Region::Visor, hair.filter(|_| cap));
    set(Region::Skirt, trousers.filter(|_| skirt));
    set(Region::Seat, trousers);
    look
}

/// A card from shuffled rounds of `kinds` cards, one for each person in turn.
pub(super) fn dealt(person: usize, salt: u32, kinds: usize) -> usize {
    let first = person - person % kinds;
    let round: BTreeSet<(u32, usize)> = (0..kinds).map(|k| (mixed((first + k) as u32, salt), k)).collect();
    round.into_iter().nth(person % kinds).expect("a card for each").1
}

/// A whole number from a person's number and a salt.
fn mixed(index: u32, salt: u32) -> u32 {
    let mut h = index.wrapping_add(1).wrapping_mul(0x9e37_79b1) ^ salt.wrapping_add(1).wrapping_mul(0x85eb_ca6b);
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    h ^ (h >> 15)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_of_many_look_alike_and_neighbours_hardly_share_a_shirt() {
        let looks: BTreeSet<Look> = (0..300).map(look).collect();
        assert!(looks.len() >= 299, "{}", looks.len());
        let shirt = |p: usize| look(p)[Region::Shirt as usize];
        let same = (1..300).filter(|&p| shirt(p) == shirt(p - 1)).count();
        assert!(same <= 4, "{same} neighbours wear the same shirt");
        let with = |r: Region| (0..300).filter(|&p| look(p)[r as usize].is_some()).count();
        for (region, least) in
            [(Region::LongHair, 60), (Region::Bun, 20), (Region::Visor, 20), (Region::Skirt, 30), (Region::Hair, 240)]
        {
            assert!((least..290).contains(&with(region)), "{region:?}: {}", with(region));
        }
    }

    /// The studio's tests read the same file, so that a person looks the same in both.
    #[test]
    fn the_studio_deals_the_same_looks() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("studio/test/looks.json");
        let in_team = (0..8).map(|t| look_in_team(t, Some(t as u32)));
        let looks: Vec<Look> = (0..40).map(|person| look_in_team(person, None)).chain(in_team).collect();
        if std::env::var_os("WRITE_LOOKS").is_some() {
            std::fs::write(&path, format!("{}\n", serde_json::to_string(&looks).unwrap())).unwrap();
        }
        let kept: Vec<Look> = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        assert_eq!(kept, looks, "run this test with WRITE_LOOKS=1 and the studio's tests after it");
    }
}
