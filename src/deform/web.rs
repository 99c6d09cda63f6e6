//! Deformation of a web of motion paths: everyone in a patch at once (section 3 of "Tiling Motion Patches", after Kim
//! et al. 2009, "Synchronized multi-character motion editing").
//!
//! Unknown are, per person and frame, the position p_i and a local similarity s_i, both complex. The energy
//!
//! sum w_i |p_(i+1) - p_i - (s_i + s_(i+1))/2 e_i|^2 + sum k_i |s_(i+1) - s_i|^2
//!
//! keeps edges e_i as captured but for similarities that change little from frame to frame. As s_i is an unknown of
//! its own, standing people (e_i = 0) have a heading, and both weights grow where a person stands, so that standing
//! people neither turn nor glide. Handles fix p_i and s_i of some frames.
//!
//! People in contact, and everyone during a patch's core, keep their relative placement: p_b - p_a = s_a d and
//! s_b = s_a. These constraints are not weighted rows but are eliminated: people in contact at a tick are one rigid
//! node (P, S) with p = P + S d and s = S. That is exact, leaves fewer unknowns, and the matrix keeps the energy's
//! condition, where heavy weights would cost digits. Nodes are ordered by time across people, so the normal equations
//! are banded; the band is about four times the number of people wide.
//!
//! A similarity may also scale. So similarities are made rotations, and a few more rounds, with the same factor and
//! another right side, look for the change of the rotations that closes the gap that this has opened. At last the
//! rotations stay and the positions are solved for alone (as-rigid edge lengths): what gap remains is spread over
//! moving edges.
//!
//! Time is a second problem of the same form on the same nodes, sum (t_(i+1) - t_i - 1)^2: people in contact share
//! their clock.

use super::Limits;
use super::band::Complex;
use super::strand::{STANDING_EDGE, compliance};
use super::system::{Pinned, Row, System};
use crate::geom::Ground;
use crate::motion::{FPS, MotionPath};
use crate::patch::PatchKind;

/// Weight of the edges against that of the similarities' changes, per square metre.
const EDGE_WEIGHT: f64 = 1000.0;
/// Rounds that look for better rotations.
const RIGID_ROUNDS: usize = 2;
/// Two handles on people in contact must agree this well, metres and radians.
const AGREEMENT: f64 = 1e-3;

/// A frame of a person that is held at a place and heading, and perhaps at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handle {
    /// Index of the fragment.
    pub role: usize,
    /// Frame of the fragment.
    pub frame: usize,
    /// Where it is to be.
    pub at: Ground,
    /// When, in ticks of the patch's clock (30 a second); `None` leaves the time free.
    pub tick: Option<f32>,
}

/// A deformed web.
#[derive(Clone, Debug, PartialEq)]
pub struct Deformed {
    /// A path per role, one sample per source frame.
    pub paths: Vec<MotionPath>,
    /// The time of each frame of each role, in ticks of the patch's clock; not whole.
    pub ticks: Vec<Vec<f32>>,
}

/// Where a frame of a role hangs: its node, and its place seen from the node as captured.
#[derive(Clone, Copy, Debug)]
struct Spot {
    node: usize,
    offset: Complex,
}

/// The motion paths of a patch with their contacts, ready to be deformed.
#[derive(Clone, Debug)]
pub struct Web {
    /// As captured.
    paths: Vec<MotionPath>,
    begins: Vec<usize>,
    spots: Vec<Vec<Spot>>,
    /// Roles of one component have the same number.
    components: Vec<usize>,
    space: System,
    time: System,
}

/// A web with a choice of handles: the factors that all deformations with these handles share.
#[derive(Clone, Debug)]
pub struct Hold<'a> {
    web: &'a Web,
    handles: Vec<(usize, usize)>,
    space: Pinned,
    /// The same with all rotations pinned.
    rigid: Pinned,
    /// Factored for the handles that have a tick.
    timed: Vec<bool>,
    time: Pinned,
}

