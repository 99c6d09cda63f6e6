//! A draft: a change to the tiling while it is worked out. It reads the tiling and writes on a desk of its own, so that
//! many can be worked out side by side; whether one can still be made is seen when it is applied.

use glam::Vec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::bridge::{Bridge, Goal, NO_INSTANCE, Port, Taste};
use super::domain::Domain;
use super::occupancy::PieceId;
use super::piece::{Company, Piece, Shift};
use super::sketch::{Mark, Sketch};
use super::source::lead_out;
use super::tracks::{Change, NEWCOMER, TrackId, Tracks, Window};
use super::view::View;

/// Tries for a life to come round to where it began, and the fewest states expanded in each.
const ROUNDS: usize = 2;
const ROUND_EXPANSIONS: usize = 400;
/// How far from straight home, in periods, people may end up: some walk on through the tiles.
const ASTRAY: f32 = 0.6;

/// What working out a change takes, used again and again.
#[derive(Default)]
pub(super) struct Desk {
    sketch: Sketch,
    bridge: Bridge,
}

/// A change in the making.
pub(super) struct Draft<'a> {
    /// The tiling as it is.
    pub base: &'a Tracks<'a>,
    desk: &'a mut Desk,
    tracks: Vec<(TrackId, Vec<PieceId>)>,
    instances: u32,
}

impl<'a> Draft<'a> {
    /// No change.
    pub fn new(base: &'a Tracks<'a>, desk: &'a mut Desk) -> Self {
        desk.sketch.begin(base.domain.cycle);
        Self { base, desk, tracks: vec![], instances: 0 }
    }

    /// Forgets everything.
    pub fn restart(&mut self) {
        self.desk.sketch.take();
        self.tracks.clear();
    }

    /// The change as it is now.
    pub fn finish(mut self) -> Change {
        let (hidden, pieces) = self.desk.sketch.take();
        Change { version: self.base.version(), hidden, pieces, tracks: std::mem::take(&mut self.tracks) }
    }

    /// How far it is.
    pub fn mark(&self) -> Mark {
        self.desk.sketch.mark()
    }

    /// Back to how far it was, when no track had been set since.
    pub fn rewind(&mut self, mark: Mark) {
        self.desk.sketch.rewind(mark);
    }

    /// The tiling with the change made.
    pub fn view(&self) -> View<'_> {
        View { sketch: &self.desk.sketch, ..self.base.view() }
    }

    /// A piece.
    pub fn piece(&self, id: PieceId) -> &Piece {
        self.view().piece(id)
    }

    /// Whose pieces were set so far, and which: of one person the last count.
    pub fn changed(&self) -> &[(TrackId, Vec<PieceId>)] {
        &self.tracks
    }

    /// A number for the pieces of a patch of several people.
    pub fn new_instance(&mut self) -> u32 {
        self.instances += 1;
        NO_INSTANCE - self.instances
    }

    /// Searches a chain (see [`Bridge::search`]) among all bodies now seen.
    pub fn search(
        &mut self,
        from: Port,
        goal: Goal,
        company: Company,
        taste: Taste,
        rng: &mut ChaCha8Rng,
    ) -> Option<Vec<PieceId>> {
        let view = View { sketch: &self.desk.sketch, ..self.base.view() };
        let chain = self.desk.bridge.search(view, from, goal, company, taste, rng)?;
        // Ways out may lead beyond the end of time.
        let domain = self.base.domain;
        let seen = chain.into_iter().filter(|piece| domain.cycle.loops() || piece.begin < domain.horizon);
        Some(seen.map(|piece| self.add(piece)).collect())
    }

    /// Searches a chain that ends the life of somebody who walks alone: at the end of time, out, or where it began.
    pub fn lead_to_the_end(
        &mut self,
        begin: Port,
        from: Port,
        taste: Taste,
        rng: &mut ChaCha8Rng,
    ) -> Option<Vec<PieceId>> {
        match self.base.domain.cycle.loops() {
            true => self.come_round(from, begin, Company::NONE, taste, rng),
            false => lead_out(self, from, Company::NONE, taste, rng),
        }
    }

    /// Searches a chain from where a life has got to round to where it began, a lap later; there, or a tile away.
    pub fn come_round(
        &mut self,
        from: Port,
        begin: Port,
        company: Company,
        taste: Taste,
        rng: &mut ChaCha8Rng,
    ) -> Option<Vec<PieceId>> {
        let Domain { torus, cycle, .. } = *self.base.domain;
        let taste = Taste { expansions: taste.expansions.max(ROUND_EXPANSIONS), ..taste };
        (0..ROUNDS).find_map(|_| {
            let beside = Vec2::new(rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0)) * torus.period();
            let place = torus.whole(from.at.position + beside * ASTRAY - begin.at.position);
            let to = Shift { place, ticks: cycle.ticks() }.port(begin);
            self.search(from, Goal::Port(to), company, taste, rng)
        })
    }

    /// Puts a piece in.
    pub fn add(&mut self, piece: Piece) -> PieceId {
        self.desk.sketch.add(piece)
    }

    /// Puts the pieces of a patch of several people in, all or none of them.
    pub fn add_patch(&mut self, parts: impl IntoIterator<Item = (u32, Port)>) -> Option<Vec<PieceId>> {
        let instance = self.new_instance();
        let (mark, mut ids) = (self.mark(), Vec::new());
        for (role, entry) in parts {
            let piece = Piece::rigid(self.base.library, self.base.domain, role, instance, entry.at, entry.tick);
            if !self.view().is_free(&piece) {
                self.rewind(mark);
                return None;
            }
            ids.push(self.add(piece));
        }
        Some(ids)
    }

    /// Takes out a piece that is nobody's.
    pub fn hide_piece(&mut self, id: PieceId) {
        self.desk.sketch.hide(id);
    }

    /// Takes out the pieces of a window.
    pub fn hide(&mut self, window: Window) {
        let ids = &self.base.tracks[window.track][window.from..window.to];
        ids.iter().for_each(|&id| self.desk.sketch.hide(id));
    }

    /// Gives a person other pieces.
    pub fn set_track(&mut self, track: TrackId, pieces: Vec<PieceId>) {
        self.tracks.push((track, pieces));
    }

    /// Adds a person.
    pub fn push_track(&mut self, pieces: Vec<PieceId>) {
        self.tracks.push((NEWCOMER, pieces));
    }

    /// Fills a window whose pieces are out with another chain; `None` if none was found.
    pub fn bridge_window(&mut self, window: Window, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
        let Window { track, from, to } = window;
        let company = Company { from: self.base.company_before(track, from), to: self.base.company_after(track, to) };
        self.bridge_window_from(window, company, taste, rng)
    }

    /// The same, where somebody may be near the people of some patches for a moment only.
    pub fn bridge_window_from(
        &mut self,
        window: Window,
        company: Company,
        taste: Taste,
        rng: &mut ChaCha8Rng,
    ) -> Option<()> {
        let Window { track, from, to } = window;
        let (begin, end) = (self.base.port(track, from), self.base.port(track, to));
        let open = to == self.base.tracks[track].len() && self.base.ends_open(track);
        let (begin, goal) = match (from == 0 && self.base.begins_open(track), open) {
            (_, true) => (begin, Goal::Until(self.base.domain.horizon)),
            (true, false) => (end, Goal::Since(0)),
            (false, false) => (begin, Goal::Port(end)),
        };
        let way = self.search(begin, goal, company, taste, rng)?;
        let pieces = &self.base.tracks[track];
        self.set_track(track, [&pieces[..from], &way, &pieces[to..]].concat());
        Some(())
    }
}
