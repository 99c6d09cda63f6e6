//! Edges: all that is the same wherever an edge of some colour lies. Some people walk across it (`ribbon.rs`), and some live on
//! it, who meet, stand and walk about on both sides of the border as people do elsewhere. These are a crowd of their own
//! on a strip along the edge; strips of edges that meet in a corner do not overlap, so that any colours fit together.

use std::collections::BTreeMap;
use std::ops::Range;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::plane::{Across, mix};
use super::ribbon::{Crossing, on_edge, ribbons};
use crate::Result;
use crate::geom::Polygon;
use crate::tiling::clock::Clock;
use crate::tiling::domain::Domain;
use crate::tiling::engine::fill_edge;
use crate::tiling::library::Library;
use crate::tiling::passage::Passages;
use crate::tiling::piece::Piece;
use crate::tiling::tracks::Tracks;
use crate::tiling::{Progress, Scene, Wang};

/// People who cross an edge, per person on a tile.
const CROSSING: f32 = 0.1;
/// So many people as are elsewhere on a strip of this width, metres, live on an edge.
const DWELLING: f32 = 2.0;
/// How far from the border their strip reaches, metres: not everywhere as far, so that where it ends is not seen.
const REACH: Range<f32> = 1.4..2.8;
/// Crowds that are tried for an edge until one has room for all and the company that is wished for.
const SEEDS: u64 = 6;

/// An edge whose lower end is at the origin.
pub(super) struct Edge {
    /// Who walks across it.
    pub crossings: Vec<Crossing>,
    /// The patches of each of those who live on it, in order of time.
    pub dwellers: Vec<Vec<Piece>>,
    /// Their instances have smaller numbers than this.
    pub instances: u32,
    /// Ticks that they spend in patches of several people.
    pub company: usize,
}

impl Edge {
    /// Ticks of those who walk across it, on the way across.
    pub fn crossing(&self) -> usize {
        ticks_of(&self.crossings)
    }
}

fn ticks_of(crossings: &[Crossing]) -> usize {
    crossings.iter().flat_map(|c| &c.pieces).map(Piece::ticks_inside).sum()
}

/// All edges, by axis and colour.
pub(super) struct Edges(BTreeMap<(Across, u32), Edge>);

impl Edges {
    /// The edges of a plane whose tiles are each like `one`.
    ///
    /// # Errors
    /// There is no room for those who are to cross an edge.
    pub fn new(
        passages: &Passages,
        library: &Library,
        one: &Scene,
        wang: Wang,
        (seed, secs): (u64, f64),
    ) -> Result<Self> {
        let keys = (0..wang.colours).flat_map(|colour| [(Across::X, colour), (Across::Z, colour)]);
        let shop = EdgeShop { passages, library, one, side: wang.tile, secs };
        let edge = |(across, colour): (Across, u32)| {
            let seed = mix(mix(seed ^ u64::from(colour)) ^ across as u64);
            Ok(((across, colour), shop.edge(across, seed)?))
        };
        keys.collect::<Vec<_>>().into_par_iter().with_max_len(1).map(edge).collect::<Result<_>>().map(Self)
    }

    /// An edge.
    pub fn of(&self, across: Across, colour: u32) -> &Edge {
        &self.0[&(across, colour)]
    }
}

/// A strip along an edge. Where edges meet it ends in a right angle at most, as the strips of the others there do.
fn strip(across: Across, side: f32, rng: &mut ChaCha8Rng) -> Polygon {
    let mut reach = || rng.random_range(REACH);
    let [a, b, c, d] = [reach(), reach(), reach(), reach()];
    let outline = [(0.0, 0.0), (a, -a), (side - b, -b), (side, 0.0), (side - c, c), (d, d)];
    let corners = outline.map(|(along, beyond)| on_edge(across, along, beyond));
    Polygon::new(corners.to_vec()).expect("six corners that go round once")
}

/// What edges are made from.
struct EdgeShop<'a> {
    passages: &'a Passages<'a>,
    library: &'a Library<'a>,
    one: &'a Scene,
    side: f32,
    secs: f64,
}

impl EdgeShop<'_> {
    fn edge(&self, across: Across, seed: u64) -> Result<Edge> {
        // As many go as come, and nobody where there are hardly any people.
        let people = self.one.characters as f32;
        let pairs = ((people * CROSSING / 2.0).round() as usize).max(usize::from(self.one.characters >= 4));
        let crossings = ribbons(self.library, self.one, (across, self.side, 2 * pairs), seed)?;
        let characters = (DWELLING * self.side * people / self.one.region.area()).round() as usize;
        let region = strip(across, self.side, &mut ChaCha8Rng::seed_from_u64(!seed));
        let scene = Scene { region, characters, ..self.one.clone() };
        let domain = Domain::new(&scene)?;
        let lives = (characters * domain.horizon as usize) as f32;
        let wish = scene.interaction * (lives + ticks_of(&crossings) as f32);
        let is_enough = |e: &Edge| e.dwellers.len() == characters && e.company as f32 >= wish;
        // One who finds no room is worse than any lack of company.
        let merit = |e: &Edge| (e.dwellers.len(), e.company);
        let mut best = self.settled(&scene, &domain, &crossings, seed);
        for again in 1..SEEDS {
            if is_enough(&best) {
                break;
            }
            let other = self.settled(&scene, &domain, &crossings, seed.wrapping_add(again));
            best = if merit(&other) > merit(&best) { other } else { best };
        }
        Ok(Edge { crossings, ..best })
    }

    /// Those who find room on a strip that others cross.
    fn settled(&self, scene: &Scene, domain: &Domain, crossings: &[Crossing], seed: u64) -> Edge {
        let mut tracks = Tracks::new(self.library, domain);
        let all: Vec<Piece> = crossings.iter().flat_map(|c| c.all().cloned()).collect();
        tracks.fix([&all]);
        let mut go_on = |_: &Progress| true;
        let clock = Clock::new(self.secs, &mut go_on);
        let tracks = fill_edge(scene, self.passages, tracks, ticks_of(crossings), seed, clock);
        let life = |ids: &Vec<_>| ids.iter().map(|&id| tracks.piece(id).clone()).collect();
        let dwellers = tracks.tracks.iter().map(life).collect();
        Edge { crossings: vec![], dwellers, instances: tracks.next_instance(), company: tracks.company() }
    }
}
