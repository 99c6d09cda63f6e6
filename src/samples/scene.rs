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
/// Where its middle is, seen from the middle between the palms: up and ahead (m). Palms are on the near half, so that
/// two people have room for their hands.
pub(super) const GRIP: [f32; 2] = [-0.03, 0.05];
/// Size of the crate that people sit on.
pub(super) const CRATE: [f32; 3] = [0.46, 0.40, 0.38];
/// How far ahead of a sitter's hips its middle is.
const SEAT: f32 = -0.03;

/// A take in the making. Frames are at 30 per second.
pub(super) struct Scene {
    name: String,
    pub actors: Vec<Actor>,
    contacts: Vec<TakeContact>,
    patches: Vec<TakePatch>,
    box_holds: Vec<TakeHold>,
    seats: Vec<TakeHold>,
}

impl Scene {
    pub fn new(name: &str, actors: Vec<Actor>) -> Self {
        Self {
            name: name.to_owned(),
            actors,
            contacts: Vec::new(),
            patches: Vec::new(),
            box_holds: vec![],
            seats: vec![],
        }
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

    /// A person holds the box over a time in seconds; by default from the beginning, or to the end.
    pub fn hold_box(&mut self, person: usize, begin: Option<f32>, end: Option<f32>) {
        let (begin, end) = (begin.unwrap_or(0.0), end.unwrap_or(f32::INFINITY));
        self.box_holds.push(TakeHold { person, begin, end });
    }

    /// A person sits on a crate of their own over a time in seconds.
    pub fn sit(&mut self, person: usize, begin: f32, end: f32) {
        self.seats.push(TakeHold { person, begin, end });
    }

    /// The boxes as props of a take that lasts `end` seconds.
    fn props(&self, end: f32) -> Vec<TakeProp> {
        let held: Vec<_> = self.box_holds.iter().map(|h| TakeHold { end: h.end.min(end), ..h.clone() }).collect();
        let carried = TakeProp { name: "box".into(), size: BOX, grip: GRIP, held, sat: vec![], seat: 0.0 };
        let crates = self.seats.iter().enumerate().map(|(i, seat)| TakeProp {
            name: if i == 0 { "crate".into() } else { format!("crate-{}", i + 1) },
            size: CRATE,
            grip: GRIP,
            held: vec![],
            sat: vec![seat.clone()],
            seat: SEAT,
        });
        (!carried.held.is_empty()).then_some(carried.clone()).into_iter().chain(crates).collect()
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
