//! Walking cycles out of captures, and steps for everybody in a world.

use std::collections::BTreeMap;

use glam::{Quat, Vec2, Vec3};

use crate::motion::gait::{GaitOptions, Phase, moments};
use crate::motion::plants::trajectory;
use crate::motion::{FPS, JOINT_COUNT, Motion, joint, pose};
use crate::patch::{Fragment, PatchKind, PatchSet};
use crate::stage::World;
use crate::stage::world::{Acts, Gait, GaitTable, PER_RADIAN, STEPS_PER_CYCLE, mix};
use crate::{Error, Result};

use super::footprints::footprints;
use super::rich::Steps;

/// Poses of a cycle in the table.
const PHASES: usize = 32;
/// Speeds nearer to each other than this are one, m/s.
const BIN: f32 = 0.25;
/// A cycle turns by at most this, radians.
const STRAIGHT: f32 = 0.14;
/// People walk by no more than this part faster or slower to be in step.
const MORE_THAN_A_TRIFLE: f32 = 0.2;
/// Below this speed, m/s, somebody looks where they looked before.
const LOOKS_AHEAD: f32 = 0.35;

/// A cycle in a capture.
struct Cycle<'a> {
    motion: &'a Motion,
    frames: (usize, usize),
    speed: f32,
    /// How far its end is from its begin, metres: small is good.
    gap: f32,
    /// Phase at which it begins: half if the right foot is planted.
    phase: f32,
}

/// The walking cycles of a patch set, one for every speed that occurs, and a standing pose.
///
/// # Errors
/// If nobody walks straight on, or stands, in it.
pub fn gait_table(set: &PatchSet) -> Result<GaitTable> {
    // Who leaps over something or hops ends as they begin, but does not walk.
    let walks = |k: &&PatchKind| !k.labels.iter().any(|label| label == "jump" || label == "hop");
    let alone = set.kinds.iter().filter(|k| k.people() == 1 && k.props.is_empty()).filter(walks);
    let motions: Vec<&Fragment> = alone.map(|k| &k.fragments[0]).collect();
    let mut best: BTreeMap<i32, Cycle> = BTreeMap::new();
    for cycle in motions.iter().flat_map(|fragment| cycles(fragment)) {
        let bin = (cycle.speed / BIN).round() as i32;
        match best.get(&bin) {
            Some(other) if other.gap <= cycle.gap => {}
            _ => drop(best.insert(bin, cycle)),
        }
    }
    let bad = |what: &str| Error::invalid("patch set", "kinds", format!("expected somebody who {what}, found nobody"));
    if best.is_empty() {
        return Err(bad("walks straight on for two steps"));
    }
    let stand = motions.iter().find_map(|fragment| standing(&fragment.motion)).ok_or_else(|| bad("stands"))?;
    let mut table = GaitTable { phases: PHASES, ..GaitTable::default() };
    table.speeds.push(0.0);
    table.strides.push(0.0);
    for _ in 0..PHASES {
        add(&mut table, &stand.0, stand.1);
    }
    for cycle in best.values() {
        table.speeds.push(cycle.speed);
        table.strides.push(cycle.speed * (cycle.frames.1 - cycle.frames.0) as f32 / FPS);
        for phase in 0..PHASES {
            let (rotations, hips) = cycle.pose(phase as f32 / PHASES as f32);
            add(&mut table, &rotations, hips);
        }
    }
    footprints(&mut table);
    Ok(table)
}

/// Appends a pose, its rotations on the same side as the standing pose's, so that sums of them make sense.
fn add(table: &mut GaitTable, rotations: &[Quat; JOINT_COUNT], hips: Vec3) {
    for (joint, &q) in rotations.iter().enumerate() {
        let reference = table.rotations.get(joint).copied().unwrap_or(q);
        table.rotations.push(if q.dot(reference) < 0.0 { -q } else { q });
    }
    table.hips.push(hips);
}

