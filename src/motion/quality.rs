//! How good a capture's motion is, as numbers: sliding feet, speeds and accelerations, feet in the ground, pops, joints turned too far.
//!
//! Measured on the capture's own joints, as imported; when feet are planted is told on the canonical skeleton.

use glam::Vec3;

use super::plants::speeds;
use super::retarget::{RestRig, lowest, match_rig, to_canonical};
use super::skeleton::joint::*;
use super::{Clip, FPS, Foot, JointId, Plant, limits};
use crate::Result;

/// A foot plant and how far the foot slid in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantQuality {
    /// Which foot, from which frame to which at [`FPS`].
    pub plant: Plant,
    /// The farthest the ball gets from its middle place over the ground, metres.
    pub slide: f32,
    /// Height of the ball above the floor, mean over the plant, metres.
    pub height: f32,
}

/// The figures of one clip. Metres and seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// All foot plants.
    pub plants: Vec<PlantQuality>,
    /// Median over the plants of how far the foot slides; `None` without plants.
    pub slide_median: Option<f32>,
    /// The worst of them.
    pub slide_worst: Option<f32>,
    /// Fastest speed of a joint, and which joint at what time, m/s.
    pub speed: Worst,
    /// Largest acceleration of a joint, m/s^2.
    pub acceleration: Worst,
    /// 99th percentile of the joints' accelerations, m/s^2.
    pub acceleration_p99: f32,
    /// How deep a toe or foot gets below the floor on which the feet stand, metres: the worst...
    pub penetration_worst: f32,
    /// ...and what is exceeded at one frame in a hundred.
    pub penetration_p99: f32,
    /// Times at which the pose pops: some joint's acceleration is above [`POP`], seconds.
    pub pops: Vec<f32>,
    /// How far joints are turned beyond what people can do, on the canonical skeleton.
    pub excess: limits::Excess,
}

/// The worst of something: value, joint, time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Worst {
    /// How much.
    pub value: f32,
    /// Name of the joint.
    pub joint: String,
    /// When, seconds.
    pub time: f32,
}

/// Acceleration of a joint that no body makes, m/s^2: heel strikes and claps of captures stay below it.
pub const POP: f32 = 400.0;

/// Pops nearer to each other than this are one, seconds.
const ONE_POP: f32 = 0.05;

/// Measures a clip in metres. O(frames x joints).
///
/// # Errors
/// The clip cannot be put on the canonical skeleton: its rig cannot be told, or it has fewer than two frames.
pub fn measure(clip: &Clip) -> Result<Quality> {
    let motion = to_canonical(clip)?;
    let rig = match_rig(&RestRig::of(&clip.skeleton))?;
    let ball = |foot, ankle: usize| (foot, rig.joints[ankle + 1].or(rig.joints[ankle]));
    let feet = [ball(Foot::Left, LEFT_FOOT), ball(Foot::Right, RIGHT_FOOT)];
    let body: Vec<JointId> = rig.joints.iter().copied().flatten().collect();
    let ways: Vec<(Foot, Vec<Vec3>)> =
        feet.iter().filter_map(|&(foot, joint)| Some((foot, clip.trajectory(joint?)))).collect();
    let floor = floor(&ways, clip.fps);
    let plants = plants(&motion.plants, &ways, clip, floor);
    let mut slides: Vec<f32> = plants.iter().map(|p| p.slide).collect();
    slides.sort_by(f32::total_cmp);
    let mut depths: Vec<f32> = ways.iter().flat_map(|(_, way)| way.iter().map(|p| (floor - p.y).max(0.0))).collect();
    depths.sort_by(f32::total_cmp);
    let moved = Moved::of(clip, &body);
    Ok(Quality {
        slide_median: slides.get(slides.len() / 2).copied(),
        slide_worst: slides.last().copied(),
        plants,
        penetration_worst: depths.last().copied().unwrap_or(0.0),
        penetration_p99: depths.get(depths.len() * 99 / 100).copied().unwrap_or(0.0),
        acceleration_p99: moved.acceleration_p99,
        speed: moved.speed,
        acceleration: moved.acceleration,
        pops: moved.pops,
        excess: limits::measure(&motion),
    })
}

/// Height at which the feet stand: the lower quartile of the balls' heights while they hardly move.
fn floor(ways: &[(Foot, Vec<Vec3>)], fps: f32) -> f32 {
    let lowest = lowest(ways.iter().flat_map(|(_, way)| way.iter().map(|p| p.y)).collect());
    let mut standing = Vec::new();
    for (_, way) in ways {
        let slow = way.iter().zip(speeds(way, fps)).filter(|(p, speed)| *speed < 0.2 && p.y < lowest + 0.15);
        standing.extend(slow.map(|(p, _)| p.y));
    }
    standing.sort_by(f32::total_cmp);
    standing.get(standing.len() / 4).copied().unwrap_or(lowest)
}

fn plants(found: &[Plant], ways: &[(Foot, Vec<Vec3>)], clip: &Clip, floor: f32) -> Vec<PlantQuality> {
    let measure = |plant: &Plant| {
        let way = ways.iter().find(|(foot, _)| *foot == plant.foot).map(|(_, way)| way)?;
        let frame = |f: u32| ((f as f32 / FPS * clip.fps) as usize).min(way.len() - 1);
        let stay = &way[frame(plant.begin)..=frame(plant.end)];
        let median = |of: &dyn Fn(&Vec3) -> f32| {
            let mut all: Vec<f32> = stay.iter().map(of).collect();
            all.sort_by(f32::total_cmp);
            all[all.len() / 2]
        };
        let middle = Vec3::new(median(&|p| p.x), 0.0, median(&|p| p.z));
        let slide = stay.iter().map(|p| p.with_y(0.0).distance(middle)).fold(0.0, f32::max);
        let height = stay.iter().map(|p| p.y).sum::<f32>() / stay.len() as f32 - floor;
        Some(PlantQuality { plant: *plant, slide, height })
    };
    found.iter().filter_map(measure).collect()
}

