//! All numbers of a world, as they stand in its file; and what must be true of them before anything is played.
//!
//! Flat arrays: a world of a million people is a few dozen allocations, written and read as it is.

use glam::DVec2;

use super::acts::Acts;
use super::gait::Gait;
use super::identity::Identities;
use super::kind::Kind;
use super::place::UNITS_PER_METRE;
use crate::{Error, Result};

/// What patches of a template look like.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TemplateInfo {
    /// Its name.
    pub name: String,
    /// What the ground looks like.
    pub ground: String,
}

/// What walkers keep to; see `world::Limits`.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WalkLimits {
    /// Radius of a body, metres.
    pub radius: f32,
    /// Greatest speed, m/s.
    pub speed: f32,
    /// Greatest acceleration, m/s2.
    pub acceleration: f32,
    /// Greatest turning, rad/s.
    pub turning: f32,
    /// Below this speed, m/s, one stands.
    pub standing: f32,
}

/// What a world is, in words and settings.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WorldInfo {
    /// Its name.
    pub name: String,
    /// Seed it was made with.
    pub seed: u64,
    /// Everything repeats after this time, seconds.
    pub period_secs: f32,
    /// Time slots of a period.
    pub slots: u32,
    /// Slots of a page; the last page may be shorter.
    pub page: u32,
    /// Control points are whole numbers of this length.
    pub metres_per_unit: f32,
    /// What walkers keep to.
    pub limits: WalkLimits,
    /// Templates.
    pub templates: Vec<TemplateInfo>,
    /// Names of objects and of what people do.
    pub names: Vec<String>,
    /// Size of what repeats for ever in x and z, in units of 1/1024 m; none if the world ends.
    pub repeat: Option<[i32; 2]>,
}

/// Somebody's stay in a page: which walker of the kind, and how many periods ago it came in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lane(pub u32);

impl Lane {
    /// Index of the walker.
    pub fn walker(self) -> usize {
        (self.0 & 0xffff) as usize
    }

    /// Periods since the one it came in.
    pub fn lap(self) -> i64 {
        i64::from(self.0 >> 16)
    }
}

/// The numbers of a world. Ends of runs are cumulative: run i goes from end i - 1 to end i.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tables {
    /// What it is.
    pub info: WorldInfo,
    /// Of every pattern: end of its inputs, end of its outputs, in `crossings`.
    pub pattern_ends: Vec<u32>,
    /// Length of every pattern's edge, metres.
    pub pattern_lengths: Vec<f32>,
    /// Place, time, speed across and along, of every crossing.
    pub crossings: Vec<f32>,
    /// Of every kind: template, then ends in `edges`, `walkers`, `object_names`, `stayer_names`.
    pub kinds: Vec<u32>,
    /// Corners x, z in the kind's frame, metres.
    pub corners: Vec<f32>,
    /// Pattern of the edge that begins at each corner; -1 - p is the mirror image of p.
    pub edges: Vec<i32>,
    /// Output (counted over all edges) of every walker, periods until it in the upper half.
    pub walkers: Vec<u32>,
    /// Name of every object.
    pub object_names: Vec<u32>,
    /// End of every object's points in `object_points`; a disc has one.
    pub object_ends: Vec<u32>,
    /// x, z of the points, metres.
    pub object_points: Vec<f32>,
    /// Radius of discs, 0 for polygons.
    pub object_radii: Vec<f32>,
    /// What everybody who stays does, a name.
    pub stayer_names: Vec<u32>,
    /// x, z, heading, radius of everybody who stays.
    pub stayers: Vec<f32>,
    /// Lanes of every page and kind, cumulative over all kinds of all pages.
    pub lane_ends: Vec<u32>,
    /// Who each lane is.
    pub lanes: Vec<u32>,
    /// Control points, page by page, row by row, kind by kind: x of all lanes, z of all lanes. Eight zeros follow, so that eight
    /// can be read from anywhere.
    pub rows: Vec<i16>,
    /// Kind of every patch.
    pub instance_kinds: Vec<u32>,
    /// Place of every patch's origin, 1/1024 m.
    pub instance_places: Vec<i32>,
    /// Turn of every patch about the vertical, radians.
    pub instance_turns: Vec<f32>,
    /// By how many slots every patch is ahead.
    pub instance_phases: Vec<u32>,
    /// Who is who.
    pub identities: Identities,
    /// Bodies, if there are any.
    pub gait: Option<Gait>,
    /// What people do who do something else than walk, if that is known.
    pub acts: Option<Acts>,
}

/// Corners are no further from the middle of their patch, metres.
const LARGEST: f32 = 200.0;

/// Words per kind in [`Tables::kinds`].
pub(super) const KIND: usize = 5;

impl Tables {
    /// How many kinds there are.
    pub fn kinds(&self) -> usize {
        self.kinds.len() / KIND
    }

