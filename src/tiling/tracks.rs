//! The state of the engine: every person is a track of pieces from the first tick to the last. It is a perfect tiling
//! after every change, because changes are proposed whole (see [`Draft`](super::draft::Draft)) and taken or left.

use glam::Vec2;

use super::bake::Chains;
use super::bridge::{NO_INSTANCE, Port};
use super::domain::Domain;
use super::library::Library;
use super::occupancy::{Occupancy, PieceId};
use super::piece::{Piece, Shift};
use super::sketch::Sketch;
use super::team::team_of;
use super::view::View;
use crate::geom::{Ground, Torus};

/// Index of a person.
pub(super) type TrackId = usize;

/// In place of a person: one who is not there yet.
pub(super) const NEWCOMER: TrackId = TrackId::MAX;

/// The tiling as tracks.
pub(super) struct Tracks<'a> {
    /// The patches.
    pub library: &'a Library<'a>,
    /// Walls and time.
    pub domain: &'a Domain,
    /// Who is where.
    pub occupancy: Occupancy,
    /// Each person's pieces in order of time.
    pub tracks: Vec<Vec<PieceId>>,
    /// The person each piece belongs to, by piece id.
    owners: Vec<TrackId>,
    /// Next number for an instance; numbers are made dense when the crowd is baked.
    next_instance: u32,
    /// Number of changes so far, and at which one each track changed last.
    version: u64,
    stamps: Vec<u64>,
    /// Ticks that people spend in patches of several.
    company: usize,
    /// So many pieces were put in before all others; nothing moves them.
    fixed: PieceId,
}

/// Instances of a change have numbers from here on, counted downwards, until it is made.
const PROVISIONAL: u32 = 1 << 31;

fn is_provisional(instance: u32) -> bool {
    (PROVISIONAL..NO_INSTANCE).contains(&instance)
}

/// Pieces `from..to` of a track.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    /// The person.
    pub track: TrackId,
    /// First piece.
    pub from: usize,
    /// The piece after the last.
    pub to: usize,
}

/// A change to the tiling, worked out but not made: pieces that go, pieces that come, and whose they are.
pub(super) struct Change {
    /// The version of the tiling it was worked out for.
    pub version: u64,
    /// Pieces that go.
    pub hidden: Vec<PieceId>,
    /// Pieces that come. Those of one instance share a number; it is replaced.
    pub pieces: Vec<Piece>,
    /// All pieces of the people who change, placed or to come.
    pub tracks: Vec<(TrackId, Vec<PieceId>)>,
}

impl Change {
    /// How many people it adds.
    pub fn newcomers(&self) -> usize {
        self.tracks.iter().filter(|t| t.0 == NEWCOMER).count()
    }
}

impl<'a> Tracks<'a> {
    /// No people yet.
    pub fn new(library: &'a Library<'a>, domain: &'a Domain) -> Self {
        Self { occupancy: Occupancy::new(domain, library), ..Self::on_open_ground(library, domain) }
    }

    /// Where there never are people: only drafts.
    pub fn on_open_ground(library: &'a Library<'a>, domain: &'a Domain) -> Self {
        Self {
            library,
            domain,
            occupancy: Occupancy::none(),
            tracks: vec![],
            owners: vec![],
            next_instance: 0,
            version: 0,
            stamps: vec![],
            company: 0,
            fixed: 0,
        }
    }

    /// A piece.
    pub fn piece(&self, id: PieceId) -> &Piece {
        self.occupancy.piece(id)
    }

    /// Number of people in the piece's patch.
    pub fn people_of(&self, id: PieceId) -> usize {
        self.library.people_of(self.piece(id).role)
    }

    /// True if a piece is of one person only and may be taken out.
    pub fn is_loose(&self, id: PieceId) -> bool {
        !self.is_fixed(id) && self.people_of(id) == 1
    }

    /// True if nothing moves a piece.
    pub fn is_fixed(&self, id: PieceId) -> bool {
        id < self.fixed
    }

