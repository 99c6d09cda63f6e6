//! Boxes of a composition: which of the clips' boxes are one, how they tie people together, and what becomes of them.

use std::f32::consts::PI;

use glam::{Quat, Vec2, Vec3};

use super::chain::Chain;
use super::clip::Grasp;
use super::solve::{Solved, Tie};
use super::story::{Composition, Moment, Prop, Role, Use, bad};
use crate::Result;
use crate::deform::Bond;
use crate::geom::{Ground, Upright};
use crate::motion::contacts::palm;
use crate::motion::joint::{LEFT_HAND, RIGHT_HAND};
use crate::motion::{FPS, Motion};
use crate::patch::cut_props::{PASS_FRAMES, far_from, lengthen, under};
use crate::patch::prop::{at_palms, settled};
use crate::patch::{PatchKind, PatchProp, PropHold};

/// Where one puts a box down and another takes it up, or both have it in their hands, it may be this much apart, metres.
const APART: f32 = 0.1;

/// A box of a composition: what it is, and who has it from when to when (frames of the role's motion).
pub(super) struct Found {
    pub size: [f32; 3],
    pub grip: [f32; 2],
    /// Who holds it (or sits on it), in order: role, grasp, how they look against the one before.
    pub uses: Vec<(usize, Grasp, f32)>,
    line: usize,
    name: String,
}

/// The boxes of a composition.
///
/// # Errors
/// Nobody has such a box in the hands; a box in the hands of which nothing is said; boxes that differ.
pub(super) fn find(story: &Composition, chains: &[Chain]) -> Result<Vec<Found>> {
    let mut free: Vec<Vec<Option<&Grasp>>> = chains.iter().map(|c| c.grasps.iter().map(Some).collect()).collect();
    let found = story.props.iter().map(|prop| found(prop, story, chains, &mut free)).collect::<Result<Vec<_>>>()?;
    for (role, left) in story.roles.iter().zip(&free) {
        if let Some(grasp) = left.iter().flatten().next() {
            let how = if grasp.sits { "to sit on" } else { "in the hands" };
            let [from, to] = grasp.span.map(|f| f as f32 / FPS);
            let expected = format!("expected one of [[props]] for the box that {} has {how}", role.name);
            return Err(bad(role.line, format!("{expected} from {from:.2} s to {to:.2} s, found none")));
        }
    }
    Ok(found)
}

fn found(prop: &Prop, story: &Composition, chains: &[Chain], free: &mut [Vec<Option<&Grasp>>]) -> Result<Found> {
    let mut uses: Vec<(usize, Grasp, f32)> = Vec::new();
    let sits = prop.held.is_empty();
    for used in prop.held.iter().chain(&prop.sat) {
        let (role, (first, last)) = (used.who.role, chains[used.who.role].span(&used.who));
        let fits = |g: &Grasp| g.sits == sits && g.span[0] < last && first < g.span[1];
        let taken = free[role].iter_mut().find(|g| g.is_some_and(fits)).and_then(Option::take).cloned();
        let dated = used.span.iter().any(Option::is_some) || !used.carried.is_empty();
        let grasp = match taken {
            taken if dated => given(prop, used, chains, taken)?,
            Some(taken) => taken,
            None => {
                let verb = if sits { "sits on" } else { "holds" };
                let name = &story.roles[role].name;
                let problem =
                    format!("expected a clip in which '{}' {verb} a box, found none of {name}", used.who.text);
                return Err(bad(prop.line, format!("prop {}: {problem}; say from when to when", prop.name)));
            }
        };
        uses.push((role, grasp, used.turn));
    }
    let own = &uses[0].1;
    let (size, grip) = (prop.size.unwrap_or(own.size), prop.grip.unwrap_or(own.grip));
    let wanted = Grasp { size, grip, ..own.clone() };
    if let Some((role, other, _)) = uses.iter().find(|u| !u.1.is_like(&wanted)) {
        let found = format!("found one of {:?} m, grip {:?}, at {}", other.size, other.grip, story.roles[*role].name);
        let problem = format!("expected boxes of {size:?} m, grip {grip:?}, {found}");
        return Err(bad(prop.line, format!("prop {}: {problem}", prop.name)));
    }
    Ok(Found { size, grip, uses, line: prop.line, name: prop.name.clone() })
}