    /// A view of a kind.
    pub fn kind(&self, index: usize) -> Kind<'_> {
        Kind::new(self, index)
    }

    /// How many pages there are.
    pub fn pages(&self) -> usize {
        self.info.slots.div_ceil(self.info.page) as usize
    }

    /// Slots of a page.
    pub fn page_slots(&self, page: usize) -> usize {
        (self.info.slots as usize - page * self.info.page as usize).min(self.info.page as usize)
    }

    /// Where the origin of a patch is, metres.
    pub fn place(&self, instance: usize) -> DVec2 {
        in_metres([self.instance_places[2 * instance], self.instance_places[2 * instance + 1]])
    }

    /// Bytes of all arrays.
    pub fn bytes(&self) -> usize {
        let four = [
            self.pattern_ends.len(),
            self.pattern_lengths.len(),
            self.crossings.len(),
            self.kinds.len(),
            self.corners.len(),
            self.edges.len(),
            self.walkers.len(),
            self.object_names.len() + self.object_ends.len() + self.object_points.len() + self.object_radii.len(),
            self.stayer_names.len() + self.stayers.len(),
            self.lane_ends.len() + self.lanes.len(),
            self.instance_kinds.len() + self.instance_places.len(),
            self.instance_turns.len() + self.instance_phases.len(),
        ];
        let (crossings, cycles) = self.identities.parts();
        let bodies = self.gait.as_ref().map_or(0, Gait::bytes) + self.acts.as_ref().map_or(0, Acts::bytes);
        4 * four.iter().sum::<usize>() + 2 * self.rows.len() + 16 * crossings.len() + 12 * cycles.len() + bodies
    }

    /// Whether the numbers make a world.
    ///
    /// # Errors
    /// Names the table and the place in it.
    pub(super) fn validate(&self) -> Result<()> {
        self.check_info()?;
        self.check_patterns()?;
        self.check_kinds()?;
        (0..self.kinds()).try_for_each(|kind| self.kind(kind).validate(self, kind))?;
        self.check_lanes()?;
        self.check_instances()?;
        self.acts.as_ref().map_or(Ok(()), |acts| acts.validate(self))
    }

    fn check_info(&self) -> Result<()> {
        let info = &self.info;
        let positive = |v: f32| v.is_finite() && v > 0.0;
        expect(positive(info.period_secs) && info.period_secs <= 1e6, "period_secs", || info.period_secs.to_string())?;
        expect((1..=60_000).contains(&info.slots), "slots", || info.slots.to_string())?;
        expect((1..=info.slots).contains(&info.page), "page", || info.page.to_string())?;
        let unit = info.metres_per_unit;
        expect(positive(unit) && unit < 1.0, "metres_per_unit", || unit.to_string())?;
        let limits = info.limits;
        let all = [limits.radius, limits.speed, limits.acceleration, limits.turning, limits.standing];
        expect(all.into_iter().all(positive), "limits", || format!("{all:?}"))?;
        let least = 1024;
        expect(info.repeat.is_none_or(|r| r.iter().all(|&size| size >= least)), "repeat", || {
            format!("{:?}", info.repeat)
        })
    }

    fn check_patterns(&self) -> Result<()> {
        let (ends, lengths) = (&self.pattern_ends, &self.pattern_lengths);
        expect(ends.len() == 2 * lengths.len(), "pattern_ends", || format!("{} numbers", ends.len()))?;
        rising(ends, self.crossings.len() / 4, "pattern_ends")?;
        expect(self.crossings.len().is_multiple_of(4), "crossings", || format!("{} numbers", self.crossings.len()))?;
        let period = self.info.period_secs;
        for (p, &length) in lengths.iter().enumerate() {
            expect(length.is_finite() && length > 0.0, format!("pattern_lengths {p}"), || length.to_string())?;
            let begin = if p == 0 { 0 } else { ends[2 * p - 1] as usize };
            for c in begin..ends[2 * p + 1] as usize {
                let v = &self.crossings[4 * c..4 * c + 4];
                let fits = (0.0..=length).contains(&v[0]) && (0.0..period).contains(&v[1]);
                let fast = v[2] > 0.0 && v[2].is_finite() && v[3].is_finite();
                expect(fits && fast, format!("crossings {c}"), || format!("{v:?}"))?;
            }
        }
        Ok(())
    }

    fn check_kinds(&self) -> Result<()> {
        expect(self.kinds.len().is_multiple_of(KIND), "kinds", || format!("{} numbers", self.kinds.len()))?;
        let totals = [self.edges.len(), self.walkers.len(), self.object_names.len(), self.stayer_names.len()];
        for (column, total) in totals.into_iter().enumerate() {
            let ends: Vec<u32> = self.kinds.iter().skip(1 + column).step_by(KIND).copied().collect();
            rising(&ends, total, "kinds")?;
        }
        let templates = self.info.templates.len();
        let odd = self.kinds.iter().step_by(KIND).find(|&&t| t as usize >= templates);
        expect(odd.is_none(), "kinds", || format!("a template below {templates} is expected, {odd:?}"))?;
        expect(self.corners.len() == 2 * self.edges.len(), "corners", || format!("{} numbers", self.corners.len()))?;
        let objects = self.object_names.len();
        expect(self.object_ends.len() == objects, "object_ends", || format!("{} numbers", self.object_ends.len()))?;
        expect(self.object_radii.len() == objects, "object_radii", || format!("{} numbers", self.object_radii.len()))?;
        expect(self.object_points.len().is_multiple_of(2), "object_points", || "an odd number".into())?;
        rising(&self.object_ends, self.object_points.len() / 2, "object_ends")?;
        let stayers = self.stayer_names.len();
        expect(self.stayers.len() == 4 * stayers, "stayers", || format!("{} numbers", self.stayers.len()))?;
        let names = self.info.names.len();
        let odd = self.object_names.iter().chain(&self.stayer_names).find(|&&n| n as usize >= names);
        expect(odd.is_none(), "names", || format!("a name below {names} is expected, {odd:?}"))?;
        // Where a world repeats, who looks around looks as far as the largest patch reaches.
        let odd = self.corners.iter().find(|c| c.is_nan() || c.abs() > LARGEST);
        expect(odd.is_none(), "corners", || format!("{odd:?} m from the middle of a patch"))?;
        let floats = [&self.corners, &self.object_points, &self.object_radii, &self.stayers];
        let finite = floats.iter().all(|list| list.iter().all(|v| v.is_finite() && v.abs() < 1e6));
        expect(finite, "kinds", || "a number that is no place".into())
    }

    fn check_lanes(&self) -> Result<()> {
        let expected = self.pages() * self.kinds();
        // What is derived from the tables is not much larger than they are.
        let derived = self.info.slots as usize * self.kinds();
        expect(derived <= 1_000_000 + 4 * self.rows.len(), "slots", || {
            format!("{} slots of {} kinds for so few control points", self.info.slots, self.kinds())
        })?;
        let found = self.lane_ends.len();
        expect(found == expected, "lane_ends", || format!("{found} numbers instead of {expected}"))?;
        rising(&self.lane_ends, self.lanes.len(), "lane_ends")?;
        let lanes = |page: usize| {
            let end = |p: usize| if p == 0 { 0 } else { self.lane_ends[p * self.kinds() - 1] as usize };
            if self.kinds() == 0 { 0 } else { end(page + 1) - end(page) }
        };
        let rows: usize = (0..self.pages()).map(|p| 2 * lanes(p) * (self.page_slots(p) + 3)).sum();
        let rows = rows + super::rows::WIDTH;
        let found = self.rows.len();
        expect(found == rows, "rows", || format!("{found} numbers instead of {rows}"))
    }

    fn check_instances(&self) -> Result<()> {
        let n = self.instance_kinds.len();
        let found = self.instance_places.len();
        expect(found == 2 * n, "instance_places", || format!("{found} numbers instead of {}", 2 * n))?;
        let found = self.instance_turns.len();
        expect(found == n, "instance_turns", || format!("{found} numbers instead of {n}"))?;
        let found = self.instance_phases.len();
        expect(found == n, "instance_phases", || format!("{found} numbers instead of {n}"))?;
        let odd = self.instance_kinds.iter().find(|&&k| k as usize >= self.kinds());
        expect(odd.is_none(), "instance_kinds", || format!("{odd:?}"))?;
        let odd = self.instance_phases.iter().find(|&&p| p >= self.info.slots);
        expect(odd.is_none(), "instance_phases", || format!("{odd:?}"))?;
        let odd = self.instance_turns.iter().find(|t| !(t.is_finite() && t.abs() < 100.0));
        expect(odd.is_none(), "instance_turns", || format!("{odd:?}"))?;
        let total: u64 = self.instance_kinds.iter().map(|&k| self.kind(k as usize).walkers() as u64).sum();
        let (crossings, cycles) = self.identities.parts();
        let found = crossings.len() as u64;
        expect(found == total, "crossing_cycles", || format!("{found} numbers instead of {total}"))?;
        let odd = crossings.iter().find(|c| c.cycle as usize >= cycles.len());
        expect(odd.is_none(), "crossing_cycles", || format!("{odd:?}"))?;
        let stayers: u64 = self.instance_kinds.iter().map(|&k| self.kind(k as usize).stayers().len() as u64).sum();
        expect(total.max(stayers) < u64::from(u32::MAX), "instance_kinds", || "more than 4 billion people".into())
    }
}

/// A place of the tables, metres.
#[inline(always)]
pub(super) fn in_metres([x, z]: [i32; 2]) -> DVec2 {
    DVec2::new(f64::from(x), f64::from(z)) / UNITS_PER_METRE
}

/// An error unless `ok`.
pub(super) fn expect(ok: bool, place: impl Into<String>, found: impl FnOnce() -> String) -> Result<()> {
    if ok { Ok(()) } else { Err(Error::invalid("world", place, format!("not what can be: {}", found()))) }
}

/// Ends of runs never fall, and the last is `total`.
fn rising(ends: &[u32], total: usize, place: &str) -> Result<()> {
    let falls = ends.windows(2).position(|w| w[1] < w[0]);
    expect(falls.is_none(), place, || format!("the end after number {falls:?} is before its begin"))?;
    let last = ends.last().map_or(0, |&end| end as usize);
    expect(last == total, place, || format!("runs of {last} things in all, there are {total}"))
}
