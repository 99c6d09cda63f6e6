//! The engine: a tiling that is perfect after every step.
//!
//! Seed adds one person at a time, led over the whole time by single-person patches. Enrich puts patches of several
//! people where people pass near each other and bridges the ripped tracks again. Mend tests the final bodies. All
//! three use one mechanism: rip up a window of a track and bridge it (recipe and reasons: ARCHITECTURE.md).

use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::bake::{Chains, bake};
use super::bridge::Taste;
use super::demands::admitted;
use super::domain::Domain;
use super::enrich::enrich;
use super::faults::faults;
use super::library::Library;
use super::mend::{dissolve, mend, perform};
use super::outcome::{Method, Options, Outcome, Phase, Progress, Status};
use super::seed::seed_person;
use super::tracks::{Tracks, Undo, Window};
use super::{Scene, paper};
use crate::patch::PatchSet;
use crate::refine::Performance;
use crate::{Error, Result};

/// Failed tries in a row after which no further person is wished for.
const SEED_PATIENCE: usize = 4000;
/// Every so many people one is wished for who begins with a box in the hands, for so many tries.
const LADEN_EVERY: usize = 20;
const LADEN_PATIENCE: usize = 60;
const LADEN_EXPANSIONS: usize = 300;
/// Failed tries in a row after which no further patch of several people is wished for.
const ENRICH_PATIENCE: usize = 90_000;
/// Failures in a row after which people are led other ways.
const STIR_AFTER: usize = 15_000;
/// Ticks before and after a piece that are then bridged anew.
const STIR_TICKS: i32 = 45;
/// The share is aimed at a little higher than wished for: mending may cost a patch or two.
const ABOVE_WISH: f32 = 1.04;
/// Largest share of the people's time in patches of several people that early rounds aim at.
const BUSIEST: f32 = 0.7;
/// Tries per person in the sweep through time, and how far ahead of it patches are put, ticks.
const SWEEP_TRIES: usize = 1000;
const SWEEP_TICKS: i32 = 30;
/// Rounds after which patches of several people are given up for a fault.
const GENTLE_ROUNDS: usize = 6;
/// States expanded to mend a fault.
const MEND_EXPANSIONS: usize = 1500;
/// How often patches of several people that mending cost are made up for.
const REFILLS: usize = 4;
/// Rounds of mending.
const MEND_ROUNDS: usize = 30;
/// Time between two reports of progress.
const REPORT_EVERY: Duration = Duration::from_millis(50);

/// Tiles a scene with a patch set.
///
/// `progress` is told about twenty times a second how far the run is, and stops it by returning false; the best tiling
/// so far is then the outcome. The same seed gives the same crowd for any number of threads unless time runs out.
///
/// # Errors
/// The scene has no room, or the set cannot make a perfect tiling: it is empty, or a pose group can be entered but
/// never left or the other way round.
pub fn tile(
    scene: &Scene,
    set: &PatchSet,
    options: &Options,
    progress: &mut dyn FnMut(&Progress) -> bool,
) -> Result<Outcome> {
    let set = &*admitted(scene, set, options.method)?;
    check_set(set)?;
    let domain = Domain::new(scene)?;
    match options.method {
        Method::Engine => Ok(engine(scene, set, &domain, options, progress)),
        Method::Paper => Ok(paper::tile(scene, set, &domain, options, progress)),
    }
}

fn check_set(set: &PatchSet) -> Result<()> {
    if let Some(problem) = set.validate().into_iter().next() {
        return Err(problem);
    }
    if set.kinds.is_empty() {
        return Err(Error::invalid("patch set", "kinds", "expected at least one kind, found none"));
    }
    let single = |k: &&crate::patch::PatchKind| k.people() == 1;
    let singles = || set.kinds.iter().filter(single).flat_map(|k| &k.fragments);
    for kind in &set.kinds {
        for (role, f) in kind.fragments.iter().enumerate() {
            let name = |group: u32| &set.groups[group as usize].name;
            let place = || format!("kind {}, role {role}", kind.name);
            if !singles().any(|s| s.entry_group == f.exit_group) {
                let problem =
                    format!("no single-person kind can follow its exit in pose group {:?}", name(f.exit_group));
                return Err(Error::invalid("patch set", place(), problem));
            }
            if !singles().any(|s| s.exit_group == f.entry_group) {
                let problem =
                    format!("no single-person kind can lead to its entry in pose group {:?}", name(f.entry_group));
                return Err(Error::invalid("patch set", place(), problem));
            }
        }
    }
    Ok(())
}

