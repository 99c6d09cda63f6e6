//! Bridging: a chain of single-person patches from one port to another, or on to the edge of time.
//!
//! Best-first search over rigidly placed patches, which stitch exactly; only the last one or two are deformed so that
//! the chain ends exactly where it must. Wherever the rest can be closed by such a strand the search ends.

use std::collections::BinaryHeap;

use rand::{Rng, RngExt};
use rand_chacha::ChaCha8Rng;
use rustc_hash::FxHashSet;

use super::domain::Spot;
use super::library::{Closing, Library, Move, Span};
use super::piece::{Company, Piece, Rigid};
use super::view::View;
use crate::geom::{Ground, wrap_angle};
use crate::motion::{FPS, MotionPath};

/// A port to be met: a place, a heading, a tick and a pose group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Port {
    /// Place and heading.
    pub at: Ground,
    /// When.
    pub tick: i32,
    /// Pose group.
    pub group: u32,
}

/// What a chain must lead to.
#[derive(Clone, Copy, Debug)]
pub(super) enum Goal {
    /// Exactly this port (forward in time only).
    Port(Port),
    /// Any state at or after this tick, searching forward.
    Until(i32),
    /// Any state at or before this tick, searching backward.
    Since(i32),
}

/// Taste of the search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Taste {
    /// Cost factor of standing and turning in place; below 1 people rather stand.
    pub calm: f32,
    /// Cost per second and m^2 of standing with more room than the most compact way to stand takes.
    pub compact: f32,
    /// Most states expanded.
    pub expansions: usize,
}

/// Instance index of pieces that belong to no instance yet.
pub(super) const NO_INSTANCE: u32 = u32::MAX;

// Search constants: see the docs of the project, "The engine".
const CLOSE_WITHIN_TICKS: i32 = 110;
const TIME_WEIGHT: f32 = 0.95;
const LATE_WEIGHT: f32 = 2.5;
const TURN_WEIGHT: f32 = 0.5;
const EASY_SPEED: f32 = 1.2;
const TOP_SPEED: f32 = 1.7;
const SLACK: f32 = 0.5;
const EASY_REACH: f32 = 0.45;
const EASY_TURN: f32 = 0.6;
const MAX_TURN: f32 = std::f32::consts::FRAC_PI_3;
/// Ways to a port that take longer than this are long, seconds.
const LONG_WAY: f32 = 4.0;
/// A state this close to a wall leads nowhere.
const WALL_ROOM: f32 = 0.3;
/// Steps sideways and back cost this much more than walking ahead: people turn to where they go.
const ASKEW_WEIGHT: f32 = 0.2;
/// Cost factor of taking up and putting down.
const LIFT_WEIGHT: f32 = 0.85;
/// Cost factor of jumping over something and over nothing.
const LEAP_OVER: f32 = 0.2;
const LEAP_WEIGHT: f32 = 4.0;
/// Cost of a box that lies about for a second.
const CLUTTER_WEIGHT: f32 = 0.05;
/// Below this mean speed a patch counts as standing, m/s.
pub(super) const STANDING_SPEED: f32 = 0.25;

struct Node {
    at: Port,
    cost: f32,
    parent: u32,
    role: u32,
    /// Whether the way to here leaves boxes lying, which the rest of it must not run into.
    boxed: bool,
}

/// In place of a role: where the search begins.
const ROOT: u32 = u32::MAX;

#[derive(PartialEq)]
struct Entry {
    score: f32,
    node: u32,
}

impl Eq for Entry {}
impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Entry {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        // The heap is a max-heap: small scores first, then old nodes.
        other.score.total_cmp(&self.score).then(other.node.cmp(&self.node))
    }
}

/// The search with its reusable buffers.
pub(super) struct Bridge {
    nodes: Vec<Node>,
    heap: BinaryHeap<Entry>,
    seen: FxHashSet<u64>,
    backward: bool,
    company: Company,
    path: MotionPath,
}

impl Default for Bridge {
    fn default() -> Self {
        Self {
            nodes: vec![],
            heap: BinaryHeap::new(),
            seen: FxHashSet::default(),
            backward: false,
            company: Company::NONE,
            path: MotionPath::default(),
        }
    }
}