impl Web {
    /// Prepares the paths, contacts and core of `kind`. O(total frames).
    pub fn new(kind: &PatchKind) -> Self {
        let paths: Vec<MotionPath> = kind.fragments.iter().map(|f| f.motion.path.clone()).collect();
        let begins: Vec<usize> = kind.fragments.iter().map(|f| f.begin as usize).collect();
        let (spots, nodes, components) = nodes(kind);
        let mut web = Self {
            space: System { size: 2 * nodes, rows: vec![] },
            time: System { size: nodes, rows: vec![] },
            paths,
            begins,
            spots,
            components,
        };
        let minus = Complex::real(-1.0);
        for (role, i, edge) in web.edges() {
            let (a, b) = (web.spots[role][i], web.spots[role][i + 1]);
            let half = edge.scale(0.5);
            let terms = vec![
                (2 * a.node, minus),
                (2 * a.node + 1, -a.offset - half),
                (2 * b.node, Complex::ONE),
                (2 * b.node + 1, b.offset - half),
            ];
            let stiffness = 1.0 / compliance(edge.abs() as f32) as f64;
            web.space.rows.push(Row { terms, weight: EDGE_WEIGHT * stiffness });
            let terms = vec![(2 * a.node + 1, minus), (2 * b.node + 1, Complex::ONE)];
            web.space.rows.push(Row { terms, weight: stiffness });
            web.time.rows.push(Row { terms: vec![(a.node, minus), (b.node, Complex::ONE)], weight: 1.0 });
        }
        web
    }

    /// All edges as captured: role, first frame, edge.
    fn edges(&self) -> Vec<(usize, usize, Complex)> {
        let of = |(role, path): (usize, &MotionPath)| {
            let edges = path.points.windows(2).enumerate();
            edges.map(|(i, p)| (role, i, Complex::from(p[1]) - Complex::from(p[0]))).collect::<Vec<_>>()
        };
        self.paths.iter().enumerate().flat_map(of).collect()
    }

    /// Factors the problem for handles at these roles and frames, those flagged with their time. `None` if people
    /// would be held nowhere, or a handle lies outside the patch. O(frames x people^3).
    pub fn hold(&self, handles: &[(usize, usize)], timed: &[bool]) -> Option<Hold<'_>> {
        let exists = |&(role, frame): &(usize, usize)| self.spots.get(role).is_some_and(|s| frame < s.len());
        if timed.len() != handles.len() || !handles.iter().all(exists) {
            return None;
        }
        let mut space = vec![false; self.space.size];
        let mut time = vec![false; self.time.size];
        for (&(role, frame), &timed) in handles.iter().zip(timed) {
            let node = self.spots[role][frame].node;
            space[2 * node] = true;
            space[2 * node + 1] = true;
            time[node] |= timed;
        }
        for component in self.free_clocks(handles, timed) {
            time[self.spots[component][0].node] = true;
        }
        let rigid = space.iter().enumerate().map(|(i, &pin)| pin || i % 2 == 1).collect();
        Some(Hold {
            web: self,
            rigid: self.space.pin(rigid)?,
            handles: handles.to_vec(),
            timed: timed.to_vec(),
            space: self.space.pin(space)?,
            time: self.time.pin(time)?,
        })
    }

    /// The first roles of the components of which no handle is timed: they keep their time.
    fn free_clocks(&self, handles: &[(usize, usize)], timed: &[bool]) -> Vec<usize> {
        let is_timed = |c: usize| handles.iter().zip(timed).any(|(h, &t)| t && self.components[h.0] == c);
        (0..self.paths.len()).filter(|&r| self.components[r] == r && !is_timed(r)).collect()
    }

    /// Deforms the web so that all handles are met. `None` if a limit is broken on any frame, if people would be held
    /// nowhere, or if handles on people in contact contradict each other.
    ///
    /// To deform with the same frames held again and again, keep a [`Hold`].
    pub fn deform(&self, handles: &[Handle], limits: &Limits) -> Option<Deformed> {
        let frames: Vec<(usize, usize)> = handles.iter().map(|h| (h.role, h.frame)).collect();
        let timed: Vec<bool> = handles.iter().map(|h| h.tick.is_some()).collect();
        self.hold(&frames, &timed)?.deform(handles, limits)
    }
}