/// A hold that the file dates.
fn given(prop: &Prop, used: &Use, chains: &[Chain], taken: Option<Grasp>) -> Result<Grasp> {
    let chain = &chains[used.who.role];
    let (first, last) = chain.span(&used.who);
    let end = |moment: &Option<Moment>, own| moment.as_ref().map_or(Ok(own), |m| chain.frame(m, prop.line));
    let (first, last) = (end(&used.span[0], first)?, end(&used.span[1], last)?);
    let fail = |problem: &str| Err(bad(prop.line, format!("prop {}: '{}': {problem}", prop.name, used.who.text)));
    if first >= last {
        return fail("expected to begin before it ends");
    }
    if taken.is_some() && !used.carried.is_empty() {
        return fail("expected clips of somebody who knows of no box where it is carried, found one in the hands");
    }
    let (size, grip) = match (&taken, prop.size) {
        (Some(own), _) => (own.size, own.grip),
        (None, Some(size)) => (size, prop.grip.unwrap_or_default()),
        (None, None) => return fail("expected the box's size, since no clip says it; found none"),
    };
    let end = chain.motion.len() - 1;
    let seat = taken.as_ref().map_or(0.0, |t| t.seat);
    let whole = [first > 0, last < end];
    Ok(Grasp { sits: prop.held.is_empty(), size, grip, seat, span: [first, last], whole, source: None })
}

/// Where a grasped box is at a frame of a motion, seen from its path, and the height of its middle; on the ground where
/// it nearly is.
fn seen(motion: &Motion, frame: usize, grasp: &Grasp, found: &Found) -> (Ground, f32) {
    if grasp.sits {
        return (Ground::new(Vec2::new(0.0, grasp.seat), 0.0), 0.5 * found.size[1]);
    }
    let mut globals: Vec<(Vec3, Quat)> = Vec::new();
    motion.globals(frame, &mut globals);
    let at = at_palms(palm(&globals, LEFT_HAND), palm(&globals, RIGHT_HAND), found.grip);
    (motion.path.at(frame).inverse().then(at.ground()), settled(at, found.size[1]).middle.y)
}

/// Adds what boxes tie together. Where one rests between two who have it, it becomes a role of its own that stands there.
///
/// # Errors
/// One does not put down, or keep, what the next takes.
pub(super) fn tie(
    story: &Composition,
    chains: Vec<Chain>,
    props: &[Found],
    ties: &mut Vec<Tie>,
) -> Result<(Composition, Vec<Chain>)> {
    let mut knots = Knots { story: story.clone(), chains, ties };
    for (prop, found) in story.props.iter().zip(props) {
        for pair in found.uses.windows(2) {
            let [a, b] = [&pair[0], &pair[1]].map(|(role, grasp, _)| (*role, grasp));
            knots.tie(found, a, b, Ground::new(Vec2::ZERO, pair[1].2), prop.rest)?;
        }
    }
    Ok((knots.story, knots.chains))
}

/// Everybody, boxes at rest among them, and what ties them together.
struct Knots<'a> {
    story: Composition,
    chains: Vec<Chain>,
    ties: &'a mut Vec<Tie>,
}

type Holder<'a> = (usize, &'a Grasp);

