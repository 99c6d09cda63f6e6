//! The crowd file (`*.crowd`, magic `CQCROWD`): a [container](crate::container).
//!
//! Header: `fps`, `seed`, `skeleton` (joints with name, parent, offset, tip), `domain` (region, obstacles: `points`,
//! and if they are low or move `height` and `path`, way-points of `secs`, `position`, `heading` about which the points
//! are; `sources` and `sinks`, if there are such: `from`, `to`, `heading`, `spread`, `group` of where people may come in
//! and go out; `last_frame`), `instances` (kind), `set` (the patch set's header, see [`crate::patch`]), `builds` (name; `offsets`: x, y,
//! z per joint, which stand in for the skeleton's; `flesh`: how a body's surface around each joint differs from the
//! canonical body's: scale x, y, z about the joint in the rest pose, shift forward) and `characters`: each has `begin`
//! (first frame), `frames`, `build` (index), and `fragments` (instance, role, begin, end, `samples` = number of path
//! samples), and `team` (index of one of `domain.teams`, names) if the person is of one. Files without builds are of people with the canonical one. `props` are boxes: name, `size` (width between
//! the hands, height, depth), `begin` (first frame), `frames`, and `holds` (character, begin, end: frames over which
//! somebody has it in the hands; otherwise it rests).
//!
//! Arrays, all characters one after the other: `root` f32 x,y,z per frame; `rotations` i16 x,y,z,w per frame and joint
//! (value / 32767; hips global, others local); `path_points` f32 x,z and `path_headings` f32 per path sample of the
//! fragments; `prop_places` f32 x,y,z of the box's middle and heading (turn about +y, radians; boxes stay level) per
//! frame, all boxes one after the other; and the patch set's arrays with the prefix `set_`.
//!
//! A crowd that repeats has `domain.periodic` (`x`, `z`, `t`: true where it does). Along x and z the periods are the sides of
//! the region, a rectangle; places are not wrapped: who crosses a border goes on outside, and stands for all images a
//! whole number of periods away. In time the last frame is the first one again: everybody is there over all frames, and
//! ends where they began but for whole periods. A patch over the seam is given at both ends, as two instances. Such a crowd
//! has no boxes.
//!
//! Versions: 1 had no `props`, 2 no `height` and `path` of obstacles, 3 no `periodic`; all are read, the first of 2 to 4
//! that can say it is written.

use std::path::Path;
use std::sync::Arc;

use glam::{Quat, Vec2, Vec3};

use super::{Character, Crowd, DomainInfo, FragmentUse, Holding, Instance, Prop};
use crate::container::{Reader, Writer, write_whole};
use crate::geom::{Obstacle, Upright};
use crate::motion::{Build, BuildRows, FPS, JOINT_COUNT, Skeleton, canonical};
use crate::patch::{PatchSet, pack_rotation, unpack_rotation};
use crate::{Error, Result};

const MAGIC: &[u8; 8] = b"CQCROWD\0";
const VERSION: u32 = 4;
/// What crowds are written as that do not repeat.
const OPEN: u32 = 3;
/// What crowds are written as whose obstacles are all walls.
const WALLS_ONLY: u32 = 2;

#[derive(serde::Serialize, serde::Deserialize)]
struct Header {
    fps: f32,
    seed: u64,
    skeleton: Skeleton,
    domain: DomainInfo,
    instances: Vec<Instance>,
    #[serde(default)]
    builds: Vec<BuildRows>,
    characters: Vec<CharacterHeader>,
    #[serde(default)]
    props: Vec<PropHeader>,
    set: serde_json::Value,
}

#[derive(serde::Serialize, serde::Deserialize)]
struct PropHeader {
    name: String,
    size: [f32; 3],
    begin: u32,
    frames: u32,
    holds: Vec<Holding>,
}

#[derive(serde::Serialize, serde::Deserialize)]
struct CharacterHeader {
    begin: u32,
    frames: u32,
    #[serde(default)]
    build: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    team: Option<u32>,
    fragments: Vec<FragmentHeader>,
}

#[derive(serde::Serialize, serde::Deserialize)]
struct FragmentHeader {
    instance: u32,
    role: u32,
    begin: i32,
    end: i32,
    samples: u32,
}