impl Hold<'_> {
    /// As [`Web::deform`], for handles at the frames that are held, in the same order. O(frames x people^2).
    pub fn deform(&self, handles: &[Handle], limits: &Limits) -> Option<Deformed> {
        let as_held = handles.iter().map(|h| (h.role, h.frame)).eq(self.handles.iter().copied());
        if !as_held || !handles.iter().map(|h| h.tick.is_some()).eq(self.timed.iter().copied()) {
            return None;
        }
        let ticks = self.ticks(handles)?;
        let state = self.place(handles)?;
        let paths = self.lay(&state);
        let fits = self.web.keeps(&paths, &state, limits) && keeps_time(&ticks, limits);
        fits.then_some(Deformed { paths, ticks })
    }

    /// P and S of the nodes that are held, zero elsewhere.
    fn pins(&self, handles: &[Handle]) -> Option<Vec<Complex>> {
        let web = self.web;
        let mut x = vec![Complex::default(); web.space.size];
        let mut set = vec![false; web.time.size];
        for h in handles {
            let spot = web.spots[h.role][h.frame];
            let turn = Complex::unit((h.at.heading - web.paths[h.role].headings[h.frame]) as f64);
            let place = Complex::from(h.at.position) - turn * spot.offset;
            let (was, was_turn) = (x[2 * spot.node], x[2 * spot.node + 1]);
            if set[spot.node] && ((was - place).abs() > AGREEMENT || (was_turn - turn).abs() > AGREEMENT) {
                return None;
            }
            set[spot.node] = true;
            (x[2 * spot.node], x[2 * spot.node + 1]) = (place, turn);
        }
        Some(x)
    }

    /// P and S of all nodes that minimise the energy.
    fn similar(&self, handles: &[Handle]) -> Option<Vec<Complex>> {
        let mut x = self.pins(handles)?;
        let right = vec![Complex::default(); self.web.space.rows.len()];
        self.web.space.solve(&self.space, &right, &mut x);
        Some(x)
    }

    /// P and S of all nodes with S of length one.
    fn place(&self, handles: &[Handle]) -> Option<Vec<Complex>> {
        let space = &self.web.space;
        let mut x = self.similar(handles)?;
        normalize(&mut x)?;
        for _ in 0..RIGID_ROUNDS {
            let right = self.web.rigid_edges(&x);
            let mut change: Vec<Complex> =
                x.iter().enumerate().map(|(i, &x)| if i % 2 == 0 { x } else { Complex::default() }).collect();
            space.solve(&self.space, &right, &mut change);
            for (i, change) in change.into_iter().enumerate() {
                x[i] = if i % 2 == 0 { change } else { x[i] + change };
            }
            normalize(&mut x)?;
        }
        let right = self.web.rigid_edges(&x);
        let mut placed: Vec<Complex> =
            x.iter().enumerate().map(|(i, &x)| if i % 2 == 0 { x } else { Complex::default() }).collect();
        space.solve(&self.rigid, &right, &mut placed);
        placed.iter_mut().zip(x).skip(1).step_by(2).for_each(|(placed, turn)| *placed = turn);
        Some(placed)
    }

    fn lay(&self, x: &[Complex]) -> Vec<MotionPath> {
        let lay = |(spots, captured): (&Vec<Spot>, &MotionPath)| {
            let mut path = MotionPath::default();
            let mut angle = 0.0;
            for (spot, heading) in spots.iter().zip(&captured.headings) {
                let turn = x[2 * spot.node + 1];
                path.points.push((x[2 * spot.node] + turn * spot.offset).into());
                angle += (turn * Complex::unit(-angle)).arg();
                path.headings.push(heading + angle as f32);
            }
            path
        };
        self.web.spots.iter().zip(&self.web.paths).map(lay).collect()
    }

    fn ticks(&self, handles: &[Handle]) -> Option<Vec<Vec<f32>>> {
        let web = self.web;
        let mut t = vec![Complex::default(); web.time.size];
        let mut set = vec![false; web.time.size];
        for (h, tick) in handles.iter().filter_map(|h| Some((h, h.tick?))) {
            let node = web.spots[h.role][h.frame].node;
            if set[node] && (t[node].re - tick as f64).abs() > AGREEMENT {
                return None;
            }
            (t[node], set[node]) = (Complex::real(tick as f64), true);
        }
        for role in web.free_clocks(&self.handles, &self.timed) {
            t[web.spots[role][0].node] = Complex::real(web.begins[role] as f64);
        }
        let right = vec![Complex::ONE; web.time.rows.len()];
        web.time.solve(&self.time, &right, &mut t);
        Some(web.spots.iter().map(|spots| spots.iter().map(|s| t[s.node].re as f32).collect()).collect())
    }
}

impl Web {
    /// Right sides for which the unknown similarities are changes of the rotations of `x`.
    fn rigid_edges(&self, x: &[Complex]) -> Vec<Complex> {
        let turn = |spot: Spot| x[2 * spot.node + 1];
        let edge = |(role, i, edge): (usize, usize, Complex)| {
            let (a, b) = (self.spots[role][i], self.spots[role][i + 1]);
            let mean = (turn(a) + turn(b)).normalized();
            [mean * edge - turn(b) * b.offset + turn(a) * a.offset, Complex::default()]
        };
        self.edges().into_iter().flat_map(edge).collect()
    }

