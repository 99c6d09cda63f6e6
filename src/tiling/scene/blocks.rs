//! The blocks of a scene file: obstacles, gates, placed patches, teams. What each key means: docs/formats/scene.md.

use glam::Vec2;

use super::parts::{KindFilter, Periodic, Placed, Sink, Source, Team, Wang};
use super::read::Section;
use super::{MAX_CHARACTERS, MAX_SECS};
use crate::geom::{Gate, Ground, Obstacle, Polygon, Waypoint};
use crate::tiling::wang::{LARGEST_TILE, SMALLEST_TILE};

/// Most colours of edges and variants of tiles, and how many there are unless a scene says it.
const MAX_COLOURS: usize = 8;
const COLOURS: usize = 4;
const MAX_VARIANTS: usize = 64;
const VARIANTS: usize = 2;

/// Most people that one source lets in.
const MAX_ARRIVALS: usize = 100_000;

/// `[[obstacle]]`.
pub(super) fn obstacle(block: Section) -> Option<Obstacle> {
    let outline = block.polygon("outline");
    if !block.has("outline") {
        block.missing("outline", "corners [x, z]");
    }
    let height = block.number("height", 0.01..=100.0, " m");
    let path: Vec<Waypoint> = block
        .rows("path", 3..=4, "way-points [secs, x, z] or [secs, x, z, heading_deg]")
        .iter()
        .map(|row| waypoint(row))
        .collect();
    let known = outline.is_some();
    // A stand-in, so that the rest is looked at as well.
    let outline = outline.unwrap_or(Polygon::rectangle(Vec2::ZERO, Vec2::ONE));
    let obstacle = Obstacle { outline, height, path };
    if let Some(problem) = obstacle.problem() {
        block.bad(&block.span_of("path"), "path", &problem);
    }
    block.finish();
    known.then_some(obstacle)
}

fn waypoint(row: &[f32]) -> Waypoint {
    let heading = row.get(3).map_or(0.0, |deg| deg.to_radians());
    Waypoint { secs: row[0], position: Vec2::new(row[1], row[2]), heading }
}

fn heading(block: &Section) -> Option<f32> {
    block.number("heading_deg", -360.0..=360.0, " degrees").map(f32::to_radians)
}

fn gate(block: &Section) -> Option<Gate> {
    let (at, from, to) = (block.point("at"), block.point("from"), block.point("to"));
    let ends = match (at, from, to) {
        (Some(at), None, None) => Some((at, at)),
        (None, Some(from), Some(to)) => Some((from, to)),
        _ => {
            block.bad(&block.span, "at", "expected either `at` or both `from` and `to`, points [x, z]");
            None
        }
    };
    let heading = heading(block);
    let spread = block.number("spread_deg", 0.0..=180.0, " degrees").map_or(0.35, f32::to_radians);
    let group = block.text("group").map(str::to_owned);
    let (from, to) = ends?;
    Some(Gate { from, to, heading, spread, group })
}

/// `[[source]]` of a scene of so many seconds.
pub(super) fn source(block: Section, secs: f32) -> Option<Source> {
    let gate = gate(&block);
    let times = times(&block, secs);
    let team = block.text("team").map(str::to_owned);
    block.finish();
    Some(Source { gate: gate?, times: times?, team })
}

/// When people come: at `times`, or evenly at a `rate` between `from_secs` and `to_secs`.
fn times(block: &Section, secs: f32) -> Option<Vec<f32>> {
    let last = f64::from(secs);
    let window = (block.number("from_secs", 0.0..=last, " s"), block.number("to_secs", 0.0..=last, " s"));
    let rate = block.number("rate", 1e-3..=100.0, " people per second");
    if let Some(list) = block.tuple("times", 0..=MAX_ARRIVALS, "moments in seconds") {
        if rate.is_some() || !list.is_sorted() || list.iter().any(|t| !(0.0..=secs).contains(t)) {
            let problem = format!("expected moments in order from 0 to {secs} s, and no `rate` beside them");
            block.bad(&block.span_of("times"), "times", &problem);
        }
        return Some(list);
    }
    let (from, to, Some(rate)) = (window.0.unwrap_or(0.0), window.1.unwrap_or(secs), rate) else {
        if !block.has("rate") && !block.has("times") {
            block.missing("rate", "people per second, or `times`");
        }
        return None;
    };
    let count = (((to - from).max(0.0) * rate) as usize).min(MAX_ARRIVALS);
    Some((0..count).map(|i| from + (i as f32 + 0.5) / rate).collect())
}

/// `[[sink]]`.
pub(super) fn sink(block: Section) -> Option<Sink> {
    let gate = gate(&block);
    block.finish();
    Some(Sink { gate: gate? })
}

/// `[[place]]`.
pub(super) fn placed(block: Section) -> Option<Placed> {
    let kind = block.text("kind");
    let (position, heading) = (block.point("position"), heading(&block).unwrap_or(0.0));
    let secs = block.number("time_secs", -MAX_SECS..=MAX_SECS, " s");
    for (key, expected) in [("kind", "the name of a kind"), ("position", "a point [x, z]"), ("time_secs", "seconds")] {
        if !block.has(key) {
            block.missing(key, expected);
        }
    }
    block.finish();
    Some(Placed { kind: kind?.to_owned(), at: Ground::new(position?, heading), secs: secs? })
}

/// `[[team]]`.
pub(super) fn team(block: Section) -> Option<Team> {
    let (name, start) = (block.text("name"), block.polygon("start"));
    let characters = block.count("characters", 1..=MAX_CHARACTERS);
    let heading = heading(&block);
    for (key, expected) in [("name", "a name"), ("start", "corners [x, z]"), ("characters", "a whole number")] {
        if !block.has(key) {
            block.missing(key, expected);
        }
    }
    block.finish();
    Some(Team { name: name?.to_owned(), characters: characters?, start: start?, heading })
}

/// `[wang]`.
pub(super) fn wang(block: Section) -> Option<Wang> {
    let tile = block.number("tile", SMALLEST_TILE..=LARGEST_TILE, " m");
    if !block.has("tile") {
        block.missing("tile", "the side of a tile in metres");
    }
    let colours = block.count("colours", 1..=MAX_COLOURS).unwrap_or(COLOURS);
    let variants = block.count("variants", 1..=MAX_VARIANTS).unwrap_or(VARIANTS);
    block.finish();
    Some(Wang { tile: tile?, colours: colours as u32, variants: variants as u32 })
}

/// `kinds = { only = [...], without = [...] }`.
pub(super) fn kinds(block: Section) -> KindFilter {
    let filter = KindFilter { only: block.texts("only"), without: block.texts("without") };
    block.finish();
    filter
}

/// `periodic = ["x", "z", "t"]`.
pub(super) fn periodic(file: &Section) -> Periodic {
    let mut periodic = Periodic::default();
    for axis in file.texts("periodic") {
        match axis.as_str() {
            "x" => periodic.x = true,
            "z" => periodic.z = true,
            "t" => periodic.t = true,
            other => file.bad(
                &file.span_of("periodic"),
                "periodic",
                &format!("expected \"x\", \"z\" or \"t\", found {other:?}"),
            ),
        }
    }
    periodic
}
