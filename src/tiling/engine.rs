//! The engine: a tiling that is perfect after every step.
//!
//! Gather puts in people who meet, while there is room. Seed adds people who walk alone. Enrich puts further patches of
//! several people where people pass near each other and bridges the ripped tracks again. Mend tests the final bodies.
//! All four propose whole changes that a [`Crew`] works out side by side (recipe and reasons: ARCHITECTURE.md).

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::bake::{Chains, bake};
use super::bridge::Taste;
use super::checkpoint::{About, Agenda, Keep, Keeper, Stage, thaw};
use super::clock::Clock;
use super::crew::Crew;
use super::demands::{admitted, check_set};
use super::domain::Domain;
use super::draft::Draft;
use super::enrich::enrich;
use super::gather::{Wish, gather};
use super::hurdle::{hurdle, jumpers};
use super::keyframe::keyframes;
use super::library::Library;
use super::mend::{dissolve, mend, restand};
use super::outcome::{Method, Options, Outcome, Phase, Progress, Status};
use super::pace::Pace;
use super::passage::Passages;
use super::plan::Plan;
use super::rehearsal::Rehearsal;
use super::seed::{seed_person, settle, stand_beside};
use super::session::{Session, first_agenda, further_agenda};
use super::source::let_in;
use super::swept::Swept;
use super::team::{line_up, team_of};
use super::tracks::{Change, Tracks, Window};
use super::wang::{Crosser, Gap, lead_across};
use super::wedge::wedge;
use super::{Scene, paper, wang};
use crate::patch::PatchSet;
use crate::{Error, Result};

/// Rounds of tries for people who come in at a source or begin in the place of a team.
const ADMIT_ROUNDS: usize = 25;
/// Rounds of tries for people who cross a tile's borders.
const CROSS_ROUNDS: usize = 8;
/// Rounds of tries for everybody in a placed patch to find their ways.
const KEYFRAME_TRIES: usize = 25;
/// States expanded for each of the ways.
const KEYFRAME_EXPANSIONS: usize = 600;
/// One in so many people jumps over something, where there is something low.
const HURDLERS: usize = 6;
/// Failed tries in a row after which nobody more jumps.
const HURDLE_PATIENCE: usize = 200;
/// Failed gatherings in a row after which people come alone.
const GATHER_PATIENCE: usize = 400;
/// States expanded to lead people to and from where they meet.
const GATHER_EXPANSIONS: usize = 300;
/// More people per m^2 than that is dense: then so large a share of their time those who meet do so at least, since whoever
/// comes and goes needs the more room.
const DENSE: f32 = 0.85;
const DENSE_TOGETHER: f32 = 0.65;
/// There people rather stand, and compactly.
const DENSE_CALM: f32 = 0.25;
const COMPACT: f32 = 4.0;
/// Of so many gatherings that are worked out at one person per m^2, so many are made: those that sweep the least ground.
const RIVALS: f32 = 18.0;
const BEST: usize = 3;
/// Their number grows with this power of the density.
const RIVALRY: i32 = 4;
const MOST_RIVALS: usize = 200;
/// The part of the people who then stand close together, up to 1.2 and from 2 people per m^2.
const STANDERS: [f32; 2] = [0.3, 0.75];
const STAND_DENSITIES: [f32; 2] = [1.2, 2.0];
/// Failed tries in a row after which nobody more stands close to others, and states expanded for each.
const STAND_PATIENCE: usize = 400;
const STAND: Taste = Taste { calm: 0.02, compact: COMPACT, expansions: 200 };
/// Where those to come would have to be together for more than this share of their time, no more are gathered.
const HOPELESS: f32 = 0.7;
/// States expanded for each step that it takes to the end of time.
const EXPANSIONS_PER_STEP: usize = 4;
/// Failed tries in a row after which no further person is wished for.
const SEED_PATIENCE: usize = 4000;
/// After so many of them searches take longer, up to so many times.
const SEED_AGAIN: usize = 200;
const SEED_EFFORT: usize = 6;
/// After so many, where it is dense, others are asked to make room, all but one in so many times.
const WEDGE_AFTER: usize = 60;
const WEDGE_BUT: usize = 4;
/// Every so many people one is wished for who begins with a box in the hands, for so many tries; the more, the more of
/// that is wanted.
const LADEN_EVERY: usize = 20;
const LADEN_PATIENCE: usize = 60;
const LADEN_EXPANSIONS: usize = 300;
/// Failed tries per person in a row after which no further patch of several people is wished for: before all people are
/// there, and at the end.
const FIRST_PATIENCE: usize = 40;
const ENRICH_PATIENCE: usize = 80;
/// Failures per person in a row after which people are led other ways.
const STIR_AFTER: usize = 14;
/// Ticks before and after a piece that are then bridged anew.
const STIR_TICKS: i32 = 45;
/// The share is aimed at a little higher than wished for: mending may cost a patch or two.
const ABOVE_WISH: f32 = 1.05;
/// Tries per person in the sweep through time, and how far ahead of it patches are put, ticks.
const SWEEP_TRIES: usize = 60;
const SWEEP_TICKS: i32 = 30;
/// Rounds after which patches of several people are given up for a fault.
const GENTLE_ROUNDS: usize = 6;
/// States expanded to mend a fault.
const MEND_EXPANSIONS: usize = 1500;
/// How often patches of several people that mending cost are made up for.
const REFILLS: usize = 4;
/// A tile may be short of company, if others are not: the same for tiles, and the part of the company wished for that is
/// enough for now if another seed can be tried instead.
const TILE_PATIENCE: usize = 12;
const TILE_REFILLS: usize = 1;
const TILE_COMPANY: f32 = 0.85;
/// Rounds of mending.
const MEND_ROUNDS: usize = 30;

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
    let Rehearsal { played, faults, .. } = engine.finish(REFILLS);
    engine.keep();
    let Engine { mut crew, clock, agenda, keeper, .. } = engine;
    crew.tracks.occupancy.close();
    let status = status(crew.tracks.chains(), scene, faults.len(), agenda.placed);
    let mut crowd = bake(crew.tracks.chains(), scene, options.seed, played);
    for (person, character) in crowd.characters.iter_mut().enumerate() {
        character.team = team_of(&crew.tracks, person).map(|team| team as u32);
    }
    let (interpenetrations, unkept) = (faults.len(), keeper.into_problem());
    Ok(Outcome { crowd, status, danglings: 0, interpenetrations, solve_secs: clock.secs(), unkept })
}

