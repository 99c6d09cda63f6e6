//! The checkpoint file (`*.tiling`, magic `CQTILNG`): a [container](crate::container).
//!
//! Header: `scene` (all that a scene file can say and what was added in Python), `seed`, `patches` (name of the patch set,
//! if told, and `digest`), `reached`, `agenda` (what is still to be done), `kinds` (names of the kinds in use).
//!
//! Arrays: `lives` u32, pieces per person; then for all pieces, person after person, in order of time: `played` u32 kind
//! (index in `kinds`), role, instance, instances of several people that it comes from and leads to (2^32 - 1: none);
//! `times` i32 tick of the entry and of the exit; `samples` u32, samples of its deformed path, 0 where it is placed
//! rigidly. `ways` f32: of a rigid piece x, z, heading of its entry; of a deformed one x, z of all samples and then
//! their headings. Last, `digest` u32 low and high half of a digest of all bytes before it.

use glam::Vec2;

use super::lay::{Laid, Way};
use super::{Agenda, Checkpoint, Reached, fnv};
use crate::container::{Reader, Writer};
use crate::geom::Ground;
use crate::motion::MotionPath;
use crate::tiling::Scene;
use crate::tiling::bridge::NO_INSTANCE;
use crate::tiling::piece::Company;
use crate::{Error, Result};

const MAGIC: &[u8; 8] = b"CQTILNG\0";
const VERSION: u32 = 1;
/// Bytes of the digest.
const DIGEST: usize = 8;
/// Instances of changes have numbers from here on; those of a tiling are smaller.
const MOST_INSTANCES: u32 = 1 << 31;
/// Nobody is farther from the origin, metres, or turned further, radians, and no tick is farther from the first.
const FARTHEST: f32 = 1e6;
const LATEST: i32 = 1 << 24;

#[derive(serde::Serialize, serde::Deserialize)]
struct Header {
    scene: Scene,
    seed: u64,
    patches: Patches,
    reached: Reached,
    agenda: Agenda,
    kinds: Vec<String>,
}

#[derive(serde::Serialize, serde::Deserialize)]
struct Patches {
    name: Option<String>,
    digest: String,
}

fn bad<T>(place: impl Into<String>, problem: impl Into<String>) -> Result<T> {
    Err(Error::invalid("checkpoint", place, problem))
}

impl Checkpoint {
    /// The bytes of a checkpoint file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let all = || self.people.iter().flatten();
        let mut writer = Writer::default();
        writer.array("lives", &self.people.iter().map(|life| life.len() as u32).collect::<Vec<_>>());
        let played = |l: &Laid| [l.kind, l.role, l.instance, l.company.from, l.company.to];
        writer.array("played", &all().flat_map(played).collect::<Vec<u32>>());
        writer.array("times", &all().flat_map(|l| [l.begin, l.end]).collect::<Vec<i32>>());
        let samples = |l: &Laid| match &l.way {
            Way::Rigid(_) => 0,
            Way::Along(path) => path.len() as u32,
        };
        writer.array("samples", &all().map(samples).collect::<Vec<u32>>());
        writer.array("ways", &all().flat_map(Laid::numbers).collect::<Vec<f32>>());
        writer.array("digest", &[0u32, 0]);
        let header = Header {
            scene: self.scene.clone(),
            seed: self.seed,
            patches: Patches { name: self.patches.clone(), digest: self.digest.clone() },
            reached: self.reached,
            agenda: self.agenda.clone(),
            kinds: self.kinds.clone(),
        };
        let mut bytes = writer.finish(MAGIC, VERSION, &header);
        Self::sign(&mut bytes);
        bytes
    }

    /// Puts the digest of all bytes before it at the end of a file that was changed on purpose.
    pub fn sign(bytes: &mut [u8]) {
        if let Some((all, digest)) = bytes.split_last_chunk_mut::<DIGEST>() {
            *digest = fnv(all).to_le_bytes();
        }
    }

    /// A checkpoint from the bytes of its file. That it is a tiling of a scene with a patch set is seen when a run goes
    /// on from it.
    ///
    /// # Errors
    /// Names the place: magic, version, digest, header field, person, piece.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let reader = Reader::open(bytes, MAGIC, VERSION..=VERSION)?;
        if !is_signed(bytes) {
            return bad("digest", "expected the digest of all bytes, found another: the file is damaged");
        }
        let header: Header = reader.header()?;
        if let Some(problem) = header.scene.problem() {
            return bad("header: scene", problem);
        }
        let people = Arrays::read(&reader)?.people(&header)?;
        let Header { scene, seed, patches: Patches { name, digest }, reached, agenda, kinds } = header;
        expect_agenda(&agenda, &scene)?;
        if reached.people != people.len() || !reached.multi_person_share.is_finite() || !reached.secs.is_finite() {
            return bad(
                "header: reached",
                format!("expected what {} people have reached, found {reached:?}", people.len()),
            );
        }
        Ok(Self { scene, seed, patches: name, reached, digest, agenda, kinds, people })
    }
}

