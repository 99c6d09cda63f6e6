//! Seeding: one more person, placed somewhere free and led by single-person patches to both edges of time.

use glam::Vec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::bridge::{Goal, Port, Taste};
use super::domain::Spot;
use super::library::{Library, Move};
use super::prefer::Stay;
use super::tracks::{Tracks, Undo};
use crate::geom::Ground;

/// Tries to add a person at a random place of the domain, present over the whole time; one who begins with a box in the
/// hands, or by taking one up, if so wished.
pub(super) fn seed_person(tracks: &mut Tracks, laden: bool, taste: Taste, rng: &mut ChaCha8Rng) -> bool {
    let domain = tracks.domain;
    let role = first_role(tracks.library, laden, rng);
    let place = Vec2::new(rng.random_range(domain.min.x..domain.max.x), rng.random_range(domain.min.y..domain.max.y));
    let heading = rng.random_range(-std::f32::consts::PI..std::f32::consts::PI);
    let lead = rng.random_range(0..tracks.library.roles[role as usize].ticks);
    let kind = tracks.library.roles[role as usize].kind;
    let wanted = tracks.library.preference.is_wanted(kind, Stay::new(Ground::new(place, heading), 0), rng);
    if !wanted || !domain.holds(Spot::ground(0), place, 0.35) {
        return false;
    }
    // The place is where the person is at tick 0, somewhere inside the first patch.
    let source = &tracks.library.roles[role as usize];
    let entry_from_start = source.path.at(lead as usize).inverse();
    let start = Ground::new(place, heading).then(entry_from_start);
    let port = Port { at: start, tick: -lead, group: source.entry_group };
    let first =
        super::occupancy::Piece::rigid(tracks.library, domain, role, super::bridge::NO_INSTANCE, start, port.tick);
    if !tracks.is_free(&first) {
        return false;
    }
    let exit = Port { at: first.exit(), tick: first.end, group: source.exit_group };
    let mut undo = Undo::default();
    let mut pieces = vec![tracks.add(first, &mut undo)];
    let Some(rest) = tracks.search(exit, Goal::Until(domain.horizon), taste, rng) else {
        tracks.roll_back(undo);
        return false;
    };
    pieces.extend(tracks.add_chain(rest, &mut undo));
    tracks.push_track(pieces);
    tracks.commit(undo);
    true
}

/// Any single-person role without a box; or with one, half of them roles that take it up, if there are such.
fn first_role(library: &Library, laden: bool, rng: &mut ChaCha8Rng) -> u32 {
    let lifts = |m: &Move| library.roles[m.role as usize].rests[0].is_some() && library.laden[m.group as usize];
    let carries = |m: &Move| library.laden[library.roles[m.role as usize].entry_group as usize];
    let roles = |wanted: &dyn Fn(&Move) -> bool| -> Vec<u32> {
        library.forward.iter().flatten().filter(|m| wanted(m)).map(|m| m.role).collect()
    };
    let wanted = match laden {
        true if rng.random_range(0..2) == 0 => roles(&lifts),
        true => roles(&carries),
        false => roles(&|m| !lifts(m) && !carries(m)),
    };
    let wanted = if wanted.is_empty() { roles(&|_| true) } else { wanted };
    wanted[rng.random_range(0..wanted.len())]
}
