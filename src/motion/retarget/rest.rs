//! A rig at rest, whoever made it: names, parents, places. What matching and turning need to know of a skeleton.

use glam::{Quat, Vec3};

use crate::motion::{JointId, Skeleton};
use crate::{Error, Result};

/// A rig in its rest pose (a T-pose, an A-pose, anything upright), in any unit, facing anywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct RestRig {
    /// Names of the joints.
    pub names: Vec<String>,
    /// Parent of each joint; in any order, without circles.
    pub parents: Vec<Option<JointId>>,
    /// Place of each joint in the rest pose, in the space of the whole rig.
    pub places: Vec<Vec3>,
    /// Where a joint's bone ends if no child says so, as an offset in the space of the whole rig.
    pub tips: Vec<Option<Vec3>>,
}

impl RestRig {
    /// A rig from names, parents and rest places, e.g. of a glTF skin's joints (places: the translations of the
    /// inverses of its inverse bind matrices).
    ///
    /// # Errors
    /// Lists of different lengths, parents that do not exist or go round in circles, places that are not finite.
    pub fn new(names: Vec<String>, parents: Vec<Option<JointId>>, places: Vec<Vec3>) -> Result<Self> {
        let bad = |problem: String| Err(Error::invalid("rig", "joints", problem));
        let n = names.len();
        if parents.len() != n || places.len() != n {
            return bad(format!("expected {n} parents and places, found {} and {}", parents.len(), places.len()));
        }
        if let Some(j) = (0..n).find(|&j| parents[j].is_some_and(|p| p >= n)) {
            return bad(format!("'{}': expected a parent below {n}, found {:?}", names[j], parents[j]));
        }
        if let Some(j) = (0..n).find(|&j| !places[j].is_finite()) {
            return bad(format!("'{}': expected a finite place, found {}", names[j], places[j]));
        }
        let rig = Self { names, parents, places, tips: vec![None; n] };
        match (0..n).find(|&j| rig.up_from(j).count() > n) {
            Some(j) => bad(format!("'{}': its parents go round in a circle", rig.names[j])),
            None => Ok(rig),
        }
    }

    /// The rest pose of a skeleton: all rotations identity.
    pub fn of(skeleton: &Skeleton) -> Self {
        let mut globals = Vec::new();
        skeleton.globals(Vec3::ZERO, &vec![Quat::IDENTITY; skeleton.joints.len()], &mut globals);
        Self {
            names: skeleton.joints.iter().map(|j| j.name.clone()).collect(),
            parents: skeleton.joints.iter().map(|j| j.parent).collect(),
            places: globals.into_iter().map(|g| g.0).collect(),
            tips: skeleton.joints.iter().map(|j| j.tip).collect(),
        }
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// True without joints.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// The joint itself, its parent, and so on to the root; at most one more than there are joints.
    pub(super) fn up_from(&self, joint: JointId) -> impl Iterator<Item = JointId> + '_ {
        std::iter::successors(Some(joint), |&j| self.parents[j]).take(self.len() + 1)
    }

    /// Whether `joint` hangs, at any depth, from `from`.
    pub(super) fn hangs_from(&self, joint: JointId, from: JointId) -> bool {
        joint != from && self.up_from(joint).any(|j| j == from)
    }

    /// The joints strictly between `from` and `to`, which hangs from it, from the top down.
    pub(super) fn between(&self, from: JointId, to: JointId) -> Vec<JointId> {
        let mut path: Vec<JointId> = self.up_from(to).skip(1).take_while(|&j| j != from).collect();
        path.reverse();
        path
    }

    /// The deepest joint that two joints hang from, or are.
    pub(super) fn common(&self, a: JointId, b: JointId) -> Option<JointId> {
        self.up_from(a).find(|&j| self.up_from(b).any(|k| k == j))
    }

    /// Length of the bone between two joints at rest.
    pub(super) fn length(&self, a: JointId, b: JointId) -> f32 {
        self.places[a].distance(self.places[b])
    }

    /// Rest direction and length of a joint's bone: to its farthest descendant among children and children of
    /// zero-length children (a hand's longest finger), or its tip.
    pub(super) fn bone(&self, joint: JointId) -> Vec3 {
        let mut best = self.tips[joint].unwrap_or(Vec3::ZERO);
        let mut here = vec![joint];
        while let Some(parent) = here.pop() {
            for child in (0..self.len()).filter(|&j| self.parents[j] == Some(parent)) {
                let offset = self.places[child] - self.places[parent];
                if offset == Vec3::ZERO {
                    here.push(child);
                } else if offset.length() > best.length() {
                    best = offset;
                }
            }
        }
        best
    }
}
