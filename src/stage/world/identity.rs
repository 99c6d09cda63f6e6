//! Who is who: a walker keeps its identity over all borders and periods, and it is known at any time without history.
//!
//! Following a walker from crossing to crossing gives a permutation of crossings. Once around a cycle takes a whole
//! number m of periods, so the cycle carries m people. With n the periods from the cycle's begin to a crossing, whoever
//! comes in there in period k is number (k - n) mod m of its cycle. In a world that repeats in space, once around may also
//! lead w copies on: with k0 = k - n and j = floor(k0 / m) it is number k0 - j m of the cycle begun j w copies earlier.
//! (Beyond the paper, which follows pointers from trajectory to trajectory.)

/// Where a walker comes in next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link {
    /// The crossing, an index.
    pub to: usize,
    /// How many periods later than the period it came in here.
    pub laps: u32,
    /// How many copies of the world further, where the world repeats in space.
    pub shift: [i64; 2],
}

/// Somebody: the same value at every crossing, period and time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
pub struct Person {
    /// Which cycle of crossings it walks on.
    pub cycle: u32,
    /// Which copy of the world the cycle begins in.
    pub copy: [i64; 2],
    /// Which of the people of the cycle: below their number, any number where the way leads out of the world.
    pub number: i64,
}

impl Person {
    /// A well-mixed number that is always the same for the same person and `seed`: picks looks and body.
    pub fn hash(&self, seed: u64) -> u64 {
        [u64::from(self.cycle), self.copy[0] as u64, self.copy[1] as u64, self.number as u64]
            .into_iter()
            .fold(seed, mix)
    }
}

/// One step of splitmix64 over `hash` and a `value`.
pub(crate) fn mix(hash: u64, value: u64) -> u64 {
    let mut z = (hash ^ value.wrapping_mul(0x2545_f491_4f6c_dd1d)).wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Identities of all walkers of a world.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Identities {
    /// Of every crossing.
    crossings: Vec<Place>,
    /// Of every cycle.
    cycles: Vec<Round>,
}

/// Where on its cycle a crossing is: periods and copies of the world since the cycle's begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub cycle: u32,
    pub laps: i32,
    pub copies: [i32; 2],
}

/// Once around a cycle: periods (= people; 0 if the way leads out of the world) and copies of the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Round {
    pub people: u32,
    pub copies: [i32; 2],
}

/// A cycle that is not known yet.
const NONE: u32 = u32::MAX;

impl Identities {
    /// Follows `links`, one per crossing; `None` leads out of the world. No two may lead to the same crossing. O(crossings).
    pub fn new(links: &[Option<Link>]) -> Self {
        let mut reached = vec![false; links.len()];
        links.iter().flatten().for_each(|link| reached[link.to] = true);
        let unknown = Place { cycle: NONE, laps: 0, copies: [0; 2] };
        let mut found = Self { crossings: vec![unknown; links.len()], cycles: Vec::new() };
        // Ways that begin at the border of the world first; all others are cycles.
        let (inner, outer): (Vec<usize>, Vec<usize>) = (0..links.len()).partition(|&c| reached[c]);
        for begin in outer.into_iter().chain(inner) {
            if found.crossings[begin].cycle == NONE {
                found.follow(begin, links);
            }
        }
        found
    }

    fn follow(&mut self, begin: usize, links: &[Option<Link>]) {
        let cycle = self.cycles.len() as u32;
        let (mut at, mut laps, mut copies) = (begin, 0, [0; 2]);
        loop {
            self.crossings[at] = Place { cycle, laps, copies };
            let Some(link) = links[at] else {
                return self.cycles.push(Round { people: 0, copies: [0; 2] });
            };
            laps += link.laps as i32;
            copies = [copies[0] + link.shift[0] as i32, copies[1] + link.shift[1] as i32];
            at = link.to;
            if at == begin {
                return self.cycles.push(Round { people: laps as u32, copies });
            }
        }
    }

    /// Who comes in at `crossing` of the world's copy `copy` in `period`. O(1).
    pub fn of(&self, crossing: usize, copy: [i64; 2], period: i64) -> Person {
        let place = self.crossings[crossing];
        let round = self.cycles[place.cycle as usize];
        let (people, since) = (i64::from(round.people), period - i64::from(place.laps));
        let rounds = if people > 0 { since.div_euclid(people) } else { 0 };
        let back = |axis: usize| copy[axis] - i64::from(place.copies[axis]) - rounds * i64::from(round.copies[axis]);
        Person { cycle: place.cycle, copy: [back(0), back(1)], number: since - rounds * people }
    }

