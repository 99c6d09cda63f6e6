//! An actor: one person's performance, written as a sequence of moves that plan path and footsteps together.
//!
//! Time runs in frames of 30 per second, so that every port lies on a frame of the later stages.

use glam::Vec2;

use super::acting::{Pulse, Sight};
use super::flight::Flight;
use super::footsteps::{Base, Feet, Hop, Placement, Stance};
use super::gait::{Gait, PhaseTrack};
use super::gesture::Reach;
use super::path::{Path, PathPlan};
use super::timeline::Span;
use crate::geom::Ground;
use crate::motion::{FPS, Foot};

pub(super) const NEVER: f32 = 1e6;

/// Seconds at `frame`.
pub(super) fn secs(frame: i32) -> f32 {
    frame as f32 / FPS
}

pub(super) fn other(foot: Foot) -> Foot {
    if foot == Foot::Left { Foot::Right } else { Foot::Left }
}

/// A person's performance. The cursor `now` moves on with every move; gestures are laid from the cursor on.
#[derive(Clone, Debug)]
pub(super) struct Actor {
    pub now: i32,
    pub plan: PathPlan,
    pub feet: [Feet; 2],
    pub phase: PhaseTrack,
    pub pulses: Vec<Pulse>,
    pub reaches: Vec<Reach>,
    pub gazes: Vec<(Span, Sight)>,
    pub ports: Vec<(i32, String)>,
    anchor: (i32, Ground),
    pub walking: Option<(Foot, Gait)>,
    pub flights: Vec<Flight>,
    /// On one leg: the foot that hops.
    pub hopping: Option<Foot>,
    /// Legs that are held up, and when.
    pub held_legs: Vec<(Foot, Span)>,
    /// Whether a box is in the hands, which makes other pose groups.
    pub carrying: bool,
}

impl Actor {
    /// Somebody standing at the origin, looking along +z.
    pub fn standing() -> Self {
        let stance = |foot| Stance {
            foot,
            placement: Placement { base: Base::Stand, at: 0.0, offset: Ground::IDENTITY },
            strike: -9.0,
            flat: -8.0,
            loaded: -7.0,
            unload: NEVER,
            heel_off: NEVER,
            toe_off: 2.0 * NEVER,
            strike_pitch: 0.0,
            off_pitch: 0.0,
            hop: None,
            place: Ground::IDENTITY,
        };
        let mut actor = Self {
            now: 0,
            plan: PathPlan::default(),
            feet: [Feet { stances: vec![stance(Foot::Left)] }, Feet { stances: vec![stance(Foot::Right)] }],
            phase: PhaseTrack::default(),
            pulses: Vec::new(),
            reaches: Vec::new(),
            gazes: Vec::new(),
            ports: Vec::new(),
            anchor: (0, Ground::IDENTITY),
            walking: None,
            flights: Vec::new(),
            hopping: None,
            held_legs: Vec::new(),
            carrying: false,
        };
        actor.mark();
        actor
    }

    pub fn t(&self) -> f32 {
        secs(self.now)
    }

    /// Marks a port at the cursor.
    pub fn mark(&mut self) {
        let pose = match (self.hopping, self.walking) {
            (Some(Foot::Left), _) => "hop_left",
            (Some(Foot::Right), _) => "hop_right",
            (None, None) => "stand",
            (None, Some((Foot::Left, _))) => "walk_left",
            (None, Some((Foot::Right, _))) => "walk_right",
        };
        let pose = if self.carrying { format!("carry_{pose}") } else { pose.to_owned() };
        if self.ports.last().is_none_or(|p| p.0 != self.now) {
            self.ports.push((self.now, pose));
        }
    }

    /// Takes back the port at the cursor, where a gesture already runs.
    pub fn unmark(&mut self) {
        self.ports.retain(|p| p.0 != self.now);
    }

    /// Brings a walk to its end, so that the person stands for the rest of the take.
    pub fn finish(&mut self) {
        if let Some((_, gait)) = self.walking {
            self.walk(gait, 1);
            self.stop(0.0);
        }
    }

    /// The whole performance is moved so that the path is at `place` at the cursor.
    pub fn put(&mut self, place: Ground) {
        self.anchor = (self.now, place);
    }

    /// The path in the world up to `end` frames.
    pub fn path(&self, end: i32) -> Path {
        let (frame, place) = self.anchor;
        let local = self.plan.build(secs(end) + 2.0, Ground::IDENTITY).at(secs(frame));
        self.plan.build(secs(end) + 2.0, place.then(local.inverse()))
    }

