//! One leg onto its planted foot. A leg that would have to be longer than it is does what people do: the hips come
//! down a little, the heel comes up while the ball of the foot stays, and only then the hips come down further.

use glam::{Quat, Vec3};

use crate::motion::ik::two_bone;
use crate::motion::limits::{excess, hold_back};
use crate::motion::{JOINT_COUNT, canonical};

/// Largest part of a leg's length that is used, so that knees never lock.
const LEG_STRETCH: f32 = 0.995;
/// How far the tips of toes may sink into the floor, metres.
const TOE_SLACK: f32 = 0.005;
/// How much further they may sink in before the foot comes up, metres.
const TOE_SINKING: f32 = 0.008;
/// A foot that falls short of its place by more than this is told, metres.
const MAX_MISS: f32 = 0.003;
/// A hip that is turned further beyond its limits than before by more than this is told, radians.
const MAX_OVERTURN: f32 = 2.0 / 180.0 * std::f32::consts::PI;
/// Hips come down by this much before a heel comes up, metres.
const EASY_LOWERING: f32 = 0.045;
/// Most that hips are lowered, metres.
const MAX_LOWERING: f32 = 0.10;
/// Most that a heel is lifted, as a turn of the foot about its ball, radians.
const MAX_LIFT: f32 = 25.0 / 180.0 * std::f32::consts::PI;

/// Where a leg is and where its foot is to stand, in the world.
#[derive(Clone, Copy)]
pub(super) struct Leg {
    hip: Vec3,
    ankle: Vec3,
    ball: Vec3,
    reach: f32,
}

impl Leg {
    /// The leg that ends at joint `ankle`, its foot moved by `shift`.
    pub fn new(globals: &[(Vec3, Quat)], ankle: usize, shift: Vec3) -> Self {
        let joints = &canonical().joints;
        let length = joints[ankle].offset.length() + joints[ankle - 1].offset.length();
        Self {
            hip: globals[ankle - 2].0,
            ankle: globals[ankle].0 + shift,
            ball: globals[ankle + 1].0 + shift,
            reach: length * LEG_STRETCH,
        }
    }

    /// How far the hips should come down for the foot to be in reach, metres.
    pub fn lowering(&self) -> f32 {
        let flat = self.lowering_to(self.ankle);
        if flat <= EASY_LOWERING {
            return flat.max(0.0);
        }
        let lifted = self.ball + self.lift(MAX_LIFT) * (self.ankle - self.ball);
        self.lowering_to(lifted).clamp(EASY_LOWERING, MAX_LOWERING)
    }

    fn lowering_to(&self, ankle: Vec3) -> f32 {
        let across = (ankle - self.hip).with_y(0.0).length_squared();
        self.hip.y - ankle.y - (self.reach * self.reach - across).max(0.0).sqrt()
    }

    /// The turn of the foot about its ball that brings the ankle in reach: none where it is.
    fn heel_lift(&self) -> Quat {
        let (foot, whole) = (self.ankle.distance(self.ball), self.hip.distance(self.ball));
        if self.hip.distance(self.ankle) <= self.reach {
            return Quat::IDENTITY;
        }
        let now = (self.ankle - self.ball).angle_between(self.hip - self.ball);
        let cosine = (foot * foot + whole * whole - self.reach * self.reach) / (2.0 * foot * whole);
        self.lift((now - cosine.clamp(-1.0, 1.0).acos()).clamp(0.0, MAX_LIFT))
    }

    /// The leg with its ball in place and the foot turned to `foot`; `globals` are the joints before.
    fn bend(&self, globals: &[(Vec3, Quat)], ankle: usize, foot: Quat) -> Bent {
        let (up, knee) = (globals[ankle - 2], globals[ankle - 1]);
        let target = self.ball + foot * globals[ankle].1.inverse() * (self.ankle - self.ball);
        let pole = up.1 * Vec3::Z;
        let (swing, bend, reached) = two_bone(self.hip, knee.0, globals[ankle].0, target, pole, 0.9999);
        Bent { up: swing * up.1, knee: swing * bend * knee.1, missed: reached.distance(target) }
    }

    /// The turn by `angle` that moves the ankle about the ball towards the hip.
    fn lift(&self, angle: f32) -> Quat {
        let axis = (self.ankle - self.ball).cross(self.hip - self.ball);
        axis.try_normalize().map_or(Quat::IDENTITY, |axis| Quat::from_axis_angle(axis, angle))
    }
}

/// How well a leg did what was asked of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planted {
    /// How far the foot falls short of its place, metres.
    missed: f32,
    /// How much further beyond its limits the hip or the knee is turned than before, radians.
    overturned: f32,
}

impl Planted {
    /// True if no leg could do it: another way has to be found.
    pub fn is_strained(&self) -> bool {
        self.missed > MAX_MISS || self.overturned > MAX_OVERTURN
    }
}

/// A leg led to its foot: rotations in the world, and how far it falls short, metres.
struct Bent {
    up: Quat,
    knee: Quat,
    missed: f32,
}

