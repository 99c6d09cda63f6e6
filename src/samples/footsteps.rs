//! Feet: stances planted by the plan, the roll from heel to ball, and the swing between two stances.

use glam::{Quat, Vec2, Vec3};

use super::path::Path;
use super::timeline::{ease, hermite, ramp};
use crate::geom::Ground;
use crate::motion::Foot;

/// From the ankle to the ball of the foot (the toe joint), in the foot's frame.
const BALL: Vec3 = Vec3::new(0.0, -0.055, 0.125);
/// From the ankle to where the heel meets the ground.
const HEEL: Vec3 = Vec3::new(0.0, -0.075, -0.05);
/// Height of the ankle over the ground when the foot is flat.
const ANKLE: f32 = 0.075;
/// Half the distance of the ankles when walking and when standing.
const WALK_HALF_WIDTH: f32 = 0.055;
const STAND_HALF_WIDTH: f32 = 0.098;
/// The most the toes bend, radians.
const TOE_LIMIT: f32 = 0.87;

/// How a foot is placed relative to the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Base {
    /// Under the walking body at mid-stance.
    Walk,
    /// Beside the other foot.
    Stand,
}

/// Where a foot is put: relative to the path at time `at`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    pub base: Base,
    pub at: f32,
    pub offset: Ground,
}

/// One time a foot is on the ground. Times in seconds, angles in radians.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stance {
    pub foot: Foot,
    pub placement: Placement,
    /// The heel touches, the foot is flat, the foot carries its share.
    pub strike: f32,
    pub flat: f32,
    pub loaded: f32,
    /// The load leaves, the heel rises, the ball leaves.
    pub unload: f32,
    pub heel_off: f32,
    pub toe_off: f32,
    /// How far the toes point up when the heel strikes, and the heel is up when the toes leave.
    pub strike_pitch: f32,
    pub off_pitch: f32,
    /// How high the foot goes afterwards, if not as in a walk.
    pub hop: Option<Hop>,
    /// Filled in by [`Feet::place`]: the flat ankle's ground point and the foot's heading.
    pub place: Ground,
}

/// The swing of a foot that is drawn up high.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hop {
    /// How much higher than in a walk the ball gets, metres.
    pub height: f32,
    /// Parts of the swing's time at which it begins to be higher, is highest, and is as in a walk again.
    pub times: [f32; 3],
    /// Rates at which it gets higher at first and lower at last, m/s.
    pub rates: [f32; 2],
    /// When the foot comes by the other; a jump off both feet has no such moment.
    pub pass: Option<Pass>,
}

/// The moment at which a foot that is in the air comes by the other as it does in a walk.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    /// When, seconds.
    pub at: f32,
    /// Half a cycle of the walk, seconds, and its speed.
    pub half: f32,
    pub speed: f32,
    /// Filled in by [`Feet::place`]: where the ball is then, and how fast.
    pub place: Vec2,
    pub velocity: Vec2,
}

/// A walker's foot is in the air for this much of half a cycle.
pub(super) const SWING: f32 = 0.74;
/// The part of a walk's swing after which the foot comes by the other.
const PASS: f32 = 0.42;

impl Pass {
    /// As [`travel`] has it of a walk's step, whose length is a cycle's.
    fn settle(&mut self, path: &Path, foot: Foot) {
        let step = 2.0 * self.speed * self.half;
        let ahead = foothold(Base::Walk, foot).position.y + BALL.z + step * (travel(PASS) - 0.5);
        let body = path.at(self.at);
        self.place = body.apply(Vec2::new(1.2 * foothold(Base::Walk, foot).position.x, ahead));
        let rate = (travel(PASS + 0.01) - travel(PASS - 0.01)) / 0.02 / (SWING * self.half);
        self.velocity = body.turn().apply(Vec2::new(0.0, step * rate));
    }
}

impl Hop {
    /// How much higher than in a walk the ball is at a part of a swing of so many seconds.
    fn height_at(&self, part: f32, span: f32) -> f32 {
        let ([begin, top, end], [up, down]) = (self.times, self.rates);
        if !(begin..end).contains(&part) {
            return 0.0;
        }
        hermite(&[(begin, 0.0, up * span), (top, self.height, 0.0), (end, 0.0, down * span)], part)
    }

    /// The part of a walk's swing that has passed.
    fn walked(&self, part: f32, begin: f32, span: f32) -> f32 {
        let Some(pass) = self.pass else { return part };
        let (pass, rate) = ((pass.at - begin) / span, self.rate(span));
        let mut keys = vec![(0.0, 0.0, rate)];
        slow(&mut keys, (pass, PASS), rate);
        slow(&mut keys, (1.0, 1.0), rate);
        hermite(&keys, part)
    }

