//! Boxes (clauses 2, 4, 5 and 7): each is held by one person, or two who pass it, or rests; palms are on it; it enters
//! nobody, no wall and no other box, and goes no faster than hands do.

use std::collections::BTreeMap;

use glam::{Quat, Vec2, Vec3};
use rayon::prelude::*;

use super::depth::Body;
use super::limits::Limits;
use super::part::Part;
use super::prop_shape::{Block, palms, place_between};
use super::report::{Faults, Row, Worst};
use crate::geom::Upright;
use crate::motion::{FPS, Motion};
use crate::stage::{Crowd, Prop};

/// What lies still moves no farther than this between two frames, metres and radians.
const STILL: f32 = 0.001;
/// Holds may begin and end this many frames from where the capture has them.
const ROUNDING: f64 = 1.01;
/// A box this near to where the capture has it is the same, metres.
const ASTRAY: f32 = 0.02;
/// Where there is no box at all, a sitter is so far from one, metres.
const NO_SEAT: f32 = 10.0;
/// Boxes may differ from the captured ones by this much, metres.
const SAME_SIZE: f32 = 0.006;

/// The rows of boxes; none for a crowd without any, whose patches have none.
pub(super) fn rows(crowd: &Crowd, parts: &[Part], limits: &Limits) -> Vec<Row> {
    if crowd.props.is_empty() && parts.iter().all(|p| p.kind.props.is_empty()) {
        return vec![];
    }
    let keeping = keeping(crowd, parts);
    let fastest = fastest_palm(crowd);
    let each = |(i, prop): (usize, &Prop)| measure(crowd, parts, i, prop, fastest);
    let all: Vec<Measures> = crowd.props.par_iter().enumerate().map(each).collect();
    let all = all.into_iter().fold(Measures::default(), Measures::merge);
    vec![
        all.speed.row(2, "box moves faster than hands in the captures", limits.joint_speed_ratio, "x"),
        all.body.row(4, "box inside a body, more than captured", limits.penetration, "m"),
        overlaps(crowd).row(4, "boxes overlap", limits.penetration, "m"),
        all.palm.row(5, "palm off the box it holds", limits.contact_distance, "m"),
        seats(crowd, parts).row(5, "sitter off the top of the box", limits.contact_distance, "m"),
        keeping.row(7, "boxes held by nobody, by strangers or by too many"),
        all.wall.row(7, "boxes outside the region or in obstacles", limits.penetration, "m"),
        all.floor.row(7, "boxes below the floor", limits.penetration, "m"),
    ]
}

/// A hold of a capture in the crowd: whose box it is (instance and number in its kind), who holds it and when.
struct Captured {
    of: (u32, usize),
    character: u32,
    begin: f64,
    end: f64,
    size: [f32; 3],
}

impl Captured {
    /// Frames at which it certainly holds.
    fn inner(&self, last_frame: u32) -> std::ops::Range<u32> {
        let end = (self.end - ROUNDING).floor().min(last_frame as f64);
        let begin = (self.begin + ROUNDING).ceil().max(0.0);
        // Casts of what lies before the first frame end there.
        begin as u32..(end + 1.0) as u32
    }

    fn covers(&self, frame: u32) -> bool {
        self.begin - ROUNDING <= frame as f64 && frame as f64 <= self.end + ROUNDING
    }
}

fn captured(parts: &[Part]) -> Vec<Captured> {
    let mut all = Vec::new();
    for part in parts {
        for (k, prop) in part.kind.props.iter().enumerate() {
            all.extend(prop.holds.iter().filter(|h| h.role == part.used.role).map(|h| Captured {
                of: (part.used.instance, k),
                character: part.character as u32,
                begin: part.frame_at_clock(h.begin as f64),
                end: part.frame_at_clock(h.end as f64),
                size: prop.size,
            }));
        }
    }
    all
}

/// How far people's hips are from the tops of the boxes that they sit on in the captures.
fn seats(crowd: &Crowd, parts: &[Part]) -> Worst {
    let mut worst = Worst::default();
    let mut globals = Vec::new();
    for part in parts {
        let character = &crowd.characters[part.character];
        let seats = part.kind.props.iter().flat_map(|p| &p.sat).filter(|s| s.role == part.used.role);
        for seat in seats {
            let (begin, end) = (part.frame_at_clock(seat.begin as f64), part.frame_at_clock(seat.end as f64));
            let frames = part.visible(crowd.domain.last_frame);
            for frame in frames.filter(|&f| begin <= f as f64 && f as f64 <= end && character.present(f)) {
                character.globals((frame - character.begin) as usize, &mut globals);
                let body = Body::new(&globals);
                let off = blocks(crowd, frame).map(|(_, block)| block.seat_off(&body)).fold(NO_SEAT, f32::min);
                worst.offer(off as f64, || format!("{}, frame {frame}", part.name()));
            }
        }
    }
    worst
}

