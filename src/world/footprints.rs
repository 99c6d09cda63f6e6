//! Footprints of walking cycles: where feet stand, and how they go from one place to the next.

use std::ops::Range;

use glam::{Vec2, Vec3};

use crate::motion::{JOINT_COUNT, canonical, joint};
use crate::stage::world::{GaitTable, Swing};

/// Who stands has the ball of the foot no further than this from where it is in the middle of the stance, metres.
const SLIP: f32 = 0.03;
/// And no higher above the height it has then, metres.
const RISE: f32 = 0.02;
/// A foot is planted for at least and at most this part of a cycle, about the middle of its stance.
const PLANTED: (f32, f32) = (0.3, 0.75);

/// The ball of a foot all along a cycle, from the middle of the stance to that of the next, on the ground.
struct Track {
    balls: Vec<Vec3>,
    /// Poses at whose beginning the foot leaves its place, and comes to the next.
    swing: Range<usize>,
}

/// Fills in footprints and swings of a table of poses. What the poses slide is left out.
pub(super) fn footprints(table: &mut GaitTable) {
    let cycles = table.speeds.len();
    let tracks: Vec<[Track; 2]> = (1..cycles).map(|cycle| [0, 1].map(|foot| track(table, cycle, foot))).collect();
    let standing = [0, 1].map(|foot| ball(table, 0, foot, 0));
    let prints = |pair: &[Track; 2]| [0, 1].map(|foot| pair[foot].print());
    table.prints = std::iter::once(standing.map(|p| Vec2::new(p.x, p.z))).chain(tracks.iter().map(prints)).collect();
    // Who stands goes on as the slowest does, but lifts no foot.
    let still = |i: usize| [0, 1].map(|f| Swing { height: standing[f].y, ..tracks[0][f].swing(i, table.strides[1]) });
    let poses = 0..table.phases;
    let mut swings: Vec<[Swing; 2]> = poses.clone().map(still).collect();
    for (pair, &stride) in tracks.iter().zip(&table.strides[1..]) {
        swings.extend(poses.clone().map(|i| [0, 1].map(|foot| pair[foot].swing(i, stride))));
    }
    table.swings = swings;
}

/// The ball of a foot in a pose, relative to where somebody is.
fn ball(table: &GaitTable, cycle: usize, foot: usize, pose: usize) -> Vec3 {
    let at = cycle * table.phases + pose % table.phases;
    let mut globals = Vec::with_capacity(JOINT_COUNT);
    canonical().globals(table.hips[at], &table.rotations[at * JOINT_COUNT..(at + 1) * JOINT_COUNT], &mut globals);
    globals[[joint::LEFT_TOE, joint::RIGHT_TOE][foot]].0
}

fn track(table: &GaitTable, cycle: usize, foot: usize) -> Track {
    let (n, stride) = (table.phases, table.strides[cycle]);
    let at = |i: usize| ball(table, cycle, foot, foot * n / 2 + i) + Vec3::Z * (stride * i as f32 / n as f32);
    let balls: Vec<Vec3> = (0..=n).map(at).collect();
    let stays = |i: usize, of: Vec3| (balls[i] - of).with_y(0.0).length() < SLIP && balls[i].y - of.y < RISE;
    let half = |share: f32| (0.5 * share * n as f32).round() as usize;
    let (least, most) = (half(PLANTED.0), half(PLANTED.1));
    let off = (least..most).find(|&i| !stays(i + 1, balls[0])).unwrap_or(most);
    let on = (least..most).find(|&i| !stays(n - i - 1, balls[n])).unwrap_or(most);
    Track { swing: off..n - on, balls }
}

impl Track {
    /// Where the foot stands: the mean of the poses in which it is planted.
    fn print(&self) -> Vec2 {
        let (n, stride) = (self.balls.len() - 1, self.balls[self.balls.len() - 1] - self.balls[0]);
        let after = self.balls[..=self.swing.start].iter().copied();
        let before = self.balls[self.swing.end..n].iter().map(|&p| p - stride);
        let count = self.swing.start + 1 + n - self.swing.end;
        let mean = after.chain(before).sum::<Vec3>() / count as f32;
        Vec2::new(mean.x, mean.z)
    }

    /// Height of the ball while planted, metres.
    fn ground(&self) -> f32 {
        let n = self.balls.len() - 1;
        let mut heights: Vec<f32> =
            self.balls[..=self.swing.start].iter().chain(&self.balls[self.swing.end..n]).map(|p| p.y).collect();
        heights.sort_by(f32::total_cmp);
        heights[heights.len() / 2]
    }

    /// How far it is on its way in a pose, from the middle of the stance on: what is missing at both ends of the swing fades out in it.
    fn swing(&self, pose: usize, stride: f32) -> Swing {
        let Range { start, end } = self.swing;
        if pose <= start || pose >= end {
            return Swing { share: if pose <= start { 0.0 } else { 1.0 }, height: self.ground() };
        }
        let share = |i: usize| (self.balls[i].z - self.balls[0].z) / stride;
        let part = (pose - start) as f32 / (end - start) as f32;
        let part = part * part * (3.0 - 2.0 * part);
        let faded = |first: f32, last: f32| first + (last - first) * part;
        Swing {
            share: share(pose) - faded(share(start), share(end) - 1.0),
            height: self.balls[pose].y - faded(self.balls[start].y - self.ground(), self.balls[end].y - self.ground()),
        }
    }
}