    /// How much of a walk's swing passes per time when the foot leaves and comes down.
    fn rate(&self, span: f32) -> f32 {
        self.pass.map_or(1.0, |pass| span / (SWING * pass.half))
    }
}

/// Keys from the last one to another, both passed at a rate; slower in between where there is time.
fn slow(keys: &mut Vec<(f32, f32, f32)>, to: (f32, f32), rate: f32) {
    let (at, value, _) = *keys.last().expect("a first key");
    let (time, third) = (to.0 - at, (to.1 - value) / 3.0);
    if rate * time > 4.5 * third {
        let (mut ends, mut middle) = (0.0, 0.0);
        for _ in 0..30 {
            ends = 2.0 * third / (rate + middle);
            middle = third / (time - 2.0 * ends);
        }
        keys.extend([(at + ends, value + third, middle), (to.0 - ends, to.1 - third, middle)]);
    }
    keys.push((to.0, to.1, rate));
}

/// A foot at one moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct FootPose {
    pub ankle: Vec3,
    pub rotation: Quat,
    /// How far the toes are bent up against the foot.
    pub toe: f32,
}

/// A foot of the neutral stance (or of mid-stance), relative to the path.
pub(super) fn foothold(base: Base, foot: Foot) -> Ground {
    let side = if foot == Foot::Left { 1.0 } else { -1.0 };
    match base {
        Base::Walk => Ground::new(Vec2::new(side * WALK_HALF_WIDTH, -0.055), side * 0.10),
        Base::Stand => Ground::new(Vec2::new(side * STAND_HALF_WIDTH, -0.025), side * 0.16),
    }
}

/// All stances of one foot, in order.
#[derive(Clone, Debug, Default)]
pub(super) struct Feet {
    pub stances: Vec<Stance>,
}

impl Feet {
    /// Puts every stance where the path wants it.
    pub fn place(&mut self, path: &Path) {
        for s in &mut self.stances {
            let Placement { base, at, offset } = s.placement;
            s.place = path.at(at).then(offset).then(foothold(base, s.foot));
            if let Some(pass) = s.hop.as_mut().and_then(|hop| hop.pass.as_mut()) {
                pass.settle(path, s.foot);
            }
        }
    }

    /// The share of the body's weight the foot would carry alone, in [0, 1].
    pub fn load(&self, t: f32) -> f32 {
        self.stances.iter().map(|s| ramp(t, s.strike, s.loaded) * (1.0 - ramp(t, s.unload, s.toe_off))).sum()
    }

    /// The foot at `t`; `lift` raises the heel of a planted foot further, a foot in the air follows
    /// `body`, the path's place.
    pub fn pose(&self, t: f32, lift: f32, body: Ground) -> FootPose {
        let next = self.stances.partition_point(|s| s.strike <= t);
        let now = &self.stances[next.saturating_sub(1)];
        match self.stances.get(next) {
            Some(after) if t > now.toe_off => swing(now, after, t, body),
            _ => planted(now, t, lift),
        }
    }
}

pub(super) fn pitched(yaw: f32, pitch: f32) -> Quat {
    Quat::from_rotation_y(yaw) * Quat::from_rotation_x(-pitch)
}

/// Pitch of a planted foot: down from the heel strike, up about the ball before it leaves.
fn stance_pitch(s: &Stance, t: f32) -> f32 {
    let landing = s.strike_pitch * (1.0 - landed(s, t));
    let u = ((t - s.heel_off) / (s.toe_off - s.heel_off)).clamp(0.0, 1.0);
    landing - s.off_pitch * u.powf(2.1)
}

fn landed(s: &Stance, t: f32) -> f32 {
    let u = ((t - s.strike) / (s.flat - s.strike).max(1e-3)).clamp(0.0, 1.0);
    1.0 - (1.0 - u) * (1.0 - u)
}

fn planted(s: &Stance, t: f32, lift: f32) -> FootPose {
    let pitch = stance_pitch(s, t) - lift;
    let flat_ankle = Vec3::new(s.place.position.x, ANKLE, s.place.position.y);
    let yaw = Quat::from_rotation_y(s.place.heading);
    let rotation = pitched(s.place.heading, pitch);
    let pivot = if pitch > 0.0 { HEEL } else { BALL };
    let ankle = flat_ankle + yaw * pivot - rotation * pivot;
    FootPose { ankle, rotation, toe: (-pitch).clamp(0.0, TOE_LIMIT) }
}

