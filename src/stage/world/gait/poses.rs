//! Poses of bodies: from the table, turned as they look, with legs that reach their feet.

use glam::{Quat, Vec2, Vec3};

use super::eights::WIDTH;
use super::leg::{Legs, about_vertical};
use super::{GaitTable, Walking};
use crate::geom::sin_cos;
use crate::motion::JOINT_COUNT;

impl GaitTable {
    /// Poses of bodies, and their hips in the frame of their places, as many as there are of each. Legs are led for eight bodies at
    /// a time, so one alone costs as much there as eight together. No allocation.
    pub fn poses(&self, bodies: &[Walking], poses: &mut [[Quat; JOINT_COUNT]], hips: &mut [Vec3]) {
        pulp::Arch::new().dispatch(Posing { table: self, bodies, poses, hips });
    }

    /// The pose at a speed and phase, and the hips relative to where somebody is. No allocation.
    #[inline(always)]
    pub fn pose(&self, speed: f32, phase: f32, pose: &mut [Quat; JOINT_COUNT]) -> Vec3 {
        let (low, fast) = self.between(speed);
        let at = phase.clamp(0.0, 1.0) * self.phases as f32;
        let first = (at as usize).min(self.phases - 1);
        let late = at - first as f32;
        let next = if first + 1 < self.phases { first + 1 } else { 0 };
        let (slower, faster) = (low * self.phases, (low + 1) * self.phases);
        let of = [slower + first, slower + next, faster + first, faster + next];
        let weights = [(1.0 - fast) * (1.0 - late), (1.0 - fast) * late, fast * (1.0 - late), fast * late];
        let rows = self.rotations.as_chunks::<JOINT_COUNT>().0;
        let (a, b, c, d) = (&rows[of[0]], &rows[of[1]], &rows[of[2]], &rows[of[3]]);
        let mut scales = [1.0_f32; JOINT_COUNT.next_multiple_of(8)];
        for joint in 0..JOINT_COUNT {
            pose[joint] = a[joint] * weights[0] + b[joint] * weights[1] + c[joint] * weights[2] + d[joint] * weights[3];
            scales[joint] = pose[joint].length_squared();
        }
        // All roots at once.
        scales.iter_mut().for_each(|scale| *scale = 1.0 / scale.sqrt());
        for joint in 0..JOINT_COUNT {
            pose[joint] *= scales[joint];
        }
        let hips = &self.hips;
        hips[of[0]] * weights[0] + hips[of[1]] * weights[1] + hips[of[2]] * weights[2] + hips[of[3]] * weights[3]
    }
}

impl Walking {
    /// Root and rotations of the canonical skeleton for this body, in the frame of its place. No allocation.
    pub fn pose(&self, table: &GaitTable, pose: &mut [Quat; JOINT_COUNT]) -> Vec3 {
        let mut hips = Vec3::ZERO;
        table.poses(std::slice::from_ref(self), std::slice::from_mut(pose), std::slice::from_mut(&mut hips));
        hips
    }

    /// The same without regard to feet, the hips relative to where it is; and where it looks, as x and z.
    #[inline(always)]
    fn stride(&self, table: &GaitTable, pose: &mut [Quat; JOINT_COUNT]) -> (Vec3, Vec2) {
        let hips = table.pose(self.velocity.length(), self.phase, pose);
        let (half_sin, half_cos) = sin_cos(0.5 * self.heading);
        let facing = Vec2::new(2.0 * half_sin * half_cos, half_cos * half_cos - half_sin * half_sin);
        pose[0] = about_vertical(half_cos, half_sin, pose[0].into()).into();
        let left = Vec2::new(facing.y, -facing.x);
        let across = left * hips.x + facing * hips.z;
        (Vec3::new(across.x, hips.y, across.y), facing)
    }
}

/// Poses of bodies, in the widest instructions there are.
struct Posing<'a> {
    table: &'a GaitTable,
    bodies: &'a [Walking],
    poses: &'a mut [[Quat; JOINT_COUNT]],
    hips: &'a mut [Vec3],
}

impl pulp::NullaryFnOnce for Posing<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { table, bodies, poses, hips } = self;
        let mut legs = Legs::default();
        for ((bodies, poses), hips) in bodies.chunks(WIDTH).zip(poses.chunks_mut(WIDTH)).zip(hips.chunks_mut(WIDTH)) {
            for (i, body) in bodies.iter().enumerate() {
                let (root, facing) = body.stride(table, &mut poses[i]);
                hips[i] = root;
                if let Some(feet) = &body.feet {
                    legs.put(i, &poses[i], root, facing, feet);
                }
            }
            legs.lead(bodies.len());
            for (i, body) in bodies.iter().enumerate() {
                if body.feet.is_some() {
                    hips[i].y = legs.take(i, &mut poses[i]);
                }
                hips[i] += Vec3::new(body.place.x, 0.0, body.place.y);
            }
        }
    }
}
