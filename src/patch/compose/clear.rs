//! Nobody walks through anybody: bodies of a composition keep clear of each other, where they were not captured together.

use super::story::{Composition, Prop, bad};
use crate::Result;
use crate::geom::{Capsule, Cuboid};
use crate::motion::{BODY_CAPSULES, FPS, body_capsules};
use crate::patch::{Contact, Fragment, PatchKind, PatchProp};

/// Bodies may be this deep in each other, metres.
const DEPTH: f32 = 0.01;
/// Those of people who touch, while they do and shortly before and after.
const TOUCHING_DEPTH: f32 = 0.04;
/// Which of a body's capsules are the first of the arms'.
const ARMS: usize = 10;
/// Frames before and after a touch.
const AROUND: u32 = 12;

/// Tests all bodies against each other. O(pairs x frames).
///
/// # Errors
/// The deepest overlap: who, when, how deep.
pub(super) fn check(story: &Composition, contacts: &[Contact], fragments: &[Fragment]) -> Result<()> {
    let shapes: Vec<Vec<Vec<Capsule>>> = fragments.iter().map(shapes).collect();
    let mut worst: Option<(f32, usize, usize, u32)> = None;
    for b in 0..fragments.len() {
        for a in 0..b {
            let begins = [fragments[a].begin, fragments[b].begin];
            let ends = [a, b].map(|r| fragments[r].begin + shapes[r].len() as u32);
            for tick in begins[0].max(begins[1])..ends[0].min(ends[1]) {
                let [p, q] = [(a, begins[0]), (b, begins[1])].map(|(r, begin)| &shapes[r][(tick - begin) as usize]);
                let deep = depth(p, q) - allowed(contacts, a, b, tick);
                if deep > 0.0 && worst.is_none_or(|w| deep > w.0) {
                    worst = Some((deep, a, b, tick));
                }
            }
        }
    }
    let Some((deep, a, b, tick)) = worst else { return Ok(()) };
    let names = [a, b].map(|r| story.roles[r].name.as_str());
    let deep = deep + allowed(contacts, a, b, tick);
    let found =
        format!("found {} {deep:.2} m deep in {} at {:.2} s of the patch", names[1], names[0], tick as f32 / FPS);
    Err(bad(story.roles[b].line, format!("expected people beside each other, {found}")))
}

/// Tests all bodies against the boxes that others have to do with, and the bodies of those who carry a box that their
/// clips know nothing of, but for their arms, against it. O(people x boxes x frames).
///
/// # Errors
/// The deepest overlap: who, when, how deep.
pub(super) fn check_boxes(story: &Composition, kind: &PatchKind) -> Result<()> {
    let mut worst: Option<(f32, usize, u32, &str)> = None;
    for (role, fragment) in kind.fragments.iter().enumerate() {
        let shapes = shapes(fragment);
        let strange = |p: &PatchProp| p.holds.iter().chain(&p.sat).all(|h| h.role as usize != role);
        let carries = |p: &Prop| p.held.iter().any(|u| u.who.role == role && !u.carried.is_empty());
        for (prop, told) in kind.props.iter().zip(&story.props) {
            let parts = match (strange(prop), carries(told)) {
                (true, _) => BODY_CAPSULES.len(),
                (_, true) => ARMS,
                _ => continue,
            };
            for (tick, body) in (fragment.begin..).zip(&shapes) {
                let Some(cuboid) = prop.place(kind, tick).map(|at| Cuboid::new(at, prop.size)) else { continue };
                let deep = body[..parts].iter().map(|c| cuboid.penetration(c)).fold(0.0, f32::max);
                if deep > worst.map_or(DEPTH, |w| w.0) {
                    worst = Some((deep, role, tick, &prop.name));
                }
            }
        }
    }
    let Some((deep, role, tick, prop)) = worst else { return Ok(()) };
    let role = &story.roles[role];
    let found = format!("found {} {deep:.2} m deep in {prop} at {:.2} s of the patch", role.name, tick as f32 / FPS);
    Err(bad(role.line, format!("expected people beside boxes, {found}")))
}

fn allowed(contacts: &[Contact], a: usize, b: usize, tick: u32) -> f32 {
    let between = |c: &&Contact| [c.a.role as usize, c.b.role as usize].iter().all(|r| [a, b].contains(r));
    let near = |c: &Contact| (c.begin.saturating_sub(AROUND)..=c.end + AROUND).contains(&tick);
    if contacts.iter().filter(between).any(near) { TOUCHING_DEPTH } else { DEPTH }
}

fn shapes(fragment: &Fragment) -> Vec<Vec<Capsule>> {
    let mut globals = Vec::new();
    let mut shape = |frame: usize| {
        let mut capsules = Vec::new();
        fragment.motion.globals(frame, &mut globals);
        body_capsules(&globals, &mut capsules);
        capsules
    };
    (0..fragment.motion.len()).map(&mut shape).collect()
}

/// Depth of the deepest pair of capsules, metres.
fn depth(a: &[Capsule], b: &[Capsule]) -> f32 {
    // Nobody reaches further than that from the first capsule, the torso's.
    const REACH: f32 = 2.4;
    if a[0].a.distance_squared(b[0].a) > REACH * REACH {
        return 0.0;
    }
    a.iter().flat_map(|p| b.iter().map(|q| p.penetration(q))).fold(0.0, f32::max)
}