fn is_signed(bytes: &[u8]) -> bool {
    bytes.split_last_chunk::<DIGEST>().is_some_and(|(all, digest)| fnv(all).to_le_bytes() == *digest)
}

fn expect_agenda(agenda: &Agenda, scene: &Scene) -> Result<()> {
    if agenda.next_instance > MOST_INSTANCES {
        return bad("header: agenda", format!("expected less than 2^31 instances, found {}", agenda.next_instance));
    }
    if let Some(team) = agenda.lining_up.iter().find(|&&team| team >= scene.teams.len()) {
        return bad("header: agenda", format!("expected one of {} teams, found number {team}", scene.teams.len()));
    }
    let known = |&&(source, tick): &&(usize, i32)| source >= scene.sources.len() || !(0..LATEST).contains(&tick);
    match agenda.coming.iter().find(known) {
        Some(found) => bad("header: agenda", format!("expected sources of the scene and ticks, found {found:?}")),
        None => Ok(()),
    }
}

/// The arrays, flat.
struct Arrays {
    lives: Vec<u32>,
    played: Vec<u32>,
    times: Vec<i32>,
    samples: Vec<u32>,
    ways: Vec<f32>,
}

impl Arrays {
    fn read(reader: &Reader) -> Result<Self> {
        let all = Self {
            lives: reader.array("lives")?,
            played: reader.array("played")?,
            times: reader.array("times")?,
            samples: reader.array("samples")?,
            ways: reader.array("ways")?,
        };
        let pieces = all.lives.iter().map(|&n| n as usize).sum::<usize>();
        let found = (all.played.len(), all.times.len(), all.samples.len());
        if found != (5 * pieces, 2 * pieces, pieces) {
            return bad("arrays", format!("expected the numbers of {pieces} pieces, found {found:?}"));
        }
        let numbers = all.samples.iter().map(|&n| 3 * (n as usize).max(1)).sum::<usize>();
        if all.ways.len() != numbers {
            return bad("array ways", format!("expected {numbers} numbers, found {}", all.ways.len()));
        }
        Ok(all)
    }

    fn people(&self, header: &Header) -> Result<Vec<Vec<Laid>>> {
        let (mut piece, mut way) = (0, 0);
        let mut life = |(person, &count): (usize, &u32)| {
            let mut next = |k: usize| {
                let laid = self.piece(piece, way);
                (piece, way) = (piece + 1, way + 3 * (self.samples[piece] as usize).max(1));
                expect_sound(&laid, header)
                    .map_err(|problem| Error::invalid("checkpoint", format!("person {person}, piece {k}"), problem))?;
                Ok(laid)
            };
            (0..count as usize).map(&mut next).collect()
        };
        self.lives.iter().enumerate().map(&mut life).collect()
    }

    fn piece(&self, i: usize, way: usize) -> Laid {
        let [kind, role, instance, from, to] = std::array::from_fn(|k| self.played[5 * i + k]);
        let n = self.samples[i] as usize;
        let numbers = &self.ways[way..way + 3 * n.max(1)];
        let way = match n {
            0 => Way::Rigid(Ground::new(Vec2::new(numbers[0], numbers[1]), numbers[2])),
            _ => Way::Along(MotionPath {
                points: numbers[..2 * n].chunks_exact(2).map(Vec2::from_slice).collect(),
                headings: numbers[2 * n..].to_vec(),
            }),
        };
        Laid {
            kind,
            role,
            instance,
            company: Company { from, to },
            begin: self.times[2 * i],
            end: self.times[2 * i + 1],
            way,
        }
    }
}

/// What is wrong with a piece as far as that is seen without the patch set.
fn expect_sound(laid: &Laid, header: &Header) -> std::result::Result<(), String> {
    let Header { kinds, agenda, .. } = header;
    if laid.kind as usize >= kinds.len() {
        return Err(format!("expected one of {} kinds, found number {}", kinds.len(), laid.kind));
    }
    let known = agenda.next_instance;
    if let Some(found) = laid.instances().find(|&i| i >= known && i != NO_INSTANCE) {
        return Err(format!("expected an instance below {known}, found {found}"));
    }
    if laid.instance == NO_INSTANCE {
        return Err("expected an instance, found none".into());
    }
    if !(-LATEST <= laid.begin && laid.begin < laid.end && laid.end <= LATEST) {
        return Err(format!("expected an end after the beginning, found ticks {} to {}", laid.begin, laid.end));
    }
    match laid.numbers().find(|v| v.is_nan() || v.abs() > FARTHEST) {
        Some(found) => Err(format!("expected finite places and headings, found {found}")),
        None => Ok(()),
    }
}
