//! Boxes that the people of a patch hold in both hands or sit on: who does when, and where a box rests otherwise.
//!
//! A box stays level; its place follows from the palms of who holds it. A fragment may enter or leave with a box in its
//! hands: a port's state, which all ports of one pose group share, so that fragments stitch without a word about boxes.

use glam::{Quat, Vec3};

use super::{PatchKind, PatchSet};
use crate::geom::Upright;
use crate::motion::contacts::palm;
use crate::motion::joint::{LEFT_HAND, RIGHT_HAND};

/// Boxes at ports of one pose group may differ by this much, metres.
const ALIKE: f32 = 0.005;
/// Longest edge of a box, metres.
const LARGEST: f32 = 3.0;

/// A box of a patch.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PatchProp {
    /// Name, e.g. `box`.
    pub name: String,
    /// Full extents in metres: width between the hands, height, depth.
    pub size: [f32; 3],
    /// Where the box's middle is, seen from the middle between the palms: up, and ahead of the person. Metres.
    pub grip: [f32; 2],
    /// Who holds it when, in order; nobody, if it is only sat on. Where two holds overlap the box is passed and both hold
    /// it; between two that do not it rests where the first put it down.
    pub holds: Vec<PropHold>,
    /// Who sits on it when, while it rests; in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sat: Vec<PropHold>,
    /// Where it rests, in the patch's frame, until the first takes it up; none if the first brings it along.
    pub before: Option<Upright>,
    /// Where it rests after the last put it down; none if the last takes it along.
    pub after: Option<Upright>,
}

/// A time over which a person of a patch holds a box between the palms, or sits on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct PropHold {
    /// Index of the fragment.
    pub role: u32,
    /// First frame on the patch's clock.
    pub begin: u32,
    /// Last frame, inclusive.
    pub end: u32,
}

impl PatchProp {
    /// The place of the box between two palms.
    pub fn between(&self, left: Vec3, right: Vec3) -> Upright {
        at_palms(left, right, self.grip)
    }

    /// The place of the box in the patch's frame at a frame of the clock, as captured; `None` if nobody of the patch has
    /// or will have it in the hands at that time.
    pub fn place(&self, kind: &PatchKind, clock: u32) -> Option<Upright> {
        if let Some(hold) = self.holds.iter().find(|h| h.begin <= clock && clock <= h.end) {
            return Some(self.in_hands(kind, hold.role, clock));
        }
        match self.holds.iter().rposition(|h| h.end < clock) {
            None => self.before.or(self.after.filter(|_| self.holds.is_empty())),
            Some(last) if last + 1 == self.holds.len() => self.after,
            Some(k) => Some(settled(self.in_hands(kind, self.holds[k].role, self.holds[k].end), self.size[1])),
        }
    }

    /// Where a role's palms have the box at a frame of the clock.
    pub(super) fn in_hands(&self, kind: &PatchKind, role: u32, clock: u32) -> Upright {
        let [left, right] = palms(kind, role, clock);
        self.between(left, right)
    }

    /// The roles, and frames of the clock at which they show it, whose motion says where it rests before and after.
    pub(crate) fn anchors(&self) -> [Option<(u32, u32)>; 2] {
        let seat = self.sat.first().map(|s| (s.role, s.begin));
        let (first, last) = (self.holds.first(), self.holds.last());
        [first.map(|h| (h.role, h.begin)).or(seat), last.map(|h| (h.role, h.end)).or(seat)]
    }