impl Knots<'_> {
    /// Ties one who has a box to the next.
    fn tie(&mut self, found: &Found, a: Holder, b: Holder, turn: Ground, rest: f32) -> Result<()> {
        let [giver, taker] = [a, b].map(|(role, _)| self.story.roles[role].name.clone());
        let fail = |problem: String| Err(bad(found.line, format!("prop {}: {problem}", found.name)));
        if !(a.1.whole[1] && b.1.whole[0]) {
            return fail(format!("expected {giver} to let go of it and {taker} to take it within the patch"));
        }
        let put = seen(&self.chains[a.0].motion, a.1.span[1], a.1, found);
        let taken = seen(&self.chains[b.0].motion, b.1.span[0], b.1, found);
        let bonds = match [put.1, taken.1].map(|height| height <= 0.5 * found.size[1]) {
            [true, true] => self.rest(found, (a.0, a.1.span[1], put.0), (b.0, b.1.span[0], turn, taken.0), rest),
            [false, false] if self.are_tied(a.0, b.0) => vec![],
            [false, false] => vec![pass(&self.chains, found, a, b, turn)],
            [down, _] => {
                let [low, high] = if down { [giver, taker] } else { [taker, giver] };
                let found = format!("found it on the ground with {low} and in the hands of {high}");
                return fail(format!("expected both to have it at one height, {found}"));
            }
        };
        let what = format!("prop {}: it cannot go from {giver} to {taker}", found.name);
        self.ties.extend(bonds.into_iter().map(|b| Tie { bonds: vec![b], what: what.clone(), line: found.line }));
        Ok(())
    }

    /// A box that one puts down and another takes up some seconds later, as a role that stands there meanwhile.
    fn rest(
        &mut self,
        found: &Found,
        (a, put, down): (usize, usize, Ground),
        (b, taken, turn, up): (usize, usize, Ground, Ground),
        seconds: f32,
    ) -> Vec<Bond> {
        let (role, frames) = (self.chains.len(), (seconds * FPS).round() as usize + 1);
        self.chains.push(Chain::still(&found.name, frames));
        self.story.roles.push(Role { name: found.name.clone(), plays: vec![], start: None, line: found.line });
        vec![
            Bond { a: (a, put), b: (role, 0), a_from_b: down },
            Bond { a: (role, frames - 1), b: (b, taken), a_from_b: turn.then(up.inverse()) },
        ]
    }

    /// True if a place says how two stand to each other.
    fn are_tied(&self, a: usize, b: usize) -> bool {
        let between = |bond: &Bond| [bond.a.0, bond.b.0] == [a, b] || [bond.b.0, bond.a.0] == [a, b];
        self.ties.iter().flat_map(|tie| &tie.bonds).any(between)
    }
}

/// Both have the box in their hands at one moment and in one place: in the middle of the time that they share.
fn pass(chains: &[Chain], found: &Found, (a, from): Holder, (b, to): Holder, turned: Ground) -> Bond {
    let captured = from.source.zip(to.source).filter(|(given, taken)| given.0 == taken.0);
    let shared = captured.map_or(0, |((_, [_, end]), (_, [begin, _]))| end.saturating_sub(begin));
    let together = if shared > 0 { shared } else { PASS_FRAMES as usize };
    let together = together.min(from.span[1] - from.span[0]).min(to.span[1] - to.span[0]);
    let frames = [from.span[1] - together / 2, to.span[0] + (together - together / 2)];
    let [given, taken] =
        [(a, frames[0], from), (b, frames[1], to)].map(|(r, f, g)| seen(&chains[r].motion, f, g, found).0);
    // Captured together they are as captured.
    let turn = if captured.is_some() { Ground::new(Vec2::ZERO, PI) } else { turned };
    Bond { a: (a, frames[0]), b: (b, frames[1]), a_from_b: given.then(turn).then(taken.inverse()) }
}

/// The boxes of the finished kind.
///
/// # Errors
/// Hands that are not on their box, a sitter who is not; a box that is not where the next takes it.
pub(super) fn of_kind(
    story: &Composition,
    props: &[Found],
    kind: &PatchKind,
    solved: &Solved,
) -> Result<Vec<PatchProp>> {
    props.iter().map(|found| of_kind_one(story, found, kind, solved)).collect()
}

