//! Jumps: hips that are pushed up, fly as bodies do, and are caught; feet that are drawn up meanwhile.

use glam::Vec2;

use super::actor::{Actor, other, secs, strike_pitch};
use super::footsteps::{Base, Hop, Pass};
use super::gait::Gait;
use super::posture::Channel::*;
use super::timeline::{Span, hermite};
use crate::geom::Ground;
use crate::motion::Foot;

/// Acceleration of what falls, m/s^2.
const GRAVITY: f32 = 9.81;

/// The course of the hips' height over a jump, above where they would be. Times in seconds, heights in metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flight {
    /// They begin to sink; the last foot leaves; the first lands; they are where they were.
    pub times: [f32; 4],
    /// How deep they sink before and after.
    pub dips: [f32; 2],
    /// Where they are when the last foot leaves and when the first lands.
    pub ends: [f32; 2],
}

impl Flight {
    /// Rates at which the hips rise when the last foot leaves and when the first lands, m/s.
    pub fn rates(&self) -> [f32; 2] {
        let airborne = self.times[2] - self.times[1];
        let up = (self.ends[1] - self.ends[0]) / airborne + 0.5 * GRAVITY * airborne;
        [up, up - GRAVITY * airborne]
    }

    /// How far the feet are off the ground, 0 to 1: those in the air follow the hips as far as legs reach.
    pub fn airborne(&self, t: f32) -> f32 {
        let [_, off, landing, _] = self.times;
        Span([off, off + 0.08, landing - 0.06, landing + 0.02]).weight(t)
    }

    /// Height at `t`.
    pub fn height(&self, t: f32) -> f32 {
        let [begin, off, landing, end] = self.times;
        let [up, down] = self.rates();
        let fallen = |dip: f32, end: f32, rate: f32| 2.0 * (dip + end) / rate.abs();
        if t < off {
            // So long before as an even push takes.
            let lowest = (off - fallen(self.dips[0], self.ends[0], up)).max(begin + 0.3 * (off - begin));
            hermite(&[(begin, 0.0, 0.0), (lowest, -self.dips[0], 0.0), (off, self.ends[0], up)], t)
        } else if t <= landing {
            let s = t - off;
            self.ends[0] + up * s - 0.5 * GRAVITY * s * s
        } else {
            let lowest = (landing + fallen(self.dips[1], self.ends[1], down)).min(landing + 0.6 * (end - landing));
            hermite(&[(landing, self.ends[1], down), (lowest, -self.dips[1], 0.0), (end, 0.0, 0.0)], t)
        }
    }
}

/// Frames of a jump: when the feet leave, land, and when one stands again.
const JUMP: [i32; 3] = [19, 33, 56];

impl Actor {
    /// From standing a jump ahead with both feet, flying at `speed`, to standing; port at the end.
    pub fn jump(&mut self, speed: f32) {
        let [off, landing, end] = JUMP.map(secs);
        let t = self.t();
        let times = [0.07, off, landing, end - 0.1].map(|after| t + after);
        let flight = Flight { times, dips: [0.26, 0.33], ends: [0.02, -0.14] };
        let speeds = [(off - 0.30, 0.0), (off, speed), (landing, speed), (landing + 0.33, 0.0)];
        self.plan.speeds.extend(speeds.map(|(after, speed)| (t + after, speed)));
        let rates = flight.rates().map(|rate| 0.9 * rate);
        for foot in [Foot::Left, Foot::Right] {
            self.lift(foot, [off - 0.10, off - 0.17, off].map(|after| t + after), 0.70);
            self.hop(foot, Hop { height: 0.42, times: [0.0, 0.5, 1.0], rates, pass: None });
            let lands = [landing, landing + 0.05, landing + 0.12].map(|after| t + after);
            self.land(foot, Base::Stand, t + end, Ground::IDENTITY, lands, 0.04);
        }
        self.flights.push(flight);
        self.swing_arms(off, landing);
        let bend = [(PelvisPitch, 0.34), (SpinePitch, 0.34), (HeadPitch, -0.2), (HipsForward, -0.05)];
        self.pose([0.05, off - 0.27, off - 0.22, off], &bend);
        self.pose([off + 0.1, landing, landing + 0.14, end], &bend.map(|(channel, amount)| (channel, 0.85 * amount)));
        self.now += JUMP[2];
        self.mark();
    }

