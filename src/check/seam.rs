//! Crowds that repeat: whether the last frame goes on into the first, and one side of the region into the other.
//!
//! The contract is held against the crowd unrolled, three tiles along each direction that repeats and three laps of time,
//! which is an ordinary crowd; and against the seams alone, in rows of their own.

use rayon::prelude::*;

use super::bodies::{Depths, bodies_at, chains, pair_depth};
use super::limits::Limits;
use super::part::{Part, parts};
use super::report::{Faults, Report, Row, Worst};
use super::{plant, speed};
use crate::geom::Torus;
use crate::motion::JOINT_COUNT;
use crate::stage::{Character, Crowd, FragmentUse};

/// Tiles along x and along z, and laps.
const TIMES: u32 = 3;
/// Frames before and after the seam in time on which bodies are looked at.
const MARGIN: u32 = 30;

/// All rows of a crowd that repeats. `references` has held.
pub(super) fn check(crowd: &Crowd, references: Row, limits: &Limits) -> Report {
    let whole = unbroken(crowd).row(0, "tiles and laps that cannot repeat");
    if !whole.ok {
        return Report { rows: vec![references, whole] };
    }
    let mut rows = vec![references, whole];
    if crowd.domain.periodic.t {
        rows.extend(in_time(crowd, limits));
    }
    if crowd.domain.periodic.in_space() {
        rows.extend(in_space(crowd, limits));
    }
    let unrolled = super::check_with(&crowd.unrolled(TIMES, TIMES, TIMES), limits);
    rows.extend(unrolled.rows.into_iter().skip(1).map(of_unrolled));
    rows.sort_by_key(|row| row.clause);
    Report { rows }
}

fn of_unrolled(row: Row) -> Row {
    let place = if row.place.is_empty() { row.place } else { format!("unrolled: {}", row.place) };
    Row { place, ..row }
}

/// What nothing can be unrolled with: a region that is no rectangle, people who are not there over the whole lap.
fn unbroken(crowd: &Crowd) -> Faults {
    let mut faults = Faults::default();
    let (domain, (low, high)) = (&crowd.domain, crowd.domain.region.bounds());
    let is_corner = |p: &glam::Vec2| (p.x == low.x || p.x == high.x) && (p.y == low.y || p.y == high.y);
    let rectangle = domain.region.points.len() == 4 && domain.region.points.iter().all(is_corner);
    if domain.periodic.in_space() && !(rectangle && high.cmpgt(low).all()) {
        faults.add(|| "the region is no rectangle along x and z".into());
    }
    if domain.periodic.t && domain.last_frame == 0 {
        faults.add(|| "a lap of no time".into());
    }
    for (c, character) in crowd.characters.iter().enumerate().filter(|_| domain.periodic.t) {
        let (frames, expected) = (character.frames(), domain.last_frame as usize + 1);
        if character.begin != 0 || frames != expected {
            faults.add(|| {
                format!("character {c}: expected {expected} frames from 0 on, found {frames} from {}", character.begin)
            });
        }
    }
    faults
}

/// The rows of the seam in time.
fn in_time(crowd: &Crowd, limits: &Limits) -> Vec<Row> {
    let torus = crowd.domain.torus();
    let (mut gap, mut turn, mut breaks) = (Worst::default(), Worst::default(), Faults::default());
    for (c, character) in crowd.characters.iter().enumerate() {
        let place = || format!("character {c}");
        let last = character.frames() - 1;
        let away = torus.nearest3(character.root[last] - character.root[0]);
        gap.offer(away.length() as f64, place);
        for j in 0..JOINT_COUNT {
            let angle = character.pose(last)[j].dot(character.pose(0)[j]).abs().min(1.0).acos() * 2.0;
            turn.offer((angle as f64).to_degrees(), || format!("character {c}, joint {j}"));
        }
        if !goes_on(crowd, character, torus, limits) {
            breaks.add(place);
        }
    }
    let lap = crowd.domain.last_frame;
    let around = crowd.laps(2).cut(lap.saturating_sub(MARGIN), (lap + MARGIN).min(2 * lap));
    let of_seam = |row: Row| Row { row: format!("seam in time: {}", row.row), ..row };
    let mut rows = vec![
        gap.row(2, "seam in time: from the last to the first place", limits.stitch_position, "m"),
        turn.row(2, "seam in time: from the last to the first pose", limits.stitch_heading_deg, "deg"),
        breaks.row(1, "seam in time: chains that do not go on"),
    ];
    rows.extend(speed::rows(&around, limits).into_iter().map(of_seam));
    rows.extend(plant::rows(&around, &parts(&around), limits).into_iter().take(1).map(of_seam));
    rows
}

/// True if what a character does last is what the character does first, or leads there.
fn goes_on(crowd: &Crowd, character: &Character, torus: Torus, limits: &Limits) -> bool {
    let (Some(first), Some(last)) = (character.fragments.first(), character.fragments.last()) else { return false };
    let lap = crowd.domain.last_frame as i32;
    let source = |f: &FragmentUse| {
        let kind = crowd.instances[f.instance as usize].kind;
        (kind, &crowd.set.kinds[kind as usize].fragments[f.role as usize])
    };
    let near = |a: glam::Vec2, b: glam::Vec2| torus.nearest(a - b).length() as f64 <= limits.stitch_position;
    let ((kind, entered), (last_kind, left)) = (source(first), source(last));
    if last.end > lap {
        let same =
            (kind, first.role, first.begin + lap, first.end + lap) == (last_kind, last.role, last.begin, last.end);
        return same && first.points.iter().zip(&last.points).all(|(a, b)| near(*a, *b));
    }
    let port = near(last.points[last.points.len() - 1], first.points[0]) && left.exit_group == entered.entry_group;
    first.begin == 0 && last.end == lap && port
}

/// The rows of the borders over which the ground repeats: bodies against the images of others.
fn in_space(crowd: &Crowd, limits: &Limits) -> Vec<Row> {
    let parts = parts(crowd);
    let chains = chains(crowd, &parts);
    let frames = (0..crowd.domain.last_frame + 1).into_par_iter();
    let depths: Vec<Depths> = frames.map(|frame| across(crowd, &chains, frame)).collect();
    let all = depths.into_iter().fold(Depths::default(), Depths::merge);
    vec![
        all.apart.row(4, "border: bodies of different patches overlap", limits.penetration, "m"),
        all.together.row(4, "border: bodies of one patch overlap more than captured", limits.penetration, "m"),
    ]
}

/// How deep people are in images of others at a frame.
fn across(crowd: &Crowd, chains: &[&[Part]], frame: u32) -> Depths {
    let (torus, bodies) = (crowd.domain.torus(), bodies_at(crowd, frame));
    let mut depths = Depths::default();
    for (i, (a, body)) in bodies.iter().enumerate() {
        for (b, other) in &bodies[i + 1..] {
            let (away, reach) = (body.center - other.center, body.radius + other.radius);
            let whole = torus.whole(away);
            if whole == glam::Vec2::ZERO || (away - whole).length() >= reach {
                continue;
            }
            let depth = body.depth_into(&other.moved(whole));
            if depth > 0.0 {
                pair_depth(chains, frame, (*a, *b), depth, &mut depths);
            }
        }
    }
    depths
}
