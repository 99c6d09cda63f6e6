//! Wang tiles: any size of plane is covered by tiles that meet where their edges have one colour, in constant time each.
//!
//! An edge's colour says who lives on it and who crosses it, where, when and which way (`edge.rs`, `ribbon.rs`). A tile leads
//! these people from and to its borders and is filled like any scene; nobody else comes near its borders (`tile.rs`). Which
//! tile lies where follows from a hash of the place (`plane.rs`), so that there is no period. Laid tiles are chained at
//! their borders (`lay.rs`) and made into bodies whole.

mod edge;
mod lay;
mod plane;
mod ribbon;
mod tile;

use std::collections::BTreeMap;

use glam::Vec2;
use rayon::prelude::*;

use self::edge::Edges;
use self::lay::Layout;
use self::plane::{Key, Plane};
use self::tile::{Tile, Workshop};
use super::bake::bake;
use super::clock::Clock;
use super::domain::Domain;
use super::engine::{mend_laid, wishes};
use super::library::Library;
use super::outcome::{Options, Outcome, Phase, Progress, Status};
use super::passage::Passages;
use super::prefer::{Field, Form};
use super::rehearsal::Rehearsal;
use super::repeat::not_a_rectangle;
use super::tracks::Tracks;
use super::{Scene, Wang};
use crate::geom::Polygon;
use crate::patch::PatchSet;
use crate::{Error, Result};

pub(super) use self::tile::{Crosser, Gap, lead_across};

/// Smallest and largest tile, metres: whoever crosses a border needs room on both sides of it.
pub(super) const SMALLEST_TILE: f64 = 8.0;
/// See [`SMALLEST_TILE`].
pub(super) const LARGEST_TILE: f64 = 100.0;
/// Tiles of a region are whole up to this much, metres.
const WHOLE: f32 = 1e-3;
/// Most tiles of a region.
const MOST_TILES: f32 = 10_000.0;
/// Tiles are built while this share of the time is not over.
const BUILDING: f64 = 0.8;

/// What a scene with tiles asks for that they cannot have: the key, and what is wrong with it.
pub(super) fn problems(scene: &Scene) -> Vec<(&'static str, String)> {
    let Some(wang) = scene.wang else { return vec![] };
    let cannot = |key: &'static str, is_asked: bool| {
        is_asked.then(|| (key, "expected none beside `wang`: every tile is worked out by itself".to_owned()))
    };
    let mut found: Vec<(&'static str, String)> = [
        cannot("obstacle", !scene.obstacles.is_empty()),
        cannot("source", !scene.sources.is_empty()),
        cannot("sink", !scene.sinks.is_empty()),
        cannot("place", !scene.placed.is_empty()),
        cannot("team", !scene.teams.is_empty()),
        cannot("rivals", !scene.rivals.is_empty()),
        cannot("periodic", scene.periodic.any()),
    ]
    .into_iter()
    .flatten()
    .collect();
    if scene.preference.terms.iter().any(|t| is_of_a_place(&t.form)) {
        let problem = "expected no wish about places beside `wang`: the same tile lies in many places";
        found.push(("prefer", problem.into()));
    }
    if !(SMALLEST_TILE..=LARGEST_TILE).contains(&f64::from(wang.tile)) || wang.colours == 0 || wang.variants == 0 {
        let problem = format!("expected tiles of {SMALLEST_TILE} to {LARGEST_TILE} m, a colour and a variant or more");
        found.push(("wang", format!("{problem}, found {wang:?}")));
    } else if let Some(problem) = not_whole(scene, wang) {
        found.push(("region", problem));
    }
    found
}

/// True if a wish is about certain places.
fn is_of_a_place(form: &Form) -> bool {
    match form {
        Form::Attract { .. } | Form::Avoid { .. } | Form::Places(_) | Form::Headings(_) => true,
        Form::Direction(field) => !matches!(field, Field::Heading(_)),
        Form::Schedule { .. } | Form::Ratios(_) | Form::Times { .. } | Form::Kinds(_) => false,
    }
}

/// Why a region is no rectangle of whole tiles, if it is none.
fn not_whole(scene: &Scene, wang: Wang) -> Option<String> {
    let expected = format!("expected a rectangle of whole tiles of {} m, its corners at multiples of that", wang.tile);
    if let Some(found) = not_a_rectangle(&scene.region) {
        return Some(format!("{expected}, found {found}"));
    }
    let (low, high) = scene.region.bounds();
    let astray = |v: f32| (v - (v / wang.tile).round() * wang.tile).abs() > WHOLE;
    if [low.x, low.y, high.x, high.y].into_iter().any(astray) {
        return Some(format!("{expected}, found [{}, {}] to [{}, {}]", low.x, low.y, high.x, high.y));
    }
    let tiles = scene.region.area() / (wang.tile * wang.tile);
    (tiles > MOST_TILES).then(|| format!("expected at most {MOST_TILES} tiles, found {tiles}"))
}

