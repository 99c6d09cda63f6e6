//! Tableaux by tiling: a small round place whose time comes round after the period is filled with a few people, as any
//! scene is. What they do are patches of the set, how they go from one to the next is bridged, and their lives lead back to
//! where they began; so a clip goes on over the period without a seam.

use std::collections::{BTreeMap, BTreeSet};

use glam::Vec2;
use rayon::prelude::*;

use super::tableau::Tableau;
use crate::geom::{Periodic, Polygon};
use crate::motion::{Build, FPS, JOINT_COUNT};
use crate::patch::{Measures, PatchKind, PatchSet};
use crate::refine::refine_crowd;
use crate::stage::world::Act;
use crate::stage::{Character, Crowd};
use crate::tiling::{Options, Scene, Session, Status, tile_in};

/// Seeds that are tried.
const SEEDS: u64 = 6;
/// Where none of the first few of them leads to anything the others are left alone.
const FIRST_SEEDS: usize = 2;
/// Shares of the time in patches of several people that are wished for, one after the other as long as that goes well; and what will do
/// where even the first does not.
const TOGETHER: [f32; 3] = [0.4, 0.55, 0.75];
const LESS: f32 = 0.2;
/// Rounds of changes that are tried for one at most: what comes out must not depend on how fast a machine is.
const STEPS: u64 = 40;
/// So many seconds are never reached.
const FOR_EVER: f64 = 1e8;
/// Who stays does nothing that reaches farther, metres.
const NEAR: f32 = 0.75;
/// Room that somebody alone has, and how much more each further person needs, metres.
const ROOM: f32 = 0.75;
const MORE_ROOM: f32 = 0.4;
/// More people than these are not one group.
pub(super) const MOST: usize = 5;
/// Who stands at least so long near others and looks at one of them within this angle (its cosine) talks to them, metres and seconds.
const TALK: (f32, f32, f32) = (1.0, 2.2, 0.6);

/// What is asked for.
#[derive(Clone)]
pub(super) struct Wish {
    /// Labels of kinds of several people that are meant; where there are none those of people who talk will do.
    pub meant: BTreeSet<String>,
    /// How many people.
    pub people: usize,
    /// Seconds after which it repeats.
    pub period: f32,
    /// What it is drawn from.
    pub seed: u64,
}

/// A patch set, and what was measured of its kinds, by name.
pub(super) struct Repertoire<'a> {
    pub set: &'a PatchSet,
    measures: BTreeMap<&'a str, Measures>,
}

impl<'a> Repertoire<'a> {
    pub fn new(set: &'a PatchSet) -> Self {
        let measured: Vec<_> = set.kinds.par_iter().map(|k| (k.name.as_str(), k.measures())).collect();
        Self { set, measures: measured.into_iter().collect() }
    }

    /// The words of a name that are labels of kinds of several people. Names with the same words wish for the same.
    pub fn meant(&self, name: &str) -> BTreeSet<String> {
        let labels = self.set.kinds.iter().filter(|k| k.people() > 1).flat_map(|k| &k.labels);
        labels.filter(|label| name.split_whitespace().any(|word| word == *label)).cloned().collect()
    }

    /// Up to `most` tableaux as wished, those with the most company first; none if the set has none. O(seeds x a small tiling).
    pub fn play(&self, wish: &Wish, most: usize) -> Vec<Tableau> {
        if wish.people > MOST {
            return Vec::new();
        }
        let seeds: Vec<u64> = (0..SEEDS).map(|k| wish.seed.wrapping_mul(SEEDS).wrapping_add(k)).collect();
        let (first, others) = seeds.split_at(FIRST_SEEDS);
        let with_turns = |turns: bool| {
            let set = self.fitting(wish, turns);
            let all = |seeds: &[u64]| -> Vec<(f32, Tableau)> {
                seeds.par_iter().filter_map(|&seed| of_seed(&set, wish, seed)).collect()
            };
            let mut found = all(first);
            if !found.is_empty() {
                found.extend(all(others));
            }
            (!found.is_empty()).then_some(found)
        };
        let mut found = [false, true].into_iter().find_map(with_turns).unwrap_or_default();
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        found.into_iter().take(most).map(|(_, tableau)| tableau).collect()
    }

    /// Kinds that can be played in a small place: those of one person that stay in it, with or without turns, and those of several
    /// people who do as wished; who stand and look at each other, where none are known to.
    fn fitting(&self, wish: &Wish, turns: bool) -> PatchSet {
        let measures = |k: &PatchKind| &self.measures[k.name.as_str()];
        let calm = |k: &PatchKind| {
            let (m, words) = (measures(k), &measures(k).words);
            k.people() == 1 && m.radius < NEAR && !words.contains(&"low") && (turns || !words.contains(&"turn"))
        };
        let small = |k: &PatchKind| (2..=wish.people).contains(&k.people()) && measures(k).radius < reach(wish.people);
        let meant = |k: &PatchKind| k.labels.iter().any(|label| wish.meant.contains(label));
        let free = |k: &PatchKind| k.props.is_empty() && !k.labels.iter().any(|l| l == "jump" || l == "hop");
        let is_known = self.set.kinds.iter().any(|k| free(k) && small(k) && meant(k));
        let chosen = |k: &PatchKind| if is_known { meant(k) } else { talks(k, measures(k)) };
        self.set.only(|k| free(k) && (calm(k) || (small(k) && chosen(k))))
    }
}

