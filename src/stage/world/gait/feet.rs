//! Footprints, and the feet between them.
//!
//! In the middle of its stance a foot is where the walking cycle has it, below somebody who is where it is then: that is its footprint.
//! It is found from any moment, as steps are counted along the way. Between two footprints the foot is by as much further as the
//! walking cycle says, and on the first while it is planted: nothing else moves it.

use glam::{Vec2, Vec3};

use super::walks::Stay;
use super::{Gait, GaitTable, Walking, World};

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

impl World {
    /// Where the feet of a `body` are, who is in slot `at` of its `stay`; `None` if the table knows no footprints.
    #[inline(always)]
    pub(super) fn feet<'a>(&'a self, gait: &Gait, stay: &Stay<'a>, at: (i32, f32), body: &Walking) -> Option<[Foot; 2]> {
        if gait.table.prints.is_empty() {
            return None;
        }
        let fast = gait.table.between(body.velocity.length());
        Some([self.foot(gait, stay, at, body, fast, 0), self.foot(gait, stay, at, body, fast, 1)])
    }

    #[inline(always)]
    fn foot<'a>(
        &'a self,
        gait: &Gait,
        stay: &Stay<'a>,
        at: (i32, f32),
        body: &Walking,
        (low, fast): (usize, f32),
        foot: usize,
    ) -> Foot {
        let since = body.phase - 0.5 * foot as f32;
        let since = if since < 0.0 { since + 1.0 } else { since };
        let Swing { share, height } = gait.table.swing((low, fast), foot, since);
        // Whoever stands on a footprint needs to know that one alone.
        let near = self.footprint(gait, stay, at, if share >= 1.0 { 1.0 - since } else { -since }, foot);
        if share <= 0.0 || share >= 1.0 {
            let place = near.0 - body.place;
            return Foot { ball: Vec3::new(place.x, height, place.y), ahead: near.1 };
        }
        let next = self.footprint(gait, stay, at, 1.0 - since, foot);
        let mut lift = 0.0;
        if low == 0 {
            let small = (near.0.distance(next.0) + 0.1 * near.1.distance(next.1)) * SMALL_STEP.0;
            lift = small.min(SMALL_STEP.1) * (1.0 - fast) * 4.0 * share * (1.0 - share);
        }
        let place = near.0.lerp(next.0, share) - body.place;
        Foot { ball: Vec3::new(place.x, height + lift, place.y), ahead: near.1.lerp(next.1, share) }
    }

    /// Where a foot stands `cycles` of two steps later, and where it looks.
    #[inline(always)]
    fn footprint<'a>(&'a self, gait: &Gait, stay: &Stay<'a>, at: (i32, f32), cycles: f32, foot: usize) -> (Vec2, Vec2) {
        self.later(gait, stay, at, cycles).print(&gait.table, foot)
    }
}
