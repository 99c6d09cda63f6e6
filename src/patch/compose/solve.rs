//! Where and when everybody is: placed rigidly as far as that goes, and what must still hold bends paths and times, by
//! least squares over everybody at once.

use super::chain::Chain;
use super::story::{Composition, Moment, Place, bad};
use crate::deform::{Bond, Deformed, Handle, Limits, Thread, Web};
use crate::geom::Ground;
use crate::motion::{FPS, MotionPath};
use crate::{Error, Result};

/// A time this near to a whole frame is one, frames.
const WHOLE: f32 = 1e-3;

/// Everybody's deformed path, and the patch's clock at each of its frames; whole at both ends and wherever something
/// holds.
#[derive(Clone, Debug)]
pub(super) struct Solved {
    pub paths: Vec<MotionPath>,
    pub ticks: Vec<Vec<f32>>,
}

impl Solved {
    /// The frame of the patch's clock that shows a frame of a role.
    pub fn tick(&self, role: usize, frame: usize) -> u32 {
        self.ticks[role][frame].round() as u32
    }

    /// The first and last frame of a role on the patch's clock.
    pub fn span(&self, role: usize) -> (u32, u32) {
        (self.tick(role, 0), self.tick(role, self.ticks[role].len() - 1))
    }
}

/// What ties two people together at a moment, or over a time.
pub(super) struct Tie {
    pub bonds: Vec<Bond>,
    /// What it demands, for messages: `'bob' cannot be there`.
    pub what: String,
    pub line: usize,
}

/// What the places of a composition tie together.
///
/// # Errors
/// Moments that do not exist.
pub(super) fn ties(story: &Composition, chains: &[Chain]) -> Result<Vec<Tie>> {
    let tie = |place: &Place| {
        let what = format!("'{}' cannot be there seen from '{}'", place.who.text, place.seen_from.text);
        Ok(Tie { bonds: bonds(place, chains)?, what, line: place.line })
    };
    story.places.iter().map(tie).collect()
}

/// Solves a composition, whose people are tied together by `ties`.
///
/// # Errors
/// Somebody of whom nothing says where they are; ties that contradict each other or cannot hold within the limits: the
/// first with which they no longer do.
pub(super) fn solve(story: &Composition, chains: &[Chain], ties: &[Tie]) -> Result<Solved> {
    let bonds: Vec<Vec<Bond>> = ties.iter().map(|tie| tie.bonds.clone()).collect();
    let threads = lay(story, chains, &bonds)?;
    let mut solved = attempt(story, &threads, &bonds).map_err(|whole| {
        // Which one is it that cannot hold?
        let failed = (1..bonds.len()).find_map(|n| attempt(story, &threads, &bonds[..n]).err().map(|f| (n - 1, f)));
        let (index, failure) = failed.unwrap_or((bonds.len().saturating_sub(1), whole));
        failure.told(story, chains, ties.get(index))
    })?;
    let first = solved.ticks.iter().map(|t| t[0]).fold(f32::INFINITY, f32::min).round();
    solved.ticks.iter_mut().flatten().for_each(|t| *t -= first);
    Ok(Solved { paths: solved.paths, ticks: solved.ticks })
}

/// The roles and frames at which anything holds: the ends of all ties and touches.
pub(super) fn held(story: &Composition, chains: &[Chain], ties: &[Tie]) -> Vec<(usize, usize)> {
    let ends = |b: &Vec<Bond>| [b[0].a, b[0].b, b[b.len() - 1].a, b[b.len() - 1].b];
    let mut held: Vec<(usize, usize)> = ties.iter().flat_map(|tie| ends(&tie.bonds)).collect();
    let moments = story.touches.iter().flat_map(|t| [(&t.from, t.line), (&t.to, t.line)]);
    held.extend(moments.filter_map(|(m, line)| Some((m.role, chains[m.role].frame(m, line).ok()?))));
    held
}

