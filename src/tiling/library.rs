//! The patch set made ready for planning: everything that depends on the kind alone is computed once here.

use std::f32::consts::PI;

use glam::Vec2;
use rayon::prelude::*;

use super::audition::plays_cleanly;
use super::bridge::{Port, STANDING_SPEED};
use super::footprint::{Footprint, Lifts, footprints, lying, reach};
use super::piece::Piece;
use super::prefer::{Preference, Ready};
use super::scene::Placed;
use super::scene::Scene;
use super::source::Gates;
use super::team::Sides;
use crate::deform::{Limits, Strand};
use crate::geom::{Ground, Turn, Upright};
use crate::motion::{JOINT_COUNT, Motion, MotionPath};
use crate::patch::{Fragment, PatchKind, PatchProp, PatchSet, fastest_turns, turn_between};

/// Growth of footprints: what blending, foot locking and sampling between frames may move a body, metres.
const MARGIN: f32 = 0.02;
/// Warped in time, a joint may turn this much faster than the captures' fastest.
const RUSH: f32 = 1.1;
/// Deformed, hips may go and turn this much faster; blending at stitches takes up the rest of what is let pass.
const HURRY: f32 = 1.05;
/// Who is so high above the ground with all of the body jumps, metres.
const LEAP: f32 = 0.1;
/// Longest strand of two single-person kinds that closes a gap, in frames.
const MAX_STRAND_FRAMES: usize = 110;
/// How far the end of a strand of one role and of two can be moved, metres.
const SINGLE_REACH: f32 = 0.9;
const PAIR_REACH: f32 = 1.2;

/// A role of a kind: one fragment, relative to its own entry.
pub(super) struct Role {
    /// Index of the kind.
    pub kind: u32,
    /// Index of the fragment in the kind.
    pub role: u32,
    /// The path seen from its first frame.
    pub path: MotionPath,
    /// The path's headings as turns.
    pub turns: Vec<Turn>,
    /// Where it ends, seen from where it begins.
    pub exit: Ground,
    /// Duration in ticks if not warped: frames - 1.
    pub ticks: i32,
    /// Fewest and most ticks it may be warped to.
    pub tick_range: (i32, i32),
    /// Pose group of the entry.
    pub entry_group: u32,
    /// Pose group of the exit.
    pub exit_group: u32,
    /// `patch_from_entry`.
    pub entry: Ground,
    /// Tick of the patch's clock at which it begins.
    pub begin: i32,
    /// How much the hips turn from frame to frame, radians.
    pub hips_turns: Vec<f32>,
    /// Footprints per frame.
    pub footprints: Vec<Footprint>,
    /// How high they are above the ground, per frame.
    pub lifts: Vec<Lifts>,
    /// Radius of each footprint around the path point.
    pub reach: Vec<f32>,
    /// The box that lies there before the role takes it up, and the one after the role put it down.
    pub rests: [Option<Rest>; 2],
    /// The frame at which it is highest above the ground, if it jumps.
    pub leap: Option<usize>,
}

/// A box that lies on its place.
pub(super) struct Rest {
    /// Source frame at which it is taken up or put down.
    pub frame: usize,
    /// Its place seen from the path at that frame.
    pub from_path: Ground,
    /// Discs that cover it.
    pub footprint: Footprint,
    /// Radius of them around its middle.
    pub reach: f32,
}

impl Role {
    fn reaches(&self) -> impl Iterator<Item = f32> {
        self.reach.iter().copied().chain(self.rests.iter().flatten().map(|r| r.reach))
    }

    /// True if a box lies there before or after.
    pub fn leaves_box(&self) -> bool {
        self.rests.iter().any(Option::is_some)
    }
}

