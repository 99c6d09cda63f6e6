//! Symptoms: what looks wrong with a capture, each with the repair that may mend it.
//!
//! - **T-pose in front**: from one frame to the next a joint goes a tenth of the body's height, far more than in the
//!   rest of the capture. Where the frames after it go on being far from smooth, the T-pose blends out.
//! - **Frame rate**, by gravity. Who is in the air falls with 9.81 m/s^2: the rate at which they do is the true one. Who
//!   is not in the air cannot push sideways harder than by leaning: where the centre of mass accelerates over the ground
//!   with more than half of gravity for a tenth of the time, the stated rate is too high.
//! - **Thorax**: neck and both shoulders stand at the chest's own place, as in cgspeed's conversions of CMU's database.
//! - **Unit**: the person's height.

use glam::Vec3;

use super::import::standing_height;
use super::retarget::{RestRig, match_rig};
use super::skeleton::joint::*;
use super::take::ImportOptions;
use super::{Clip, JOINT_COUNT, JointId};

/// What is suspected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Complaint {
    /// Frames in front that do not belong to the motion.
    LeadingFrames,
    /// The pose jumps somewhere in between.
    Jump,
    /// The stated frame rate cannot be.
    FrameRate,
    /// The bone below neck and shoulders is lost.
    Thorax,
    /// The person is too small or too tall.
    Height,
    /// The unit is not known.
    GuessedUnit,
}

/// A complaint with what would mend it.
#[derive(Clone, Debug, PartialEq)]
pub struct Symptom {
    /// What is suspected.
    pub complaint: Complaint,
    /// In words, with figures.
    pub message: String,
    /// The options that would mend it; others are as by default.
    pub repair: ImportOptions,
    /// From 0 to 1: measured directly (0.9), inferred (0.7), or a guess (below 0.5).
    pub confidence: f32,
}

/// A step of a joint from one frame to the next, in heights of the person, that no motion makes.
const LEAP: f32 = 0.1;
/// The same as a multiple of the capture's 95th percentile.
const ABOVE_USUAL: f32 = 2.5;
/// Frames in which a T-pose may blend out.
const MAX_BLEND: usize = 30;
/// Gravity, m/s^2.
const GRAVITY: f32 = 9.81;
/// Sideways acceleration that is exceeded for a tenth of the time only where the rate is wrong, m/s^2.
const MAX_LEAN: f32 = 5.0;
/// Heights of people, metres.
const HEIGHTS: std::ops::RangeInclusive<f32> = 1.3..=2.2;

/// What looks wrong with a clip that was imported with `options`: repairs that were made already are not proposed.
pub fn examine(clip: &Clip, options: &ImportOptions) -> Vec<Symptom> {
    let options = options.resolved().unwrap_or_else(|_| options.clone());
    let mut found = Vec::new();
    let height = standing_height(clip);
    found.extend(unit(height, &options));
    if clip.frames() >= 2 && height > 0.0 {
        let steps = Steps::of(clip, height);
        found.extend(leading(&steps, &options).or_else(|| jumps(&steps, clip.fps * height)));
        found.extend(rate(clip, height));
    }
    found.extend(thorax(clip));
    found
}

/// The repairs of all symptoms together.
pub fn repairs(symptoms: &[Symptom]) -> ImportOptions {
    let mut all = ImportOptions::default();
    for s in symptoms {
        all.fps = all.fps.or(s.repair.fps);
        all.metres_per_unit = all.metres_per_unit.or(s.repair.metres_per_unit);
        all.drop_first_frames = all.drop_first_frames.or(s.repair.drop_first_frames);
        all.restore_thorax = all.restore_thorax.or(s.repair.restore_thorax);
    }
    all
}

