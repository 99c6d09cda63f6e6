//! What can be measured of a kind, and what its people do in words that follow from that: labels beside the free ones.

mod circle;

use glam::Vec2;

use super::{Fragment, PatchKind, PatchProp};
use crate::geom::Capsule;
use crate::motion::{FPS, body_capsules};
use circle::Outline;

/// Who is faster than this somewhere travels, m/s.
const TRAVELS: f32 = 0.5;
/// Who is slower than this at an end stands there, m/s.
const STANDS: f32 = 0.3;
/// Nobody walks faster than this, m/s: legs of 0.9 m fall into a run (Froude number 0.5).
const RUNS: f32 = 2.1;
/// Who goes less far than this from standing to standing makes a step, metres.
const STEP: f32 = 1.0;
/// Whose heading at the exit differs by more than this from that at the entry turns, degrees.
const TURNS: f32 = 20.0;
/// Whose hips come lower than this crouches, kneels, sits or lies, metres.
const LOW: f32 = 0.65;
/// Whose lowest point is higher than this jumps, metres.
const AIR: f32 = 0.08;
/// Frames on either side over which a speed is taken.
const AROUND: usize = 3;

/// What is measured of a kind. Angles and lengths do not depend on where the kind lies or which way round.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Measures {
    /// Number of people.
    pub people: usize,
    /// Seconds from the first entry to the last exit.
    pub seconds: f32,
    /// Mean speed over the ground of all people, m/s.
    pub speed: f32,
    /// Fastest speed of anybody over the ground, over a fifth of a second, m/s.
    pub fastest: f32,
    /// Radius of the smallest circle around all bodies and boxes at all times, seen from above, metres (to 0.1 %).
    pub radius: f32,
    /// Turn from entry to exit of who turns most, degrees, to the left positive.
    pub turn_deg: f32,
    /// Number of boxes that somebody holds.
    pub props: usize,
    /// What people do, in this order; every word that holds for anybody:
    ///
    /// - `stand`: is never faster than 0.5 m/s; else `run`: is somewhere faster than 2.1 m/s; else `step`: goes less than
    ///   1 m from standing (slower than 0.3 m/s) to standing; else `walk`;
    /// - `start`, `stop`: who travels and stands at the entry alone, or at the exit alone;
    /// - `turn`: heads more than 20 degrees elsewhere at the exit than at the entry;
    /// - `low`: hips come below 0.65 m (crouching, kneeling, sitting); `jump`: no part is below 0.08 m at some moment;
    /// - `together`: two people or more; `contact`: they touch; `prop`: somebody holds a box.
    pub words: Vec<&'static str>,
}

impl PatchKind {
    /// Measures the kind. O(frames of all people).
    pub fn measures(&self) -> Measures {
        let people: Vec<Person> = self.fragments.iter().map(Person::of).collect();
        let last = self.fragments.iter().map(|f| f.begin + f.motion.len() as u32).max().unwrap_or(0).saturating_sub(1);
        let (way, secs) = people.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.way, sum.1 + p.secs));
        let mut outline = Outline::default();
        people.iter().for_each(|p| outline.unite(&p.outline));
        self.props.iter().for_each(|prop| add_box(&mut outline, prop, self, last));
        let turns = people.iter().map(|p| p.turn_deg);
        Measures {
            people: people.len(),
            seconds: last as f32 / FPS,
            speed: if secs > 0.0 { way / secs } else { 0.0 },
            fastest: people.iter().map(|p| p.fastest).fold(0.0, f32::max),
            radius: outline.radius(),
            // The first of those who turn as much: max_by would take the last.
            turn_deg: turns.rev().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0),
            props: self.props.len(),
            words: self.words(&people),
        }
    }

    fn words(&self, people: &[Person]) -> Vec<&'static str> {
        let any = |does: fn(&Person) -> bool| people.iter().any(does);
        let told = [
            ("stand", any(|p| p.gait() == "stand")),
            ("step", any(|p| p.gait() == "step")),
            ("walk", any(|p| p.gait() == "walk")),
            ("run", any(|p| p.gait() == "run")),
            ("start", any(|p| p.stands == [true, false])),
            ("stop", any(|p| p.stands == [false, true])),
            ("turn", any(|p| p.turn_deg.abs() > TURNS)),
            ("low", any(|p| p.low)),
            ("jump", any(|p| p.jumps)),
            ("together", people.len() > 1),
            ("contact", !self.contacts.is_empty()),
            ("prop", !self.props.is_empty()),
        ];
        told.into_iter().filter(|(_, holds)| *holds).map(|(word, _)| word).collect()
    }
}

/// What is measured of one person.
struct Person {
    secs: f32,
    way: f32,
    fastest: f32,
    turn_deg: f32,
    /// At the entry and at the exit.
    stands: [bool; 2],
    low: bool,
    jumps: bool,
    outline: Outline,
}

impl Person {
    fn of(fragment: &Fragment) -> Self {
        let path = &fragment.motion.path;
        let last = path.len().saturating_sub(1);
        let speeds: Vec<f32> = (0..path.len()).map(|i| speed(&path.points, i)).collect();
        let fastest = speeds.iter().copied().fold(0.0, f32::max);
        let ends = [speeds.first(), speeds.last()].map(|s| s.copied().unwrap_or(0.0));
        let mut person = Self {
            secs: last as f32 / FPS,
            way: path.points.windows(2).map(|p| p[0].distance(p[1])).sum(),
            fastest,
            turn_deg: if last > 0 { (path.headings[last] - path.headings[0]).to_degrees() } else { 0.0 },
            stands: ends.map(|s| s < STANDS || fastest < TRAVELS),
            low: fragment.motion.heights.iter().any(|&h| h < LOW),
            jumps: false,
            outline: Outline::default(),
        };
        person.add_bodies(fragment);
        person
    }

    fn add_bodies(&mut self, fragment: &Fragment) {
        let (mut globals, mut capsules): (Vec<_>, Vec<Capsule>) = (Vec::new(), Vec::new());
        for frame in 0..fragment.motion.len() {
            fragment.motion.globals(frame, &mut globals);
            capsules.clear();
            body_capsules(&globals, &mut capsules);
            for c in &capsules {
                self.outline.add(Vec2::new(c.a.x, c.a.z), c.radius);
                self.outline.add(Vec2::new(c.b.x, c.b.z), c.radius);
            }
            self.jumps |= capsules.iter().all(|c| c.a.y.min(c.b.y) - c.radius > AIR);
        }
    }

    fn gait(&self) -> &'static str {
        match self.fastest {
            v if v <= TRAVELS => "stand",
            v if v > RUNS => "run",
            _ if self.stands == [true, true] && self.way < STEP => "step",
            _ => "walk",
        }
    }
}

/// Speed over the frames around one, m/s.
fn speed(points: &[Vec2], at: usize) -> f32 {
    let (first, last) = (at.saturating_sub(AROUND), (at + AROUND).min(points.len() - 1));
    points[first].distance(points[last]) * FPS / (last - first).max(1) as f32
}

/// Adds the corners of a box at all times at which it is there.
fn add_box(outline: &mut Outline, prop: &PatchProp, kind: &PatchKind, last: u32) {
    for at in (0..=last).filter_map(|frame| prop.place(kind, frame)) {
        let (sin, cos) = at.heading.sin_cos();
        for (aside, ahead) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let (x, z) = (0.5 * aside * prop.size[0], 0.5 * ahead * prop.size[2]);
            outline.add(Vec2::new(at.middle.x + x * cos + z * sin, at.middle.z - x * sin + z * cos), 0.0);
        }
    }
}

#[cfg(test)]
mod tests;
