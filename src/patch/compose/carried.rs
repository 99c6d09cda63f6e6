//! Boxes in the hands of people whose clips know of none: a compose file says where a box is, seen from them, at some
//! moments, and their arms are led onto it. The hands reach for it before and leave it afterwards; where a box is in
//! them already at a port, the port is one of people who carry.

use glam::{Quat, Vec2, Vec3};

use super::chain::Chain;
use super::clip::Grasp;
use super::prop::Found;
use super::story::{Carried, Composition, Prop, bad};
use crate::Result;
use crate::geom::{Ground, Upright};
use crate::motion::contacts::{PALM_DEPTH, palm, palm_in_hand};
use crate::motion::{Foot, JOINT_COUNT, Motion, arm, canonical};

/// Frames over which hands reach for a box before they have it, and over which they leave it.
const REACH: usize = 26;
/// Hands that reach for a box are farther apart than on it by up to this much on either side, metres.
const OPEN: f32 = 0.14;
/// Palms may be this far from where they hold a box, metres.
const MISS: f32 = 0.01;
/// Where elbows point in the chest's frame, for the left one: close, down, back.
const ELBOW: Vec3 = Vec3::new(0.35, -1.0, -0.7);
/// Rounds in which a hand's direction and the forearm's settle.
const ROUNDS: usize = 3;
/// What fingers do not point higher or lower than, as a slope: those of arms that hang down point forward as well.
const STEEPEST: f32 = 1.2;

/// Leads the arms of all who carry a box that their clips know nothing of. O(frames carried).
///
/// # Errors
/// Moments that do not exist or are out of order; a box that arms cannot reach.
pub(super) fn lead(story: &Composition, props: &[Found], chains: &mut [Chain]) -> Result<()> {
    for (prop, found) in story.props.iter().zip(props) {
        for (used, (role, grasp, _)) in prop.held.iter().zip(&found.uses).filter(|(u, _)| !u.carried.is_empty()) {
            let way = Way::new(prop, &used.carried, &chains[*role])?;
            let hold = Hold { way, found, grasp };
            let chain = &mut chains[*role];
            if let Some((miss, frame)) = hold.lead(&mut chain.motion) {
                let expected = format!("expected it within reach of {}'s hands", story.roles[*role].name);
                let problem = format!("{expected}, found it {miss:.2} m out of reach at {}", chain.name(frame));
                return Err(bad(prop.line, format!("prop {}: {problem}", prop.name)));
            }
            for (port, _) in [&mut chain.entry, &mut chain.exit].into_iter().zip(grasp.whole).filter(|p| !p.1) {
                *port = format!("carry_{port}");
            }
        }
    }
    Ok(())
}

/// Where a box is, seen from who carries it: above the hips and ahead of them, smoothly from moment to moment.
struct Way(Vec<(usize, Vec2)>);

impl Way {
    fn new(prop: &Prop, carried: &[Carried], chain: &Chain) -> Result<Self> {
        let mut moments: Vec<(usize, Vec2)> = Vec::new();
        for c in carried {
            let frame = chain.frame(&c.at, prop.line)?;
            if moments.last().is_some_and(|before| before.0 >= frame) {
                let expected = format!("prop {}: expected moments in order", prop.name);
                return Err(bad(prop.line, format!("{expected}, found '{}' after a later one", c.at.text)));
            }
            moments.push((frame, Vec2::new(c.up - chain.motion.heights[frame], c.ahead)));
        }
        Ok(Self(moments))
    }

    fn at(&self, frame: usize) -> Vec2 {
        let next = self.0.partition_point(|m| m.0 <= frame);
        if next == 0 || next == self.0.len() {
            return self.0[next.saturating_sub(1)].1;
        }
        let ((from, a), (to, b)) = (self.0[next - 1], self.0[next]);
        let frames = (to - from) as f32;
        let t = (frame - from) as f32 / frames;
        let left = 1.0 - t;
        let [out, into] = [next - 1, next].map(|i| self.rate(i) * frames);
        a * (left * left * (1.0 + 2.0 * t)) + b * (t * t * (1.0 + 2.0 * left)) + (out * left - into * t) * (t * left)
    }

    /// How fast it moves at a moment, per frame: it rests at the first and last, and turns back nowhere else (Fritsch and
    /// Butland 1984).
    fn rate(&self, moment: usize) -> Vec2 {
        if moment == 0 || moment + 1 == self.0.len() {
            return Vec2::ZERO;
        }
        let between = |i: usize| (self.0[i + 1].1 - self.0[i].1) / (self.0[i + 1].0 - self.0[i].0) as f32;
        let harmonic = |a: f32, b: f32| if a * b > 0.0 { 2.0 * a * b / (a + b) } else { 0.0 };
        let (before, after) = (between(moment - 1), between(moment));
        Vec2::new(harmonic(before.x, after.x), harmonic(before.y, after.y))
    }
}

