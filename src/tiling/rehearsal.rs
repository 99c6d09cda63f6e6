//! Rehearsal: everybody's final body and what is wrong with them, worked out anew only for those who changed and for
//! whoever shares patches with them.

use super::bake::{Chains, segments_of};
use super::encounters::Encounters;
use super::faults::{Fault, faults};
use super::tracks::Tracks;
use crate::patch::PatchKind;
use crate::refine::{Performance, Segment, refine_all, refine_some};
use crate::stage::FragmentUse;

/// The final bodies at some version of the tiling, and their faults.
pub(super) struct Rehearsal {
    /// Bodies and boxes.
    pub played: Performance,
    /// Who comes near to whom.
    pub encounters: Encounters,
    /// What is wrong, in order of time for those found together.
    pub faults: Vec<Fault>,
    version: u64,
}

impl Rehearsal {
    /// Everybody's.
    pub fn new(tracks: &Tracks) -> Self {
        Self { version: tracks.version(), ..Self::of(tracks.chains()) }
    }

    /// Of a tiling that does not change.
    pub fn of(chains: Chains) -> Self {
        let uses: Vec<_> = (0..chains.lists.len()).map(|t| segments_of(chains, t)).collect();
        let people: Vec<Vec<Segment>> = uses.iter().map(|uses| segments(uses)).collect();
        let played = refine_all(&people, chains.domain.last_frame(), chains.domain.torus);
        let encounters = Encounters::of(&played.bodies, chains.domain);
        let faults = faults(chains, &played, &encounters, &vec![true; people.len()]);
        Self { played, encounters, faults, version: 0 }
    }

    /// Again with what changed since. People must not have come or gone.
    pub fn repeat(&mut self, tracks: &Tracks) {
        let is_new = with_partners(tracks, tracks.changed_since(self.version));
        let who: Vec<usize> = (0..is_new.len()).filter(|&t| is_new[t]).collect();
        let chains = tracks.chains();
        let uses: Vec<_> =
            is_new.iter().enumerate().map(|(t, &new)| if new { segments_of(chains, t) } else { vec![] }).collect();
        let people: Vec<Vec<Segment>> = uses.iter().map(|uses| segments(uses)).collect();
        refine_some(&people, &who, chains.domain.last_frame(), chains.domain.torus, &mut self.played);
        self.faults.retain(|f| !is_new[f.a] && !is_new[f.b]);
        self.encounters.renew(&self.played.bodies, chains.domain, &is_new);
        self.faults.extend(faults(chains, &self.played, &self.encounters, &is_new));
        self.version = tracks.version();
    }
}

/// A person's fragments as refinement wants them.
pub(super) fn segments<'a>(uses: &'a [(&'a PatchKind, FragmentUse)]) -> Vec<Segment<'a>> {
    uses.iter().map(|(kind, placed)| Segment { kind, placed }).collect()
}

/// Some people, and all who are tied to them by patches, be it through others.
fn with_partners(tracks: &Tracks, mut some: Vec<bool>) -> Vec<bool> {
    let mut players: std::collections::BTreeMap<u32, Vec<usize>> = std::collections::BTreeMap::new();
    for (t, pieces) in tracks.tracks.iter().enumerate() {
        for &id in pieces.iter().filter(|&&id| tracks.people_of(id) > 1) {
            players.entry(tracks.piece(id).instance).or_default().push(t);
        }
    }
    let mut open: Vec<usize> = (0..some.len()).filter(|&t| some[t]).collect();
    while let Some(t) = open.pop() {
        for &id in tracks.tracks[t].iter().filter(|&&id| tracks.people_of(id) > 1) {
            for &partner in &players[&tracks.piece(id).instance] {
                if !std::mem::replace(&mut some[partner], true) {
                    open.push(partner);
                }
            }
        }
    }
    some
}
