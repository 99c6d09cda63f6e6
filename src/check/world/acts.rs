//! What people do who stay: their bodies stay in their discs, and clips go on where they begin again.

use std::collections::BTreeMap;

use glam::{DVec2, Quat, Vec2, Vec3};
use rayon::prelude::*;

use crate::check::report::{Row, Worst};
use crate::geom::{Capsule, Polygon};
use crate::motion::{JOINT_COUNT, body_capsules, canonical, joint};
use crate::stage::World;
use crate::stage::world::{Acts, Spot};

/// What 16 bits may turn a joint by, radians, and move what hangs on it by, metres.
const ROUNDED_TURN: f64 = 4e-4;
const ROUNDED_PLACE: f64 = 1e-3;
/// The hips may go so much farther where a clip begins again than anywhere else in it, metres.
const SEAM: f64 = 1e-3;
/// And so much faster than right before and after it, where it is fast anyway.
const FAST: f64 = 1.4;

/// Rows of a world whose people do something; none if nobody does.
pub(super) fn rows(world: &World) -> Vec<Row> {
    let Some(acts) = &world.tables().acts else { return Vec::new() };
    let stays = |kind: usize| (0..world.kind(kind).stayers().len()).map(move |index| (kind, index));
    let all: Vec<(usize, usize)> = (0..world.kinds()).flat_map(stays).collect();
    let outside: Vec<f64> = all.par_iter().map(|&(kind, index)| outside(world, acts, kind, index)).collect();
    let [mut out, mut leap, mut turn, mut odd] = std::array::from_fn(|_| Worst::default());
    for (&(kind, index), outside) in all.iter().zip(outside) {
        let place = || format!("kind {kind}, person {index} of those who stay");
        out.offer(outside, place);
        if let Some((act, _)) = world.stayer_act(kind, index) {
            let (leaps, turns) = seam(acts, act);
            leap.offer(leaps, place);
            turn.offer(turns, place);
            let rounds = f64::from(world.info().period_secs) / acts.round_secs(act);
            odd.offer((rounds - rounds.round()).abs() * acts.round_secs(act), place);
        }
    }
    vec![
        out.row(6, "bodies of who stays leave their discs", ROUNDED_PLACE, "m"),
        leap.row(6, "hips leap where an act begins again", SEAM, "m"),
        turn.row(6, "joints leap where an act begins again", ROUNDED_TURN.to_degrees(), "deg"),
        odd.row(6, "acts do not end with the period", 1e-3, "s"),
    ]
}

/// Who meets may be so deep in each other, metres: an embrace is as deep as it was captured.
const EMBRACE: f64 = 0.08;
/// For so long after coming in and before going out walk and clip fade into each other, seconds. One foot stands then: its ball is
/// slower and lower than this, m/s and metres; but for this part of the time.
const FADING: f64 = 1.5;
const STANDS: (f32, f32) = (0.15, 0.06);
const ALOFT: f64 = 0.15;
/// Hips are so near to where the ordinary sampling has the walker, metres.
const STRAY: f64 = 0.25;

