//! The plan of gatherings: with which patch each is to begin and how long its people are to stay together. It learns how
//! often gatherings that begin with a kind come about.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::gather::Wish;
use super::library::Library;
use super::passage::{Passages, Way};

/// Least and largest share of their time that people who stay together do so, about.
const TOGETHER: [f32; 2] = [0.35, 0.85];
/// By how much more company is provided for than is needed: some gatherings do not get as far as they should.
const RESERVE: f32 = 2.2;
/// Part of the time asked for that people must spend together.
const LEAST: f32 = 0.7;
/// Gatherings, half of which came about, that a kind is credited with before it is tried.
const CREDIT: f32 = 2.0;

/// How gatherings that begin with a kind went.
#[derive(Clone, Copy)]
struct Record {
    kind: u32,
    tried: f32,
    made: f32,
}

/// What gatherings are to be like.
pub(super) struct Plan<'a> {
    library: &'a Library<'a>,
    passages: &'a Passages<'a>,
    horizon: i32,
    records: Vec<Record>,
    rng: ChaCha8Rng,
}

impl<'a> Plan<'a> {
    /// Nothing is known yet.
    pub fn new(library: &'a Library<'a>, passages: &'a Passages<'a>, horizon: i32, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        // Far from the streams of the crew, which count from zero.
        rng.set_stream(u64::MAX);
        let record = |&kind: &u32| Record { kind, tried: 0.0, made: 0.0 };
        Self { library, passages, horizon, records: library.multi.iter().map(record).collect(), rng }
    }

    /// A gathering; `need` is the share of their time that those who are still to come must spend together on average.
    /// Kinds whose people cannot spend as much time together, or which seldom find room, are drawn the more seldom.
    pub fn draw(&mut self, need: f32) -> Wish {
        let weight = |r: &Record| {
            if self.is_isolated(r.kind) {
                return 0.0;
            }
            let enough = (self.potential(r.kind) / (RESERVE * need)).min(1.0);
            self.library.preference.weight_of_kind(r.kind) * enough * enough * (r.made + 0.5 * CREDIT)
                / (r.tried + CREDIT)
        };
        let weights: Vec<f32> = self.records.iter().map(weight).collect();
        let mut at = self.rng.random_range(0.0..1.0) * weights.iter().sum::<f32>();
        let drawn = weights.iter().position(|w| {
            at -= w;
            at < 0.0
        });
        self.wish(self.records[drawn.unwrap_or(0)].kind, need)
    }

    fn wish(&mut self, kind: u32, need: f32) -> Wish {
        if !self.is_sociable(kind) {
            return Wish { kind, together: 0, least: 0 };
        }
        let least = TOGETHER[0].max(need.min(TOGETHER[1]));
        let ticks = |share: f32| (share * self.horizon as f32) as i32;
        Wish { kind, together: ticks(self.rng.random_range(least..=TOGETHER[1])), least: ticks(least * LEAST) }
    }

    /// True if the people of a kind can stay together after it, as far as is known.
    fn is_sociable(&self, kind: u32) -> bool {
        self.passages.known(kind, Way::Stay).is_none_or(|known| !known.is_empty())
    }

    /// True if people are known to have no way to or from a kind.
    fn is_isolated(&self, kind: u32) -> bool {
        let none = |way| self.passages.known(kind, way).is_some_and(<[_]>::is_empty);
        none(Way::Come) || none(Way::Part)
    }

    /// The share of their time that people whose first patch is of a kind may spend together.
    fn potential(&self, kind: u32) -> f32 {
        let first = self.library.first_role[kind as usize] as usize;
        let own = self.library.roles[first].ticks as f32 / self.horizon as f32;
        if self.is_sociable(kind) { own.max(0.5 * (TOGETHER[0] + TOGETHER[1])) } else { own }
    }

    /// Takes note of which gatherings came about.
    pub fn learn(&mut self, wishes: &[Wish], made: &[bool]) {
        for (wish, &made) in wishes.iter().zip(made) {
            let record = self.records.iter_mut().find(|r| r.kind == wish.kind).expect("a kind of several people");
            record.tried += 1.0;
            record.made += f32::from(u8::from(made));
        }
    }
}
