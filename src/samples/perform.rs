//! From an actor's plan to motion: pelvis over the feet, legs by inverse kinematics, spine, head and arms.

use std::f32::consts::FRAC_PI_2;

use glam::{Quat, Vec2, Vec3};

use super::acting::Sight;
use super::actor::{Actor, secs};
use super::footsteps::{Base, FootPose};
use super::gait::{GaitPose, gait_pose};
use super::gesture::{hanging, set_arm};
use super::hopping::{held_foot, held_share};
use super::path::Path;
use super::posture::{Body, Channel, Channels};
use super::timeline::{Span, Wander, blur, lerp, signed, unit};
use crate::geom::{Ground, Turn, wrap_angle};
use crate::motion::arm::sign;
use crate::motion::{Clip, Foot, canonical, joint::*};

/// Frames per second of the written captures.
pub(super) const RATE: i32 = 60;
/// Height of the hips when standing.
const HIPS_HEIGHT: f32 = 0.928;
/// The most of a leg's length that is used, so that knees never lock.
const STRETCH: f32 = 0.9988;
const SIDES: [Foot; 2] = [Foot::Left, Foot::Right];

/// Small differences between people and between cycles.
struct Temper {
    head: [Wander; 2],
    chest: [Wander; 2],
    arms: [Wander; 2],
    breath: (f32, f32),
}

impl Temper {
    fn new(rng: &mut impl rand::Rng) -> Self {
        let mut pair = || [Wander::new(rng), Wander::new(rng)];
        let (head, chest, arms) = (pair(), pair(), pair());
        Self { head, chest, arms, breath: (0.24 + 0.04 * signed(rng), unit(rng)) }
    }

    fn breathing(&self, t: f32) -> f32 {
        (std::f32::consts::TAU * (t * self.breath.0 + self.breath.1)).sin()
    }
}

/// What is known of a frame before the pose is made.
struct Frame {
    t: f32,
    channels: Channels,
    gait: GaitPose,
    speed: f32,
    feet: [FootPose; 2],
    pelvis: Quat,
    hips: Vec2,
    height: f32,
    airborne: f32,
}

/// Plays `actor` (number `me` of the take) over `end` frames of 30 per second; `paths` are everybody's.
pub(super) fn perform(
    actor: &Actor,
    me: usize,
    paths: &[Path],
    end: i32,
    name: &str,
    rng: &mut impl rand::Rng,
) -> Clip {
    let mut actor = actor.clone();
    let path = &paths[me];
    place_feet(&mut actor, path, rng);
    let temper = Temper::new(rng);
    let mut frames = prepare(&actor, path, end);
    settle_heights(&mut frames);
    let mut clip = Clip {
        name: name.to_owned(),
        skeleton: canonical().clone(),
        fps: RATE as f32,
        root: Vec::with_capacity(frames.len()),
        rotations: Vec::with_capacity(frames.len() * canonical().joints.len()),
    };
    for frame in &frames {
        let body = pose(&actor, me, paths, frame, &temper);
        clip.root.push(body.root);
        clip.rotations.extend(body.local);
    }
    clip
}

/// Puts the feet where the plan wants them, walking ones a little off, as nobody steps twice the same.
fn place_feet(actor: &mut Actor, path: &Path, rng: &mut impl rand::Rng) {
    for feet in &mut actor.feet {
        for s in &mut feet.stances {
            if s.placement.base == Base::Walk {
                s.placement.offset.position += Vec2::new(0.006 * signed(rng), 0.009 * signed(rng));
                s.placement.offset.heading += 0.02 * signed(rng);
            }
        }
        feet.place(path);
    }
}

