//! A pose whose legs reach the feet.
//!
//! A leg that would have to be longer than it is does what people do: the hips come down a little, then the heel comes up
//! while the ball of the foot stays. Toes do not go through the floor.

use glam::{Quat, Vec2, Vec3};

use super::feet::Foot;
use crate::motion::{JOINT_COUNT, canonical, joint};

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

/// A leg, in the world's directions, relative to where its owner is.
struct Leg {
    up: usize,
    hip: Vec3,
    knee: Vec3,
    ankle: Vec3,
    /// Rotations of thigh, shin, foot and toes.
    turns: [Quat; 4],
    /// Where the ball is to be, and how the foot is to be turned there.
    ball: Vec3,
    foot: Quat,
}

/// Leads the legs of a `pose` (its hips turned in the world, at `root`) to the `feet`; returns by how much the hips come down.
/// `turn` is where the body looks.
pub(super) fn lead(pose: &mut [Quat; JOINT_COUNT], root: Vec3, turn: Quat, feet: &[Foot; 2]) -> f32 {
    let mut legs = [
        Leg::new(pose, root, turn, joint::LEFT_UP_LEG, &feet[0]),
        Leg::new(pose, root, turn, joint::RIGHT_UP_LEG, &feet[1]),
    ];
    let lowering = eased(legs[0].lowering().max(legs[1].lowering())).min(LOWERING);
    for leg in &mut legs {
        leg.hip.y -= lowering;
        leg.knee.y -= lowering;
        leg.ankle.y -= lowering;
        leg.bend(pose);
    }
    lowering
}

/// `need` where it is large, 0 where there is none, without an edge.
fn eased(need: f32) -> f32 {
    let over = (need + EASE).max(0.0);
    if need > EASE { need } else { over * over / (4.0 * EASE) }
}

impl Leg {
    #[inline]
    fn new(pose: &[Quat; JOINT_COUNT], root: Vec3, turn: Quat, up: usize, foot: &Foot) -> Self {
        let joints = &canonical().joints;
        let thigh = pose[0] * pose[up];
        let shin = thigh * pose[up + 1];
        let own = shin * pose[up + 2];
        let hip = root + pose[0] * joints[up].offset;
        let knee = hip + thigh * joints[up + 1].offset;
        let ankle = knee + shin * joints[up + 2].offset;
        let aside = aside(turn, foot.ahead);
        let turned = aside * own;
        let mut ball = foot.ball;
        // A heel that strikes the floor before the ball does not go through it.
        ball.y += (HEEL - (ball.y - (turned * joints[up + 3].offset).y)).max(0.0);
        Self { up, hip, knee, ankle, turns: [thigh, shin, turned, turned * pose[up + 3]], ball, foot: turned }
    }

    #[inline]
    fn target(&self) -> Vec3 {
        self.ball - self.foot * canonical().joints[self.up + 3].offset
    }

    #[inline]
    fn reach(&self) -> f32 {
        let joints = &canonical().joints;
        (joints[self.up + 1].offset.y + joints[self.up + 2].offset.y).abs() * STRETCH
    }

    #[inline]
    /// How far the hips should come down for the foot to be in reach; negative where it is nearer than that.
    fn lowering(&self) -> f32 {
        let (target, reach) = (self.target(), self.reach());
        let across = (target - self.hip).with_y(0.0).length_squared();
        self.hip.y - target.y - (reach * reach - across).max(0.0).sqrt()
    }

    /// Turns the foot about its ball until the ankle is in reach, as far as it goes.
    fn lift_heel(&mut self) {
        let (target, reach) = (self.target(), self.reach());
        let (bone, to_hip) = (target - self.ball, self.hip - self.ball);
        if target.distance_squared(self.hip) <= reach * reach {
            return;
        }
        let (foot, whole) = (bone.length(), to_hip.length());
        let cosine = (foot * foot + whole * whole - reach * reach) / (2.0 * foot * whole);
        let angle = (bone.angle_between(to_hip) - cosine.clamp(-1.0, 1.0).acos()).clamp(0.0, LIFT);
        let axis = bone.cross(to_hip).normalize_or_zero();
        self.foot = Quat::from_axis_angle(if axis == Vec3::ZERO { Vec3::X } else { axis }, angle) * self.foot;
    }

