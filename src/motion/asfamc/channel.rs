//! Orders of turns, and what the numbers of a bone say.

use glam::{Quat, Vec3};

use super::words::{bad, quoted};
use crate::{Error, Result};

/// The order in which turns about x (0), y (1) and z (2) are made, about axes that stay where they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turns(pub [usize; 3]);

impl Turns {
    fn parse(word: &str) -> Option<Self> {
        let axis = |c: char| "xyz".find(c.to_ascii_lowercase());
        let axes: Vec<usize> = word.chars().map(axis).collect::<Option<_>>()?;
        let order: [usize; 3] = axes.try_into().ok()?;
        ((1 << order[0]) | (1 << order[1]) | (1 << order[2]) == 0b111).then_some(Self(order))
    }

    /// The rotation of these angles (radians, by axis) in this order.
    pub fn rotation(self, angles: Vec3) -> Quat {
        self.0.into_iter().fold(Quat::IDENTITY, |q, axis| Quat::from_axis_angle(Vec3::AXES[axis], angles[axis]) * q)
    }
}

/// What one number of a bone's line in the AMC file says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channel {
    /// A turn about an axis.
    Rotation(usize),
    /// A shift along an axis; of the root only, other bones keep their rest lengths.
    Position(usize),
    /// A stretch, which is read and not used.
    Length,
}

impl Channel {
    fn parse(word: &str) -> Option<Self> {
        let (kind, axis) = word.split_at_checked(1)?;
        let axis = "xyz".find(&axis.to_ascii_lowercase()).filter(|_| axis.len() == 1);
        match (kind.to_ascii_lowercase().as_str(), axis) {
            ("r", Some(axis)) => Some(Self::Rotation(axis)),
            ("t", Some(axis)) => Some(Self::Position(axis)),
            ("l", None) if word.len() == 1 => Some(Self::Length),
            _ => None,
        }
    }
}

pub(super) fn channels(words: &[&str], line: usize) -> Result<Vec<Channel>> {
    if words.len() > 7 {
        return Err(bad(line, format!("expected at most 7 channels, found {}", words.len())));
    }
    let channel = |word: &&str| {
        let found = Channel::parse(word);
        found.ok_or_else(|| bad(line, format!("expected channels such as rx or TY, found {}", quoted(word))))
    };
    words.iter().map(channel).collect()
}

pub(super) fn turns(word: Option<&&str>, line: usize) -> Result<Turns> {
    let word = word.copied().unwrap_or_default();
    let found = Turns::parse(word);
    found.ok_or_else(|| {
        Error::invalid("ASF", format!("line {line}"), format!("expected an order such as XYZ, found {}", quoted(word)))
    })
}