    /// Stands for `frames`, without a port at the end.
    pub fn wait(&mut self, frames: i32) {
        self.now += frames;
    }

    /// Stands still for `frames`; port at the end.
    pub fn stand(&mut self, frames: i32) {
        self.wait(frames);
        self.mark();
    }

    /// From standing into a walk, `foot` first, turning by `turn` radians; port at the second mid-stance.
    pub fn start(&mut self, foot: Foot, gait: Gait, turn: f32) {
        let (t0, span) = (self.t(), START);
        let at = |u: f32| t0 + u * secs(span);
        let (t1, t2) = (at(1.0), at(1.0) + secs(gait.half));
        // Who turns far turns first.
        let delay = 0.1 + 0.22 * (turn.abs() / std::f32::consts::FRAC_PI_2).min(1.2);
        self.plan.speeds.extend([(at(delay), 0.0), (t1 + 0.60 * secs(gait.half), gait.speed)]);
        self.turn(turn, at(0.12), t2 - 0.1 * secs(gait.half));
        self.phase.mid_stance(t0, foot != Foot::Left);
        self.phase.mid_stance(t1, foot == Foot::Left);
        self.lift(foot, [at(0.0), at(0.18), at(0.36)], 0.75 * off_pitch(gait.speed));
        self.land(
            foot,
            Base::Walk,
            t1,
            Ground::IDENTITY,
            [at(0.68), at(0.79), at(0.86)],
            0.7 * strike_pitch(gait.speed),
        );
        self.lift(other(foot), [at(0.68), at(0.56), at(0.85)], off_pitch(gait.speed));
        self.now += span;
        self.walking = Some((foot, gait));
        self.half(gait, 0.0);
    }

    /// Half a cycle, to the other foot's mid-stance, arriving at `gait`'s speed; port at the end.
    pub fn half(&mut self, gait: Gait, turn: f32) {
        let (t0, t1) = (self.t(), self.t() + secs(gait.half));
        let from = self.half_step(gait, Base::Walk, t1, gait.speed);
        if from.speed != gait.speed {
            self.plan.speeds.extend([(t0, from.speed), (t1, gait.speed)]);
        }
        self.turn(turn, t0, t1);
        self.mark();
    }

    /// Moves on by half a cycle; the foot that lands is placed for time `at`. Returns the gait before.
    fn half_step(&mut self, gait: Gait, base: Base, at: f32, speed: f32) -> Gait {
        let (foot, before) = self.walking.expect("walking");
        let u = |u: f32| self.t() + u * secs(gait.half);
        let (lift, land, mid) = ([u(0.43), u(0.24), u(0.69)], [u(0.43), u(0.61), u(0.69)], u(1.0));
        self.lift(foot, lift, off_pitch(before.speed.min(speed.max(0.6))));
        self.land(other(foot), base, at, Ground::IDENTITY, land, strike_pitch(before.speed));
        self.phase.mid_stance(mid, foot != Foot::Left);
        self.now += gait.half;
        self.walking = Some((other(foot), gait));
        before
    }

    /// `count` half cycles.
    pub fn walk(&mut self, gait: Gait, count: usize) {
        for _ in 0..count {
            self.half(gait, 0.0);
        }
    }

    /// `count` half cycles over which the path turns by `angle`, walking as slow as `dip` times the speed in it.
    pub fn walk_turn(&mut self, gait: Gait, count: usize, angle: f32, dip: f32) {
        let t0 = self.t();
        let t1 = t0 + secs(gait.half * count as i32);
        self.turn(angle, t0 - 0.05, t1 + 0.05);
        self.plan.speeds.extend([(t0, gait.speed), (0.5 * (t0 + t1), gait.speed * dip), (t1, gait.speed)]);
        let from = self.now;
        self.walk(gait, count);
        // No port in the middle of a turn.
        let to = self.now;
        self.ports.retain(|p| p.0 <= from || p.0 >= to);
    }

    /// From mid-stance to standing, turning by `turn`; port at the end.
    pub fn stop(&mut self, turn: f32) {
        let (_, gait) = self.walking.expect("walking");
        let (t0, half) = (self.t(), secs(gait.half));
        let (t1, end) = (t0 + half, t0 + half + secs(STOP));
        self.plan.speeds.extend([(t0 + 0.05 * half, gait.speed), (t1 + 0.62 * secs(STOP), 0.0)]);
        self.turn(turn, t0, t1 + 0.5 * secs(STOP));
        self.half_step(gait, Base::Stand, end, 0.0);
        let last = self.walking.expect("walking").0;
        let at = |u: f32| t1 + u * secs(STOP);
        self.land(other(last), Base::Stand, end, Ground::IDENTITY, [at(0.34), at(0.44), at(0.8)], 0.02);
        self.phase.mid_stance(end, last != Foot::Left);
        self.now += STOP;
        self.walking = None;
        self.mark();
    }

