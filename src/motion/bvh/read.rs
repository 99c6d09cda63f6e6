//! Reads BVH files of any skeleton. Memory is bounded by the size of the input, whatever its header promises.

use std::path::Path;

use glam::{Quat, Vec3};
use rayon::prelude::*;

use super::hierarchy::{self, Channel, Hierarchy, Line, bad, number, quoted};
use crate::motion::Clip;
use crate::{Error, Result};

/// Slowest rate taken for a capture's: later stages sample at 30 per second, and a few frames claimed to last for days
/// must not fill the memory.
pub(crate) const MIN_FPS: f32 = 1.0;

/// Reads the BVH file at `path`; the clip is named after the file's stem. Lengths stay in the file's units.
///
/// # Errors
/// The file cannot be read, or as [`read`], with its name.
pub fn load(path: &Path) -> Result<Clip> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    let mut clip = read(&bytes).map_err(|e| e.in_file(path))?;
    clip.name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(clip)
}

/// Reads the bytes of a BVH file: any skeleton, Euler channels in any order. Lengths stay in the file's units.
///
/// A joint's rotation is the product of its rotation channels in file order. Position channels of joints other than
/// the root are read and not used (bones keep their rest lengths). O(numbers in the file).
///
/// # Errors
/// One message with the line: not text, not a hierarchy, an unknown word or channel, a root that cannot move,
/// no frames, a frame time that is not above 0 and at most a second, a frame with too few or too many or non-finite numbers,
/// fewer or more frames than promised.
pub fn read(bytes: &[u8]) -> Result<Clip> {
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let line = 1 + bytes[..e.valid_up_to()].iter().filter(|&&b| b == b'\n').count();
        bad(line, "expected text, found bytes that are not UTF-8")
    })?;
    let mut lines = text.trim_start_matches('\u{feff}').lines().enumerate().map(|(i, line)| (i + 1, line));
    let hierarchy = hierarchy::read(&mut lines)?;
    let mut lines = lines.filter(|(_, text)| !text.trim().is_empty());
    let (promised, header_line) = frame_count(lines.next())?;
    let fps = frame_rate(lines.next(), header_line)?;
    let (root, rotations) = read_frames(&hierarchy, lines, promised, header_line)?;
    Ok(Clip { name: String::new(), skeleton: hierarchy.skeleton, fps, root, rotations })
}

fn field<'a>(line: Option<Line<'a>>, key: &str, before: usize) -> Result<(usize, &'a str)> {
    let (at, text) = line.ok_or_else(|| bad(before, format!("expected '{key}:' next, found the end of the file")))?;
    let value = text.split_once(':').filter(|(k, _)| k.trim().eq_ignore_ascii_case(key));
    let (_, value) = value.ok_or_else(|| bad(at, format!("expected '{key}:', found {}", quoted(text.trim()))))?;
    Ok((at, value.trim()))
}

fn frame_count(line: Option<Line>) -> Result<(u64, usize)> {
    let (at, value) = field(line, "Frames", 1)?;
    match value.parse::<u64>() {
        Ok(0) => Err(bad(at, "expected at least one frame, found 0")),
        Ok(count) => Ok((count, at)),
        Err(_) => Err(bad(at, format!("expected a number of frames, found {}", quoted(value)))),
    }
}

fn frame_rate(line: Option<Line>, before: usize) -> Result<f32> {
    let (at, value) = field(line, "Frame Time", before)?;
    let seconds = number(value, at)?;
    let fps = 1.0 / seconds;
    if (MIN_FPS..f32::INFINITY).contains(&fps) {
        return Ok(fps);
    }
    Err(bad(at, format!("expected a frame time above 0 and at most 1 second, found {}", quoted(value))))
}

/// Places of the root and rotations of all joints, frame-major.
type Frames = (Vec<Vec3>, Vec<Quat>);

/// Reads the frames in parallel. One that is too short for its numbers is read last and alone, lest it takes memory
/// for nothing.
fn read_frames<'a>(
    hierarchy: &Hierarchy,
    lines: impl Iterator<Item = Line<'a>>,
    promised: u64,
    header_line: usize,
) -> Result<Frames> {
    let lines: Vec<Line> = lines.collect();
    let joints = hierarchy.skeleton.joints.len();
    let shortest = 2 * hierarchy.channels.len() - 1;
    let promised_here = usize::try_from(promised).unwrap_or(usize::MAX).min(lines.len());
    let whole = lines.iter().take(promised_here).position(|(_, text)| text.len() < shortest).unwrap_or(promised_here);
    let mut root = vec![Vec3::ZERO; whole];
    let mut rotations = vec![Quat::IDENTITY; whole * joints];
    let frames = rotations.par_chunks_mut(joints).zip(&mut root).zip(&lines).enumerate();
    let read = frames.map(|(frame, ((pose, root), &line))| read_frame(hierarchy, frame, line, root, pose));
    if let Some(error) = read.find_map_first(Result::err) {
        return Err(error);
    }
    if whole < promised_here {
        let (mut place, mut pose) = (Vec3::ZERO, vec![Quat::IDENTITY; joints]);
        read_frame(hierarchy, whole, lines[whole], &mut place, &mut pose)?;
    }
    if let Some((line, text)) = lines.get(promised_here) {
        return Err(bad(*line, format!("expected the end after {promised} frames, found {}", quoted(text.trim()))));
    }
    if (lines.len() as u64) < promised {
        let last_line = lines.last().map_or(header_line + 1, |line| line.0);
        return Err(bad(last_line, format!("expected {promised} frames, found the end after {}", lines.len())));
    }
    Ok((root, rotations))
}

fn read_frame(h: &Hierarchy, frame: usize, (line, text): Line, root: &mut Vec3, pose: &mut [Quat]) -> Result<()> {
    let place = |found: usize| {
        let expected = format!("expected {} numbers", h.channels.len());
        bad(line, format!("frame {frame}: {expected}, found {found}"))
    };
    let mut words = text.split_ascii_whitespace();
    for (i, &(joint, channel)) in h.channels.iter().enumerate() {
        let value = number(words.next().ok_or_else(|| place(i))?, line)?;
        match channel {
            Channel::Position(axis) if joint == 0 => root[axis] = value,
            Channel::Position(_) => {}
            Channel::Rotation(axis) => pose[joint] *= turn(axis, value),
        }
    }
    let more = words.count();
    if more > 0 {
        return Err(place(h.channels.len() + more));
    }
    for q in pose {
        *q = q.normalize();
    }
    Ok(())
}

/// A turn by degrees about an axis of the frame.
fn turn(axis: usize, degrees: f32) -> Quat {
    let (sin, cos) = (0.5 * degrees.to_radians()).sin_cos();
    let mut v = Vec3::ZERO;
    v[axis] = sin;
    Quat::from_xyzw(v.x, v.y, v.z, cos)
}
