//! The HIERARCHY part of a BVH file: joints, offsets, channels. Depth costs no call stack.

use glam::Vec3;

use crate::motion::{Joint, JointId, Skeleton};
use crate::{Error, Result};

/// What one number of a frame's line says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channel {
    /// A coordinate (0 = x, 1 = y, 2 = z) of the joint's position.
    Position(usize),
    /// A turn in degrees about an axis (0 = x, 1 = y, 2 = z).
    Rotation(usize),
}

/// A numbered line of the file.
pub(super) type Line<'a> = (usize, &'a str);

/// The joints and, in file order, whose channel each number of a frame is.
pub(super) struct Hierarchy {
    pub skeleton: Skeleton,
    pub channels: Vec<(JointId, Channel)>,
}

/// An error of the reader at a line; lines count from 1.
pub(super) fn bad(line: usize, problem: impl Into<String>) -> Error {
    Error::invalid("BVH", format!("line {line}"), problem)
}

/// Text for a message, cut to a length that fits one.
pub(super) fn quoted(text: &str) -> String {
    let short: String = text.chars().take(40).collect();
    if short.len() < text.len() { format!("'{short}...'") } else { format!("'{short}'") }
}

/// The words up to `MOTION`, with their line numbers.
struct Words<'a, L: Iterator<Item = Line<'a>>> {
    lines: L,
    words: std::str::SplitWhitespace<'a>,
    line: usize,
}

impl<'a, L: Iterator<Item = Line<'a>>> Words<'a, L> {
    fn next(&mut self, expected: &str) -> Result<&'a str> {
        loop {
            if let Some(word) = self.words.next() {
                return Ok(word);
            }
            let Some((line, text)) = self.lines.next() else {
                return Err(bad(self.line, format!("expected {expected}, found the end of the file")));
            };
            (self.line, self.words) = (line, text.split_whitespace());
        }
    }

    fn expect(&mut self, word: &str) -> Result<()> {
        let found = self.next(word)?;
        if found.eq_ignore_ascii_case(word) {
            return Ok(());
        }
        Err(bad(self.line, format!("expected {word}, found {}", quoted(found))))
    }

    /// A joint's name: all words up to the opening brace.
    fn name(&mut self) -> Result<String> {
        let mut name = String::new();
        loop {
            let word = self.next("a joint's name and {")?;
            let last = word.ends_with('{');
            let part = word.trim_end_matches('{');
            if !part.is_empty() {
                name += if name.is_empty() { "" } else { " " };
                name += part;
            }
            match (last, name.is_empty()) {
                (true, true) => return Err(bad(self.line, "expected a joint's name, found {")),
                (true, false) => return Ok(name),
                _ => {}
            }
        }
    }

    fn vector(&mut self) -> Result<Vec3> {
        let mut v = Vec3::ZERO;
        for i in 0..3 {
            v[i] = number(self.next("an offset of 3 numbers")?, self.line)?;
        }
        Ok(v)
    }
}

/// A finite number.
pub(super) fn number(word: &str, line: usize) -> Result<f32> {
    match word.parse::<f32>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(bad(line, format!("expected a finite number, found {}", quoted(word)))),
    }
}

/// Reads up to and including the word `MOTION`; `lines` then stands at the line after it.
pub(super) fn read<'a>(lines: &mut impl Iterator<Item = Line<'a>>) -> Result<Hierarchy> {
    let mut words = Words { lines, words: "".split_whitespace(), line: 1 };
    words.expect("HIERARCHY")?;
    words.expect("ROOT")?;
    let mut hierarchy = Hierarchy { skeleton: Skeleton { joints: Vec::new() }, channels: Vec::new() };
    let mut open = vec![hierarchy.add(words.name()?, None)];
    while let Some(&joint) = open.last() {
        match words.next("OFFSET, CHANNELS, JOINT, End Site or }")? {
            word if word.eq_ignore_ascii_case("OFFSET") => hierarchy.skeleton.joints[joint].offset = words.vector()?,
            word if word.eq_ignore_ascii_case("CHANNELS") => hierarchy.read_channels(&mut words, joint)?,
            word if word.eq_ignore_ascii_case("JOINT") => open.push(hierarchy.add(words.name()?, Some(joint))),
            word if word.eq_ignore_ascii_case("End") => hierarchy.read_end(&mut words, joint)?,
            "}" => drop(open.pop()),
            word => {
                let expected = "expected OFFSET, CHANNELS, JOINT, End Site or }";
                return Err(bad(words.line, format!("{expected}, found {}", quoted(word))));
            }
        }
    }
    words.expect("MOTION")?;
    hierarchy.check(words.line)?;
    Ok(hierarchy)
}

impl Hierarchy {
    fn add(&mut self, name: String, parent: Option<JointId>) -> JointId {
        self.skeleton.joints.push(Joint { name, parent, offset: Vec3::ZERO, tip: None });
        self.skeleton.joints.len() - 1
    }

    fn read_channels<'a>(&mut self, words: &mut Words<'a, impl Iterator<Item = Line<'a>>>, joint: usize) -> Result<()> {
        let word = words.next("a number of channels")?;
        // No joint has more than three positions and three rotations, so a huge count is refused before it is used.
        let count = word.parse::<usize>().ok().filter(|&n| n <= 6);
        let count =
            count.ok_or_else(|| bad(words.line, format!("expected 0 to 6 channels, found {}", quoted(word))))?;
        if self.channels.iter().rev().take(1).any(|&(of, _)| of == joint) {
            let name = &self.skeleton.joints[joint].name;
            return Err(bad(words.line, format!("expected one CHANNELS of joint {}, found another", quoted(name))));
        }
        for _ in 0..count {
            let word = words.next("a channel")?;
            let channel = match word.to_ascii_lowercase().as_str() {
                "xposition" => Channel::Position(0),
                "yposition" => Channel::Position(1),
                "zposition" => Channel::Position(2),
                "xrotation" => Channel::Rotation(0),
                "yrotation" => Channel::Rotation(1),
                "zrotation" => Channel::Rotation(2),
                _ => {
                    let expected = "expected a channel such as Xposition or Zrotation";
                    return Err(bad(words.line, format!("{expected}, found {}", quoted(word))));
                }
            };
            self.channels.push((joint, channel));
        }
        Ok(())
    }

    fn read_end<'a>(&mut self, words: &mut Words<'a, impl Iterator<Item = Line<'a>>>, joint: usize) -> Result<()> {
        words.expect("Site")?;
        words.expect("{")?;
        words.expect("OFFSET")?;
        let tip = words.vector()?;
        self.skeleton.joints[joint].tip.get_or_insert(tip);
        words.expect("}")
    }

    /// A root that can be moved, and no flood of joints without channels (memory stays in proportion to the input).
    fn check(&self, line: usize) -> Result<()> {
        let name = &self.skeleton.joints[0].name;
        for axis in 0..3 {
            if !self.channels.contains(&(0, Channel::Position(axis))) {
                let missing = ["Xposition", "Yposition", "Zposition"][axis];
                return Err(bad(line, format!("root {}: expected a channel {missing}, found none", quoted(name))));
            }
        }
        if !self.channels.iter().any(|&(joint, c)| joint == 0 && matches!(c, Channel::Rotation(_))) {
            return Err(bad(line, format!("root {}: expected rotation channels, found none", quoted(name))));
        }
        let joints = self.skeleton.joints.len();
        if joints > 4 * self.channels.len() {
            let found = format!("{joints} joints with {} channels in all", self.channels.len());
            return Err(bad(line, format!("expected channels on the joints, found {found}")));
        }
        Ok(())
    }
}