    /// A step from standing to standing: `foot` lands at `offset` from where the path is at the cursor, relative to
    /// its neutral place. No port.
    pub fn step(&mut self, foot: Foot, offset: Ground, frames: i32) {
        let t0 = self.t();
        let at = |u: f32| t0 + u * secs(frames);
        // Stepping back, the foot leaves flat.
        let off_pitch = if offset.position.y < -0.1 { 0.15 } else { 0.42 };
        self.lift(foot, [at(-0.25), at(0.06), at(0.34)], off_pitch);
        self.land(foot, Base::Stand, t0, offset, [at(0.84), at(0.92), at(1.25)], 0.02);
        self.now += frames;
    }

    /// The path turns by `angle` between two times (s).
    pub fn turn(&mut self, angle: f32, t0: f32, t1: f32) {
        if angle != 0.0 {
            self.plan.turns.push((t0, t1, angle));
        }
    }

    /// The path moves by `by` (left, forward) over `seconds` from the cursor on, beginning after `delay`.
    pub fn shift(&mut self, by: Vec2, delay: f32, seconds: f32) {
        let t0 = self.t() + delay;
        self.plan.shifts.push((t0, t0 + seconds, by));
    }

    /// Turns in place by `angle` with `steps` steps of `frames` each, the left foot first; port at the end.
    pub fn pivot(&mut self, angle: f32, steps: usize, frames: i32) {
        let t0 = self.t();
        let total = frames * steps as i32;
        self.turn(angle, t0 - 0.05, t0 + secs(total));
        let (mut foot, began) = (if angle > 0.0 { Foot::Left } else { Foot::Right }, self.now);
        for k in 0..steps {
            // The last step brings the feet together; the ones before go ahead of the body.
            let share = ((k + 1) as f32 / (steps - 1).max(1) as f32).min(1.0);
            self.step_from(foot, began, Ground::new(Vec2::ZERO, angle * share), frames);
            foot = other(foot);
        }
        self.wait(7);
        self.mark();
    }

    /// Like [`Self::step`], the offset relative to the path at frame `origin`.
    pub fn step_from(&mut self, foot: Foot, origin: i32, offset: Ground, frames: i32) {
        self.step(foot, offset, frames);
        let stances = &mut self.feet[foot as usize].stances;
        stances.last_mut().expect("a stance").placement.at = secs(origin);
    }

    /// The last stance planned of a foot ends.
    pub fn lift(&mut self, foot: Foot, [unload, heel_off, toe_off]: [f32; 3], off_pitch: f32) {
        let stance = self.feet[foot as usize].stances.last_mut().expect("a stance");
        (stance.unload, stance.heel_off, stance.toe_off, stance.off_pitch) = (unload, heel_off, toe_off, off_pitch);
    }

    /// The swing after the last stance planned of a foot goes high.
    pub fn hop(&mut self, foot: Foot, hop: Hop) {
        self.feet[foot as usize].stances.last_mut().expect("a stance").hop = Some(hop);
    }

    /// A new stance of a foot.
    pub fn land(
        &mut self,
        foot: Foot,
        base: Base,
        at: f32,
        offset: Ground,
        [strike, flat, loaded]: [f32; 3],
        strike_pitch: f32,
    ) {
        let placement = Placement { base, at, offset };
        let (place, hop) = (Ground::IDENTITY, None);
        let (unload, heel_off, toe_off, off_pitch) = (NEVER, NEVER, 2.0 * NEVER, 0.0);
        let stance = Stance {
            foot,
            placement,
            strike,
            flat,
            loaded,
            unload,
            heel_off,
            toe_off,
            strike_pitch,
            off_pitch,
            hop,
            place,
        };
        self.feet[foot as usize].stances.push(stance);
    }
}

/// Frames from standing to the first mid-stance, and from the last mid-stance to standing.
const START: i32 = 30;
const STOP: i32 = 25;

pub(super) fn strike_pitch(speed: f32) -> f32 {
    (6.0 + 11.0 * (speed / 1.3)).to_radians()
}

fn off_pitch(speed: f32) -> f32 {
    (44.0 + 12.0 * (speed / 1.3)).to_radians()
}