/// A step of the search: a single-person role taken from its entry (forward) or from its exit (backward).
#[derive(Clone, Copy)]
pub(super) struct Move {
    /// The role.
    pub role: u32,
    /// The new state seen from the old one.
    pub to: Ground,
    /// Duration.
    pub ticks: i32,
    /// Pose group of the new state.
    pub group: u32,
    /// Mean speed in m/s.
    pub speed: f32,
    /// How much of the way goes sideways or backwards, 0 to 1.
    pub askew: f32,
    /// By how much the circle that it stays in is larger than that of the most compact way to stand, m^2.
    pub room: f32,
}

/// One or two single-person roles that can be deformed together between two given ends.
pub(super) struct Closing {
    /// The roles; the second is there only for pairs.
    pub roles: [Option<u32>; 2],
    /// Path of both.
    pub strand: Strand,
}

/// What tells whether a closing may fit: looked at much more often than the closing itself.
#[derive(Clone, Copy)]
pub(super) struct Span {
    /// Where it ends if not deformed, seen from where it begins.
    pub exit: Ground,
    /// Fewest and most ticks.
    pub ticks: (i32, i32),
    /// How far its end can be moved, metres.
    pub reach: f32,
}

/// All closings from one pose group to another, and the span of each.
#[derive(Default)]
pub(super) struct Closings {
    /// The spans.
    pub spans: Vec<Span>,
    /// The closings, in the same order.
    pub all: Vec<Closing>,
}

/// A patch set made ready for planning.
pub(super) struct Library<'a> {
    /// The set.
    pub set: &'a PatchSet,
    /// Deformation limits.
    pub limits: Limits,
    /// All roles of all kinds, kind by kind.
    pub roles: Vec<Role>,
    /// Index of each kind's first role.
    pub first_role: Vec<u32>,
    /// Kinds of two or more people; like the single ones below, only those that are fit to be cast.
    pub multi: Vec<u32>,
    /// Moves by the pose group they start from, forward in time.
    pub forward: Vec<Vec<Move>>,
    /// Moves by the pose group they start from, backward in time.
    pub backward: Vec<Vec<Move>>,
    /// By entry group * groups + exit group.
    pub closings: Vec<Closings>,
    /// Fastest turn of each joint in the captures, radians per frame.
    pub fastest: [f32; JOINT_COUNT],
    /// Longest way of the hips over the ground in the captures, metres per frame.
    pub fastest_step: f32,
    /// Longest way of the hips through the air in the captures, metres per frame.
    pub fastest_hips: f32,
    /// Largest reach of any footprint.
    pub max_reach: f32,
    /// By pose group, whether people have a box in their hands.
    pub laden: Vec<bool>,
    /// Which patches are wanted where, which way, when.
    pub preference: Ready,
    /// Where people come in and go out.
    pub gates: Gates,
    /// The teams.
    pub sides: Sides,
}