impl Crowd {
    /// The crowd as the bytes of a crowd file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut writer = Writer::default();
        let people = || self.characters.iter();
        let root: Vec<f32> = people().flat_map(|c| &c.root).flat_map(|p| p.to_array()).collect();
        let rotations: Vec<i16> = people().flat_map(|c| &c.rotations).flat_map(|&q| pack_rotation(q)).collect();
        let fragments = || people().flat_map(|c| &c.fragments);
        let points: Vec<f32> = fragments().flat_map(|f| &f.points).flat_map(|p| [p.x, p.y]).collect();
        let headings: Vec<f32> = fragments().flat_map(|f| &f.headings).copied().collect();
        writer.array("root", &root);
        writer.array("rotations", &rotations);
        writer.array("path_points", &points);
        writer.array("path_headings", &headings);
        let places = self.props.iter().flat_map(|p| &p.places);
        let places = places.flat_map(|p| [p.middle.x, p.middle.y, p.middle.z, p.heading]);
        writer.array("prop_places", &places.collect::<Vec<f32>>());
        let set = serde_json::to_value(self.set.write_into(&mut writer, "set_")).expect("plain data");
        let (builds, own) = self.builds();
        let header = Header {
            fps: FPS,
            seed: self.seed,
            skeleton: canonical().clone(),
            domain: self.domain.clone(),
            instances: self.instances.clone(),
            builds: builds.iter().map(|b| b.to_rows()).collect(),
            characters: people().zip(own).map(|(c, build)| character_header(c, build as u32)).collect(),
            props: self.props.iter().map(prop_header).collect(),
            set,
        };
        let walls_only = self.domain.obstacles.iter().all(Obstacle::is_wall);
        let version = match (self.domain.periodic.any(), walls_only) {
            (true, _) => VERSION,
            (false, true) => WALLS_ONLY,
            (false, false) => OPEN,
        };
        writer.finish(MAGIC, version, &header)
    }

    /// A crowd from the bytes of a crowd file.
    ///
    /// # Errors
    /// Names the place: magic, version, header field, character, array.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let reader = Reader::open(bytes, MAGIC, 1..=VERSION)?;
        let header: Header = reader.header()?;
        let set = PatchSet::read_embedded(&reader, header.set, "set_")?;
        let mut arrays = Arrays {
            builds: builds(header.builds)?,
            root: reader.array("root")?,
            rotations: reader.array("rotations")?,
            points: reader.array("path_points")?,
            headings: reader.array("path_headings")?,
            frame: 0,
            sample: 0,
        };
        let read = |(i, c)| arrays.character(i, c);
        let characters = header.characters.into_iter().enumerate().map(read).collect::<Result<Vec<_>>>()?;
        let props = props(header.props, &reader)?;
        let problem = |(i, o): (usize, &Obstacle)| Some((i, o.problem()?));
        if let Some((i, problem)) = header.domain.obstacles.iter().enumerate().find_map(problem) {
            return Err(Error::invalid("crowd", format!("obstacle {i}"), problem));
        }
        if let Some(problem) = repeat_problem(&header.domain, props.len()) {
            return Err(Error::invalid("crowd", "domain", problem));
        }
        let gates = header.domain.sources.iter().chain(&header.domain.sinks);
        if let Some((i, problem)) = gates.enumerate().find_map(|(i, g)| Some((i, g.problem()?))) {
            return Err(Error::invalid("crowd", format!("source or sink {i}"), problem));
        }
        let crowd =
            Self { seed: header.seed, domain: header.domain, set, instances: header.instances, characters, props };
        crowd.check_references()?;
        Ok(crowd)
    }

    /// Writes a crowd file, whole or not at all.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn save(&self, path: &Path) -> Result<()> {
        write_whole(path, &self.to_bytes())
    }

    /// Reads a crowd file.
    ///
    /// # Errors
    /// The file is not there or is not a valid crowd.
    pub fn load(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
        Self::from_bytes(&bytes).map_err(|e| e.in_file(path))
    }

    fn check_references(&self) -> Result<()> {
        let bad = |place: String, problem: String| Err(Error::invalid("crowd", place, problem));
        for (i, instance) in self.instances.iter().enumerate() {
            if instance.kind as usize >= self.set.kinds.len() {
                return bad(format!("instance {i}"), format!("kind {} does not exist", instance.kind));
            }
        }
        for (i, character) in self.characters.iter().enumerate() {
            if let Some(team) = character.team.filter(|&t| t as usize >= self.domain.teams.len()) {
                let problem = format!("expected a team below {}, found {team}", self.domain.teams.len());
                return bad(format!("character {i}"), problem);
            }
            for (k, f) in character.fragments.iter().enumerate() {
                let place = || format!("character {i}, fragment {k}");
                let kind = self.instances.get(f.instance as usize).map(|n| &self.set.kinds[n.kind as usize]);
                let Some(source) = kind.and_then(|k| k.fragments.get(f.role as usize)) else {
                    return bad(place(), format!("instance {} has no role {}", f.instance, f.role));
                };
                if source.motion.len() != f.points.len() {
                    return bad(
                        place(),
                        format!("expected {} path samples, found {}", source.motion.len(), f.points.len()),
                    );
                }
                if f.end <= f.begin {
                    return bad(place(), format!("ends at frame {} before it begins at {}", f.end, f.begin));
                }
            }
        }
        for (i, prop) in self.props.iter().enumerate() {
            if let Some(hold) = prop.holds.iter().find(|h| h.character as usize >= self.characters.len()) {
                let people = self.characters.len();
                return bad(format!("prop {i}"), format!("expected a holder below {people}, found {}", hold.character));
            }
        }
        Ok(())
    }
}