fn unit(height: f32, options: &ImportOptions) -> Option<Symptom> {
    let symptom = |complaint, message, metres_per_unit, confidence| Symptom {
        complaint,
        message,
        repair: ImportOptions { metres_per_unit, ..Default::default() },
        confidence,
    };
    if !HEIGHTS.contains(&height) {
        let right = options.metres_per_unit.filter(|_| height > 0.0).map(|unit| unit * 1.72 / height);
        let try_it = right.map_or(String::new(), |unit| format!(" try --metres-per-unit {unit:.4}"));
        let message = format!("the person is {height:.2} m tall: is --metres-per-unit right?{try_it}");
        return Some(symptom(Complaint::Height, message, right, 0.7));
    }
    let guessed = options.metres_per_unit.is_none();
    let message = "the unit is guessed from the standing height; say it with --metres-per-unit".to_owned();
    guessed.then(|| symptom(Complaint::GuessedUnit, message, None, 0.3))
}

/// How far some joint goes from frame to frame, and how much that changes, in heights of the person.
struct Steps {
    /// From frame k to k + 1: the farthest a joint goes.
    far: Vec<f32>,
    /// At frame k (between k - 1 and k + 1): the largest change of a joint's step; 0 at the first.
    uneven: Vec<f32>,
}

impl Steps {
    fn of(clip: &Clip, height: f32) -> Self {
        let mut frames = [Vec::new(), Vec::new(), Vec::new()];
        let (mut far, mut uneven) = (Vec::new(), vec![0.0]);
        for frame in 0..clip.frames() {
            frames.rotate_left(1);
            clip.globals(frame, &mut frames[2]);
            let [a, b, c] = &frames;
            let largest =
                |of: &dyn Fn(usize) -> Vec3| (0..c.len()).map(|j| of(j).length()).fold(0.0, f32::max) / height;
            if frame >= 1 {
                far.push(largest(&|j| c[j].0 - b[j].0));
            }
            if frame >= 2 {
                uneven.push(largest(&|j| c[j].0 - 2.0 * b[j].0 + a[j].0));
            }
        }
        Self { far, uneven }
    }

    fn leaps(&self) -> impl Fn(usize) -> bool + '_ {
        let usual = percentile(&self.far, 95);
        move |step: usize| self.far[step] > LEAP && self.far[step] > ABOVE_USUAL * usual
    }

    /// Number of frames in front that do not belong to the rest.
    fn leading(&self) -> usize {
        let leaps = self.leaps();
        if !leaps(0) {
            return 0;
        }
        let last = self.far.len();
        let blends = last > 2 && self.far[1] > ABOVE_USUAL * percentile(&self.far, 95);
        if !blends {
            // More jumps close behind belong to it.
            return (0..last.min(6)).filter(|&s| leaps(s)).max().unwrap_or(0) + 1;
        }
        let calm = &self.uneven[12.min(self.uneven.len() - 1)..60.min(self.uneven.len())];
        let limit = (1.5 * percentile(calm, 90)).max(0.003);
        let rough = |frame: usize| self.uneven.get(frame).is_some_and(|&u| u > limit);
        let mut frame = 1;
        while frame < MAX_BLEND && (rough(frame + 1) || rough(frame + 2)) {
            frame += 1;
        }
        frame
    }
}

fn leading(steps: &Steps, options: &ImportOptions) -> Option<Symptom> {
    let count = steps.leading();
    if count == 0 || options.drop_first_frames.is_some_and(|n| n > 0) {
        return None;
    }
    let message = if count == 1 {
        "the pose jumps after frame 0, like a T-pose put in front: try --drop-first 1".to_owned()
    } else {
        format!(
            "the pose jumps after frame 0 and settles by frame {count}, like a T-pose that blends out: try --drop-first {count}"
        )
    };
    let repair = ImportOptions { drop_first_frames: Some(count as u32), ..Default::default() };
    Some(Symptom { complaint: Complaint::LeadingFrames, message, repair, confidence: 0.9 })
}

fn jumps(steps: &Steps, speed: f32) -> Option<Symptom> {
    let leaps = steps.leaps();
    let all: Vec<usize> = (0..steps.far.len()).filter(|&s| leaps(s)).collect();
    let &first = all.first()?;
    let fastest = steps.far[first] * speed;
    let message = format!("the pose jumps at {} frames, first after frame {first} ({fastest:.0} m/s)", all.len());
    Some(Symptom { complaint: Complaint::Jump, message, repair: ImportOptions::default(), confidence: 0.9 })
}

