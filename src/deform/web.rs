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
//! Bonds fix the relative placement of two frames of two people: p_b - p_a = s_a d and s_b = s_a r. These constraints are
//! not weighted rows but are eliminated: frames that are bonded are one rigid node (P, S) with p = P + S d and s = S r.
//! That is exact, leaves fewer unknowns, and the matrix keeps the energy's condition, where heavy weights would cost
//! digits. Nodes are ordered by time across people, so the normal equations are banded; the band is about four times the
//! number of people wide where people are bonded at like times.
//!
//! A similarity may also scale. So similarities are made rotations, and a few more rounds, with the same factor and
//! another right side, look for the change of the rotations that closes the gap that this has opened. At last the
//! rotations stay and the positions are solved for alone (as-rigid edge lengths): what gap remains is spread over
//! moving edges.
//!
//! Time is a second problem of the same form on the same nodes, sum (t_(i+1) - t_i - 1)^2: bonded frames are one moment.

use super::Limits;
use super::band::Complex;
use super::nodes::{Spot, nodes};
use super::strain::Strain;
use super::strand::compliance;
use super::system::{Pinned, Row, System};
use crate::geom::Ground;
use crate::motion::MotionPath;

/// Weight of the edges against that of the similarities' changes, per square metre.
const EDGE_WEIGHT: f64 = 1000.0;
/// Rounds that look for better rotations.
const RIGID_ROUNDS: usize = 2;
/// Two handles on one node must agree this well, metres and radians; so must bonds that close a ring.
pub(super) const AGREEMENT: f64 = 1e-3;

/// One person's path in a web.
#[derive(Clone, Debug, PartialEq)]
pub struct Thread {
    /// As captured, or as placed by hand.
    pub path: MotionPath,
    /// Tick of the web's clock (30 a second) at which its first frame comes, if nothing else says when.
    pub begin: usize,
}

/// Two frames that are to be one moment, and how the second person is to stand seen from the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bond {
    /// Index of a thread, and a frame of it.
    pub a: (usize, usize),
    /// Another's.
    pub b: (usize, usize),
    /// Place and heading of b in the frame of a.
    pub a_from_b: Ground,
}

/// A frame of a thread that is held in place and heading, in time, or in both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handle {
    /// Index of the thread.
    pub role: usize,
    /// Frame of the thread.
    pub frame: usize,
    /// Where it is to be; `None` leaves the place free.
    pub at: Option<Ground>,
    /// When, in ticks of the web's clock; `None` leaves the time free.
    pub tick: Option<f32>,
}

/// A deformed web.
#[derive(Clone, Debug, PartialEq)]
pub struct Deformed {
    /// A path per thread, one sample per source frame.
    pub paths: Vec<MotionPath>,
    /// The time of each frame of each thread, in ticks of the web's clock; not whole.
    pub ticks: Vec<Vec<f32>>,
}

/// Motion paths and their bonds, ready to be deformed.
#[derive(Clone, Debug)]
pub struct Web {
    pub(super) threads: Vec<Thread>,
    pub(super) spots: Vec<Vec<Spot>>,
    /// Threads of one component have the same number.
    components: Vec<usize>,
    space: System,
    time: System,
}

/// A web with a choice of handles: the factors that all deformations with these handles share.
#[derive(Clone, Debug)]
pub struct Hold<'a> {
    web: &'a Web,
    handles: Vec<Pattern>,
    space: Pinned,
    /// The same with all rotations pinned.
    rigid: Pinned,
    time: Pinned,
}

/// What a handle holds: thread, frame, whether its place, whether its time.
type Pattern = (usize, usize, bool, bool);

fn pattern(handle: &Handle) -> Pattern {
    (handle.role, handle.frame, handle.at.is_some(), handle.tick.is_some())
}

impl Web {
    /// Ties threads together. O(total frames).
    ///
    /// # Errors
    /// The index of the first bond that contradicts those before it, or that names a frame that does not exist.
    pub fn new(threads: Vec<Thread>, bonds: &[Bond]) -> Result<Self, usize> {
        let (spots, nodes, components) = nodes(&threads, bonds)?;
        let mut web = Self {
            space: System { size: 2 * nodes, rows: vec![] },
            time: System { size: nodes, rows: vec![] },
            threads,
            spots,
            components,
        };
        let minus = Complex::real(-1.0);
        for (role, i, edge) in web.edges() {
            let (a, b) = (web.spots[role][i], web.spots[role][i + 1]);
            let half = edge.scale(0.5);
            let terms = vec![
                (2 * a.node, minus),
                (2 * a.node + 1, -a.offset - half * a.turn),
                (2 * b.node, Complex::ONE),
                (2 * b.node + 1, b.offset - half * b.turn),
            ];
            let stiffness = 1.0 / compliance(edge.abs() as f32) as f64;
            web.space.rows.push(Row { terms, weight: EDGE_WEIGHT * stiffness });
            let terms = vec![(2 * a.node + 1, -a.turn), (2 * b.node + 1, b.turn)];
            web.space.rows.push(Row { terms, weight: stiffness });
            web.time.rows.push(Row { terms: vec![(a.node, minus), (b.node, Complex::ONE)], weight: 1.0 });
        }
        Ok(web)
    }