fn prepare(actor: &Actor, path: &Path, end: i32) -> Vec<Frame> {
    let count = (end * RATE / 30 + 1) as usize;
    let times: Vec<f32> = (0..count).map(|i| i as f32 / RATE as f32).collect();
    let share = |t: f32| {
        let [left, right] = [actor.feet[0].load(t), actor.feet[1].load(t)];
        held_share(actor, t, if left + right < 1e-3 { 0.5 } else { left / (left + right) })
    };
    let shares = blur(&times.iter().map(|&t| share(t)).collect::<Vec<_>>(), 0.055 * RATE as f32);
    // Who hops does not walk.
    let walked = |t: f32| if actor.held_legs.is_empty() { path.speed(t) } else { 0.0 };
    let speeds = blur(&times.iter().map(|&t| walked(t)).collect::<Vec<_>>(), 0.10 * RATE as f32);
    let mut frames: Vec<Frame> =
        times.iter().zip(&shares).zip(speeds).map(|((&t, _), speed)| prepare_frame(actor, path, t, speed)).collect();
    let sways: Vec<f32> = frames.iter().zip(shares).map(|(f, share)| sway(f, path.at(f.t), share)).collect();
    for (frame, sway) in frames.iter_mut().zip(blur(&sways, 0.04 * RATE as f32)) {
        frame.hips += Turn::from_angle(path.at(frame.t).heading).apply(Vec2::new(sway, 0.0));
    }
    frames
}

/// The hips lean over the foot that carries, less so the faster the walk.
fn sway(f: &Frame, at: Ground, left_share: f32) -> f32 {
    let back = Turn::from_angle(-at.heading);
    let [left, right] = f.feet.map(|foot| back.apply(Vec2::new(foot.ankle.x, foot.ankle.z) - at.position).x);
    let half_width = (0.5 * (left - right)).clamp(0.03, 0.10);
    lerp(0.62, 0.40, (f.speed / 1.1).min(1.0)) * (2.0 * left_share - 1.0) * half_width
}

fn prepare_frame(actor: &Actor, path: &Path, t: f32, speed: f32) -> Frame {
    let mut channels = Channels::default();
    for p in &actor.pulses {
        channels[p.channel] += p.amount * p.span.weight(t);
    }
    let gait = gait_pose(actor.phase.at(t), speed);
    let lifts = [channels[Channel::HeelUpLeft], channels[Channel::HeelUpRight]];
    let at = path.at(t);
    let local = Vec2::new(channels[Channel::HipsLeft], channels[Channel::HipsForward]);
    let pelvis = Quat::from_rotation_y(at.heading + gait.pelvis_yaw + channels[Channel::PelvisYaw])
        * Quat::from_rotation_x(0.035 + gait.pelvis_pitch + channels[Channel::PelvisPitch])
        * Quat::from_rotation_z(gait.pelvis_roll + channels[Channel::PelvisRoll]);
    let flown: f32 = actor.flights.iter().map(|f| f.height(t)).sum();
    let walks = 1.0 - actor.flights.iter().map(|f| Span(f.times).weight(t)).sum::<f32>();
    let height = HIPS_HEIGHT - gait.drop * walks + channels[Channel::HipsUp] + flown;
    let feet = [0, 1].map(|i| held_foot(actor, i, t, at, height, actor.feet[i].pose(t, lifts[i], at)));
    let airborne = actor.flights.iter().map(|f| f.airborne(t)).sum();
    Frame { t, channels, gait, speed, feet, pelvis, hips: at.apply(local), height, airborne }
}

/// Lowers the hips where a leg would not reach, beginning before and ending after, so that no knee snaps.
fn settle_heights(frames: &mut [Frame]) {
    let short: Vec<f32> = frames.iter().map(|f| (f.height - highest(f)).max(0.0)).collect();
    let reach = RATE as usize / 12;
    let widened: Vec<f32> = (0..short.len())
        .map(|i| short[i.saturating_sub(reach)..(i + reach + 1).min(short.len())].iter().copied().fold(0.0, f32::max))
        .collect();
    for (frame, lower) in frames.iter_mut().zip(blur(&widened, 0.45 * reach as f32)) {
        frame.height = (frame.height - lower).min(highest(frame));
    }
}