/// Reports progress now and then and knows when to stop.
pub(super) struct Clock<'a> {
    start: Instant,
    last_report: Instant,
    limit: Duration,
    stopped: bool,
    progress: &'a mut dyn FnMut(&Progress) -> bool,
}

impl<'a> Clock<'a> {
    pub(super) fn new(limit_secs: f64, progress: &'a mut dyn FnMut(&Progress) -> bool) -> Self {
        let now = Instant::now();
        Self {
            start: now,
            last_report: now,
            limit: Duration::from_secs_f64(limit_secs.max(0.0)),
            stopped: false,
            progress,
        }
    }

    /// False once time is up or the caller has had enough.
    pub(super) fn goes_on(&mut self, state: impl FnOnce() -> Progress) -> bool {
        let now = Instant::now();
        if !self.stopped && now - self.last_report >= REPORT_EVERY {
            self.last_report = now;
            let secs = self.secs();
            self.stopped = !(self.progress)(&Progress { secs, ..state() });
        }
        !self.stopped && now - self.start < self.limit
    }

    pub(super) fn secs(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }
}

fn engine(
    scene: &Scene,
    set: &PatchSet,
    domain: &Domain,
    options: &Options,
    progress: &mut dyn FnMut(&Progress) -> bool,
) -> Outcome {
    let mut clock = Clock::new(options.time_secs, progress);
    let mut rng = ChaCha8Rng::seed_from_u64(options.seed);
    let library = Library::new(set, scene.limits).preferring(&scene.preference);
    let mut tracks = Tracks::new(&library, domain);
    let taste = Taste { calm: calm(scene), expansions: 60 };

    // Patches of several people need room: they go in while the place is half empty, enough of them for all to come.
    for part in [3, 2, 1] {
        let people = scene.characters.div_ceil(part);
        seed(&mut tracks, people, taste, &mut clock, &mut rng);
        let wish = scene.interaction * ABOVE_WISH;
        let share = (wish * (scene.characters as f32 / people as f32)).min(BUSIEST);
        enrich_to(&mut tracks, share, taste, &mut clock, &mut rng);
    }
    let (played, left) = finish(&mut tracks, scene.interaction, taste, &mut clock, &mut rng);
    let status = status(tracks.chains(), scene, left);
    let crowd = bake(tracks.chains(), scene, options.seed, played);
    Outcome { crowd, status, danglings: 0, interpenetrations: left, solve_secs: clock.secs() }
}

/// The denser the crowd, the more people rather stand than walk.
fn calm(scene: &Scene) -> f32 {
    let density = scene.characters as f32 / scene.region.area();
    (1.58 - density).clamp(0.3, 1.3)
}

fn state(tracks: &Tracks, phase: Phase) -> Progress {
    let ports: usize = tracks.tracks.iter().map(|t| 2 * t.len()).sum();
    Progress {
        phase,
        patches: tracks.instances(),
        characters: tracks.tracks.len(),
        danglings: 0,
        multi_person_share: tracks.multi_person_share(),
        energy: paper::energy(ports, 0),
        secs: 0.0,
    }
}

fn seed(tracks: &mut Tracks, wish: usize, taste: Taste, clock: &mut Clock, rng: &mut ChaCha8Rng) {
    let mut failures = 0;
    let boxes = tracks.library.laden.contains(&true);
    while tracks.tracks.len() < wish && failures < SEED_PATIENCE && clock.goes_on(|| state(tracks, Phase::Seed)) {
        let laden = boxes && tracks.tracks.len().is_multiple_of(LADEN_EVERY) && failures < LADEN_PATIENCE;
        // Fewer patches go on with a box in the hands: the search needs longer.
        let taste = if laden { Taste { expansions: LADEN_EXPANSIONS, ..taste } } else { taste };
        failures = if seed_person(tracks, laden, taste, rng) { 0 } else { failures + 1 };
    }
}

