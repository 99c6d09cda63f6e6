//! The engine: a tiling that is perfect after every step.
//!
//! Gather puts in people who meet, while there is room. Seed adds people who walk alone. Enrich puts further patches of
//! several people where people pass near each other and bridges the ripped tracks again. Mend tests the final bodies.
//! All four propose whole changes that a [`Crew`] works out side by side (recipe and reasons: ARCHITECTURE.md).
//!
//! | file | what |
//! |---|---|
//! | `mod.rs` | runs, and their stages one after the other |
//! | `arrivals.rs` | people who are to be somewhere at some time |
//! | `people.rs` | people who find room anywhere: they meet, stand, come alone |
//! | `company.rs` | further patches of several people |
//! | `mending.rs` | final bodies |

mod arrivals;
mod company;
mod mending;
mod people;

use super::bake::{Chains, bake};
use super::bridge::Taste;
use super::checkpoint::{About, Agenda, Keep, Keeper, Stage, thaw};
use super::clock::Clock;
use super::crew::Crew;
use super::demands::{admitted, check_set};
use super::domain::Domain;
use super::library::Library;
use super::outcome::{Method, Options, Outcome, Phase, Progress, Status};
use super::pace::Pace;
use super::passage::Passages;
use super::plan::Plan;
use super::rehearsal::Rehearsal;
use super::session::{Session, first_agenda, further_agenda};
use super::team::team_of;
use super::tracks::Tracks;
use super::wang::{Crosser, Gap};
use super::{Scene, paper, wang};
use crate::patch::PatchSet;
use crate::{Error, Result};
use people::{COMPACT, calm, is_dense};

/// States expanded to lead people to and from where they meet.
const GATHER_EXPANSIONS: usize = 300;
/// States expanded for each step that it takes to the end of time.
const EXPANSIONS_PER_STEP: usize = 4;
/// Failed tries per person in a row after which no further patch of several people is wished for: before all people are
/// there, and at the end.
const FIRST_PATIENCE: usize = 40;
const ENRICH_PATIENCE: usize = 80;
/// The share is aimed at a little higher than wished for: mending may cost a patch or two.
const ABOVE_WISH: f32 = 1.05;
/// How often patches of several people that mending cost are made up for.
const REFILLS: usize = 4;
/// A tile may be short of company, if others are not: the same for tiles, and the part of the company wished for that is
/// enough for now if another seed can be tried instead.
const TILE_PATIENCE: usize = 12;
const TILE_REFILLS: usize = 1;
const TILE_COMPANY: f32 = 0.85;

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
    tile_in(Session::default(), scene, set, options, progress)
}

/// The same from a checkpoint on, or with checkpoints written. From the same checkpoint on the same seed gives the same
/// crowd, which is not the one of a run that was never interrupted.
///
/// # Errors
/// As [`tile`]; the checkpoint is not a tiling of the scene with the set, or the method has none.
pub fn tile_in(
    session: Session,
    scene: &Scene,
    set: &PatchSet,
    options: &Options,
    progress: &mut dyn FnMut(&Progress) -> bool,
) -> Result<Outcome> {
    if let Some(kept) = session.from {
        kept.expect_set(set)?;
    }
    let about = |keep: Keep| About::new(scene, set, options.seed, keep);
    let keeper = Keeper::new(session.keep, about);
    let set = &*admitted(scene, set, options.method)?;
    check_set(set)?;
    if let Some(wang) = scene.wang {
        if session.from.is_some() || session.keep.is_some() {
            return Err(Error::invalid(
                "checkpoint",
                "wang",
                "expected a scene without tiles: they are laid when all are done",
            ));
        }
        return wang::tile(scene, wang, set, options, progress);
    }
    let domain = Domain::new(scene)?;
    match options.method {
        Method::Engine => engine(session, keeper, scene, set, &domain, options, progress),
        Method::Paper if session.from.is_some() || session.keep.is_some() => {
            Err(Error::invalid("checkpoint", "method", "expected the engine: the paper's algorithms keep none"))
        }
        Method::Paper => Ok(paper::tile(scene, set, &domain, options, progress)),
    }
}

