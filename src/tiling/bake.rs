//! Baking: chains of pieces become the finished crowd. Both methods end here.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::Scene;
use super::builds::people;
use super::domain::Domain;
use super::library::Library;
use super::occupancy::{Occupancy, PieceId};
use super::piece::{Piece, Shift};
use super::rehearsal::Rehearsal;
use crate::motion::{Build, JOINT_COUNT};
use crate::patch::{PatchKind, filed_rotation};
use crate::refine::Body;
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
        let tick = self.fold(person, tick);
        self.pieces(person).find(|p| tick < p.end)
    }

    /// A tick as a person's pieces count them.
    pub fn fold(self, person: usize, tick: i32) -> i32 {
        self.pieces(person).next().map_or(tick, |first| self.domain.cycle.fold(tick, first.begin))
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

/// Numbers of instances begin again here for each lap.
const LAP: u32 = 1 << 27;

/// The fragments of a person that are seen within the domain's time, in order: kind and placement. Where time comes
/// round: within three laps, of which the second counts; an instance is another one in every lap.
pub(super) fn segments_of<'a>(chains: Chains<'a>, person: usize) -> Vec<(&'a PatchKind, FragmentUse)> {
    uses(chains.library, chains.domain, chains.pieces(person))
}

/// The same of some pieces in order of time.
pub(super) fn uses<'a, 'p>(
    library: &Library<'a>,
    domain: &Domain,
    pieces: impl Iterator<Item = &'p Piece>,
) -> Vec<(&'a PatchKind, FragmentUse)> {
    let pieces: Vec<&Piece> = pieces.collect();
    let last = if domain.cycle.loops() { domain.last_frame() as i32 } else { domain.horizon };
    let all = laps(domain, &pieces).into_iter().flat_map(|by| pieces.iter().map(move |piece| (by, *piece)));
    let seen = all.filter(|(by, p)| p.end + by.ticks > 0 && p.begin + by.ticks < last);
    seen.map(|(by, piece)| placed(library, domain, piece, by)).collect()
}

/// By how much a person's pieces are shifted to be seen: nothing, or three times by another lap.
fn laps(domain: &Domain, pieces: &[&Piece]) -> Vec<Shift> {
    let (true, Some(first), Some(last)) = (domain.cycle.loops(), pieces.first(), pieces.last()) else {
        return vec![Shift::default()];
    };
    let lap = domain.cycle.ticks();
    let place = domain.torus.whole(last.exit().position - first.entry().position);
    let from = (-first.begin).div_euclid(lap) - 1;
    (from..from + 5).map(|k| Shift { place: place * (k - from) as f32, ticks: k * lap }).collect()
}

fn placed<'a>(library: &Library<'a>, domain: &Domain, piece: &Piece, by: Shift) -> (&'a PatchKind, FragmentUse) {
    let role = &library.roles[piece.role as usize];
    let begin = piece.begin + by.ticks;
    // All of an instance are in the lap in which its clock begins.
    let lap = if domain.cycle.loops() { (begin - role.begin).div_euclid(domain.cycle.ticks()) + 4 } else { 0 };
    let placed = FragmentUse {
        instance: piece.instance.wrapping_add(lap as u32 * LAP),
        role: role.role,
        begin,
        end: piece.end + by.ticks,
        points: piece.path.points.iter().map(|&p| p + by.place).collect(),
        headings: piece.path.headings.clone(),
    };
    (&library.set.kinds[role.kind as usize], placed)
}

/// The finished crowd. Instances are numbered in the order in which people meet them.
pub(super) fn bake(chains: Chains, scene: &Scene, seed: u64, rehearsal: Rehearsal) -> Crowd {
    let Rehearsal { played, encounters, .. } = rehearsal;
    let builds = people(chains, &played, &encounters, seed);
    // What everybody's body was made from is no longer needed, and large.
    let props = played.props;
    drop(played.bodies);
    let mut characters: Vec<Character> = builds
        .into_par_iter()
        .enumerate()
        .map(|(person, (build, body))| character(chains, person, build, body))
        .collect();
    let instances = number_instances(chains, &mut characters);
    let domain = DomainInfo {
        region: scene.region.clone(),
        obstacles: scene.obstacles.clone(),
        sources: scene.sources.iter().map(|s| s.gate.clone()).collect(),
        sinks: scene.sinks.iter().map(|s| s.gate.clone()).collect(),
        last_frame: scene.last_frame() as u32,
        periodic: scene.periodic,
        teams: scene.teams.iter().map(|t| t.name.clone()).collect(),
    };
    Crowd { seed, domain, set: chains.library.set.clone(), instances, characters, props }
}

/// Somebody as the crowd keeps them, but for the numbers of instances.
fn character(chains: Chains, person: usize, build: Arc<Build>, body: Body) -> Character {
    let mut fragments: Vec<FragmentUse> = segments_of(chains, person).into_iter().map(|(_, placed)| placed).collect();
    let Body { begin, root, rotations, .. } = last_lap_but_one(chains.domain, body, &mut fragments);
    // As a file keeps them: what is checked in memory is what is loaded later.
    let rotations = rotations.into_iter().map(filed_rotation).collect();
    Character { begin, build, team: None, fragments, root, rotations }
}

/// Numbers instances in the order in which people meet them; where time comes round one is another in every lap.
fn number_instances(chains: Chains, characters: &mut [Character]) -> Vec<Instance> {
    let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
    let instances_of_a_lap = if chains.domain.cycle.loops() { LAP } else { u32::MAX };
    let mut instances = Vec::new();
    for (person, character) in characters.iter_mut().enumerate() {
        let roles: BTreeMap<u32, u32> = chains.pieces(person).map(|p| (p.instance, p.role)).collect();
        for f in &mut character.fragments {
            let kind = chains.library.roles[roles[&(f.instance % instances_of_a_lap)] as usize].kind;
            f.instance = *numbers.entry(f.instance).or_insert_with(|| {
                instances.push(Instance { kind });
                instances.len() as u32 - 1
            });
        }
    }
    instances
}

/// What is kept of a life: of three laps the second, its last frame being the first of the third. Where the ground
/// repeats it begins inside the region.
fn last_lap_but_one(domain: &Domain, mut body: Body, fragments: &mut Vec<FragmentUse>) -> Body {
    let frames = domain.frames();
    if domain.cycle.loops() {
        let skipped = (frames.start - body.begin as i32) as usize;
        let kept = skipped..skipped + domain.horizon as usize + 1;
        body.root = body.root[kept.clone()].to_vec();
        body.rotations = body.rotations[kept.start * JOINT_COUNT..kept.end * JOINT_COUNT].to_vec();
        body.begin = 0;
        fragments.retain(|f| f.end > frames.start && f.begin < frames.end);
    }
    let root = body.root[0];
    let away = domain.torus.whole(Vec2::new(root.x, root.z) - (domain.min + domain.max) * 0.5);
    if !domain.torus.is_plane() {
        body.root.iter_mut().for_each(|p| *p -= Vec3::new(away.x, 0.0, away.y));
        fragments.iter_mut().flat_map(|f| &mut f.points).for_each(|p| *p -= away);
    }
    for f in fragments {
        (f.begin, f.end) = (f.begin - frames.start, f.end - frames.start);
    }
    body
}
