//! People who find room anywhere: those who meet come first, then those who stand close together where it is dense, then those who
//! come alone.

use rand_chacha::ChaCha8Rng;

use super::super::Scene;
use super::super::bridge::Taste;
use super::super::draft::Draft;
use super::super::gather::{Wish, gather};
use super::super::library::Library;
use super::super::outcome::Phase;
use super::super::seed::{seed_person, settle, stand_beside};
use super::super::swept::Swept;
use super::super::tracks::{Change, Tracks};
use super::super::wedge::wedge;
use super::{Engine, GATHER_EXPANSIONS};

/// Failed gatherings in a row after which people come alone.
const GATHER_PATIENCE: usize = 400;
/// More people per m^2 than that is dense: then so large a share of their time those who meet do so at least, since whoever
/// comes and goes needs the more room.
const DENSE: f32 = 0.85;
const DENSE_TOGETHER: f32 = 0.65;
/// There people rather stand, and compactly.
const DENSE_CALM: f32 = 0.25;
pub(super) const COMPACT: f32 = 4.0;
/// Where time comes round the way back to where somebody began takes room as well: so large a share, less where nobody finds
/// room for so much.
const LOOP_TOGETHER: f32 = 0.6;
/// So few people find room anyway.
const FEW: usize = 12;
const LOOP_YIELD: f32 = 0.2;
/// Of so many gatherings that are worked out at one person per m^2, so many are made: those that sweep the least ground.
const RIVALS: f32 = 18.0;
const BEST: usize = 3;
/// Their number grows with this power of the density.
const RIVALRY: i32 = 4;
const MOST_RIVALS: usize = 200;
/// Where time comes round there are so many at least.
const LOOP_RIVALS: usize = 48;
/// The part of the people who then stand close together, up to 1.2 and from 2 people per m^2.
const STANDERS: [f32; 2] = [0.3, 0.75];
const STAND_DENSITIES: [f32; 2] = [1.2, 2.0];
/// Failed tries in a row after which nobody more stands close to others, and states expanded for each.
const STAND_PATIENCE: usize = 400;
pub(super) const STAND: Taste = Taste { calm: 0.02, compact: COMPACT, expansions: 200 };
/// Where those to come would have to be together for more than this share of their time, no more are gathered.
const HOPELESS: f32 = 0.7;
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

impl Engine<'_> {
    /// Adds people who meet until there is as much company as wished for.
    pub(super) fn gather(&mut self) {
        let (library, passages) = (self.crew.tracks.library, self.passages);
        let (wish, most) = (self.company_wish(), self.most);
        if library.multi.is_empty() || wish == 0 || self.people_left() == 0 || !self.scene.teams.is_empty() {
            return;
        }
        let taste = Taste { expansions: GATHER_EXPANSIONS, ..self.taste };
        let loops = self.crew.tracks.domain.cycle.loops() && self.scene.characters > FEW;
        let rivals = rivals(self.scene, loops);
        let mut least = match is_dense(self.scene) {
            true => DENSE_TOGETHER,
            false if loops => LOOP_TOGETHER,
            false => 0.0,
        };
        let (mut swept, mut failures) = (Swept::of(&self.crew.tracks), 0);
        while self.crew.tracks.company() < wish && failures < GATHER_PATIENCE && self.goes_on(Phase::Seed) {
            let (left, tracks) = (self.people_left(), &self.crew.tracks);
            let need = wish.saturating_sub(tracks.company()) as f32 / (left * tracks.domain.horizon as usize) as f32;
            if left < 2 || need > HOPELESS {
                break;
            }
            let count = rivals.unwrap_or(self.crew.batch.min(left.div_ceil(2)));
            let wishes: Vec<Wish> = (0..count).map(|_| self.plan.draw(need.max(least))).collect();
            let propose =
                |i: usize, draft: &mut Draft, rng: &mut ChaCha8Rng| gather(draft, passages, wishes[i], taste, rng);
            let wanted = |tracks: &Tracks, change: &Change| {
                tracks.tracks.len() + change.newcomers() <= most && tracks.company() < wish
            };
            let made = match rivals {
                Some(_) => self.crew.work_best((count, BEST), &mut swept, propose, wanted),
                None => self.crew.work(count, propose, wanted),
            };
            self.plan.learn(&wishes, &made);
            failures = if made.contains(&true) { 0 } else { failures + made.len() };
            if failures >= GATHER_PATIENCE && loops && least > 0.0 {
                (least, failures) = (least - LOOP_YIELD, 0);
            }
        }
    }

    /// Where it is to be dense, adds people who stand close together, so that the others have room.
    pub(super) fn stand(&mut self) {
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
    pub(super) fn seed(&mut self) {
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
}

/// The denser the crowd, the more people rather stand than walk.
pub(super) fn calm(scene: &Scene) -> f32 {
    if is_dense(scene) { DENSE_CALM } else { 1.58 - density(scene) }.min(1.3)
}

/// Whether there is so little room that it is shared out with care.
pub(super) fn is_dense(scene: &Scene) -> bool {
    density(scene) > DENSE
}

/// How many gatherings vie for room, where it is scarce.
fn rivals(scene: &Scene, loops: bool) -> Option<usize> {
    let where_dense = || ((RIVALS * density(scene).powi(RIVALRY)) as usize).clamp(BEST, MOST_RIVALS);
    let dense = is_dense(scene).then(where_dense);
    if loops { Some(dense.unwrap_or(0).max(LOOP_RIVALS)) } else { dense }
}

/// People per m^2.
fn density(scene: &Scene) -> f32 {
    scene.characters as f32 / scene.region.area()
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
