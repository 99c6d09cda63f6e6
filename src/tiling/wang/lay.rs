//! Laying tiles: everybody's stays in the tiles that they come through are chained at the borders.

use std::collections::BTreeMap;

use glam::Vec2;

use super::edge::Edges;
use super::plane::{Key, Plane};
use super::tile::{Gap, Stay, Tile, UPPER_SIDES, beyond, edge_of, of_side};
use crate::tiling::bridge::NO_INSTANCE;
use crate::tiling::piece::{Company, Piece, Shift};

/// A plane and its tiles.
pub(super) struct Layout<'a> {
    /// Where.
    pub plane: Plane,
    /// All tiles that it has.
    pub tiles: &'a BTreeMap<Key, Tile>,
    /// What happens at edges.
    pub edges: &'a Edges,
    /// Side of a tile, metres.
    pub side: f32,
}

impl Layout<'_> {
    /// Everybody's patches, in order of time. Who begins in a tile comes before those who begin in later ones.
    pub fn people(&self) -> Vec<Vec<Piece>> {
        let places: Vec<[i64; 2]> = self.plane.places().collect();
        let mut bases = Vec::with_capacity(places.len());
        let mut numbers = 0;
        for &at in &places {
            bases.push(numbers);
            numbers += self.tile(at).instances;
        }
        let mut numbers = numbers..;
        let starts = |&at: &[i64; 2]| self.tile(at).stays.iter().filter(|s| s.from.is_none()).map(move |s| (at, s));
        let mut people: Vec<Vec<Piece>> =
            places.iter().flat_map(starts).map(|(at, stay)| self.life(at, stay, &bases, &mut numbers)).collect();
        let mut base = numbers.start;
        // The upper borders of a tile are the lower ones of others.
        for (&at, side) in places.iter().flat_map(|at| UPPER_SIDES.map(|side| (at, side))) {
            let colour = self.plane.key(at).sides[side];
            let Some(edge) = colour.map(|colour| self.edges.of(of_side(side).0, colour)) else { continue };
            let place = self.plane.corner(at) + edge_of(side, self.side);
            people.extend(edge.dwellers.iter().map(|life| life.iter().map(|p| laid(p, place, base)).collect()));
            base += edge.instances;
        }
        people
    }

    fn tile(&self, at: [i64; 2]) -> &Tile {
        &self.tiles[&self.plane.key(at)]
    }

    /// From a stay on through all tiles that lead on.
    fn life<'s>(
        &'s self,
        mut at: [i64; 2],
        mut stay: &'s Stay,
        bases: &[u32],
        numbers: &mut impl Iterator<Item = u32>,
    ) -> Vec<Piece> {
        let mut pieces = Vec::new();
        loop {
            let (base, corner) = (bases[self.plane.index(at)], self.plane.corner(at));
            pieces.extend(stay.pieces.iter().map(|p| laid(p, corner, base)));
            let Some(gap) = stay.to else { return pieces };
            pieces.extend(self.crossing(at, gap).zip(numbers.by_ref()).map(numbered));
            at = step(at, gap.side);
            let on = beyond(gap);
            stay = self.tile(at).stays.iter().find(|s| s.from == Some(on)).expect("neighbours agree on their edge");
        }
    }

    /// The patches that lead across a border.
    fn crossing(&self, at: [i64; 2], gap: Gap) -> impl Iterator<Item = Piece> {
        let colour = self.plane.key(at).sides[gap.side].expect("nobody crosses the rim");
        let crossing = &self.edges.of(of_side(gap.side).0, colour).crossings[gap.number];
        let place = self.plane.corner(at) + edge_of(gap.side, self.side);
        crossing.pieces.iter().map(move |p| p.clone().shifted(Shift { place, ticks: 0 }))
    }
}

fn numbered((piece, instance): (Piece, u32)) -> Piece {
    Piece { instance, ..piece }
}

/// The tile beyond a side.
fn step([i, k]: [i64; 2], side: usize) -> [i64; 2] {
    [[i - 1, k], [i + 1, k], [i, k - 1], [i, k + 1]][side]
}

/// A piece of a tile or an edge that is laid somewhere.
fn laid(piece: &Piece, place: Vec2, base: u32) -> Piece {
    let number = |instance: u32| if instance == NO_INSTANCE { instance } else { instance + base };
    let Company { from, to } = piece.company;
    Piece {
        instance: number(piece.instance),
        company: Company { from: number(from), to: number(to) },
        ..piece.clone().shifted(Shift { place, ticks: 0 })
    }
}
