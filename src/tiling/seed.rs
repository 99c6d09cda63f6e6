//! Seeding: one more person, placed somewhere free and led by single-person patches to both edges of time.

use glam::Vec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::bridge::{Goal, Port, Taste};
use super::tracks::{Tracks, Undo};
use crate::geom::Ground;

/// Tries to add a person at a random place of the domain, present over the whole time.
pub(super) fn seed_person(tracks: &mut Tracks, taste: Taste, rng: &mut ChaCha8Rng) -> bool {
    let domain = tracks.domain;
    let role = {
        let single: Vec<u32> = tracks.library.forward.iter().flatten().map(|m| m.role).collect();
        single[rng.random_range(0..single.len())]
    };
    let place = Vec2::new(rng.random_range(domain.min.x..domain.max.x), rng.random_range(domain.min.y..domain.max.y));
    let heading = rng.random_range(-std::f32::consts::PI..std::f32::consts::PI);
    let lead = rng.random_range(0..tracks.library.roles[role as usize].ticks);
    if !domain.holds(place, 0.35) {
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
