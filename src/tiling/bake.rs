//! Baking: tracks become the finished crowd.

use std::collections::BTreeMap;

use super::Scene;
use super::tracks::{TrackId, Tracks};
use crate::patch::PatchKind;
use crate::refine::Body;
use crate::stage::{Character, Crowd, DomainInfo, FragmentUse, Instance};

/// The fragments of a person that are seen within the domain's time, in order: kind and placement.
pub(super) fn segments_of<'a>(tracks: &Tracks<'a>, track: TrackId) -> Vec<(&'a PatchKind, FragmentUse)> {
    let library = tracks.library;
    let seen = tracks.tracks[track]
        .iter()
        .map(|&id| tracks.piece(id))
        .filter(|p| p.end > 0 && p.begin < tracks.domain.horizon);
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
pub(super) fn bake(tracks: &Tracks, scene: &Scene, seed: u64, bodies: Vec<Body>) -> Crowd {
    let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
    let mut instances = Vec::new();
    let mut characters = Vec::with_capacity(bodies.len());
    for (track, body) in bodies.into_iter().enumerate() {
        let mut fragments: Vec<FragmentUse> =
            segments_of(tracks, track).into_iter().map(|(_, placed)| placed).collect();
        let pieces = tracks.tracks[track].iter().map(|&id| tracks.piece(id));
        let roles: BTreeMap<u32, u32> = pieces.map(|p| (p.instance, p.role)).collect();
        for f in &mut fragments {
            let kind = tracks.library.roles[roles[&f.instance] as usize].kind;
            f.instance = *numbers.entry(f.instance).or_insert_with(|| {
                instances.push(Instance { kind });
                instances.len() as u32 - 1
            });
        }
        characters.push(Character { begin: body.begin, fragments, root: body.root, rotations: body.rotations });
    }
    let domain = DomainInfo {
        region: scene.region.clone(),
        obstacles: scene.obstacles.clone(),
        last_frame: scene.last_frame() as u32,
    };
    Crowd { seed, domain, set: tracks.library.set.clone(), instances, characters }
}