    fn bend(&mut self, pose: &mut [Quat; JOINT_COUNT]) {
        let flat = self.foot;
        self.lift_heel();
        let [thigh, shin] = self.reached();
        let (up, toes) = (self.up, self.toes());
        pose[up] = pose[0].conjugate() * thigh;
        pose[up + 1] = thigh.conjugate() * shin;
        pose[up + 2] = shin.conjugate() * self.foot;
        if toes != self.turns[3] || self.foot != flat {
            pose[up + 3] = (self.foot.conjugate() * toes).normalize();
        }
    }

    /// Rotations of thigh and shin that bring the ankle to its target: the knee opens or closes about its hinge, then all of the leg
    /// swings. A few square roots and nothing else: this runs for everybody in every frame.
    #[inline]
    fn reached(&self) -> [Quat; 2] {
        let (thigh, shin, way) = (self.knee - self.hip, self.ankle - self.knee, self.target() - self.hip);
        let joints = &canonical().joints;
        let (a, b) = (joints[self.up + 1].offset.length(), joints[self.up + 2].offset.length());
        let (a2, b2, now) = (a * a, b * b, (thigh + shin).length_squared());
        let (most, far) = ((a + b) * 0.9999, way.length());
        let reach = far.clamp(0.1, most);
        let then = reach * reach;
        // Of the triangles of hip, knee and ankle before and after: twice their areas, and products of sides with cosines between.
        let cross = thigh.cross(shin);
        let before = Triangle { area: cross.length(), hip: 0.5 * (a2 + now - b2), ankle: 0.5 * (b2 + now - a2) };
        let hip = 0.5 * (a2 + then - b2);
        let after = Triangle { area: (a2 * then - hip * hip).max(0.0).sqrt(), hip, ankle: 0.5 * (b2 + then - a2) };
        let hinge = (cross + self.turns[0] * Vec3::X * (STRAIGHT * a * b)).normalize_or(Vec3::X);
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

    #[inline]
    /// How the toes are turned: as they were, but not into the floor.
    fn toes(&self) -> Quat {
        let turn = self.turns[3];
        let tip = turn * canonical().joints[self.up + 3].tip.unwrap_or(Vec3::ZERO);
        let lowest = -TOES - self.ball.y;
        if tip.y >= lowest {
            return turn;
        }
        let slope = |y: f32| (y / tip.length()).clamp(-1.0, 1.0).asin();
        let axis = tip.cross(Vec3::Y).try_normalize().unwrap_or(turn * Vec3::NEG_X);
        Quat::from_axis_angle(axis, slope(lowest) - slope(tip.y)) * turn
    }
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
    #[inline]
    fn new([from, from_sine]: [f32; 2], [to, to_sine]: [f32; 2], whole: f32) -> Self {
        let scale = 1.0 / whole.max(1e-12);
        Self { cosine: (from * to + from_sine * to_sine) * scale, sine: (to_sine * from - to * from_sine) * scale }
    }

    /// A direction at right angles to the hinge, turned.
    #[inline]
    fn turned(&self, hinge: Vec3, direction: Vec3) -> Vec3 {
        direction * self.cosine + hinge.cross(direction) * self.sine
    }

    /// As a rotation; not as long as one.
    #[inline]
    fn rotation(&self, hinge: Vec3) -> Quat {
        Quat::from_vec4((hinge * self.sine).extend(1.0 + self.cosine))
    }
}

/// The turn about the vertical from where a body looks to where its foot looks.
fn aside(turn: Quat, ahead: Vec2) -> Quat {
    let body = turn * Vec3::Z;
    let (sine, cosine) = (ahead.x * body.z - ahead.y * body.x, ahead.x * body.x + ahead.y * body.z);
    let length = (sine * sine + cosine * cosine).sqrt();
    // Of half the angle. A foot that looked straight back would be on the wrong leg.
    Quat::from_xyzw(0.0, sine, 0.0, (length + cosine).max(1e-3)).normalize()
}
