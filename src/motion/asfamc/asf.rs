//! The ASF file: bones with their directions, lengths, axes and degrees of freedom, and the tree they form.

use std::collections::BTreeMap;

use glam::{Quat, Vec3};

use super::channel::{Channel, Turns, channels, turns};
use super::words::{Line, bad, number, quoted, text, vector};
use crate::Result;
use crate::motion::{Joint, Skeleton};

/// One bone; its joint is where it begins.
#[derive(Clone, Debug, PartialEq)]
pub struct Bone {
    pub(super) channels: Vec<Channel>,
    /// Order of turns of both the axis and the motion.
    pub(super) turns: Turns,
    /// The frame in which the motion's angles are meant.
    pub(super) axis: Quat,
}

/// What an ASF file says.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The joints in the file's units, each named after the bone that begins there.
    pub skeleton: Skeleton,
    /// The bones, by joint.
    pub bones: Vec<Bone>,
    /// Where the root is when its shift is zero.
    pub position: Vec3,
    /// Radians per unit of the motion's angles, unless the AMC file says otherwise.
    pub radians: f32,
    /// Metres per unit, where the header's number is CMU's: 0.45 units are an inch.
    pub metres_per_unit: Option<f32>,
}

/// Reads the bytes of an ASF file. O(bytes).
///
/// # Errors
/// One message with the line: not text, no bones, an unknown or doubled bone, an unknown channel or axis order, a
/// number that is not finite, a tree that does not hang together.
pub fn read(bytes: &[u8]) -> Result<Figure> {
    let mut draft = Draft::new();
    let mut section = String::new();
    let mut last = 1;
    for (i, line) in text(bytes, "ASF")?.lines().enumerate() {
        let words: Vec<&str> = line.split('#').next().unwrap_or_default().split_whitespace().collect();
        let Some(&first) = words.first() else { continue };
        last = i + 1;
        if first.starts_with(':') {
            section = first.to_ascii_lowercase();
        } else {
            draft.line(&section, (last, words))?;
        }
    }
    draft.finish(last)
}

/// A bone as it stands in the file.
struct RawBone {
    name: String,
    line: usize,
    direction: Vec3,
    length: f32,
    angles: Vec3,
    turns: Turns,
    channels: Vec<Channel>,
}

impl RawBone {
    fn new(line: usize, name: &str) -> Self {
        let turns = Turns([0, 1, 2]);
        let (direction, angles) = (Vec3::ZERO, Vec3::ZERO);
        Self { name: name.into(), line, direction, length: 0.0, angles, turns, channels: Vec::new() }
    }
}

/// The file read so far. Bone 0 is the root.
struct Draft {
    bones: Vec<RawBone>,
    by_name: BTreeMap<String, usize>,
    parents: Vec<Option<usize>>,
    children: Vec<Vec<usize>>,
    position: Vec3,
    radians: f32,
    length: Option<f32>,
    open: Option<RawBone>,
}

impl Draft {
    fn new() -> Self {
        let mut root = RawBone::new(1, "root");
        root.channels = [Channel::Position, Channel::Rotation].iter().flat_map(|c| (0..3).map(c)).collect();
        Self {
            bones: vec![root],
            by_name: BTreeMap::from([("root".into(), 0)]),
            parents: Vec::new(),
            children: Vec::new(),
            position: Vec3::ZERO,
            radians: 1f32.to_radians(),
            length: None,
            open: None,
        }
    }

    fn line(&mut self, section: &str, line: Line) -> Result<()> {
        match section {
            ":units" => self.unit(line),
            ":root" => self.root(line),
            ":bonedata" => self.bone(line),
            ":hierarchy" => self.branch(line),
            _ => Ok(()),
        }
    }