impl Bridge {
    /// A chain of free pieces, in order of time, from `from` to `goal`; `None` if none was found in `taste.expansions`.
    ///
    /// `company` has the patches of several people that the chain leads from and to. Time O(expansions x moves x frames).
    pub fn search(
        &mut self,
        view: View,
        from: Port,
        goal: Goal,
        company: Company,
        taste: Taste,
        rng: &mut ChaCha8Rng,
    ) -> Option<Vec<Piece>> {
        self.company = company;
        self.nodes.clear();
        self.heap.clear();
        self.seen.clear();
        self.backward = matches!(goal, Goal::Since(_));
        self.push(Node { at: from, cost: 0.0, parent: 0, role: ROOT, boxed: false }, 0.0);
        let mut expansions = 0;
        while let Some(Entry { node, .. }) = self.heap.pop() {
            let at = self.nodes[node as usize].at;
            // A state counts as seen once a free patch has led to it: the first that would may be blocked.
            if self.seen.contains(&key(&at)) || !self.is_free(view, node) {
                continue;
            }
            self.seen.insert(key(&at));
            let done = match goal {
                Goal::Port(_) => false,
                Goal::Until(tick) => at.tick >= tick,
                Goal::Since(tick) => at.tick <= tick,
            };
            if done {
                return Some(self.chain(view, node, vec![]));
            }
            if let Goal::Port(to) = goal
                && let Some(last) = self.close(view, node, to, rng)
            {
                return Some(self.chain(view, node, last));
            }
            expansions += 1;
            if expansions > taste.expansions {
                return None;
            }
            self.expand(view, node, goal, taste, rng);
        }
        None
    }

    fn push(&mut self, node: Node, score: f32) {
        self.heap.push(Entry { score, node: self.nodes.len() as u32 });
        self.nodes.push(node);
    }

    /// Entry and tick of a node's patch.
    fn entry(&self, node: u32) -> (Ground, i32) {
        let n = &self.nodes[node as usize];
        let at = if self.backward { n.at } else { self.nodes[n.parent as usize].at };
        (at.at, at.tick)
    }

    fn piece(&self, view: View, node: u32) -> Piece {
        let (entry, begin) = self.entry(node);
        let role = self.nodes[node as usize].role;
        Piece {
            company: self.company_of(node),
            ..Piece::rigid(view.library, view.domain, role, NO_INSTANCE, entry, begin)
        }
    }

    /// The patches that a node's patch leads from and to: only the one next to where the search began is known.
    fn company_of(&self, node: u32) -> Company {
        match (self.nodes[node as usize].parent, self.backward) {
            (0, false) => Company { to: NO_INSTANCE, ..self.company },
            (0, true) => Company { from: NO_INSTANCE, ..self.company },
            _ => Company::NONE,
        }
    }

    /// True if the patch that leads to a node is in nobody's way.
    fn is_free(&self, view: View, node: u32) -> bool {
        let Node { role, boxed, parent, .. } = self.nodes[node as usize];
        if role == ROOT {
            return true;
        }
        let leaves_box = view.library.roles[role as usize].leaves_box();
        let (entry, begin) = self.entry(node);
        if !leaves_box && !view.is_free_rigid(role, Rigid::new(view.library, role, entry, begin), self.company_of(node))
        {
            return false;
        }
        if !boxed {
            return true;
        }
        let piece = self.piece(view, node);
        (!leaves_box || view.is_free(&piece)) && !self.meets_own_way(view, parent, &piece)
    }

    /// True if a piece runs into a box on the way to a node, or its own box lies on that way.
    fn meets_own_way(&self, view: View, node: u32, piece: &Piece) -> bool {
        let mut at = node;
        while self.nodes[at as usize].role != ROOT {
            let other = self.piece(view, at);
            if (other.leaves_box() || piece.leaves_box()) && piece.meets(&other, view.library) {
                return true;
            }
            at = self.nodes[at as usize].parent;
        }
        false
    }

    fn expand(&mut self, view: View, node: u32, goal: Goal, taste: Taste, rng: &mut ChaCha8Rng) {
        let from = self.nodes[node as usize].at;
        let Node { cost, boxed, .. } = self.nodes[node as usize];
        let (moves, direction) = match goal {
            Goal::Since(_) => (&view.library.backward, -1),
            _ => (&view.library.forward, 1),
        };
        let turn = from.at.turn();
        for step in &moves[from.group as usize] {
            let place = from.at.position + turn.apply(step.to.position);
            let at = Ground::new(place, from.at.heading + step.to.heading);
            let at = Port { at, tick: from.tick + direction * step.ticks, group: step.group };
            let inside =
                view.domain.is_unseen(at.tick) || view.domain.holds(Spot::ground(at.tick), at.at.position, WALL_ROOM);
            if !inside || self.seen.contains(&key(&at)) {
                continue;
            }
            let price = price(view, step, &at);
            let effort = step_cost(view, step, taste) * leap_weight(view, step, &from, goal);
            let cost = cost + effort * price * rng.random_range(0.85..1.2) + clutter(view, step, from.tick);
            if let Some(left) = cost_left(&at, goal, price) {
                let boxed = boxed || view.library.roles[step.role as usize].leaves_box();
                self.push(Node { at, cost, parent: node, role: step.role, boxed }, cost + left);
            }
        }
    }

