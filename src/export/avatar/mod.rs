//! Somebody's own character: a skinned humanoid from a GLB file, which plays people of a crowd.
//!
//! The joints are told by [`match_rig`], the rest pose may be a T-pose, an A-pose or anything upright, of any size and
//! facing anywhere. Meshes, skins, materials and pictures come along; the character's own animations do not.
//!
//! The file's nodes are looked at first ([`nodes`]), then everything that is seen is followed from them
//! ([`tailor`]): it is checked and kept in the form ([`outfit`]) in which it is written ([`graft`]).

mod graft;
mod material;
mod nodes;
mod outfit;
mod picture;
mod play;
mod sole;
mod tailor;
mod vertices;

use std::path::Path;

use glam::{Quat, Vec3};
use gltf_json::Root;

use super::actor::{Bone, Dress};
use crate::gltf::{Data, Tables, bad, open, version};
use crate::motion::JOINT_COUNT;
use crate::motion::retarget::{RestRig, match_rig, rest_turns};
use crate::{Error, Result};
use nodes::Parts;
use outfit::Outfit;

/// Lengths that legs may have in the file's unit, be it a micrometre or a thousand kilometres.
const LEGS: std::ops::RangeInclusive<f32> = 1e-6..=1e6;

/// A character made ready to play people.
#[derive(Debug)]
pub struct Avatar {
    outfit: Outfit,
    /// Its bones; the first one stands for the character's size.
    bones: Vec<Bone>,
    /// Global rest transforms of the bones at size 1.
    rest: Vec<(Vec3, Quat)>,
    /// The bone that plays each canonical joint.
    plays: [Option<usize>; JOINT_COUNT],
    /// `rig_from_canonical` of each canonical joint; see [`rest_turns`].
    turns: [Quat; JOINT_COUNT],
    /// Length of thigh and shin together, mean of both legs, in the file's unit.
    leg: f32,
    /// Height of the ankles over the soles, in the file's unit.
    ankle: f32,
}

/// An avatar's meshes in a file in the making.
pub(super) struct Graft {
    /// Skinned meshes.
    pub dresses: Vec<Dress>,
    /// The bones with their stiff parts.
    bones: Vec<Bone>,
}

impl Avatar {
    /// Reads a character from a `.glb` file.
    ///
    /// # Errors
    /// As [`Self::open`]; or the file cannot be read.
    pub fn load(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
        Self::open(&bytes).map_err(|e| e.in_file(path))
    }

    /// A character from the bytes of a GLB file.
    ///
    /// # Errors
    /// Not a whole GLB with its own data, no skinned mesh, joints that are scaled unevenly, or no humanoid: names the
    /// joints that are missing.
    pub fn open(bytes: &[u8]) -> Result<Self> {
        if !bytes.starts_with(b"glTF") {
            return Err(bad("byte 0", "expected a binary glTF file (.glb), found something else"));
        }
        let (json, binary) = open::<Root>(bytes)?;
        version(&json.asset)?;
        if !json.extensions_required.is_empty() {
            let names = json.extensions_required.join(", ");
            return Err(bad("extensionsRequired", format!("expected plain glTF 2.0, found {names}; export without")));
        }
        let parts = Parts::of(&json)?;
        let bones = parts.bones(&json)?;
        let rest: Vec<(Vec3, Quat)> =
            nodes::frames(&bones).iter().map(|(f, turn)| (f.translation.into(), *turn)).collect();
        // Bone 0 is the size, which is no joint of theirs.
        let places: Vec<Vec3> = rest[1..].iter().map(|r| r.0).collect();
        let parents = bones[1..].iter().map(|b| b.parent.and_then(|p| p.checked_sub(1))).collect();
        let rig = RestRig::new(parts.names(&json), parents, places)?;
        let found = match_rig(&rig)?;
        let turns = rest_turns(&rig, &found);
        let plays = found.joints.map(|joint| joint.map(|j| j + 1));
        let tables = Tables { accessors: &json.accessors, views: &json.buffer_views, buffers: &json.buffers };
        let outfit = tailor::dress(&json, Data::new(tables, binary, bytes.len(), None), &parts)?;
        let mut avatar = Self { outfit, bones, rest, plays, turns, leg: 0.0, ankle: 0.0 };
        avatar.measure()?;
        Ok(avatar)
    }

    /// Finds out how long its legs are and how high its ankles.
    fn measure(&mut self) -> Result<()> {
        let leg = play::LEGS.map(|[up, low, foot]| {
            let at = |j: usize| self.plays[j].map_or(Vec3::NAN, |b| self.rest[b].0);
            at(up).distance(at(low)) + at(low).distance(at(foot))
        });
        self.leg = 0.5 * (leg[0] + leg[1]);
        if !LEGS.contains(&self.leg) {
            return Err(bad("skeleton", format!("expected legs with a length, found {}", self.leg)));
        }
        let up = self.turns[0] * Vec3::Y;
        let ankles = play::LEGS.map(|[_, _, foot]| self.plays[foot].map_or(f32::NAN, |b| self.rest[b].0.dot(up)));
        let sole = sole::lowest(&self.outfit, &self.bones, up);
        if !sole.is_finite() {
            return Err(bad("meshes", format!("expected vertices in the scene, found some at {sole}")));
        }
        self.ankle = (0.5 * (ankles[0] + ankles[1]) - sole).clamp(0.0, 0.5 * self.leg);
        Ok(())
    }
}