    /// Arms go back, swing up with the jump and come down with it; times from the cursor on.
    fn swing_arms(&mut self, off: f32, landing: f32) {
        let back = [0.0, off - 0.34, off - 0.32, off + 0.10];
        let up = [off - 0.32, off + 0.14, off + 0.16, landing + 0.24];
        for (flex, elbow) in [(FlexLeft, ElbowLeft), (FlexRight, ElbowRight)] {
            self.pose(back, &[(flex, -0.6)]);
            self.pose(up, &[(flex, 0.95), (elbow, 0.4)]);
        }
        self.pose([off - 0.1, off + 0.1, landing, landing + 0.3], &[(AbductLeft, 0.18), (AbductRight, 0.18)]);
    }

    /// A leap out of a walk: from mid-stance off this foot, over something at `speed`, onto the other, and on to its
    /// mid-stance; port at the end.
    pub fn leap(&mut self, gait: Gait, speed: f32) {
        let (foot, before) = self.walking.expect("walking");
        let (t, lands) = (self.t(), other(foot));
        let [off, landing, end] = LEAP.map(|frames| t + secs(frames));
        let middle = 0.5 * (off + landing);
        let flight = Flight { times: [t, off, landing, end], dips: [0.045, 0.13], ends: [0.0, -0.06] };
        let [up, down] = flight.rates();
        let (up, down) = (0.6 * up, 0.6 * down);
        self.plan.speeds.extend([(t, before.speed), (off, speed), (landing, speed), (end, gait.speed)]);
        // The leading leg has been in the air since before mid-stance: it is highest in the middle of the flight.
        let since = self.feet[lands as usize].stances.last().expect("a stance").toe_off;
        let part = |t: f32| (t - since) / (landing - since);
        let pass = Some(passing(t, before));
        let times = [part(t), part(middle), 1.0];
        self.hop(lands, Hop { height: 0.45, times, rates: [0.0, down], pass });
        self.lift(foot, [off - 0.07, off - 0.17, off], 0.75);
        let touches = [landing, landing + 0.06, landing + 0.12];
        self.land(lands, Base::Walk, end, Ground::IDENTITY, touches, strike_pitch(gait.speed));
        // The trailing leg follows a little later, and swings on into the next step.
        let next = end + 0.43 * secs(gait.half);
        let part = |t: f32| (t - off) / (next - off);
        let pass = Some(passing(end, gait));
        let times = [0.0, part(middle + 0.05), part(end)];
        self.hop(foot, Hop { height: 0.40, times, rates: [up, 0.0], pass });
        self.flights.push(flight);
        let [off, landing, end] = LEAP.map(secs);
        self.pose([0.02, off, landing, end], &[(SpinePitch, 0.10), (PelvisPitch, 0.06)]);
        self.pose([off - 0.1, off + 0.15, off + 0.2, end], &[(AbductLeft, 0.25), (AbductRight, 0.25)]);
        self.phase.mid_stance(t + end, foot != Foot::Left);
        self.now += LEAP[2];
        self.walking = Some((lands, gait));
        self.mark();
    }
}

fn passing(at: f32, gait: Gait) -> Pass {
    Pass { at, half: secs(gait.half), speed: gait.speed, place: Vec2::ZERO, velocity: Vec2::ZERO }
}

/// Frames of a leap: when the foot leaves, the other lands, and is in mid-stance.
const LEAP: [i32; 3] = [6, 17, 23];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hips_fly_as_bodies_do_and_go_over_smoothly() {
        let flight = Flight { times: [0.0, 0.6, 1.06, 1.8], dips: [0.25, 0.27], ends: [0.05, -0.03] };
        let h = |t: f32| f64::from(flight.height(t));
        let rate = |t: f32| (h(t + 1e-3) - h(t - 1e-3)) / 2e-3;
        assert_eq!((h(0.0), h(1.8)), (0.0, 0.0));
        for t in [0.6, 1.06] {
            assert!((rate(t + 2e-3) - rate(t - 2e-3)).abs() < 0.15, "{t}: {} {}", rate(t + 2e-3), rate(t - 2e-3));
        }
        let fall = (h(0.93) - 2.0 * h(0.83) + h(0.73)) / 0.01;
        assert!((fall + 9.81).abs() < 0.01, "{fall}");
        let lowest = (0..180).map(|i| h(i as f32 * 0.01)).fold(0.0, f64::min);
        assert!(lowest > -0.28, "{lowest}");
    }
}
