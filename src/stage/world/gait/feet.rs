//! Footprints, and the feet between them.
//!
//! In the middle of its stance a foot is where the walking cycle has it, below somebody who is where it is then: that is its footprint.
//! It is found from any moment, as steps are counted along the way. Between two footprints the foot is by as much further as the
//! walking cycle says, and on the first while it is planted: nothing else moves it.

use glam::{Vec2, Vec3};

use super::bodies::{Instants, States};
use super::eights::{Eight, Eights, WIDTH};
use super::{GaitTable, World};

/// How a foot goes from one footprint to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Swing {
    /// How far it is on its way: 0 on the first footprint, 1 on the second.
    pub share: f32,
    /// Height of its ball, metres.
    pub height: f32,
}

/// Where a foot is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Its ball, relative to where its owner is.
    pub ball: Vec3,
    /// Where it looks, as x and z; about a unit long.
    pub ahead: Vec2,
}

/// Who takes small steps lifts feet by this share of them, and by at most so many metres.
const SMALL_STEP: (f32, f32) = (0.25, 0.03);

/// Cycles since the middle of a foot's stance, 0 to 1.
#[inline(always)]
pub(super) fn since(phase: f32, foot: usize) -> f32 {
    let since = phase - 0.5 * foot as f32;
    if since < 0.0 { since + 1.0 } else { since }
}

impl GaitTable {
    /// How far the feet are between their footprints, each from the middle of its own stance on (0 to 1).
    #[inline(always)]
    fn swing(&self, (low, fast): (usize, f32), foot: usize, since: f32) -> Swing {
        let at = since * self.phases as f32;
        let first = (at as usize).min(self.phases - 1);
        let late = at - first as f32;
        let (slower, faster) = (&self.swings[low * self.phases..], &self.swings[(low + 1) * self.phases..]);
        // Before its own stance comes round again it is wholly on its way.
        let last = first + 1 == self.phases;
        let (next, whole) = if last { (0, 1.0) } else { (first + 1, 0.0) };
        let (slow, quick) = (slower[next][foot], faster[next][foot]);
        let slow = Swing { share: slow.share.max(whole), ..slow };
        let quick = Swing { share: quick.share.max(whole), ..quick };
        slower[first][foot].towards(slow, late).towards(faster[first][foot].towards(quick, late), fast)
    }
}

impl Swing {
    #[inline(always)]
    fn towards(self, other: Self, share: f32) -> Self {
        Self {
            share: self.share + (other.share - self.share) * share,
            height: self.height + (other.height - self.height) * share,
        }
    }
}

/// Where feet stand in the middle of their stances, by speed: lines from one cycle of the table to the next.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Prints {
    /// Of who stands: to the left, ahead.
    first: [Vec2; 2],
    lines: Vec<Line>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    /// Speed it begins at, and by how much more it ends.
    speed: f32,
    width: f32,
    slopes: [Vec2; 2],
}

impl Prints {
    pub fn new(table: &GaitTable) -> Self {
        let cycles = table.speeds.windows(2).zip(table.prints.windows(2));
        let line = |(speeds, prints): (&[f32], &[[Vec2; 2]])| {
            let width = speeds[1] - speeds[0];
            let slopes = [0, 1].map(|foot| (prints[1][foot] - prints[0][foot]) / width);
            Line { speed: speeds[0], width, slopes }
        };
        Self { first: table.prints.first().copied().unwrap_or_default(), lines: cycles.map(line).collect() }
    }

    /// From where people are to where a foot of theirs stands.
    #[inline(always)]
    fn stand(&self, people: &mut States, foot: usize) {
        let mut own = Eights([[self.first[foot].x; WIDTH], [self.first[foot].y; WIDTH]]);
        for line in &self.lines {
            for i in 0..WIDTH {
                let over = (people.speed[i] - line.speed).max(0.0).min(line.width);
                own.put(i, own.at(i) + line.slopes[foot] * over);
            }
        }
        for i in 0..WIDTH {
            let (ahead, own) = (people.ahead.at(i), own.at(i));
            let left = Vec2::new(ahead.y, -ahead.x);
            people.place.put(i, people.place.at(i) + left * own.x + ahead * own.y);
        }
    }
}

/// A step of eight people, each with the same foot.
#[derive(Default)]
pub(super) struct Steps {
    /// In the middle of the stance before, and after.
    pub before: Instants,
    pub after: Instants,
    /// Where it stands then, and where its owner looks.
    from: States,
    to: States,
    /// How far the foot is on its way, how high its ball, and how slow its owner is: 1 who stands, 0 from the slowest cycle on.
    share: Eight,
    height: Eight,
    slow: Eight,
    /// What follows.
    ball: Eights<3>,
    ahead: Eights<2>,
}

impl Steps {
    /// Finds where the feet are of who are as `now` says, and so far through their cycles.
    #[inline(always)]
    pub fn find(&mut self, world: &World, table: &GaitTable, foot: usize, phase: &Eight, now: &States) {
        for (i, &phase) in phase.iter().enumerate() {
            let (low, fast) = table.between(now.speed[i]);
            let Swing { share, height } = table.swing((low, fast), foot, since(phase, foot));
            (self.share[i], self.height[i]) = (share, height);
            self.slow[i] = if low == 0 { 1.0 - fast } else { 0.0 };
        }
        self.before.find(world.ways.rate, &mut self.from);
        self.after.find(world.ways.rate, &mut self.to);
        world.ways.prints.stand(&mut self.from, foot);
        world.ways.prints.stand(&mut self.to, foot);
        self.place(now);
    }

    /// Places the feet between their footprints.
    #[inline(always)]
    fn place(&mut self, now: &States) {
        let Self { from, to, share, height, slow, ball, ahead, .. } = self;
        for i in 0..WIDTH {
            let share = share[i].clamp(0.0, 1.0);
            let (looked, looks) = (from.ahead.at(i), to.ahead.at(i));
            let (from, to) = (from.place.at(i), to.place.at(i));
            let small = (length(to - from) + 0.1 * length(looks - looked)) * SMALL_STEP.0;
            let lift = small.min(SMALL_STEP.1) * slow[i] * 4.0 * share * (1.0 - share);
            // On one of them exactly, where it stands on one.
            let place = from * (1.0 - share) + to * share - now.place.at(i);
            ball.put(i, Vec3::new(place.x, height[i] + lift, place.y));
            ahead.put(i, looked * (1.0 - share) + looks * share);
        }
    }

    /// The foot of the one at place `i`.
    #[inline(always)]
    pub fn at(&self, i: usize) -> Foot {
        Foot { ball: self.ball.at(i), ahead: self.ahead.at(i) }
    }
}

/// Not glam's, which is a vector instruction of its own for two numbers.
#[inline(always)]
fn length(v: Vec2) -> f32 {
    (v.x * v.x + v.y * v.y).sqrt()
}
