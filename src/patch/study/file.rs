//! A study in a patch-set file: three arrays of rows of numbers, in order of kinds, ways and passages.

use super::{Encore, End, Passage, Step, Study};
use crate::container::{Reader, Writer};
use crate::deform::Limits;
use crate::geom::Ground;
use crate::motion::MotionPath;
use crate::{Error, Result};
use glam::Vec2;

const ENDS: [End; 3] = [End::Alone, End::Patch, End::Encore];
/// In place of the kind of an encore: none.
const NONE: i32 = -1;

/// What the header says of a study; the arrays have the rest: `study_numbers` i32, `study_places` f32.
///
/// Numbers: per passage the encore's kind (-1: none), first player and ticks, then for each role the number of its steps,
/// and per step its kind, ticks of entry and exit, ends (0 alone, 1 the patch, 2 the encore), and the number of frames of
/// its path (0: as captured). Places: per passage with an encore its x, z, heading; per step those of the entry, then
/// those of every frame of the path.
#[derive(serde::Serialize, serde::Deserialize)]
pub(in crate::patch) struct StudyHeader {
    limits: Limits,
    /// By kind: people, and numbers of passages by which they come, stay and part.
    kinds: Vec<Option<(u32, [u32; 3])>>,
}

impl Study {
    /// Adds the study's arrays; returns its part of the header.
    pub(in crate::patch) fn write_into(&self, writer: &mut Writer) -> StudyHeader {
        let (mut numbers, mut places) = (Vec::new(), Vec::new());
        let mut put = |passages: &Vec<Passage>| {
            passages.iter().for_each(|p| put_passage(p, &mut numbers, &mut places));
            passages.len() as u32
        };
        let people = |ways: &[Vec<Passage>; 3]| ways.iter().flatten().next().map_or(0, |p| p.ways.len() as u32);
        let kinds = self
            .kinds
            .iter()
            .map(|ways| ways.as_ref().map(|ways| (people(ways), ways.each_ref().map(&mut put))))
            .collect();
        writer.array("study_numbers", &numbers);
        writer.array("study_places", &places);
        StudyHeader { limits: self.limits, kinds }
    }

    /// The study that a header and the arrays tell of.
    pub(in crate::patch) fn read_from(reader: &Reader, header: StudyHeader) -> Result<Self> {
        let mut rows = Rows {
            numbers: reader.array::<i32>("study_numbers")?.into_iter(),
            places: reader.array::<f32>("study_places")?.into_iter(),
        };
        let short = || Error::invalid("patch set", "study", "expected more numbers, found the end of its arrays");
        let mut kinds = Vec::with_capacity(header.kinds.len());
        for counts in header.kinds {
            let ways = counts.map(|(people, counts)| {
                let [come, stay, part] = counts.map(|count| rows.passages(count, people));
                Some([come?, stay?, part?])
            });
            kinds.push(match ways {
                Some(ways) => Some(ways.ok_or_else(short)?),
                None => None,
            });
        }
        Ok(Self { limits: header.limits, kinds })
    }
}

fn put_passage(passage: &Passage, numbers: &mut Vec<i32>, places: &mut Vec<f32>) {
    let encore = passage.encore.map(|e| [e.kind as i32, e.first as i32, e.ticks]);
    numbers.extend(encore.unwrap_or([NONE, 0, 0]));
    let mut put = |at: Ground| places.extend([at.position.x, at.position.y, at.heading]);
    passage.encore.iter().for_each(|e| put(e.patch_from_patch));
    for way in &passage.ways {
        numbers.push(way.len() as i32);
        for step in way {
            let ends = step.ends.map(|end| ENDS.iter().position(|&e| e == end).expect("one of all") as i32);
            let frames = step.path.as_ref().map_or(0, MotionPath::len);
            numbers.extend([step.kind as i32, step.ticks[0], step.ticks[1], ends[0], ends[1], frames as i32]);
            put(step.entry);
            let path = step.path.iter().flat_map(|p| p.points.iter().zip(&p.headings));
            path.into_iter().for_each(|(&p, &h)| put(Ground::new(p, h)));
        }
    }
}

/// What is left to be read. Nothing is set aside for what a file only says it holds.
struct Rows {
    numbers: std::vec::IntoIter<i32>,
    places: std::vec::IntoIter<f32>,
}

impl Rows {
    fn passages(&mut self, count: u32, people: u32) -> Option<Vec<Passage>> {
        (0..count).map(|_| self.passage(people)).collect()
    }

    fn passage(&mut self, people: u32) -> Option<Passage> {
        let (kind, first, ticks) = (self.numbers.next()?, self.numbers.next()?, self.numbers.next()?);
        let encore = match kind {
            NONE => None,
            kind => Some(Encore { kind: kind as u32, first: first as u32, patch_from_patch: self.place()?, ticks }),
        };
        Some(Passage { encore, ways: (0..people).map(|_| self.way()).collect::<Option<_>>()? })
    }

    fn way(&mut self) -> Option<Vec<Step>> {
        let steps = self.numbers.next()?;
        (0..steps).map(|_| self.step()).collect()
    }

    fn step(&mut self) -> Option<Step> {
        let kind = self.numbers.next()? as u32;
        let ticks = [self.numbers.next()?, self.numbers.next()?];
        let ends = [self.end()?, self.end()?];
        let frames = self.numbers.next()?;
        let entry = self.place()?;
        let path = (0..frames).map(|_| self.place()).collect::<Option<Vec<_>>>()?;
        let path = MotionPath {
            points: path.iter().map(|at| at.position).collect(),
            headings: path.iter().map(|at| at.heading).collect(),
        };
        Some(Step { kind, ticks, ends, entry, path: (frames > 0).then_some(path) })
    }

    fn end(&mut self) -> Option<End> {
        ENDS.get(self.numbers.next()? as usize).copied()
    }

    fn place(&mut self) -> Option<Ground> {
        let (x, z) = (self.places.next()?, self.places.next()?);
        Some(Ground::new(Vec2::new(x, z), self.places.next()?))
    }
}
