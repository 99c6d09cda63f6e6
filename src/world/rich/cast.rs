//! Tableaux for everybody who gathers in a scene.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::play::{MOST, Repertoire, Wish};
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
    /// gathering's name as a label are meant; where there are none, those of people who stand and face each other; where there are
    /// none either, people who are alone stand in a circle. Also says, in words, for whom nothing was found.
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
    let mut casting = Casting { repertoire: Repertoire::new(set), known: BTreeMap::new(), period, seed };
    let mut notes = Vec::new();
    for gathering in templates.iter_mut().flat_map(|t| &mut t.gatherings) {
        let mut all = Vec::new();
        for people in gathering.size.0.max(1)..=gathering.size.1 {
            let found = casting.tableaux(&gathering.name, people);
            if found.is_empty() {
                notes.push(format!("{:?}: no motion was found for {people} in one place", gathering.name));
            }
            all.extend(found);
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

/// What people do, and what was found for some: by the labels that are meant and the number of people.
struct Casting<'a> {
    repertoire: Repertoire<'a>,
    known: BTreeMap<(BTreeSet<String>, usize), Vec<Tableau>>,
    period: f32,
    seed: u64,
}

impl Casting<'_> {
    fn tableaux(&mut self, name: &str, people: usize) -> Vec<Tableau> {
        let sits = name.split_whitespace().any(|word| word == "sit") && people > 0;
        let sitters = if sits { sit(self.repertoire.set, self.period, VERSIONS) } else { vec![] };
        if !sitters.is_empty() {
            return (0..VERSIONS).map(|version| beside(&sitters, version, people)).collect();
        }
        let found = self.played(self.repertoire.meant(name), people);
        if found.is_empty() && (2..=MOST).contains(&people) { rings(&self.alone(), people) } else { found }
    }

    /// What people do who are alone, whatever it is called.
    fn alone(&mut self) -> Vec<Tableau> {
        self.played(BTreeSet::new(), 1)
    }

    fn played(&mut self, meant: BTreeSet<String>, people: usize) -> Vec<Tableau> {
        let meant = if people > 1 { meant } else { BTreeSet::new() };
        let wish = Wish { meant, people, period: self.period, seed: mix(self.seed, people as u64) };
        let found = self.known.entry((wish.meant.clone(), people));
        found.or_insert_with(|| self.repertoire.play(&wish, VERSIONS)).clone()
    }
}

/// Groups of people each of whom is alone in the captures: they stand in a circle and look at each other.
fn rings(singles: &[Tableau], people: usize) -> Vec<Tableau> {
    let of = |version: usize| (0..people).map(|k| &singles[(version + k) % singles.len()]).collect::<Vec<_>>();
    (0..singles.len()).map(|version| Tableau::ring(&of(version))).filter(Tableau::is_small).collect()
}

/// So many sitters side by side.
fn beside(sitters: &[Tableau], version: usize, people: usize) -> Tableau {
    let chosen = (0..people).map(|k| &sitters[(version + k) % sitters.len()]);
    Tableau::row(chosen)
}
