//! Tableaux for everybody who gathers in a scene.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::play::{Wish, play};
use super::seat::sit;
use super::tableau::Tableau;
use crate::patch::PatchSet;
use crate::stage::world::mix;
use crate::world::{Layout, Template, WorldScene};

/// Different tableaux for each thing that people do.
const VERSIONS: usize = 4;

impl WorldScene {
    /// The same scene, in which people who stay do something: what they do comes out of `set`, whose patches of several people are
    /// tiled for groups, and those of one person who stays in place for who is alone. Kinds that have a word of the
    /// gathering's name as a label are meant; where there are none any will do. Also says, in words, for whom nothing was found.
    pub fn with_acts(mut self, set: &PatchSet) -> (Self, Vec<String>) {
        let (templates, period, seed) = match &mut self.layout {
            Layout::Map(plan) => (&mut plan.templates, plan.period, plan.seed),
            Layout::Area(area) => (&mut area.templates, area.period, area.seed),
        };
        let notes = cast(templates, set, period, seed);
        (self, notes)
    }
}

fn cast(templates: &mut [Template], set: &PatchSet, period: f32, seed: u64) -> Vec<String> {
    let (mut known, mut notes) = (BTreeMap::<(String, usize), Vec<Tableau>>::new(), Vec::new());
    for gathering in templates.iter_mut().flat_map(|t| &mut t.gatherings) {
        let mut all = Vec::new();
        for people in gathering.size.0.max(1)..=gathering.size.1 {
            let wish = Wish { name: &gathering.name, people, period, seed: mix(seed, people as u64) };
            let found = known.entry((gathering.name.clone(), people)).or_insert_with(|| tableaux(set, wish));
            if found.is_empty() {
                notes.push(format!("{:?}: no motion was found for {people} in one place", gathering.name));
            }
            all.extend(found.iter().cloned());
        }
        gathering.tableaux = Arc::new(all);
    }
    for template in templates {
        let Some(meeting) = &mut template.meeting else { continue };
        if !meeting.cast(set) {
            notes.push(format!("{:?}: nobody meets, no patch is labelled {:?}", template.name, meeting.labels));
        }
    }
    notes.sort();
    notes.dedup();
    notes
}

fn tableaux(set: &PatchSet, wish: Wish) -> Vec<Tableau> {
    let sitters =
        if wish.name.split_whitespace().any(|w| w == "sit") { sit(set, wish.period, VERSIONS) } else { vec![] };
    if sitters.is_empty() || wish.people == 0 {
        return play(set, wish, VERSIONS);
    }
    (0..VERSIONS).map(|version| beside(&sitters, version, wish.people)).collect()
}

/// So many sitters side by side.
fn beside(sitters: &[Tableau], version: usize, people: usize) -> Tableau {
    let chosen = (0..people).map(|k| &sitters[(version + k) % sitters.len()]);
    Tableau::row(chosen)
}