    /// All edges as captured: thread, first frame, edge.
    fn edges(&self) -> Vec<(usize, usize, Complex)> {
        let of = |(role, thread): (usize, &Thread)| {
            let edges = thread.path.points.windows(2).enumerate();
            edges.map(|(i, p)| (role, i, Complex::from(p[1]) - Complex::from(p[0]))).collect::<Vec<_>>()
        };
        self.threads.iter().enumerate().flat_map(of).collect()
    }

    /// Factors the problem for handles that hold what these do. `None` if people would be held nowhere, or a handle
    /// lies outside the web. O(frames x people^3).
    pub fn hold(&self, handles: &[Handle]) -> Option<Hold<'_>> {
        if !handles.iter().all(|h| self.spots.get(h.role).is_some_and(|s| h.frame < s.len())) {
            return None;
        }
        let mut space = vec![false; self.space.size];
        let mut time = vec![false; self.time.size];
        for h in handles {
            let node = self.spots[h.role][h.frame].node;
            space[2 * node] |= h.at.is_some();
            space[2 * node + 1] |= h.at.is_some();
            time[node] |= h.tick.is_some();
        }
        let handles: Vec<Pattern> = handles.iter().map(pattern).collect();
        for component in self.free_clocks(&handles) {
            time[self.spots[component][0].node] = true;
        }
        let rigid = space.iter().enumerate().map(|(i, &pin)| pin || i % 2 == 1).collect();
        Some(Hold {
            web: self,
            rigid: self.space.pin(rigid)?,
            handles,
            space: self.space.pin(space)?,
            time: self.time.pin(time)?,
        })
    }

    /// The first threads of the components of which no handle is timed: they keep their time.
    fn free_clocks(&self, handles: &[Pattern]) -> Vec<usize> {
        let is_timed = |c: usize| handles.iter().any(|h| h.3 && self.components[h.0] == c);
        (0..self.threads.len()).filter(|&r| self.components[r] == r && !is_timed(r)).collect()
    }

    /// Deforms the web so that all handles are met. `None` if a limit is broken on any frame, if people would be held
    /// nowhere, or if handles on people in contact contradict each other.
    ///
    /// To deform with the same frames held again and again, keep a [`Hold`].
    pub fn deform(&self, handles: &[Handle], limits: &Limits) -> Option<Deformed> {
        self.hold(handles)?.deform(handles, limits)
    }

    /// What a deformation asks of the threads.
    pub fn strain(&self, deformed: &Deformed) -> Strain {
        Strain::of(&self.threads, deformed)
    }
}

impl Hold<'_> {
    /// As [`Web::deform`], for handles that hold what is held, in the same order. O(frames x people^2).
    pub fn deform(&self, handles: &[Handle], limits: &Limits) -> Option<Deformed> {
        let deformed = self.solve(handles)?;
        self.web.strain(&deformed).broken(limits).is_none().then_some(deformed)
    }

    /// As [`deform`](Self::deform), however far the threads must be deformed.
    pub fn solve(&self, handles: &[Handle]) -> Option<Deformed> {
        if !handles.iter().map(pattern).eq(self.handles.iter().copied()) {
            return None;
        }
        let ticks = self.ticks(handles)?;
        let state = self.place(handles)?;
        Some(Deformed { paths: self.lay(&state), ticks })
    }

    /// P and S of the nodes that are held, zero elsewhere.
    fn pins(&self, handles: &[Handle]) -> Option<Vec<Complex>> {
        let web = self.web;
        let mut x = vec![Complex::default(); web.space.size];
        let mut set = vec![false; web.time.size];
        for (h, at) in handles.iter().filter_map(|h| Some((h, h.at?))) {
            let spot = web.spots[h.role][h.frame];
            let own = Complex::unit((at.heading - web.threads[h.role].path.headings[h.frame]) as f64);
            let turn = own * spot.turn.conj();
            let place = Complex::from(at.position) - turn * spot.offset;
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
        let lay = |(spots, thread): (&Vec<Spot>, &Thread)| {
            let mut path = MotionPath::default();
            let mut angle = 0.0;
            for (spot, heading) in spots.iter().zip(&thread.path.headings) {
                let turn = x[2 * spot.node + 1];
                path.points.push((x[2 * spot.node] + turn * spot.offset).into());
                angle += (turn * spot.turn * Complex::unit(-angle)).arg();
                path.headings.push(heading + angle as f32);
            }
            path
        };
        self.web.spots.iter().zip(&self.web.threads).map(lay).collect()
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
        for role in web.free_clocks(&self.handles) {
            t[web.spots[role][0].node] = Complex::real(web.threads[role].begin as f64);
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
            let mean = (turn(a) * a.turn + turn(b) * b.turn).normalized();
            [mean * edge - turn(b) * b.offset + turn(a) * a.offset, Complex::default()]
        };
        self.edges().into_iter().flat_map(edge).collect()
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

#[cfg(test)]
#[path = "web_tests.rs"]
mod tests;