    /// Puts people's pieces in that nothing moves, before all others. Those of one instance share a number; it is replaced.
    pub fn fix<'p>(&mut self, people: impl IntoIterator<Item = &'p Vec<Piece>>) -> Vec<Vec<PieceId>> {
        let mut numbers = Vec::new();
        let mut fix = |piece: &Piece| {
            let mut piece = piece.clone();
            piece.instance = self.number(&mut numbers, piece.instance);
            for instance in [&mut piece.company.from, &mut piece.company.to].into_iter().filter(|i| **i != NO_INSTANCE)
            {
                *instance = self.number(&mut numbers, *instance);
            }
            self.fixed += 1;
            self.occupancy.insert(piece)
        };
        people.into_iter().map(|pieces| pieces.iter().map(&mut fix).collect()).collect()
    }

    /// Puts a piece in as it is, as an instance of its own.
    pub fn put(&mut self, piece: Piece) -> PieceId {
        let instance = self.number(&mut vec![], NO_INSTANCE);
        self.occupancy.insert(Piece { instance, ..piece })
    }

    /// People whose lives are known, seen by nobody until [`Tracks::opened`].
    pub fn laid(library: &'a Library<'a>, domain: &'a Domain, people: Vec<Vec<Piece>>) -> Self {
        let mut tracks = Self::on_open_ground(library, domain);
        for pieces in people {
            tracks.next_instance = pieces.iter().map(|p| p.instance + 1).fold(tracks.next_instance, u32::max);
            let ids: Vec<PieceId> = pieces.into_iter().map(|piece| tracks.occupancy.keep(piece)).collect();
            tracks.enter(ids);
        }
        tracks
    }

    /// The same people seen by searches; as they were if they are too crowded for that.
    pub fn opened(self) -> Result<Self, Box<Self>> {
        let (domain, library) = (self.domain, self.library);
        match self.occupancy.opened(domain, library) {
            Ok(occupancy) => Ok(Self { occupancy, ..self }),
            Err(occupancy) => Err(Box::new(Self { occupancy: *occupancy, ..self })),
        }
    }

    /// The port at which piece `index` of `track` begins; past the last piece, the port at which the track ends.
    pub fn port(&self, track: TrackId, index: usize) -> Port {
        let pieces = &self.tracks[track];
        match pieces.get(index) {
            Some(&id) => self.library.entry_of(self.piece(id)),
            None => self.library.exit_of(self.piece(*pieces.last().expect("tracks are never empty"))),
        }
    }

    /// The instance of several people that ends where piece `index` of a track begins.
    pub fn company_before(&self, track: TrackId, index: usize) -> u32 {
        match (index.checked_sub(1), self.domain.cycle.loops()) {
            (None, false) => NO_INSTANCE,
            (before, _) => self.company_after(track, before.unwrap_or(self.tracks[track].len() - 1)),
        }
    }

    /// The instance of several people that piece `index` of a track is of.
    pub fn company_after(&self, track: TrackId, index: usize) -> u32 {
        let index = if self.domain.cycle.loops() { index % self.tracks[track].len() } else { index };
        let piece = self.tracks[track].get(index).filter(|&&id| self.people_of(id) > 1);
        piece.map_or(NO_INSTANCE, |&id| self.piece(id).instance)
    }

    /// The tiling as searches see it.
    pub fn view(&self) -> View<'_> {
        View::new(self.library, self.domain, &self.occupancy)
    }

    /// The person a piece belongs to.
    pub fn owner(&self, id: PieceId) -> TrackId {
        self.owners[id as usize]
    }

    /// Number of changes so far.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// The people who changed after a version.
    pub fn changed_since(&self, version: u64) -> Vec<bool> {
        self.stamps.iter().map(|&stamp| stamp > version).collect()
    }

    /// Makes a change if nothing that was changed since it was worked out is in its way; else all is as it was.
    pub fn apply(&mut self, change: Change) -> bool {
        let Change { version, hidden, pieces, tracks } = change;
        if tracks.iter().any(|&(t, _)| t != NEWCOMER && self.stamps[t] > version) {
            return false;
        }
        hidden.iter().for_each(|&id| self.occupancy.hide(id));
        let Some(ids) = self.insert(pieces) else {
            hidden.iter().rev().for_each(|&id| self.occupancy.show(id));
            return false;
        };
        self.company -= self.company_of(&hidden);
        self.company += self.company_of(&ids);
        hidden.iter().for_each(|&id| self.occupancy.forget(id));
        self.version += 1;
        for (track, mut pieces) in tracks {
            let sketched = pieces.iter_mut().filter(|id| Sketch::is_sketched(**id));
            sketched.for_each(|id| *id = ids[Sketch::index(*id)]);
            self.set(track, pieces);
        }
        true
    }

    /// Puts pieces in, each tested against all that are there; `None` and nothing is changed if one is not free.
    fn insert(&mut self, pieces: Vec<Piece>) -> Option<Vec<PieceId>> {
        let mut ids = Vec::with_capacity(pieces.len());
        let mut numbers: Vec<(u32, u32)> = Vec::new();
        for mut piece in pieces {
            piece.instance = self.number(&mut numbers, piece.instance);
            for instance in [&mut piece.company.from, &mut piece.company.to] {
                if is_provisional(*instance) {
                    *instance = self.number(&mut numbers, *instance);
                }
            }
            if !self.view().is_free(&piece) {
                self.remove(ids);
                return None;
            }
            ids.push(self.occupancy.insert(piece));
        }
        Some(ids)
    }

    /// The instance's number in the tiling; those of a change are its own. Patches of one person all come as the same.
    fn number(&mut self, numbers: &mut Vec<(u32, u32)>, instance: u32) -> u32 {
        if let Some(known) = numbers.iter().find(|n| n.0 == instance) {
            return known.1;
        }
        let new = self.next_instance;
        self.next_instance += 1;
        if instance != NO_INSTANCE {
            numbers.push((instance, new));
        }
        new
    }

    /// Puts a person in, as a tiling was kept; false and nothing is changed if the grid has no room.
    pub fn settle(&mut self, pieces: Vec<Piece>) -> bool {
        let mut ids = Vec::with_capacity(pieces.len());
        for piece in pieces {
            if !self.occupancy.has_room(&piece) {
                self.remove(ids);
                return false;
            }
            ids.push(self.occupancy.insert(piece));
        }
        self.enter(ids);
        true
    }

    /// Next number for an instance.
    pub fn next_instance(&self) -> u32 {
        self.next_instance
    }

    /// Numbers new instances from here on.
    pub fn number_from(&mut self, next: u32) {
        self.next_instance = next;
    }

    fn remove(&mut self, ids: Vec<PieceId>) {
        for id in ids.into_iter().rev() {
            self.occupancy.hide(id);
            self.occupancy.forget(id);
        }
    }

    fn set(&mut self, track: TrackId, pieces: Vec<PieceId>) {
        let track = if track == NEWCOMER {
            self.tracks.push(vec![]);
            self.stamps.push(0);
            self.tracks.len() - 1
        } else {
            track
        };
        for &id in &pieces {
            if self.owners.len() <= id as usize {
                self.owners.resize(id as usize + 1, 0);
            }
            self.owners[id as usize] = track;
        }
        self.tracks[track] = pieces;
        self.stamps[track] = self.version;
    }

    /// Adds somebody whose pieces are in already.
    fn enter(&mut self, ids: Vec<PieceId>) {
        self.company += self.company_of(&ids);
        self.set(NEWCOMER, ids);
    }

    fn company_of(&self, pieces: &[PieceId]) -> usize {
        pieces.iter().filter(|&&id| self.people_of(id) > 1).map(|&id| self.piece(id).ticks_inside()).sum()
    }

    /// The window made wider by at least `ticks` on both sides, as far as time goes and up to the next patch of several
    /// people.
    pub fn widen(&self, window: Window, ticks: i32) -> Window {
        let Window { track, mut from, mut to } = window;
        let single = |i: usize| self.is_loose(self.tracks[track][i]);
        let (begin, end) = (self.port(track, from).tick - ticks, self.port(track, to).tick + ticks);
        while from > 0 && self.port(track, from).tick > begin && single(from - 1) {
            from -= 1;
        }
        while to < self.tracks[track].len() && self.port(track, to).tick < end && single(to) {
            to += 1;
        }
        Window { track, from, to }
    }

    /// True if a person may have come from anywhere: was there before time began, and not in the place of a team.
    pub fn begins_open(&self, track: TrackId) -> bool {
        let free = !self.domain.cycle.loops() && !self.is_fixed(self.tracks[track][0]);
        free && self.port(track, 0).tick <= 0 && team_of(self, track).is_none()
    }

    /// True if a person may go anywhere: is still there when time ends.
    pub fn ends_open(&self, track: TrackId) -> bool {
        let free = !self.domain.cycle.loops() && self.tracks[track].last().is_none_or(|&id| !self.is_fixed(id));
        free && self.port(track, self.tracks[track].len()).tick >= self.domain.horizon
    }

    /// True if a person is there at a tick within the domain's time.
    pub fn is_there(&self, track: TrackId, tick: i32) -> bool {
        self.port(track, 0).tick <= tick && tick < self.port(track, self.tracks[track].len()).tick
    }

    /// Index of the piece a track is in at `tick`.
    pub fn index_at(&self, track: TrackId, tick: i32) -> usize {
        let tick = self.fold(track, tick);
        self.tracks[track].partition_point(|&id| self.piece(id).end <= tick)
    }

    /// Number of pieces of a track that begin before `tick`.
    pub fn index_before(&self, track: TrackId, tick: i32) -> usize {
        self.tracks[track].partition_point(|&id| self.piece(id).begin < tick)
    }

    /// Place and heading of a person at a tick at which the person is there.
    pub fn state_at(&self, track: TrackId, tick: i32) -> Ground {
        self.piece(self.tracks[track][self.index_at(track, tick)]).state(self.fold(track, tick))
    }

    /// A tick as a person counts them: from when their first piece begins, where time comes round.
    pub fn fold(&self, track: TrackId, tick: i32) -> i32 {
        self.domain.cycle.fold(tick, self.piece(self.tracks[track][0]).begin)
    }

    /// What a port is for a person who is near it, and there at tick `seen`.
    pub fn shift_to(&self, track: TrackId, port: &Port, seen: i32) -> Shift {
        let tick = self.fold(track, port.tick);
        let near = |torus: Torus| torus.whole(self.state_at(track, seen).position - port.at.position);
        let place = if self.domain.torus.is_plane() { Vec2::ZERO } else { near(self.domain.torus) };
        Shift { place, ticks: tick - port.tick }
    }

    /// True if a person's loop can take two moments, counted as the person does, without being cut between them.
    pub fn spans(&self, track: TrackId, begin: i32, end: i32) -> bool {
        let cycle = self.domain.cycle;
        !cycle.loops() || (self.port(track, 0).tick < begin && end <= self.port(track, 0).tick + cycle.ticks())
    }

    /// Cuts a person's loop open farthest from a tick, so that changes about it find it whole.
    pub fn cut_away_from(&mut self, track: TrackId, tick: i32) {
        let lap = self.domain.cycle.ticks();
        if lap == 0 {
            return;
        }
        let begin = self.port(track, 0);
        let count = self.index_before(track, self.fold(track, tick + lap / 2));
        let end = self.port(track, self.tracks[track].len());
        let place = self.domain.torus.whole(end.at.position - begin.at.position);
        // Nobody's ticks grow without end.
        let (moved, by) = match begin.tick < 0 {
            true => (0..count, Shift { place, ticks: lap }),
            false => (count..self.tracks[track].len(), Shift { place: -place, ticks: -lap }),
        };
        for k in moved {
            let id = self.tracks[track][k];
            self.occupancy.hide(id);
            self.occupancy.replace(id, self.piece(id).clone().shifted(by));
        }
        self.tracks[track].rotate_left(count);
    }

    /// Index of the piece of a track that is in an instance.
    pub fn index_in(&self, track: TrackId, instance: u32) -> Option<usize> {
        self.tracks[track].iter().position(|&id| self.piece(id).instance == instance)
    }

    /// The people as baking wants them.
    pub fn chains(&self) -> Chains<'_> {
        let Self { library, domain, occupancy, tracks, .. } = self;
        Chains { library, domain, occupancy, lists: tracks }
    }

    /// Ticks that people spend in patches of two or more.
    pub fn company(&self) -> usize {
        self.company
    }

    /// Ticks that people are there.
    pub fn presence(&self) -> usize {
        if self.domain.cycle.loops() {
            return self.tracks.len() * self.domain.horizon as usize;
        }
        let last = |t: TrackId| self.port(t, self.tracks[t].len()).tick.min(self.domain.horizon);
        (0..self.tracks.len()).map(|t| (last(t) - self.port(t, 0).tick.max(0)) as usize).sum()
    }

    /// Share of the people's time inside patches of two or more.
    pub fn multi_person_share(&self) -> f32 {
        self.company as f32 / self.presence().max(1) as f32
    }

    /// Number of instances.
    pub fn instances(&self) -> usize {
        let mut seen: Vec<u32> = self.tracks.iter().flatten().map(|&id| self.piece(id).instance).collect();
        seen.sort_unstable();
        seen.dedup();
        seen.len()
    }
}
