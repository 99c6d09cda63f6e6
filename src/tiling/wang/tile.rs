//! One tile: a tiling problem on a square whose borders some people cross as its colours say.

use glam::Vec2;
use rand_chacha::ChaCha8Rng;

use super::edge::{Edge, Edges};
use super::plane::{Across, Key, SIDES};
use super::ribbon::Crossing;
use crate::tiling::bridge::{Goal, Port, Taste};
use crate::tiling::clock::Clock;
use crate::tiling::domain::{self, Domain};
use crate::tiling::draft::Draft;
use crate::tiling::engine::{Shared, fill};
use crate::tiling::library::Library;
use crate::tiling::occupancy::PieceId;
use crate::tiling::passage::Passages;
use crate::tiling::piece::{Company, Piece, Shift};
use crate::tiling::tracks::Tracks;
use crate::tiling::tryout::is_clean;
use crate::tiling::{Progress, Scene};
use crate::{Error, Result};

/// Seeds tried until everybody who crosses the borders finds a way.
const SEEDS: u64 = 16;
/// So many of them are tried for one whose people meet often.
const PICKY: u64 = 8;

/// The sides at the upper ends of a tile.
pub(super) const UPPER_SIDES: [usize; 2] = [1, 3];

/// Where somebody crosses a tile's border: the side and which of its colour's ways.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::tiling) struct Gap {
    /// The side.
    pub side: usize,
    /// The number of the crossing.
    pub number: usize,
}

/// Somebody who is to come in or go out.
pub(in crate::tiling) struct Crosser {
    ids: Vec<PieceId>,
    /// A way on that is kept free for them until they are led.
    kept: Vec<PieceId>,
    entry: Port,
    exit: Port,
    comes: bool,
    /// Where.
    pub gap: Gap,
}

/// A crossing seen from a tile.
struct Visit {
    gap: Gap,
    comes: bool,
    pieces: Vec<Piece>,
    lead: Vec<Piece>,
}

/// Somebody's life within a tile.
pub(super) struct Stay {
    /// Where they come in, unless they are there from the beginning.
    pub from: Option<Gap>,
    /// The patches between.
    pub pieces: Vec<Piece>,
    /// Where they go out, unless they stay to the end.
    pub to: Option<Gap>,
}

/// A finished tile with its lower corner at the origin.
pub(super) struct Tile {
    /// Everybody.
    pub stays: Vec<Stay>,
    /// Instances have smaller numbers than this.
    pub instances: u32,
}

/// What all tiles of a plane have in common.
pub(super) struct Workshop<'a> {
    /// A tile as a scene: so many people as there are on it at once.
    pub scene: &'a Scene,
    /// The patches.
    pub library: &'a Library<'a>,
    /// How people meet and part.
    pub passages: &'a Passages<'a>,
    /// Who crosses edges and who lives on them.
    pub edges: &'a Edges,
    /// Side of a tile, metres.
    pub side: f32,
    /// What all tiles are drawn from.
    pub seed: u64,
}

/// Of a side: along which axis people cross it, whether it is the upper end of the tile.
pub(super) fn of_side(side: usize) -> (Across, bool) {
    (if side < 2 { Across::X } else { Across::Z }, side % 2 == 1)
}

/// The same edge seen from the tile beyond it.
pub(super) fn beyond(gap: Gap) -> Gap {
    Gap { side: gap.side ^ 1, ..gap }
}

/// The lower end of a side seen from the tile's lower corner.
pub(super) fn edge_of(side: usize, length: f32) -> Vec2 {
    [Vec2::ZERO, Vec2::new(length, 0.0), Vec2::ZERO, Vec2::new(0.0, length)][side]
}

