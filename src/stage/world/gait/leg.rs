//! A pose whose legs reach the feet.
//!
//! A leg that would have to be longer than it is does what people do: the hips come down a little, then the heel comes up
//! while the ball of the foot stays. Toes do not go through the floor.

use glam::{Quat, Vec2, Vec3, Vec3A};

use super::feet::Foot;
use crate::motion::{JOINT_COUNT, Joint, canonical, joint};

/// Largest part of a leg's length that is used, so that knees never lock.
const STRETCH: f32 = 0.995;
/// Most that hips come down before heels come up, metres.
const LOWERING: f32 = 0.045;
/// Over so many metres the hips begin to come down.
const EASE: f32 = 0.012;
/// Most that a heel is lifted, as a turn of the foot about its ball, radians.
const LIFT: f32 = 0.45;
/// Height below which an ankle's heel would be in the floor, metres.
const HEEL: f32 = 0.06;
/// The hinge of a knee that is bent less than this (its sine) is as much that which its thigh has at rest.
const STRAIGHT: f32 = 0.1;
/// How far the tips of toes may sink into the floor, metres.
const TOES: f32 = 0.005;

/// The bones of a leg: those of thigh and shin hang straight down at rest.
#[derive(Clone, Copy)]
struct Bones {
    hip: Vec3A,
    thigh: f32,
    shin: f32,
    foot: Vec3A,
    toes: Vec3A,
}

impl Bones {
    #[inline(always)]
    fn of(joints: &[Joint], up: usize) -> Self {
        let (hip, foot) = (joints[up].offset.into(), joints[up + 3].offset.into());
        let (thigh, shin) = (-joints[up + 1].offset.y, -joints[up + 2].offset.y);
        Self { hip, thigh, shin, foot, toes: joints[up + 3].tip.unwrap_or(Vec3::ZERO).into() }
    }

    /// From hip to ankle, as far as that may be.
    #[inline(always)]
    fn reach(&self) -> f32 {
        (self.thigh + self.shin) * STRETCH
    }
}

/// A leg, in the world's directions, relative to where its owner is.
struct Leg {
    up: usize,
    bones: Bones,
    hip: Vec3A,
    /// From the hip to the knee, and from there to the ankle.
    thigh: Vec3A,
    shin: Vec3A,
    /// Rotations of thigh, shin, foot and toes.
    turns: [Quat; 4],
    /// Where the ball is to be, and how the foot is to be turned there.
    ball: Vec3A,
    foot: Quat,
    /// Where the ankle is then.
    target: Vec3A,
}

/// Leads the legs of a `pose` (its hips turned in the world, at `root`) to the `feet`; returns by how much the hips come down.
/// `facing` is where the body looks, as x and z.
#[inline(always)]
pub(super) fn lead(pose: &mut [Quat; JOINT_COUNT], root: Vec3, facing: Vec2, feet: &[Foot; 2]) -> f32 {
    let joints = &canonical().joints;
    let [left, right] = [joint::LEFT_UP_LEG, joint::RIGHT_UP_LEG];
    let first = Leg::new(pose, Bones::of(joints, left), root.into(), facing, left, &feet[0]);
    let second = Leg::new(pose, Bones::of(joints, right), root.into(), facing, right, &feet[1]);
    let lowering = eased(first.lowering().max(second.lowering())).min(LOWERING);
    first.bend(pose, lowering);
    second.bend(pose, lowering);
    lowering
}

/// `need` where it is large, 0 where there is none, without an edge.
#[inline(always)]
fn eased(need: f32) -> f32 {
    let over = (need + EASE).max(0.0);
    if need > EASE { need } else { over * over / (4.0 * EASE) }
}

