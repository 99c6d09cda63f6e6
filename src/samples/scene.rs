//! A scene: actors, what passes between them, and the patches to cut, played into a take.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::Take;
use super::actor::{Actor, secs};
use super::path::Path;
use super::perform::{perform, plants};
use crate::motion::BodyPart;
use crate::motion::take::{
    TakeContact, TakeFile, TakeHold, TakePatch, TakePerson, TakePlant, TakePort, TakeProp, TakeRole, Touch,
};

/// Size of the box that is carried: width between the hands, height, depth (m).
pub(super) const BOX: [f32; 3] = [0.36, 0.26, 0.30];

/// A take in the making. Frames are at 30 per second.
pub(super) struct Scene {
    name: String,
    pub actors: Vec<Actor>,
    contacts: Vec<TakeContact>,
    patches: Vec<TakePatch>,
    /// Who takes over the box, in order, each with the second of it (none for the first).
    box_holders: Vec<(usize, Option<f32>)>,
}

impl Scene {
    pub fn new(name: &str, actors: Vec<Actor>) -> Self {
        Self { name: name.to_owned(), actors, contacts: Vec::new(), patches: Vec::new(), box_holders: Vec::new() }
    }

    /// A patch of people (actor, first frame, last frame); `core` is the time of interaction in seconds.
    pub fn patch(&mut self, name: &str, labels: &[&str], roles: &[(usize, i32, i32)], core: Option<[f32; 2]>) {
        self.patches.push(TakePatch {
            name: name.to_owned(),
            labels: labels.iter().map(|&l| l.to_owned()).collect(),
            roles: roles.iter().map(|&(person, a, b)| TakeRole { person, begin: secs(a), end: secs(b) }).collect(),
            core,
        });
    }

    /// Two people touch over a time in seconds.
    pub fn contact(&mut self, a: (usize, BodyPart), b: (usize, BodyPart), begin: f32, end: f32) {
        let touch = |(person, part)| Touch { person, part };
        self.contacts.push(TakeContact { a: touch(a), b: touch(b), begin, end });
    }

    /// There is a box, held by these people in order; each but the first with the second of taking it over.
    pub fn hold_box(&mut self, holders: Vec<(usize, Option<f32>)>) {
        self.box_holders = holders;
    }

    /// The box as a prop of a take that lasts `end` seconds.
    fn props(&self, end: f32) -> Vec<TakeProp> {
        let begin = |i: usize| self.box_holders[i].1.unwrap_or(0.0);
        let last = self.box_holders.len();
        let held = (0..last).map(|i| TakeHold {
            person: self.box_holders[i].0,
            begin: begin(i),
            end: if i + 1 < last { begin(i + 1) } else { end },
        });
        let held: Vec<_> = held.collect();
        if held.is_empty() { vec![] } else { vec![TakeProp { name: "box".into(), size: BOX, held }] }
    }

    /// Plays the scene.
    pub fn play(mut self, seed: u64) -> Take {
        self.actors.iter_mut().for_each(Actor::finish);
        let end = self.actors.iter().map(|a| a.now).max().unwrap_or(0);
        let paths: Vec<Path> = self.actors.iter().map(|a| a.path(end)).collect();
        let mut clips = Vec::new();
        let (mut people, mut all_plants, mut ports) = (Vec::new(), Vec::new(), Vec::new());
        for (person, actor) in self.actors.iter().enumerate() {
            let stem = format!("{}-{}", self.name, (b'a' + person as u8) as char);
            let mut rng = ChaCha8Rng::seed_from_u64(seed ^ fnv(&stem));
            clips.push(perform(actor, person, &paths, end, &stem, &mut rng));
            people.push(TakePerson { file: format!("{stem}.bvh"), ..Default::default() });
            all_plants.extend(plants(actor, end).into_iter().map(|(foot, begin, end)| TakePlant {
                person,
                foot,
                begin,
                end,
            }));
            ports.extend(actor.ports.iter().map(|(f, pose)| TakePort { person, time: secs(*f), pose: pose.clone() }));
        }
        let props = self.props(secs(end));
        let file = TakeFile {
            format: "crowdquilt-take".into(),
            version: 1,
            name: self.name,
            description: String::new(),
            people,
            plants: all_plants,
            contacts: self.contacts,
            ports,
            patches: self.patches,
            props,
        };
        Take { file, clips }
    }
}

/// FNV-1a, so that every person of every take has random numbers of their own.
fn fnv(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3))
}
