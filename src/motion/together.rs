//! People of one take: picked from their files, moved onto one clock and one ground, and checked to belong together.

use std::path::{Path, PathBuf};

use glam::{Quat, Vec3};

use super::retarget::{RestRig, match_rig};
use super::skeleton::joint::HIPS;
use super::take::{Character, ImportOptions, Offset, TakeFile};
use super::{Clip, import};
use crate::{Error, Result};

/// People of one take who never come nearer to each other than this are not in one world, metres.
pub const FAR_APART: f32 = 30.0;

/// Hips nearer to each other than this are inside each other, metres.
pub const INSIDE: f32 = 0.15;

/// Lengths that differ by more than this are said, seconds.
const MUCH_LONGER: f32 = 0.1;

/// Loads all people of a take, each repaired, turned and moved as its entry says; on one clock: where any has an offset
/// in time, all are cut to the time that they share, else all begin at 0. `locate` finds a capture's file.
///
/// # Errors
/// A capture is bad; a character that its file does not hold; no time that all share; people who are too far apart to
/// be in one world.
pub fn load(take: &TakeFile, locate: impl Fn(&str) -> PathBuf) -> Result<Vec<Clip>> {
    let mut clips = Vec::new();
    for person in &take.people {
        clips.push(load_one(&locate(&person.file), &person.import, person.character.as_ref())?);
    }
    let offsets: Vec<Offset> = take.people.iter().map(|p| p.offset).collect();
    align(&mut clips, &offsets)?;
    match check(&clips).into_iter().find(|f| f.hopeless) {
        Some(finding) => Err(Error::invalid(take.name.clone(), "people", finding.message)),
        None => Ok(clips),
    }
}

/// Loads one person of a capture: the only one, or the one that `character` names or counts.
///
/// # Errors
/// As [`import::load`]; nobody of that number.
pub fn load_one(path: &Path, options: &ImportOptions, character: Option<&Character>) -> Result<Clip> {
    let index = match character {
        None => return import::load(path, options),
        Some(Character::Name(name)) => {
            return import::load(path, &ImportOptions { character: Some(name.clone()), ..options.clone() });
        }
        Some(Character::Index(index)) => *index,
    };
    let mut clips = import::load_all(path, options)?;
    if index < clips.len() {
        return Ok(clips.swap_remove(index));
    }
    let problem = format!("expected a character below {}, found {index}", clips.len());
    Err(Error::invalid(path.display().to_string(), "character", problem))
}

/// Turns and moves clips by their offsets and cuts them to the time that all share, if any has an offset in time.
///
/// # Errors
/// Offsets that are not finite; no time that all share.
pub fn align(clips: &mut [Clip], offsets: &[Offset]) -> Result<()> {
    for (clip, offset) in clips.iter_mut().zip(offsets) {
        if ![offset.time, offset.x, offset.z, offset.heading_deg].iter().all(|v| v.is_finite()) {
            return Err(Error::invalid(
                clip.name.clone(),
                "offset",
                format!("expected finite numbers, found {offset:?}"),
            ));
        }
        place(clip, offset);
    }
    if offsets.iter().all(|o| o.time == 0.0) {
        return Ok(());
    }
    let begin = offsets.iter().map(|o| o.time).fold(f32::NEG_INFINITY, f32::max);
    let ends = clips.iter().zip(offsets).map(|(clip, o)| o.time + clip.seconds());
    let end = ends.fold(f32::INFINITY, f32::min);
    for (clip, offset) in clips.iter_mut().zip(offsets) {
        cut(clip, begin - offset.time, end - offset.time)?;
    }
    Ok(())
}

fn place(clip: &mut Clip, offset: &Offset) {
    let turn = Quat::from_rotation_y(offset.heading_deg.to_radians());
    let joints = clip.skeleton.joints.len();
    if *offset == (Offset { time: offset.time, ..Default::default() }) {
        return;
    }
    for (root, pose) in clip.root.iter_mut().zip(clip.rotations.chunks_exact_mut(joints)) {
        *root = turn * *root + Vec3::new(offset.x, 0.0, offset.z);
        pose[0] = (turn * pose[0]).normalize();
    }
}

/// Keeps the frames from one time to another, seconds.
fn cut(clip: &mut Clip, begin: f32, end: f32) -> Result<()> {
    let joints = clip.skeleton.joints.len();
    let first = (begin * clip.fps).round() as usize;
    let last = ((end * clip.fps).round().max(0.0) as usize).min(clip.frames() - 1);
    if end < begin || last < first + 1 {
        let problem = format!("expected a time that all people share, found that {begin:.2} s to {end:.2} s is left");
        return Err(Error::invalid(clip.name.clone(), "offset.time", problem));
    }
    clip.root = clip.root[first..=last].to_vec();
    clip.rotations = clip.rotations[first * joints..(last + 1) * joints].to_vec();
    Ok(())
}

/// What is odd about clips that are to be one take.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// In words, with figures.
    pub message: String,
    /// Whether they cannot be one take.
    pub hopeless: bool,
}

/// How two people of a take stand to each other: hips to hips over the ground, metres, over the time both are there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// Indices of the two.
    pub people: [usize; 2],
    /// Nearest.
    pub nearest: f32,
    /// Farthest.
    pub farthest: f32,
    /// Share of the time in which they are nearer than [`INSIDE`].
    pub inside: f32,
}

