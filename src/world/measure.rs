//! How long patches take: what the benchmark prints.

use std::time::Instant;

use glam::{DVec2, Quat, Vec3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    CrowdPatch, FramePatch, Limits, Method, Options, PatternType, Placement, Plan, Stream, Template, bake, gait_table,
    solve, with_gait,
};
use crate::Result;
use crate::motion::JOINT_COUNT;
use crate::patch::PatchSet;
use crate::stage::World;
use crate::stage::world::{Roots, Spot, TemplateInfo, WalkLimits, WorldInfo};

/// Bodies posed together.
const BLOCK: usize = 64;

/// Figures of patches of one size.
#[derive(Clone, Debug)]
pub struct Creation {
    /// Inputs (and outputs) of every patch.
    pub walkers: usize,
    /// Milliseconds per patch, ascending: the least of three runs, as other processes take the core now and then.
    pub millis: Vec<f64>,
    /// Patches whose walkers keep all limits.
    pub solved: usize,
    /// Curves computed, of all patches.
    pub solves: u64,
    /// Connections drawn anew, of all patches.
    pub restarts: u64,
    /// The patches.
    pub patches: Vec<CrowdPatch>,
}

impl Creation {
    /// Milliseconds that a `share` of the patches stays below.
    pub fn quantile(&self, share: f64) -> f64 {
        let last = self.millis.len().saturating_sub(1);
        self.millis.get((last as f64 * share.clamp(0.0, 1.0)) as usize).copied().unwrap_or(f64::NAN)
    }
}

/// Solves `patches` random test patches ([`FramePatch::sample`]) of `walkers` inputs and outputs on one core.
///
/// # Errors
/// If there is no room for so many walkers.
pub fn measure_creation(method: Method, walkers: usize, patches: u64) -> Result<Creation> {
    let mut found = Creation { walkers, millis: Vec::new(), solved: 0, solves: 0, restarts: 0, patches: Vec::new() };
    for seed in 0..patches {
        let frame = FramePatch::sample(walkers, seed)?;
        let options = Options { seed, method, ..Options::default() };
        let mut least = f64::INFINITY;
        for run in 0..3 {
            let begin = Instant::now();
            let solution = solve(&frame, &Limits::default(), &options)?;
            least = least.min(begin.elapsed().as_secs_f64() * 1e3);
            if run == 0 {
                found.solved += usize::from(solution.ok());
                found.solves += solution.solves;
                found.restarts += u64::from(solution.restarts);
                found.patches.push(solution.patch);
            }
        }
        found.millis.push(least);
    }
    found.millis.sort_by(f64::total_cmp);
    Ok(found)
}

/// Figures of a walk through an endless world.
#[derive(Clone, Debug)]
pub struct Walk {
    /// Milliseconds of every frame in which patches were made, ascending.
    pub frames: Vec<f64>,
    /// Most patches there were at a time.
    pub resident: usize,
    /// Patches made.
    pub made: usize,
}

/// Walks `metres` along x through the endless world of `plan`, on one core: patches within `reach` cells of the camera are
/// made, at most `budget` in a frame, those behind forgotten.
///
/// # Errors
/// As [`Plan::build`].
pub fn measure_walk(plan: &Plan, metres: f32, reach: i64, budget: usize) -> Result<Walk> {
    let mut stream = Stream::new(plan.clone())?;
    let mut walk = Walk { frames: Vec::new(), resident: 0, made: 0 };
    for column in 0..(metres / plan.side).ceil() as i64 {
        loop {
            let begin = Instant::now();
            let missing = stream.look([column, 1], reach, budget);
            walk.frames.push(begin.elapsed().as_secs_f64() * 1e3);
            walk.resident = walk.resident.max(stream.cells().count());
            if missing == 0 {
                break;
            }
        }
        walk.made += if column == 0 { stream.cells().count() } else { 2 * reach as usize + 1 };
    }
    walk.frames.sort_by(f64::total_cmp);
    Ok(walk)
}

/// Figures of playing a large world on one core.
#[derive(Clone, Debug)]
pub struct Replay {
    /// Patch kinds.
    pub kinds: usize,
    /// People who walk, on average.
    pub people: usize,
    /// Bytes of the world in memory.
    pub bytes: usize,
    /// Places with velocities per second, around 1 s; the median of many frames.
    pub early: f64,
    /// The same around 1 h.
    pub late: f64,
    /// Microseconds for all people of one patch at a random time: the median.
    pub single_micros: f64,
}