/// Fills a tile of a plane: some of `residents` meet while it is empty, then those who cross its borders are led there and
/// from there, stopped or not, then the others are added as anywhere.
///
/// # Errors
/// Those who find no way; nobody if few people meet, which another seed may do better, and who is picky minds.
pub(super) fn fill<'a>(
    scene: &'a Scene,
    passages: &'a Passages<'a>,
    tracks: Tracks<'a>,
    (crossers, residents): (&[Crosser], usize),
    (seed, picky): (u64, bool),
    clock: Clock<'a>,
) -> std::result::Result<Tracks<'a>, Vec<Gap>> {
    let crew = Crew::new(tracks, scene.region.area(), seed);
    let mut engine = Engine::new(scene, passages, crew, seed, clock);
    // Half the life of who crosses a border is here, or some more.
    (engine.most, engine.visitors, engine.patience) = (residents, crossers.len() * 5 / 8, TILE_PATIENCE);
    engine.gather();
    let enough = TILE_COMPANY * engine.company_wish() as f32;
    if picky && (engine.crew.tracks.company() as f32) < enough && engine.goes_on(Phase::Seed) {
        return Err(vec![]);
    }
    engine.cross(crossers.iter().collect())?;
    (engine.most, engine.visitors) = (crossers.len() + residents, 0);
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

/// The denser the crowd, the more people rather stand than walk.
fn calm(scene: &Scene) -> f32 {
    if is_dense(scene) { DENSE_CALM } else { 1.58 - density(scene) }.min(1.3)
}

/// Whether there is so little room that it is shared out with care.
fn is_dense(scene: &Scene) -> bool {
    density(scene) > DENSE
}

/// How many gatherings vie for room.
fn rivals(scene: &Scene) -> usize {
    ((RIVALS * density(scene).powi(RIVALRY)) as usize).clamp(BEST, MOST_RIVALS)
}

