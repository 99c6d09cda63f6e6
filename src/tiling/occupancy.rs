//! Who is where when: placed pieces and, per tick, a grid of their bodies.

use std::ops::{ControlFlow, RangeInclusive};

use glam::Vec2;

use super::bridge::NO_INSTANCE;
use super::domain::Domain;
use super::footprint::{DISCS, Footprint};
use super::library::{Library, Role};
use crate::geom::{Ground, Turn};
use crate::motion::MotionPath;

/// Cell size of the grid in metres.
const CELL: f32 = 1.0;
/// Most bodies whose path points lie in one cell; a fuller cell counts as blocked.
const CELL_BODIES: usize = 7;

/// Cells beyond which nothing is looked for.
const FAR: f32 = 1024.0;

/// In place of a source frame: a box that lies there before (+ 0) or after (+ 1) the piece.
const LYING: u32 = u32::MAX - 1;

/// Index of a placed piece.
pub(super) type PieceId = u32;

/// A body at one tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    position: Vec2,
    turn: Turn,
    reach: f32,
    frame: u32,
}

/// One role of an instance, placed: from tick `begin` to tick `end`, along `path` (world, one sample per source frame).
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Index of the role in the library.
    pub role: u32,
    /// Index of the instance.
    pub instance: u32,
    /// Tick of the entry.
    pub begin: i32,
    /// Tick of the exit.
    pub end: i32,
    /// The deformed path.
    pub path: MotionPath,
    /// First tick of `bodies`.
    shown_from: i32,
    /// The bodies on the ticks it occupies: [begin, end) cut to [0, horizon); before and after them the box that lies
    /// there until the piece takes it up, or from when it puts it down.
    bodies: Vec<Body>,
}

impl Piece {
    /// A role placed rigidly with its entry at `from`.
    pub fn rigid(library: &Library, domain: &Domain, role: u32, instance: u32, from: Ground, begin: i32) -> Self {
        let source = &library.roles[role as usize];
        let path = MotionPath {
            points: source.path.points.iter().map(|&p| from.apply(p)).collect(),
            headings: source.path.headings.iter().map(|h| h + from.heading).collect(),
        };
        Self::along(library, domain, role, instance, path, begin, begin + source.ticks)
    }

    /// A role placed along a deformed path.
    pub fn along(
        library: &Library,
        domain: &Domain,
        role: u32,
        instance: u32,
        path: MotionPath,
        begin: i32,
        end: i32,
    ) -> Self {
        let source = &library.roles[role as usize];
        let last = path.len() - 1;
        let step = last as f32 / (end - begin) as f32;
        let bodies = (begin.max(0)..end.min(domain.horizon)).map(|tick| {
            let at = (tick - begin) as f32 * step;
            let i = (at as usize).min(last - 1);
            let t = at - i as f32;
            let frame = (at + 0.5) as usize;
            Body {
                position: path.points[i].lerp(path.points[i + 1], t),
                turn: Turn::from_angle(path.headings[i] * (1.0 - t) + path.headings[i + 1] * t),
                reach: source.reach[frame],
                frame: frame as u32,
            }
        });
        let bodies = bodies.collect();
        let mut piece = Self { role, instance, begin, end, path, shown_from: begin.max(0), bodies };
        piece.lay_boxes(source, domain.horizon);
        piece
    }

    /// Puts boxes where they lie before the piece begins and after it ends.
    fn lay_boxes(&mut self, source: &Role, horizon: i32) {
        let lying = |k: usize, ticks: i32| {
            let rest = source.rests[k].as_ref().filter(|_| ticks > 0)?;
            let at = self.path.at(rest.frame).then(rest.from_path);
            let body = Body {
                position: at.position,
                turn: at.turn(),
                reach: rest.reach,
                frame: LYING + k as u32,
            };
            Some(std::iter::repeat_n(body, ticks as usize))
        };
        let (before, after) = (lying(0, self.begin.min(horizon)), lying(1, horizon - self.end.max(0)));
        self.bodies.extend(after.into_iter().flatten());
        if let Some(before) = before {
            self.bodies.splice(..0, before);
            self.shown_from = 0;
        }
    }