/// All boxes at a frame.
fn blocks(crowd: &Crowd, frame: u32) -> impl Iterator<Item = (usize, Block)> + '_ {
    crowd.props.iter().enumerate().filter_map(move |(i, p)| {
        let at = p.places.get(frame.checked_sub(p.begin)? as usize)?;
        Some((i, Block::new(*at, p.size)))
    })
}

/// Faults of who holds what: the captures say who has a box in the hands, and nobody else has.
fn keeping(crowd: &Crowd, parts: &[Part]) -> Faults {
    let mut faults = Faults::default();
    let captured = captured(parts);
    let mut boxes: BTreeMap<(u32, usize), usize> = BTreeMap::new();
    for hold in &captured {
        for frame in hold.inner(crowd.domain.last_frame) {
            let held = (0..crowd.props.len()).filter(|&i| crowd.props[i].holders(frame).any(|c| c == hold.character));
            let held: Vec<usize> = held.collect();
            let [only] = held[..] else {
                let count = held.len();
                faults.add(|| format!("character {}, frame {frame}: expected one box, found {count}", hold.character));
                continue;
            };
            let alike = crowd.props[only].size.iter().zip(&hold.size).all(|(a, b)| (a - b).abs() <= SAME_SIZE);
            if *boxes.entry(hold.of).or_insert(only) != only || !alike {
                faults.add(|| format!("character {}, frame {frame}: holds another box, {only}", hold.character));
            }
        }
    }
    for (i, prop) in crowd.props.iter().enumerate() {
        keeping_of(i, prop, crowd, &captured, &mut faults);
    }
    faults
}

fn keeping_of(i: usize, prop: &Prop, crowd: &Crowd, captured: &[Captured], faults: &mut Faults) {
    let of = |character: u32, frame: u32| captured.iter().find(|c| c.character == character && c.covers(frame));
    for frame in prop.begin..=prop.end() {
        let mut holders = prop.holders(frame);
        let (first, second, more) = (holders.next(), holders.next(), holders.next());
        for c in [first, second].into_iter().flatten().filter(|&c| of(c, frame).is_none()) {
            faults.add(|| {
                format!("box {i}, frame {frame}: in the hands of character {c}, who holds none in the capture")
            });
        }
        let together = match (first, second) {
            (Some(a), Some(b)) => matches!((of(a, frame), of(b, frame)), (Some(x), Some(y)) if x.of == y.of),
            _ => true,
        };
        if more.is_some() || !together {
            faults.add(|| format!("box {i}, frame {frame}: in too many hands"));
        }
        let index = (frame - prop.begin) as usize;
        let was_held = frame > 0 && prop.holders(frame - 1).next().is_some();
        if first.is_none() && !was_held && index > 0 && !is_still(&prop.places[index - 1], &prop.places[index]) {
            faults.add(|| format!("box {i}, frame {frame}: moves in nobody's hands"));
        }
    }
    let (begin, end) = (prop.begin, prop.end());
    if begin > 0 && prop.holders(begin).next().is_none() {
        faults.add(|| format!("box {i}: appears at frame {begin} in nobody's hands"));
    }
    if end != crowd.domain.last_frame && (end > crowd.domain.last_frame || prop.holders(end).next().is_none()) {
        faults.add(|| format!("box {i}: is gone after frame {end}"));
    }
}

fn is_still(a: &Upright, b: &Upright) -> bool {
    a.middle.distance(b.middle) <= STILL && (a.heading - b.heading).abs() <= STILL
}

/// The worst of a box, or of all.
#[derive(Default)]
struct Measures {
    speed: Worst,
    body: Worst,
    palm: Worst,
    wall: Worst,
    floor: Worst,
}

impl Measures {
    fn merge(self, other: Self) -> Self {
        Self {
            speed: self.speed.merge(other.speed),
            body: self.body.merge(other.body),
            palm: self.palm.merge(other.palm),
            wall: self.wall.merge(other.wall),
            floor: self.floor.merge(other.floor),
        }
    }
}

fn measure(crowd: &Crowd, parts: &[Part], i: usize, prop: &Prop, fastest: f32) -> Measures {
    let mut worst = Measures::default();
    let mut globals = Vec::new();
    for frame in prop.begin..=prop.end() {
        let at = prop.places[(frame - prop.begin) as usize];
        let block = Block::new(at, prop.size);
        let place = || format!("box {i}, frame {frame}");
        worst.floor.offer((0.5 * prop.size[1] - at.middle.y) as f64, place);
        worst.wall.offer(block.depth_in_walls(&crowd.domain, frame as f32 / FPS) as f64, place);
        if let Some(before) = frame.checked_sub(prop.begin + 1) {
            let way = at.middle.distance(prop.places[before as usize].middle);
            worst.speed.offer((way * FPS / fastest) as f64, place);
        }
        for (c, character) in crowd.characters.iter().enumerate().filter(|(_, c)| c.frames() > 0 && c.present(frame)) {
            let index = (frame - character.begin) as usize;
            let place = || format!("box {i} and character {c}, frame {frame}");
            if prop.holders(frame).any(|h| h == c as u32) {
                character.globals(index, &mut globals);
                worst.palm.offer(block.palms_off(palms(&globals)) as f64, place);
            } else if block.is_near(character.root[index]) {
                character.globals(index, &mut globals);
                let depth = block.depth_in(&Body::new(&globals));
                if depth > 0.0 {
                    let allowed = captured_depth(crowd, parts, prop, c, frame);
                    worst.body.offer((depth - allowed) as f64, place);
                }
            }
        }
    }
    worst
}