/// The cycles of a fragment, straight on: from one passing of the left leg to the next, and the whole of it if it ends as it
/// begins (as walks are cut that may follow each other).
fn cycles(fragment: &Fragment) -> Vec<Cycle<'_>> {
    let motion = &fragment.motion;
    let lefts: Vec<usize> = moments(motion, &GaitOptions::default())
        .into_iter()
        .filter(|m| m.phase == Phase::WalkLeft)
        .map(|m| m.frame)
        .collect();
    let whole = (fragment.entry_group == fragment.exit_group).then(|| (0, motion.len() - 1));
    let pairs = lefts.windows(2).map(|pair| (pair[0], pair[1])).chain(whole);
    pairs.filter_map(|frames| cycle(motion, frames)).collect()
}

fn cycle(motion: &Motion, (begin, end): (usize, usize)) -> Option<Cycle<'_>> {
    let path = &motion.path;
    let way: Vec2 = path.points[end] - path.points[begin];
    let secs = (end - begin) as f32 / FPS;
    let turned = (begin..=end).map(|f| (path.headings[f] - path.headings[begin]).abs()).fold(0.0, f32::max);
    let aside = way.length() - way.dot(Vec2::new(path.headings[begin].sin(), path.headings[begin].cos()));
    let fits = (0.6..2.2).contains(&secs) && turned < STRAIGHT && aside < 0.05 && way.length() > 0.4;
    let ankle = |of: usize| trajectory(motion, of)[begin].y;
    let phase = if ankle(joint::LEFT_FOOT) <= ankle(joint::RIGHT_FOOT) { 0.0 } else { 0.5 };
    let gap = pose::distance(motion, begin, motion, end);
    fits.then(|| Cycle { motion, frames: (begin, end), speed: way.length() / secs, gap, phase })
}

fn standing(motion: &Motion) -> Option<([Quat; JOINT_COUNT], Vec3)> {
    let moment = moments(motion, &GaitOptions::default()).into_iter().find(|m| m.phase == Phase::Stand)?;
    let rotations = motion.pose(moment.frame).try_into().ok()?;
    Some((rotations, Vec3::Y * motion.heights[moment.frame]))
}

impl Cycle<'_> {
    /// Rotations and hips at a phase, relative to somebody who goes straight on at the mean speed; its end is led to its begin.
    fn pose(&self, phase: f32) -> ([Quat; JOINT_COUNT], Vec3) {
        let (begin, end) = self.frames;
        let phase = (phase + self.phase).fract();
        let at = begin as f32 + phase * (end - begin) as f32;
        let frame = (at as usize).min(end - 1);
        let share = at - frame as f32;
        let (a, b) = (self.at(frame), self.at(frame + 1));
        let (first, last) = (self.at(begin), self.at(end));
        let rotation = |joint: usize| {
            let q = a.0[joint].slerp(b.0[joint], share);
            let back = last.0[joint].inverse() * first.0[joint];
            let back = if back.w < 0.0 { -back } else { back };
            (q * Quat::IDENTITY.slerp(back, phase)).normalize()
        };
        let hips = a.1.lerp(b.1, share) + (first.1 - last.1) * phase;
        (std::array::from_fn(rotation), hips - Vec3::new(first.1.x, 0.0, first.1.z))
    }

    /// The same at a frame, not led anywhere.
    fn at(&self, frame: usize) -> ([Quat; JOINT_COUNT], Vec3) {
        let (begin, end) = self.frames;
        let path = &self.motion.path;
        let way = path.points[end] - path.points[begin];
        let ahead = way.normalize();
        let gone = path.points[frame] - path.points[begin] - way * ((frame - begin) as f32 / (end - begin) as f32);
        // Left of (x, z) = (sin h, cos h) is (cos h, -sin h).
        let left = Vec2::new(ahead.y, -ahead.x);
        let mut rotations: [Quat; JOINT_COUNT] =
            self.motion.pose(frame).try_into().unwrap_or([Quat::IDENTITY; JOINT_COUNT]);
        rotations[0] = Quat::from_rotation_y(path.headings[frame] - ahead.x.atan2(ahead.y)) * rotations[0];
        (rotations, Vec3::new(gone.dot(left), self.motion.heights[frame], gone.dot(ahead)))
    }
}

