//! Seeding: one more person, placed somewhere free and led by single-person patches to both edges of time; where it is
//! dense, close to others.

use std::f32::consts::PI;

use glam::Vec2;
use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;

use super::bridge::{NO_INSTANCE, STANDING_SPEED, Taste};
use super::domain::Spot;
use super::draft::Draft;
use super::library::{Library, Move};
use super::occupancy::PieceId;
use super::piece::Piece;
use super::prefer::Stay;
use super::tracks::{TrackId, Tracks, Window};
use super::tryout::is_clean;
use crate::geom::Ground;

/// Places tried for one person.
const PLACES: usize = 20;
/// Who stands close to others is tried so near first, and then so much farther each time, metres.
const NEAREST: f32 = 0.4;
const CLOSER: f32 = 0.05;
/// Who steps aside tries so many places, each so much farther from where they stood than the one before, metres.
const ASIDE_TRIES: usize = 40;
const ASIDE: f32 = 0.02;
/// Nobody stands where others ever come nearer, metres.
const ELBOW_ROOM: f32 = 0.35;
/// One of so many begins a group of their own.
const APART: u32 = 40;
/// Whoever stands stays within this, and whoever is farther from the first place roams, metres.
const ASTIR: f32 = 0.5;
const ROAM: f32 = 1.0;

/// Adds a person who is at a random place of the domain at first, until the end of time or out; one who begins with a box in the hands,
/// or by taking one up, if so wished.
pub(super) fn seed_person(draft: &mut Draft, laden: bool, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    let first = (0..PLACES).find_map(|_| {
        let role = first_role(draft.base.library, laden, taste, rng);
        first_piece(draft, role, anywhere(draft, rng), rng)
    })?;
    let pieces = life(draft, first, taste, rng)?;
    draft.push_track(pieces);
    is_clean(draft).then_some(())
}

/// Adds a person who stands as near somebody who is there at first as there is room, all the time.
pub(super) fn stand_beside(draft: &mut Draft, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    let pieces = standing(draft, taste, rng)?;
    draft.push_track(pieces);
    is_clean(draft).then_some(())
}

/// Lets somebody who walks about alone stand beside somebody else instead, so that there is room for others.
pub(super) fn settle(draft: &mut Draft, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    let tracks = draft.base;
    if tracks.tracks.is_empty() {
        return None;
    }
    let track = rng.random_range(0..tracks.tracks.len());
    let pieces = &tracks.tracks[track];
    let here = tracks.piece(pieces[0]).entry().position;
    let roams = |&id: &PieceId| tracks.piece(id).entry().position.distance(here) > ROAM;
    if !is_free_to_stand(tracks, track) || !pieces.iter().any(roams) {
        return None;
    }
    draft.hide(Window { track, from: 0, to: pieces.len() });
    let pieces = standing(draft, taste, rng)?;
    draft.set_track(track, pieces);
    is_clean(draft).then_some(())
}

/// The life of somebody who stands all the time, as near as there is room to where a person who is taken out began.
pub(super) fn stand_aside(
    draft: &mut Draft,
    track: TrackId,
    taste: Taste,
    rng: &mut ChaCha8Rng,
) -> Option<Vec<PieceId>> {
    let here = draft.base.port(track, 0).at.position;
    let aside = |k: usize| here + Vec2::from_angle(rng.random_range(-PI..PI)) * (k as f32 * ASIDE);
    let places: Vec<Vec2> = (0..ASIDE_TRIES).map(aside).collect();
    stand_at(draft, &places, taste, rng)
}

/// True if somebody who is there all the time is alone and has no boxes, and so may as well stand somewhere.
pub(super) fn is_free_to_stand(tracks: &Tracks, track: TrackId) -> bool {
    let alone = |&id: &PieceId| tracks.is_loose(id) && !tracks.piece(id).leaves_box();
    let open = tracks.begins_open(track) && tracks.ends_open(track);
    open && !is_laden(tracks, track) && tracks.tracks[track].iter().all(alone)
}

