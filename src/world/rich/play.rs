//! Tableaux by tiling: a small round place whose time comes round after the period is filled with a few people, as any
//! scene is. What they do are patches of the set, how they go from one to the next is bridged, and their lives lead back to
//! where they began; so a clip goes on over the period without a seam.

use glam::Vec2;
use rayon::prelude::*;

use super::tableau::Tableau;
use crate::geom::{Periodic, Polygon};
use crate::motion::{Build, FPS, JOINT_COUNT};
use crate::patch::{PatchKind, PatchSet};
use crate::refine::refine_crowd;
use crate::stage::world::Act;
use crate::stage::{Character, Crowd};
use crate::tiling::{Options, Scene, Status, tile};

/// Seeds that are tried.
const SEEDS: u64 = 8;
/// Where none of the first few of them leads to anything the others are left alone.
const FIRST_SEEDS: usize = 2;
/// Shares of the time in patches of several people that are wished for, one after the other as long as that goes well.
const TOGETHER: [f32; 4] = [0.2, 0.4, 0.55, 0.75];
/// Longest time for one; what is usual is a tenth of a second.
const SECS: f64 = 10.0;
/// Who stays does nothing that reaches farther, metres.
const NEAR: f32 = 0.75;
/// Room that somebody alone has, and how much more each further person needs, metres.
const ROOM: f32 = 0.75;
const MORE_ROOM: f32 = 0.4;
/// More people than these are not one group.
const MOST: usize = 5;
/// Tableaux that are wider are left out, metres.
const WIDEST: f32 = 1.6;

/// What is asked for.
#[derive(Clone, Copy)]
pub(super) struct Wish<'a> {
    /// What people do, in words; kinds with one of them as a label come first.
    pub name: &'a str,
    /// How many people.
    pub people: usize,
    /// Seconds after which it repeats.
    pub period: f32,
    /// What it is drawn from.
    pub seed: u64,
}

/// Up to `most` tableaux as wished, those with the most company first; none if the set has none. O(seeds x a tiling of some seconds).
pub(super) fn play(set: &PatchSet, wish: Wish, most: usize) -> Vec<Tableau> {
    if wish.people > MOST {
        return Vec::new();
    }
    let choices = [false, true].map(|turns| fitting(set, wish, turns));
    let of_seed = |seed: u64| choices.iter().find_map(|set| of_seed(set, wish, seed));
    let seeds: Vec<u64> = (0..SEEDS).map(|k| wish.seed.wrapping_mul(SEEDS).wrapping_add(k)).collect();
    let (first, others) = seeds.split_at(FIRST_SEEDS);
    let all = |seeds: &[u64]| -> Vec<(f32, Tableau)> { seeds.par_iter().filter_map(|&seed| of_seed(seed)).collect() };
    let mut found = all(first);
    if !found.is_empty() {
        found.extend(all(others));
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.into_iter().take(most).map(|(_, tableau)| tableau).collect()
}

/// Kinds that can be played in a small place: those of one person that stay in it, with or without turns, and those of several
/// people who do as wished, or whatever there is.
fn fitting(set: &PatchSet, wish: Wish, turns: bool) -> PatchSet {
    let calm = |k: &PatchKind| {
        let m = k.measures();
        k.people() == 1 && m.radius < NEAR && !m.words.contains(&"low") && (turns || !m.words.contains(&"turn"))
    };
    let small = |k: &PatchKind| (2..=wish.people).contains(&k.people()) && k.measures().radius < reach(wish.people);
    let meant = |k: &PatchKind| k.labels.iter().any(|label| wish.name.split_whitespace().any(|w| w == label));
    let free = |k: &PatchKind| k.props.is_empty() && !k.labels.iter().any(|l| l == "jump" || l == "hop");
    let is_known = set.kinds.iter().any(|k| free(k) && small(k) && meant(k));
    set.only(|k| free(k) && (calm(k) || (small(k) && (meant(k) || !is_known))))
}

/// Radius of the place for so many people.
fn reach(people: usize) -> f32 {
    ROOM + MORE_ROOM * (people - 1) as f32
}

/// A tableau, and the share of the time that its people spend together.
fn of_seed(set: &PatchSet, wish: Wish, seed: u64) -> Option<(f32, Tableau)> {
    let corner = |k: usize| reach(wish.people) * (Vec2::from_angle(k as f32 * std::f32::consts::TAU / 12.0) + 1.0);
    let region = Polygon { points: (0..12).map(corner).collect() };
    let periodic = Periodic { t: true, ..Periodic::default() };
    let scene = Scene { periodic, ..Scene::new(region, wish.period, wish.people) };
    let shares = if wish.people > 1 { &TOGETHER[..] } else { &[0.0] };
    let at = |&interaction: &f32| {
        let scene = Scene { interaction, ..scene.clone() };
        let options = Options { seed, time_secs: SECS, ..Options::default() };
        let outcome = tile(&scene, set, &options, &mut |_| true).ok()?;
        let fits = outcome.status == Status::Perfect && outcome.crowd.characters.len() == wish.people;
        fits.then_some(outcome.crowd)
    };
    let crowd = shares.iter().map_while(at).last()?;
    let share = together(&crowd);
    let crowd = refine_crowd(&undressed(crowd));
    let tableau = Tableau::new(crowd.characters.iter().map(|c| clip(c, wish.period)).collect(), vec![]);
    (tableau.reach < WIDEST).then_some((share, tableau))
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