impl Leg {
    #[inline(always)]
    fn new(pose: &[Quat; JOINT_COUNT], bones: Bones, root: Vec3A, facing: Vec2, up: usize, foot: &Foot) -> Self {
        let thigh = pose[0] * pose[up];
        let shin = thigh * pose[up + 1];
        let own = shin * pose[up + 2];
        let hip = root + pose[0] * bones.hip;
        let turned = aside(facing, foot.ahead, own);
        let (to_ball, ball) = (turned * bones.foot, Vec3A::from(foot.ball));
        // A heel that strikes the floor before the ball does not go through it.
        let ball = ball + Vec3A::Y * (HEEL - (ball.y - to_ball.y)).max(0.0);
        let (down, turns) = (Vec3A::NEG_Y, [thigh, shin, turned, turned * pose[up + 3]]);
        let (thigh, shin) = (thigh * down * bones.thigh, shin * down * bones.shin);
        Self { up, bones, hip, thigh, shin, turns, ball, foot: turned, target: ball - to_ball }
    }

    /// How far the hips should come down for the foot to be in reach; negative where it is nearer than that.
    #[inline(always)]
    fn lowering(&self) -> f32 {
        let (reach, way) = (self.bones.reach(), self.target - self.hip);
        let across = way.length_squared() - way.y * way.y;
        -way.y - (reach * reach - across).max(0.0).sqrt()
    }

    /// The foot, turned about its ball until the ankle is in reach, as far as it goes.
    #[inline(always)]
    fn lifted(&self) -> Quat {
        let reach = self.bones.reach();
        if self.target.distance_squared(self.hip) <= reach * reach {
            return self.foot;
        }
        lift(self.foot, self.target - self.ball, self.hip - self.ball, reach)
    }

    #[inline(always)]
    fn bend(mut self, pose: &mut [Quat; JOINT_COUNT], lowering: f32) {
        self.hip -= Vec3A::Y * lowering;
        let foot = self.lifted();
        if foot != self.foot {
            self.target = self.ball - foot * self.bones.foot;
        }
        let [thigh, shin] = self.reached();
        let (up, toes) = (self.up, self.toes());
        pose[up] = pose[0].conjugate() * thigh;
        pose[up + 1] = thigh.conjugate() * shin;
        pose[up + 2] = shin.conjugate() * foot;
        if toes != self.turns[3] || foot != self.foot {
            pose[up + 3] = (foot.conjugate() * toes).normalize();
        }
    }

    /// Rotations of thigh and shin that bring the ankle to its target: the knee opens or closes about its hinge, then all of the leg
    /// swings. A few square roots and nothing else: this runs for everybody in every frame.
    #[inline(always)]
    fn reached(&self) -> [Quat; 2] {
        let (thigh, shin, way) = (self.thigh, self.shin, self.target - self.hip);
        let (a, b) = (self.bones.thigh, self.bones.shin);
        let (a2, b2, now) = (a * a, b * b, (thigh + shin).length_squared());
        let (most, far) = ((a + b) * 0.9999, way.length());
        let reach = far.clamp(0.1, most);
        let then = reach * reach;
        // Of the triangles of hip, knee and ankle before and after: twice their areas, and products of sides with cosines between.
        let cross = thigh.cross(shin);
        let before = Triangle { area: cross.length(), hip: 0.5 * (a2 + now - b2), ankle: 0.5 * (b2 + now - a2) };
        let hip = 0.5 * (a2 + then - b2);
        let after = Triangle { area: (a2 * then - hip * hip).max(0.0).sqrt(), hip, ankle: 0.5 * (b2 + then - a2) };
        let hinge = (cross + self.turns[0] * Vec3A::X * (STRAIGHT * a * b)).normalize_or(Vec3A::X);
        let whole = now.sqrt() * reach;
        let open = Opening::new([after.hip, after.area], [before.hip, before.area], a2 * whole);
        let close = Opening::new([before.ankle, before.area], [after.ankle, after.area], b2 * whole);
        let from = open.turned(hinge, thigh) + close.turned(hinge, shin);
        let swing = Quat::from_vec4(from.cross(way).extend((reach * far + from.dot(way)).max(1e-6)));
        [
            (swing * open.rotation(hinge) * self.turns[0]).normalize(),
            (swing * close.rotation(hinge) * self.turns[1]).normalize(),
        ]
    }