    /// What is wrong with the prop itself.
    pub(super) fn problems(&self, kind: &PatchKind) -> Vec<String> {
        let mut problems = Vec::new();
        let mut bad = |problem: String| problems.push(format!("prop {}: {problem}", self.name));
        let sound = self.size.iter().all(|&s| s > 0.0 && s <= LARGEST)
            && self.grip.iter().all(|g| g.abs() <= LARGEST)
            && [self.before, self.after].iter().flatten().all(|r| r.middle.is_finite() && r.heading.is_finite());
        if !sound {
            bad(format!("expected extents above 0 and up to {LARGEST} m, and finite places"));
        }
        let span = |h: &PropHold| {
            let fragment = kind.fragments.get(h.role as usize)?;
            let last = (fragment.motion.len() as u32).checked_sub(1)?.checked_add(fragment.begin)?;
            (fragment.begin <= h.begin && h.begin <= h.end && h.end <= last).then_some((fragment.begin, last))
        };
        for (h, what) in self.uses().filter(|(h, _)| span(h).is_none()) {
            bad(format!("role {} {what} it from frame {} to {}, outside its fragment", h.role, h.begin, h.end));
        }
        let held = |s: &&PropHold| self.holds.iter().any(|h| h.begin <= s.end && s.begin <= h.end);
        for s in self.sat.iter().filter(held) {
            bad(format!("role {} sits on it while it is in somebody's hands", s.role));
        }
        let (Some(first), Some(last)) = (self.holds.first(), self.holds.last()) else {
            if self.sat.is_empty() {
                bad("expected somebody to hold it or to sit on it, found nobody".into());
            } else if self.before.is_none() || self.before != self.after {
                bad("nobody moves it: expected it to rest in one place".into());
            }
            return problems;
        };
        let ordered = |a: &PropHold, b: &PropHold| a.begin < b.begin && a.end < b.end;
        let passed_on = |a: &PropHold, b: &PropHold| a.role != b.role || a.end < b.begin;
        for w in self.holds.windows(2).filter(|w| !passed_on(&w[0], &w[1]) || !ordered(&w[0], &w[1])) {
            bad(format!("role {} does not take it over from role {} in time", w[1].role, w[0].role));
        }
        if self.holds.windows(3).any(|w| w[2].begin <= w[0].end) {
            bad("three people hold it at once".into());
        }
        if span(first).is_some_and(|s| (s.0 == first.begin) == self.before.is_some()) {
            bad(format!("role {} neither brings it along nor takes it up", first.role));
        }
        if span(last).is_some_and(|s| (s.1 == last.end) == self.after.is_some()) {
            bad(format!("role {} neither takes it along nor puts it down", last.role));
        }
        problems
    }
}

impl PatchProp {
    /// Who holds it or sits on it, and which of both in words.
    fn uses(&self) -> impl Iterator<Item = (&PropHold, &'static str)> {
        self.holds.iter().map(|h| (h, "holds")).chain(self.sat.iter().map(|s| (s, "sits on")))
    }
}

/// The place of a box between two palms: level, its width from the right palm to the left one.
pub(crate) fn at_palms(left: Vec3, right: Vec3, [up, ahead]: [f32; 2]) -> Upright {
    let across = left - right;
    let heading = (-across.z).atan2(across.x);
    let forward = Vec3::new(heading.sin(), 0.0, heading.cos());
    Upright { middle: (left + right) * 0.5 + Vec3::Y * up + forward * ahead, heading }
}

/// The middles of a role's palms, left and right, at a frame of the clock.
pub(super) fn palms(kind: &PatchKind, role: u32, clock: u32) -> [Vec3; 2] {
    let fragment = &kind.fragments[role as usize];
    let mut globals: Vec<(Vec3, Quat)> = Vec::new();
    fragment.motion.globals((clock - fragment.begin) as usize, &mut globals);
    [palm(&globals, LEFT_HAND), palm(&globals, RIGHT_HAND)]
}

/// The place seen in a mirror on the plane x = 0.
pub(super) fn mirrored(at: Upright) -> Upright {
    Upright { middle: at.middle * Vec3::new(-1.0, 1.0, 1.0), heading: -at.heading }
}

/// A box at the captured height over the ground; on the ground where it all but is.
pub(super) fn settled(at: Upright, height: f32) -> Upright {
    /// Hands are this far off when they grasp what lies on the ground, metres.
    const NEARLY: f32 = 0.08;
    let lowest = 0.5 * height;
    let y = if at.middle.y < lowest + NEARLY { lowest } else { at.middle.y };
    Upright { middle: at.middle.with_y(y), ..at }
}

impl PatchKind {
    /// Index of the prop that a role has in the hands at its entry.
    pub fn carried_in(&self, role: u32) -> Option<usize> {
        let brings = |p: &PatchProp| p.before.is_none() && p.holds.first().is_some_and(|h| h.role == role);
        self.props.iter().position(brings)
    }

    /// Index of the prop that a role has in the hands at its exit.
    pub fn carried_out(&self, role: u32) -> Option<usize> {
        let takes = |p: &PatchProp| p.after.is_none() && p.holds.last().is_some_and(|h| h.role == role);
        self.props.iter().position(takes)
    }