/// Distances of all pairs. O(people^2 x frames).
pub fn distances(clips: &[Clip]) -> Vec<Apart> {
    let hips = |clip: &Clip| {
        let joint = match_rig(&RestRig::of(&clip.skeleton)).ok().and_then(|m| m.joints[HIPS]).unwrap_or(0);
        clip.trajectory(joint)
    };
    let ways: Vec<Vec<Vec3>> = clips.iter().map(hips).collect();
    let mut out = Vec::new();
    for a in 0..clips.len() {
        for b in a + 1..clips.len() {
            let seconds = clips[a].seconds().min(clips[b].seconds());
            let at = |i: usize, time: f32| {
                let frame = (time * clips[i].fps).round() as usize;
                ways[i].get(frame).or(ways[i].last()).copied().unwrap_or(Vec3::NAN).with_y(0.0)
            };
            let count = (seconds * super::FPS) as usize + 1;
            let gaps: Vec<f32> =
                (0..count).map(|f| f as f32 / super::FPS).map(|t| at(a, t).distance(at(b, t))).collect();
            out.push(Apart {
                people: [a, b],
                nearest: gaps.iter().copied().fold(f32::INFINITY, f32::min),
                farthest: gaps.iter().copied().fold(0.0, f32::max),
                inside: gaps.iter().filter(|&&g| g < INSIDE).count() as f32 / count as f32,
            });
        }
    }
    out
}

/// Whether clips can be one take: alike in length and rate, near each other and not inside each other.
pub fn check(clips: &[Clip]) -> Vec<Finding> {
    let mut found = Vec::new();
    let mut say = |message: String, hopeless: bool| found.push(Finding { message, hopeless });
    if let Some(first) = clips.first() {
        for other in &clips[1..] {
            if (first.fps / other.fps - 1.0).abs() > 1e-3 {
                let rates = format!("{} has {} frames per second, {} {}", first.name, first.fps, other.name, other.fps);
                say(format!("{rates}: is one header wrong (fps)?"), false);
            }
            if (first.seconds() - other.seconds()).abs() > MUCH_LONGER {
                let (a, b) = (first.seconds(), other.seconds());
                say(
                    format!(
                        "{} takes {a:.2} s, {} {b:.2} s: do they begin at one time (offset.time)?",
                        first.name, other.name
                    ),
                    false,
                );
            }
        }
    }
    for apart in distances(clips) {
        let [a, b] = apart.people.map(|i| clips[i].name.as_str());
        if apart.nearest > FAR_APART {
            let near = apart.nearest;
            say(
                format!(
                    "expected people in one world, found {a} and {b} never nearer than {near:.0} m: is a unit wrong, or an offset missing?"
                ),
                true,
            );
        }
        if apart.inside > 0.05 {
            let share = 100.0 * apart.inside;
            say(
                format!(
                    "{a} and {b} stand inside each other for {share:.0} % of the time: an offset, or the same capture twice?"
                ),
                false,
            );
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{JOINT_COUNT, canonical};

    fn walker(name: &str, seconds: f32, x: f32) -> Clip {
        let frames = (seconds * 60.0) as usize + 1;
        Clip {
            name: name.into(),
            skeleton: canonical().clone(),
            fps: 60.0,
            root: (0..frames).map(|f| Vec3::new(x, 0.93, f as f32 / 60.0)).collect(),
            rotations: vec![Quat::IDENTITY; frames * JOINT_COUNT],
        }
    }

    fn told(clips: &[Clip]) -> String {
        check(clips).iter().map(|f| format!("{} {}\n", f.hopeless, f.message)).collect()
    }

    #[test]
    fn people_who_belong_together_raise_nothing() {
        assert_eq!(told(&[walker("a", 3.0, 0.0), walker("b", 3.0, 1.0)]), "");
    }

    #[test]
    fn what_is_odd_is_said() {
        let mut slow = walker("b", 3.0, 1.0);
        slow.fps = 30.0;
        let odd = told(&[walker("a", 3.0, 0.0), slow]);
        assert!(odd.contains("60 frames per second, b 30") && odd.contains("takes 3.00 s, b 6.00 s"), "{odd}");
        assert!(told(&[walker("a", 3.0, 0.0), walker("b", 3.0, 0.1)]).contains("inside each other for 100 %"));
        assert!(told(&[walker("a", 3.0, 0.0), walker("b", 3.0, 140.0)]).contains("true expected people in one world"));
    }

    #[test]
    fn offsets_turn_move_and_cut() {
        let mut clips = [walker("a", 3.0, 0.0), walker("b", 3.0, 0.0)];
        let offset = Offset { time: 1.0, x: 2.0, z: 0.5, heading_deg: 90.0 };
        align(&mut clips, &[Offset::default(), offset]).unwrap();
        assert_eq!((clips[0].frames(), clips[1].frames()), (121, 121));
        assert!(clips[0].root[0].distance(Vec3::new(0.0, 0.93, 1.0)) < 1e-5, "begins where b begins");
        assert!(clips[1].root[60].distance(Vec3::new(3.0, 0.93, 0.5)) < 1e-5, "walks along +x");
        let mut never = [walker("a", 1.0, 0.0), walker("b", 1.0, 0.0)];
        let late = Offset { time: 2.0, ..Default::default() };
        let told = align(&mut never, &[Offset::default(), late]).unwrap_err().to_string();
        assert!(told.contains("offset.time: expected a time that all people share"), "{told}");
        let odd = Offset { x: f32::NAN, ..Default::default() };
        assert!(align(&mut never, &[odd, odd]).unwrap_err().to_string().contains("finite"));
    }
}