impl<'a> Library<'a> {
    /// Prepares `set`. O(total frames + pairs of single-person kinds x frames).
    pub fn new(set: &'a PatchSet, limits: Limits) -> Self {
        let sources: Vec<(u32, u32)> =
            (0..set.kinds.len()).flat_map(|k| (0..set.kinds[k].people()).map(move |r| (k as u32, r as u32))).collect();
        let fastest = set.fastest_turns();
        let roles: Vec<Role> = sources.par_iter().map(|&(k, r)| prepare(set, k, r, &limits, &fastest)).collect();
        let first_role = (0..set.kinds.len() as u32)
            .map(|k| sources.iter().position(|s| s.0 == k).expect("validated: no kind without people") as u32)
            .collect();
        let fit: Vec<bool> = set.kinds.par_iter().map(plays_cleanly).collect();
        let is_single = |role: &Role| set.kinds[role.kind as usize].people() == 1 && fit[role.kind as usize];
        let groups = set.groups.len();
        let (mut forward, mut backward) = (vec![Vec::new(); groups], vec![Vec::new(); groups]);
        for (i, role) in roles.iter().enumerate().filter(|(_, r)| is_single(r)) {
            let way = role.path.points.windows(2).map(|w| w[0].distance(w[1])).sum::<f32>();
            let (speed, askew) = (way / role.ticks as f32 * crate::motion::FPS, askew(&role.path));
            let room = circle(role);
            let step = |to, group| Move { role: i as u32, to, ticks: role.ticks, group, speed, askew, room };
            forward[role.entry_group as usize].push(step(role.exit, role.exit_group));
            backward[role.exit_group as usize].push(step(role.exit.inverse(), role.entry_group));
        }
        let standing = forward.iter().flatten().filter(|m| m.speed < STANDING_SPEED);
        let least = standing.map(|m| m.room).reduce(f32::min).unwrap_or_default();
        forward.iter_mut().chain(&mut backward).flatten().for_each(|m| m.room -= least);
        let closings = closings(&roles, groups, |r| is_single(r) && !r.leaves_box() && r.leap.is_none());
        Self {
            set,
            limits,
            first_role,
            multi: (0..set.kinds.len() as u32)
                .filter(|&k| set.kinds[k as usize].people() > 1 && fit[k as usize])
                .collect(),
            forward,
            backward,
            closings,
            fastest,
            fastest_hips: set
                .kinds
                .iter()
                .flat_map(|k| &k.fragments)
                .map(|f| fastest_hips(&f.motion))
                .fold(0.0, f32::max),
            fastest_step: roles.iter().map(|r| longest_step(&r.path)).fold(0.0, f32::max),
            max_reach: roles.iter().flat_map(Role::reaches).fold(0.0, f32::max),
            laden: set.laden_groups(),
            preference: Ready::default(),
            gates: Gates::default(),
            sides: Sides::default(),
            roles,
        }
    }

    /// The same with wishes.
    pub fn preferring(self, preference: &Preference) -> Self {
        Self { preference: Ready::new(preference, self.set), ..self }
    }

    /// The same, where some kinds are used only where they are placed.
    pub fn placing(mut self, placed: &[Placed]) -> Self {
        let set = self.set;
        self.multi.retain(|&k| placed.iter().all(|p| p.kind != set.kinds[k as usize].name));
        self
    }

    /// The same with the gates and teams of a scene.
    pub fn parting(mut self, scene: &Scene) -> Self {
        self.gates = Gates::new(scene, &self);
        self.sides = Sides::new(scene, &self);
        self
    }

    /// About how many patches of one person fill so many ticks.
    pub fn steps(&self, ticks: i32) -> usize {
        let moves = || self.forward.iter().flatten();
        let all: i32 = moves().map(|m| m.ticks).sum();
        (ticks as usize * moves().count()).div_ceil(all.max(1) as usize)
    }

    /// True if a role laid along `path` over `ticks` makes the hips go or turn faster than anywhere in the captures.
    pub fn is_hurried(&self, role: u32, path: &MotionPath, ticks: i32) -> bool {
        let role = &self.roles[role as usize];
        let rate = role.ticks as f32 / ticks as f32;
        if longest_step(path) * rate > HURRY * self.fastest_step {
            return true;
        }
        let bends = path.headings.windows(2).zip(role.path.headings.windows(2));
        let bends = bends.map(|(now, then)| ((now[1] - now[0]) - (then[1] - then[0])).abs());
        // Where nothing bends the range of ticks has seen to it.
        role.hips_turns
            .iter()
            .zip(bends)
            .any(|(own, bend)| bend > 1e-4 && (own + bend) * rate > HURRY * self.fastest[0])
    }

    /// The closings from one pose group to another.
    pub fn closings_between(&self, from: u32, to: u32) -> &Closings {
        &self.closings[from as usize * self.set.groups.len() + to as usize]
    }

    /// Number of people in the patch of a role.
    pub fn people_of(&self, role: u32) -> usize {
        self.set.kinds[self.roles[role as usize].kind as usize].people()
    }