    /// True if a box lies there before or after the patch.
    pub fn leaves_box(&self) -> bool {
        self.props.iter().any(|p| p.before.is_some() || p.after.is_some())
    }
}

/// A port of a set, for messages: kind, role, which end, group, prop in the hands.
struct Port<'a> {
    kind: &'a PatchKind,
    role: usize,
    end: &'static str,
    prop: Option<&'a PatchProp>,
}

impl PatchSet {
    /// For every pose group, whether people of its ports have a box in their hands.
    pub(crate) fn laden_groups(&self) -> Vec<bool> {
        let mut laden = vec![false; self.groups.len()];
        for kind in &self.kinds {
            for (role, f) in kind.fragments.iter().enumerate() {
                laden[f.entry_group as usize] |= kind.carried_in(role as u32).is_some();
                laden[f.exit_group as usize] |= kind.carried_out(role as u32).is_some();
            }
        }
        laden
    }

    /// Ports of one pose group that differ in what the hands hold, and roles that hold two boxes at once.
    pub(super) fn prop_problems(&self) -> Vec<(String, String)> {
        let mut problems = Vec::new();
        let mut first: Vec<Option<Port>> = self.groups.iter().map(|_| None).collect();
        for kind in &self.kinds {
            for (k, prop) in kind.props.iter().enumerate() {
                problems.extend(prop.problems(kind).into_iter().map(|p| (kind.name.clone(), p)));
                for (other, when) in kind.props[..k].iter().filter_map(|o| Some((o, lie_by_one_role(prop, o)?))) {
                    let problem = format!("{} and {} both lie there {when} one role", other.name, prop.name);
                    problems.push((kind.name.clone(), problem));
                }
                for other in kind.props[..k].iter().filter(|other| in_same_hands(prop, other)) {
                    problems.push((kind.name.clone(), format!("{} and {} in the same hands", other.name, prop.name)));
                }
            }
            for (role, f) in kind.fragments.iter().enumerate() {
                let carried = [kind.carried_in(role as u32), kind.carried_out(role as u32)];
                for ((group, end), prop) in [(f.entry_group, "entry"), (f.exit_group, "exit")].into_iter().zip(carried)
                {
                    let port = Port { kind, role, end, prop: prop.map(|p| &kind.props[p]) };
                    let Some(known) = first.get_mut(group as usize) else { continue };
                    match known {
                        None => *known = Some(port),
                        Some(known) if !alike(known.prop, port.prop) => {
                            let name = &self.groups[group as usize].name;
                            problems.push((port.kind.name.clone(), port.unlike(known, name)));
                        }
                        Some(_) => {}
                    }
                }
            }
        }
        problems
    }
}

impl Port<'_> {
    fn unlike(&self, other: &Port, group: &str) -> String {
        let hands = |p: &Port| p.prop.map_or("empty hands".into(), |p| format!("a box of {:?} m", p.size));
        let there = format!("the {} of role {} of kind {}", other.end, other.role, other.kind.name);
        let (expected, found) = (hands(other), hands(self));
        format!(
            "role {}: its {} in pose group {group}: expected {expected} as at {there}, found {found}",
            self.role, self.end
        )
    }
}

/// Whether one role's motion says of two boxes where they lie before it, or after: pieces of tilings know of one.
fn lie_by_one_role(a: &PatchProp, b: &PatchProp) -> Option<&'static str> {
    let role = |p: &PatchProp, end: usize| p.anchors()[end].filter(|_| [p.before, p.after][end].is_some()).map(|a| a.0);
    let same = |end: usize| role(a, end).is_some() && role(a, end) == role(b, end);
    ["before", "after"].into_iter().enumerate().find_map(|(end, when)| same(end).then_some(when))
}

fn in_same_hands(a: &PatchProp, b: &PatchProp) -> bool {
    let meet = |h: &PropHold| b.holds.iter().any(|g| g.role == h.role && g.begin <= h.end && h.begin <= g.end);
    a.holds.iter().any(meet)
}

fn alike(a: Option<&PatchProp>, b: Option<&PatchProp>) -> bool {
    let near = |p: &[f32], q: &[f32]| p.iter().zip(q).all(|(p, q)| (p - q).abs() <= ALIKE);
    match (a, b) {
        (None, None) => true,
        (Some(a), Some(b)) => near(&a.size, &b.size) && near(&a.grip, &b.grip),
        _ => false,
    }
}
