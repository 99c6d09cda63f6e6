//! What an event asks of a patch: relative placement stays, who touches still touches.

use super::event::{Event, Sign};
use crate::geom::Ground;
use crate::motion::Motion;
use crate::patch::{Contact, Touch};

/// Two people's relative placement over an event's frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// Roles: indices into the event's people.
    pub roles: [u32; 2],
    /// First frame of the take.
    pub begin: usize,
    /// At every frame from `begin` on, the second's local frame as the first's sees it.
    pub first_from_second: Vec<Ground>,
}

/// What must not change of an event when its people's motion is deformed.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraints {
    /// First and last frame of the interaction, on the patch's clock.
    pub core: (u32, u32),
    /// Relative placement of any two people who have a sign in common, over its frames.
    pub placements: Vec<Placement>,
    /// Hands, bodies and heads that touch, on the patch's clock.
    pub contacts: Vec<Contact>,
}

impl Event {
    /// The constraints of this event in a patch whose roles are its people and whose clock begins at frame `start` of
    /// the take (at most the event's begin). `motions` are the take's.
    pub fn constraints(&self, motions: &[Motion], start: usize) -> Constraints {
        let clock = |frame: usize| frame.saturating_sub(start) as u32;
        Constraints {
            core: (clock(self.begin), clock(self.end)),
            placements: self.signs.iter().map(|s| self.placement(s, motions)).collect(),
            contacts: self.contacts(start),
        }
    }

    fn role(&self, person: usize) -> u32 {
        self.people.iter().position(|&p| p == person).expect("signs are of the event's people") as u32
    }

    fn placement(&self, sign: &Sign, motions: &[Motion]) -> Placement {
        let [a, b] = sign.people;
        let at = |frame: usize| motions[a].path.at(frame).inverse().then(motions[b].path.at(frame));
        Placement {
            roles: sign.people.map(|p| self.role(p)),
            begin: sign.begin,
            first_from_second: (sign.begin..=sign.end).map(at).collect(),
        }
    }

    /// Contacts that patches know: those of arms and legs are kept by relative placement alone.
    fn contacts(&self, start: usize) -> Vec<Contact> {
        let clock = |frame: usize| frame.saturating_sub(start) as u32;
        let contacts = self.touching().filter_map(|t| {
            let a = Touch { role: self.role(t.a.0), part: t.a.1.part()? };
            let b = Touch { role: self.role(t.b.0), part: t.b.1.part()? };
            Some(Contact { a, b, begin: clock(t.begin), end: clock(t.end) })
        });
        contacts.collect()
    }
}
