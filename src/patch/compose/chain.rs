//! What somebody plays, as one motion: clips follow each other from port to port, and share the difference of their poses
//! as fragments do at stitches ([`crate::motion::fade`]).

use glam::{Quat, Vec2, Vec3};

use super::clip::{Cut, Grasp};
use super::story::{Clip, Moment, Role, bad};
use crate::Result;
use crate::geom::{Ground, wrap_angle};
use crate::motion::{FPS, JOINT_COUNT, Motion, MotionPath, Plant, fade};

/// Frames over which a difference is faded on either side of a joint.
const WINDOW: usize = 10;

/// A role's motion, which begins at the origin.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    pub motion: Motion,
    pub entry: String,
    pub exit: String,
    /// Frame at which each part begins, and the last frame.
    pub parts: Vec<usize>,
    /// The boxes in the hands or under the hips, in order of time.
    pub grasps: Vec<Grasp>,
    names: Vec<String>,
}

impl Chain {
    /// Joins the clips that a role plays.
    ///
    /// # Errors
    /// A clip ends in another pose group than the next begins with.
    pub fn new(role: &Role, clips: &[Clip], cuts: &[Cut]) -> Result<Self> {
        for pair in role.plays.windows(2) {
            let (before, after) = (&cuts[pair[0]], &cuts[pair[1]]);
            if before.exit != after.entry {
                let names = [&clips[pair[0]].name, &clips[pair[1]].name];
                let expected = format!("expected {} to begin with the pose '{}'", names[1], before.exit);
                let found = format!("in which {} ends, found '{}'", names[0], after.entry);
                return Err(bad(role.line, format!("role {}: {expected}, {found}", role.name)));
            }
        }
        let mut motion = moved(&cuts[role.plays[0]].motion, Ground::IDENTITY);
        let mut parts = vec![0, motion.len() - 1];
        let mut grasps = cuts[role.plays[0]].grasps.clone();
        for &clip in &role.plays[1..] {
            let joint = motion.len() - 1;
            join_grasps(&mut grasps, &cuts[clip].grasps, joint).map_err(|found| {
                let what = format!("where {} begins", clips[clip].name);
                bad(role.line, format!("role {}: expected the same box in the hands {what}, found {found}", role.name))
            })?;
            motion = join(motion, &cuts[clip].motion, parts[parts.len() - 2]);
            parts.push(motion.len() - 1);
        }
        Ok(Self {
            motion,
            parts,
            grasps,
            entry: cuts[role.plays[0]].entry.clone(),
            exit: cuts[*role.plays.last().expect("roles play something")].exit.clone(),
            names: role.plays.iter().map(|&clip| clips[clip].name.clone()).collect(),
        })
    }

    /// What lies there for some frames, as if it were somebody standing.
    pub fn still(name: &str, frames: usize) -> Self {
        let motion = Motion {
            path: MotionPath { points: vec![Vec2::ZERO; frames], headings: vec![0.0; frames] },
            ..Motion::default()
        };
        let parts = vec![0, frames - 1];
        let (entry, exit) = (String::new(), String::new());
        Self { motion, entry, exit, parts, grasps: vec![], names: vec![format!("the rest of {name}")] }
    }

    /// First and last frame of what a moment speaks of.
    pub fn span(&self, moment: &Moment) -> (usize, usize) {
        match moment.part {
            Some(part) => (self.parts[part], self.parts[part + 1]),
            None => (0, self.motion.len() - 1),
        }
    }

    /// The frame of a moment that is spoken of at `line`; the first one where it has no seconds.
    ///
    /// # Errors
    /// What it speaks of does not last so long.
    pub fn frame(&self, moment: &Moment, line: usize) -> Result<usize> {
        let (first, last) = self.span(moment);
        let frame = first + (moment.seconds.unwrap_or(0.0) * FPS).round() as usize;
        if frame > last {
            let lasts = (last - first) as f32 / FPS;
            let what = moment.text.split('@').next().unwrap_or("");
            return Err(bad(
                line,
                format!("expected a moment within the {lasts:.2} s of {what}, found '{}'", moment.text),
            ));
        }
        Ok(frame)
    }

    /// A frame, for messages: seconds of the clip that is played then.
    pub fn name(&self, frame: usize) -> String {
        let part = self.parts[1..].iter().position(|&end| frame < end).unwrap_or(self.names.len() - 1);
        format!("{:.2} s of {}", (frame - self.parts[part]) as f32 / FPS, self.names[part])
    }
}

/// Adds the grasps of a clip that begins at frame `joint`; what is in the hands there goes on.
fn join_grasps(grasps: &mut Vec<Grasp>, next: &[Grasp], joint: usize) -> std::result::Result<(), &'static str> {
    let mut next: Vec<Grasp> = next.iter().map(|g| Grasp { span: g.span.map(|f| f + joint), ..g.clone() }).collect();
    let before = grasps.iter_mut().find(|g| !g.whole[1] && g.span[1] == joint);
    let after = next.iter().position(|g| !g.whole[0] && g.span[0] == joint);
    match (before, after) {
        (None, None) => {}
        (Some(before), Some(i)) if before.is_like(&next[i]) => {
            let after = next.remove(i);
            (before.span[1], before.whole[1], before.source) = (after.span[1], after.whole[1], after.source);
        }
        (Some(_), Some(_)) => return Err("another"),
        (Some(_), None) => return Err("none, and one before"),
        (None, Some(_)) => return Err("one, and none before"),
    }
    grasps.append(&mut next);
    Ok(())
}