/// Speeds and accelerations of the body's joints, at the clip's own rate.
#[derive(Default)]
struct Moved {
    speed: Worst,
    acceleration: Worst,
    acceleration_p99: f32,
    pops: Vec<f32>,
}

impl Moved {
    fn of(clip: &Clip, body: &[JointId]) -> Self {
        let mut out = Self::default();
        let mut all = Vec::new();
        let mut last: [Vec<Vec3>; 3] = Default::default();
        let mut globals = Vec::new();
        for frame in 0..clip.frames() {
            clip.globals(frame, &mut globals);
            last.rotate_left(1);
            last[2] = body.iter().map(|&j| globals[j].0).collect();
            let time = frame.saturating_sub(1) as f32 / clip.fps;
            for (i, &joint) in body.iter().enumerate().filter(|_| frame >= 2) {
                let [a, b, c] = [last[0][i], last[1][i], last[2][i]];
                let keep = |worst: &mut Worst, value: f32| {
                    if value > worst.value {
                        *worst = Worst { value, joint: clip.skeleton.joints[joint].name.clone(), time };
                    }
                };
                let jolt = (c - 2.0 * b + a).length() * clip.fps * clip.fps;
                keep(&mut out.speed, (c - a).length() * clip.fps / 2.0);
                keep(&mut out.acceleration, jolt);
                all.push(jolt);
                if jolt > POP && out.pops.last().is_none_or(|&t| time > t + ONE_POP) {
                    out.pops.push(time);
                }
            }
        }
        all.sort_by(f32::total_cmp);
        out.acceleration_p99 = all.get(all.len() * 99 / 100).copied().unwrap_or(0.0);
        out
    }
}

/// How much the pose differs from `gap` seconds before, at every frame of the canonical motion, metres: the curve by
/// which episodes and recurring poses are seen.
///
/// # Errors
/// As [`measure`].
pub fn variation(clip: &Clip, gap: f32) -> Result<Vec<f32>> {
    let motion = to_canonical(clip)?;
    let back = (gap * FPS).round() as usize;
    let at = |frame: usize| super::pose::distance(&motion, frame, &motion, frame.saturating_sub(back));
    Ok((0..motion.len()).map(at).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::testing::walking;
    use crate::motion::{JOINT_COUNT, Motion, canonical};
    use glam::Quat;

    fn clip_of(motion: &Motion) -> Clip {
        let mut clip = Clip {
            name: "walk".into(),
            skeleton: canonical().clone(),
            fps: FPS,
            root: Vec::new(),
            rotations: motion.rotations.clone(),
        };
        for frame in 0..motion.len() {
            let at = motion.path.at(frame);
            clip.root.push(Vec3::new(at.position.x, motion.heights[frame], at.position.y));
            clip.rotations[frame * JOINT_COUNT] = at.rotation() * clip.rotations[frame * JOINT_COUNT];
        }
        clip
    }

    #[test]
    fn a_clean_walk_has_clean_figures() {
        let q = measure(&clip_of(&walking(4.0))).unwrap();
        assert!(q.plants.len() >= 6 && q.slide_worst.unwrap() < 0.03, "{q:?}");
        assert!(q.pops.is_empty() && q.penetration_worst < 0.02 && q.speed.value < 5.0, "{q:?}");
    }

    #[test]
    fn faults_are_measured() {
        let mut clip = clip_of(&walking(4.0));
        let clean = measure(&clip).unwrap();
        // The ground moves under everybody by 0.1 m/s; one frame is out of place; one is in the ground.
        clip.root.iter_mut().enumerate().for_each(|(f, p)| p.x += 0.1 * f as f32 / FPS);
        clip.root[60].z += 1.0;
        clip.root[100].y -= 0.2;
        clip.rotations[80 * JOINT_COUNT + LEFT_LEG] = Quat::from_rotation_x(-1.0);
        let q = measure(&clip).unwrap();
        assert!(q.slide_median.unwrap() > clean.slide_median.unwrap() + 0.01, "{q:?}");
        assert!(q.pops.iter().any(|t| (t - 2.0).abs() < 0.05), "{:?}", q.pops);
        assert!((q.acceleration.value - 2.0 * FPS * FPS).abs() < 200.0, "{:?}", q.acceleration);
        assert!((q.penetration_worst - 0.2).abs() < 0.03 && q.penetration_p99 < 0.03, "{q:?}");
        assert!(clean.excess.worst < 0.01 && (q.excess.joint, q.excess.frame) == (LEFT_LEG, 80), "{q:?}");
        assert!((q.excess.worst.to_degrees() - 47.0).abs() < 3.0, "{q:?}");
    }

    #[test]
    fn the_variation_is_small_for_who_stands() {
        let still = variation(&clip_of(&crate::motion::testing::standing(2.0)), 0.5).unwrap();
        let walk = variation(&clip_of(&walking(2.0)), 0.5).unwrap();
        assert!(still.iter().all(|&v| v < 1e-4) && walk[40] > 0.05);
    }
}