/// How deep the box is in somebody of its patch in the capture at the moment that `frame` shows.
fn captured_depth(crowd: &Crowd, parts: &[Part], prop: &Prop, character: usize, frame: u32) -> f32 {
    let shown = |p: &&Part| p.used.begin <= frame as i32 && frame as i32 <= p.used.end;
    let mine = parts.iter().filter(|p| p.character == character).filter(shown);
    let handles = |p: &Part| {
        let players = parts.iter().filter(|q| q.used.instance == p.used.instance);
        players.into_iter().any(|q| {
            let span = q.visible(crowd.domain.last_frame);
            prop.holds.iter().any(|h| h.character as usize == q.character && h.begin < span.end && span.start <= h.end)
        }) || prop.holds.is_empty() && stands_by(p, prop)
    };
    let depths =
        mine.filter(|p| handles(p)).flat_map(|p| (0..p.kind.props.len()).map(move |k| depth_in_capture(p, k, frame)));
    depths.fold(0.0, f32::max)
}

/// True if a box that nobody holds is where the capture has people sit on one, or has one lie that is put down before time
/// begins or taken up after it ends.
fn stands_by(part: &Part, prop: &Prop) -> bool {
    let (begin, end) = part.clock_range();
    let lies = |at: Upright, clock: u32| {
        let world_from_patch = part.deformed_at(clock).then(part.captured_at(clock).inverse());
        at.carried(world_from_patch).middle.distance(prop.places[0].middle) <= ASTRAY
    };
    let mut rests = part.kind.props.iter().flat_map(|p| [p.before.map(|at| (at, begin)), p.after.map(|at| (at, end))]);
    rests.any(|rest| rest.is_some_and(|(at, clock)| lies(at, clock)))
}

/// Between two captured frames the deeper of them.
fn depth_in_capture(part: &Part, prop: usize, frame: u32) -> f32 {
    let prop = &part.kind.props[prop];
    let (begin, end) = part.clock_range();
    let clock = part.clock_at_frame(frame as f64).clamp(begin as f64, end as f64);
    let at = |clock: u32| {
        let mut globals = Vec::new();
        let holder = prop.holds.iter().find(|h| h.begin <= clock && clock <= h.end);
        let place = match holder {
            Some(hold) => {
                let source = &part.kind.fragments[hold.role as usize];
                source.motion.globals((clock - source.begin) as usize, &mut globals);
                Some(place_between(palms(&globals), prop.grip))
            }
            None if prop.holds.first().is_some_and(|h| clock < h.begin) => prop.before,
            None => prop.place(part.kind, clock),
        };
        let Some(place) = place else { return 0.0 };
        part.source.motion.globals((clock - begin) as usize, &mut globals);
        Block::new(place, prop.size).depth_in(&Body::new(&globals))
    };
    at(clock.floor() as u32).max(at(clock.ceil() as u32))
}

fn overlaps(crowd: &Crowd) -> Worst {
    let at_frame = |frame: u32| {
        let here: Vec<(usize, Block)> = blocks(crowd, frame).collect();
        let mut worst = Worst::default();
        for (k, (i, block)) in here.iter().enumerate() {
            for (j, other) in &here[..k] {
                let depth = block.depth_into(other);
                if depth > 0.0 {
                    worst.offer(depth as f64, || format!("boxes {j} and {i}, frame {frame}"));
                }
            }
        }
        worst
    };
    let seen = crowd.props.iter().map(|p| p.end() + 1).max().unwrap_or(0);
    let all: Vec<Worst> = (0..seen).into_par_iter().map(at_frame).collect();
    all.into_iter().fold(Worst::default(), Worst::merge)
}

/// The fastest palm of any capture, m/s; 1 at least.
fn fastest_palm(crowd: &Crowd) -> f32 {
    let motions: Vec<&Motion> = crowd.set.kinds.iter().flat_map(|k| &k.fragments).map(|f| &f.motion).collect();
    let fastest = |motion: &&Motion| {
        let mut globals: Vec<(Vec3, Quat)> = Vec::new();
        let mut at = |frame: usize| {
            motion.globals(frame, &mut globals);
            palms(&globals)
        };
        let places: Vec<[Vec3; 2]> = (0..motion.len()).map(&mut at).collect();
        let steps = places.windows(2).flat_map(|w| [w[0][0].distance(w[1][0]), w[0][1].distance(w[1][1])]);
        steps.fold(0.0, f32::max) * FPS
    };
    motions.par_iter().map(fastest).reduce(|| 1.0, f32::max)
}

/// Ground point of a place, metres.
pub(super) fn on_ground(p: Vec3) -> Vec2 {
    Vec2::new(p.x, p.z)
}
