//! How the body moves over a walking cycle, by phase and speed.
//!
//! Phase 0 is the left heel strike, 0.5 the right one; the left foot is in mid-stance at 0.285. Amplitudes and
//! phases follow the normal curves of gait analysis (Perry and Burnfield 2010; Murray 1967 for the arms; Stokes et
//! al. 1989 for pelvis against thorax), each kept to its first harmonic or two.

use std::f32::consts::TAU;

use super::timeline::hermite;

/// A steady walk: frames (at 30 per second) from one mid-stance to the next, and speed in m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gait {
    pub half: i32,
    pub speed: f32,
}

pub(super) const SLOW: Gait = Gait { half: 20, speed: 0.8 };
pub(super) const NORMAL: Gait = Gait { half: 17, speed: 1.15 };
pub(super) const FAST: Gait = Gait { half: 15, speed: 1.45 };

/// Phase of the left foot's mid-stance.
pub(super) const LEFT_MID: f32 = 0.285;

/// What walking adds to the neutral posture. Radians and metres; index 0 is left.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GaitPose {
    pub drop: f32,
    pub pelvis_pitch: f32,
    pub pelvis_yaw: f32,
    pub pelvis_roll: f32,
    /// Of the chest, against the path.
    pub chest_yaw: f32,
    pub lean: f32,
    pub arm_flex: [f32; 2],
    pub elbow: [f32; 2],
}

/// The pose at `phase` when walking at `speed` (m/s); fades to nothing towards standing.
pub(super) fn gait_pose(phase: f32, speed: f32) -> GaitPose {
    let wave = |harmonic: f32, peak: f32| (TAU * harmonic * (phase - peak)).cos();
    let deg = f32::to_radians;
    let vigour = (speed / 1.25).clamp(0.0, 1.2);
    let arm = |peak: f32| {
        let swing = wave(1.0, peak);
        let flex = deg(-3.0 + 20.0 * swing + if swing < 0.0 { 2.5 * swing } else { 0.0 }) * vigour.powf(1.3);
        let bend = deg(9.0 + 12.0 * wave(1.0, peak + 0.06)) * vigour;
        (flex, bend)
    };
    // The left arm is foremost when the right heel strikes.
    let (left, right) = (arm(0.52), arm(0.02));
    let dip = hermite(&[(0.0, 0.0, 0.0), (0.8, 0.016, 0.03), (1.45, 0.038, 0.02)], speed.max(0.0));
    GaitPose {
        drop: 0.006 * vigour.min(1.0) + dip * 0.5 * (1.0 - wave(2.0, LEFT_MID + 0.01)),
        pelvis_pitch: (deg(2.0) + deg(1.0) * wave(2.0, 0.0)) * vigour,
        pelvis_yaw: deg(-4.2) * wave(1.0, 0.02) * vigour,
        pelvis_roll: deg(3.6) * wave(1.0, 0.19) * vigour.sqrt().min(1.0),
        chest_yaw: deg(4.5) * wave(1.0, 0.03) * vigour,
        lean: deg(2.6) * vigour,
        arm_flex: [left.0, right.0],
        elbow: [left.1, right.1],
    }
}

/// The phase as a function of time, from the times of mid-stance.
#[derive(Clone, Debug, Default)]
pub(super) struct PhaseTrack {
    keys: Vec<(f32, f32)>,
}

impl PhaseTrack {
    /// Adds a mid-stance at `t`; the next one of that foot after the last.
    pub fn mid_stance(&mut self, t: f32, left: bool) {
        let offset = if left { LEFT_MID } else { LEFT_MID + 0.5 };
        let last = self.keys.last().map_or(0.0, |k| k.1);
        let cycles = (last - offset + 0.25).ceil().max(0.0);
        self.keys.push((t, offset + cycles));
    }

    /// The phase at `t`; its rate is continuous.
    pub fn at(&self, t: f32) -> f32 {
        let keys = &self.keys;
        if keys.len() < 2 {
            return 0.0;
        }
        let rate = |i: usize| (keys[i + 1].1 - keys[i].1) / (keys[i + 1].0 - keys[i].0);
        let slope = |i: usize| match i {
            0 => rate(0),
            i if i + 1 == keys.len() => rate(i - 1),
            // The harmonic mean keeps the phase running forwards.
            i => 2.0 / (1.0 / rate(i - 1) + 1.0 / rate(i)),
        };
        let last = keys.len() - 1;
        if t <= keys[0].0 {
            return keys[0].1 + (t - keys[0].0) * rate(0);
        }
        if t >= keys[last].0 {
            return keys[last].1 + (t - keys[last].0) * rate(last - 1);
        }
        let i = keys.partition_point(|k| k.0 <= t) - 1;
        let key = |i: usize| (keys[i].0, keys[i].1, slope(i));
        hermite(&[key(i), key(i + 1)], t)
    }
}
