//! Reads BVH files of any skeleton. Memory is bounded by the size of the input, whatever its header promises.

use std::path::Path;

use glam::{Quat, Vec3};

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
    let mut lines = lines.filter(|(_, text)| !text.trim().is_empty()).peekable();
    let (promised, header_line) = frame_count(lines.next())?;
    let fps = frame_rate(lines.next(), header_line)?;
    let (root, rotations) = read_frames(&hierarchy, &mut lines, promised, header_line)?;
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

fn read_frames<'a>(
    hierarchy: &Hierarchy,
    lines: &mut impl Iterator<Item = Line<'a>>,
    promised: u64,
    header_line: usize,
) -> Result<(Vec<Vec3>, Vec<Quat>)> {
    let (mut root, mut rotations) = (Vec::new(), Vec::new());
    let mut last_line = header_line + 1;
    for (line, text) in lines {
        if root.len() as u64 == promised {
            return Err(bad(line, format!("expected the end after {promised} frames, found {}", quoted(text.trim()))));
        }
        read_frame(hierarchy, line, text, &mut root, &mut rotations)?;
        last_line = line;
    }
    if (root.len() as u64) < promised {
        return Err(bad(last_line, format!("expected {promised} frames, found the end after {}", root.len())));
    }
    Ok((root, rotations))
}

fn read_frame(h: &Hierarchy, line: usize, text: &str, root: &mut Vec<Vec3>, rotations: &mut Vec<Quat>) -> Result<()> {
    let place = |found: usize| {
        let expected = format!("expected {} numbers", h.channels.len());
        bad(line, format!("frame {}: {expected}, found {found}", root.len()))
    };
    let mut words = text.split_whitespace();
    let mut position = Vec3::ZERO;
    let first = rotations.len();
    rotations.resize(first + h.skeleton.joints.len(), Quat::IDENTITY);
    for (i, &(joint, channel)) in h.channels.iter().enumerate() {
        let value = number(words.next().ok_or_else(|| place(i))?, line)?;
        match channel {
            Channel::Position(axis) if joint == 0 => position[axis] = value,
            Channel::Position(_) => {}
            Channel::Rotation(axis) => {
                let turn = Quat::from_axis_angle(Vec3::AXES[axis], value.to_radians());
                rotations[first + joint] *= turn;
            }
        }
    }
    let more = words.count();
    if more > 0 {
        return Err(place(h.channels.len() + more));
    }
    for q in &mut rotations[first..] {
        *q = q.normalize();
    }
    root.push(position);
    Ok(())
}