    /// How the toes are turned: as they were, but not into the floor.
    #[inline(always)]
    fn toes(&self) -> Quat {
        let (turn, lowest) = (self.turns[3], -TOES - self.ball.y);
        if height(turn).dot(self.bones.toes) >= lowest {
            return turn;
        }
        let tip = turn * self.bones.toes;
        let slope = |y: f32| (y / tip.length()).clamp(-1.0, 1.0).asin();
        let axis = tip.cross(Vec3A::Y).try_normalize().unwrap_or(turn * Vec3A::NEG_X);
        Quat::from_axis_angle(axis.into(), slope(lowest) - slope(tip.y)) * turn
    }
}

/// A foot turned about its ball, from where its `ankle` is and the `hip`, until they are `reach` apart. Not inlined: else all of a leg
/// would lie in memory for it.
#[inline(never)]
fn lift(foot: Quat, ankle: Vec3A, hip: Vec3A, reach: f32) -> Quat {
    let (own, whole) = (ankle.length(), hip.length());
    let cosine = (own * own + whole * whole - reach * reach) / (2.0 * own * whole);
    let angle = (ankle.angle_between(hip) - cosine.clamp(-1.0, 1.0).acos()).clamp(0.0, LIFT);
    let axis = ankle.cross(hip).try_normalize().map_or(Vec3::X, Vec3::from);
    Quat::from_axis_angle(axis, angle) * foot
}

/// A leg's triangle: twice its area, and products of the sides at the hip and at the ankle with the cosine between them.
struct Triangle {
    area: f32,
    hip: f32,
    ankle: f32,
}

/// How far a joint turns about its hinge: cosine and sine.
struct Opening {
    cosine: f32,
    sine: f32,
}

impl Opening {
    /// From one angle to another, given as cosines and sines times lengths whose product is `whole`.
    #[inline(always)]
    fn new([from, from_sine]: [f32; 2], [to, to_sine]: [f32; 2], whole: f32) -> Self {
        let scale = 1.0 / whole.max(1e-12);
        Self { cosine: (from * to + from_sine * to_sine) * scale, sine: (to_sine * from - to * from_sine) * scale }
    }

    /// A direction at right angles to the hinge, turned.
    #[inline(always)]
    fn turned(&self, hinge: Vec3A, direction: Vec3A) -> Vec3A {
        direction * self.cosine + hinge.cross(direction) * self.sine
    }

    /// As a rotation; not as long as one.
    #[inline(always)]
    fn rotation(&self, hinge: Vec3A) -> Quat {
        Quat::from_vec4((hinge * self.sine).extend(1.0 + self.cosine))
    }
}

/// `rotation`, turned about the vertical from where its body looks to where its foot looks.
#[inline(always)]
fn aside(facing: Vec2, ahead: Vec2, rotation: Quat) -> Quat {
    let (sine, cosine) = (ahead.x * facing.y - ahead.y * facing.x, ahead.dot(facing));
    // Of half the angle. A foot that looked straight back would be on the wrong leg.
    let half = Vec2::new((sine * sine + cosine * cosine).sqrt() + cosine, sine);
    about_vertical(Vec2::new(half.x.max(1e-3), half.y).normalize(), rotation)
}

/// `rotation`, then a turn about the vertical of which cosine and sine of half the angle are given.
#[inline(always)]
pub(super) fn about_vertical(half: Vec2, rotation: Quat) -> Quat {
    let ((c, s), [x, y, z, w]) = ((half.x, half.y), rotation.to_array());
    Quat::from_xyzw(c * x + s * z, c * y + s * w, c * z - s * x, c * w - s * y)
}

/// How high a rotation leads each of the axes.
#[inline(always)]
fn height(q: Quat) -> Vec3A {
    Vec3A::new(2.0 * (q.x * q.y + q.w * q.z), 1.0 - 2.0 * (q.x * q.x + q.z * q.z), 2.0 * (q.y * q.z - q.w * q.x))
}