/// Plays a world of about `people` walkers in squares of 8 m with 16 inputs and outputs. `kinds` of them are solved; if `unique`,
/// every patch is stored on its own.
///
/// # Errors
/// As [`Plan::build`].
pub fn measure_replay(people: usize, kinds: u64, unique: bool) -> Result<Replay> {
    let world = dense_world(people, kinds, unique)?;
    let mut roots = Roots::default();
    let mut rate = |from: f64| {
        let mut frames: Vec<f64> = (0..60)
            .map(|frame| {
                let begin = Instant::now();
                world.roots(&world.moment(from + f64::from(frame) * 0.177), DVec2::ZERO, &mut roots);
                roots.len() as f64 / begin.elapsed().as_secs_f64()
            })
            .collect();
        frames.sort_by(f64::total_cmp);
        frames[frames.len() / 2]
    };
    let (early, late) = (rate(1.0), rate(3600.0));
    let slots = world.info().slots;
    let walkers = (0..slots).map(|s| world.walkers(&world.moment(f64::from(s) * 0.2 + 0.1))).sum::<usize>();
    Ok(Replay {
        kinds: world.kinds(),
        people: walkers / slots as usize,
        bytes: world.bytes(),
        early,
        late,
        single_micros: single_micros(&world),
    })
}

/// Microseconds for a patch anywhere at any time.
fn single_micros(world: &World) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut roots = Roots::default();
    let mut micros: Vec<f64> = (0..10_000)
        .map(|_| {
            let (time, instance) = (rng.random_range(0.0..1e6), rng.random_range(0..world.instances() as u32));
            let begin = Instant::now();
            let spot = Spot { instance, shift: DVec2::ZERO };
            world.roots_of(&world.moment(time), std::iter::once(spot), DVec2::ZERO, &mut roots);
            begin.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    micros.sort_by(f64::total_cmp);
    micros[micros.len() / 2]
}

/// A square of dense patches.
fn dense_world(people: usize, kinds: u64, unique: bool) -> Result<World> {
    let place = Template::new("place", "stone").bordered("place", PatternType::mixed(4, 4));
    let side = (people as f64 / 11.0).sqrt().ceil() as usize;
    // One pattern per border, so that versions are all the kinds.
    let plan = Plan::from_text(&"p".repeat(8), vec![('p', place)])?;
    let plan = Plan { cells: vec![vec![0; side]; side], patterns: 1, versions: kinds, endless: true, ..plan };
    let lattice = plan.build()?;
    if !unique {
        return plan.bake("dense", &lattice);
    }
    let kinds: Vec<(&CrowdPatch, u32)> = lattice.cells().iter().map(|&kind| (&lattice.kinds()[kind], 0)).collect();
    let place = |i: usize| DVec2::new((i % side) as f64, (i / side) as f64) * f64::from(plan.side);
    let placements: Vec<Placement> =
        (0..kinds.len()).map(|i| Placement { kind: i, origin: place(i), turn: 0.0 }).collect();
    let info = WorldInfo {
        templates: vec![TemplateInfo { name: "place".into(), ground: "stone".into() }],
        limits: WalkLimits::from(&Limits::default()),
        ..WorldInfo::default()
    };
    bake(info, &kinds, &placements, lattice.identities().clone())
}

/// Plays full bodies of a dense world on one core: people, and nanoseconds per body (where it is, how it looks, all joints'
/// rotations); the median of many frames.
///
/// # Errors
/// If nobody walks in `set`.
pub fn measure_poses(set: &PatchSet) -> Result<(usize, f64)> {
    let world = with_gait(&dense_world(10_000, 64, false)?, gait_table(set)?)?;
    let Some(gait) = &world.tables().gait else { return Ok((0, f64::NAN)) };
    let (mut bodies, mut poses) = (Vec::new(), [[Quat::IDENTITY; JOINT_COUNT]; BLOCK]);
    let mut hips = [Vec3::ZERO; BLOCK];
    let mut frame = |time: f64| {
        let begin = Instant::now();
        let spots = world.order().map(|instance| Spot { instance: instance as u32, shift: DVec2::ZERO });
        bodies.clear();
        world.bodies_of(spots, time, &mut bodies);
        for block in bodies.chunks(BLOCK) {
            gait.table.poses(block, &mut poses, &mut hips);
            std::hint::black_box((&poses, &hips));
        }
        (bodies.len(), begin.elapsed().as_secs_f64() * 1e9 / bodies.len().max(1) as f64)
    };
    let mut nanos: Vec<(usize, f64)> = (0..40).map(|i| frame(f64::from(i) * 0.31)).collect();
    nanos.sort_by(|a, b| a.1.total_cmp(&b.1));
    Ok(nanos[nanos.len() / 2])
}