/// Rows of a world whose walkers meet, with full bodies, thirty times a second over a period; none if nobody meets.
pub(super) fn meetings(world: &World) -> Vec<Row> {
    let acts = |kind: usize| (0..world.kind(kind).walkers()).any(|w| world.walker_act(kind, w).is_some());
    if world.tables().gait.is_none() || !(0..world.kinds()).any(acts) {
        return Vec::new();
    }
    // Patches of one kind are alike.
    let first = |kind: usize| (0..world.instances()).find(|&i| world.kind_of(i) == kind);
    let instances: Vec<usize> = (0..world.kinds()).filter(|&kind| acts(kind)).filter_map(first).collect();
    let frames = (f64::from(world.info().period_secs) * 30.0) as usize;
    let all: Vec<(usize, f64)> =
        instances.iter().flat_map(|&i| (0..frames).map(move |f| (i, (f as f64 + 0.5) / 30.0))).collect();
    let found: Vec<[f64; 3]> = all.par_iter().map(|&(instance, time)| meeting(world, instance, time)).collect();
    let mut worst: [Worst; 3] = Default::default();
    for (&(instance, time), values) in all.iter().zip(&found) {
        let place = || format!("patch {instance} at {time:.2} s");
        worst.iter_mut().zip(values).for_each(|(worst, &value)| worst.offer(value, place));
    }
    let [depth, stray, outside] = worst;
    let feet: Vec<[usize; 2]> = all.par_iter().map(|&(instance, time)| fading(world, instance, time)).collect();
    let [fading, aloft] = feet.iter().fold([0; 2], |sum, one| [sum[0] + one[0], sum[1] + one[1]]);
    let mut loose = Worst::default();
    loose.offer(aloft as f64 / fading.max(1) as f64, || format!("{fading} bodies"));
    vec![
        depth.row(7, "bodies of who meets enter each other", EMBRACE, "m"),
        stray.row(7, "hips of who meets are not where they are sampled", STRAY, "m"),
        outside.row(7, "who meets leaves the patch", ROUNDED_PLACE, "m"),
        loose.row(7, "no foot stands where walk and clip fade", ALOFT, ""),
    ]
}

/// Depth of bodies in each other, distance of hips from sampled places, how far hips are out of the outline while not crossing it.
fn meeting(world: &World, instance: usize, time: f64) -> [f64; 3] {
    let spot = Spot { instance: instance as u32, shift: DVec2::ZERO };
    let kind = world.kind_of(instance);
    let outline = Polygon { points: world.kind(kind).outline() };
    let back = Vec2::from_angle(-world.turn(instance));
    let mut bodies: Vec<Vec<Capsule>> = Vec::new();
    let (mut stray, mut outside) = (0.0f64, 0.0f64);
    let (mut pose, mut globals) = ([Quat::IDENTITY; JOINT_COUNT], Vec::new());
    let moment = world.moment(time);
    for (who, walking) in world.walkers_of(instance, &moment).zip(world.bodies(spot, time)) {
        let hips = world.walker_body(spot, who, &walking, time, &mut pose);
        canonical().globals(hips, &pose, &mut globals);
        bodies.push(Vec::new());
        body_capsules(&globals, bodies.last_mut().expect("just pushed"));
        let ground = Vec2::new(hips.x, hips.z);
        stray = stray.max(f64::from(ground.distance(walking.place)));
        if is_within(world, instance, who, time) {
            outside = outside.max(f64::from(outline.signed_distance(back.rotate(ground))));
        }
    }
    let mut depth = 0.0f32;
    for (i, a) in bodies.iter().enumerate() {
        let pairs =
            bodies[..i].iter().flat_map(|b| a.iter().flat_map(move |p| b.iter().map(move |q| p.penetration(q))));
        depth = pairs.fold(depth, f32::max);
    }
    [f64::from(depth), stray, outside]
}

/// How many people are where walk and clip fade into each other, and how many of them have no foot that stands.
fn fading(world: &World, instance: usize, time: f64) -> [usize; 2] {
    const APART: f64 = 1.0 / 60.0;
    let spot = Spot { instance: instance as u32, shift: DVec2::ZERO };
    let balls = |time: f64| -> BTreeMap<(usize, i64), [Vec3; 2]> {
        let (mut pose, mut globals) = ([Quat::IDENTITY; JOINT_COUNT], Vec::new());
        let moment = world.moment(time);
        let people = world.walkers_of(instance, &moment).zip(world.bodies(spot, time));
        let near = |time: f64, who| {
            is_within(world, instance, who, time)
                && !(is_within(world, instance, who, time - FADING) && is_within(world, instance, who, time + FADING))
        };
        people
            .filter(|(who, _)| near(time, *who))
            .map(|(who, walking)| {
                let hips = world.walker_body(spot, who, &walking, time, &mut pose);
                canonical().globals(hips, &pose, &mut globals);
                (who, [joint::LEFT_TOE, joint::RIGHT_TOE].map(|toe| globals[toe].0))
            })
            .collect()
    };
    let (now, then) = (balls(time), balls(time + APART));
    let stands = |a: &Vec3, b: &Vec3| a.distance(*b) < STANDS.0 * APART as f32 && a.y < STANDS.1;
    let both = now.iter().filter_map(|(who, balls)| Some((balls, then.get(who)?)));
    both.fold([0; 2], |[all, aloft], (a, b)| [all + 1, aloft + usize::from(!(0..2).any(|i| stands(&a[i], &b[i])))])
}

