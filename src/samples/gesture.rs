//! Gestures: hands reaching for grips over time, and arms hanging where they do not.

use glam::{Quat, Vec3};

use super::posture::Body;
use super::timeline::{Span, ease};
use crate::geom::Ground;
use crate::motion::arm::{self, hand_rotation, joints, shrug, sign};
use crate::motion::{Foot, joint::*, mirror};

/// From the wrist to the middle of the palm along the fingers.
pub(super) const PALM: f32 = 0.09;

/// What a grip's coordinates are relative to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Relative {
    World,
    /// The path's frame on the ground.
    Path,
    /// The chest: turns and bends with the upper body.
    Chest,
    Head,
}

/// Where a palm is to be, where its fingers point and where it faces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grip {
    pub relative: Relative,
    pub palm: Vec3,
    pub fingers: Vec3,
    pub facing: Vec3,
}

/// A hand led along grips; the weight fades it in from the arm's own swing and out again.
#[derive(Clone, Debug)]
pub(super) struct Reach {
    pub side: Foot,
    pub span: Span,
    pub grips: Vec<(f32, Grip)>,
    /// Where the elbow points in the chest's frame, for the left arm (mirrored for the right).
    pub elbow: Vec3,
}

/// Elbows point down, outwards and a little back.
pub(super) const ELBOW: Vec3 = Vec3::new(0.45, -1.0, -0.45);

/// The hand's rotation and the palm's place.
#[derive(Clone, Copy)]
struct Goal {
    palm: Vec3,
    rotation: Quat,
}

impl Reach {
    fn goal(&self, t: f32, body: &Body, path: Ground) -> Goal {
        let next = self.grips.partition_point(|g| g.0 <= t);
        let at = |i: usize| self.grips[i].1.resolve(self.side, body, path);
        if next == 0 {
            return at(0);
        }
        if next == self.grips.len() {
            return at(next - 1);
        }
        let (t0, t1) = (self.grips[next - 1].0, self.grips[next].0);
        let u = ease((t - t0) / (t1 - t0));
        let (a, b) = (at(next - 1), at(next));
        Goal { palm: a.palm.lerp(b.palm, u), rotation: a.rotation.slerp(b.rotation, u) }
    }
}

impl Grip {
    fn resolve(&self, side: Foot, body: &Body, path: Ground) -> Goal {
        let (origin, turn) = match self.relative {
            Relative::World => (Vec3::ZERO, Quat::IDENTITY),
            Relative::Path => (Vec3::new(path.position.x, 0.0, path.position.y), path.rotation()),
            Relative::Chest => body.global[SPINE2],
            Relative::Head => body.global[HEAD],
        };
        Goal { palm: origin + turn * self.palm, rotation: turn * hand_rotation(side, self.fingers, self.facing) }
    }
}

/// An arm's local rotations: upper arm, forearm, hand.
pub(super) type ArmPose = [Quat; 3];

/// A hanging arm: flexed forward, abducted, with a bent elbow (radians).
pub(super) fn hanging(side: Foot, flex: f32, abduct: f32, elbow: f32) -> ArmPose {
    use std::f32::consts::FRAC_PI_2;
    let left = [
        Quat::from_rotation_x(-flex) * Quat::from_rotation_z(abduct - FRAC_PI_2) * Quat::from_rotation_x(0.30),
        Quat::from_rotation_y(-elbow) * Quat::from_rotation_x(0.1),
        Quat::from_rotation_z(-0.10) * Quat::from_rotation_y(-0.06),
    ];
    if side == Foot::Left { left } else { left.map(mirror::rotation) }
}

/// Blends one arm from hanging to what the reaches of its side want at `t`.
pub(super) fn set_arm(body: &mut Body, side: Foot, hanging: ArmPose, reaches: &[Reach], path: Ground, t: f32) {
    let [_, upper, lower, hand] = joints(side);
    let mut pose = hanging;
    for reach in reaches.iter().filter(|r| r.side == side) {
        let weight = reach.span.weight(t);
        if weight > 0.0 {
            let goal = reach.goal(t, body, path);
            shrug_towards(body, side, goal.palm, weight);
            let wrist = goal.palm - goal.rotation * (Vec3::X * sign(side) * PALM);
            let solved = arm::reach(&body.global, side, wrist, goal.rotation, reach.elbow);
            for (p, s) in pose.iter_mut().zip(solved) {
                *p = p.slerp(s, weight);
            }
        }
    }
    [body.local[upper], body.local[lower], body.local[hand]] = pose;
    body.refresh();
}

/// The shoulder girdle goes with a hand that is raised or reaches far.
fn shrug_towards(body: &mut Body, side: Foot, palm: Vec3, weight: f32) {
    let girdle = joints(side)[0];
    let turn = shrug(&body.global, side, palm);
    body.local[girdle] = body.local[girdle].slerp(turn * body.local[girdle], weight);
    body.refresh();
}
