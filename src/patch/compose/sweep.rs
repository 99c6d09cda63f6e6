//! A clip that is to end somewhere gets there evenly: every frame moves on and turns by the same bit more than captured.
//! Least squares would leave those alone who hardly move, as people who stand should be; who hops on the spot may as well
//! hop somewhere. Feet stay where they are planted, so legs swing as far as the way demands.

use super::story::{Clip, bad};
use crate::Result;
use crate::deform::Limits;
use crate::geom::{Ground, wrap_angle};
use crate::motion::{JOINT_COUNT, Motion, MotionPath};
use crate::patch::{Fragment, PatchKind};
use crate::refine::{Segment, refine};
use crate::stage::FragmentUse;

/// A clip's motion, changed so that it ends where it is to, seen from where it begins. O(frames x joints).
///
/// # Errors
/// Every frame would have to move or turn by more than the limits allow.
pub(super) fn sweep(clip: &Clip, motion: Motion, limits: &Limits) -> Result<Motion> {
    let Some(end) = clip.end else { return Ok(motion) };
    let path = &motion.path;
    let (end, last) = (path.at(0).then(end), path.len() - 1);
    let frames = last as f32;
    let turn = wrap_angle(end.heading - path.headings[last]);
    let mut points = vec![path.points[0]];
    for (i, pair) in path.points.windows(2).enumerate() {
        let turned = Ground::new(points[i], turn * (i as f32 + 0.5) / frames);
        points.push(turned.apply(pair[1] - pair[0]));
    }
    let gap = end.position - points[last];
    let refused = |what: &str, most: f32, unit: &str, found: f32| {
        let expected = format!("expected an end within {most:.2} {unit} of where it {what}");
        Err(bad(clip.line, format!("clip {}: {expected}, found {found:.2} {unit}", clip.name)))
    };
    if turn.abs() > limits.bend * frames {
        return refused("turns to", (limits.bend * frames).to_degrees(), "deg", turn.abs().to_degrees());
    }
    if gap.length() > limits.stretch * frames {
        return refused("leads", limits.stretch * frames, "m", gap.length());
    }
    points.iter_mut().enumerate().for_each(|(i, p)| *p += gap * (i as f32 / frames));
    let headings = path.headings.iter().enumerate().map(|(i, h)| h + turn * (i as f32 / frames)).collect();
    Ok(planted(motion, MotionPath { points, headings }))
}

/// A motion on another path, whose planted feet stay where they stand.
fn planted(motion: Motion, path: MotionPath) -> Motion {
    let last = motion.len() - 1;
    let (points, headings) = (path.points.clone(), path.headings.clone());
    let placed = FragmentUse { instance: 0, role: 0, begin: 0, end: last as i32, points, headings };
    let fragments = vec![Fragment { motion, begin: 0, entry_group: 0, exit_group: 0 }];
    let kind = PatchKind { fragments, ..PatchKind::default() };
    let body = refine(&[Segment { kind: &kind, placed: &placed }], last as u32);
    let Some(Fragment { motion, .. }) = kind.fragments.into_iter().next() else { unreachable!("one was put in") };
    let mut rotations = body.rotations;
    for (frame, hips) in rotations.iter_mut().step_by(JOINT_COUNT).enumerate() {
        *hips = path.at(frame).rotation().inverse() * *hips;
    }
    Motion { path, heights: body.root.iter().map(|hips| hips.y).collect(), rotations, ..motion }
}
