//! The AMC file: numbered frames, in each a line per bone that moves. Frames are read in parallel.

use std::collections::BTreeMap;

use glam::{Quat, Vec3};
use rayon::prelude::*;

use super::asf::{Bone, Figure};
use super::channel::Channel;
use super::words::{quoted, text};
use crate::motion::{Clip, JointId};
use crate::{Error, Result};

fn bad(line: usize, problem: impl Into<String>) -> Error {
    Error::invalid("AMC", format!("line {line}"), problem)
}

/// Reads the bytes of an AMC file that moves `figure`; the clip is in the figure's units. O(numbers in the file).
///
/// A bone's angles are meant in the frame of its axis; the clip's rotations are meant in the world's, where they are
/// all identity at rest. Shifts and stretches of bones other than the root are read and not used.
///
/// # Errors
/// One message with the line: not text, frames that do not count up one by one, a bone that is unknown, missing, there
/// twice or has too few or too many numbers, a number that is not finite.
pub fn read(figure: &Figure, bytes: &[u8]) -> Result<Clip> {
    let text = text(bytes, "AMC")?;
    let (frames, degrees) = split(text)?;
    let reader = Reader::new(figure, degrees, &frames[0]);
    let joints = figure.bones.len();
    // A frame too short to name its bones is bad: it is read last and alone, lest it takes memory for nothing.
    let whole = frames.iter().position(|f| f.text.len() < reader.shortest).unwrap_or(frames.len());
    let mut root = vec![Vec3::ZERO; whole];
    let mut rotations = vec![Quat::IDENTITY; whole * joints];
    let poses = rotations.par_chunks_mut(joints).zip(&mut root).zip(&frames);
    let wrong = poses.map(|((pose, root), frame)| reader.frame(frame, pose, root)).find_map_first(Result::err);
    if let Some(error) = wrong {
        return Err(error);
    }
    if let Some(short) = frames.get(whole) {
        let (mut pose, mut root) = (vec![Quat::IDENTITY; joints], Vec3::ZERO);
        reader.frame(short, &mut pose, &mut root)?;
    }
    Ok(Clip { name: String::new(), skeleton: figure.skeleton.clone(), fps: super::FPS, root, rotations })
}

/// The text of one frame, from the line after its number.
struct Frame<'a> {
    number: u64,
    line: usize,
    text: &'a str,
}

/// The frames, and whether the header says degrees (or radians, or neither).
fn split(text: &str) -> Result<(Vec<Frame<'_>>, Option<bool>)> {
    let mut frames: Vec<Frame> = Vec::new();
    let (mut degrees, mut starts, mut at) = (None, Vec::new(), 0);
    for (i, line) in text.split_inclusive('\n').enumerate() {
        let begin = at;
        at += line.len();
        let first = line.trim_start().bytes().next();
        if first.is_some_and(|b| b.is_ascii_digit()) {
            let number = frame_number(line.trim(), i + 1)?;
            if let Some(before) = frames.last().filter(|f| f.number.checked_add(1) != Some(number)) {
                let problem = format!("expected frame {}, found {number}", before.number.saturating_add(1));
                return Err(bad(i + 1, problem));
            }
            frames.push(Frame { number, line: i + 1, text: "" });
            starts.push((begin, at));
        } else if frames.is_empty() {
            degrees = header(line.trim(), i + 1)?.or(degrees);
        }
    }
    if frames.is_empty() {
        return Err(bad(text.lines().count().max(1), "expected frames, found the end of the file"));
    }
    let ends = starts.iter().skip(1).map(|s| s.0).chain([text.len()]);
    for ((frame, start), end) in frames.iter_mut().zip(&starts).zip(ends) {
        frame.text = &text[start.1..end];
    }
    Ok((frames, degrees))
}

fn frame_number(word: &str, line: usize) -> Result<u64> {
    word.parse().map_err(|_| bad(line, format!("expected a frame's number alone, found {}", quoted(word))))
}

fn header(line: &str, at: usize) -> Result<Option<bool>> {
    match line.to_ascii_lowercase().as_str() {
        ":degrees" => Ok(Some(true)),
        ":radians" => Ok(Some(false)),
        other if other.is_empty() || other.starts_with(['#', ':']) => Ok(None),
        _ => Err(bad(at, format!("expected a header or the number of the first frame, found {}", quoted(line)))),
    }
}

/// What does not change from frame to frame.
struct Reader<'a> {
    figure: &'a Figure,
    radians: f32,
    by_name: BTreeMap<&'a str, JointId>,
    /// The bones in the order of the first frame, which is nearly always that of all.
    usual: Vec<JointId>,
    moving: usize,
    shortest: usize,
}

