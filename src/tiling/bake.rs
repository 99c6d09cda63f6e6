//! Baking: chains of pieces become the finished crowd. Both methods end here.

use std::collections::BTreeMap;

use super::Scene;
use super::builds::people;
use super::domain::Domain;
use super::library::Library;
use super::occupancy::{Occupancy, PieceId};
use super::piece::Piece;
use crate::patch::{PatchKind, filed_rotation};
use crate::refine::{Body, Performance};
use crate::stage::{Character, Crowd, DomainInfo, FragmentUse, Instance};

/// A tiling as people: each person's pieces in order of time.
#[derive(Clone, Copy)]
pub(super) struct Chains<'a> {
    /// The patches.
    pub library: &'a Library<'a>,
    /// Where and when.
    pub domain: &'a Domain,
    /// The pieces.
    pub occupancy: &'a Occupancy,
    /// A list of pieces per person.
    pub lists: &'a [Vec<PieceId>],
}

impl<'a> Chains<'a> {
    /// A person's pieces.
    pub fn pieces(self, person: usize) -> impl Iterator<Item = &'a Piece> {
        self.lists[person].iter().map(move |&id| self.occupancy.piece(id))
    }

    /// Number of people in a piece's patch.
    pub fn people_of(self, piece: &Piece) -> usize {
        self.library.set.kinds[self.library.roles[piece.role as usize].kind as usize].people()
    }

    /// The piece a person is in at `tick`.
    pub fn piece_at(self, person: usize, tick: i32) -> Option<&'a Piece> {
        self.pieces(person).find(|p| tick < p.end)
    }

    /// Of the instances that two people are in at `tick`, the one with fewer people.
    pub fn smaller_instance(self, a: usize, b: usize, tick: i32) -> u32 {
        let pieces = [a, b].into_iter().filter_map(|t| self.piece_at(t, tick).or_else(|| self.pieces(t).last()));
        pieces.min_by_key(|p| self.people_of(p)).expect("people have pieces").instance
    }

    /// Share of the people's time inside patches of two or more.
    pub fn multi_person_share(self) -> f32 {
        let (mut multi, mut all) = (0, 0);
        for piece in (0..self.lists.len()).flat_map(|t| self.pieces(t)) {
            all += piece.ticks_inside();
            multi += if self.people_of(piece) > 1 { piece.ticks_inside() } else { 0 };
        }
        multi as f32 / all.max(1) as f32
    }
}

/// The fragments of a person that are seen within the domain's time, in order: kind and placement.
pub(super) fn segments_of<'a>(chains: Chains<'a>, person: usize) -> Vec<(&'a PatchKind, FragmentUse)> {
    uses(chains.library, chains.domain.horizon, chains.pieces(person))
}

/// The same of some pieces in order of time.
pub(super) fn uses<'a, 'p>(
    library: &Library<'a>,
    horizon: i32,
    pieces: impl Iterator<Item = &'p Piece>,
) -> Vec<(&'a PatchKind, FragmentUse)> {
    let seen = pieces.filter(|p| p.end > 0 && p.begin < horizon);
    seen.map(|piece| {
        let role = &library.roles[piece.role as usize];
        let placed = FragmentUse {
            instance: piece.instance,
            role: role.role,
            begin: piece.begin,
            end: piece.end,
            points: piece.path.points.clone(),
            headings: piece.path.headings.clone(),
        };
        (&library.set.kinds[role.kind as usize], placed)
    })
    .collect()
}

/// The finished crowd. Instances are numbered in the order in which people meet them.
pub(super) fn bake(chains: Chains, scene: &Scene, seed: u64, played: Performance) -> Crowd {
    let Performance { bodies, props, .. } = played;
    let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
    let mut instances = Vec::new();
    let mut characters = Vec::with_capacity(bodies.len());
    for (person, (build, body)) in people(chains, &bodies, &props, seed).into_iter().enumerate() {
        let mut fragments: Vec<FragmentUse> =
            segments_of(chains, person).into_iter().map(|(_, placed)| placed).collect();
        let roles: BTreeMap<u32, u32> = chains.pieces(person).map(|p| (p.instance, p.role)).collect();
        for f in &mut fragments {
            let kind = chains.library.roles[roles[&f.instance] as usize].kind;
            f.instance = *numbers.entry(f.instance).or_insert_with(|| {
                instances.push(Instance { kind });
                instances.len() as u32 - 1
            });
        }
        let Body { begin, root, rotations, .. } = body;
        // As a file keeps them: what is checked in memory is what is loaded later.
        let rotations = rotations.into_iter().map(filed_rotation).collect();
        characters.push(Character { begin, build, fragments, root, rotations });
    }
    let domain = DomainInfo {
        region: scene.region.clone(),
        obstacles: scene.obstacles.clone(),
        sources: scene.sources.iter().map(|s| s.gate.clone()).collect(),
        sinks: scene.sinks.iter().map(|s| s.gate.clone()).collect(),
        last_frame: scene.last_frame() as u32,
    };
    Crowd { seed, domain, set: chains.library.set.clone(), instances, characters, props }
}
