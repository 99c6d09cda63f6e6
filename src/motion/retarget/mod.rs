//! Retargeting: a capture on its own rig becomes motion on the canonical skeleton.
//!
//! 1. `Rig`: joints by name and hierarchy ([`match_rig`]), bones by direction ([`rest_turns`]), so that limbs point
//!    the same way in space.
//! 2. Root: the point between the hip joints, scaled by the ratio of the legs' lengths, so that steps fit the legs;
//!    people of one take share one scale on the ground, so that they still meet.
//! 3. Floor: shifted so that the planted ball of the foot is 0.02 m above it.
//! 4. [`build`]: sampled at 30 fps, with a smooth heading.
//! 5. Feet: planted feet are detected and pinned.
//! 6. Touch: hands of two people that touch in the capture are brought as near each other as they were.

pub mod build;
mod families;
mod feet;
mod floor;
mod guess;
mod height;
mod hinge;
mod names;
mod rest;
mod rig;
#[cfg(test)]
mod rig_tests;
pub mod rigfile;
#[cfg(test)]
mod tests;
mod touch;
#[cfg(test)]
mod touch_tests;

pub(crate) use floor::lowest;
pub use height::body_height;
pub use names::{RigMatch, match_rig};
pub use rest::RestRig;
pub use rig::rest_turns;

use glam::{Quat, Vec3};

use super::plants::{self, PlantOptions};
use super::skeleton::joint::*;
use super::{Clip, JOINT_COUNT, Motion, canonical};
use crate::{Error, Result};
use rig::Rig;

/// Length of thigh and shin of the canonical body, metres.
const CANONICAL_LEG: f32 = 0.83;

/// One person's capture (in metres, see [`super::import`]) as motion on the canonical skeleton, foot plants detected.
///
/// # Errors
/// The rig is none of a person that can be told (names the joints that are missing) or the clip has fewer than two frames.
pub fn to_canonical(clip: &Clip) -> Result<Motion> {
    take(std::slice::from_ref(clip)).map(|mut motions| motions.remove(0))
}

/// All people of a take: as [`to_canonical`], with one scale on the ground about the take's common origin (the mean
/// of the people's leg ratios), so that who met still meets. Heights keep each person's own ratio. Hands of two people
/// that touch in the capture (3 cm or less between them) are brought as near each other as they were.
///
/// # Errors
/// As [`to_canonical`], for the first clip that is bad.
pub fn take(clips: &[Clip]) -> Result<Vec<Motion>> {
    let rigs = clips.iter().map(Rig::new).collect::<Result<Vec<Rig>>>()?;
    let mut motions = bodies(clips, &rigs)?;
    touch::restore(&mut motions, &touch::measure(clips, &rigs));
    Ok(motions)
}

/// Everybody on a canonical body, whatever the others do.
fn bodies(clips: &[Clip], rigs: &[Rig]) -> Result<Vec<Motion>> {
    let ratios: Vec<f32> = rigs.iter().map(|rig| CANONICAL_LEG / rig.leg).collect();
    let ground_scale = ratios.iter().sum::<f32>() / ratios.len().max(1) as f32;
    let person = |((clip, rig), &ratio): ((&Clip, &Rig), &f32)| -> Result<Motion> {
        if clip.frames() < 2 {
            let problem = format!("expected at least 2 frames, found {}", clip.frames());
            return Err(Error::invalid(clip.name.clone(), "frames", problem));
        }
        check_legs(clip, rig)?;
        let mut canonical_clip = onto_canonical(clip, rig, Vec3::new(ground_scale, ratio, ground_scale));
        check_places(&canonical_clip)?;
        floor::settle(&mut canonical_clip, rig.joints[LEFT_TOE].is_none());
        let mut motion = build::motion(&canonical_clip);
        motion.plants = plants::detect(&motion, &PlantOptions::default());
        feet::pin(&mut motion);
        hinge::straighten(&mut motion);
        Ok(motion)
    };
    clips.iter().zip(rigs).zip(&ratios).map(person).collect()
}

/// Legs and ways beyond these are no person's, and sums of them no numbers, metres.
const LEGS: std::ops::Range<f32> = 0.01..100.0;
const FARTHEST: f32 = 1e6;

fn check_legs(clip: &Clip, rig: &Rig) -> Result<()> {
    if LEGS.contains(&rig.leg) {
        return Ok(());
    }
    let problem = format!("expected legs of {} to {} m, found {} m", LEGS.start, LEGS.end, rig.leg);
    Err(Error::invalid(clip.name.clone(), "skeleton", problem))
}

fn check_places(clip: &Clip) -> Result<()> {
    let lost = clip.root.iter().position(|p| !p.is_finite() || p.abs().max_element() > FARTHEST);
    lost.map_or(Ok(()), |frame| {
        let problem = format!("expected hips within {FARTHEST} m of the origin, found {}", clip.root[frame]);
        Err(Error::invalid(clip.name.clone(), format!("frame {frame}"), problem))
    })
}

/// The clip with the same frames on the canonical skeleton; lengths of the root's path times `scale`.
fn onto_canonical(clip: &Clip, rig: &Rig, scale: Vec3) -> Clip {
    let mut out = Clip {
        name: clip.name.clone(),
        skeleton: canonical().clone(),
        fps: clip.fps,
        root: Vec::with_capacity(clip.frames()),
        rotations: Vec::with_capacity(clip.frames() * JOINT_COUNT),
    };
    let offset = |j: usize| canonical().joints[j].offset;
    let hip_centre = 0.5 * (offset(LEFT_UP_LEG) + offset(RIGHT_UP_LEG));
    let mut source = Vec::new();
    for frame in 0..clip.frames() {
        clip.globals(frame, &mut source);
        let mut globals = [Quat::IDENTITY; JOINT_COUNT];
        for joint in 0..JOINT_COUNT {
            let parent = canonical().joints[joint].parent.map(|p| globals[p]).unwrap_or_default();
            globals[joint] = match rig.joints[joint] {
                Some(from) => (source[from].1 * rig.rig_from_canonical[joint]).normalize(),
                None => parent,
            };
            out.rotations.push((parent.inverse() * globals[joint]).normalize());
        }
        let hip = |j: usize| rig.joints[j].map(|from| source[from].0).expect("every rig has thighs");
        let centre = 0.5 * (hip(LEFT_UP_LEG) + hip(RIGHT_UP_LEG)) * scale;
        out.root.push(centre - globals[HIPS] * hip_centre);
    }
    out
}