    fn unit(&mut self, (at, words): Line) -> Result<()> {
        match words[0].to_ascii_lowercase().as_str() {
            "length" => self.length = Some(number(words.get(1), at, "a length")?),
            "angle" => {
                self.radians = match words.get(1).map(|w| w.to_ascii_lowercase()).as_deref() {
                    Some("deg" | "degrees") => 1f32.to_radians(),
                    Some("rad" | "radians") => 1.0,
                    other => {
                        let found = other.map_or("the end of the line".into(), quoted);
                        return Err(bad(at, format!("expected angle deg or rad, found {found}")));
                    }
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn root(&mut self, (at, words): Line) -> Result<()> {
        let root = &mut self.bones[0];
        match words[0].to_ascii_lowercase().as_str() {
            "order" => root.channels = channels(&words[1..], at)?,
            "axis" => root.turns = turns(words.get(1), at)?,
            "position" => self.position = vector(&words[1..], at)?,
            "orientation" => root.angles = vector(&words[1..], at)?,
            word => {
                return Err(bad(at, format!("expected order, axis, position or orientation, found {}", quoted(word))));
            }
        }
        Ok(())
    }

    fn bone(&mut self, (at, words): Line) -> Result<()> {
        let word = words[0].to_ascii_lowercase();
        let Some(bone) = &mut self.open else {
            if word != "begin" {
                return Err(bad(at, format!("expected begin, found {}", quoted(words[0]))));
            }
            self.open = Some(RawBone::new(at, ""));
            return Ok(());
        };
        match word.as_str() {
            "name" => bone.name = words[1..].join(" "),
            "direction" => bone.direction = vector(&words[1..], at)?,
            "length" => bone.length = number(words.get(1), at, "a length")?,
            "axis" => {
                bone.angles = vector(&words[1..], at)?;
                bone.turns = turns(words.get(4), at)?;
            }
            "dof" => bone.channels = channels(&words[1..], at)?,
            "end" => self.close(at)?,
            // Limits, masses and whatever else a bone may say.
            _ => {}
        }
        Ok(())
    }

    fn close(&mut self, at: usize) -> Result<()> {
        let Some(bone) = self.open.take() else { return Ok(()) };
        if bone.name.is_empty() {
            return Err(bad(at, "expected a bone's name, found end"));
        }
        if self.by_name.insert(bone.name.clone(), self.bones.len()).is_some() {
            return Err(bad(at, format!("expected one bone {}, found another", quoted(&bone.name))));
        }
        self.bones.push(bone);
        Ok(())
    }

    /// A line of the tree: a bone and its children.
    fn branch(&mut self, (at, words): Line) -> Result<()> {
        if ["begin", "end"].iter().any(|w| words[0].eq_ignore_ascii_case(w)) && words.len() == 1 {
            return Ok(());
        }
        self.parents.resize(self.bones.len(), None);
        self.children.resize(self.bones.len(), Vec::new());
        let known = |word: &str| {
            let found = self.by_name.get(word).copied();
            found.ok_or_else(|| bad(at, format!("expected a bone of :bonedata, found {}", quoted(word))))
        };
        let ids = words.iter().map(|word| known(word)).collect::<Result<Vec<_>>>()?;
        for (&child, word) in ids.iter().zip(&words).skip(1) {
            if child == 0 || self.parents[child].replace(ids[0]).is_some() {
                return Err(bad(at, format!("expected one parent of {}, found another", quoted(word))));
            }
            self.children[ids[0]].push(child);
        }
        Ok(())
    }

    /// The bones from the root on, parents first.
    fn order(&self, last: usize) -> Result<Vec<usize>> {
        if self.bones.len() < 2 || self.children.is_empty() {
            return Err(bad(last, "expected :bonedata and :hierarchy, found the end of the file"));
        }
        let mut order = Vec::with_capacity(self.bones.len());
        let mut stack = vec![0];
        while let Some(bone) = stack.pop() {
            order.push(bone);
            stack.extend(self.children.get(bone).into_iter().flatten().rev());
        }
        if order.len() == self.bones.len() {
            return Ok(order);
        }
        let mut reached = vec![false; self.bones.len()];
        order.iter().for_each(|&bone| reached[bone] = true);
        let lost = reached.iter().position(|&r| !r).unwrap_or_default();
        let (line, name) = (self.bones[lost].line, quoted(&self.bones[lost].name));
        Err(bad(line, format!("expected bone {name} to hang from the root in :hierarchy, found no way to it")))
    }

    fn finish(self, last: usize) -> Result<Figure> {
        let order = self.order(last)?;
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(i, &bone)| place[bone] = i);
        let (mut joints, mut bones) = (Vec::new(), Vec::new());
        for &id in &order {
            let bone = &self.bones[id];
            let parent = self.parents[id];
            // A bone begins where its parent ends; the root has no length.
            let offset = parent.map_or(Vec3::ZERO, |p| self.bones[p].vector());
            let leaf = self.children[id].is_empty();
            let (name, parent) = (bone.name.clone(), parent.map(|p| place[p]));
            joints.push(Joint { name, parent, offset, tip: leaf.then(|| bone.vector()) });
            let axis = bone.turns.rotation(bone.angles * self.radians);
            bones.push(Bone { channels: bone.channels.clone(), turns: bone.turns, axis });
        }
        check(&bones, last)?;
        let metres_per_unit = self.length.filter(|&l| (l - 0.45).abs() < 1e-6).map(|_| 0.0254 / 0.45);
        let skeleton = Skeleton { joints };
        Ok(Figure { skeleton, bones, position: self.position, radians: self.radians, metres_per_unit })
    }
}

impl RawBone {
    fn vector(&self) -> Vec3 {
        self.direction.normalize_or_zero() * self.length
    }
}

/// No flood of bones without channels: memory stays in proportion to the AMC file.
fn check(bones: &[Bone], line: usize) -> Result<()> {
    let channels: usize = bones.iter().map(|b| b.channels.len()).sum();
    if bones.len() > 4 * channels {
        let found = format!("{} bones with {channels} channels in all", bones.len());
        return Err(bad(line, format!("expected degrees of freedom of the bones, found {found}")));
    }
    if !bones[0].channels.iter().any(|c| matches!(c, Channel::Position(_))) {
        return Err(bad(line, "root: expected an order with TX TY TZ, found none of them"));
    }
    Ok(())
}