fn swing(from: &Stance, to: &Stance, t: f32, body: Ground) -> FootPose {
    let span = to.strike - from.toe_off;
    let part = (t - from.toe_off) / span;
    let u = from.hop.map_or(part, |hop| hop.walked(part, from.toe_off, span));
    let (start, goal) = (planted(from, from.toe_off, 0.0), planted(to, to.strike, 0.0));
    let (a, b) = (start.ankle + start.rotation * BALL, goal.ankle + goal.rotation * BALL);
    let walk = span / from.hop.map_or(1.0, |hop| hop.rate(span));
    let landing_rate = -2.0 * to.strike_pitch / (to.flat - to.strike).max(1e-3) * walk;
    let off_rate = -2.1 * from.off_pitch / (from.toe_off - from.heel_off).max(1e-3) * walk;
    let pitch = swing_pitch(from.off_pitch, off_rate, to.strike_pitch, landing_rate, u);
    let drop = landing_rate * 0.17;
    let distance = (b - a).length();
    let lift = 0.028 + 0.03 * (distance / 1.2).min(1.0);
    // The ball rises early, passes low while the foot comes by, and is high again before the heel strikes.
    let height = hermite(
        &[
            (0.0, a.y, 0.0),
            (0.28, a.y + lift, 0.05 * lift),
            (0.62, a.y + lift * 0.85 + 0.1 * (b.y - a.y), (b.y - a.y) * 1.2),
            (1.0, b.y, drop.min(-0.06)),
        ],
        u,
    ) + from.hop.map_or(0.0, |hop| hop.height_at(part, span));
    let travel = travel(u);
    let free = (std::f32::consts::PI * u).sin().powi(2);
    let mut ground = Vec2::new(a.x + (b.x - a.x) * travel, a.z + (b.z - a.z) * travel);
    if let Some(pass) = from.hop.and_then(|hop| hop.pass) {
        let (at, rate) = ((pass.at - from.toe_off) / span, pass.velocity * span);
        // A foot that leaves high does not stay behind.
        let quick = if from.hop.is_some_and(|hop| hop.rates[0] > 0.0) { 0.25 } else { 0.0 };
        let through = |a: f32, p: f32, v: f32, b: f32| hermite(&[(0.0, a, quick * v), (at, p, v), (1.0, b, 0.0)], part);
        ground = Vec2::new(through(a.x, pass.place.x, rate.x, b.x), through(a.z, pass.place.y, rate.y, b.z));
    }
    if from.placement.base == Base::Walk || to.placement.base == Base::Walk {
        // A walker's foot comes by close to the other, wherever it is from and goes to.
        let mut beside = body.inverse().apply(ground);
        beside.x += 0.8 * free * (1.2 * foothold(Base::Walk, to.foot).position.x - beside.x);
        ground = body.apply(beside);
    }
    let ball = Vec3::new(ground.x, height, ground.y);
    // In the air the foot looks where the body does.
    let placed = from.place.heading + (to.place.heading - from.place.heading) * ease(u);
    let heading = placed + (body.heading + foothold(Base::Walk, to.foot).heading - placed) * free;
    let rotation = pitched(heading, pitch);
    let toe = start.toe * (1.0 - ease(u / 0.35));
    FootPose { ankle: ball - rotation * BALL, rotation, toe }
}

/// The foot's pitch in swing: the heel rises on, then the toes come up for the strike.
fn swing_pitch(off: f32, off_rate: f32, strike: f32, landing_rate: f32, u: f32) -> f32 {
    hermite(
        &[
            (0.0, -off, off_rate),
            (0.14, -off * 1.06, 0.3 * off),
            (0.58, -off * 0.16, 1.5 * off + strike),
            (0.9, strike * 1.12, 0.2 * strike),
            (1.0, strike, landing_rate),
        ],
        u,
    )
}

/// Part of the way gone: quick off, even in the middle, soft at the end.
fn travel(u: f32) -> f32 {
    const UP: f32 = 0.34;
    const DOWN: f32 = 0.42;
    let rise = |x: f32| x * x * x - 0.5 * x * x * x * x; // integral of 3x^2 - 2x^3
    let speed = |u: f32| -> f32 {
        let gained = if u < UP { UP * rise(u / UP) } else { 0.5 * UP + (u.min(1.0 - DOWN) - UP) };
        if u <= 1.0 - DOWN { gained } else { gained + 0.5 * DOWN - DOWN * rise((1.0 - u) / DOWN) }
    };
    speed(u.clamp(0.0, 1.0)) / (1.0 - 0.5 * (UP + DOWN))
}