/// The motion, begun at `start`.
fn moved(motion: &Motion, start: Ground) -> Motion {
    let change = start.then(motion.path.at(0).inverse());
    let turn = start.heading - motion.path.headings[0];
    let mut out = motion.clone();
    out.path.points.iter_mut().for_each(|p| *p = change.apply(*p));
    out.path.headings.iter_mut().for_each(|h| *h += turn);
    out
}

/// One pose of a motion, as numbers that can be subtracted: path, height, joints.
struct State {
    at: Ground,
    height: f32,
    pose: Vec<Quat>,
}

/// A difference of states; on the ground along fixed axes.
struct Change {
    position: Vec2,
    heading: f32,
    height: f32,
    turns: Vec<Vec3>,
}

impl State {
    fn of(motion: &Motion, frame: usize) -> Self {
        Self { at: motion.path.at(frame), height: motion.heights[frame], pose: motion.pose(frame).to_vec() }
    }

    fn to(&self, other: &Self) -> Change {
        Change {
            position: other.at.position - self.at.position,
            heading: wrap_angle(other.at.heading - self.at.heading),
            height: other.height - self.height,
            turns: self.pose.iter().zip(&other.pose).map(|(&a, &b)| fade::turn_from(a, b)).collect(),
        }
    }
}

impl Change {
    fn minus(&self, other: &Self) -> Self {
        Self {
            position: self.position - other.position,
            heading: self.heading - other.heading,
            height: self.height - other.height,
            turns: self.turns.iter().zip(&other.turns).map(|(a, b)| a - b).collect(),
        }
    }
}

/// `before`, and where it ends `next`. Only the last part of `before`, from frame `part` on, is changed.
fn join(mut before: Motion, next: &Motion, part: usize) -> Motion {
    let last = before.len() - 1;
    let mut next = moved(next, before.path.at(last));
    let (exit, entry) = (State::of(&before, last), State::of(&next, 0));
    let rate = entry.to(&State::of(&next, 1)).minus(&State::of(&before, last - 1).to(&exit));
    let difference = exit.to(&entry);
    let windows = [last - part, next.len() - 1].map(|frames| WINDOW.min(frames / 2).max(1));
    for k in 0..windows[0] {
        add(&mut before, last - k, &difference, &rate, fade::before(0.5, windows[0] as f32, k as f32));
    }
    for k in 0..windows[1] {
        add(&mut next, k, &difference, &rate, fade::after(0.5, windows[1] as f32, k as f32));
    }
    append(&mut before, &next);
    before
}

fn add(motion: &mut Motion, frame: usize, difference: &Change, rate: &Change, (value, speed): (f32, f32)) {
    motion.path.points[frame] += difference.position * value + rate.position * speed;
    motion.path.headings[frame] += difference.heading * value + rate.heading * speed;
    motion.heights[frame] += difference.height * value + rate.height * speed;
    let pose = &mut motion.rotations[frame * JOINT_COUNT..(frame + 1) * JOINT_COUNT];
    for (j, q) in pose.iter_mut().enumerate() {
        let turn = difference.turns[j] * value + rate.turns[j] * speed;
        *q = (Quat::from_scaled_axis(turn) * *q).normalize();
    }
}

/// Adds all frames but the first, which is the last of the motion itself. Plants that go on are one.
fn append(motion: &mut Motion, next: &Motion) {
    let last = motion.len() - 1;
    motion.path.points.extend_from_slice(&next.path.points[1..]);
    motion.path.headings.extend_from_slice(&next.path.headings[1..]);
    motion.heights.extend_from_slice(&next.heights[1..]);
    motion.rotations.extend_from_slice(&next.rotations[JOINT_COUNT..]);
    for plant in &next.plants {
        let shifted = Plant { begin: plant.begin + last as u32, end: plant.end + last as u32, ..*plant };
        let earlier = motion.plants.iter_mut().find(|p| p.foot == plant.foot && p.end + 1 >= shifted.begin);
        match earlier {
            Some(earlier) => earlier.end = earlier.end.max(shifted.end),
            None => motion.plants.push(shifted),
        }
    }
    motion.plants.sort_by_key(|p| (p.begin, p.foot));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::testing::walking;
    use glam::Vec2;

    #[test]
    fn a_walk_cut_and_joined_is_the_walk() {
        let walk = moved(&walking(4.0), Ground::IDENTITY);
        let (cut, last) = (57, walk.len() - 1);
        let elsewhere = moved(&walk.slice(cut, last), Ground::new(Vec2::new(4.0, -1.0), 2.0));
        let joined = join(walk.slice(0, cut), &elsewhere, 0);
        assert_eq!((joined.len(), &joined.plants), (walk.len(), &walk.plants));
        for f in 0..walk.len() {
            assert!(joined.path.points[f].distance(walk.path.points[f]) < 5e-3, "frame {f}");
            assert!((joined.path.headings[f] - walk.path.headings[f]).abs() < 1e-2, "frame {f}");
            let turn = |j: usize| joined.pose(f)[j].angle_between(walk.pose(f)[j]);
            assert!((0..JOINT_COUNT).map(turn).fold(0.0, f32::max) < 0.05, "frame {f}");
        }
    }

    #[test]
    fn what_differs_is_shared_smoothly() {
        let mut late = walking(3.0);
        late.heights.iter_mut().for_each(|h| *h += 0.06);
        let joined = join(walking(3.0), &late, 0);
        let step = joined.heights.windows(2).map(|h| (h[1] - h[0]).abs()).fold(0.0, f32::max);
        let own = late.heights.windows(2).map(|h| (h[1] - h[0]).abs()).fold(0.0, f32::max);
        assert!(step < own + 0.012, "{step} after {own}");
    }
}
