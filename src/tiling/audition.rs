//! Audition: a patch is cast only if it comes out of full-body refinement as clean as it was
//! captured. Feet that slid in the capture are locked, and where legs are intertwined that can push one into another.

use glam::{Quat, Vec3};

use super::figure::{Figure, TOLERANCE};
use crate::geom::{Capsule, Torus};
use crate::motion::{Motion, body_capsules};
use crate::patch::PatchKind;
use crate::refine::{Body, Segment, refine_all};
use crate::stage::FragmentUse;

/// How much deeper than captured the people of a patch may overlap after refinement, metres: a little less than is let
/// pass in the end, since stitches move feet a little.
const ALLOWANCE: f32 = 0.8 * TOLERANCE;

/// True if refinement keeps the people of `kind` as clear of each other as in the capture, and their feet in reach.
/// O(pairs x frames).
pub(super) fn plays_cleanly(kind: &PatchKind) -> bool {
    let played = play(kind);
    if played.iter().any(|body| !body.strained.is_empty()) {
        return false;
    }
    if !parts_cleanly(kind) {
        return false;
    }
    let (mut globals, mut now, mut then) = (Vec::new(), Vec::new(), Vec::new());
    let last = kind.fragments.iter().map(|f| f.begin as usize + f.motion.len()).max().unwrap_or(0);
    (0..last).all(|frame| {
        now.clear();
        then.clear();
        for (fragment, body) in kind.fragments.iter().zip(&played) {
            if let Some(f) = frame.checked_sub(fragment.begin as usize).filter(|&f| f < fragment.motion.len()) {
                now.push(shapes(|g| body.globals(f, g), &mut globals));
                then.push(shapes(|g| fragment.motion.globals(f, g), &mut globals));
            }
        }
        (0..now.len())
            .all(|i| (0..i).all(|j| depth(&now[i], &now[j]) <= depth(&then[i], &then[j]).max(0.0) + ALLOWANCE))
    })
}

/// True if nobody enters or leaves while in somebody else: the frame before or after is of another patch, whose people
/// may not be.
fn parts_cleanly(kind: &PatchKind) -> bool {
    let mut globals = Vec::new();
    let mut figure = |role: usize, clock: usize| {
        let fragment = &kind.fragments[role];
        let frame = clock.checked_sub(fragment.begin as usize).filter(|&f| f < fragment.motion.len())?;
        fragment.motion.globals(frame, &mut globals);
        Some(Figure::new(&globals))
    };
    (0..kind.people()).all(|role| {
        let begin = kind.fragments[role].begin as usize;
        [begin, begin + kind.fragments[role].motion.len() - 1].into_iter().all(|clock| {
            let own = figure(role, clock).expect("its first and its last frame");
            let mut others = (0..kind.people()).filter(|&other| other != role);
            others.all(|other| figure(other, clock).is_none_or(|theirs| own.depth_into(&theirs) <= TOLERANCE))
        })
    })
}

/// The people of a patch on their own, placed as captured.
fn play(kind: &PatchKind) -> Vec<Body> {
    let placed: Vec<FragmentUse> = (0..kind.people()).map(|role| as_captured(kind, role)).collect();
    let people: Vec<Vec<Segment>> = placed.iter().map(|placed| vec![Segment { kind, placed }]).collect();
    let last = placed.iter().map(|p| p.end).max().unwrap_or(0);
    refine_all(&people, last as u32, Torus::default()).bodies
}

fn as_captured(kind: &PatchKind, role: usize) -> FragmentUse {
    let fragment = &kind.fragments[role];
    let Motion { path, .. } = &fragment.motion;
    let begin = fragment.begin as i32;
    FragmentUse {
        instance: 0,
        role: role as u32,
        begin,
        end: begin + path.len() as i32 - 1,
        points: path.points.clone(),
        headings: path.headings.clone(),
    }
}

fn shapes(pose: impl Fn(&mut Vec<(Vec3, Quat)>), globals: &mut Vec<(Vec3, Quat)>) -> Vec<Capsule> {
    pose(globals);
    let mut capsules = Vec::new();
    body_capsules(globals, &mut capsules);
    capsules
}

fn depth(a: &[Capsule], b: &[Capsule]) -> f32 {
    a.iter().flat_map(|p| b.iter().map(|q| p.penetration(q))).fold(0.0, f32::max)
}