/// The world with bodies: everybody takes steps of the table's length.
///
/// # Errors
/// If the table does not fit.
pub fn with_gait(world: &World, table: GaitTable) -> Result<World> {
    let mut gait = Gait { table, ..Gait::default() };
    // Cycles (of two steps) that every walker of every kind goes through during its stay.
    let mut taken: Vec<Vec<f32>> = Vec::with_capacity(world.kinds());
    for kind in 0..world.kinds() {
        let stays = world.stays(kind).into_iter().enumerate();
        taken.push(stays.map(|(walker, stay)| track(world, kind, walker, stay, &mut gait)).collect());
    }
    let mut tables = world.tables().clone();
    let met = tables.acts.as_mut().map_or_else(Vec::new, |acts| in_step(world, acts));
    join(world, &taken, &met, &mut gait);
    tables.gait = Some(gait);
    World::new(tables)
}

/// Phases with which the clips of those who meet begin and end, by walker of all kinds; nothing for the others, and where nobody steps.
type Met = Vec<[Option<f64>; 2]>;

/// Finds when feet stand in the clips of those who meet: they go over from walk to clip in their steps, and walks are to be in step.
fn in_step(world: &World, acts: &mut Acts) -> Met {
    let mut met = vec![[None; 2]; acts.walkers.len()];
    for kind in 0..world.kinds() {
        for walker in 0..world.kind(kind).walkers() {
            let number = world.kind(kind).first_walker() + walker;
            let Some((act, [begin, enter, leave])) = world.walker_act(kind, walker) else { continue };
            let steps = Steps::of(acts, act);
            met[number] = [enter, leave].map(|secs| steps.phase(secs - begin));
            let times = steps.changes(enter - begin, leave - begin).map(|secs| (secs + begin) as f32);
            acts.walker_feet[8 * number..8 * number + 8].copy_from_slice(&times);
        }
    }
    met
}

/// Steps and headings of a walker; returns how many cycles it goes through.
fn track(world: &World, kind: usize, walker: usize, (enter, leave): (i64, i64), gait: &mut Gait) -> f32 {
    let info = world.info();
    let step = f64::from(info.period_secs) / f64::from(info.slots);
    // The very end belongs to the next patch.
    let time = |slot: i64| if slot < leave { slot as f64 * step + 1e-6 } else { slot as f64 * step - 1e-6 };
    let velocity = |secs: f64| world.way(kind, walker, secs).map_or(Vec2::ZERO, |(_, velocity)| velocity);
    let mut sum = 0.0;
    for slot in enter..=leave {
        gait.steps.push((sum * STEPS_PER_CYCLE).round().min(f32::from(i16::MAX)) as i16);
        // By Simpson's rule over the slot.
        let speeds =
            [time(slot), (slot as f64 + 0.5) * step, time(slot + 1)].map(|t| velocity(t.min(time(leave))).length());
        let [a, m, b] = speeds.map(|speed| gait.table.cadence(speed));
        sum += if slot < leave { (a + 4.0 * m + b) / 6.0 * step as f32 } else { 0.0 };
    }
    let last = gait.steps.last().map_or(0.0, |&s| f32::from(s) / STEPS_PER_CYCLE);
    let ways: Vec<Vec2> = (enter..=leave).map(|slot| velocity(time(slot))).collect();
    gait.headings.extend(headings(&ways).into_iter().map(|h| ((h * PER_RADIAN).round() as i64) as i16));
    last
}

/// Where somebody looks who walks with these velocities: ahead; who hardly moves turns evenly from before to after.
fn headings(velocities: &[Vec2]) -> Vec<f32> {
    let ahead: Vec<Option<f32>> =
        velocities.iter().map(|v| (v.length() > LOOKS_AHEAD).then(|| v.x.atan2(v.y))).collect();
    let known: Vec<(usize, f32)> = ahead.iter().enumerate().filter_map(|(i, h)| Some((i, (*h)?))).collect();
    let Some(&(_, first)) = known.first() else { return vec![0.0; velocities.len()] };
    let mut found = vec![first; velocities.len()];
    for pair in known.windows(2) {
        let ((i, a), (j, b)) = (pair[0], pair[1]);
        let turn = (b - a + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU) - std::f32::consts::PI;
        (i..=j).for_each(|k| found[k] = a + turn * (k - i) as f32 / (j - i) as f32);
    }
    if let Some(&(i, last)) = known.last() {
        found[i..].fill(last);
    }
    found
}

