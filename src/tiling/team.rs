//! Teams: people who begin together, and kinds of several people that are only of people of different teams.
//!
//! Where somebody's first patch begins tells the team, and it stays where it is for as long as the tiling is worked on.

use std::f32::consts::PI;

use glam::Vec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::bridge::{NO_INSTANCE, Taste};
use super::domain::Spot;
use super::draft::Draft;
use super::library::Library;
use super::piece::{Company, Piece};
use super::scene::{Scene, Team};
use super::source::lead_out;
use super::tracks::{TrackId, Tracks};
use super::tryout::is_clean;
use crate::geom::Ground;

/// Places tried for one person.
const PLACES: usize = 40;
/// Room that somebody must have to walls, metres.
const ROOM: f32 = 0.4;
/// How far people look past each other at first, radians.
const ASIDE: f32 = 0.1;

/// The teams of a scene, and by kind whether it is for rivals.
#[derive(Default)]
pub(super) struct Sides {
    /// The teams.
    pub teams: Vec<Team>,
    rivals: Vec<bool>,
}

impl Sides {
    /// Those of a scene.
    pub fn new(scene: &Scene, library: &Library) -> Self {
        let is_rival = |kind: &crate::patch::PatchKind| kind.labels.iter().any(|l| scene.rivals.contains(l));
        Self { teams: scene.teams.clone(), rivals: library.set.kinds.iter().map(is_rival).collect() }
    }

    /// True if a kind is only for people of different teams.
    pub fn is_rival(&self, kind: u32) -> bool {
        self.rivals.get(kind as usize).copied().unwrap_or(false)
    }
}

/// The team of a person, if any.
pub(super) fn team_of(tracks: &Tracks, track: TrackId) -> Option<usize> {
    let library = tracks.library;
    if library.sides.teams.is_empty() {
        return None;
    }
    let from = tracks.port(track, 0);
    let starts = |t: &Team| t.start.signed_distance(from.at.position) <= 0.0;
    match from.tick > 0 {
        true => library.gates.team_at(from.at.position),
        false => library.sides.teams.iter().position(starts),
    }
}

/// True if two people may play a kind together.
pub(super) fn may_meet(tracks: &Tracks, kind: u32, a: TrackId, b: TrackId) -> bool {
    if !tracks.library.sides.is_rival(kind) {
        return true;
    }
    matches!((team_of(tracks, a), team_of(tracks, b)), (Some(a), Some(b)) if a != b)
}

/// Adds a person who begins in the team's place at the first tick.
pub(super) fn line_up(draft: &mut Draft, team: usize, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    let first = (0..PLACES).find_map(|_| first_piece(draft, team, rng))?;
    let exit = draft.base.library.exit_of(&first);
    let mut pieces = vec![draft.add(first)];
    pieces.extend(lead_out(draft, exit, Company::NONE, taste, rng)?);
    draft.push_track(pieces);
    is_clean(draft).then_some(())
}

/// A free patch of one person that begins at tick 0 in the place of the team.
fn first_piece(draft: &Draft, team: usize, rng: &mut ChaCha8Rng) -> Option<Piece> {
    let (library, domain) = (draft.base.library, draft.base.domain);
    let team = &library.sides.teams[team];
    let roles = library.forward.iter().flatten().map(|m| m.role);
    let light = |&r: &u32| !library.laden[library.roles[r as usize].entry_group as usize];
    let roles: Vec<u32> = roles.filter(light).collect();
    if roles.is_empty() {
        return None;
    }
    let role = roles[rng.random_range(0..roles.len())];
    let (low, high) = team.start.bounds();
    let place = low + (high - low) * Vec2::new(rng.random_range(0.0..1.0), rng.random_range(0.0..1.0));
    let heading = team.heading.unwrap_or(0.0) + team.heading.map_or(PI, |_| ASIDE) * rng.random_range(-1.0..1.0);
    if team.start.signed_distance(place) > 0.0 || !domain.holds(Spot::ground(0), place, ROOM) {
        return None;
    }
    let first = Piece::rigid(library, domain, role, NO_INSTANCE, Ground::new(place, heading), 0);
    draft.view().is_free(&first).then_some(first)
}