/// Whether the people of a kind stand and look at each other, as people do who talk.
fn talks(kind: &PatchKind, measures: &Measures) -> bool {
    let stand = !["walk", "run", "step", "low", "jump"].iter().any(|word| measures.words.contains(word));
    let (secs, near, ahead) = TALK;
    let frames = kind.fragments.iter().map(|f| f.motion.len()).min().unwrap_or(0);
    // Fragments of people who stand begin and end at about the same time.
    let faces = |i: usize, frame: usize| {
        let path = |k: usize| &kind.fragments[k].motion.path;
        let (sin, cos) = path(i).headings[frame].sin_cos();
        (0..kind.people()).filter(|&k| k != i).any(|k| {
            let way = path(k).points[frame] - path(i).points[frame];
            way.length() < near && way.normalize_or_zero().dot(Vec2::new(sin, cos)) > ahead
        })
    };
    let mostly = |i: usize| 2 * (0..frames).filter(|&frame| faces(i, frame)).count() > frames;
    stand && frames as f32 > secs * FPS && (0..kind.people()).all(mostly)
}

/// Radius of the place for so many people.
fn reach(people: usize) -> f32 {
    ROOM + MORE_ROOM * (people - 1) as f32
}

/// A tableau, and the share of the time that its people spend together.
fn of_seed(set: &PatchSet, wish: &Wish, seed: u64) -> Option<(f32, Tableau)> {
    if wish.people > 1 && set.kinds.iter().all(|k| k.people() == 1) {
        return None;
    }
    let corner = |k: usize| reach(wish.people) * (Vec2::from_angle(k as f32 * std::f32::consts::TAU / 12.0) + 1.0);
    let region = Polygon { points: (0..12).map(corner).collect() };
    let periodic = Periodic { t: true, ..Periodic::default() };
    let scene = Scene { periodic, ..Scene::new(region, wish.period, wish.people) };
    let shares = if wish.people > 1 { &TOGETHER[..] } else { &[0.0] };
    let at = |interaction: f32| {
        let scene = Scene { interaction, ..scene.clone() };
        let options = Options { seed, time_secs: FOR_EVER, ..Options::default() };
        let session = Session { steps: Some(STEPS), ..Session::default() };
        let outcome = tile_in(session, &scene, set, &options, &mut |_| true).ok()?;
        let fits = outcome.status == Status::Perfect && outcome.crowd.characters.len() == wish.people;
        fits.then_some(outcome.crowd)
    };
    let crowd = shares.iter().map_while(|&share| at(share)).last().or_else(|| at(LESS).filter(|_| wish.people > 1))?;
    let share = together(&crowd);
    let crowd = refine_crowd(&undressed(crowd));
    let tableau = Tableau::new(crowd.characters.iter().map(|c| clip(c, wish.period)).collect(), vec![]);
    tableau.is_small().then_some((share, tableau))
}

/// The same crowd with bodies of the canonical build: worlds know no others.
fn undressed(mut crowd: Crowd) -> Crowd {
    crowd.characters.iter_mut().for_each(|c| c.build = Build::canonical());
    crowd
}

/// Share of the people's time in patches of several people.
fn together(crowd: &Crowd) -> f32 {
    let (mut company, mut all) = (0, 0);
    for placed in crowd.characters.iter().flat_map(|c| &c.fragments) {
        let ticks = (placed.end - placed.begin).max(0);
        let people = crowd.set.kinds[crowd.instances[placed.instance as usize].kind as usize].people();
        (company, all) = (company + if people > 1 { ticks } else { 0 }, all + ticks);
    }
    company as f32 / all.max(1) as f32
}

/// A round of somebody's motion, every other frame if that comes out even: the last frame is the first of the next round.
fn clip(character: &Character, period: f32) -> Act {
    let frames = character.root.len() - 1;
    let every = if frames.is_multiple_of(2) && period * FPS > 60.0 { 2 } else { 1 };
    let kept = || (0..frames).step_by(every);
    let pose = |f: usize| &character.rotations[f * JOINT_COUNT..(f + 1) * JOINT_COUNT];
    Act {
        step: period / kept().count() as f32,
        roots: kept().map(|f| character.root[f]).collect(),
        rotations: kept().flat_map(pose).copied().collect(),
    }
}
