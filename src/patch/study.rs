//! What was found out about a set before anybody tiles with it: how the people of a patch come to it, go on from it to
//! another one together, and part. Only the motion counts for that, not where a patch will lie, so it is worked out once
//! (`tiling::study`) and kept with the set.

mod file;

pub(super) use file::StudyHeader;

use super::PatchSet;
use crate::deform::Limits;
use crate::geom::Ground;
use crate::motion::MotionPath;

/// The passages of a set's kinds of several people, as far as they are known.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// How far paths were deformed at most. Who tiles with other limits must find passages anew.
    pub limits: Limits,
    /// By kind: how its people come, go on and part; `None` for kinds that were not looked at.
    pub kinds: Vec<Option<[Vec<Passage>; 3]>>,
}

/// What the people of a patch do before or after it.
#[derive(Clone, Debug, PartialEq)]
pub struct Passage {
    /// The patch that they go on with, if they do.
    pub encore: Option<Encore>,
    /// By role of the patch, the patches of one person on the way, in order of time.
    pub ways: Vec<Vec<Step>>,
}

/// A patch that the people of another go on with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encore {
    /// Its kind.
    pub kind: u32,
    /// Who plays its first role: the second role is played by the next of them, and so on round.
    pub first: u32,
    /// Where it lies, seen from the first patch.
    pub patch_from_patch: Ground,
    /// How much later its clock begins than that of the first patch, ticks.
    pub ticks: i32,
}

/// A patch of one person on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Its kind.
    pub kind: u32,
    /// Ticks of its entry and exit on the clock of the patch of several people.
    pub ticks: [i32; 2],
    /// What it leads from and to.
    pub ends: [End; 2],
    /// Its entry, in the frame of that patch.
    pub entry: Ground,
    /// Its path in that frame if it is deformed, one sample per frame of the kind.
    pub path: Option<MotionPath>,
}

/// What is before or after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// Nobody else.
    Alone,
    /// The patch.
    Patch,
    /// The encore.
    Encore,
}

/// Longest time that anything may be away from a patch: a broken file could say anything, ticks.
const FARTHEST: i32 = 1 << 11;

impl Study {
    /// The study for a set that has only some of the kinds; `index` has for each its index there. What came, went on or
    /// parted by one of the others is not known any more.
    pub(crate) fn of_some(&self, index: &[Option<u32>]) -> Self {
        let there = |kind: u32| index[kind as usize];
        let kinds = self.kinds.iter().zip(index).filter(|(_, there)| there.is_some());
        let kept = |ways: &[Vec<Passage>; 3]| {
            let list = |list: &Vec<Passage>| list.iter().map(|p| p.renumbered(&there)).collect::<Option<Vec<_>>>();
            let [come, stay, part] = ways.each_ref().map(list);
            Some([come?, stay?, part?])
        };
        Self { limits: self.limits, kinds: kinds.map(|(ways, _)| ways.as_ref().and_then(kept)).collect() }
    }

    /// What is wrong with it, seen from its set; the first problem with the kind where it is.
    pub(super) fn problem(&self, set: &PatchSet) -> Option<(String, String)> {
        if self.kinds.len() != set.kinds.len() {
            let problem =
                format!("expected what was found out about {} kinds, found {}", set.kinds.len(), self.kinds.len());
            return Some(("study".into(), problem));
        }
        let of_kind = |(k, ways): (usize, &Option<[Vec<Passage>; 3]>)| {
            let mut passages = ways.iter().flatten().flatten();
            let problem = passages.find_map(|p| p.problem(set, set.kinds[k].people()))?;
            Some((format!("study of kind {}", set.kinds[k].name), problem))
        };
        self.kinds.iter().enumerate().find_map(of_kind)
    }
}

impl Passage {
    fn renumbered(&self, there: &impl Fn(u32) -> Option<u32>) -> Option<Self> {
        let step = |s: &Step| Some(Step { kind: there(s.kind)?, ..s.clone() });
        let way = |way: &Vec<Step>| way.iter().map(step).collect::<Option<Vec<_>>>();
        let encore = match self.encore {
            Some(encore) => Some(Encore { kind: there(encore.kind)?, ..encore }),
            None => None,
        };
        Some(Self { encore, ways: self.ways.iter().map(way).collect::<Option<_>>()? })
    }

    fn problem(&self, set: &PatchSet, people: usize) -> Option<String> {
        if self.ways.len() != people {
            return Some(format!("expected ways of {people} people, found {}", self.ways.len()));
        }
        let encore = self.encore.and_then(|e| e.problem(set, people));
        encore.or_else(|| self.ways.iter().flatten().find_map(|step| step.problem(set)))
    }
}

impl Encore {
    fn problem(&self, set: &PatchSet, people: usize) -> Option<String> {
        let fits = set.kinds.get(self.kind as usize).is_some_and(|k| k.people() == people);
        if !fits || self.first as usize >= people {
            return Some(format!("kind {} is none that {people} people can go on with as {}", self.kind, self.first));
        }
        let near = is_near(self.patch_from_patch) && self.ticks.abs() < FARTHEST;
        (!near).then(|| "a patch to go on with that is nowhere near".into())
    }
}

impl Step {
    fn problem(&self, set: &PatchSet) -> Option<String> {
        let Some(kind) = set.kinds.get(self.kind as usize).filter(|k| k.people() == 1) else {
            return Some(format!("kind {} is none of one person", self.kind));
        };
        let frames = kind.fragments[0].motion.len();
        let [begin, end] = self.ticks;
        let short = end.checked_sub(begin).is_none_or(|ticks| ticks < 1);
        if short || begin.saturating_abs().max(end.saturating_abs()) > FARTHEST {
            return Some(format!("kind {} from tick {begin} to {end}", kind.name));
        }
        if self.path.is_none() && (end - begin) as usize != frames - 1 {
            return Some(format!("kind {} as captured takes {} ticks, found {}", kind.name, frames - 1, end - begin));
        }
        if self.path.as_ref().is_some_and(|p| p.len() != frames) {
            return Some(format!("expected a path of {frames} frames for kind {}", kind.name));
        }
        let path = self.path.iter().flat_map(|p| p.points.iter().zip(&p.headings));
        let finite = is_near(self.entry) && path.into_iter().all(|(&p, &h)| is_near(Ground::new(p, h)));
        (!finite).then(|| format!("kind {}: a place that is nowhere near", kind.name))
    }
}

/// True for places that people can get to meanwhile; not for numbers that are none.
fn is_near(at: Ground) -> bool {
    [at.position.x, at.position.y, at.heading].iter().all(|v| v.abs() < FARTHEST as f32)
}