/// Whether somebody has come in and not gone out at a time: slots begin and end a moment before or after.
fn is_within(world: &World, instance: usize, (walker, lap): (usize, i64), time: f64) -> bool {
    let (period, slots) = (f64::from(world.info().period_secs), f64::from(world.info().slots));
    let own = time + f64::from(world.tables().instance_phases[instance]) * period / slots - lap as f64 * period;
    let times = world.walker_act(world.kind_of(instance), walker);
    times.is_some_and(|(_, [_, enter, leave])| enter < own && own < leave)
}

/// How far the body of somebody who stays leaves the disc.
fn outside(world: &World, acts: &Acts, kind: usize, index: usize) -> f64 {
    let stayer = world.kind(kind).stayers().nth(index);
    let (Some(stayer), Some((act, _))) = (stayer, world.stayer_act(kind, index)) else { return 0.0 };
    let (mut globals, mut capsules) = (Vec::new(), Vec::new());
    for (root, pose) in frames(acts, act) {
        canonical().globals(root, &pose, &mut globals);
        body_capsules(&globals, &mut capsules);
    }
    let reach = |p: Vec3, radius: f32| Vec2::new(p.x, p.z).length() + radius;
    let far = capsules.iter().map(|c| reach(c.a, c.radius).max(reach(c.b, c.radius))).fold(0.0, f32::max);
    f64::from(far - stayer.radius).max(0.0)
}

/// Hips and rotations of a clip, read from the numbers themselves.
fn frames(acts: &Acts, act: usize) -> impl Iterator<Item = (Vec3, Vec<Quat>)> {
    acts.frames(act).map(|frame| {
        let numbers = &acts.rotations[4 * JOINT_COUNT * frame..][..4 * JOINT_COUNT];
        let turn = |q: &[i16]| Quat::from_array(std::array::from_fn(|i| f32::from(q[i]))).normalize();
        (Vec3::from_slice(&acts.roots[3 * frame..]), numbers.chunks_exact(4).map(turn).collect())
    })
}

/// By how much hips (metres) and joints (degrees) change more from the last frame to the first than anywhere else.
fn seam(acts: &Acts, act: usize) -> (f64, f64) {
    let all: Vec<(Vec3, Vec<Quat>)> = frames(acts, act).collect();
    let change = |a: &(Vec3, Vec<Quat>), b: &(Vec3, Vec<Quat>)| {
        let turns = a.1.iter().zip(&b.1).map(|(p, q)| p.angle_between(*q)).fold(0.0, f32::max);
        (f64::from(a.0.distance(b.0)), f64::from(turns).to_degrees())
    };
    let n = all.len();
    let at = |frame: usize| change(&all[frame % n], &all[(frame + 1) % n]);
    let most = |a: (f64, f64), b: (f64, f64)| (f64::max(a.0, b.0), f64::max(a.1, b.1));
    let within = (0..n - 1).map(at).fold((0.0, 0.0), most);
    // What is fast anyway may be fastest where the clip happens to begin.
    let beside = most(at(2 * n - 2), at(n));
    let (over, free) = (at(n - 1), most(within, (FAST * beside.0, FAST * beside.1)));
    ((over.0 - free.0).max(0.0), (over.1 - free.1).max(0.0))
}
