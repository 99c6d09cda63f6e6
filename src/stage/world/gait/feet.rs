//! Footprints, and the feet between them.
//!
//! In the middle of its stance a foot is where the walking cycle has it, below somebody who is where it is then: that is its footprint.
//! It is found from any moment, as steps are counted along the way. Between two footprints the foot is by as much further as the
//! walking cycle says, and on the first while it is planted: nothing else moves it.

use glam::{Vec2, Vec3};

use super::walks::{Instant, Stay};
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
    #[inline]
    fn swing(&self, (low, fast): (usize, f32), foot: usize, since: f32) -> Swing {
        let at = since * self.phases as f32;
        let first = (at as usize).min(self.phases - 1);
        let late = at - first as f32;
        let of = |cycle: usize| {
            let row = &self.swings[cycle * self.phases..(cycle + 1) * self.phases];
            let next = row.get(first + 1).map_or(Swing { share: 1.0, ..row[0][foot] }, |pair| pair[foot]);
            row[first][foot].towards(next, late)
        };
        of(low).towards(of(low + 1), fast)
    }

    /// Where a foot stands in the middle of its stance.
    #[inline]
    fn print(&self, foot: usize, at: &Instant) -> Vec2 {
        let (low, fast) = self.between(at.speed);
        let own = self.prints[low][foot].lerp(self.prints[low + 1][foot], fast);
        let left = Vec2::new(at.ahead.y, -at.ahead.x);
        at.place + left * own.x + at.ahead * own.y
    }
}

impl Swing {
    #[inline]
    fn towards(self, other: Self, share: f32) -> Self {
        Self {
            share: self.share + (other.share - self.share) * share,
            height: self.height + (other.height - self.height) * share,
        }
    }
}

impl World {
    /// Where the feet of a `body` are, who is in slot `at` of its `stay`; `None` if the table knows no footprints.
    pub(super) fn feet(&self, gait: &Gait, stay: &Stay, at: (i32, f32), body: &Walking) -> Option<[Foot; 2]> {
        let table = &gait.table;
        if table.prints.is_empty() {
            return None;
        }
        let between = table.between(body.velocity.length());
        let foot = |foot: usize| {
            let since = body.phase - 0.5 * foot as f32;
            let since = if since < 0.0 { since + 1.0 } else { since };
            let swing = table.swing(between, foot, since);
            // Whoever stands on a footprint needs to know that one alone.
            let print = |cycles: f32| {
                let then = self.later(gait, stay, at, cycles);
                (table.print(foot, &then) - body.place, then.ahead)
            };
            if swing.share <= 0.0 || swing.share >= 1.0 {
                let (place, ahead) = print(if swing.share <= 0.0 { -since } else { 1.0 - since });
                return Foot { ball: Vec3::new(place.x, swing.height, place.y), ahead };
            }
            let ((a, b), slow) =
                ((print(-since), print(1.0 - since)), if between.0 == 0 { 1.0 - between.1 } else { 0.0 });
            let small = (a.0.distance(b.0) + 0.1 * a.1.distance(b.1)) * SMALL_STEP.0;
            let lift = small.min(SMALL_STEP.1) * slow * 4.0 * swing.share * (1.0 - swing.share);
            let place = a.0.lerp(b.0, swing.share);
            Foot { ball: Vec3::new(place.x, swing.height + lift, place.y), ahead: a.1.lerp(b.1, swing.share) }
        };
        Some([foot(0), foot(1)])
    }
}