fn thorax(clip: &Clip) -> Option<Symptom> {
    let joints = &clip.skeleton.joints;
    let lost = |chest: usize| joints.iter().filter(|j| j.parent == Some(chest) && j.offset == Vec3::ZERO).count() >= 3;
    let chest = (1..joints.len()).find(|&chest| joints[chest].offset != Vec3::ZERO && lost(chest))?;
    let message = format!(
        "'{}' has no bone to the neck and shoulders, as in cgspeed's CMU files: try --restore-thorax",
        joints[chest].name
    );
    let repair = ImportOptions { restore_thorax: Some(true), ..Default::default() };
    Some(Symptom { complaint: Complaint::Thorax, message, repair, confidence: 0.9 })
}

/// Shares of the body's mass that move with the canonical joints (rounded from Winter, Biomechanics, table 4.1).
const MASSES: [(usize, f32); 21] = [
    (HIPS, 0.15),
    (SPINE, 0.08),
    (SPINE1, 0.10),
    (SPINE2, 0.13),
    (NECK, 0.03),
    (HEAD, 0.08),
    (LEFT_UP_LEG, 0.05),
    (RIGHT_UP_LEG, 0.05),
    (LEFT_LEG, 0.08),
    (RIGHT_LEG, 0.08),
    (LEFT_FOOT, 0.03),
    (RIGHT_FOOT, 0.03),
    (LEFT_ARM, 0.02),
    (RIGHT_ARM, 0.02),
    (LEFT_FORE_ARM, 0.02),
    (RIGHT_FORE_ARM, 0.02),
    (LEFT_HAND, 0.012),
    (RIGHT_HAND, 0.012),
    (LEFT_SHOULDER, 0.0),
    (RIGHT_SHOULDER, 0.0),
    (LEFT_TOE, 0.0),
];

/// The centre of mass at every frame, about.
fn centre_of_mass(clip: &Clip, joints: &[Option<JointId>; JOINT_COUNT]) -> Vec<Vec3> {
    let parts: Vec<(JointId, f32)> = MASSES.iter().filter_map(|&(slot, mass)| Some((joints[slot]?, mass))).collect();
    let whole: f32 = parts.iter().map(|p| p.1).sum();
    let mut globals = Vec::new();
    let at = |frame| {
        clip.globals(frame, &mut globals);
        parts.iter().map(|&(j, mass)| globals[j].0 * mass).sum::<Vec3>() / whole
    };
    (0..clip.frames()).map(at).collect()
}

fn rate(clip: &Clip, height: f32) -> Option<Symptom> {
    let rig = match_rig(&RestRig::of(&clip.skeleton)).ok()?;
    // A wrong unit would look like a wrong rate.
    let to_metres = if HEIGHTS.contains(&height) { 1.0 } else { 1.72 / height };
    let centre: Vec<Vec3> = centre_of_mass(clip, &rig.joints).into_iter().map(|p| p * to_metres).collect();
    let (fps, message, confidence) = match free_fall(clip, &centre, to_metres) {
        Some(g) if (0.75..1.35).contains(&(g / GRAVITY)) => return None,
        Some(g) => {
            let fps = common_rate(clip.fps * (GRAVITY / g).sqrt());
            let fall =
                format!("who is in the air falls with {g:.1} m/s2 instead of 9.8 at {} frames per second", clip.fps);
            (fps, fall, 0.9)
        }
        None => {
            let lean = percentile(&sideways(&centre, clip.fps), 90);
            let part = (2..=5).find(|n| lean <= 0.8 * MAX_LEAN * (n * n) as f32).filter(|_| lean > MAX_LEAN)?;
            let push = format!(
                "at {} frames per second the body's centre is pushed over the ground with {lean:.1} m/s2 for a tenth \
                 of the time, which takes a lean of {:.0} degrees",
                clip.fps,
                (lean / GRAVITY).atan().to_degrees()
            );
            (common_rate(clip.fps / part as f32), push, 0.7)
        }
    };
    let message = format!("{message}: the true rate is likelier {fps}; try --fps {fps}");
    let repair = ImportOptions { fps: Some(fps), ..Default::default() };
    Some(Symptom { complaint: Complaint::FrameRate, message, repair, confidence })
}

