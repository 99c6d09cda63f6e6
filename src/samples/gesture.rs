//! Gestures: hands reaching for grips over time, and arms hanging where they do not.

use glam::{Mat3, Quat, Vec3};

use super::posture::{Body, arm, bend, bone_length, mirrored, side_sign};
use super::timeline::{Span, ease};
use crate::geom::Ground;
use crate::motion::{Foot, joint::*};

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

/// The global rotation of a hand whose fingers point along one direction and whose palm faces another.
fn hand_rotation(side: Foot, fingers: Vec3, facing: Vec3) -> Quat {
    let x = fingers.normalize() * side_sign(side);
    let y = -(facing - x * facing.dot(x)).try_normalize().unwrap_or_else(|| x.any_orthonormal_vector());
    Quat::from_mat3(&Mat3::from_cols(x, y, x.cross(y)))
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
    if side == Foot::Left { left } else { left.map(mirrored) }
}

/// Blends one arm from hanging to what the reaches of its side want at `t`.
pub(super) fn set_arm(body: &mut Body, side: Foot, hanging: ArmPose, reaches: &[Reach], path: Ground, t: f32) {
    let [_, upper, lower, hand] = arm(side);
    let mut pose = hanging;
    for reach in reaches.iter().filter(|r| r.side == side) {
        let weight = reach.span.weight(t);
        if weight > 0.0 {
            let goal = reach.goal(t, body, path);
            shrug_towards(body, side, goal.palm, weight);
            let solved = solve(body, side, goal, reach.elbow);
            for (p, s) in pose.iter_mut().zip(solved) {
                *p = p.slerp(s, weight);
            }
        }
    }
    [body.local[upper], body.local[lower], body.local[hand]] = pose;
    body.refresh();
}

/// The shoulder girdle goes up and forward with a hand that is raised or reaches far.
fn shrug_towards(body: &mut Body, side: Foot, palm: Vec3, weight: f32) {
    let [girdle, upper, ..] = arm(side);
    let chest = body.rotation(SPINE2);
    let to = chest.inverse() * (palm - body.position(upper));
    let raise = ((to.y + 0.15) * 0.55).clamp(0.0, 0.35);
    let forward = ((to.z - 0.25) * 0.6).clamp(0.0, 0.3);
    let left = Quat::from_rotation_y(-forward) * Quat::from_rotation_z(raise);
    let turn = if side == Foot::Left { left } else { mirrored(left) };
    body.local[girdle] = body.local[girdle].slerp(turn * body.local[girdle], weight);
    body.refresh();
}

/// The arm that brings the palm to its goal, its elbow a hinge, the hand's twist shared with the forearm.
fn solve(body: &Body, side: Foot, goal: Goal, elbow_left: Vec3) -> ArmPose {
    let [girdle, upper, lower, hand] = arm(side);
    let sign = side_sign(side);
    let chest = body.rotation(SPINE2);
    let pole = chest * Vec3::new(elbow_left.x * sign, elbow_left.y, elbow_left.z);
    let wrist = goal.palm - goal.rotation * (Vec3::X * sign * PALM);
    let shoulder = body.position(upper);
    // An elbow that would point along the arm gives way to the back.
    let along = pole.normalize().dot((wrist - shoulder).normalize_or_zero()).abs();
    let pole = pole.normalize() + chest * Vec3::new(0.2 * sign, 0.0, -1.0) * (0.9 * along.powi(3));
    let (elbow, end) = bend(shoulder, wrist, bone_length(lower), bone_length(hand), pole, 0.995);
    // The elbow is behind the line from shoulder to wrist; the hinge's z looks to its front.
    let front = (shoulder + end) * 0.5 - elbow;
    let bone = |along: Vec3| {
        let x = along.normalize() * sign;
        let z = (front - x * front.dot(x)).normalize_or(chest * Vec3::Z);
        Quat::from_mat3(&Mat3::from_cols(x, z.cross(x), z))
    };
    let (upper_global, lower_global) = (bone(elbow - shoulder), bone(end - elbow));
    let wrist_turn = lower_global.inverse() * goal.rotation;
    let twist = Quat::from_rotation_x(2.0 * wrist_turn.x.atan2(wrist_turn.w));
    let twist = if twist.w < 0.0 { -twist } else { twist };
    let shared = Quat::IDENTITY.slerp(twist, 0.75);
    [
        body.rotation(girdle).inverse() * upper_global,
        upper_global.inverse() * lower_global * shared,
        shared.inverse() * wrist_turn,
    ]
}
