//! Seeding: one more person, placed somewhere free and led by single-person patches to both edges of time.

use glam::Vec2;
use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;

use super::bridge::{NO_INSTANCE, STANDING_SPEED, Taste};
use super::domain::Spot;
use super::draft::Draft;
use super::library::{Library, Move};
use super::piece::Piece;
use super::prefer::Stay;
use super::tryout::is_clean;
use crate::geom::Ground;

/// Places tried for one person.
const PLACES: usize = 20;

/// Adds a person who is at a random place of the domain at first, until the end of time or out; one who begins with a box in the hands,
/// or by taking one up, if so wished.
pub(super) fn seed_person(draft: &mut Draft, laden: bool, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    let first = (0..PLACES).find_map(|_| first_piece(draft, laden, taste, rng))?;
    let (entry, exit) = (draft.base.library.entry_of(&first), draft.base.library.exit_of(&first));
    let mut pieces = vec![draft.add(first)];
    pieces.extend(draft.lead_to_the_end(entry, exit, taste, rng)?);
    draft.push_track(pieces);
    is_clean(draft).then_some(())
}

/// A free patch of one person that is going on at tick 0, or at any where time comes round.
fn first_piece(draft: &Draft, laden: bool, taste: Taste, rng: &mut ChaCha8Rng) -> Option<Piece> {
    let (library, domain) = (draft.base.library, draft.base.domain);
    let role = first_role(library, laden, taste, rng);
    let place = Vec2::new(rng.random_range(domain.min.x..domain.max.x), rng.random_range(domain.min.y..domain.max.y));
    let heading = rng.random_range(-std::f32::consts::PI..std::f32::consts::PI);
    let lead = rng.random_range(0..library.roles[role as usize].ticks);
    let tick = if domain.cycle.loops() { rng.random_range(0..domain.horizon) } else { 0 };
    let stay = Stay::new(Ground::new(place, heading), tick);
    let wanted = library.preference.is_wanted_there(library.roles[role as usize].kind, stay, rng);
    if !wanted || !domain.holds(Spot::ground(tick), place, 0.35) {
        return None;
    }
    // The place is where the person is at that tick, somewhere inside the first patch.
    let entry_from_start = library.roles[role as usize].path.at(lead as usize).inverse();
    let start = Ground::new(place, heading).then(entry_from_start);
    let first = Piece::rigid(library, domain, role, NO_INSTANCE, start, tick - lead);
    draft.view().is_free(&first).then_some(first)
}

/// Any single-person role without a box, the calmer the more often one of somebody who stands; or with a box, half of
/// them roles that take it up, if there are such.
fn first_role(library: &Library, laden: bool, taste: Taste, rng: &mut ChaCha8Rng) -> u32 {
    let lifts = |m: &Move| library.roles[m.role as usize].rests[0].is_some() && library.laden[m.group as usize];
    let carries = |m: &Move| library.laden[library.roles[m.role as usize].entry_group as usize];
    let roles = |wanted: &dyn Fn(&Move) -> bool| -> Vec<u32> {
        library.forward.iter().flatten().filter(|m| wanted(m)).map(|m| m.role).collect()
    };
    let wanted = match laden {
        true if rng.random_range(0..2) == 0 => roles(&lifts),
        true => roles(&carries),
        false if rng.random_range(0.0..1.0) > taste.calm => {
            roles(&|m| m.speed < STANDING_SPEED && !lifts(m) && !carries(m))
        }
        false => roles(&|m| !lifts(m) && !carries(m)),
    };
    let wanted = if wanted.is_empty() { roles(&|_| true) } else { wanted };
    *wanted
        .choose_weighted(rng, |&r| library.preference.weight_of_kind(library.roles[r as usize].kind))
        .expect("some role")
}
