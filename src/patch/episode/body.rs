//! What is asked of a person at every frame, worked out once.

use glam::{Vec2, Vec3};

use super::variation::variation;
use crate::geom::Capsule;
use crate::motion::contacts::palm;
use crate::motion::{BODY_CAPSULES, FPS, JOINT_COUNT, Motion, body_capsules, joint};

/// The face in the head's frame, metres: the eyes are about here.
const FACE: Vec3 = Vec3::new(0.0, 0.10, 0.09);

/// A person over time. O(frames) of memory, about half a kilobyte each.
pub(super) struct Body {
    /// Hips on the ground.
    pub places: Vec<Vec2>,
    /// Where the eyes are.
    pub faces: Vec<Vec3>,
    /// Which way they look: the head's forward.
    pub gazes: Vec<Vec3>,
    /// Middle of the upper body.
    pub chests: Vec<Vec3>,
    /// Centres of the left and right palm.
    pub palms: Vec<[Vec3; 2]>,
    /// Eq. 4.
    pub variation: Vec<f32>,
    /// Largest speed on the ground around each frame, m/s, see [`speeds`].
    pub speeds: Vec<f32>,
    capsules: Vec<Capsule>,
}

impl Body {
    pub fn new(motion: &Motion, half_window: usize) -> Self {
        let mut globals = Vec::with_capacity(JOINT_COUNT);
        let mut body = Self {
            places: motion.path.points.clone(),
            faces: Vec::with_capacity(motion.len()),
            gazes: Vec::with_capacity(motion.len()),
            chests: Vec::with_capacity(motion.len()),
            palms: Vec::with_capacity(motion.len()),
            variation: variation(motion, half_window),
            speeds: speeds(&motion.path.points, half_window),
            capsules: Vec::with_capacity(motion.len() * BODY_CAPSULES.len()),
        };
        for frame in 0..motion.len() {
            motion.globals(frame, &mut globals);
            let (place, turn) = globals[joint::HEAD];
            body.faces.push(place + turn * FACE);
            body.gazes.push(turn * Vec3::Z);
            body.chests.push(globals[joint::SPINE2].0);
            body.palms.push([palm(&globals, joint::LEFT_HAND), palm(&globals, joint::RIGHT_HAND)]);
            body_capsules(&globals, &mut body.capsules);
        }
        body
    }

    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// The body at a frame as capsules.
    pub fn capsules(&self, frame: usize) -> &[Capsule] {
        &self.capsules[frame * BODY_CAPSULES.len()..(frame + 1) * BODY_CAPSULES.len()]
    }

    /// g of eq. 5: the angle between the gaze and the way from the face to the other's upper body, radians.
    pub fn gaze_angle(&self, frame: usize, other: &Self) -> f32 {
        let way = (other.chests[frame] - self.faces[frame]).normalize_or(self.gazes[frame]);
        self.gazes[frame].dot(way).clamp(-1.0, 1.0).acos()
    }
}

/// Largest speed within two half windows of each frame; speeds are over five frames. So who is about to set off counts as
/// fast, and who has just stopped: first and last steps, on which hips are slow, are no reaction to anybody.
fn speeds(points: &[Vec2], half: usize) -> Vec<f32> {
    let around = |i: usize, by: usize| (i.saturating_sub(by), (i + by).min(points.len() - 1));
    let speed = |i: usize| {
        let (first, last) = around(i, 2);
        points[first].distance(points[last]) * FPS / (last - first).max(1) as f32
    };
    let local: Vec<f32> = (0..points.len()).map(speed).collect();
    let most = |i: usize| {
        let (first, last) = around(i, 2 * half);
        local[first..=last].iter().copied().fold(0.0, f32::max)
    };
    (0..points.len()).map(most).collect()
}

/// How far two surfaces are apart, metres, negative if they overlap; `within` if they are farther than that.
pub(super) fn gap(a: &Capsule, b: &Capsule, within: f32) -> f32 {
    let thick = Capsule { radius: a.radius + within, ..*a };
    within - thick.penetration(b).max(0.0)
}
