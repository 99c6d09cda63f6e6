//! The world file (`*.world`, magic `CQWORLD`): a [container](crate::container), described number by number in
//! `docs/formats/world.md`.
//!
//! The header is [`WorldInfo`]; the arrays are those of [`Tables`] under the same names, and of the identities:
//! `crossing_cycles`, `crossing_laps`, `crossing_copies` and `cycle_people`, `cycle_copies`.

use std::path::Path;

use glam::{Quat, Vec2, Vec3};

use super::acts::Acts;
use super::gait::{Gait, GaitTable, Swing};
use super::identity::{Identities, Place, Round};
use super::{Tables, World, WorldInfo};
use crate::container::{Reader, Writer, write_whole};
use crate::motion::{Skeleton, canonical};
use crate::{Error, Result};

const MAGIC: &[u8; 8] = b"CQWORLD\0";
const VERSION: u32 = 1;

/// The world's settings, and how many poses a walking cycle has if there are bodies.
#[derive(serde::Serialize, serde::Deserialize)]
struct Header {
    #[serde(flatten)]
    info: WorldInfo,
    #[serde(default)]
    gait_phases: Option<usize>,
    /// Whether people who stay have bodies.
    #[serde(default)]
    has_acts: bool,
    /// What the rotations turn, for readers that do not know it.
    #[serde(default, skip_deserializing)]
    skeleton: Option<Skeleton>,
}

impl World {
    /// The world as the bytes of a world file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let t = self.tables();
        let mut writer = Writer::default();
        let (crossings, cycles) = t.identities.parts();
        for (name, numbers) in [
            ("pattern_ends", &t.pattern_ends),
            ("kinds", &t.kinds),
            ("walkers", &t.walkers),
            ("object_names", &t.object_names),
            ("object_ends", &t.object_ends),
            ("stayer_names", &t.stayer_names),
            ("lane_ends", &t.lane_ends),
            ("lanes", &t.lanes),
            ("instance_kinds", &t.instance_kinds),
            ("instance_phases", &t.instance_phases),
            ("crossing_cycles", &crossings.iter().map(|c| c.cycle).collect()),
            ("cycle_people", &cycles.iter().map(|c| c.people).collect()),
        ] {
            writer.array(name, numbers);
        }
        for (name, numbers) in [
            ("pattern_lengths", &t.pattern_lengths),
            ("crossings", &t.crossings),
            ("corners", &t.corners),
            ("object_points", &t.object_points),
            ("object_radii", &t.object_radii),
            ("stayers", &t.stayers),
            ("instance_turns", &t.instance_turns),
        ] {
            writer.array(name, numbers);
        }
        writer.array("edges", &t.edges);
        writer.array("instance_places", &t.instance_places);
        writer.array("crossing_laps", &crossings.iter().map(|c| c.laps).collect::<Vec<i32>>());
        writer.array("crossing_copies", &crossings.iter().flat_map(|c| c.copies).collect::<Vec<i32>>());
        writer.array("cycle_copies", &cycles.iter().flat_map(|c| c.copies).collect::<Vec<i32>>());
        writer.array("rows", &t.rows);
        if let Some(gait) = &t.gait {
            write_gait(gait, &mut writer);
        }
        if let Some(acts) = &t.acts {
            acts.write(&mut writer);
        }
        let has_acts = t.acts.is_some();
        let skeleton = (has_acts || t.gait.is_some()).then(|| canonical().clone());
        let gait_phases = t.gait.as_ref().map(|gait| gait.table.phases);
        writer.finish(MAGIC, VERSION, &Header { info: t.info.clone(), gait_phases, has_acts, skeleton })
    }

    /// A world from the bytes of a world file.
    ///
    /// # Errors
    /// Names the place: magic, version, header field, array.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let reader = Reader::open(bytes, MAGIC, VERSION..=VERSION)?;
        let Header { info, gait_phases, has_acts, .. } = reader.header()?;
        Self::new(Tables {
            info,
            gait: gait_phases.map(|phases| read_gait(phases, &reader)).transpose()?,
            acts: has_acts.then(|| Acts::read(&reader)).transpose()?,
            pattern_ends: reader.array("pattern_ends")?,
            pattern_lengths: reader.array("pattern_lengths")?,
            crossings: reader.array("crossings")?,
            kinds: reader.array("kinds")?,
            corners: reader.array("corners")?,
            edges: reader.array("edges")?,
            walkers: reader.array("walkers")?,
            object_names: reader.array("object_names")?,
            object_ends: reader.array("object_ends")?,
            object_points: reader.array("object_points")?,
            object_radii: reader.array("object_radii")?,
            stayer_names: reader.array("stayer_names")?,
            stayers: reader.array("stayers")?,
            lane_ends: reader.array("lane_ends")?,
            lanes: reader.array("lanes")?,
            rows: reader.array("rows")?,
            instance_kinds: reader.array("instance_kinds")?,
            instance_places: reader.array("instance_places")?,
            instance_turns: reader.array("instance_turns")?,
            instance_phases: reader.array("instance_phases")?,
            identities: identities(&reader)?,
        })
    }

    /// Writes a world file, whole or not at all.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn save(&self, path: &Path) -> Result<()> {
        write_whole(path, &self.to_bytes())
    }

    /// Reads a world file.
    ///
    /// # Errors
    /// The file is not there or is not a valid world.
    pub fn load(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
        Self::from_bytes(&bytes).map_err(|e| e.in_file(path))
    }
}