/// True if somebody begins with a box in the hands.
fn is_laden(tracks: &Tracks, track: TrackId) -> bool {
    tracks.library.laden[tracks.port(track, 0).group as usize]
}

/// The life of somebody who stands as near somebody else as there is room.
fn standing(draft: &mut Draft, taste: Taste, rng: &mut ChaCha8Rng) -> Option<Vec<PieceId>> {
    let tracks = draft.base;
    let (others, begin) = (tracks.tracks.len(), tracks.domain.frames().start.max(0));
    let other = rng.random_range(0..others + 1);
    let near = match other < others && tracks.is_there(other, begin) && rng.random_range(0..APART) > 0 {
        true => tracks.state_at(other, begin).position,
        false => anywhere(draft, rng),
    };
    let aside = Vec2::from_angle(rng.random_range(-PI..PI));
    let places: Vec<Vec2> = (0..PLACES).map(|k| near + aside * (NEAREST + k as f32 * CLOSER)).collect();
    stand_at(draft, &places, taste, rng)
}

/// The life of somebody who stands at the first of some places where there is room.
pub(super) fn stand_at(draft: &mut Draft, places: &[Vec2], taste: Taste, rng: &mut ChaCha8Rng) -> Option<Vec<PieceId>> {
    let role = first_role(draft.base.library, false, taste, rng);
    let mut quiet = places.iter().filter(|&&place| draft.view().is_quiet(place, ELBOW_ROOM));
    let first = quiet.find_map(|&place| first_piece(draft, role, place, rng))?;
    let here = first.entry().position;
    let pieces = life(draft, first, taste, rng)?;
    pieces.iter().all(|&id| draft.piece(id).entry().position.distance(here) < ASTIR).then_some(pieces)
}

/// The life of somebody who begins with a piece.
fn life(draft: &mut Draft, first: Piece, taste: Taste, rng: &mut ChaCha8Rng) -> Option<Vec<PieceId>> {
    let (entry, exit) = (draft.base.library.entry_of(&first), draft.base.library.exit_of(&first));
    let mut pieces = vec![draft.add(first)];
    pieces.extend(draft.lead_to_the_end(entry, exit, taste, rng)?);
    Some(pieces)
}

pub(super) fn anywhere(draft: &Draft, rng: &mut ChaCha8Rng) -> Vec2 {
    let domain = draft.base.domain;
    Vec2::new(rng.random_range(domain.min.x..domain.max.x), rng.random_range(domain.min.y..domain.max.y))
}

/// A patch of one person who is at a place at tick 0, or at any where time comes round, if it is free.
fn first_piece(draft: &Draft, role: u32, place: Vec2, rng: &mut ChaCha8Rng) -> Option<Piece> {
    let (library, domain) = (draft.base.library, draft.base.domain);
    let heading = rng.random_range(-PI..PI);
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

/// Any single-person role without a box, the calmer the more often one of somebody who stands, compact ones rather; or with a box, half of
/// them roles that take it up, if there are such.
fn first_role(library: &Library, laden: bool, taste: Taste, rng: &mut ChaCha8Rng) -> u32 {
    let lifts = |m: &Move| library.roles[m.role as usize].rests[0].is_some() && library.laden[m.group as usize];
    let carries = |m: &Move| library.laden[library.roles[m.role as usize].entry_group as usize];
    let moves = |wanted: &dyn Fn(&Move) -> bool| -> Vec<&Move> {
        library.forward.iter().flatten().filter(|m| wanted(m)).collect()
    };
    let wanted = match laden {
        true if rng.random_range(0..2) == 0 => moves(&lifts),
        true => moves(&carries),
        false if rng.random_range(0.0..1.0) > taste.calm => {
            moves(&|m| m.speed < STANDING_SPEED && !lifts(m) && !carries(m))
        }
        false => moves(&|m| !lifts(m) && !carries(m)),
    };
    let wanted = if wanted.is_empty() { moves(&|_| true) } else { wanted };
    let weight = |m: &&Move| {
        library.preference.weight_of_kind(library.roles[m.role as usize].kind) * (-taste.compact * m.room).exp()
    };
    wanted.choose_weighted(rng, weight).expect("some role").role
}