/// The greatest height of the hips at which both feet are in reach; as they are when nobody stands on them.
fn highest(f: &Frame) -> f32 {
    let limit = STRETCH * (0.42 + 0.41);
    let over = |i: usize| {
        let joint = f.pelvis * Vec3::new(sign(SIDES[i]) * 0.09, -0.03, 0.0);
        let ankle = f.feet[i].ankle;
        let across = Vec2::new(f.hips.x + joint.x - ankle.x, f.hips.y + joint.z - ankle.z).length().min(limit * 0.98);
        ankle.y + (limit * limit - across * across).sqrt() - joint.y
    };
    over(0).min(over(1)) + f.airborne
}

fn pose(actor: &Actor, me: usize, paths: &[Path], f: &Frame, temper: &Temper) -> Body {
    let path = &paths[me];
    let at = path.at(f.t);
    let mut body = Body::new(Vec3::new(f.hips.x, f.height, f.hips.y), f.pelvis);
    for (i, side) in SIDES.into_iter().enumerate() {
        let out = sign(side) * f.channels[[Channel::KneeOutLeft, Channel::KneeOutRight][i]];
        let pole = Quat::from_rotation_y(out)
            * (0.6 * (f.feet[i].rotation * Vec3::Z).with_y(0.0).normalize_or_zero()
                + 0.4 * (f.pelvis * Vec3::Z).with_y(0.0).normalize_or_zero());
        body.set_leg(side, &f.feet[i], knee_pole(pole, &body, i), STRETCH);
    }
    let looks = gaze(actor, paths, me, f);
    body.set_spine(spine(f, at.heading, looks, temper), [-0.05, 0.0, 0.075]);
    body.refresh();
    set_head(&mut body, f, at.heading, looks, temper);
    for (i, side) in SIDES.into_iter().enumerate() {
        let shrug = f.channels[[Channel::ShrugLeft, Channel::ShrugRight][i]] + 0.008 * temper.breathing(f.t);
        body.local[[LEFT_SHOULDER, RIGHT_SHOULDER][i]] = Quat::from_rotation_z(sign(side) * (shrug - 0.05));
    }
    body.refresh();
    for (i, side) in SIDES.into_iter().enumerate() {
        set_arm(&mut body, side, swinging(f, i, temper), &actor.reaches, at, f.t);
    }
    body
}

/// The knee looks ahead as the foot does; when the thigh is raised beyond level, upwards.
fn knee_pole(forward: Vec3, body: &Body, i: usize) -> Vec3 {
    let low = (0.55 - body.root.y).clamp(0.0, 0.5) * 2.0;
    forward * (1.0 - 0.5 * low) + Vec3::Y * low + body.rotation(HIPS) * Vec3::X * (0.1 * low * sign(SIDES[i]))
}

fn spine(f: &Frame, heading: f32, (look_yaw, _): (f32, f32), temper: &Temper) -> Quat {
    let c = &f.channels;
    let calm = 1.0 - 0.6 * c[Channel::StillArms].clamp(0.0, 1.0);
    let pelvis_yaw = wrap_angle(yaw_of(f.pelvis) - heading);
    let yaw = f.gait.chest_yaw * calm - pelvis_yaw + c[Channel::SpineYaw] + c[Channel::PelvisYaw] + 0.12 * look_yaw;
    let pitch = f.gait.lean - f.gait.pelvis_pitch + c[Channel::SpinePitch] + 0.006 * temper.breathing(f.t);
    let roll = -0.85 * f.gait.pelvis_roll + c[Channel::SpineRoll];
    let wander = [0.012 * temper.chest[0].at(f.t), 0.008 * temper.chest[1].at(f.t)];
    Quat::from_rotation_y(yaw + wander[0]) * Quat::from_rotation_x(pitch) * Quat::from_rotation_z(roll + wander[1])
}

fn yaw_of(q: Quat) -> f32 {
    let z = q * Vec3::Z;
    z.x.atan2(z.z)
}

