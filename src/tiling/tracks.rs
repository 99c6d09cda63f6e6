//! The state of the engine: every person is a track of pieces from the first tick to the last. It is a perfect tiling
//! after every change, because a change that cannot be completed is undone.

use rand_chacha::ChaCha8Rng;

use super::bake::Chains;
use super::bridge::{Bridge, Goal, NO_INSTANCE, Port, Taste, View};
use super::domain::Domain;
use super::library::Library;
use super::occupancy::{Occupancy, Piece, PieceId};
use crate::geom::Ground;

/// Index of a person.
pub(super) type TrackId = usize;

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
    bridge: Bridge,
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

/// What undoes a change: pieces taken out, pieces put in, tracks as they were.
#[derive(Default)]
pub(super) struct Undo {
    hidden: Vec<PieceId>,
    added: Vec<PieceId>,
    tracks: Vec<(TrackId, Vec<PieceId>)>,
}

impl<'a> Tracks<'a> {
    /// No people yet.
    pub fn new(library: &'a Library<'a>, domain: &'a Domain) -> Self {
        Self {
            library,
            domain,
            occupancy: Occupancy::new(domain, library),
            tracks: vec![],
            owners: vec![],
            next_instance: 0,
            bridge: Bridge::default(),
        }
    }

    /// A piece.
    pub fn piece(&self, id: PieceId) -> &Piece {
        self.occupancy.piece(id)
    }

    /// Number of people in the piece's patch.
    pub fn people_of(&self, id: PieceId) -> usize {
        let role = &self.library.roles[self.piece(id).role as usize];
        self.library.set.kinds[role.kind as usize].people()
    }

    /// The port at which piece `index` of `track` begins; past the last piece, the port at which the track ends.
    pub fn port(&self, track: TrackId, index: usize) -> Port {
        let pieces = &self.tracks[track];
        let roles = &self.library.roles;
        match pieces.get(index) {
            Some(&id) => {
                let p = self.piece(id);
                Port { at: p.entry(), tick: p.begin, group: roles[p.role as usize].entry_group }
            }
            None => {
                let p = self.piece(*pieces.last().expect("tracks are never empty"));
                Port { at: p.exit(), tick: p.end, group: roles[p.role as usize].exit_group }
            }
        }
    }

    /// A new instance number.
    pub fn new_instance(&mut self) -> u32 {
        self.next_instance += 1;
        self.next_instance - 1
    }

    /// Searches a chain (see [`Bridge::search`]) among all bodies now shown.
    pub fn search(&mut self, from: Port, goal: Goal, taste: Taste, rng: &mut ChaCha8Rng) -> Option<Vec<Piece>> {
        let view = View { library: self.library, domain: self.domain, occupancy: &self.occupancy };
        self.bridge.search(view, from, goal, taste, rng)
    }

    /// True if `piece` could be put in now.
    pub fn is_free(&self, piece: &Piece) -> bool {
        self.occupancy.is_free(self.library, self.domain, piece)
    }

    /// Puts a piece in; one without an instance gets one of its own.
    pub fn add(&mut self, mut piece: Piece, undo: &mut Undo) -> PieceId {
        if piece.instance == NO_INSTANCE {
            piece.instance = self.new_instance();
        }
        let id = self.occupancy.insert(piece);
        undo.added.push(id);
        id
    }

    /// Puts a chain in.
    pub fn add_chain(&mut self, chain: Vec<Piece>, undo: &mut Undo) -> Vec<PieceId> {
        chain.into_iter().map(|piece| self.add(piece, undo)).collect()
    }

    /// Takes a piece out for the time being.
    pub fn hide(&mut self, id: PieceId, undo: &mut Undo) {
        self.occupancy.hide(id);
        undo.hidden.push(id);
    }

    /// Gives a track other pieces.
    pub fn set_track(&mut self, track: TrackId, pieces: Vec<PieceId>, undo: &mut Undo) {
        self.own(track, &pieces);
        undo.tracks.push((track, std::mem::replace(&mut self.tracks[track], pieces)));
    }

    /// Adds a person.
    pub fn push_track(&mut self, pieces: Vec<PieceId>) {
        self.own(self.tracks.len(), &pieces);
        self.tracks.push(pieces);
    }