/// What keeps a crowd from repeating as it says, if anything.
fn repeat_problem(domain: &DomainInfo, boxes: usize) -> Option<String> {
    let (low, high) = domain.region.bounds();
    let is_corner = |p: &Vec2| (p.x == low.x || p.x == high.x) && (p.y == low.y || p.y == high.y);
    let rectangle = domain.region.points.len() == 4 && domain.region.points.iter().all(is_corner);
    let periodic = domain.periodic;
    if periodic.in_space() && !(rectangle && high.cmpgt(low).all()) {
        return Some("expected a rectangle along x and z as a region that repeats".into());
    }
    if periodic.t && domain.last_frame == 0 {
        return Some("expected a last frame after 0 where time repeats, found 0".into());
    }
    (periodic.any() && boxes > 0).then(|| format!("expected no boxes in a crowd that repeats, found {boxes}"))
}

/// The builds that characters refer to.
fn builds(rows: Vec<BuildRows>) -> Result<Vec<Arc<Build>>> {
    if rows.is_empty() {
        return Ok(vec![Build::canonical()]);
    }
    rows.into_iter().map(|b| Build::from_rows(b).map(Arc::new)).collect()
}

fn character_header(c: &Character, build: u32) -> CharacterHeader {
    let fragments = c.fragments.iter().map(|f| FragmentHeader {
        instance: f.instance,
        role: f.role,
        begin: f.begin,
        end: f.end,
        samples: f.points.len() as u32,
    });
    CharacterHeader { begin: c.begin, frames: c.frames() as u32, build, team: c.team, fragments: fragments.collect() }
}

fn prop_header(prop: &Prop) -> PropHeader {
    PropHeader {
        name: prop.name.clone(),
        size: prop.size,
        begin: prop.begin,
        frames: prop.places.len() as u32,
        holds: prop.holds.clone(),
    }
}

fn props(headers: Vec<PropHeader>, reader: &Reader) -> Result<Vec<Prop>> {
    if headers.is_empty() {
        return Ok(vec![]);
    }
    let numbers: Vec<f32> = reader.array("prop_places")?;
    let mut places = numbers.chunks_exact(4).map(|v| Upright { middle: Vec3::from_slice(v), heading: v[3] });
    let mut read = |(i, h): (usize, PropHeader)| {
        if h.frames as usize > places.len() {
            return Err(Error::invalid("crowd", format!("prop {i}"), "its frames reach beyond the arrays"));
        }
        let places = places.by_ref().take(h.frames as usize).collect();
        Ok(Prop { name: h.name, size: h.size, begin: h.begin, places, holds: h.holds })
    };
    headers.into_iter().enumerate().map(&mut read).collect()
}

struct Arrays {
    builds: Vec<Arc<Build>>,
    root: Vec<f32>,
    rotations: Vec<i16>,
    points: Vec<f32>,
    headings: Vec<f32>,
    frame: usize,
    sample: usize,
}

impl Arrays {
    fn character(&mut self, index: usize, header: CharacterHeader) -> Result<Character> {
        let beyond = || Error::invalid("crowd", format!("character {index}"), "its frames reach beyond the arrays");
        let build = self.builds.get(header.build as usize).cloned().ok_or_else(|| {
            let problem = format!("expected a build below {}, found {}", self.builds.len(), header.build);
            Error::invalid("crowd", format!("character {index}"), problem)
        })?;
        let frames = self.frame..self.frame.saturating_add(header.frames as usize);
        let root = self.root.get(frames.start * 3..frames.end * 3).ok_or_else(beyond)?;
        let rotations = self.rotations.get(frames.start * JOINT_COUNT * 4..frames.end * JOINT_COUNT * 4);
        self.frame = frames.end;
        let mut fragments = Vec::with_capacity(header.fragments.len());
        for f in header.fragments {
            let samples = self.sample..self.sample.saturating_add(f.samples as usize);
            let points = self.points.get(samples.start * 2..samples.end * 2).ok_or_else(beyond)?;
            let headings = self.headings.get(samples.clone()).ok_or_else(beyond)?;
            self.sample = samples.end;
            fragments.push(FragmentUse {
                instance: f.instance,
                role: f.role,
                begin: f.begin,
                end: f.end,
                points: points.chunks_exact(2).map(Vec2::from_slice).collect(),
                headings: headings.to_vec(),
            });
        }
        Ok(Character {
            begin: header.begin,
            build,
            team: header.team,
            fragments,
            root: root.chunks_exact(3).map(Vec3::from_slice).collect(),
            rotations: rotations.ok_or_else(beyond)?.chunks_exact(4).map(unpack_rotation).collect::<Vec<Quat>>(),
        })
    }
}
