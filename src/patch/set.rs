//! The patch set: the patch kinds to tile with.

use super::PatchProp;
use super::study::Study;
use crate::motion::{BodyPart, Motion};

/// A group of full-body poses close enough to pass from one to another smoothly (paper section 4.2).
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PoseGroup {
    /// Name, e.g. `stand`, `walk_left`.
    pub name: String,
}

/// One person's part in a patch. Its first frame is the entry, its last the exit.
#[derive(Clone, Debug, PartialEq)]
pub struct Fragment {
    /// The motion, in the patch's own frame.
    pub motion: Motion,
    /// Frame of the patch's clock at which this fragment begins.
    pub begin: u32,
    /// Pose group of the entry.
    pub entry_group: u32,
    /// Pose group of the exit.
    pub exit_group: u32,
}

/// One side of a contact.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Touch {
    /// Index of the fragment.
    pub role: u32,
    /// With what.
    pub part: BodyPart,
}

/// An interpersonal constraint: over its frames the two people's relative placement and timing must stay as captured.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Contact {
    /// One side.
    pub a: Touch,
    /// The other.
    pub b: Touch,
    /// First frame on the patch's clock.
    pub begin: u32,
    /// Last frame, inclusive.
    pub end: u32,
}

/// A motion patch that instances are made of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatchKind {
    /// Unique name.
    pub name: String,
    /// Free words.
    pub labels: Vec<String>,
    /// The people's motion; all in one frame and on one clock.
    pub fragments: Vec<Fragment>,
    /// Who touches whom.
    pub contacts: Vec<Contact>,
    /// First and last frame of the interaction on the patch's clock, over which relative placement must not change.
    pub core: Option<(u32, u32)>,
    /// Boxes that somebody holds.
    pub props: Vec<PatchProp>,
    /// Made from another kind by mirroring.
    pub mirrored: bool,
}

impl PatchKind {
    /// Number of people.
    pub fn people(&self) -> usize {
        self.fragments.len()
    }
}

/// The patch kinds to tile with, on the canonical skeleton, at [`crate::motion::FPS`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatchSet {
    /// The pose groups of all ports.
    pub groups: Vec<PoseGroup>,
    /// The kinds.
    pub kinds: Vec<PatchKind>,
    /// What was found out about them beforehand, if anything; to be left out or found anew when kinds change.
    pub study: Option<Study>,
}

impl PatchSet {
    /// The set with only some of its kinds.
    pub fn only(&self, used: impl Fn(&PatchKind) -> bool) -> Self {
        let mut left = 0..;
        let index: Vec<Option<u32>> =
            self.kinds.iter().map(|kind| used(kind).then(|| left.next().expect("endless"))).collect();
        let kinds = self.kinds.iter().zip(&index).filter(|(_, there)| there.is_some()).map(|(kind, _)| kind.clone());
        let study = self.study.as_ref().map(|study| study.of_some(&index));
        Self { groups: self.groups.clone(), kinds: kinds.collect(), study }
    }
}