    /// State at the entry.
    pub fn entry(&self) -> Ground {
        self.path.at(0)
    }

    /// State at the exit.
    pub fn exit(&self) -> Ground {
        self.path.at(self.path.len() - 1)
    }

    fn body(&self, tick: i32) -> Option<&Body> {
        self.bodies.get(usize::try_from(tick - self.shown_from).ok()?)
    }

    /// Place and heading at a tick the piece occupies.
    pub fn state(&self, tick: i32) -> Ground {
        let body = self.body(tick).expect("a tick the piece occupies");
        Ground::new(body.position, body.turn.angle())
    }

    /// True if the person is in the piece at a tick.
    pub fn is_played(&self, tick: i32) -> bool {
        self.begin <= tick && tick < self.end
    }

    /// Ticks inside the domain's time.
    pub fn ticks_inside(&self) -> usize {
        self.bodies.iter().filter(|b| b.frame < LYING).count()
    }

    /// True if a box lies there before or after the piece.
    pub fn leaves_box(&self) -> bool {
        [self.bodies.first(), self.bodies.last()].into_iter().flatten().any(|b| b.frame >= LYING)
    }

    /// True if this piece and another are ever in each other's way.
    pub fn meets(&self, other: &Self, library: &Library) -> bool {
        let until = |p: &Self| p.shown_from + p.bodies.len() as i32;
        let ticks = self.shown_from.max(other.shown_from)..until(self).min(until(other));
        ticks.into_iter().any(|tick| depth(library, self, other, tick).is_some())
    }
}

/// The bodies in one cell at one tick, with what the cheap tests need beside them.
#[derive(Clone, Copy, Default)]
struct Cell {
    count: u32,
    bodies: [Shown; CELL_BODIES],
}

#[derive(Clone, Copy, Default)]
struct Shown {
    id: PieceId,
    position: Vec2,
    reach: f32,
}

/// All placed pieces.
pub(super) struct Occupancy {
    pieces: Vec<Option<Piece>>,
    free: Vec<PieceId>,
    cells: Vec<Cell>,
    columns: i32,
    rows: i32,
    origin: Vec2,
    max_reach: f32,
}

impl Occupancy {
    /// An empty one.
    pub fn new(domain: &Domain, library: &Library) -> Self {
        let size = ((domain.max - domain.min) / CELL).ceil();
        let (columns, rows) = (size.x as i32 + 1, size.y as i32 + 1);
        Self {
            pieces: vec![],
            free: vec![],
            cells: vec![Cell::default(); (columns * rows * domain.horizon) as usize],
            columns,
            rows,
            origin: domain.min,
            max_reach: library.max_reach,
        }
    }

    /// A placed piece.
    pub fn piece(&self, id: PieceId) -> &Piece {
        self.pieces[id as usize].as_ref().expect("a live piece")
    }

    /// Takes a piece in and shows its bodies.
    pub fn insert(&mut self, piece: Piece) -> PieceId {
        let id = self.free.pop().unwrap_or_else(|| {
            self.pieces.push(None);
            self.pieces.len() as PieceId - 1
        });
        self.pieces[id as usize] = Some(piece);
        self.show(id);
        id
    }

    /// Forgets a piece that is hidden.
    pub fn forget(&mut self, id: PieceId) {
        self.pieces[id as usize] = None;
        self.free.push(id);
    }

    /// Puts another piece in the place of a hidden one, which is answered.
    pub fn replace(&mut self, id: PieceId, piece: Piece) -> Piece {
        let before = self.pieces[id as usize].replace(piece).expect("a live piece");
        self.show(id);
        before
    }