    /// The last one or two patches, deformed so that they lead from a node exactly to `to`.
    fn close(&mut self, view: View, node: u32, to: Port, rng: &mut ChaCha8Rng) -> Option<Vec<Piece>> {
        let from = self.nodes[node as usize].at;
        let left = to.tick - from.tick;
        if left <= 0 || left > CLOSE_WITHIN_TICKS {
            return None;
        }
        let closings = view.library.closings_between(from.group, to.group);
        let count = closings.all.len();
        if count == 0 {
            return None;
        }
        // Begin anywhere, so that no kind is always the first to be tried.
        let start = rng.next_u32() as usize % count;
        let way = from.at.inverse().then(to.at);
        let fits = |&i: &usize| closings.spans[i].leads(way, left, closings.spans[i].reach, MAX_TURN);
        (start..count).chain(0..start).filter(fits).find_map(|i| self.try_close(view, &closings.all[i], node, to))
    }

    fn try_close(&mut self, view: View, closing: &Closing, node: u32, to: Port) -> Option<Vec<Piece>> {
        let Node { at: from, boxed, .. } = self.nodes[node as usize];
        if !closing.strand.deform(from.at, to.at, &view.library.limits, &mut self.path) {
            return None;
        }
        let mut pieces = split(view, closing, &self.path, from.tick, to.tick)?;
        if node == 0 {
            pieces[0].company.from = self.company.from;
        }
        pieces.last_mut()?.company.to = self.company.to;
        let free = |p: &Piece| view.is_free(p) && !(boxed && self.meets_own_way(view, node, p));
        pieces.iter().all(free).then_some(pieces)
    }

    fn chain(&self, view: View, node: u32, last: Vec<Piece>) -> Vec<Piece> {
        let mut pieces = Vec::new();
        let mut at = node;
        while self.nodes[at as usize].role != ROOT {
            pieces.push(self.piece(view, at));
            at = self.nodes[at as usize].parent;
        }
        if !self.backward {
            pieces.reverse();
        }
        pieces.extend(last);
        pieces
    }
}

impl Span {
    /// True if the closing takes `left` ticks and ends no farther than `reach` and `turn` from the end of `way`.
    fn leads(&self, way: Ground, left: i32, reach: f32, turn: f32) -> bool {
        self.ticks.0 <= left
            && left <= self.ticks.1
            && self.exit.position.distance_squared(way.position) < reach * reach
            && wrap_angle(self.exit.heading - way.heading).abs() < turn
    }
}

/// Number of strands that lead from one port to another with little deformation: how easy the bridge will be.
pub(super) fn easy_closings(library: &Library, from: Port, to: Port) -> usize {
    easy(library, from, to).count()
}

/// True if at least `wanted` strands do.
pub(super) fn has_easy_closings(library: &Library, from: Port, to: Port, wanted: usize) -> bool {
    easy(library, from, to).take(wanted).count() == wanted
}

fn easy<'a>(library: &'a Library, from: Port, to: Port) -> impl Iterator<Item = &'a Span> {
    let (left, way) = (to.tick - from.tick, from.at.inverse().then(to.at));
    let closings = library.closings_between(from.group, to.group);
    let farthest = TOP_SPEED * left as f32 / FPS + SLACK;
    let spans = if way.position.length_squared() > farthest * farthest { &[] } else { closings.spans.as_slice() };
    spans.iter().filter(move |span| span.leads(way, left, EASY_REACH, EASY_TURN))
}

