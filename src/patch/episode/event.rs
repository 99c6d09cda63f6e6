//! What is found: signs between two people, and the events they make.

use crate::motion::{BodyPart, mirror};

/// Why something is an event (paper section 4.1), from the strongest reason to the weakest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    /// They touch.
    Contact,
    /// They are near each other, and one of them reacts.
    Proximity,
    /// They act at the same time, and see each other.
    Synchronicity,
}

/// Part of a body that can touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Region {
    /// Left hand.
    LeftHand,
    /// Right hand.
    RightHand,
    /// Left arm without the hand.
    LeftArm,
    /// Right arm without the hand.
    RightArm,
    /// Hips, chest, back, shoulders.
    Torso,
    /// Head.
    Head,
    /// Left leg with the foot.
    LeftLeg,
    /// Right leg with the foot.
    RightLeg,
}

impl Region {
    /// All regions, in order.
    pub const ALL: [Self; 8] = [
        Self::LeftHand,
        Self::RightHand,
        Self::LeftArm,
        Self::RightArm,
        Self::Torso,
        Self::Head,
        Self::LeftLeg,
        Self::RightLeg,
    ];

    /// The part that a patch's contacts know it as; arms and legs are none.
    pub fn part(self) -> Option<BodyPart> {
        match self {
            Self::LeftHand => Some(BodyPart::LeftHand),
            Self::RightHand => Some(BodyPart::RightHand),
            Self::Torso => Some(BodyPart::Torso),
            Self::Head => Some(BodyPart::Head),
            _ => None,
        }
    }

    /// The region on the other side of the body.
    pub fn mirrored(self) -> Self {
        match self {
            Self::LeftArm => Self::RightArm,
            Self::RightArm => Self::LeftArm,
            Self::LeftLeg => Self::RightLeg,
            Self::RightLeg => Self::LeftLeg,
            other => match other.part().map(mirror::part) {
                Some(BodyPart::LeftHand) => Self::LeftHand,
                Some(BodyPart::RightHand) => Self::RightHand,
                _ => other,
            },
        }
    }

    /// The region that a capsule of [`crate::motion::BODY_CAPSULES`] belongs to.
    pub fn of_capsule(capsule: usize) -> Self {
        match capsule {
            0..=2 => Self::Torso,
            3 => Self::Head,
            4 | 6 | 8 => Self::LeftLeg,
            5 | 7 | 9 => Self::RightLeg,
            10 | 12 => Self::LeftArm,
            11 | 13 => Self::RightArm,
            14 => Self::LeftHand,
            _ => Self::RightHand,
        }
    }
}

/// Two regions of two people that touch over some frames.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Touching {
    /// One side: person of the take and region.
    pub a: (usize, Region),
    /// The other.
    pub b: (usize, Region),
    /// First frame, at [`crate::motion::FPS`].
    pub begin: usize,
    /// Last frame, inclusive.
    pub end: usize,
    /// How near the two surfaces come, metres; negative where the capsules overlap.
    pub gap: f32,
}

/// One reason between two people: what events are merged from.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Sign {
    /// Which reason.
    pub kind: EventKind,
    /// The two people, in order.
    pub people: [usize; 2],
    /// First frame, at [`crate::motion::FPS`].
    pub begin: usize,
    /// Last frame, inclusive.
    pub end: usize,
    /// For contacts: what touches, sorted by begin.
    pub touching: Vec<Touching>,
}

/// An event among two or more people.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Event {
    /// The strongest reason.
    pub kind: EventKind,
    /// Who takes part, in order.
    pub people: Vec<usize>,
    /// First frame, at [`crate::motion::FPS`].
    pub begin: usize,
    /// Last frame, inclusive.
    pub end: usize,
    /// All reasons, sorted by begin.
    pub signs: Vec<Sign>,
}

impl Event {
    /// The event made of signs; at least one.
    pub(super) fn of(mut signs: Vec<Sign>) -> Self {
        signs.sort_by_key(|s| (s.begin, s.end, s.kind, s.people));
        let mut people: Vec<usize> = signs.iter().flat_map(|s| s.people).collect();
        people.sort_unstable();
        people.dedup();
        Self {
            kind: signs.iter().map(|s| s.kind).min().expect("an event has signs"),
            people,
            begin: signs.iter().map(|s| s.begin).min().expect("an event has signs"),
            end: signs.iter().map(|s| s.end).max().expect("an event has signs"),
            signs,
        }
    }

    /// Everything that touches during the event.
    pub fn touching(&self) -> impl Iterator<Item = &Touching> {
        self.signs.iter().flat_map(|s| &s.touching)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{BODY_CAPSULES, joint};

    #[test]
    fn mirrored_capsules_are_of_the_mirrored_region() {
        for (i, capsule) in BODY_CAPSULES.iter().enumerate().filter(|(_, c)| c.a.0 != c.b.0 || c.a.0 != joint::HEAD) {
            let ends = [capsule.a.0, capsule.b.0].map(joint::mirror);
            let twin = BODY_CAPSULES.iter().position(|c| ends == [c.a.0, c.b.0] || ends == [c.b.0, c.a.0]).unwrap();
            assert_eq!(Region::of_capsule(twin), Region::of_capsule(i).mirrored(), "capsule {i}");
        }
        assert!(Region::ALL.iter().all(|r| r.mirrored().mirrored() == *r));
    }
}