    /// A placed piece, if there is one of this id.
    pub fn get(&self, id: PieceId) -> Option<&Piece> {
        self.pieces.get(id as usize)?.as_ref()
    }

    /// Puts the bodies of a hidden piece back.
    pub fn show(&mut self, id: PieceId) {
        let piece = self.pieces[id as usize].take().expect("a live piece");
        for (tick, body) in (piece.shown_from..).zip(&piece.bodies) {
            let cell = self.cell_of(tick, body.position);
            let cell = &mut self.cells[cell];
            cell.bodies[cell.count as usize] = Shown { id, position: body.position, reach: body.reach };
            cell.count += 1;
        }
        self.pieces[id as usize] = Some(piece);
    }

    /// Takes the bodies of a piece out, keeping the piece.
    pub fn hide(&mut self, id: PieceId) {
        let piece = self.pieces[id as usize].take().expect("a live piece");
        for (tick, body) in (piece.shown_from..).zip(&piece.bodies) {
            let cell = self.cell_of(tick, body.position);
            let cell = &mut self.cells[cell];
            let at = cell.bodies[..cell.count as usize].iter().position(|b| b.id == id).expect("shown");
            cell.count -= 1;
            cell.bodies[at] = cell.bodies[cell.count as usize];
        }
        self.pieces[id as usize] = Some(piece);
    }

    fn cell_of(&self, tick: i32, position: Vec2) -> usize {
        let (x, z) = self.column_and_row(position);
        let (x, z) = (x.clamp(0, self.columns - 1), z.clamp(0, self.rows - 1));
        ((tick * self.rows + z) * self.columns + x) as usize
    }

    /// May be outside the grid. A cast rounds towards zero, which is down once the number is above it; calls of `floor`
    /// would cost more than all the rest.
    fn column_and_row(&self, position: Vec2) -> (i32, i32) {
        let c = (position - self.origin) / CELL + FAR;
        (c.x as i32 - FAR as i32, c.y as i32 - FAR as i32)
    }

    /// True if the piece stays inside the domain and clear of all bodies shown, but for those of its own instance.
    /// Frames are probed coarse to fine.
    pub fn is_free(&self, library: &Library, domain: &Domain, piece: &Piece) -> bool {
        let n = piece.bodies.len();
        let free = |i: usize| {
            self.is_inside(library, domain, piece, i)
                && self.meet(library, piece, i, &mut |_| ControlFlow::Break(())).is_continue()
        };
        (0..n).step_by(8).all(free) && (4..n).step_by(8).all(free) && (0..n).filter(|i| i % 4 != 0).all(free)
    }

    /// The pieces whose bodies are in the way of `piece`, sorted; `None` if a wall or a crush is.
    pub fn blockers(&self, library: &Library, domain: &Domain, piece: &Piece) -> Option<Vec<PieceId>> {
        let n = piece.bodies.len();
        if !(0..n).all(|i| self.is_inside(library, domain, piece, i)) {
            return None;
        }
        let mut found = Vec::new();
        for i in 0..n {
            let crush = self.meet(library, piece, i, &mut |id| {
                if let Some(id) = id {
                    found.push(id);
                    return ControlFlow::Continue(());
                }
                ControlFlow::Break(())
            });
            if crush.is_break() {
                return None;
            }
        }
        found.sort_unstable();
        found.dedup();
        Some(found)
    }

    fn is_inside(&self, library: &Library, domain: &Domain, piece: &Piece, i: usize) -> bool {
        let body = &piece.bodies[i];
        domain.holds(body.position, body.reach) || {
            world_discs(body, footprint(library, piece.role, body)).iter().all(|d| domain.holds(d.truncate(), d.z))
        }
    }

