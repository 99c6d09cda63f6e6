//! The patch-set file (`*.patches`, magic `CQPATCH`): a [container](crate::container) with these arrays over all
//! fragments in order: `points` f32 x,z per frame; `headings`, `heights` f32 per frame; `rotations` i16 x,y,z,w per
//! frame and joint (value / 32767).
//!
//! Versions: 1 had no `props`; 2 has them per kind: boxes with name, size, grip (where the middle is, seen from the
//! middle between the palms: up, ahead), holds (role, begin, end: frames of the patch's clock), sat (who sits on it,
//! likewise; absent if nobody) and where they rest before and after (middle, heading). Both are read, 2 is written. The header
//! may have a `study` (see [`super::study`]).

use std::path::Path;

use glam::{Quat, Vec2};

use super::study::{Study, StudyHeader};
use super::{Contact, Fragment, PatchKind, PatchProp, PatchSet, PoseGroup};
use crate::container::{Reader, Writer, write_whole};
use crate::motion::{FPS, JOINT_COUNT, Motion, MotionPath, Plant, Skeleton, canonical};
use crate::{Error, Result};

const MAGIC: &[u8; 8] = b"CQPATCH\0";
const VERSION: u32 = 2;

#[derive(serde::Serialize, serde::Deserialize)]
pub(crate) struct Header {
    fps: f32,
    skeleton: Skeleton,
    groups: Vec<PoseGroup>,
    kinds: Vec<KindHeader>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    study: Option<StudyHeader>,
}

#[derive(serde::Serialize, serde::Deserialize)]
struct KindHeader {
    name: String,
    labels: Vec<String>,
    mirrored: bool,
    core: Option<(u32, u32)>,
    contacts: Vec<Contact>,
    #[serde(default)]
    props: Vec<PatchProp>,
    fragments: Vec<FragmentHeader>,
}

#[derive(serde::Serialize, serde::Deserialize)]
struct FragmentHeader {
    begin: u32,
    frames: u32,
    entry_group: u32,
    exit_group: u32,
    plants: Vec<Plant>,
}

/// A rotation as four 16-bit integers; the error is below 0.005 degrees.
pub(crate) fn pack_rotation(q: Quat) -> [i16; 4] {
    // Half up, without a call of the library's `round`: this runs for every joint of every frame of a crowd.
    q.to_array().map(|v| (v * 32767.0 + 0.5_f32.copysign(v)) as i16)
}

/// The rotation packed by [`pack_rotation`].
pub(crate) fn unpack_rotation(packed: &[i16]) -> Quat {
    Quat::from_array(std::array::from_fn(|i| packed[i] as f32 / 32767.0)).normalize()
}

/// The nearest rotation that a file keeps exactly: packed and unpacked it is itself, bit by bit.
pub(crate) fn filed_rotation(q: Quat) -> Quat {
    // Normalizing what was rounded can round it elsewhere; that settles within a few steps.
    let mut packed = pack_rotation(q);
    for _ in 0..8 {
        let again = pack_rotation(unpack_rotation(&packed));
        if again == packed {
            break;
        }
        packed = again;
    }
    unpack_rotation(&packed)
}