    /// True if stretch, bend and slip stay within the limits on every frame.
    fn keeps(&self, paths: &[MotionPath], x: &[Complex], limits: &Limits) -> bool {
        self.edges().into_iter().all(|(role, i, edge)| {
            let (points, headings) = (&paths[role].points, &paths[role].headings);
            let own = &self.paths[role].headings;
            let bend = (headings[i + 1] - headings[i]) - (own[i + 1] - own[i]);
            let now = Complex::from(points[i + 1] - points[i]);
            let turn = |frame: usize| x[2 * self.spots[role][frame].node + 1];
            let slip = (now * ((turn(i) + turn(i + 1)) * edge).conj()).arg().abs();
            let walks = edge.abs() > STANDING_EDGE as f64;
            bend.abs() <= limits.bend
                && (now.abs() - edge.abs()).abs() <= limits.stretch as f64
                && (!walks || slip <= limits.slip as f64)
        })
    }
}

/// Makes all similarities rotations; `None` if one is too close to zero to have a direction.
fn normalize(x: &mut [Complex]) -> Option<()> {
    x.iter_mut().skip(1).step_by(2).try_for_each(|s| {
        let direction = (s.abs() > 0.2).then(|| s.normalized())?;
        *s = direction;
        Some(())
    })
}

fn keeps_time(ticks: &[Vec<f32>], limits: &Limits) -> bool {
    let most = limits.time * FPS + 1e-4;
    ticks.iter().flat_map(|t| t.windows(2)).all(|w| (w[1] - w[0] - 1.0).abs() <= most)
}

/// The node of every frame of every role, the number of nodes, and the component of every role.
fn nodes(kind: &PatchKind) -> (Vec<Vec<Spot>>, usize, Vec<usize>) {
    let begin = |role: usize| kind.fragments[role].begin as usize;
    let end = |role: usize| begin(role) + kind.fragments[role].motion.len();
    let people = 0..kind.people();
    let point = |role: usize, tick: usize| Complex::from(kind.fragments[role].motion.path.points[tick - begin(role)]);
    let mut spots: Vec<Vec<Spot>> = vec![Vec::new(); kind.people()];
    let mut components: Vec<usize> = people.clone().collect();
    let mut count = 0;
    for tick in 0..people.clone().map(end).max().unwrap_or(0) {
        let here = |role: usize| begin(role) <= tick && tick < end(role);
        let mut leaders: Vec<usize> = people.clone().collect();
        for (a, b) in bonds(kind, tick).into_iter().filter(|&(a, b)| here(a) && here(b)) {
            join(&mut leaders, a, b);
            join(&mut components, a, b);
        }
        let mut numbers = vec![usize::MAX; kind.people()];
        for role in people.clone().filter(|&r| here(r)) {
            let leader = leaders[role];
            if numbers[leader] == usize::MAX {
                numbers[leader] = count;
                count += 1;
            }
            spots[role].push(Spot { node: numbers[leader], offset: point(role, tick) - point(leader, tick) });
        }
    }
    (spots, count, components)
}

/// The pairs of roles whose relative placement must not change at a tick.
fn bonds(kind: &PatchKind, tick: usize) -> Vec<(usize, usize)> {
    let within = |begin: u32, end: u32| begin as usize <= tick && tick <= end as usize;
    let contacts = kind.contacts.iter().filter(|c| within(c.begin, c.end));
    let mut pairs: Vec<(usize, usize)> = contacts.map(|c| (c.a.role as usize, c.b.role as usize)).collect();
    if kind.core.is_some_and(|(begin, end)| within(begin, end)) {
        let present: Vec<usize> = (0..kind.people())
            .filter(|&r| {
                let f = &kind.fragments[r];
                f.begin as usize <= tick && tick < f.begin as usize + f.motion.len()
            })
            .collect();
        pairs.extend(present.windows(2).map(|w| (w[0], w[1])));
    }
    pairs
}

/// Gives the set of `b` the smaller of both leaders, and that of `a` too.
fn join(leaders: &mut [usize], a: usize, b: usize) {
    let (low, high) = (leaders[a].min(leaders[b]), leaders[a].max(leaders[b]));
    leaders.iter_mut().filter(|l| **l == high).for_each(|l| *l = low);
}

#[cfg(test)]
#[path = "web_tests.rs"]
mod tests;