/// People per m^2.
fn density(scene: &Scene) -> f32 {
    scene.characters as f32 / scene.region.area()
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
    /// Whole lives of others who are still to come.
    visitors: usize,
    /// Failed tries per person in a row after which no more patches of several people are wished for.
    patience: usize,
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
            visitors: 0,
            patience: ENRICH_PATIENCE,
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

    /// Leads all who cross a tile's borders to and from where they do; an error are those who find no way.
    fn cross(&mut self, mut left: Vec<&Crosser>) -> std::result::Result<(), Vec<Gap>> {
        let taste = Taste { expansions: GATHER_EXPANSIONS, ..self.taste };
        for _ in 0..CROSS_ROUNDS {
            let made = self.crew.work(left.len(), |i, draft, rng| lead_across(draft, left[i], taste, rng), |_, _| true);
            left = left.into_iter().zip(made).filter(|(_, made)| !made).map(|(crosser, _)| crosser).collect();
        }
        let stuck: Vec<Gap> = left.into_iter().map(|crosser| crosser.gap).collect();
        if stuck.is_empty() { Ok(()) } else { Err(stuck) }
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
        let ticks = self.crew.tracks.presence()
            + (self.people_left() + self.visitors) * self.crew.tracks.domain.horizon as usize;
        (self.scene.interaction * ABOVE_WISH * ticks as f32) as usize
    }

    fn people_left(&self) -> usize {
        self.most.saturating_sub(self.crew.tracks.tracks.len())
    }

    /// Puts the teams in their places.
    fn line_up(&mut self) {
        let taste = Taste { expansions: GATHER_EXPANSIONS, ..self.taste };
        for team in 0..self.scene.teams.len() {
            let (people, others): (Vec<usize>, Vec<usize>) = self.agenda.lining_up.iter().partition(|&&t| t == team);
            let waiting = |agenda: &mut Agenda, left: Vec<usize>| agenda.lining_up = [&others[..], &left].concat();
            self.admit(people, waiting, &|draft, team, rng| line_up(draft, team, taste, rng));
        }
    }

    /// Lets people in at the sources.
    fn let_in(&mut self) {
        let taste = Taste { expansions: GATHER_EXPANSIONS, ..self.taste };
        let (people, waiting) = (self.agenda.coming.clone(), |agenda: &mut Agenda, left| agenda.coming = left);
        self.admit(people, waiting, &|draft, arrival, rng| let_in(draft, arrival, taste, rng));
    }

    /// Puts in people who are to be somewhere at some time, as many of them as find room in some rounds; `waiting` takes
    /// note of the others.
    fn admit<T: Copy + Sync>(
        &mut self,
        mut people: Vec<T>,
        waiting: impl Fn(&mut Agenda, Vec<T>),
        propose: &(impl Fn(&mut Draft, T, &mut ChaCha8Rng) -> Option<()> + Sync),
    ) {
        for _ in 0..ADMIT_ROUNDS {
            let mut left = Vec::new();
            for (k, some) in people.chunks(self.crew.batch).enumerate() {
                waiting(&mut self.agenda, [&left[..], &people[k * self.crew.batch..]].concat());
                if !self.goes_on(Phase::Seed) {
                    return;
                }
                let made = self.crew.work(some.len(), |i, draft, rng| propose(draft, some[i], rng), |_, _| true);
                let admitted = made.iter().filter(|&&made| made).count();
                (self.most, self.agenda.admitted) = (self.most + admitted, self.agenda.admitted + admitted);
                left.extend(some.iter().zip(made).filter(|(_, made)| !made).map(|(&person, _)| person));
            }
            waiting(&mut self.agenda, left.clone());
            people = left;
        }
    }

    /// Puts in what the scene has placed, if everybody finds ways to and from it.
    fn keyframes(&mut self) {
        let placed = &self.scene.placed;
        let taste = Taste { expansions: KEYFRAME_EXPANSIONS, ..self.taste };
        self.agenda.placed = placed.is_empty()
            || (0..KEYFRAME_TRIES).any(|_| {
                self.goes_on(Phase::Seed) && self.crew.work_one(|draft, rng| keyframes(draft, placed, taste, rng))
            });
    }

    /// Adds people who jump over what is low enough, if there is such.
    fn hurdle(&mut self) {
        let jumpers = jumpers(self.crew.tracks.library);
        let low = self.scene.obstacles.iter().any(|o| o.height.is_some());
        let most = self.crew.tracks.tracks.len() + self.people_left().div_ceil(HURDLERS);
        let mut failures = 0;
        while low && !jumpers.is_empty() && failures < HURDLE_PATIENCE && self.goes_on(Phase::Seed) {
            let count = self.crew.batch.min(most.saturating_sub(self.crew.tracks.tracks.len()));
            if count == 0 {
                return;
            }
            let taste = Taste { expansions: GATHER_EXPANSIONS, ..self.taste };
            let made = self.crew.work(count, |_, draft, rng| hurdle(draft, &jumpers, taste, rng), |_, _| true);
            failures = if made.contains(&true) { 0 } else { failures + count };
        }
    }

    /// Adds people who meet until there is as much company as wished for.
    fn gather(&mut self) {
        let (library, passages) = (self.crew.tracks.library, self.passages);
        let (wish, most) = (self.company_wish(), self.most);
        if library.multi.is_empty() || wish == 0 || self.people_left() == 0 || !self.scene.teams.is_empty() {
            return;
        }
        let taste = Taste { expansions: GATHER_EXPANSIONS, ..self.taste };
        let dense = is_dense(self.scene);
        let least = if dense { DENSE_TOGETHER } else { 0.0 };
        let (mut swept, mut failures) = (Swept::of(&self.crew.tracks), 0);
        while self.crew.tracks.company() < wish && failures < GATHER_PATIENCE && self.goes_on(Phase::Seed) {
            let (left, tracks) = (self.people_left(), &self.crew.tracks);
            let need = wish.saturating_sub(tracks.company()) as f32 / (left * tracks.domain.horizon as usize) as f32;
            if left < 2 || need > HOPELESS {
                break;
            }
            let count = if dense { rivals(self.scene) } else { self.crew.batch.min(left.div_ceil(2)) };
            let wishes: Vec<Wish> = (0..count).map(|_| self.plan.draw(need.max(least))).collect();
            let propose =
                |i: usize, draft: &mut Draft, rng: &mut ChaCha8Rng| gather(draft, passages, wishes[i], taste, rng);
            let wanted = |tracks: &Tracks, change: &Change| {
                tracks.tracks.len() + change.newcomers() <= most && tracks.company() < wish
            };
            let made = match dense {
                true => self.crew.work_best((count, BEST), &mut swept, propose, wanted),
                false => self.crew.work(count, propose, wanted),
            };
            self.plan.learn(&wishes, &made);
            failures = if made.contains(&true) { 0 } else { failures + made.len() };
        }
    }

    /// Where it is to be dense, adds people who stand close together, so that the others have room.
    fn stand(&mut self) {
        if !is_dense(self.scene) || !self.scene.teams.is_empty() {
            return;
        }
        let [sparse, full] = STAND_DENSITIES;
        let dense = ((density(self.scene) - sparse) / (full - sparse)).clamp(0.0, 1.0);
        let standers = (STANDERS[0] + (STANDERS[1] - STANDERS[0]) * dense) * self.scene.characters as f32;
        let most = self.most.min(self.crew.tracks.tracks.len() + standers as usize);
        let mut failures = 0;
        while self.crew.tracks.tracks.len() < most && failures < STAND_PATIENCE && self.goes_on(Phase::Seed) {
            let count = self.crew.batch.min(most - self.crew.tracks.tracks.len());
            let made = self.crew.work(count, |_, draft, rng| stand_beside(draft, STAND, rng), |_, _| true);
            failures = if made.contains(&true) { 0 } else { failures + count };
        }
    }

    /// Adds people who come alone until there are as many as wished for.
    fn seed(&mut self) {
        let boxes = self.crew.tracks.library.laden.contains(&true);
        let every = laden_every(self.crew.tracks.library);
        let dense = is_dense(self.scene) && !self.crew.tracks.domain.cycle.loops();
        let (mut failures, mut round) = (0, 0);
        while self.people_left() > 0 && failures < SEED_PATIENCE && self.goes_on(Phase::Seed) {
            round += 1;
            let laden = boxes && self.people_left().is_multiple_of(every) && failures < LADEN_PATIENCE;
            let count = if laden { 1 } else { self.crew.batch.min(self.people_left()) };
            let wedges = dense && !laden && failures > WEDGE_AFTER && round % WEDGE_BUT > 0;
            let made = if wedges { self.wedge(count) } else { self.come_alone(count, laden, failures) };
            failures = match made {
                true if wedges => WEDGE_AFTER + 1,
                true => 0,
                false => failures + count,
            };
            if failures > SEED_AGAIN {
                self.crew.work(self.crew.batch, |_, draft, rng| settle(draft, STAND, rng), |_, _| true);
            }
        }
    }

    /// Tries to add some people who come alone after so many failures in a row; whether somebody found room.
    fn come_alone(&mut self, count: usize, laden: bool, failures: usize) -> bool {
        // Fewer patches go on with a box in the hands: the search needs longer.
        let patience = (1 + failures / SEED_AGAIN).min(SEED_EFFORT);
        let least = if laden { LADEN_EXPANSIONS } else { 0 };
        let taste = Taste { expansions: (patience * self.taste.expansions).max(least), ..self.taste };
        self.crew.work(count, |_, draft, rng| seed_person(draft, laden, taste, rng), |_, _| true).contains(&true)
    }

    /// Tries to add some people for whom others make room; whether somebody found it.
    fn wedge(&mut self, count: usize) -> bool {
        let taste = self.taste;
        self.crew.work(count, |_, draft, rng| wedge(draft, STAND, taste, rng), |_, _| true).contains(&true)
    }

    /// Adds patches of several people until there is as much company as wished for: once through time from its
    /// beginning, when what comes after is free, then wherever there is room.
    fn enrich(&mut self, patience: usize) {
        let (people, last) = (self.crew.tracks.tracks.len(), self.crew.tracks.domain.horizon - SWEEP_TICKS / 2);
        if self.crew.tracks.library.multi.is_empty() || people == 0 {
            return;
        }
        let (wish, tries, taste) = (self.company_wish(), SWEEP_TRIES * people, self.taste);
        let (mut done, mut failures, mut since_stir) = (0, 0, 0);
        while self.crew.tracks.company() < wish && failures < patience * people && self.goes_on(Phase::Enrich) {
            let ticks = |i: usize| match (done + i) * last as usize / tries {
                tick if tick < last as usize => tick as i32..(tick as i32 + SWEEP_TICKS).min(last),
                _ => 0..last,
            };
            let count = self.crew.batch;
            let made = self.crew.work(
                count,
                |i, draft, rng| enrich(draft, ticks(i), taste, rng),
                |tracks, _| tracks.company() < wish,
            );
            done += count;
            (failures, since_stir) = if made.contains(&true) { (0, 0) } else { (failures + count, since_stir + count) };
            if since_stir > STIR_AFTER * people {
                since_stir = 0;
                self.crew.work(people, |track, draft, rng| stir(draft, track, taste, rng), |_, _| true);
            }
        }
    }

    /// Mends, and where that cost more patches of several people than it may, puts new ones in and mends again.
    fn finish(&mut self, refills: usize) -> Rehearsal {
        let mut rehearsal = Rehearsal::new(&self.crew.tracks);
        self.mend(&mut rehearsal);
        for _ in 0..refills {
            let share = self.crew.tracks.multi_person_share();
            if share >= self.scene.interaction || !rehearsal.faults.is_empty() {
                break;
            }
            // People may have been led other ways even if no patch found room.
            self.enrich(self.patience);
            rehearsal.repeat(&self.crew.tracks);
            self.mend(&mut rehearsal);
            if self.crew.tracks.multi_person_share() <= share {
                break;
            }
        }
        rehearsal
    }

    /// Bridges anew where final bodies are at fault, until none are.
    fn mend(&mut self, rehearsal: &mut Rehearsal) {
        let taste = Taste { expansions: MEND_EXPANSIONS, ..self.taste };
        for round in 0..MEND_ROUNDS {
            let faults = &rehearsal.faults;
            if faults.is_empty() || !self.goes_on(Phase::Mend) {
                return;
            }
            for fault in &rehearsal.faults {
                [fault.a, fault.b].into_iter().for_each(|track| self.crew.tracks.cut_away_from(track, fault.tick));
            }
            let gentle = round < GENTLE_ROUNDS;
            let propose = |i: usize, draft: &mut Draft, rng: &mut ChaCha8Rng| match gentle {
                true => mend(draft, faults[i], taste, rng),
                false => restand(draft, faults[i], STAND, rng)
                    .or_else(|| dissolve(draft, faults[i], taste, rng))
                    .or_else(|| mend(draft, faults[i], taste, rng)),
            };
            self.crew.work(faults.len(), propose, |_, _| true);
            rehearsal.repeat(&self.crew.tracks);
        }
    }
}

/// Every how many people one is to begin with a box: the preference may want what is done with boxes more than all else.
fn laden_every(library: &Library) -> usize {
    let mean = |laden: bool| {
        let singles =
            library.forward.iter().enumerate().filter(|(g, _)| library.laden[*g] == laden).flat_map(|(_, m)| m);
        let weights = singles.map(|m| library.preference.weight_of_kind(library.roles[m.role as usize].kind));
        let (sum, count) = weights.fold((0.0, 0), |(sum, count), w| (sum + w, count + 1));
        sum / count.max(1) as f32
    };
    ((LADEN_EVERY as f32 * mean(false) / mean(true).max(1e-6)).round() as usize).clamp(1, LADEN_EVERY)
}

/// Leads somebody another way for some seconds: new neighbours meet.
fn stir(draft: &mut Draft, track: usize, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    let tracks = draft.base;
    let from = rng.random_range(0..tracks.tracks[track].len());
    if !tracks.is_loose(tracks.tracks[track][from]) {
        return None;
    }
    let window = tracks.widen(Window { track, from, to: from + 1 }, STIR_TICKS);
    draft.hide(window);
    draft.bridge_window(window, taste, rng)
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
