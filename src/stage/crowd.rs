//! The finished crowd and its playback.

use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};

use super::Prop;
use crate::geom::{Gate, Obstacle, Periodic, Polygon, Torus};
use crate::motion::{Build, FPS, JOINT_COUNT, Skeleton};
use crate::patch::PatchSet;

/// Where and how long the crowd lives.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct DomainInfo {
    /// Everybody stays inside.
    pub region: Polygon,
    /// Everybody stays out.
    pub obstacles: Vec<Obstacle>,
    /// Where people may come in after the first frame.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<Gate>,
    /// Where they may go out before the last.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sinks: Vec<Gate>,
    /// The crowd lives from frame 0 to this frame, inclusive; the time is open at both ends (cropped), unless it repeats:
    /// then this frame is the first one again.
    pub last_frame: u32,
    /// In which directions the crowd repeats: along x and z with the region, a rectangle; in time with the last frame.
    /// People's places go on as they are where they cross a border.
    #[serde(default, skip_serializing_if = "Periodic::none")]
    pub periodic: Periodic,
    /// Names of the teams.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub teams: Vec<String>,
}

impl DomainInfo {
    /// What is the same place.
    pub fn torus(&self) -> Torus {
        let (low, high) = self.region.bounds();
        Torus::new(low, high, self.periodic)
    }
}

/// A placed patch.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Instance {
    /// Index of its kind in the set.
    pub kind: u32,
}

/// One fragment of an instance in the life of a character: the role it plays, and the deformed motion path.
#[derive(Clone, Debug, PartialEq)]
pub struct FragmentUse {
    /// Index of the instance.
    pub instance: u32,
    /// Index of the fragment in the kind.
    pub role: u32,
    /// Frame of the entry; negative where the crowd's first frame crops it.
    pub begin: i32,
    /// Frame of the exit; the source's frames are spread evenly between the two. The next fragment begins here.
    pub end: i32,
    /// The deformed path's ground points, one per *source* frame.
    pub points: Vec<Vec2>,
    /// The deformed path's headings (unwrapped), one per source frame.
    pub headings: Vec<f32>,
}

/// One person: a chain of fragments, and the final full-body motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Character {
    /// First frame of the final motion.
    pub begin: u32,
    /// Bones and flesh: what the rotations turn.
    pub build: Arc<Build>,
    /// Index of the team, if of one.
    pub team: Option<u32>,
    /// The fragments in order; each begins where the one before ends.
    pub fragments: Vec<FragmentUse>,
    /// Hips position per frame.
    pub root: Vec<Vec3>,
    /// Rotations, frame-major, hips' global, others local.
    pub rotations: Vec<Quat>,
}

impl Character {
    /// Number of frames of the final motion.
    pub fn frames(&self) -> usize {
        self.root.len()
    }

    /// Last frame, inclusive.
    pub fn end(&self) -> u32 {
        self.begin + self.frames().saturating_sub(1) as u32
    }

    /// True while the person is there.
    pub fn present(&self, frame: u32) -> bool {
        self.begin <= frame && frame <= self.end()
    }

    /// Rotations of all joints at frame `index` of the person's own motion.
    pub fn pose(&self, index: usize) -> &[Quat] {
        &self.rotations[index * JOINT_COUNT..(index + 1) * JOINT_COUNT]
    }

    /// The person's own bones.
    pub fn skeleton(&self) -> &Skeleton {
        &self.build.skeleton
    }

    /// Global joint transforms at frame `index` of the person's own motion, into `out`.
    pub fn globals(&self, index: usize, out: &mut Vec<(Vec3, Quat)>) {
        self.skeleton().globals(self.root[index], self.pose(index), out);
    }

    /// Root position and pose at `secs`, by interpolation; `None` while absent. No allocation, no state.
    pub fn sample(&self, secs: f32, pose: &mut [Quat; JOINT_COUNT]) -> Option<Vec3> {
        let at = secs * FPS - self.begin as f32;
        if self.root.is_empty() || at < 0.0 || at > (self.frames() - 1) as f32 {
            return None;
        }
        let i = (at as usize).min(self.frames().saturating_sub(2));
        let j = (i + 1).min(self.frames() - 1);
        let t = at - i as f32;
        for (k, out) in pose.iter_mut().enumerate() {
            let (a, b) = (self.rotations[i * JOINT_COUNT + k], self.rotations[j * JOINT_COUNT + k]);
            *out = a.lerp(b, t);
        }
        Some(self.root[i].lerp(self.root[j], t))
    }
}

/// A finished crowd, with the captures it was made from, so that it can be checked and played from itself alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Crowd {
    /// Seed it was made with.
    pub seed: u64,
    /// Where and how long.
    pub domain: DomainInfo,
    /// The patch set it is tiled with.
    pub set: PatchSet,
    /// The placed patches.
    pub instances: Vec<Instance>,
    /// The people.
    pub characters: Vec<Character>,
    /// The boxes that they carry.
    pub props: Vec<Prop>,
}

impl Crowd {
    /// The different builds of the people, in order of first appearance, and the index of everybody's own.
    pub fn builds(&self) -> (Vec<Arc<Build>>, Vec<usize>) {
        let mut builds: Vec<Arc<Build>> = Vec::new();
        let mut index_of = |build: &Arc<Build>| {
            let found = builds.iter().position(|b| Arc::ptr_eq(b, build) || b == build);
            found.unwrap_or_else(|| {
                builds.push(build.clone());
                builds.len() - 1
            })
        };
        let indices = self.characters.iter().map(|c| index_of(&c.build)).collect();
        (builds, indices)
    }
}