    /// What was captured of a piece's person.
    pub fn fragment(&self, piece: &Piece) -> &'a Fragment {
        let role = &self.roles[piece.role as usize];
        &self.set.kinds[role.kind as usize].fragments[role.role as usize]
    }

    /// The port at which a piece begins.
    pub fn entry_of(&self, piece: &Piece) -> Port {
        Port { at: piece.entry(), tick: piece.begin, group: self.roles[piece.role as usize].entry_group }
    }

    /// The port at which a piece ends.
    pub fn exit_of(&self, piece: &Piece) -> Port {
        Port { at: piece.exit(), tick: piece.end, group: self.roles[piece.role as usize].exit_group }
    }

    /// Entry and exit of a role of a patch that is placed rigidly, its clock beginning at tick `clock`.
    pub fn ports(&self, role: u32, world_from_patch: Ground, clock: i32) -> (Port, Port) {
        let r = &self.roles[role as usize];
        let entry = Port { at: world_from_patch.then(r.entry), tick: clock + r.begin, group: r.entry_group };
        let exit = Port { at: entry.at.then(r.exit), tick: entry.tick + r.ticks, group: r.exit_group };
        (entry, exit)
    }

    /// The roles of a kind.
    pub fn roles_of(&self, kind: u32) -> std::ops::Range<u32> {
        let first = self.first_role[kind as usize];
        first..first + self.set.kinds[kind as usize].people() as u32
    }
}

fn prepare(set: &PatchSet, kind: u32, role: u32, limits: &Limits, fastest: &[f32; JOINT_COUNT]) -> Role {
    let fragment = &set.kinds[kind as usize].fragments[role as usize];
    let source = &fragment.motion.path;
    let entry = source.at(0);
    let entry_from_patch = entry.inverse();
    let path = MotionPath {
        points: source.points.iter().map(|&p| entry_from_patch.apply(p)).collect(),
        headings: source.headings.iter().map(|h| h - entry.heading).collect(),
    };
    let (footprints, lifts): (Vec<_>, Vec<_>) = footprints(&set.kinds[kind as usize], role, MARGIN).into_iter().unzip();
    Role {
        kind,
        role,
        turns: path.headings.iter().map(|&h| Turn::from_angle(h)).collect(),
        exit: path.at(path.len() - 1),
        ticks: path.len() as i32 - 1,
        tick_range: tick_range(&fragment.motion, limits, fastest),
        entry_group: fragment.entry_group,
        exit_group: fragment.exit_group,
        entry,
        begin: fragment.begin as i32,
        hips_turns: hips_turns(&fragment.motion),
        reach: footprints.iter().map(reach).collect(),
        leap: leap(&lifts),
        rests: rests(&set.kinds[kind as usize], role),
        footprints,
        lifts,
        path,
    }
}

/// The frame at which somebody who jumps is highest.
fn leap(lifts: &[Lifts]) -> Option<usize> {
    let lowest = |l: &Lifts| l.iter().copied().fold(f32::INFINITY, f32::min);
    let highest = (0..lifts.len()).max_by(|&i, &j| lowest(&lifts[i]).total_cmp(&lowest(&lifts[j])))?;
    (lowest(&lifts[highest]) > LEAP).then_some(highest)
}

/// The boxes that a role is the first to take up (or sits on) and the last to put down.
fn rests(kind: &PatchKind, role: u32) -> [Option<Rest>; 2] {
    let fragment = &kind.fragments[role as usize];
    let rest = |prop: &PatchProp, at: Upright, clock: u32| {
        let frame = (clock - fragment.begin) as usize;
        let footprint = lying(prop.size, MARGIN);
        let from_path = fragment.motion.path.at(frame).inverse().then(at.ground());
        Rest { frame, from_path, reach: reach(&footprint), footprint }
    };
    let [before, after] = [0, 1].map(|end| {
        kind.props.iter().find_map(|p| {
            let (_, clock) = p.anchors()[end].filter(|a| a.0 == role)?;
            Some(rest(p, [p.before, p.after][end]?, clock))
        })
    });
    [before, after]
}