/// The bonds of a place: of its moment, or of every frame of its clips.
fn bonds(place: &Place, chains: &[Chain]) -> Result<Vec<Bond>> {
    let (a, b) = (&place.seen_from, &place.who);
    let ends = |m: &Moment| Ok::<_, Error>((chains[m.role].frame(m, place.line)?, chains[m.role].span(m).1));
    let ((first_a, last_a), (first_b, last_b)) = (ends(a)?, ends(b)?);
    let first_a = first_a + (place.delay * FPS).round() as usize;
    if first_a > last_a {
        return Err(bad(place.line, format!("expected a delay shorter than '{}'", a.text)));
    }
    let frames = if a.seconds.is_some() { 0 } else { (last_a - first_a).min(last_b - first_b) };
    let (path_a, path_b) = (&chains[a.role].motion.path, &chains[b.role].motion.path);
    // Both go on as captured from where they stand at first.
    let bond = |k: usize| Bond {
        a: (a.role, first_a + k),
        b: (b.role, first_b + k),
        a_from_b: since(path_a, first_a, k).inverse().then(place.at).then(since(path_b, first_b, k)),
    };
    Ok((0..=frames).map(bond).collect())
}

/// Where a path is `frames` after a frame, seen from there.
fn since(path: &MotionPath, frame: usize, frames: usize) -> Ground {
    path.at(frame).inverse().then(path.at(frame + frames))
}

/// Everybody laid out rigidly: those with a start there, others by the first place that ties them to somebody laid out.
fn lay(story: &Composition, chains: &[Chain], bonds: &[Vec<Bond>]) -> Result<Vec<Thread>> {
    let mut laid: Vec<Option<(Ground, i64)>> = vec![None; chains.len()];
    let starts = story.roles.iter().map(|r| r.start);
    for (own, (at, time)) in laid.iter_mut().zip(starts).filter_map(|(own, start)| Some((own, start?))) {
        *own = Some((at, (time.unwrap_or(0.0) * FPS).round() as i64));
    }
    if laid.iter().all(Option::is_none) {
        laid[0] = Some((Ground::IDENTITY, 0));
    }
    while let Some((role, start)) = next_laid(chains, bonds, &laid) {
        laid[role] = Some(start);
    }
    if let Some(role) = laid.iter().position(Option::is_none) {
        let role = &story.roles[role];
        let problem = format!("role {}: expected a start, or a place that ties it to others, found neither", role.name);
        return Err(bad(role.line, problem));
    }
    let laid: Vec<(Ground, i64)> = laid.into_iter().flatten().collect();
    let first = laid.iter().map(|l| l.1).min().unwrap_or(0);
    let thread = |(chain, (start, begin)): (&Chain, (Ground, i64))| {
        let path = &chain.motion.path;
        let points = path.points.iter().map(|&p| start.apply(p)).collect();
        let headings = path.headings.iter().map(|h| h + start.heading).collect();
        Thread { path: MotionPath { points, headings }, begin: (begin - first) as usize }
    };
    Ok(chains.iter().zip(laid).map(thread).collect())
}

/// Somebody who is tied to somebody laid out, and where and when they begin.
fn next_laid(chains: &[Chain], bonds: &[Vec<Bond>], laid: &[Option<(Ground, i64)>]) -> Option<(usize, (Ground, i64))> {
    let at = |(role, frame): (usize, usize)| chains[role].motion.path.at(frame);
    let tied = |bond: Bond| match (laid[bond.a.0], laid[bond.b.0]) {
        (Some((a, begin)), None) => {
            let there = a.then(at(bond.a)).then(bond.a_from_b).then(at(bond.b).inverse());
            Some((bond.b.0, (there, begin + bond.a.1 as i64 - bond.b.1 as i64)))
        }
        (None, Some((b, begin))) => {
            let there = b.then(at(bond.b)).then(bond.a_from_b.inverse()).then(at(bond.a).inverse());
            Some((bond.a.0, (there, begin + bond.b.1 as i64 - bond.a.1 as i64)))
        }
        _ => None,
    };
    bonds.iter().find_map(|all| tied(all[0]))
}

/// Why a composition does not work out.
enum Failure {
    /// A place contradicts others.
    Contradiction,
    /// What else holds leaves no way to it at all.
    TooFar,
    /// A limit is broken.
    Broken(crate::deform::Broken),
}