/// Moves a foot by `shift`, lifting its heel where the leg is too short. `globals` are the pose's joints in the world before. An ankle that would turn beyond its limits, and beyond what it
/// was, takes the foot with it, about the ball.
pub(super) fn plant(pose: &mut [Quat], globals: &[(Vec3, Quat)], ankle: usize, shift: Vec3) -> Planted {
    debug_assert_eq!(pose.len(), JOINT_COUNT);
    let leg = Leg::new(globals, ankle, shift);
    let mut foot = leg.heel_lift() * globals[ankle].1;
    let mut bent = leg.bend(globals, ankle, foot);
    let turn = (bent.knee.inverse() * foot).normalize();
    let held = hold_back(ankle, turn, || excess(ankle, pose[ankle]));
    if held != turn {
        foot = (bent.knee * held).normalize();
        bent = leg.bend(globals, ankle, foot);
    }
    let (up, knee, toe) = (ankle - 2, ankle - 1, ankle + 1);
    let overturned =
        [turn_to(pose, up, globals[0].1.inverse() * bent.up), turn_to(pose, knee, bent.up.inverse() * bent.knee)];
    pose[ankle] = (bent.knee.inverse() * foot).normalize();
    // The toes stay on the floor, as far as they bend.
    let flat = (foot.inverse() * globals[toe].1).normalize();
    pose[toe] = hold_back(toe, flat, || excess(toe, pose[toe]));
    Planted { missed: bent.missed, overturned: overturned[0].max(overturned[1]) }
}

/// Turns a joint, and answers how much further it is beyond its limits than before, if that is much, radians.
fn turn_to(pose: &mut [Quat], joint: usize, to: Quat) -> f32 {
    let to = to.normalize();
    let over = excess(joint, to);
    let before = std::mem::replace(&mut pose[joint], to);
    if over > MAX_OVERTURN { over - excess(joint, before) } else { 0.0 }
}