/// The nearest rate that cameras have.
fn common_rate(fps: f32) -> f32 {
    const RATES: [f32; 14] = [24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 72.0, 90.0, 100.0, 120.0, 150.0, 200.0, 240.0, 250.0];
    let miss = |rate: f32| (rate / fps).ln().abs();
    let near = RATES.into_iter().min_by(|&a, &b| miss(a).total_cmp(&miss(b))).expect("rates");
    if miss(near) < 0.1 { near } else { fps.round().max(1.0) }
}

/// Acceleration over the ground at every frame, smoothed over a twentieth of a second.
fn sideways(centre: &[Vec3], fps: f32) -> Vec<f32> {
    let smooth = smooth(centre, 0.05 * fps);
    let inner = (0.125 * fps) as usize;
    let pairs = smooth.windows(3).map(|p| (p[2] - 2.0 * p[1] + p[0]).with_y(0.0).length() * fps * fps);
    let all: Vec<f32> = pairs.collect();
    if all.len() > 2 * inner + 30 { all[inner..all.len() - inner].to_vec() } else { Vec::new() }
}

fn smooth(points: &[Vec3], sigma: f32) -> Vec<Vec3> {
    let reach = (3.0 * sigma).ceil() as isize;
    let last = points.len() as isize - 1;
    let weight = |d: isize| (-0.5 * (d as f32 / sigma.max(1e-3)).powi(2)).exp();
    let whole: f32 = (-reach..=reach).map(weight).sum();
    let at =
        |i: isize| (-reach..=reach).map(|d| points[(i + d).clamp(0, last) as usize] * weight(d)).sum::<Vec3>() / whole;
    (0..=last).map(at).collect()
}

/// With what acceleration the body falls while no foot is near the floor, m/s^2: the median over all flights that are
/// long enough to tell. The centre's height must be a parabola to within a fiftieth of its depth.
fn free_fall(clip: &Clip, centre: &[Vec3], to_metres: f32) -> Option<f32> {
    const CLEAR: f32 = 0.05;
    const MIN_DEPTH: f32 = 0.05;
    let lowest = lowest_points(clip);
    let floor = percentile(&lowest, 2);
    let up: Vec<bool> = lowest.iter().map(|y| (y - floor) * to_metres > CLEAR).collect();
    let mut found = Vec::new();
    let mut begin = 0;
    while begin < up.len() {
        let end = (begin..up.len()).find(|&f| !up[f]).unwrap_or(up.len());
        if end >= begin + 5 {
            let (fall, miss) = parabola(&centre[begin..end]);
            let depth = fall * ((end - begin - 1) as f32).powi(2) / 8.0;
            if depth > MIN_DEPTH && miss < 0.02 * depth {
                found.push(fall * clip.fps * clip.fps);
            }
        }
        begin = end + 1;
    }
    (!found.is_empty()).then(|| percentile(&found, 50))
}

/// Height of the lowest joint at every frame.
fn lowest_points(clip: &Clip) -> Vec<f32> {
    let mut globals = Vec::new();
    let at = |frame| {
        clip.globals(frame, &mut globals);
        globals.iter().map(|g| g.0.y).fold(f32::INFINITY, f32::min)
    };
    (0..clip.frames()).map(at).collect()
}

/// Downward acceleration per frame squared of heights fitted by a parabola, and the root mean square of what is left.
fn parabola(points: &[Vec3]) -> (f32, f32) {
    // Orthogonal polynomials of degrees 0, 1, 2 over the frames.
    let n = points.len() as f64;
    let (mut y0, mut y1, mut y2, mut n1, mut n2) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let basis = |i: usize| {
        let t = i as f64 - (n - 1.0) / 2.0;
        (t, t * t - (n * n - 1.0) / 12.0)
    };
    for (i, p) in points.iter().enumerate() {
        let ((t, q), y) = (basis(i), p.y as f64);
        (y0, y1, y2, n1, n2) = (y0 + y / n, y1 + y * t, y2 + y * q, n1 + t * t, n2 + q * q);
    }
    let (slope, bend) = (y1 / n1, y2 / n2);
    let miss = |(i, p): (usize, &Vec3)| {
        let (t, q) = basis(i);
        (p.y as f64 - y0 - slope * t - bend * q).powi(2)
    };
    let left = points.iter().enumerate().map(miss).sum::<f64>() / n;
    (-2.0 * bend as f32, left.sqrt() as f32)
}