/// A stay of a cycle of crossings.
struct Stay {
    /// When somebody who begins the cycle in period 0 comes in, slots.
    when: i64,
    crossing: usize,
    /// Cycles of two steps that it takes at its own pace.
    steps: f64,
    /// Phases that it is to begin and to end with.
    phases: [Option<f64>; 2],
}

/// Phases at which everybody comes in, so that steps go on over borders, and in step with the clips of those who meet.
fn join(world: &World, taken: &[Vec<f32>], met: &Met, gait: &mut Gait) {
    let mut cycles: BTreeMap<u32, Vec<Stay>> = BTreeMap::new();
    let mut crossing = 0;
    let identities = &world.tables().identities;
    for instance in 0..world.instances() {
        let kind = world.kind_of(instance);
        let first = world.kind(kind).first_walker();
        for (walker, ((enter, _), &steps)) in world.stays(kind).into_iter().zip(&taken[kind]).enumerate() {
            let ahead = i64::from(world.tables().instance_phases[instance]);
            let when = identities.laps(crossing) * i64::from(world.info().slots) + enter - ahead;
            let phases = met.get(first + walker).copied().unwrap_or_default();
            let of = cycles.entry(identities.cycle(crossing)).or_default();
            of.push(Stay { when, crossing, steps: f64::from(steps), phases });
            crossing += 1;
        }
    }
    gait.crossing_phases = vec![0.0; crossing];
    gait.crossing_paces = vec![1.0; crossing];
    for (cycle, mut stays) in cycles {
        stays.sort_by_key(|stay| (stay.when, stay.crossing));
        let closes = !identities.leads_out(cycle);
        let first = (mix(world.info().seed, cycle.into()) % 1024) as f64 / 1024.0;
        let mut phase = pace(&stays, closes, first, gait);
        for stay in &stays {
            gait.crossing_phases[stay.crossing] = phase.rem_euclid(1.0) as f32;
            phase += stay.steps * f64::from(gait.crossing_paces[stay.crossing]);
        }
    }
}

/// Sets the paces along a cycle; returns the phase that it begins with. Between two stays whose phase is given everybody walks a trifle
/// faster or slower, so that the second is met as the first was; where that is more than a trifle, it is not.
fn pace(stays: &[Stay], closes: bool, phase: f64, gait: &mut Gait) -> f64 {
    let n = stays.len();
    let wanted = |at: usize| {
        let next = (closes || at < n).then(|| stays[at % n].phases[0]).flatten();
        let last = (closes || at > 0).then(|| stays[(at + n - 1) % n].phases[1]).flatten();
        next.or(last)
    };
    let steps = |from: usize, to: usize| (from..to).map(|k| stays[k % n].steps).sum::<f64>();
    let first = (0..n).find(|&at| wanted(at).is_some());
    let begin = first.unwrap_or(0);
    let mut known = (begin, wanted(begin).unwrap_or(phase));
    let mut set = |from: usize, to: usize, change: f64| {
        let total = steps(from, to);
        let pace = (((total - change).round() + change) / total) as f32;
        let fits = total > 1.0 && (closes && to == begin + n || (pace - 1.0).abs() < MORE_THAN_A_TRIFLE);
        if fits {
            (from..to).for_each(|k| gait.crossing_paces[stays[k % n].crossing] = pace);
        }
        fits
    };
    let end = if closes { begin + n } else { n };
    for at in begin + 1..=end {
        let next = if at == begin + n { closes.then_some(wanted(begin).unwrap_or(phase)) } else { wanted(at) };
        if let Some(next) = next
            && set(known.0, at, next - known.1)
        {
            known = (at, next);
        }
    }
    // Back from the first that is known to the begin.
    let before: f64 = stays[..begin].iter().map(|s| s.steps * f64::from(gait.crossing_paces[s.crossing])).sum();
    wanted(begin).unwrap_or(phase) - before
}