impl PatchSet {
    /// The set as the bytes of a patch-set file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut writer = Writer::default();
        let mut header = self.write_into(&mut writer, "");
        header.study = self.study.as_ref().map(|study| study.write_into(&mut writer));
        writer.finish(MAGIC, VERSION, &header)
    }

    /// Adds the set's arrays to `writer`, their names prefixed; returns the header. The crowd file embeds sets so,
    /// without their studies.
    pub(crate) fn write_into(&self, writer: &mut Writer, prefix: &str) -> Header {
        let motions: Vec<&Motion> = self.kinds.iter().flat_map(|k| &k.fragments).map(|f| &f.motion).collect();
        let flat = |of: fn(&Motion) -> &[f32]| motions.iter().flat_map(|m| of(m)).copied().collect::<Vec<f32>>();
        let points: Vec<f32> = motions.iter().flat_map(|m| &m.path.points).flat_map(|p| [p.x, p.y]).collect();
        writer.array(&format!("{prefix}points"), &points);
        writer.array(&format!("{prefix}headings"), &flat(|m| &m.path.headings));
        writer.array(&format!("{prefix}heights"), &flat(|m| &m.heights));
        let rotations: Vec<i16> = motions.iter().flat_map(|m| &m.rotations).flat_map(|&q| pack_rotation(q)).collect();
        writer.array(&format!("{prefix}rotations"), &rotations);
        Header {
            fps: FPS,
            skeleton: canonical().clone(),
            groups: self.groups.clone(),
            kinds: self.kinds.iter().map(kind_header).collect(),
            study: None,
        }
    }

    /// A set from the bytes of a patch-set file.
    ///
    /// # Errors
    /// Names the place: magic, version, header field, kind, array.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let reader = Reader::open(bytes, MAGIC, 1..=VERSION)?;
        Self::read_from(&reader, reader.header()?, "")
    }

    /// The header of the set embedded under `prefix`, then its arrays.
    pub(crate) fn read_embedded(reader: &Reader, header: serde_json::Value, prefix: &str) -> Result<Self> {
        let header =
            serde_json::from_value(header).map_err(|e| Error::invalid("patch set", "header", e.to_string()))?;
        Self::read_from(reader, header, prefix)
    }

    fn read_from(reader: &Reader, header: Header, prefix: &str) -> Result<Self> {
        let mut arrays = Arrays {
            points: reader.array(&format!("{prefix}points"))?,
            headings: reader.array(&format!("{prefix}headings"))?,
            heights: reader.array(&format!("{prefix}heights"))?,
            rotations: reader.array(&format!("{prefix}rotations"))?,
            frame: 0,
        };
        let mut kinds = Vec::with_capacity(header.kinds.len());
        for kind in header.kinds {
            let place = format!("kind {}", kind.name);
            let fragments = kind.fragments.into_iter().map(|f| arrays.fragment(f, &place));
            kinds.push(PatchKind {
                fragments: fragments.collect::<Result<_>>()?,
                name: kind.name,
                labels: kind.labels,
                contacts: kind.contacts,
                core: kind.core,
                props: kind.props,
                mirrored: kind.mirrored,
            });
        }
        let study = header.study.map(|study| Study::read_from(reader, study)).transpose()?;
        let set = Self { groups: header.groups, kinds, study };
        match set.validate().into_iter().next() {
            Some(problem) => Err(problem),
            None => Ok(set),
        }
    }

    /// Writes a patch-set file, whole or not at all.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn save(&self, path: &Path) -> Result<()> {
        write_whole(path, &self.to_bytes())
    }

    /// Reads a patch-set file.
    ///
    /// # Errors
    /// The file is not there or is not a valid set.
    pub fn load(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
        Self::from_bytes(&bytes).map_err(|e| e.in_file(path))
    }

    /// All problems of the set: kinds without people, fragments shorter than two frames, contacts out of range,
    /// pose groups that do not exist, props held by nobody or out of turn, ports of one pose group that hold different
    /// things.
    pub fn validate(&self) -> Vec<Error> {
        let mut problems = Vec::new();
        for kind in &self.kinds {
            let mut bad =
                |problem: String| problems.push(Error::invalid("patch set", format!("kind {}", kind.name), problem));
            if kind.fragments.is_empty() {
                bad("expected at least one fragment, found none".into());
            }
            for (role, f) in kind.fragments.iter().enumerate() {
                if f.motion.len() < 2 {
                    bad(format!("role {role}: expected at least 2 frames, found {}", f.motion.len()));
                }
                if f.entry_group.max(f.exit_group) as usize >= self.groups.len() {
                    bad(format!("role {role}: pose group {} does not exist", f.entry_group.max(f.exit_group)));
                }
                let finite = f.motion.path.points.iter().all(|p| p.is_finite())
                    && f.motion.path.headings.iter().chain(&f.motion.heights).all(|v| v.is_finite())
                    && f.motion.rotations.iter().all(|q| q.is_finite());
                if !finite {
                    bad(format!("role {role}: a number that is not finite"));
                }
                if f.motion.plants.iter().any(|p| p.begin > p.end || p.end as usize >= f.motion.len()) {
                    bad(format!("role {role}: a foot plant outside its {} frames", f.motion.len()));
                }
            }
            for c in &kind.contacts {
                let inside = |role: u32| {
                    kind.fragments.get(role as usize).is_some_and(|f| {
                        f.begin <= c.begin && c.begin <= c.end && c.end < f.begin + f.motion.len() as u32
                    })
                };
                if !inside(c.a.role) || !inside(c.b.role) {
                    bad(format!("a contact over frames {}..={} lies outside its fragments", c.begin, c.end));
                }
            }
        }
        let of_kind = |(name, problem)| Error::invalid("patch set", format!("kind {name}"), problem);
        problems.extend(self.prop_problems().into_iter().map(of_kind));
        if let Some((place, problem)) =
            self.study.as_ref().filter(|_| problems.is_empty()).and_then(|s| s.problem(self))
        {
            problems.push(Error::invalid("patch set", place, problem));
        }
        problems
    }
}