/// The value below which `percent` of the values are; 0 of none.
fn percentile(values: &[f32], percent: usize) -> f32 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f32::total_cmp);
    sorted.get(sorted.len().saturating_sub(1) * percent / 100).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::canonical;
    use glam::Quat;

    /// Someone who jumps half a metre high for real, at 100 frames per second, `stated` otherwise.
    fn jump(stated: f32) -> Clip {
        let skeleton = canonical().clone();
        let height = |frame: usize| {
            let t = (frame as f32 - 100.0) / 100.0;
            (0.5 - 0.5 * GRAVITY * t * t).max(0.0) + skeleton.joints[0].offset.y
        };
        let root = (0..200).map(|f| Vec3::new(0.0, height(f), 0.0)).collect();
        let rotations = vec![Quat::IDENTITY; 200 * JOINT_COUNT];
        Clip { name: "jump".into(), skeleton, fps: stated, root, rotations }
    }

    fn told(clip: &Clip, options: &ImportOptions) -> Vec<Complaint> {
        examine(clip, options).iter().map(|s| s.complaint).collect()
    }

    fn metres() -> ImportOptions {
        ImportOptions { metres_per_unit: Some(1.0), ..Default::default() }
    }

    #[test]
    fn gravity_tells_the_rate() {
        assert_eq!(told(&jump(100.0), &metres()), []);
        for stated in [30.0, 50.0, 200.0, 240.0] {
            let found = examine(&jump(stated), &metres());
            assert_eq!(found.len(), 1, "{found:?}");
            assert_eq!(repairs(&found).fps, Some(100.0), "{found:?}");
        }
    }

    #[test]
    fn frames_in_front_are_counted() {
        let mut clip = jump(100.0);
        clip.root[0].x += 1.0;
        let found = examine(&clip, &metres());
        assert_eq!(repairs(&found).drop_first_frames, Some(1), "{found:?}");
        // One that blends out over six frames.
        for frame in 0..6 {
            clip.root[frame].x = ((6 - frame) as f32 / 6.0).powi(2);
        }
        let count = repairs(&examine(&clip, &metres())).drop_first_frames.unwrap();
        assert!((5..=7).contains(&count), "{count}");
        let mended = ImportOptions { drop_first_frames: Some(6), ..metres() };
        assert_eq!(told(&crate::motion::import::repair(clip, &mended).unwrap(), &mended), []);
    }

    #[test]
    fn a_jump_in_between_is_no_t_pose() {
        let mut clip = jump(100.0);
        clip.root[20].x += 1.0;
        let found = examine(&clip, &metres());
        assert_eq!((found.len(), found[0].complaint), (1, Complaint::Jump), "{found:?}");
        assert!(found[0].message.contains("2 frames, first after frame 19"), "{found:?}");
    }

    #[test]
    fn heights_and_units() {
        let mut clip = jump(100.0);
        assert_eq!(told(&clip, &ImportOptions::default()), [Complaint::GuessedUnit]);
        super::super::import::repair(clip.clone(), &metres()).unwrap();
        clip.root.iter_mut().for_each(|p| *p *= 0.01);
        clip.skeleton.joints.iter_mut().for_each(|j| j.offset *= 0.01);
        clip.skeleton.joints.iter_mut().for_each(|j| j.tip = j.tip.map(|t| t * 0.01));
        let found = examine(&clip, &metres());
        assert_eq!(found[0].complaint, Complaint::Height);
        assert!((repairs(&found).metres_per_unit.unwrap() - 100.0).abs() < 3.0, "{found:?}");
    }
}