fn of_kind_one(story: &Composition, found: &Found, kind: &PatchKind, solved: &Solved) -> Result<PatchProp> {
    let hold = |(role, g, _): &(usize, Grasp, f32)| PropHold {
        role: *role as u32,
        begin: solved.tick(*role, g.span[0]),
        end: solved.tick(*role, g.span[1]),
    };
    let holds: Vec<PropHold> = found.uses.iter().map(hold).collect();
    let (size, grip, name) = (found.size, found.grip, found.name.clone());
    let prop = PatchProp { name, size, grip, holds: vec![], sat: vec![], before: None, after: None };
    let prop =
        if found.uses[0].1.sits { seated(prop, holds, found, kind) } else { held(prop, holds, found, kind, solved) };
    let name = |role: u32| story.roles[role as usize].name.as_str();
    let problem = prop.problems(kind).into_iter().next();
    let problem = problem.or_else(|| Some(format!("prop {}: {}", found.name, misplaced(&prop, found, kind, name)?)));
    problem.map_or(Ok(prop), |problem| Err(bad(found.line, problem)))
}

/// A box that stands under who sits on it first.
fn seated(prop: PatchProp, sat: Vec<PropHold>, found: &Found, kind: &PatchKind) -> PatchProp {
    let at = Some(seat(&sat[0], &found.uses[0].1, kind));
    PatchProp { sat, before: at, after: at, ..prop }
}

/// Where a box would stand under a sitter.
fn seat(sat: &PropHold, grasp: &Grasp, kind: &PatchKind) -> Upright {
    let fragment = &kind.fragments[sat.role as usize];
    under(fragment.motion.path.at((sat.begin - fragment.begin) as usize), grasp.seat, grasp.size[1])
}

/// A box that people hold; where it rests follows from the hands that take it up and put it down.
fn held(prop: PatchProp, mut holds: Vec<PropHold>, found: &Found, kind: &PatchKind, solved: &Solved) -> PatchProp {
    lengthen(&mut holds, |role| solved.span(role as usize));
    let rest = |hold: PropHold, clock: u32| settled(prop.in_hands(kind, hold.role, clock), prop.size[1]);
    let (a, b) = (holds[0], holds[holds.len() - 1]);
    let before = found.uses[0].1.whole[0].then(|| rest(a, a.begin));
    let after = found.uses[found.uses.len() - 1].1.whole[1].then(|| rest(b, b.end));
    PatchProp { holds, before, after, ..prop }
}

/// What is wrong with where a box of sound times is.
fn misplaced<'a>(prop: &PatchProp, found: &Found, kind: &PatchKind, name: impl Fn(u32) -> &'a str) -> Option<String> {
    for (sat, used) in prop.sat.iter().zip(&found.uses) {
        let away = seat(sat, &used.1, kind).middle.distance(prop.before?.middle);
        if away > APART {
            return Some(format!("expected it under {} where it stands, found it {away:.2} m away", name(sat.role)));
        }
    }
    if let Some(apart) = apart(prop, kind) {
        return Some(format!("expected it where both have it when it changes hands, found {apart:.2} m between"));
    }
    if let Some((role, problem)) = far_from(prop, kind) {
        return Some(format!("{}: {problem}", name(role)));
    }
    let ends = [(prop.before, prop.holds.first(), "take it up"), (prop.after, prop.holds.last(), "put it down")];
    ends.into_iter().find_map(|(rest, hold, verb)| {
        let above = rest?.middle.y - 0.5 * prop.size[1];
        let name = name(hold?.role);
        (above > 0.0).then(|| format!("expected {name} to {verb} on the ground, found it {above:.2} m above"))
    })
}

/// How far apart two who pass a box, or who take it up where it was put down, have it; `None` if near enough.
fn apart(prop: &PatchProp, kind: &PatchKind) -> Option<f32> {
    let between = |pair: &[PropHold]| {
        let (a, b) = (pair[0], pair[1]);
        let at = |hold: PropHold, clock: u32| -> Upright { prop.in_hands(kind, hold.role, clock) };
        let [from, to] = if b.begin <= a.end {
            let middle = b.begin.midpoint(a.end);
            [at(a, middle), at(b, middle)]
        } else {
            [settled(at(a, a.end), prop.size[1]), settled(at(b, b.begin), prop.size[1])]
        };
        from.middle.distance(to.middle)
    };
    prop.holds.windows(2).map(between).find(|&d| d > APART)
}
