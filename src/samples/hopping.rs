//! Hopping on one leg, the other held up behind, the arms folded before the chest.

use glam::Vec3;

use super::actor::{Actor, NEVER, other, secs};
use super::flight::Flight;
use super::footsteps::{Base, FootPose, Hop, pitched};
use super::gesture::{Grip, Relative};
use super::posture::Channel::*;
use super::timeline::Span;
use crate::geom::Ground;
use crate::motion::Foot;
use crate::motion::arm::sign;

/// Frames of a hop from mid-stance to mid-stance: when the foot leaves, lands, and carries the body over it.
pub(super) const HOP: [i32; 3] = [5, 11, 16];
/// Seconds from mid-stance to the middle of the flight.
const HOP_MIDDLE: f32 = 8.0 / 30.0;
/// Speed at ports, m/s.
pub(super) const PACE: f32 = 0.7;
/// How much lower than in standing the hips are at mid-stance, and how high when the foot leaves and lands over that.
const CROUCH: f32 = 0.07;
const RISE: f32 = 0.05;
/// The ankle of the leg that is held up, seen from the ground point under the hips: left (of the left foot) and ahead;
/// how far below the hips it is; and how far the toes point down.
const HELD: [f32; 2] = [0.085, -0.29];
const HELD_DROP: f32 = 0.36;
const HELD_PITCH: f32 = -1.25;
/// Elbows of folded arms, in the chest's frame.
const ELBOW_FOLDED: Vec3 = Vec3::new(0.8, -0.9, 0.25);

/// The palm of one side when the arms are folded: the left one lies upon the right upper arm, the right one on the left.
/// `high` is how far they are thrown up by a hop, 0 to 1.
fn folded(side: Foot, high: f32) -> Grip {
    let (palm, fingers) = match side {
        Foot::Left => ([-0.105, -0.045, 0.195], [-1.0, 0.15, -0.22]),
        Foot::Right => ([0.10, -0.125, 0.245], [1.0, 0.10, -0.30]),
    };
    let (palm, fingers) = (Vec3::from_array(palm), Vec3::from_array(fingers));
    Grip {
        relative: Relative::Chest,
        palm: palm + high * Vec3::new(0.0, 0.022, 0.012),
        fingers: fingers + high * Vec3::new(0.0, 0.2, -0.12),
        facing: Vec3::new(0.0, -0.25 * high, -1.0),
    }
}

impl Actor {
    /// Somebody who hops on `foot` since ever, from the origin along +z.
    pub fn hopper(foot: Foot) -> Self {
        let mut a = Self::standing();
        a.ports.clear();
        a.hopping = Some(foot);
        let since = [-9.0, -8.9, NEVER, NEVER + 1.0];
        a.fold(since);
        a.hold_up(other(foot), since);
        a.lift(other(foot), [-8.9, -8.8, -8.7], 0.0);
        // The foot is where a hop has brought it.
        a.feet[foot as usize].stances[0].placement.base = Base::Walk;
        a.plan.speeds.push((0.0, PACE));
        a.mark();
        a
    }

    /// Folds the arms and leans a little over a span.
    fn fold(&mut self, times: [f32; 4]) {
        // The right arm is outside: it comes last.
        for (side, after) in [(Foot::Left, 0.0), (Foot::Right, 0.15)] {
            let [a, b, c, d] = times;
            self.reach_with(side, [a + after, b + after, c, d], vec![(0.0, folded(side, 0.0))], ELBOW_FOLDED);
        }
        self.pose(times, &[(StillArms, 1.0), (SpinePitch, 0.07), (ShrugLeft, 0.02), (ShrugRight, 0.02)]);
    }

    /// Holds a leg up over a span (seconds from the cursor on), crouching a little on the other.
    fn hold_up(&mut self, leg: Foot, times: [f32; 4]) {
        let t = self.t();
        self.held_legs.push((leg, Span(times.map(|after| after + t))));
        self.pose(times, &[(HipsUp, -CROUCH), (PelvisPitch, 0.06)]);
    }