/// Cuts a deformed strand into the pieces of its roles, sharing out the ticks in proportion to the sources'; `None` if
/// the hips would turn too fast.
fn split(view: View, closing: &Closing, path: &MotionPath, begin: i32, end: i32) -> Option<Vec<Piece>> {
    let role = |r: u32| &view.library.roles[r as usize];
    let first = closing.roles[0].expect("a closing has a first role");
    let piece = |r: u32, path: MotionPath, begin: i32, end: i32| {
        let hurried = view.library.is_hurried(r, &path, end - begin);
        (!hurried).then(|| Piece::along(view.library, view.domain, r, NO_INSTANCE, path, begin, end))
    };
    let Some(second) = closing.roles[1] else {
        return Some(vec![piece(first, path.clone(), begin, end)?]);
    };
    let cut = role(first).ticks as usize;
    let share = cut as f32 / (path.len() - 1) as f32;
    let range = |r| role(r).tick_range;
    let ((low_a, high_a), (low_b, high_b)) = (range(first), range(second));
    let ticks = ((end - begin) as f32 * share).round() as i32;
    let ticks = ticks.clamp(low_a.max(end - begin - high_b), high_a.min(end - begin - low_b));
    let part = |range: std::ops::RangeInclusive<usize>| MotionPath {
        points: path.points[range.clone()].to_vec(),
        headings: path.headings[range].to_vec(),
    };
    Some(vec![
        piece(first, part(0..=cut), begin, begin + ticks)?,
        piece(second, part(cut..=path.len() - 1), begin + ticks, end)?,
    ])
}

fn step_cost(view: View, step: &Move, taste: Taste) -> f32 {
    let lifts = view.library.roles[step.role as usize].leaves_box();
    let factor = if lifts {
        LIFT_WEIGHT
    } else if step.speed < STANDING_SPEED {
        taste.calm + taste.compact * step.room
    } else {
        1.0 + ASKEW_WEIGHT * step.askew
    };
    step.ticks as f32 / FPS * factor
}

/// Who jumps does it over something: cheap where there is an obstacle under the highest point, dear elsewhere.
fn leap_weight(view: View, step: &Move, from: &Port, goal: Goal) -> f32 {
    let role = &view.library.roles[step.role as usize];
    let Some(frame) = role.leap else { return 1.0 };
    let (entry, begin) = match goal {
        Goal::Since(_) => (from.at.then(step.to), from.tick - step.ticks),
        _ => (from.at, from.tick),
    };
    let place = entry.then(role.path.at(frame)).position;
    if view.domain.is_over_obstacle(begin + frame as i32, place) { LEAP_OVER } else { LEAP_WEIGHT }
}

/// Equation 7: what a step costs more for leading where, when or which way nobody wants to be.
fn price(view: View, step: &Move, to: &Port) -> f32 {
    view.library.preference.price(view.library.roles[step.role as usize].kind, view.domain.stay(to.at, to.tick))
}

/// Cost of the time over which a step leaves a box lying about.
fn clutter(view: View, step: &Move, tick: i32) -> f32 {
    let rests = &view.library.roles[step.role as usize].rests;
    let before = if rests[0].is_some() { tick.max(0) } else { 0 };
    let after = if rests[1].is_some() { (view.domain.horizon - tick).max(0) } else { 0 };
    CLUTTER_WEIGHT * (before + after) as f32 / FPS
}

/// Estimated cost from `at` to the goal, in seconds, the time there costing `price`; `None` if the goal is out of reach.
fn cost_left(at: &Port, goal: Goal, price: f32) -> Option<f32> {
    match goal {
        Goal::Until(tick) => Some(price * TIME_WEIGHT * (tick - at.tick).max(0) as f32 / FPS),
        Goal::Since(tick) => Some(price * TIME_WEIGHT * (at.tick - tick).max(0) as f32 / FPS),
        Goal::Port(to) => {
            let left = (to.tick - at.tick) as f32 / FPS;
            let distance = at.at.position.distance(to.at.position);
            let reachable = left > 0.0 && distance <= TOP_SPEED * left + SLACK;
            let turn = wrap_angle(to.at.heading - at.at.heading).abs() - MAX_TURN;
            let late = (distance - EASY_SPEED * left).max(0.0) + TURN_WEIGHT * (turn - left).max(0.0);
            // A short way ends at the goal's price, a long one goes on at that of the present place.
            let price = if left > LONG_WAY { price } else { 1.0 };
            reachable.then_some(price * TIME_WEIGHT * left + LATE_WEIGHT * late)
        }
    }
}

/// States of one key are as good as the same: 25 cm, 20 degrees, 5 ticks.
fn key(p: &Port) -> u64 {
    let heading = (wrap_angle(p.at.heading).to_degrees() / 20.0).round() as i64 as u64;
    let cell = (p.at.position * 4.0).round();
    let field = |value: i64, bits: u32| value as u64 & ((1 << bits) - 1);
    let place = field(cell.x as i64, 18) << 18 | field(cell.y as i64, 18);
    (place << 28) | (heading & 0x1f) << 23 | field(p.tick.div_euclid(5) as i64, 15) << 8 | u64::from(p.group)
}