/// Bends the toes up where their tip would be more than [`TOE_SLACK`] below the floor once the foot is moved up by
/// `raise`; returns by how much more the foot must come up where toes would have to bend further than they can, metres.
pub(super) fn lift_toes(pose: &mut [Quat], globals: &mut [(Vec3, Quat)], ankle: usize, raise: f32) -> f32 {
    let toe = ankle + 1;
    let (ball, turn) = globals[toe];
    let tip = turn * canonical().joints[toe].tip.expect("toes have tips");
    let lowest = -TOE_SLACK - (ball.y + raise);
    if tip.y >= lowest {
        return 0.0;
    }
    let slope = |y: f32| (y / tip.length()).clamp(-1.0, 1.0).asin();
    let axis = tip.cross(Vec3::Y).try_normalize().unwrap_or(turn * Vec3::NEG_X);
    let lifted = Quat::from_axis_angle(axis, slope(lowest) - slope(tip.y)) * turn;
    let bent = (globals[ankle].1.inverse() * lifted).normalize();
    pose[toe] = hold_back(toe, bent, || excess(toe, pose[toe]));
    globals[toe].1 = (globals[ankle].1 * pose[toe]).normalize();
    // Toes that would have to bend further than they can sink in a little.
    (lowest - TOE_SINKING - (globals[toe].1 * canonical().joints[toe].tip.expect("toes have tips")).y).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::joint::LEFT_FOOT;

    type Globals = Vec<(Vec3, Quat)>;

    /// A person at rest with the left foot to be moved by `shift`: what is missed, and the joints after.
    fn planted(shift: Vec3) -> (Planted, Globals, Globals) {
        let mut pose = [Quat::IDENTITY; JOINT_COUNT];
        let root = canonical().joints[0].offset;
        let (mut before, mut after) = (Vec::new(), Vec::new());
        canonical().globals(root, &pose, &mut before);
        let planted = plant(&mut pose, &before, LEFT_FOOT, shift);
        canonical().globals(root, &pose, &mut after);
        (planted, before, after)
    }

    #[test]
    fn a_foot_in_reach_moves_as_it_is() {
        let shift = Vec3::new(0.02, 0.06, 0.1);
        let (planted, before, after) = planted(shift);
        assert!(planted.missed < 1e-4 && !planted.is_strained(), "{planted:?}");
        assert!((after[LEFT_FOOT].0 - before[LEFT_FOOT].0 - shift).length() < 1e-4);
        assert!(after[LEFT_FOOT].1.angle_between(before[LEFT_FOOT].1) < 1e-3);
    }

    #[test]
    fn a_heel_comes_up_where_the_leg_is_too_short_and_the_ball_stays() {
        let shift = Vec3::new(0.0, 0.0, -0.3);
        let (planted, before, after) = planted(shift);
        assert!(planted.missed < 1e-3, "{planted:?}");
        let (ball, toe) = (LEFT_FOOT + 1, LEFT_FOOT + 1);
        assert!((after[ball].0 - before[ball].0 - shift).length() < 1e-3);
        assert!(after[LEFT_FOOT].0.y > before[LEFT_FOOT].0.y + 0.01, "the heel did not come up");
        assert!(after[toe].1.angle_between(before[toe].1) < 1e-3, "the toes turned");
    }

    #[test]
    fn an_ankle_that_turns_too_far_takes_the_foot_along_about_its_ball() {
        let mut pose = [Quat::IDENTITY; JOINT_COUNT];
        pose[LEFT_FOOT] = Quat::from_rotation_x(-1.2);
        let (shift, mut before, mut after) = (Vec3::new(0.0, 0.1, -0.45), Globals::new(), Globals::new());
        let root = canonical().joints[0].offset;
        canonical().globals(root, &pose, &mut before);
        let knee = Leg::new(&before, LEFT_FOOT, shift).bend(&before, LEFT_FOOT, before[LEFT_FOOT].1).knee;
        let unheld = excess(LEFT_FOOT, knee.inverse() * before[LEFT_FOOT].1);
        assert!(unheld > 0.1, "the test turns nothing too far: {unheld}");
        let missed = plant(&mut pose, &before, LEFT_FOOT, shift).missed;
        canonical().globals(root, &pose, &mut after);
        let ball = LEFT_FOOT + 1;
        assert!(missed < 1e-3 && after[ball].0.distance(before[ball].0 + shift) < 2e-3, "{missed}");
        let held = excess(LEFT_FOOT, pose[LEFT_FOOT]);
        assert!(held < 0.35 * unheld, "{held} after {unheld}");
    }

    #[test]
    fn toes_do_not_go_through_the_floor() {
        let mut pose = [Quat::IDENTITY; JOINT_COUNT];
        pose[LEFT_FOOT] = Quat::from_rotation_x(0.5);
        let root = canonical().joints[0].offset;
        let mut globals = Vec::new();
        canonical().globals(root, &pose, &mut globals);
        let toe = LEFT_FOOT + 1;
        let tip = canonical().joints[toe].tip.unwrap();
        let raise = -globals[toe].0.y + 0.01;
        assert!(globals[toe].0.y + raise + (globals[toe].1 * tip).y < -0.01, "the test sinks nothing");
        assert_eq!(lift_toes(&mut pose, &mut globals, LEFT_FOOT, raise), 0.0);
        canonical().globals(root, &pose, &mut globals);
        let height = globals[toe].0.y + raise + (globals[toe].1 * tip).y;
        assert!((height + TOE_SLACK).abs() < 1e-4, "{height}");
    }

    #[test]
    fn a_foot_comes_up_for_toes_that_bend_no_further() {
        let root = canonical().joints[0].offset;
        let tip = |globals: &[(Vec3, Quat)]| globals[LEFT_FOOT + 1].1 * canonical().joints[LEFT_FOOT + 1].tip.unwrap();
        let mut last = 0.0;
        for step in 0..30 {
            let mut pose = [Quat::IDENTITY; JOINT_COUNT];
            pose[LEFT_FOOT] = Quat::from_rotation_x(step as f32 * 0.05) * Quat::from_rotation_z(1.2);
            let mut globals = Vec::new();
            canonical().globals(root, &pose, &mut globals);
            let raise = -globals[LEFT_FOOT + 1].0.y;
            let more = lift_toes(&mut pose, &mut globals, LEFT_FOOT, raise);
            assert!(tip(&globals).y + more > -TOE_SLACK - TOE_SINKING - 1e-4, "step {step}");
            assert!(more >= last && more - last < 0.01, "step {step}: {more} after {last}");
            last = more;
        }
        assert!(last > 0.02, "the test bends toes too little: {last}");
    }

    #[test]
    fn a_hip_that_turns_too_far_is_told() {
        let (planted, ..) = planted(Vec3::new(0.1, 0.4, -0.7));
        assert!(planted.overturned > MAX_OVERTURN && planted.is_strained(), "{planted:?}");
    }

    #[test]
    fn lowering_is_continuous_and_enough() {
        let mut globals = Vec::new();
        canonical().globals(canonical().joints[0].offset, &[Quat::IDENTITY; JOINT_COUNT], &mut globals);
        let mut last = 0.0;
        for step in 0..90 {
            let leg = Leg::new(&globals, LEFT_FOOT, Vec3::NEG_Z * (step as f32 * 0.005));
            let lowering = leg.lowering();
            assert!((0.0..=MAX_LOWERING).contains(&lowering) && (lowering - last).abs() < 0.012, "{step}: {lowering}");
            last = lowering;
            let lowered = Leg { hip: leg.hip - Vec3::Y * lowering, ..leg };
            let ankle = lowered.ball + lowered.heel_lift() * (lowered.ankle - lowered.ball);
            assert!(lowering == MAX_LOWERING || lowered.hip.distance(ankle) < leg.reach + 2e-3, "{step}");
        }
        assert!(last > EASY_LOWERING);
    }
}