impl<'a> Reader<'a> {
    fn new(figure: &'a Figure, degrees: Option<bool>, first: &Frame) -> Self {
        let joints = &figure.skeleton.joints;
        let by_name: BTreeMap<&str, JointId> = joints.iter().enumerate().map(|(i, j)| (j.name.as_str(), i)).collect();
        let words = first.text.lines().filter_map(|line| line.split_ascii_whitespace().next());
        let usual = words.filter_map(|word| by_name.get(word).copied()).collect();
        let radians = degrees.map_or(figure.radians, |degrees| if degrees { 1f32.to_radians() } else { 1.0 });
        let moves = |bone: &&Bone| !bone.channels.is_empty();
        let moving = figure.bones.iter().filter(moves).count();
        // Per bone its name and a line end, per number a space and a digit.
        let shortest = joints.iter().zip(&figure.bones).filter(|(_, bone)| moves(bone));
        let shortest = shortest.map(|(joint, bone)| joint.name.len() + 2 * bone.channels.len()).sum();
        Self { figure, radians, by_name, usual, moving, shortest }
    }

    fn frame(&self, frame: &Frame, pose: &mut [Quat], root: &mut Vec3) -> Result<()> {
        // Which bones are there, and whether one is there twice.
        let mut seen = vec![false; pose.len()];
        let mut moved = 0;
        for (i, line) in frame.text.lines().enumerate() {
            let line = line.split('#').next().unwrap_or_default().trim();
            let Some((name, numbers)) = split_name(line) else { continue };
            let at = frame.line + 1 + i;
            let joint = self.joint(name, moved).ok_or_else(|| {
                let problem = format!("frame {}: expected a bone of the ASF file", frame.number);
                bad(at, format!("{problem}, found {}", quoted(name)))
            })?;
            if std::mem::replace(&mut seen[joint], true) {
                let problem = format!("frame {}: expected {} once, found it again", frame.number, quoted(name));
                return Err(bad(at, problem));
            }
            pose[joint] = self.bone(joint, numbers, at, root)?;
            moved += usize::from(!self.figure.bones[joint].channels.is_empty());
        }
        if moved == self.moving {
            return Ok(());
        }
        let missing = (0..pose.len()).find(|&j| !seen[j] && !self.figure.bones[j].channels.is_empty());
        let name = missing.map_or("", |j| self.figure.skeleton.joints[j].name.as_str());
        Err(bad(frame.line, format!("frame {}: expected a line for {}, found none", frame.number, quoted(name))))
    }

    /// The joint called `name`, which probably is the one at this place in the usual order.
    fn joint(&self, name: &str, place: usize) -> Option<JointId> {
        let usual = self.usual.get(place).copied();
        let is_it = |&joint: &JointId| self.figure.skeleton.joints[joint].name == name;
        usual.filter(is_it).or_else(|| self.by_name.get(name).copied())
    }

    fn bone(&self, joint: JointId, numbers: &str, line: usize, root: &mut Vec3) -> Result<Quat> {
        let bone = &self.figure.bones[joint];
        let mut words = numbers.split_ascii_whitespace();
        let (mut angles, mut shift) = (Vec3::ZERO, Vec3::ZERO);
        let count = |found: usize| {
            let name = quoted(&self.figure.skeleton.joints[joint].name);
            bad(line, format!("{name}: expected {} numbers, found {found}", bone.channels.len()))
        };
        for (i, channel) in bone.channels.iter().enumerate() {
            let word = words.next().ok_or_else(|| count(i))?;
            let value = word.parse::<f32>().ok().filter(|v| v.is_finite());
            let value = value.ok_or_else(|| bad(line, format!("expected a finite number, found {}", quoted(word))))?;
            match *channel {
                Channel::Rotation(axis) => angles[axis] = value * self.radians,
                Channel::Position(axis) => shift[axis] = value,
                Channel::Length => {}
            }
        }
        let more = words.count();
        if more > 0 {
            return Err(count(bone.channels.len() + more));
        }
        if joint == 0 {
            *root = self.figure.position + shift;
        }
        Ok((bone.axis * bone.turns.rotation(angles) * bone.axis.inverse()).normalize())
    }
}

/// A bone's name and the numbers after it.
fn split_name(line: &str) -> Option<(&str, &str)> {
    let end = line.find(|c: char| c.is_ascii_whitespace()).unwrap_or(line.len());
    (end > 0).then(|| line.split_at(end))
}
