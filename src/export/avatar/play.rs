//! An avatar plays a person: bones point where the person's bones point, feet stand where the person's feet stand.

use glam::{Affine3A, Quat, Vec3};

use super::{Avatar, Graft};
use crate::export::actor::{Bone, Keys};
use crate::motion::ik::two_bone;
use crate::motion::joint::*;
use crate::motion::{ANKLE_HEIGHT, JOINT_COUNT};
use crate::stage::Character;

/// Thigh, shin and foot of each leg.
pub(super) const LEGS: [[usize; 3]; 2] = [[LEFT_UP_LEG, LEFT_LEG, LEFT_FOOT], [RIGHT_UP_LEG, RIGHT_LEG, RIGHT_FOOT]];
/// Largest part of a leg's length that is used, so that knees never lock.
const LEG_STRETCH: f32 = 0.9995;

impl Avatar {
    /// Bones and keys of the avatar as the person `character`.
    pub(in crate::export) fn play(&self, character: &Character, graft: &Graft) -> (Vec<Bone>, Keys) {
        let mut bones = graft.bones.clone();
        let mut player = Player::new(self, character.build.leg() / self.leg);
        bones[0].scale = Vec3::splat(player.size);
        let played: Vec<usize> = (0..bones.len()).filter(|&b| player.role[b].is_some()).collect();
        let mut turns: Vec<Vec<Quat>> = vec![Vec::with_capacity(character.frames()); played.len()];
        let mut places = Vec::with_capacity(character.frames());
        let mut person = Vec::new();
        for frame in 0..character.frames() {
            character.globals(frame, &mut person);
            player.pose(&person);
            places.push(player.hips_place());
            for (track, &bone) in turns.iter_mut().zip(&played) {
                track.push(player.local(bone));
            }
        }
        (bones, Keys { root: player.hips, places, turns: played.into_iter().zip(turns).collect() })
    }
}

/// The avatar's bones at one moment.
struct Player<'a> {
    avatar: &'a Avatar,
    size: f32,
    hips: usize,
    /// The canonical joint that each bone plays.
    role: Vec<Option<usize>>,
    /// Each bone's place seen from its parent's at rest, at the person's size.
    offsets: Vec<Vec3>,
    /// From the world into the frame that the hips hang from; nothing moves it.
    hips_from_world: Affine3A,
    turns: Vec<Quat>,
    places: Vec<Vec3>,
}

impl<'a> Player<'a> {
    fn new(avatar: &'a Avatar, size: f32) -> Self {
        let bones = &avatar.bones;
        let mut role = vec![None; bones.len()];
        for j in (0..JOINT_COUNT).rev() {
            // A bone that plays several joints follows the first.
            avatar.plays[j].into_iter().for_each(|b| role[b] = Some(j));
        }
        let offset = |b: &Bone, at: Vec3| {
            let (parent, turn) = b.parent.map_or((Vec3::ZERO, Quat::IDENTITY), |p| avatar.rest[p]);
            turn.inverse() * (at - parent) * size
        };
        let offsets = bones.iter().zip(&avatar.rest).map(|(b, r)| offset(b, r.0)).collect();
        let hips = avatar.plays[HIPS].expect("no rig is without hips");
        let mut above = Affine3A::IDENTITY;
        let mut next = bones[hips].parent;
        while let Some(b) = next {
            let scale = if b == 0 { Vec3::splat(size) } else { bones[b].scale };
            above = Affine3A::from_scale_rotation_translation(scale, bones[b].rotation, bones[b].translation) * above;
            next = bones[b].parent;
        }
        let turns = vec![Quat::IDENTITY; bones.len()];
        let places = vec![Vec3::ZERO; bones.len()];
        Self { avatar, size, hips, role, offsets, hips_from_world: above.inverse(), turns, places }
    }

    /// Takes the pose of a person whose global joint transforms are given.
    fn pose(&mut self, person: &[(Vec3, Quat)]) {
        for b in 0..self.turns.len() {
            self.turns[b] = match self.role[b] {
                Some(j) => person[j].1 * self.avatar.turns[j].inverse() * self.avatar.rest[b].1,
                None => self.carried(b),
            };
        }
        // Ankles of another height lift or lower the whole body.
        let rise = self.size * self.avatar.ankle - ANKLE_HEIGHT;
        let middle = |of: &dyn Fn(usize) -> Vec3| 0.5 * (of(LEFT_UP_LEG) + of(RIGHT_UP_LEG));
        let wanted = middle(&|j| person[j].0) + Vec3::Y * rise;
        self.place(Vec3::ZERO);
        let found = middle(&|j| self.places[self.bone(j)]);
        self.place(wanted - found);
        for [up, low, foot] in LEGS {
            let target = person[foot].0 + person[foot].1 * Vec3::Y * rise;
            let [a, b, c] = [up, low, foot].map(|j| self.places[self.bone(j)]);
            let (swing, bend, _) = two_bone(a, b, c, target, person[up].1 * Vec3::Z, LEG_STRETCH);
            let (up, low) = (self.bone(up), self.bone(low));
            self.turns[up] = swing * self.turns[up];
            self.turns[low] = swing * bend * self.turns[low];
        }
        for b in (0..self.turns.len()).filter(|&b| self.role[b].is_none()) {
            self.turns[b] = self.carried(b);
        }
    }

    /// The rotation of a bone that is as it was at rest, seen from its parent.
    fn carried(&self, b: usize) -> Quat {
        let bone = &self.avatar.bones[b];
        bone.parent.map_or(Quat::IDENTITY, |p| self.turns[p]) * bone.rotation
    }

    fn bone(&self, joint: usize) -> usize {
        self.avatar.plays[joint].expect("no rig is without legs")
    }

    /// Places all bones that hang from the hips.
    fn place(&mut self, hips: Vec3) {
        for b in 0..self.places.len() {
            self.places[b] = match self.avatar.bones[b].parent {
                _ if b == self.hips => hips,
                Some(p) => self.places[p] + self.turns[p] * self.offsets[b],
                None => Vec3::ZERO,
            };
        }
    }

    fn hips_place(&self) -> Vec3 {
        self.hips_from_world.transform_point3(self.places[self.hips])
    }

    fn local(&self, b: usize) -> Quat {
        let parent = self.avatar.bones[b].parent.map_or(Quat::IDENTITY, |p| self.turns[p]);
        (parent.inverse() * self.turns[b]).normalize()
    }
}
