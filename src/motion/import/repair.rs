//! Repairs of what captures get wrong, by explicit options (see [`ImportOptions`]).

use glam::Vec3;

use crate::motion::take::ImportOptions;
use crate::motion::{Clip, Joint, bvh};
use crate::{Error, Result};

/// Applies the repairs to a clip in its file's own units. See [`load`](super::load).
///
/// # Errors
/// An option that does not fit the clip.
pub fn repair(mut clip: Clip, options: &ImportOptions) -> Result<Clip> {
    let options = &options.resolved()?;
    let bad = |option: &str, problem: String| Error::invalid(clip.name.clone(), format!("import.{option}"), problem);
    let positive = |option: &str, value: Option<f32>| match value {
        Some(v) if !(v.is_finite() && v > 0.0) => Err(bad(option, format!("expected a positive number, found {v}"))),
        other => Ok(other),
    };
    let unit = positive("metres_per_unit", options.metres_per_unit)?;
    let fps = positive("fps", options.fps)?;
    if let Some(slow) = fps.filter(|&fps| fps < bvh::MIN_FPS) {
        return Err(bad("fps", format!("expected at least {} per second, found {slow}", bvh::MIN_FPS)));
    }
    let drop = options.drop_first_frames.unwrap_or(0) as usize;
    if drop >= clip.frames() {
        return Err(bad("drop_first_frames", format!("expected fewer than {} frames, found {drop}", clip.frames())));
    }
    let joints = clip.skeleton.joints.len();
    clip.root.drain(..drop);
    clip.rotations.drain(..drop * joints);
    clip.fps = fps.unwrap_or(clip.fps);
    if options.restore_thorax == Some(true) {
        restore_thorax(&mut clip)?;
    }
    let unit = match unit {
        Some(unit) => unit,
        None => guess_unit(&clip)?,
    };
    scale(&mut clip, unit);
    Ok(clip)
}

fn scale(clip: &mut Clip, factor: f32) {
    clip.root.iter_mut().for_each(|p| *p *= factor);
    for joint in &mut clip.skeleton.joints {
        joint.offset *= factor;
        joint.tip = joint.tip.map(|tip| tip * factor);
    }
}

/// Puts back the bone between the chest and the three joints that hang from it (neck and both shoulders), which
/// cgspeed's conversions of CMU's captures collapse to nothing. The lost bone is close to a copy of the one below it.
fn restore_thorax(clip: &mut Clip) -> Result<()> {
    let joints = &mut clip.skeleton.joints;
    let collapsed = |chest: usize, joints: &[Joint]| -> Vec<usize> {
        (0..joints.len()).filter(|&j| joints[j].parent == Some(chest) && joints[j].offset == Vec3::ZERO).collect()
    };
    let found = (1..joints.len()).map(|chest| (chest, collapsed(chest, joints))).find(|(_, lost)| lost.len() >= 3);
    let Some((chest, lost)) = found else {
        let problem = "expected a chest joint whose neck and shoulders have no offset, found none";
        return Err(Error::invalid(clip.name.clone(), "import.restore_thorax", problem));
    };
    for joint in lost {
        joints[joint].offset = joints[chest].offset;
    }
    Ok(())
}

/// Units that files are commonly in, as metres: metres, centimetres, millimetres, inches, feet, CMU's ASF/AMC unit.
const UNITS: [f32; 6] = [1.0, 0.01, 0.001, 0.0254, 0.3048, 0.0254 / 0.45];

/// Metres per unit of a clip, guessed from the standing height: the common unit that makes the person
/// closest to 1.72 m if one makes them 1.3 to 2.2 m tall, else what makes them 1.72 m exactly.
///
/// # Errors
/// The skeleton has no height.
pub fn guess_unit(clip: &Clip) -> Result<f32> {
    const TYPICAL: f32 = 1.72;
    let height = standing_height(clip);
    if !(height.is_finite() && height > 0.0) {
        let problem = format!("expected a skeleton with a height to guess the unit from, found height {height}");
        return Err(Error::invalid(clip.name.clone(), "import.metres_per_unit", problem));
    }
    let miss = |unit: f32| (height * unit - TYPICAL).abs();
    let best = UNITS.into_iter().min_by(|&a, &b| miss(a).total_cmp(&miss(b))).expect("six units");
    Ok(if (1.3..2.2).contains(&(height * best)) { best } else { TYPICAL / height })
}

/// Height of the person: the 95th percentile over the frames of the extent from the lowest to the highest joint or
/// bone tip, in the clip's unit. (Fit for whoever stands upright in some frame; arms overhead make it too large.)
pub fn standing_height(clip: &Clip) -> f32 {
    let mut globals = Vec::new();
    let step = (clip.frames() / 200).max(1);
    let mut extents: Vec<f32> = Vec::new();
    for frame in (0..clip.frames()).step_by(step) {
        clip.globals(frame, &mut globals);
        let tips = clip.skeleton.joints.iter().zip(&globals).filter_map(|(j, g)| Some(g.0 + g.1 * j.tip?));
        let (low, high) = globals
            .iter()
            .map(|g| g.0)
            .chain(tips)
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(lo, hi), p| (lo.min(p.y), hi.max(p.y)));
        extents.push(high - low);
    }
    extents.sort_by(f32::total_cmp);
    extents.get(extents.len().saturating_sub(1) * 95 / 100).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;
    use crate::motion::{JOINT_COUNT, canonical};

    fn standing(scale_by: f32) -> Clip {
        let skeleton = canonical().clone();
        let root = vec![skeleton.joints[0].offset; 5];
        let rotations = vec![Quat::IDENTITY; 5 * JOINT_COUNT];
        let mut clip = Clip { name: "stand".into(), skeleton, fps: 30.0, root, rotations };
        scale(&mut clip, scale_by);
        clip
    }

    #[test]
    fn unit_is_guessed_from_the_height() {
        for unit in UNITS {
            let guess = guess_unit(&standing(1.0 / unit)).unwrap();
            assert!((guess / unit - 1.0).abs() < 1e-5, "{unit}: {guess}");
        }
        let odd = standing(1.0 / 7.7);
        let repaired = repair(odd, &ImportOptions::default()).unwrap();
        assert!((standing_height(&repaired) - 1.72).abs() < 1e-4);
    }

    #[test]
    fn options_that_do_not_fit_are_named() {
        let says = |options: ImportOptions, text: &str| {
            let found = repair(standing(1.0), &options).unwrap_err().to_string();
            assert!(found.contains(text), "{found}");
        };
        says(
            ImportOptions { drop_first_frames: Some(5), ..Default::default() },
            "import.drop_first_frames: expected fewer",
        );
        says(ImportOptions { fps: Some(0.0), ..Default::default() }, "import.fps: expected a positive");
        says(ImportOptions { fps: Some(0.001), ..Default::default() }, "import.fps: expected at least 1");
        says(ImportOptions { metres_per_unit: Some(f32::NAN), ..Default::default() }, "import.metres_per_unit");
        says(
            ImportOptions { restore_thorax: Some(true), ..Default::default() },
            "import.restore_thorax: expected a chest",
        );
    }

    #[test]
    fn leading_frames_go_and_the_rate_changes() {
        let options = ImportOptions { drop_first_frames: Some(3), fps: Some(60.0), ..Default::default() };
        let clip = repair(standing(1.0), &options).unwrap();
        assert_eq!((clip.frames(), clip.rotations.len(), clip.fps), (2, 2 * JOINT_COUNT, 60.0));
    }
}