impl Workshop<'_> {
    /// The people who cross the borders of a tile, and where.
    fn crossings(&self, key: Key) -> impl Iterator<Item = (Gap, &Crossing)> {
        (0..SIDES).flat_map(move |side| {
            let of = move |colour| self.edges.of(of_side(side).0, colour).crossings.iter().enumerate();
            let all = key.sides[side].into_iter().flat_map(of);
            all.map(move |(number, crossing)| (Gap { side, number }, crossing))
        })
    }

    /// Some sides of a tile, and where they are.
    pub fn edges(&self, key: Key, sides: &[usize]) -> impl Iterator<Item = (&Edge, Vec2)> {
        let of =
            move |&side: &usize| Some((self.edges.of(of_side(side).0, key.sides[side]?), edge_of(side, self.side)));
        sides.iter().filter_map(of)
    }

    /// How many people are in a tile besides those on its borders.
    fn residents(&self, key: Key) -> usize {
        // Half of each crossing's life is here; who lives on an upper border counts as one of this tile.
        let dwellers: usize = self.edges(key, &UPPER_SIDES).map(|(edge, _)| edge.dwellers.len()).sum();
        self.scene.characters.saturating_sub(self.crossings(key).count() / 2 + dwellers)
    }

    /// How many ticks in patches of several people those on the borders are short of what is wished for, half of which is
    /// this tile's.
    fn lack(&self, key: Key, horizon: i32) -> f32 {
        let share = self.scene.interaction;
        // The whole of a crosser's time counts in both tiles, that on the border twice.
        let lack = |(edge, _): (&Edge, Vec2)| {
            share * (edge.dwellers.len() as f32 * horizon as f32 - edge.crossing() as f32) - edge.company as f32
        };
        self.edges(key, &[0, 1, 2, 3]).map(lack).sum::<f32>() * 0.5
    }

    /// Works a tile out.
    ///
    /// # Errors
    /// Somebody who crosses its borders finds no way.
    pub fn build(&self, key: Key, secs: f64) -> Result<Tile> {
        let mut crossings: Vec<Visit> = self.crossings(key).map(|(gap, c)| self.visit(gap, c)).collect();
        let on_border = crossings.iter().map(|c| places(&c.pieces));
        let domain = Domain::new(self.scene)?.crossed_by(on_border.collect());
        let lack = self.lack(key, domain.horizon);
        for again in 0..SEEDS {
            let mut tracks = Tracks::new(self.library, &domain);
            let mut go_on = |_: &Progress| true;
            for (edge, place) in self.edges(key, &[0, 1, 2, 3]) {
                let dwellers: Vec<Vec<Piece>> = edge.dwellers.iter().map(|life| put(life, place)).collect();
                tracks.fix(&dwellers);
            }
            let crossers = self.crossers(&mut tracks, &crossings);
            let (seed, clock) =
                ((key.seed(self.seed.wrapping_add(again)), again < PICKY), Clock::new(secs, &mut go_on));
            let crossing = crossers.iter().map(|c| c.ticks_inside(domain.horizon)).sum();
            let people = (&Shared { crossers: &crossers, crossing, lack }, self.residents(key));
            match fill(self.scene, self.passages, tracks, people, seed, clock) {
                Ok(tracks) => return Ok(finished(&tracks, &crossers)),
                // Who found no way comes first next time.
                Err(stuck) => crossings.sort_by_key(|c| !stuck.contains(&c.gap)),
            }
        }
        let problem =
            "expected ways for all who cross the borders of a tile, found none; make tiles larger or people fewer";
        Err(Error::invalid("scene", "wang", problem))
    }

    /// A crossing as the tile sees it.
    fn visit(&self, gap: Gap, crossing: &Crossing) -> Visit {
        let put = |pieces: &[Piece]| put(pieces, edge_of(gap.side, self.side));
        let comes = crossing.forward != of_side(gap.side).1;
        Visit { gap, comes, pieces: put(&crossing.pieces), lead: put(&crossing.leads[usize::from(comes)]) }
    }

    /// Puts those in who cross the borders.
    fn crossers(&self, tracks: &mut Tracks, visits: &[Visit]) -> Vec<Crosser> {
        let ids = tracks.fix(visits.iter().map(|v| &v.pieces));
        let crosser = |(visit, ids): (&Visit, Vec<PieceId>)| Crosser {
            ids,
            kept: visit.lead.iter().map(|p| tracks.put(p.clone())).collect(),
            entry: self.library.entry_of(&visit.pieces[0]),
            exit: self.library.exit_of(&visit.pieces[visit.pieces.len() - 1]),
            comes: visit.comes,
            gap: visit.gap,
        };
        visits.iter().zip(ids).map(crosser).collect()
    }
}

impl Crosser {
    /// Ticks for which somebody is in this tile, the border included.
    fn ticks_inside(&self, horizon: i32) -> usize {
        let from = if self.comes { self.entry.tick.max(0) } else { 0 };
        let to = if self.comes { horizon } else { self.exit.tick.min(horizon) };
        (to - from).max(0) as usize
    }
}

/// Pieces of an edge whose lower end is somewhere.
fn put(pieces: &[Piece], place: Vec2) -> Vec<Piece> {
    pieces.iter().map(|p| p.clone().shifted(Shift { place, ticks: 0 })).collect()
}

/// Where somebody is while crossing.
fn places(pieces: &[Piece]) -> domain::Crossing {
    let bodies = || pieces.iter().filter(|p| !p.bodies.is_empty());
    let from = bodies().next().map_or(0, |p| p.shown_from);
    // A body is also seen at the tick at which it leaves the last piece.
    let last = pieces.last().map(|p| p.exit().position);
    let places = bodies().flat_map(|p| p.bodies.iter().map(|b| b.position)).chain(last).collect();
    domain::Crossing { from, places }
}

/// Leads somebody who comes in to the end of time, or who goes out from its beginning.
pub(in crate::tiling) fn lead_across(
    draft: &mut Draft,
    crosser: &Crosser,
    taste: Taste,
    rng: &mut ChaCha8Rng,
) -> Option<()> {
    let Crosser { entry, exit, comes, .. } = *crosser;
    let horizon = draft.base.domain.horizon;
    crosser.kept.iter().for_each(|&id| draft.hide_piece(id));
    let way = match comes {
        true if exit.tick < horizon => draft.search(exit, Goal::Until(horizon), Company::NONE, taste, rng)?,
        false if entry.tick > 0 => draft.search(entry, Goal::Since(0), Company::NONE, taste, rng)?,
        _ => vec![],
    };
    let track = if comes { [crosser.ids.as_slice(), &way].concat() } else { [way.as_slice(), &crosser.ids].concat() };
    draft.push_track(track);
    is_clean(draft).then_some(())
}

/// The people of a tile without what they share with others.
fn finished(tracks: &Tracks, crossers: &[Crosser]) -> Tile {
    let gap = |id: Option<&PieceId>, comes: bool| {
        let of = |c: &&Crosser| c.comes == comes && id.is_some_and(|id| c.ids.contains(id));
        crossers.iter().find(of).map(|c| c.gap)
    };
    let stay = |ids: &Vec<PieceId>| Stay {
        from: gap(ids.first(), true),
        pieces: ids.iter().filter(|&&id| !tracks.is_fixed(id)).map(|&id| tracks.piece(id).clone()).collect(),
        to: gap(ids.last(), false),
    };
    let stays: Vec<Stay> = tracks.tracks.iter().map(stay).collect();
    let instances = stays.iter().flat_map(|s| &s.pieces).map(|p| p.instance + 1).max().unwrap_or(0);
    Tile { stays, instances }
}