impl Failure {
    fn told(self, story: &Composition, chains: &[Chain], tie: Option<&Tie>) -> Error {
        let Some(Tie { what, line, .. }) = tie else {
            return bad(1, "expected people who can be where they start".into());
        };
        let line = *line;
        match self {
            Self::Contradiction => bad(line, format!("{what}: it contradicts what was said before")),
            Self::TooFar => bad(line, format!("{what}: that is too far from what else holds")),
            Self::Broken(b) => {
                let (name, when) = (&story.roles[b.at.role].name, chains[b.at.role].name(b.at.frame));
                let found = format!("{:.3} {} per frame", b.found, b.unit);
                let limit = format!("(limit {:.3} {})", b.limit, b.unit);
                bad(line, format!("{what}: {name} would have to {} by {found} {limit} at {when}", b.measure))
            }
        }
    }
}

/// Everybody, deformed so that all starts and bonds hold.
fn attempt(story: &Composition, threads: &[Thread], bonds: &[Vec<Bond>]) -> std::result::Result<Deformed, Failure> {
    let all: Vec<Bond> = bonds.iter().flatten().copied().collect();
    let web = Web::new(threads.to_vec(), &all).map_err(|_| Failure::Contradiction)?;
    let mut handles = anchors(story, threads, bonds);
    let deform = |handles: &[Handle]| web.hold(handles).and_then(|hold| hold.solve(handles));
    let mut deformed = deform(&handles).ok_or(Failure::TooFar)?;
    let ends = threads.iter().enumerate().flat_map(|(role, t)| [(role, 0), (role, t.path.len() - 1)]);
    let met = bonds.iter().flat_map(|b| [b[0].a, b[b.len() - 1].a]);
    let uneven = |&(role, frame): &(usize, usize)| {
        let tick = deformed.ticks[role][frame];
        (tick - tick.round()).abs() > WHOLE
    };
    let marks: Vec<(usize, usize)> = ends.chain(met).collect();
    if marks.iter().any(uneven) {
        // Fragments begin, end and meet on whole frames.
        handles.iter_mut().for_each(|h| h.tick = None);
        let whole = |(role, frame): (usize, usize)| {
            let tick = Some(deformed.ticks[role][frame].round());
            Handle { role, frame, at: None, tick }
        };
        handles.extend(marks.into_iter().map(whole));
        deformed = deform(&handles).ok_or(Failure::TooFar)?;
    }
    match web.strain(&deformed).broken(&limits(story)) {
        Some(broken) => Err(Failure::Broken(broken)),
        None => Ok(deformed),
    }
}

/// Nothing may come out beyond the limits by rounding in single precision.
fn limits(story: &Composition) -> Limits {
    let Limits { stretch, bend, time, slip } = story.limits;
    Limits { stretch: stretch + 1e-5, bend: bend + 1e-5, time, slip: slip + 1e-4 }
}

/// What holds everybody somewhere: starts, and of those tied together without one, the first.
fn anchors(story: &Composition, threads: &[Thread], bonds: &[Vec<Bond>]) -> Vec<Handle> {
    let mut group: Vec<usize> = (0..threads.len()).collect();
    for bond in bonds.iter().map(|b| b[0]) {
        let (a, b) = (group[bond.a.0], group[bond.b.0]);
        group.iter_mut().filter(|g| **g == a.max(b)).for_each(|g| *g = a.min(b));
    }
    let begins = |role: usize| Some(threads[role].begin as f32);
    let mut handles: Vec<Handle> = Vec::new();
    for (role, start) in story.roles.iter().enumerate().filter_map(|(i, r)| Some((i, r.start?))) {
        handles.push(Handle { role, frame: 0, at: Some(threads[role].path.at(0)), tick: start.1.and(begins(role)) });
    }
    let is_held = |g: usize, handles: &[Handle]| handles.iter().any(|h| group[h.role] == g);
    for role in 0..threads.len() {
        if group[role] == role && !is_held(role, &handles) {
            handles.push(Handle { role, frame: 0, at: Some(threads[role].path.at(0)), tick: begins(role) });
        }
    }
    handles
}