    /// The person a piece belongs to.
    pub fn owner(&self, id: PieceId) -> TrackId {
        self.owners[id as usize]
    }

    fn own(&mut self, track: TrackId, pieces: &[PieceId]) {
        for &id in pieces {
            if self.owners.len() <= id as usize {
                self.owners.resize(id as usize + 1, 0);
            }
            self.owners[id as usize] = track;
        }
    }

    /// Makes a change final.
    pub fn commit(&mut self, undo: Undo) {
        undo.hidden.into_iter().for_each(|id| self.occupancy.forget(id));
    }

    /// Takes a change back.
    pub fn roll_back(&mut self, undo: Undo) {
        for id in undo.added.into_iter().rev() {
            self.occupancy.hide(id);
            self.occupancy.forget(id);
        }
        undo.hidden.into_iter().rev().for_each(|id| self.occupancy.show(id));
        for (track, pieces) in undo.tracks.into_iter().rev() {
            self.own(track, &pieces);
            self.tracks[track] = pieces;
        }
    }

    /// The window made wider by at least `ticks` on both sides, as far as time goes and up to the next patch of several
    /// people.
    pub fn widen(&self, window: Window, ticks: i32) -> Window {
        let Window { track, mut from, mut to } = window;
        let single = |i: usize| self.people_of(self.tracks[track][i]) == 1;
        let (begin, end) = (self.port(track, from).tick - ticks, self.port(track, to).tick + ticks);
        while from > 0 && self.port(track, from).tick > begin && single(from - 1) {
            from -= 1;
        }
        while to < self.tracks[track].len() && self.port(track, to).tick < end && single(to) {
            to += 1;
        }
        Window { track, from, to }
    }

    /// Takes the pieces of a window out.
    pub fn hide_window(&mut self, window: Window, undo: &mut Undo) {
        for i in window.from..window.to {
            self.hide(self.tracks[window.track][i], undo);
        }
    }

    /// Fills a window whose pieces are out with another chain; `None` if none was found.
    pub fn bridge_window(&mut self, window: Window, taste: Taste, rng: &mut ChaCha8Rng, undo: &mut Undo) -> Option<()> {
        let Window { track, from, to } = window;
        let (begin, end) = (self.port(track, from), self.port(track, to));
        let open = to == self.tracks[track].len();
        let chain = match (from == 0, open) {
            (_, true) => self.search(begin, Goal::Until(self.domain.horizon), taste, rng)?,
            (true, false) => self.search(end, Goal::Since(0), taste, rng)?,
            (false, false) => self.search(begin, Goal::Port(end), taste, rng)?,
        };
        let way = self.add_chain(chain, undo);
        let pieces = [&self.tracks[track][..from], &way, &self.tracks[track][to..]].concat();
        self.set_track(track, pieces, undo);
        Some(())
    }

    /// Index of the piece a track is in at `tick`.
    pub fn index_at(&self, track: TrackId, tick: i32) -> usize {
        self.tracks[track].partition_point(|&id| self.piece(id).end <= tick)
    }

    /// Number of pieces of a track that begin before `tick`.
    pub fn index_before(&self, track: TrackId, tick: i32) -> usize {
        self.tracks[track].partition_point(|&id| self.piece(id).begin < tick)
    }

    /// Place and heading of a person at a tick within the domain's time.
    pub fn state_at(&self, track: TrackId, tick: i32) -> Ground {
        self.piece(self.tracks[track][self.index_at(track, tick)]).state(tick)
    }

    /// The people as baking wants them.
    pub fn chains(&self) -> Chains<'_> {
        let Self { library, domain, occupancy, tracks, .. } = self;
        Chains { library, domain, occupancy, lists: tracks }
    }

    /// Share of the people's time inside patches of two or more.
    pub fn multi_person_share(&self) -> f32 {
        self.chains().multi_person_share()
    }

    /// Number of instances.
    pub fn instances(&self) -> usize {
        let mut seen: Vec<u32> = self.tracks.iter().flatten().map(|&id| self.piece(id).instance).collect();
        seen.sort_unstable();
        seen.dedup();
        seen.len()
    }
}