    /// Calls `met` with each piece whose body overlaps body `i` of `piece`, or with `None` for a cell that is full,
    /// until it breaks.
    fn meet(
        &self,
        library: &Library,
        piece: &Piece,
        i: usize,
        met: &mut impl FnMut(Option<PieceId>) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let body = &piece.bodies[i];
        let tick = piece.shown_from + i as i32;
        let reach = body.reach + self.max_reach;
        let mut discs = None;
        let (columns, rows) = self.cells_within(body.position, reach);
        for z in rows {
            for x in columns.clone() {
                let cell = &self.cells[((tick * self.rows + z) * self.columns + x) as usize];
                if cell.count as usize == CELL_BODIES {
                    met(None)?;
                }
                for shown in &cell.bodies[..cell.count as usize] {
                    let apart = body.reach + shown.reach;
                    if body.position.distance_squared(shown.position) >= apart * apart {
                        continue;
                    }
                    let other = self.piece(shown.id);
                    if other.instance == piece.instance && piece.instance != NO_INSTANCE {
                        continue;
                    }
                    let theirs = other.body(tick).expect("shown at this tick");
                    let own = discs.get_or_insert_with(|| world_discs(body, footprint(library, piece.role, body)));
                    if overlap(own, &world_discs(theirs, footprint(library, other.role, theirs))) {
                        met(Some(shown.id))?;
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }

    fn cells_within(&self, position: Vec2, distance: f32) -> (RangeInclusive<i32>, RangeInclusive<i32>) {
        let (low, high) = (self.column_and_row(position - distance), self.column_and_row(position + distance));
        (low.0.max(0)..=high.0.min(self.columns - 1), low.1.max(0)..=high.1.min(self.rows - 1))
    }

    /// Ids of the pieces whose people's path points lie within `distance` of `position` at `tick`, in no particular order.
    pub fn near(&self, tick: i32, position: Vec2, distance: f32, out: &mut Vec<PieceId>) {
        out.clear();
        let (columns, rows) = self.cells_within(position, distance);
        for z in rows {
            for x in columns.clone() {
                let cell = &self.cells[((tick * self.rows + z) * self.columns + x) as usize];
                let near = |b: &&Shown| b.position.distance_squared(position) < distance * distance;
                let near = cell.bodies[..cell.count as usize].iter().filter(near).map(|b| b.id);
                out.extend(near.filter(|&id| self.piece(id).is_played(tick)));
            }
        }
    }
}

/// How deep the footprints of two pieces overlap at a tick, metres; `None` if either is not there, or they are apart.
pub(super) fn depth(library: &Library, a: &Piece, b: &Piece, tick: i32) -> Option<f32> {
    let body = |p: &Piece| {
        let body = p.body(tick)?;
        Some((body.position, body.reach, world_discs(body, footprint(library, p.role, body))))
    };
    let ((at, reach, own), (other_at, other_reach, others)) = (body(a)?, body(b)?);
    if at.distance(other_at) >= reach + other_reach {
        return None;
    }
    let pairs = own.iter().flat_map(|p| others.iter().map(move |q| p.z + q.z - p.truncate().distance(q.truncate())));
    pairs.reduce(f32::max).filter(|&d| d > 0.0)
}

fn footprint<'a>(library: &'a Library, role: u32, body: &Body) -> &'a Footprint {
    let role = &library.roles[role as usize];
    match body.frame.checked_sub(LYING) {
        None => &role.footprints[body.frame as usize],
        Some(k) => &role.rests[k as usize].as_ref().expect("a box lies there").footprint,
    }
}

fn world_discs(body: &Body, footprint: &Footprint) -> Footprint {
    footprint.map(|d| (body.position + body.turn.apply(d.truncate())).extend(d.z))
}

fn overlap(a: &Footprint, b: &Footprint) -> bool {
    for p in a {
        for q in b {
            let apart = p.z + q.z;
            if p.truncate().distance_squared(q.truncate()) < apart * apart {
                return true;
            }
        }
    }
    debug_assert_eq!(a.len(), DISCS);
    false
}
