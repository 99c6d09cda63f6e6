//! People who are to be somewhere at some time: in what a scene has placed, in teams, at sources, over a tile's borders, over hurdles.

use rand_chacha::ChaCha8Rng;

use super::super::bridge::Taste;
use super::super::checkpoint::Agenda;
use super::super::draft::Draft;
use super::super::hurdle::{hurdle, jumpers};
use super::super::keyframe::keyframes;
use super::super::outcome::Phase;
use super::super::source::let_in;
use super::super::team::line_up;
use super::super::wang::{Crosser, Gap, lead_across};
use super::{Engine, GATHER_EXPANSIONS};

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

impl Engine<'_> {
    /// Leads all who cross a tile's borders to and from where they do; an error are those who find no way.
    pub(super) fn cross(&mut self, mut left: Vec<&Crosser>) -> std::result::Result<(), Vec<Gap>> {
        let taste = Taste { expansions: GATHER_EXPANSIONS, ..self.taste };
        for _ in 0..CROSS_ROUNDS {
            let made = self.crew.work(left.len(), |i, draft, rng| lead_across(draft, left[i], taste, rng), |_, _| true);
            left = left.into_iter().zip(made).filter(|(_, made)| !made).map(|(crosser, _)| crosser).collect();
        }
        let stuck: Vec<Gap> = left.into_iter().map(|crosser| crosser.gap).collect();
        if stuck.is_empty() { Ok(()) } else { Err(stuck) }
    }

    /// Puts the teams in their places.
    pub(super) fn line_up(&mut self) {
        let taste = Taste { expansions: GATHER_EXPANSIONS, ..self.taste };
        for team in 0..self.scene.teams.len() {
            let (people, others): (Vec<usize>, Vec<usize>) = self.agenda.lining_up.iter().partition(|&&t| t == team);
            let waiting = |agenda: &mut Agenda, left: Vec<usize>| agenda.lining_up = [&others[..], &left].concat();
            self.admit(people, waiting, &|draft, team, rng| line_up(draft, team, taste, rng));
        }
    }

    /// Lets people in at the sources.
    pub(super) fn let_in(&mut self) {
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
    pub(super) fn keyframes(&mut self) {
        let placed = &self.scene.placed;
        let taste = Taste { expansions: KEYFRAME_EXPANSIONS, ..self.taste };
        self.agenda.placed = placed.is_empty()
            || (0..KEYFRAME_TRIES).any(|_| {
                self.goes_on(Phase::Seed) && self.crew.work_one(|draft, rng| keyframes(draft, placed, taste, rng))
            });
    }

    /// Adds people who jump over what is low enough, if there is such.
    pub(super) fn hurdle(&mut self) {
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
}