fn write_gait(gait: &Gait, writer: &mut Writer) {
    let table = &gait.table;
    writer.array("gait_speeds", &table.speeds);
    writer.array("gait_strides", &table.strides);
    writer.array("gait_rotations", &table.rotations.iter().flat_map(|q| q.to_array()).collect::<Vec<f32>>());
    writer.array("gait_hips", &table.hips.iter().flat_map(|p| p.to_array()).collect::<Vec<f32>>());
    if !table.prints.is_empty() {
        let swing = |s: &Swing| [s.share, s.height];
        writer.array("gait_prints", &table.prints.iter().flatten().flat_map(|p| p.to_array()).collect::<Vec<f32>>());
        writer.array("gait_swings", &table.swings.iter().flatten().flat_map(swing).collect::<Vec<f32>>());
    }
    writer.array("gait_steps", &gait.steps);
    writer.array("gait_headings", &gait.headings);
    writer.array("crossing_phases", &gait.crossing_phases);
    writer.array("crossing_paces", &gait.crossing_paces);
}

fn read_gait(phases: usize, reader: &Reader) -> Result<Gait> {
    let rotations: Vec<f32> = reader.array("gait_rotations")?;
    let hips: Vec<f32> = reader.array("gait_hips")?;
    // Worlds made before feet were led to footprints have none.
    let both = |name: &str| -> Result<Vec<Vec2>> {
        let numbers: Vec<f32> = if reader.has(name) { reader.array(name)? } else { Vec::new() };
        Ok(numbers.chunks_exact(2).map(Vec2::from_slice).collect())
    };
    let swing = |v: Vec2| Swing { share: v.x, height: v.y };
    let table = GaitTable {
        prints: both("gait_prints")?.chunks_exact(2).map(|p| [p[0], p[1]]).collect(),
        swings: both("gait_swings")?.chunks_exact(2).map(|s| [swing(s[0]), swing(s[1])]).collect(),
        speeds: reader.array("gait_speeds")?,
        strides: reader.array("gait_strides")?,
        phases,
        rotations: rotations.chunks_exact(4).map(Quat::from_slice).collect(),
        hips: hips.chunks_exact(3).map(Vec3::from_slice).collect(),
    };
    Ok(Gait {
        table,
        steps: reader.array("gait_steps")?,
        headings: reader.array("gait_headings")?,
        crossing_phases: reader.array("crossing_phases")?,
        crossing_paces: paces(reader)?,
    })
}

/// Worlds made before people met had one for every cycle.
fn paces(reader: &Reader) -> Result<Vec<f32>> {
    if reader.has("crossing_paces") {
        return reader.array("crossing_paces");
    }
    let (paces, cycles): (Vec<f32>, Vec<u32>) = (reader.array("cycle_paces")?, reader.array("crossing_cycles")?);
    let problem = || Error::invalid("world", "cycle_paces", format!("{} numbers are too few", paces.len()));
    cycles.iter().map(|&cycle| paces.get(cycle as usize).copied().ok_or_else(problem)).collect()
}

fn identities(reader: &Reader) -> Result<Identities> {
    let cycles: Vec<u32> = reader.array("crossing_cycles")?;
    let laps: Vec<i32> = reader.array("crossing_laps")?;
    let copies: Vec<i32> = reader.array("crossing_copies")?;
    let people: Vec<u32> = reader.array("cycle_people")?;
    let around: Vec<i32> = reader.array("cycle_copies")?;
    let same = laps.len() == cycles.len() && copies.len() == 2 * cycles.len() && around.len() == 2 * people.len();
    if !same {
        let lengths = [cycles.len(), laps.len(), copies.len(), people.len(), around.len()];
        let problem = format!("expected n, n, 2 n, m and 2 m numbers, found {lengths:?}");
        return Err(Error::invalid("world", "crossing_cycles to cycle_copies", problem));
    }
    let pair = |list: &[i32], i: usize| [list[2 * i], list[2 * i + 1]];
    let crossing = |i: usize| Place { cycle: cycles[i], laps: laps[i], copies: pair(&copies, i) };
    let cycle = |i: usize| Round { people: people[i], copies: pair(&around, i) };
    Ok(Identities::from_parts((0..cycles.len()).map(crossing).collect(), (0..people.len()).map(cycle).collect()))
}