fn engine(
    Session { from, steps, .. }: Session,
    keeper: Keeper,
    scene: &Scene,
    set: &PatchSet,
    domain: &Domain,
    options: &Options,
    progress: &mut dyn FnMut(&Progress) -> bool,
) -> Result<Outcome> {
    let clock = Clock::new(options.time_secs, progress).asked_at_most(steps);
    let library = Library::new(set, scene.limits).preferring(&scene.preference).placing(&scene.placed).parting(scene);
    let (tracks, agenda) = match from {
        Some(kept) => (thaw(kept, scene, &library, domain)?, further_agenda(kept, scene)),
        None => (Tracks::new(&library, domain), first_agenda(scene)),
    };
    let crew = Crew::new(tracks, scene.region.area(), options.seed).going_on(agenda.drawn);
    let passages = Passages::new(&library);
    // Whoever goes on does not wish for the same gatherings again.
    let mut engine = Engine::new(scene, &passages, crew, options.seed.wrapping_add(agenda.drawn), clock);
    engine.most += agenda.admitted;
    (engine.agenda, engine.keeper) = (agenda, keeper);
    engine.before = from.map_or(0.0, |kept| kept.reached.secs);
    engine.search();
    let rehearsal = engine.finish(REFILLS);
    engine.keep();
    let Engine { mut crew, clock, agenda, keeper, .. } = engine;
    crew.tracks.occupancy.close();
    let interpenetrations = rehearsal.faults.len();
    let status = status(crew.tracks.chains(), scene, interpenetrations, agenda.placed);
    let mut crowd = bake(crew.tracks.chains(), scene, options.seed, rehearsal);
    for (person, character) in crowd.characters.iter_mut().enumerate() {
        character.team = team_of(&crew.tracks, person).map(|team| team as u32);
    }
    let (solve_secs, unkept) = (clock.secs(), keeper.into_problem());
    Ok(Outcome { crowd, status, danglings: 0, interpenetrations, solve_secs, unkept })
}

/// What those bring along who cross a tile's borders or live on them.
pub(super) struct Shared<'c> {
    /// Who is to come or to go.
    pub crossers: &'c [Crosser],
    /// Ticks that they are to be in this tile, the border included.
    pub crossing: usize,
    /// Ticks in patches of several people that are wished for besides, since those on its borders have fewer; negative if
    /// they have more.
    pub lack: f32,
}

/// Fills the strip along an edge between tiles, which others cross for so many ticks in all.
pub(super) fn fill_edge<'a>(
    scene: &'a Scene,
    passages: &'a Passages<'a>,
    tracks: Tracks<'a>,
    crossing: usize,
    seed: u64,
    clock: Clock<'a>,
) -> Tracks<'a> {
    let crew = Crew::new(tracks, scene.region.area(), seed);
    let mut engine = Engine::new(scene, passages, crew, seed, clock);
    engine.visiting = crossing;
    engine.gather();
    engine.stand();
    engine.add_the_others();
    engine.finish(REFILLS);
    engine.crew.tracks
}

/// Fills a tile of a plane: some of `residents` meet while there is room, then those who cross its borders are led there and
/// from there, stopped or not, then the others are added as anywhere.
///
/// # Errors
/// Those who find no way; nobody if few people meet, which another seed may do better, and who is picky minds.
pub(super) fn fill<'a>(
    scene: &'a Scene,
    passages: &'a Passages<'a>,
    tracks: Tracks<'a>,
    (shared, residents): (&Shared, usize),
    (seed, picky): (u64, bool),
    clock: Clock<'a>,
) -> std::result::Result<Tracks<'a>, Vec<Gap>> {
    let crew = Crew::new(tracks, scene.region.area(), seed);
    let mut engine = Engine::new(scene, passages, crew, seed, clock);
    (engine.most, engine.visiting, engine.lack) = (residents, shared.crossing, shared.lack);
    engine.gather();
    let enough = TILE_COMPANY * engine.company_wish() as f32;
    if picky && (engine.crew.tracks.company() as f32) < enough && engine.goes_on(Phase::Seed) {
        return Err(vec![]);
    }
    engine.cross(shared.crossers.iter().collect())?;
    (engine.most, engine.visiting) = (residents + shared.crossers.len(), 0);
    // What is short now is dear, and many tiles have a little more than they need.
    (engine.above, engine.patience) = (1.0, TILE_PATIENCE);
    engine.stand();
    engine.add_the_others();
    engine.finish(TILE_REFILLS);
    Ok(engine.crew.tracks)
}

/// Mends a tiling that was put together, if it has faults.
pub(super) fn mend_laid<'a>(
    scene: &'a Scene,
    passages: &'a Passages<'a>,
    tracks: Tracks<'a>,
    mut rehearsal: Rehearsal,
    seed: u64,
    clock: Clock<'a>,
) -> (Tracks<'a>, Rehearsal) {
    let crew = Crew::new(tracks, scene.region.area(), seed);
    let mut engine = Engine::new(scene, passages, crew, seed, clock);
    engine.mend(&mut rehearsal);
    (engine.crew.tracks, rehearsal)
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

/// A run.
struct Engine<'a> {
    scene: &'a Scene,
    crew: Crew<'a>,
    passages: &'a Passages<'a>,
    plan: Plan<'a>,
    taste: Taste,
    clock: Clock<'a>,
    /// Most people: those who are there anyway, those of the teams, and those who came in.
    most: usize,
    /// Ticks of others who are still to come.
    visiting: usize,
    /// Ticks in patches of several people that are wished for besides, or fewer.
    lack: f32,
    /// Failed tries per person in a row after which no more patches of several people are wished for.
    patience: usize,
    /// How much more company is aimed at than is wished for.
    above: f32,
    agenda: Agenda,
    keeper: Keeper<'a>,
    /// Seconds that earlier runs have taken.
    before: f64,
    pace: Pace,
}