/// Where the eyes go, as yaw against the path and pitch (down is positive).
fn gaze(actor: &Actor, paths: &[Path], me: usize, f: &Frame) -> (f32, f32) {
    let path = &paths[me];
    let at = path.at(f.t);
    // Who turns in one hop looks there later than who turns in two steps.
    let soon = if actor.held_legs.is_empty() { 0.35 } else { 0.2 };
    let ahead = (path.at(f.t + soon).heading - at.heading).clamp(-0.6, 0.6);
    let (mut yaw, mut pitch) = (ahead, 0.05);
    for (span, sight) in &actor.gazes {
        let weight = span.weight(f.t);
        if weight > 0.0 {
            let target = match *sight {
                Sight::Person(i) => {
                    let p = paths[i].at(f.t).position;
                    Vec3::new(p.x, 1.60, p.y)
                }
                Sight::Beside(p) => at.apply3(p),
            };
            let eye = Vec3::new(f.hips.x, f.height + 0.70, f.hips.y);
            let to = target - eye;
            let wanted = wrap_angle(to.x.atan2(to.z) - at.heading).clamp(-1.25, 1.25);
            let down = (-to.y).atan2(to.with_y(0.0).length()).clamp(-0.6, 0.9);
            (yaw, pitch) = (lerp(yaw, wanted, weight), lerp(pitch, down, weight));
        }
    }
    (yaw, pitch)
}

fn set_head(body: &mut Body, f: &Frame, heading: f32, (yaw, pitch): (f32, f32), temper: &Temper) {
    let c = &f.channels;
    // Eyes do the rest of the way.
    let yaw = heading + 0.85 * yaw + c[Channel::HeadYaw] + 0.02 * temper.head[0].at(f.t);
    // A bent body takes the head along by half.
    let chest_pitch = -(body.rotation(SPINE2) * Vec3::Z).y.asin();
    let carried = 0.45 * (chest_pitch - 0.06).clamp(-FRAC_PI_2, FRAC_PI_2);
    let pitch = 0.8 * pitch + carried + c[Channel::HeadPitch] + 0.014 * temper.head[1].at(f.t);
    let roll = c[Channel::HeadRoll] + 0.3 * c[Channel::SpineRoll];
    let turn = Quat::from_rotation_y(yaw) * Quat::from_rotation_x(pitch) * Quat::from_rotation_z(roll);
    body.set_head(turn);
    body.refresh();
}

fn swinging(f: &Frame, i: usize, temper: &Temper) -> [Quat; 3] {
    let c = &f.channels;
    let still = 1.0 - c[Channel::StillArms].clamp(0.0, 1.0);
    let lively = still * (1.0 + 0.06 * temper.arms[i].at(f.t));
    let wander = 0.018 * temper.arms[1 - i].at(f.t);
    let hang = 0.02 + 0.25 * chest_compensation(f);
    let flex = hang + f.gait.arm_flex[i] * lively + wander + c[[Channel::FlexLeft, Channel::FlexRight][i]];
    let abduct = 0.15 - 0.02 * f.speed.min(1.4) + c[[Channel::AbductLeft, Channel::AbductRight][i]];
    let elbow = (0.28 + f.gait.elbow[i] * lively + wander + c[[Channel::ElbowLeft, Channel::ElbowRight][i]]).max(0.05);
    hanging(SIDES[i], flex, abduct, elbow)
}

/// Arms keep hanging when the body bends forward.
fn chest_compensation(f: &Frame) -> f32 {
    f.channels[Channel::SpinePitch] + f.channels[Channel::PelvisPitch]
}

/// Foot plants of an actor whose performance lasts `end` frames: times over which the ball of the foot is still.
pub(super) fn plants(actor: &Actor, end: i32) -> Vec<(Foot, f32, f32)> {
    let end = secs(end);
    let spans = actor.feet.iter().flat_map(|feet| &feet.stances);
    let inside = spans.map(|s| (s.foot, s.flat.max(0.0), s.toe_off.min(end)));
    let mut plants: Vec<_> = inside.filter(|&(_, begin, to)| to - begin > 0.05).collect();
    plants.sort_by(|a, b| a.1.total_cmp(&b.1));
    plants
}
