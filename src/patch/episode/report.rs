//! What came of a take: its events, and of every two people why there is none.

use std::fmt;

use super::attention::Couple;
use super::event::{Event, Sign};
use super::signals::Signals;
use super::thresholds::Thresholds;

/// What was found between two people.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PairReport {
    /// The two people, in order.
    pub people: [usize; 2],
    /// Number of frames that both have.
    pub frames: usize,
    /// Smallest distance of their hips on the ground, metres; infinite if they share no frame.
    pub nearest: f32,
    /// The frame of it.
    pub nearest_frame: usize,
    /// While they are near: how many times above its threshold the strongest action is; 0 if they never are.
    pub reaction: f32,
    /// How many times above its threshold the synchronicity gets.
    pub synchronicity: f32,
    /// Number of signs found.
    pub signs: usize,
    /// Distance below which they count as near, metres.
    pub near: f32,
}

impl PairReport {
    pub(super) fn of(couple: &Couple, signs: &[Sign]) -> Self {
        let frames = 0..couple.frames();
        let nearest = frames.clone().map(|f| (couple.apart(f), f)).min_by(|a, b| a.0.total_cmp(&b.0));
        let near = frames.clone().filter(|&f| couple.apart(f) < couple.options.near);
        Self {
            people: couple.people,
            frames: couple.frames(),
            nearest: nearest.map_or(f32::INFINITY, |n| n.0),
            nearest_frame: nearest.map_or(0, |n| n.1),
            reaction: near.map(|f| couple.reaction(f)).fold(0.0, f32::max),
            synchronicity: frames.map(|f| couple.synchronicity(f)).fold(0.0, f32::max),
            signs: signs.len(),
            near: couple.options.near,
        }
    }
}

impl fmt::Display for PairReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [a, b] = self.people;
        write!(f, "people {a} and {b}: ")?;
        if self.frames == 0 {
            return write!(f, "they share no frame");
        }
        write!(f, "nearest {:.2} m apart at frame {}; ", self.nearest, self.nearest_frame)?;
        if self.signs > 0 {
            return write!(f, "{} found", plural(self.signs, "sign"));
        }
        if self.nearest >= self.near {
            write!(f, "they never meet (nearer than {:.2} m)", self.near)?;
        } else if self.reaction < 1.0 {
            let share = 100.0 * self.reaction;
            write!(f, "nobody touches, and nobody reacts noticeably while near ({share:.0} % of the threshold)")?;
        } else {
            write!(f, "nobody touches, and reactions while near are too short")?;
        }
        match self.synchronicity {
            0.0 => write!(f, "; they never both act in sight of each other"),
            s if s < 1.0 => write!(f, "; when both act they look away ({:.0} % of the threshold)", 100.0 * s),
            _ => write!(f, "; what they do together is too short"),
        }
    }
}

/// What was found in a take.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Detection {
    /// The events, sorted by begin.
    pub events: Vec<Event>,
    /// Every two people.
    pub pairs: Vec<PairReport>,
    /// Number of frames of everybody.
    pub frames: Vec<usize>,
    /// What counted as acting noticeably.
    pub thresholds: Thresholds,
    /// What events were told by, frame by frame.
    pub signals: Signals,
}

impl Detection {
    /// Why there are no events; `None` where there are.
    pub fn why_nothing(&self) -> Option<String> {
        if !self.events.is_empty() {
            return None;
        }
        let longest = self.frames.iter().copied().max().unwrap_or(0);
        Some(match self.frames.len() {
            0 => "no event: expected people, found none".into(),
            1 => format!("no event: expected at least two people, found one ({})", plural(longest, "frame")),
            people if longest < 2 => {
                format!("no event: expected at least two frames, found {longest} of {people} people, nobody touching")
            }
            _ => {
                let pairs: Vec<String> = self.pairs.iter().map(PairReport::to_string).collect();
                format!("no event: {}", pairs.join("; "))
            }
        })
    }
}

fn plural(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}