/// Refuses what tiles cannot have.
///
/// # Errors
/// Names all of it.
pub(super) fn possible(scene: &Scene) -> Result<()> {
    let mut problems = problems(scene).into_iter();
    let Some((key, first)) = problems.next() else { return Ok(()) };
    let all = problems.fold(first, |sum, (key, problem)| format!("{sum}; {key}: {problem}"));
    Err(Error::invalid("scene", key, all))
}

/// Covers a scene's region with tiles.
///
/// # Errors
/// There is no room for those who are to cross an edge.
pub(super) fn tile(
    scene: &Scene,
    wang: Wang,
    set: &PatchSet,
    options: &Options,
    progress: &mut dyn FnMut(&Progress) -> bool,
) -> Result<Outcome> {
    let start = std::time::Instant::now();
    let library = Library::new(set, scene.limits).preferring(&scene.preference);
    let passages = Passages::new(&library);
    passages.work_out_all();
    let plane = Plane::new(scene, wang, options.seed);
    let one = one_tile(scene, wang);
    let edges = Edges::new(&passages, &library, &one, wang, (options.seed, options.time_secs * BUILDING))?;
    let shop = Workshop {
        scene: &one,
        library: &library,
        passages: &passages,
        edges: &edges,
        side: wang.tile,
        seed: options.seed,
    };
    let tiles = build(&shop, plane, options, progress)?;
    let domain = Domain::new(scene)?;
    let people = Layout { plane, tiles: &tiles, edges: &edges, side: wang.tile }.people();
    let tracks = Tracks::laid(&library, &domain, people);
    let left = (options.time_secs - start.elapsed().as_secs_f64()).max(0.0);
    let (tracks, rehearsal) = mended(scene, &passages, tracks, options.seed, Clock::new(left, progress));
    let interpenetrations = rehearsal.faults.len();
    let status = match interpenetrations {
        0 => wishes(tracks.chains(), scene),
        n => Status::Imperfect(format!("{n} faults of the final bodies are left")),
    };
    let crowd = bake(tracks.chains(), scene, options.seed, rehearsal);
    let solve_secs = start.elapsed().as_secs_f64();
    Ok(Outcome { crowd, status, danglings: 0, interpenetrations, solve_secs, unkept: None })
}

/// The scene of one tile: as many people as are on it at once.
fn one_tile(scene: &Scene, wang: Wang) -> Scene {
    let tiles = (scene.region.area() / (wang.tile * wang.tile)).round();
    let characters = (scene.characters as f32 / tiles).ceil() as usize;
    let region = Polygon::rectangle(Vec2::ZERO, Vec2::splat(wang.tile));
    Scene { region, characters, wang: None, ..scene.clone() }
}

/// All tiles that a plane has, each once.
fn build(
    shop: &Workshop,
    plane: Plane,
    options: &Options,
    progress: &mut dyn FnMut(&Progress) -> bool,
) -> Result<BTreeMap<Key, Tile>> {
    let start = std::time::Instant::now();
    let mut keys: Vec<Key> = plane.places().map(|at| plane.key(at)).collect();
    keys.sort_unstable();
    keys.dedup();
    let (mut tiles, mut goes_on): (BTreeMap<Key, Tile>, bool) = (BTreeMap::new(), true);
    for some in keys.chunks(2 * rayon::current_num_threads()) {
        let left = options.time_secs * BUILDING - start.elapsed().as_secs_f64();
        let secs = if goes_on { left.max(0.0) } else { 0.0 };
        let built = some.par_iter().with_max_len(1).map(|&key| Ok((key, shop.build(key, secs)?)));
        tiles.extend(built.collect::<Result<Vec<_>>>()?);
        goes_on = goes_on && progress(&state(&tiles, start.elapsed().as_secs_f64()));
    }
    Ok(tiles)
}

/// How far building has got.
fn state(tiles: &BTreeMap<Key, Tile>, secs: f64) -> Progress {
    let stays = || tiles.values().flat_map(|t| &t.stays);
    Progress {
        phase: Phase::Seed,
        patches: tiles.values().map(|t| t.instances as usize).sum(),
        characters: stays().filter(|s| s.from.is_none()).count(),
        danglings: 0,
        multi_person_share: 0.0,
        energy: 0.0,
        secs,
    }
}

/// The tiling and its final bodies; where a border still has a fault, it is mended as any other.
fn mended<'a>(
    scene: &'a Scene,
    passages: &'a Passages<'a>,
    tracks: Tracks<'a>,
    seed: u64,
    clock: Clock<'a>,
) -> (Tracks<'a>, Rehearsal) {
    let rehearsal = Rehearsal::new(&tracks);
    if rehearsal.faults.is_empty() {
        return (tracks, rehearsal);
    }
    match tracks.opened() {
        Ok(tracks) => mend_laid(scene, passages, tracks, rehearsal, seed, clock),
        Err(tracks) => (*tracks, rehearsal),
    }
}

#[cfg(test)]
mod tests;