/// Area of the circle around the middle of its path that a body stays in, m^2.
fn circle(role: &Role) -> f32 {
    let points = &role.path.points;
    let middle = points.iter().sum::<Vec2>() / points.len() as f32;
    let radius = points.iter().zip(&role.reach).map(|(p, reach)| p.distance(middle) + reach).fold(0.0, f32::max);
    PI * radius * radius
}

/// The part of a path's length that leads away from where the body looks: 0 for a walk, 1 for steps sideways or back.
fn askew(path: &MotionPath) -> f32 {
    let (mut ahead, mut all) = (0.0, 1e-6);
    for (w, heading) in path.points.windows(2).zip(&path.headings) {
        let step = w[1] - w[0];
        let forward = Vec2::new(heading.sin(), heading.cos());
        ahead += step.dot(forward).max(0.0);
        all += step.length();
    }
    1.0 - ahead / all
}

fn longest_step(path: &MotionPath) -> f32 {
    path.points.windows(2).map(|w| w[0].distance(w[1])).fold(0.0, f32::max)
}

fn fastest_hips(motion: &Motion) -> f32 {
    let hips = |f: usize| motion.path.points[f].extend(motion.heights[f]);
    (1..motion.len()).map(|f| hips(f).distance(hips(f - 1))).fold(0.0, f32::max)
}

fn hips_turns(motion: &Motion) -> Vec<f32> {
    let hips = |f: usize| motion.path.at(f).rotation() * motion.pose(f)[0];
    (1..motion.len()).map(|f| turn_between(hips(f - 1), hips(f))).collect()
}

/// The limits' range, cut so that no joint is sped up beyond what the set's captures show of it.
fn tick_range(motion: &Motion, limits: &Limits, fastest: &[f32; JOINT_COUNT]) -> (i32, i32) {
    let (shortest, longest) = limits.tick_range(motion.len());
    let own = fastest_turns([motion]);
    let rate = (0..JOINT_COUNT).map(|j| RUSH * fastest[j] / own[j]).fold(f32::INFINITY, f32::min);
    let unhurried = ((motion.len() - 1) as f32 / rate).ceil() as i32;
    (shortest.max(unhurried).min(longest), longest)
}

fn closings(roles: &[Role], groups: usize, is_single: impl Fn(&Role) -> bool) -> Vec<Closings> {
    let strands: Vec<Option<Strand>> = roles.iter().map(|r| is_single(r).then(|| Strand::new(&r.path))).collect();
    let mut table: Vec<Closings> = (0..groups * groups).map(|_| Closings::default()).collect();
    let mut add = |first: usize, second: Option<usize>, strand: Strand| {
        let ranges = [Some(first), second].into_iter().flatten().map(|r| roles[r].tick_range);
        let ticks = ranges.fold((0, 0), |sum, range| (sum.0 + range.0, sum.1 + range.1));
        let (from, to) = (roles[first].entry_group, roles[second.unwrap_or(first)].exit_group);
        let roles = [Some(first as u32), second.map(|s| s as u32)];
        let reach = if second.is_some() { PAIR_REACH } else { SINGLE_REACH };
        let closings = &mut table[from as usize * groups + to as usize];
        closings.spans.push(Span { exit: strand.exit(), ticks, reach });
        closings.all.push(Closing { roles, strand });
    };
    for (i, first) in strands.iter().enumerate() {
        let Some(first) = first else { continue };
        add(i, None, first.clone());
        for (j, second) in strands.iter().enumerate() {
            let Some(second) = second else { continue };
            let fits =
                roles[i].exit_group == roles[j].entry_group && first.frames() + second.frames() <= MAX_STRAND_FRAMES;
            if fits {
                add(i, Some(j), Strand::chained(first, second));
            }
        }
    }
    table
}