fn kind_header(kind: &PatchKind) -> KindHeader {
    let fragments = kind.fragments.iter().map(|f| FragmentHeader {
        begin: f.begin,
        frames: f.motion.len() as u32,
        entry_group: f.entry_group,
        exit_group: f.exit_group,
        plants: f.motion.plants.clone(),
    });
    KindHeader {
        name: kind.name.clone(),
        labels: kind.labels.clone(),
        mirrored: kind.mirrored,
        core: kind.core,
        contacts: kind.contacts.clone(),
        props: kind.props.clone(),
        fragments: fragments.collect(),
    }
}

struct Arrays {
    points: Vec<f32>,
    headings: Vec<f32>,
    heights: Vec<f32>,
    rotations: Vec<i16>,
    frame: usize,
}

impl Arrays {
    fn fragment(&mut self, header: FragmentHeader, place: &str) -> Result<Fragment> {
        let (from, to) = (self.frame, self.frame.saturating_add(header.frames as usize));
        let long_enough = to <= self.headings.len()
            && to <= self.heights.len()
            && to * 2 <= self.points.len()
            && to * JOINT_COUNT * 4 <= self.rotations.len();
        if !long_enough {
            return Err(Error::invalid(
                "patch set",
                place,
                format!("{} frames reach beyond the arrays", header.frames),
            ));
        }
        self.frame = to;
        let rotations = &self.rotations[from * JOINT_COUNT * 4..to * JOINT_COUNT * 4];
        Ok(Fragment {
            motion: Motion {
                path: MotionPath {
                    points: self.points[from * 2..to * 2].chunks_exact(2).map(Vec2::from_slice).collect(),
                    headings: self.headings[from..to].to_vec(),
                },
                heights: self.heights[from..to].to_vec(),
                rotations: rotations.chunks_exact(4).map(unpack_rotation).collect(),
                plants: header.plants,
            },
            begin: header.begin,
            entry_group: header.entry_group,
            exit_group: header.exit_group,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn filed_rotations_come_back_bit_by_bit(axis in prop::array::uniform3(-1f32..1.0), angle in 0f32..6.3) {
            let axis = glam::Vec3::from(axis).try_normalize().unwrap_or(glam::Vec3::X);
            let q = Quat::from_axis_angle(axis, angle);
            let filed = filed_rotation(q);
            prop_assert_eq!(unpack_rotation(&pack_rotation(filed)), filed);
            prop_assert!(super::super::turn_between(q, filed).to_degrees() < 0.01);
        }
    }
}
