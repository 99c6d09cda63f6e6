//! Hands that are to touch are led together by bending arms, as hands of captures that touched are kept together.

use super::story::{Composition, bad};
use crate::motion::take::{TakeContact, Touch};
use crate::motion::{FPS, Motion, reach};
use crate::patch::{Contact, Fragment};
use crate::{Error, Result};

/// Hands may be this far apart where they are to touch, besides [`reach::CLOSE`], metres.
const MISS: f32 = 0.01;

/// Leads the hands of all contacts together. O(contacts x frames).
///
/// # Errors
/// Hands that do not come together: says how far they are apart, and when.
pub(super) fn lead(story: &Composition, contacts: &[Contact], fragments: &mut [Fragment]) -> Result<()> {
    for contact in contacts {
        let (first, mut motions) = together(contact, fragments);
        reach::keep(&mut motions, &[on_clock(contact, first)]);
        for (role, motion) in [contact.a.role, contact.b.role].into_iter().zip(motions) {
            let fragment = &mut fragments[role as usize];
            let from = (first - fragment.begin) as usize * crate::motion::JOINT_COUNT;
            fragment.motion.rotations[from..from + motion.rotations.len()].copy_from_slice(&motion.rotations);
        }
    }
    // Those led later may have taken others along.
    contacts.iter().zip(&story.touches).try_for_each(|(contact, touches)| {
        let (first, motions) = together(contact, fragments);
        let misses = reach::misses(&motions, &on_clock(contact, first));
        let (at, miss) = misses.into_iter().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0));
        if miss <= MISS { Ok(()) } else { Err(apart(story, touches, miss + reach::CLOSE, contact.begin + at as u32)) }
    })
}

/// What the two people of a contact do while both are there, and when that begins.
fn together(contact: &Contact, fragments: &[Fragment]) -> (u32, Vec<Motion>) {
    let both = [contact.a.role, contact.b.role].map(|role| &fragments[role as usize]);
    let first = both[0].begin.max(both[1].begin);
    let end = |f: &Fragment| f.begin + f.motion.len() as u32 - 1;
    let last = end(both[0]).min(end(both[1]));
    (first, both.map(|f| f.motion.slice((first - f.begin) as usize, (last - f.begin) as usize)).to_vec())
}

fn on_clock(contact: &Contact, first: u32) -> TakeContact {
    let side = |person: usize, part| Touch { person, part };
    let time = |tick: u32| (tick - first) as f32 / FPS;
    let (a, b) = (side(0, contact.a.part), side(1, contact.b.part));
    TakeContact { a, b, begin: time(contact.begin), end: time(contact.end) }
}

fn apart(story: &Composition, touches: &super::story::Touches, gap: f32, tick: u32) -> Error {
    let names = touches.sides.map(|(role, _)| story.roles[role].name.as_str());
    let when = format!("at {:.2} s of the patch", tick as f32 / FPS);
    let found = format!("found {} and {} {gap:.2} m apart {when}", names[0], names[1]);
    bad(touches.line, format!("expected hands that can reach each other, {found}"))
}
