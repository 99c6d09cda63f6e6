//! The two worlds of the 2009 paper (section 6.1): an endless pedestrian street, and a city from a template map.

use super::template::Prototype::{Disc, Oblong};
use super::{Amount, PatternType, Plan, Template};
use crate::Result;

/// A pedestrian street that has no end, along x: two lanes of patches between buildings with doors.
///
/// # Errors
/// Never, but its parts can fail.
pub fn street(seed: u64) -> Result<Plan> {
    let street = Template::new("street", "cobblestones")
        .furnished("lamp", Disc(0.15), Amount::Number(0, 1))
        .furnished("bench", Oblong(1.8, 0.6), Amount::Number(0, 1))
        .furnished("flower pot", Disc(0.4), Amount::Number(0, 1))
        .gathered("talk", (2, 3), Amount::Density(0.004))
        .gathered("look at a shop window", (1, 1), Amount::Density(0.004))
        .bordered("street", PatternType::lanes(4, 4))
        .bordered("building", PatternType::door(1, 1, 0.3, 0.7));
    let building = Template::new("building", "floor").bordered("building", PatternType::door(1, 1, 0.3, 0.7));
    let row = |c: &str| c.repeat(16);
    let map = [row("b"), row("s"), row("s"), row("b")].join("\n");
    let plan = Plan::from_text(&map, vec![('s', street), ('b', building)])?;
    // Ten patterns, as in the paper: three of each of the three types of border, and the empty one.
    Ok(Plan { endless: true, patterns: 3, seed, ..plan })
}

/// A city of `side` x `side` cells (32 in the paper) with streets, squares, parks and building entrances, that repeats for ever
/// if `endless`.
///
/// # Errors
/// Never, but its parts can fail.
pub fn city(side: usize, endless: bool, seed: u64) -> Result<Plan> {
    let place = Template::new("place", "cobblestones")
        .furnished("fountain", Disc(0.7), Amount::Number(0, 1))
        .furnished("stall", Oblong(1.6, 1.0), Amount::Number(0, 1))
        .gathered("talk", (2, 4), Amount::Number(0, 1))
        .bordered("place", PatternType::mixed(4, 4))
        .bordered("street", PatternType::mixed(3, 3))
        .bordered("park", PatternType::mixed(2, 2))
        .bordered("entrance", PatternType::door(1, 1, 0.3, 0.7));
    let street = Template::new("street", "asphalt")
        .furnished("lamp", Disc(0.15), Amount::Density(0.006))
        .furnished("bin", Disc(0.25), Amount::Density(0.003))
        .gathered("wait", (1, 1), Amount::Density(0.006))
        .bordered("street", PatternType::lanes(4, 4))
        .bordered("park", PatternType::mixed(2, 2))
        .bordered("entrance", PatternType::door(1, 1, 0.3, 0.7));
    let park = Template::new("park", "grass")
        .furnished("tree", Disc(0.35), Amount::Number(0, 2))
        .furnished("bench", Oblong(1.8, 0.6), Amount::Number(0, 1))
        .gathered("sit", (1, 2), Amount::Density(0.008))
        .bordered("park", PatternType::mixed(2, 2))
        .bordered("entrance", PatternType::door(1, 1, 0.3, 0.7));
    let entrance = Template::new("entrance", "floor").bordered("entrance", PatternType::door(1, 1, 0.4, 0.6));
    let building = Template::new("building", "roof");
    let key = |x: usize, z: usize| match (x % 8, z % 8) {
        (0, _) | (_, 0) => 's',
        (4, 4) => 'p',
        (3..=5, 3..=5) => 'g',
        (4, _) | (_, 4) => 'e',
        _ => 'b',
    };
    let rows: Vec<String> = (0..side).map(|z| (0..side).map(|x| key(x, z)).collect()).collect();
    let palette = vec![('p', place), ('s', street), ('g', park), ('e', entrance), ('b', building)];
    let plan = Plan::from_text(&rows.join("\n"), palette)?;
    // Twenty patterns or so, as in the paper.
    Ok(Plan { endless, patterns: 3, seed, ..plan })
}
