//! Poses whose legs reach the feet.
//!
//! A leg that would have to be longer than it is does what people do: the hips come down a little, then the heel comes up
//! while the ball of the foot stays. Toes do not go through the floor.
//!
//! All of it is sums, products and a few roots, without a branch, for eight people side by side: the loop over them becomes vector
//! instructions.

use glam::{Quat, Vec2, Vec3};

use super::eights::{Eights, WIDTH};
use super::feet::Foot;
use crate::geom::Rotation;
use crate::motion::{JOINT_COUNT, Joint, canonical, joint};

/// Largest part of a leg's length that is used, so that knees never lock.
const STRETCH: f32 = 0.995;
/// Most that hips come down before heels come up, metres.
const LOWERING: f32 = 0.045;
/// Over so many metres the hips begin to come down.
const EASE: f32 = 0.012;
/// Most that a heel is lifted, as a turn of the foot about its ball: cosine and sine of 0.45 radians.
const LIFT: (f32, f32) = (0.900_447_1, 0.434_965_53);
/// Height below which an ankle's heel would be in the floor, metres.
const HEEL: f32 = 0.06;
/// The hinge of a knee that is bent less than this (its sine) is as much that which its thigh has at rest.
const STRAIGHT: f32 = 0.1;
/// How far the tips of toes may sink into the floor, metres.
const TOES: f32 = 0.005;
/// In place of lengths that are zero.
const TINY: f32 = 1e-9;

/// First joints of the legs.
const UPS: [usize; 2] = [joint::LEFT_UP_LEG, joint::RIGHT_UP_LEG];

/// Legs of up to eight people.
#[derive(Default)]
pub(super) struct Legs {
    hips: Eights<4>,
    root: Eights<3>,
    facing: Eights<2>,
    sides: [Side; 2],
}

/// Left or right legs: rotations of thigh, shin, foot and toes, each relative to the one before.
#[derive(Clone, Copy, Default)]
struct Side {
    turns: [Eights<4>; 4],
    ball: Eights<3>,
    ahead: Eights<2>,
}

impl Legs {
    /// Puts somebody in at place `i`.
    #[inline(always)]
    pub fn put(&mut self, i: usize, pose: &[Quat; JOINT_COUNT], root: Vec3, facing: Vec2, feet: &[Foot; 2]) {
        let i = i % WIDTH;
        self.hips.put(i, pose[0].into());
        self.root.put(i, root);
        self.facing.put(i, facing);
        for side in 0..2 {
            let (legs, foot) = (&mut self.sides[side], &feet[side]);
            for k in 0..4 {
                legs.turns[k].put(i, pose[UPS[side] + k].into());
            }
            legs.ball.put(i, foot.ball);
            legs.ahead.put(i, foot.ahead);
        }
    }

    /// Takes out whoever is at place `i`: the legs into `pose`; returns how high the hips are.
    #[inline(always)]
    pub fn take(&self, i: usize, pose: &mut [Quat; JOINT_COUNT]) -> f32 {
        let i = i % WIDTH;
        for side in 0..2 {
            for k in 0..4 {
                pose[UPS[side] + k] = self.sides[side].turns[k].at(i).into();
            }
        }
        self.root.0[1][i]
    }

    /// Leads the legs of the first `people` to their feet; the hips come down where they have to.
    #[inline(always)]
    pub fn lead(&mut self, people: usize) {
        let joints = &canonical().joints;
        let [left, right] = [Bones::of(joints, UPS[0]), Bones::of(joints, UPS[1])];
        let Self { hips, root, facing, sides: [lefts, rights] } = self;
        for i in 0..people.min(WIDTH) {
            let hanging = (hips.at(i), root.at(i), facing.at(i));
            let left = Leg::new(lefts, i, left, hanging);
            let right = Leg::new(rights, i, right, hanging);
            let lowering = eased(left.lowering().max(right.lowering())).min(LOWERING);
            left.bend(hanging.0, lowering, lefts, i);
            right.bend(hanging.0, lowering, rights, i);
            root.0[1][i] -= lowering;
        }
    }
}

/// The bones of a leg: those of thigh and shin hang straight down at rest.
#[derive(Clone, Copy)]
struct Bones {
    hip: Vec3,
    thigh: f32,
    shin: f32,
    foot: Vec3,
    toes: Vec3,
}

impl Bones {
    #[inline(always)]
    fn of(joints: &[Joint], up: usize) -> Self {
        let (hip, foot) = (joints[up].offset, joints[up + 3].offset);
        let (thigh, shin) = (-joints[up + 1].offset.y, -joints[up + 2].offset.y);
        Self { hip, thigh, shin, foot, toes: joints[up + 3].tip.unwrap_or(Vec3::ZERO) }
    }