    /// From standing to hopping on `foot`: the arms are folded, the other leg is drawn up, a first hop; port at the end.
    pub fn begin_to_hop(&mut self, foot: Foot) {
        let free = other(foot);
        self.fold([0.0, 0.6, NEVER, NEVER + 1.0]);
        self.hold_up(free, [0.45, 1.05, NEVER, NEVER + 1.0]);
        let t = self.t();
        self.lift(free, [t + 0.2, t + 0.38, t + 0.5], 0.35);
        self.wait(36);
        self.hopping = Some(foot);
        self.plan.speeds.push((self.t(), 0.0));
        self.hop_on(0.5 * PACE, PACE, 0.0);
    }

    /// From hopping to standing: a last hop, the leg comes down beside the other, the arms sink; port at the end.
    pub fn end_hopping(&mut self) {
        let foot = self.hopping.expect("on one leg");
        self.hop_on(0.5 * PACE, 0.0, 0.0);
        self.ports.pop();
        let (t, free) = (self.t(), other(foot));
        for (_, span) in &mut self.held_legs {
            (span.0[2], span.0[3]) = (t + 0.1, t + 0.55);
        }
        let ends = |span: &mut Span, after: f32| (span.0[2], span.0[3]) = (t + after, t + after + 0.6);
        self.pulses.iter_mut().for_each(|p| ends(&mut p.span, 0.1));
        self.reaches.iter_mut().for_each(|r| ends(&mut r.span, if r.side == Foot::Left { 0.22 } else { 0.05 }));
        self.hopping = None;
        let at = t + 0.9;
        self.land(free, Base::Stand, at, Ground::IDENTITY, [t + 0.5, t + 0.56, t + 0.75], 0.02);
        // The foot that hopped is brought beside.
        self.wait(22);
        self.step(foot, Ground::IDENTITY, 10);
        self.wait(12);
        self.mark();
    }

    /// A hop at `speed` in the air (backwards if negative) to mid-stance at speed `end`, turning by `turn`; port there.
    pub fn hop_on(&mut self, speed: f32, end: f32, turn: f32) {
        let (foot, t) = (self.hopping.expect("on one leg"), self.t());
        let [off, landing, middle] = HOP.map(|frames| t + secs(frames));
        self.plan.speeds.extend([(off, speed), (landing, speed), (middle, end)]);
        self.turn(turn, off - 0.08, landing + 0.08);
        let flight = Flight { times: [t, off, landing, middle], dips: [0.012, 0.012], ends: [RISE, RISE] };
        let rates = flight.rates().map(|rate| 0.35 * rate);
        self.lift(foot, [off - 0.04, off - 0.11, off], 0.55);
        self.hop(foot, Hop { height: 0.035, times: [0.0, 0.5, 1.0], rates, pass: None });
        let lands = [landing, landing + 0.05, landing + 0.08];
        self.land(foot, Base::Walk, middle, Ground::IDENTITY, lands, 0.03);
        self.flights.push(flight);
        let keys = [(t + 0.02, 0.0), (off + 0.09, 1.0), (landing + 0.06, -0.5), (middle, 0.0)];
        for reach in &mut self.reaches {
            reach.grips.extend(keys.map(|(at, high)| (at, folded(reach.side, high))));
        }
        self.pulse(SpinePitch, [0.03, HOP_MIDDLE, HOP_MIDDLE, secs(HOP[2]) - 0.03], -0.03);
        self.now += HOP[2];
        self.mark();
    }
}

/// The share of the body's weight on the left foot, given what the stances say.
pub(super) fn held_share(actor: &Actor, t: f32, share: f32) -> f32 {
    actor.held_legs.iter().fold(share, |share, (leg, span)| {
        let all = if *leg == Foot::Left { 0.0 } else { 1.0 };
        share + (all - share) * span.weight(t)
    })
}

/// A foot as it is, or held up behind.
pub(super) fn held_foot(actor: &Actor, foot: usize, t: f32, at: Ground, hips: f32, pose: FootPose) -> FootPose {
    let held = actor.held_legs.iter().filter(|(leg, _)| *leg as usize == foot);
    held.fold(pose, |pose, (leg, span)| {
        let weight = span.weight(t);
        let place = at.apply(glam::Vec2::new(sign(*leg) * HELD[0], HELD[1]));
        let ankle = Vec3::new(place.x, hips - HELD_DROP, place.y);
        FootPose {
            ankle: pose.ankle.lerp(ankle, weight),
            rotation: pose.rotation.slerp(pitched(at.heading, HELD_PITCH), weight),
            toe: pose.toe * (1.0 - weight),
        }
    })
}
