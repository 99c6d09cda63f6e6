//! What events were told by, frame by frame: for pictures that explain the thresholds.

use super::attention::Couple;
use super::body::Body;
use super::thresholds::Thresholds;

/// What was measured of a person.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PersonSignals {
    /// Variation (eq. 4) at every frame, square metres.
    pub variation: Vec<f32>,
    /// Whether the person counts as travelling, by frame: another threshold holds then.
    pub travels: Vec<bool>,
}

/// What was measured of two people, at every frame that both have.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PairSignals {
    /// The two people, in order.
    pub people: [usize; 2],
    /// How near surfaces are, metres; negative where they overlap, 0.3 where they are farther apart than that.
    pub gap: Vec<f32>,
    /// Distance of the hips on the ground, metres.
    pub apart: Vec<f32>,
    /// How many times above its threshold the stronger variation is.
    pub reaction: Vec<f32>,
    /// How many times above its threshold the synchronicity (eq. 5) is.
    pub synchronicity: Vec<f32>,
}

/// What was measured in a take.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Signals {
    /// Of everybody.
    pub people: Vec<PersonSignals>,
    /// Of every two people.
    pub pairs: Vec<PairSignals>,
}

impl PersonSignals {
    pub(super) fn of(body: &Body) -> Self {
        Self {
            variation: body.variation.clone(),
            travels: (0..body.len()).map(|f| Thresholds::travels(body, f)).collect(),
        }
    }
}

impl PairSignals {
    pub(super) fn of(couple: &Couple, gap: Vec<f32>) -> Self {
        let frames = 0..couple.frames();
        Self {
            people: couple.people,
            gap,
            apart: frames.clone().map(|f| couple.apart(f)).collect(),
            reaction: frames.clone().map(|f| couple.reaction(f)).collect(),
            synchronicity: frames.map(|f| couple.synchronicity(f)).collect(),
        }
    }
}