    /// From hip to ankle, as far as that may be.
    #[inline(always)]
    fn reach(&self) -> f32 {
        (self.thigh + self.shin) * STRETCH
    }
}

/// A leg, in the world's directions, relative to where its owner is.
#[derive(Clone, Copy)]
struct Leg {
    bones: Bones,
    hip: Vec3,
    /// From the hip to the knee, and from there to the ankle.
    thigh: Vec3,
    shin: Vec3,
    /// Rotations of thigh, shin and toes.
    turns: [Rotation; 3],
    /// Where the ball is to be, and how the foot is to be turned there.
    ball: Vec3,
    foot: Rotation,
    /// Where the ankle is then.
    target: Vec3,
}

/// `need` where it is large, 0 where there is none, without an edge.
#[inline(always)]
fn eased(need: f32) -> f32 {
    let over = (need + EASE).max(0.0);
    if need > EASE { need } else { over * over / (4.0 * EASE) }
}

impl Leg {
    #[inline(always)]
    fn new(side: &Side, i: usize, bones: Bones, (hips, root, facing): (Rotation, Vec3, Vec2)) -> Self {
        let thigh = hips * side.turns[0].at(i);
        let shin = thigh * side.turns[1].at(i);
        let foot = aside(facing, side.ahead.at(i), shin * side.turns[2].at(i));
        let (to_ball, ball) = (foot * bones.foot, side.ball.at(i));
        // A heel that strikes the floor before the ball does not go through it.
        let ball = ball + Vec3::Y * (HEEL - (ball.y - to_ball.y)).max(0.0);
        let (down, turns) = (Vec3::NEG_Y, [thigh, shin, foot * side.turns[3].at(i)]);
        let (thigh, shin) = (thigh * down * bones.thigh, shin * down * bones.shin);
        Self { bones, hip: root + hips * bones.hip, thigh, shin, turns, ball, foot, target: ball - to_ball }
    }

    /// How far the hips should come down for the foot to be in reach; negative where it is nearer than that.
    #[inline(always)]
    fn lowering(&self) -> f32 {
        let (reach, way) = (self.bones.reach(), self.target - self.hip);
        -way.y - (reach * reach - way.x * way.x - way.z * way.z).max(0.0).sqrt()
    }

    /// Writes its rotations, each relative to the one before, when the hips have come down.
    #[inline(always)]
    fn bend(mut self, hips: Rotation, lowering: f32, side: &mut Side, i: usize) {
        self.hip.y -= lowering;
        let foot = self.lifted() * self.foot;
        self.target = self.ball - foot * self.bones.foot;
        let [thigh, shin] = self.reached();
        side.turns[0].put(i, hips.back() * thigh);
        side.turns[1].put(i, thigh.back() * shin);
        side.turns[2].put(i, shin.back() * foot);
        side.turns[3].put(i, (foot.back() * self.toes()).normalized());
    }

    /// How the foot is turned about its ball for the ankle to be in reach, as far as it goes: by the angle at the ball between where
    /// the ankle is and where it should be.
    #[inline(always)]
    fn lifted(&self) -> Rotation {
        let (ankle, hip, reach) = (self.target - self.ball, self.hip - self.ball, self.bones.reach());
        let (squares, axis) = (ankle.length_squared() + hip.length_squared(), ankle.cross(hip));
        let (area, product) = (axis.length(), ankle.length() * hip.length());
        let cosine = (0.5 * (squares - reach * reach)).max(-product).min(product);
        let sine = (product * product - cosine * cosine).max(0.0).sqrt();
        let scale = 1.0 / (product * product).max(TINY);
        let by = Opening::new([cosine, sine], [ankle.dot(hip), area], scale);
        // Not too far, and not down.
        let (cosine, sine) = if by.cosine < LIFT.0 { LIFT } else { (by.cosine, by.sine) };
        let (cosine, sine) = if by.sine > 0.0 { (cosine, sine) } else { (1.0, 0.0) };
        Rotation::about(axis * (1.0 / area.max(TINY)), cosine, sine)
    }