    /// From what a file holds. The caller has checked that every crossing's cycle is there.
    pub(super) fn from_parts(crossings: Vec<Place>, cycles: Vec<Round>) -> Self {
        Self { crossings, cycles }
    }

    pub(super) fn parts(&self) -> (&[Place], &[Round]) {
        (&self.crossings, &self.cycles)
    }

    /// The cycle of a crossing.
    pub fn cycle(&self, crossing: usize) -> u32 {
        self.crossings[crossing].cycle
    }

    /// Periods from the cycle's begin to a crossing.
    pub fn laps(&self, crossing: usize) -> i64 {
        self.crossings[crossing].laps.into()
    }

    /// Copies of the world since the cycle's begin of a crossing, and copies once around the cycle.
    pub(super) fn copies(&self, crossing: usize) -> ([i32; 2], [i32; 2]) {
        let place = self.crossings[crossing];
        (place.copies, self.cycles[place.cycle as usize].copies)
    }

    /// Periods once around a cycle; 0 if it leads out of the world.
    pub(super) fn around(&self, cycle: u32) -> i64 {
        self.cycles[cycle as usize].people.into()
    }

    /// Whether a cycle is a way through the world rather than a round in it.
    pub fn leads_out(&self, cycle: u32) -> bool {
        self.cycles[cycle as usize].people == 0
    }

    /// How many cycles (and ways through the world) there are.
    pub fn cycles(&self) -> usize {
        self.cycles.len()
    }

    /// How many people walk on the cycles of one copy of the world; those on ways through it are not counted.
    pub fn people(&self) -> u64 {
        self.cycles.iter().map(|round| u64::from(round.people)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::HashSet;

    fn links(order: &[usize], laps: &[u32], shifts: &[(i64, i64)]) -> Vec<Option<Link>> {
        let link = |((&to, &laps), &(x, z)): ((&usize, &u32), &(i64, i64))| Link { to, laps, shift: [x, z] };
        order.iter().zip(laps).zip(shifts).map(|all| Some(link(all))).collect()
    }

    proptest! {
        #[test]
        fn nobody_changes_on_the_way_and_all_are_different(
            order in Just((0..40).collect::<Vec<usize>>()).prop_shuffle(),
            laps in prop::collection::vec(1u32..4, 40),
            shifts in prop::collection::vec((-1i64..2, -1i64..2), 40),
            begin in 0usize..40,
            period in -50i64..50,
        ) {
            let links = links(&order, &laps, &shifts);
            let identities = Identities::new(&links);
            let (mut at, mut copy, mut now) = (begin, [3, -7], period);
            let who = identities.of(at, copy, now);
            for _ in 0..500 {
                let link = links[at].unwrap();
                (at, now) = (link.to, now + i64::from(link.laps));
                copy = [copy[0] + link.shift[0], copy[1] + link.shift[1]];
                prop_assert_eq!(identities.of(at, copy, now), who);
            }
            // Whoever is on the way between two crossings in a period: as many as links last periods.
            let present = |copies: i64| (0..40).flat_map(move |c| (0..copies).map(move |x| (c, [x, 0])));
            let of = |(c, copy): (usize, [i64; 2])| (0..i64::from(laps[c])).map(move |lap| (c, copy, period - lap));
            let people: Vec<Person> = present(4).flat_map(of).map(|(c, copy, k)| identities.of(c, copy, k)).collect();
            prop_assert_eq!(people.iter().collect::<HashSet<_>>().len(), people.len());
        }
    }

    #[test]
    fn ways_through_the_world_carry_new_people_every_period() {
        let links = [Some(Link { to: 1, laps: 2, shift: [0, 0] }), None];
        let identities = Identities::new(&links);
        assert_eq!(identities.of(0, [0, 0], 5), identities.of(1, [0, 0], 7));
        assert_ne!(identities.of(0, [0, 0], 5), identities.of(0, [0, 0], 6));
        assert_eq!((identities.cycles(), identities.people()), (1, 0));
    }
}