/// A box in somebody's hands.
struct Hold<'a> {
    way: Way,
    found: &'a Found,
    grasp: &'a Grasp,
}

impl Hold<'_> {
    /// Where the box is at a frame: in the hands, or where it is taken up and put down.
    fn place(&self, motion: &Motion, frame: usize) -> Upright {
        let frame = frame.clamp(self.grasp.span[0], self.grasp.span[1]);
        let seen = self.way.at(frame);
        let Ground { position, heading } = motion.path.at(frame).then(Ground::new(Vec2::new(0.0, seen.y), 0.0));
        Upright { middle: Vec3::new(position.x, motion.heights[frame] + seen.x, position.y), heading }
    }

    /// Bends the arms. The farthest that a palm stays off the box, and when, if that is too far.
    fn lead(&self, motion: &mut Motion) -> Option<(f32, usize)> {
        let ([first, last], end) = (self.grasp.span, motion.len() - 1);
        // Whoever stands at a port has nothing to reach for yet.
        let reach = [first, end - last].map(|frames| frames.min(REACH));
        let mut worst: Option<(f32, usize)> = None;
        for frame in first - reach[0]..=last + reach[1] {
            let away = [(first.saturating_sub(frame), reach[0]), (frame.saturating_sub(last), reach[1])];
            let away = away.map(|(frames, of)| frames as f32 / of.max(1) as f32);
            let weight = eased(1.0 - away[0].max(away[1]));
            let place = self.place(motion, frame);
            for side in [Foot::Left, Foot::Right] {
                let miss = self.lead_arm(motion, frame, side, place, weight);
                if (first..=last).contains(&frame) && miss > worst.map_or(MISS, |w| w.0) {
                    worst = Some((miss, frame));
                }
            }
        }
        worst
    }

    /// Bends one arm, and answers how far its palm stays off.
    fn lead_arm(&self, motion: &mut Motion, frame: usize, side: Foot, place: Upright, weight: f32) -> f32 {
        let (joints, sign) = (arm::joints(side), arm::sign(side));
        let out = 0.5 * self.found.size[0] + PALM_DEPTH + OPEN * (1.0 - weight);
        let target = place.apply(Vec3::new(sign * out, -self.found.grip[0], -self.found.grip[1]));
        let axis = |along: Vec3| Upright { middle: Vec3::ZERO, ..place }.apply(along);
        let (forward, facing) = (axis(Vec3::Z), axis(Vec3::X * -sign));

        let mut globals = Vec::with_capacity(JOINT_COUNT);
        motion.globals(frame, &mut globals);
        let pose = frame * JOINT_COUNT..(frame + 1) * JOINT_COUNT;
        let girdle = &mut motion.rotations[pose.start + joints[0]];
        *girdle = girdle.slerp(arm::shrug(&globals, side, target) * *girdle, weight).normalize();
        motion.globals(frame, &mut globals);

        // Fingers go on as the forearm does, which depends on where the wrist is: a few rounds settle it.
        let (mut fingers, mut solved) = (forward, [Quat::IDENTITY; 3]);
        for _ in 0..ROUNDS {
            let hand = arm::hand_rotation(side, fingers, facing);
            let wrist = target - hand * palm_in_hand(joints[3]);
            solved = arm::reach(&globals, side, wrist, hand, ELBOW);
            let upper = globals[joints[0]].1 * solved[0];
            let elbow = globals[joints[1]].0 + upper * canonical().joints[joints[2]].offset;
            fingers = slanted(target - elbow, forward);
        }
        for (&joint, to) in joints[1..].iter().zip(solved) {
            let own = &mut motion.rotations[pose.start + joint];
            *own = own.slerp(to, weight).normalize();
        }
        motion.globals(frame, &mut globals);
        palm(&globals, joints[3]).distance(target)
    }
}

/// A direction on the side of a box: as another one points, but neither back nor steeply up or down.
fn slanted(like: Vec3, forward: Vec3) -> Vec3 {
    let slope = like.y / like.dot(forward).max(0.05);
    (forward + Vec3::Y * slope.clamp(-STEEPEST, STEEPEST)).normalize()
}

/// From 0 to 1, smooth at both ends.
fn eased(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (10.0 + x * (6.0 * x - 15.0))
}