    /// Rotations of thigh and shin that bring the ankle to its target: the knee opens or closes about its hinge, then all of the leg
    /// swings.
    #[inline(always)]
    fn reached(&self) -> [Rotation; 2] {
        let (thigh, shin, way) = (self.thigh, self.shin, self.target - self.hip);
        let (a, b) = (self.bones.thigh, self.bones.shin);
        let (a2, b2, now) = (a * a, b * b, (thigh + shin).length_squared());
        let (most, far) = ((a + b) * 0.9999, way.length());
        let reach = far.max(0.1).min(most);
        let then = reach * reach;
        // Of the triangles of hip, knee and ankle before and after: twice their areas, and products of sides with cosines between.
        let cross = thigh.cross(shin);
        let before = Triangle { area: cross.length(), hip: 0.5 * (a2 + now - b2), ankle: 0.5 * (b2 + now - a2) };
        let hip = 0.5 * (a2 + then - b2);
        let after = Triangle { area: (a2 * then - hip * hip).max(0.0).sqrt(), hip, ankle: 0.5 * (b2 + then - a2) };
        let hinge = cross + self.turns[0] * Vec3::X * (STRAIGHT * a * b);
        let hinge = hinge * (1.0 / hinge.length().max(TINY));
        let scale = 1.0 / (now.sqrt() * reach).max(TINY);
        let open = Opening::new([after.hip, after.area], [before.hip, before.area], scale / a2);
        let close = Opening::new([before.ankle, before.area], [after.ankle, after.area], scale / b2);
        let from = open.turned(hinge, thigh) + close.turned(hinge, shin);
        let swing = Rotation { axis: from.cross(way), cosine: (reach * far + from.dot(way)).max(1e-6) };
        [
            (swing * open.rotation(hinge) * self.turns[0]).normalized(),
            (swing * close.rotation(hinge) * self.turns[1]).normalized(),
        ]
    }

    /// How the toes are turned: as they were, but not into the floor.
    #[inline(always)]
    fn toes(&self) -> Rotation {
        let turn = self.turns[2];
        let tip = turn * self.bones.toes;
        let scale = 1.0 / tip.length().max(TINY);
        let now = (tip.y * scale).clamp(-1.0, 1.0);
        let then = now.max(((-TOES - self.ball.y) * scale).min(1.0));
        let up = Opening::new([cosine(now), now], [cosine(then), then], 1.0);
        // About the level axis at right angles to the tip.
        let across = 1.0 / (tip.x * tip.x + tip.z * tip.z).max(TINY).sqrt();
        Rotation::about(Vec3::new(-tip.z * across, 0.0, tip.x * across), up.cosine, up.sine) * turn
    }
}

/// A leg's triangle: twice its area, and products of the sides at the hip and at the ankle with the cosine between them.
struct Triangle {
    area: f32,
    hip: f32,
    ankle: f32,
}

/// How far something turns: cosine and sine.
struct Opening {
    cosine: f32,
    sine: f32,
}

impl Opening {
    /// From one angle to another, given as cosines and sines times lengths, and one over the product of these.
    #[inline(always)]
    fn new([from, from_sine]: [f32; 2], [to, to_sine]: [f32; 2], scale: f32) -> Self {
        Self { cosine: (from * to + from_sine * to_sine) * scale, sine: (to_sine * from - to * from_sine) * scale }
    }

    /// A direction at right angles to the hinge, turned.
    #[inline(always)]
    fn turned(&self, hinge: Vec3, direction: Vec3) -> Vec3 {
        direction * self.cosine + hinge.cross(direction) * self.sine
    }

    /// As a rotation; not as long as one.
    #[inline(always)]
    fn rotation(&self, hinge: Vec3) -> Rotation {
        Rotation { axis: hinge * self.sine, cosine: 1.0 + self.cosine }
    }
}

/// Of the slope that has this sine.
#[inline(always)]
fn cosine(sine: f32) -> f32 {
    (1.0 - sine * sine).max(0.0).sqrt()
}

/// `rotation`, turned about the vertical from where its body looks to where its foot looks.
#[inline(always)]
fn aside(facing: Vec2, ahead: Vec2, rotation: Rotation) -> Rotation {
    let (sine, cosine) = (ahead.x * facing.y - ahead.y * facing.x, ahead.dot(facing));
    // Of half the angle. A foot that looked straight back would be on the wrong leg.
    let half = ((sine * sine + cosine * cosine).sqrt() + cosine).max(1e-3);
    let scale = 1.0 / (half * half + sine * sine).sqrt();
    about_vertical(half * scale, sine * scale, rotation)
}

/// `rotation`, then a turn about the vertical of which cosine and sine of half the angle are given.
#[inline(always)]
pub(super) fn about_vertical(c: f32, s: f32, Rotation { axis, cosine: w }: Rotation) -> Rotation {
    let Vec3 { x, y, z } = axis;
    Rotation { axis: Vec3::new(c * x + s * z, c * y + s * w, c * z - s * x), cosine: c * w - s * y }
}