impl<'a> Engine<'a> {
    /// From the beginning, without checkpoints.
    fn new(scene: &'a Scene, passages: &'a Passages<'a>, crew: Crew<'a>, seed: u64, clock: Clock<'a>) -> Self {
        let (library, horizon) = (crew.tracks.library, crew.tracks.domain.horizon);
        Self {
            scene,
            passages,
            plan: Plan::new(library, passages, horizon, seed),
            taste: Taste {
                calm: calm(scene),
                compact: if is_dense(scene) { COMPACT } else { 0.0 },
                expansions: library.steps(horizon) * EXPANSIONS_PER_STEP,
            },
            crew,
            clock,
            most: scene.characters,
            visiting: 0,
            lack: 0.0,
            patience: ENRICH_PATIENCE,
            above: ABOVE_WISH,
            agenda: Agenda::default(),
            keeper: Keeper::none(),
            before: 0.0,
            pace: Pace::default(),
        }
    }

    /// Adds people who come alone, and patches of several people where company is short.
    fn add_the_others(&mut self) {
        self.enrich(FIRST_PATIENCE);
        self.seed();
        self.enrich(self.patience);
    }

    /// All that comes before the final bodies are tested.
    fn search(&mut self) {
        self.at(Stage::Place, Self::keyframes);
        self.at(Stage::LineUp, Self::line_up);
        self.at(Stage::LetIn, Self::let_in);
        self.at(Stage::Hurdle, Self::hurdle);
        self.at(Stage::Gather, Self::gather);
        self.at(Stage::Stand, Self::stand);
        self.at(Stage::Acquaint, |engine| engine.enrich(FIRST_PATIENCE));
        self.at(Stage::Seed, Self::seed);
        self.at(Stage::Enrich, |engine| engine.enrich(engine.patience));
        self.at(Stage::Mend, |_| ());
        self.keep();
    }

    /// Works at a stage, unless an earlier run is through with it or time is up.
    fn at(&mut self, stage: Stage, work: impl FnOnce(&mut Self)) {
        if self.agenda.stage <= stage && !self.clock.is_over() {
            self.agenda.stage = stage;
            work(self);
        }
    }

    fn goes_on(&mut self, phase: Phase) -> bool {
        if self.keeper.is_due() {
            self.keep();
        }
        let tracks = &self.crew.tracks;
        if !self.clock.is_over() && self.pace.is_wanted(self.clock.gone(), tracks.tracks.len()) {
            self.pace.measure(tracks.chains(), self.crew.seed);
        }
        let people = tracks.tracks.len();
        let mending = phase == Phase::Mend;
        self.clock.reserve = if mending { self.pace.baking(people) } else { self.pace.ending(people) };
        self.clock.goes_on(|| state(tracks, phase))
    }

    /// Writes a checkpoint, if that is wanted.
    fn keep(&mut self) {
        let Crew { tracks, .. } = &self.crew;
        let (drawn, next_instance) = (self.crew.drawn(), tracks.next_instance());
        self.agenda = Agenda { drawn, next_instance, ..std::mem::take(&mut self.agenda) };
        self.keeper.write(tracks, &self.agenda, self.before + self.clock.secs());
    }

    /// Ticks in patches of several people that are aimed at when everybody is there.
    fn company_wish(&self) -> usize {
        let to_come = self.people_left() * self.crew.tracks.domain.horizon as usize + self.visiting;
        self.company_of(self.crew.tracks.presence() + to_come, self.above) as usize
    }

    /// Ticks in patches of several people if those who are there for some ticks are together as long as wished for, or `above`
    /// times as long.
    fn company_of(&self, presence: usize, above: f32) -> f32 {
        self.scene.interaction * above * presence as f32 + self.lack
    }

    fn people_left(&self) -> usize {
        self.most.saturating_sub(self.crew.tracks.tracks.len())
    }
}

/// How a run ended: `placed` if what the scene has placed is there.
pub(super) fn status(chains: Chains, scene: &Scene, faults: usize, placed: bool) -> Status {
    match faults {
        _ if !placed => Status::Imperfect("no ways were found to and from the placed patches".into()),
        0 => wishes(chains, scene),
        _ => Status::Imperfect(format!("{faults} faults of the final bodies are left")),
    }
}

/// The status of a tiling without danglings and interpenetrations: which wish is unmet.
pub(super) fn wishes(chains: Chains, scene: &Scene) -> Status {
    let share = chains.multi_person_share();
    let wanted = scene.people();
    if chains.lists.len() < wanted {
        Status::Short(format!("{} of {wanted} characters found room", chains.lists.len()))
    } else if share < scene.interaction && !chains.library.multi.is_empty() {
        Status::Short(format!(
            "{share:.3} of {:.3} of the time is spent in patches of several people",
            scene.interaction
        ))
    } else {
        Status::Perfect
    }
}