/// Adds patches of several people until their share of the people's time is `wish`: once through time from its
/// beginning, when what comes after is free, then wherever there is room.
fn enrich_to(tracks: &mut Tracks, wish: f32, taste: Taste, clock: &mut Clock, rng: &mut ChaCha8Rng) {
    let kinds = tracks.library.multi.clone();
    if kinds.is_empty() || tracks.tracks.is_empty() {
        return;
    }
    let last = tracks.domain.horizon - 15;
    let mut share = tracks.multi_person_share();
    let tries = SWEEP_TRIES * tracks.tracks.len();
    let sweep = (0..tries).map(|i| {
        let tick = (i * last as usize / tries) as i32;
        tick..(tick + SWEEP_TICKS).min(last)
    });
    let mut failures = 0;
    for ticks in sweep.chain(std::iter::repeat(0..last)) {
        if share >= wish || failures > ENRICH_PATIENCE || !clock.goes_on(|| state(tracks, Phase::Enrich)) {
            return;
        }
        let kind = kinds[rng.random_range(0..kinds.len())];
        if enrich(tracks, kind, ticks, taste, rng) {
            failures = 0;
            share = tracks.multi_person_share();
        } else {
            failures += 1;
            if failures.is_multiple_of(STIR_AFTER) {
                stir(tracks, taste, rng);
            }
        }
    }
}

/// Leads everybody another way for some seconds, where there is one: new neighbours meet.
fn stir(tracks: &mut Tracks, taste: Taste, rng: &mut ChaCha8Rng) {
    for track in 0..tracks.tracks.len() {
        let from = rng.random_range(0..tracks.tracks[track].len());
        if tracks.people_of(tracks.tracks[track][from]) > 1 {
            continue;
        }
        let mut undo = Undo::default();
        let window = tracks.widen(Window { track, from, to: from + 1 }, STIR_TICKS);
        tracks.hide_window(window, &mut undo);
        match tracks.bridge_window(window, taste, rng, &mut undo) {
            Some(()) => tracks.commit(undo),
            None => tracks.roll_back(undo),
        }
    }
}

/// Mends, and where that cost more patches of several people than it may, puts new ones in and mends again; the
/// performance and the number of faults left.
fn finish(
    tracks: &mut Tracks,
    wish: f32,
    taste: Taste,
    clock: &mut Clock,
    rng: &mut ChaCha8Rng,
) -> (Performance, usize) {
    let mut found = mend_all(tracks, taste, clock, rng);
    for _ in 0..REFILLS {
        let share = tracks.multi_person_share();
        if share >= wish || found.1 > 0 {
            break;
        }
        enrich_to(tracks, wish * ABOVE_WISH, taste, clock, rng);
        if tracks.multi_person_share() <= share {
            break;
        }
        found = mend_all(tracks, taste, clock, rng);
    }
    found
}

/// Tests final bodies and bridges anew until none interpenetrate; the performance and the number of faults left.
fn mend_all(tracks: &mut Tracks, taste: Taste, clock: &mut Clock, rng: &mut ChaCha8Rng) -> (Performance, usize) {
    let mut round = 0;
    loop {
        let played = perform(tracks.chains());
        let faults = faults(tracks.chains(), &played);
        round += 1;
        if faults.is_empty() || round > MEND_ROUNDS || !clock.goes_on(|| state(tracks, Phase::Mend)) {
            return (played, faults.len());
        }
        let taste = Taste { expansions: MEND_EXPANSIONS, ..taste };
        for fault in faults {
            if round < GENTLE_ROUNDS || !dissolve(tracks, fault, taste, rng) {
                mend(tracks, fault, taste, rng);
            }
        }
    }
}

fn status(chains: Chains, scene: &Scene, faults: usize) -> Status {
    match faults {
        0 => wishes(chains, scene),
        _ => Status::Imperfect(format!("{faults} faults of the final bodies are left")),
    }
}

/// The status of a tiling without danglings and interpenetrations: which wish is unmet.
pub(super) fn wishes(chains: Chains, scene: &Scene) -> Status {
    let share = chains.multi_person_share();
    if chains.lists.len() < scene.characters {
        Status::Short(format!("{} of {} characters found room", chains.lists.len(), scene.characters))
    } else if share < scene.interaction && !chains.library.multi.is_empty() {
        Status::Short(format!(
            "{share:.3} of {:.3} of the time is spent in patches of several people",
            scene.interaction
        ))
    } else {
        Status::Perfect
    }
}
