//! Bakes solved patches into an immutable world: curves into 16-bit rows, connections into identities.

use std::collections::BTreeMap;

use glam::{DVec2, Vec2};

use super::rich::moved;
use super::{CrowdPatch, Identities, Lattice, Limits, Pattern, Plan, Role, Shape, Standing, Template, Walker};
use crate::stage::World;
use crate::stage::world::{
    Lane, NO_ACT, Tables, TemplateInfo, UNITS_PER_METRE, WalkLimits, WorldInfo, feet_with_body, stay_slots,
};
use crate::{Error, Result};

/// Slots of a page: fewer cost memory for control points around their ends, more for lanes that are not there all the time.
const PAGES: [u32; 5] = [10, 8, 5, 2, 1];

/// A patch in a world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Which of the kinds.
    pub kind: usize,
    /// Where the origin of its frame is, metres; rounded to 1/1024 m.
    pub origin: DVec2,
    /// How it is turned about the vertical, radians.
    pub turn: f32,
}

/// Bakes `kinds` (each with the index of its template) at their `placements`. `identities` has the crossings of all placements, one
/// for each walker, in order. Of `info`, what follows from the patches is filled in here.
///
/// # Errors
/// If kinds differ in period or step, are too large to be stored to a millimetre, or a name or a template is missing.
pub fn bake(
    info: WorldInfo,
    kinds: &[(&CrowdPatch, u32)],
    placements: &[Placement],
    identities: Identities,
) -> Result<World> {
    let mut bakery = Bakery::new(info, kinds, placements, identities)?;
    for (index, (patch, template)) in kinds.iter().enumerate() {
        bakery.add_kind(index, patch, *template)?;
    }
    bakery.add_pages(kinds);
    bakery.end_acts();
    bakery.end_rows();
    bakery.add_instances(placements)?;
    World::new(bakery.tables)
}

impl Plan {
    /// The plan's world, ready to be played and written to a file.
    ///
    /// # Errors
    /// If it is too large for its numbers ([`bake`]).
    pub fn bake(&self, name: &str, lattice: &Lattice) -> Result<World> {
        let (columns, rows) = self.size();
        let side = f64::from(self.side);
        let units = |cells: usize| (cells as f64 * side * UNITS_PER_METRE).round() as i32;
        let ground = |t: &Template| TemplateInfo { name: t.name.clone(), ground: t.ground.clone() };
        let info = WorldInfo {
            name: name.into(),
            seed: self.seed,
            limits: WalkLimits::from(&Limits::default()),
            templates: self.templates.iter().map(ground).collect(),
            repeat: self.endless.then(|| [units(columns), units(rows)]),
            ..WorldInfo::default()
        };
        let cells = || lattice.cells().iter().enumerate();
        let mut templates = vec![0; lattice.kinds().len()];
        cells().for_each(|(cell, &kind)| templates[kind] = self.cells[cell / columns][cell % columns] as u32);
        let kinds: Vec<(&CrowdPatch, u32)> = lattice.kinds().iter().zip(templates).collect();
        let place = |cell: usize| DVec2::new((cell % columns) as f64, (cell / columns) as f64) * side;
        let placements: Vec<Placement> =
            cells().map(|(cell, &kind)| Placement { kind, origin: place(cell), turn: 0.0 }).collect();
        bake(info, &kinds, &placements, lattice.identities().clone())
    }
}

impl From<&Limits> for WalkLimits {
    fn from(limits: &Limits) -> Self {
        let Limits { radius, speed, acceleration, turning, standing } = *limits;
        Self { radius, speed, acceleration, turning, standing }
    }
}

struct Bakery {
    tables: Tables,
    /// Index of every pattern by its bytes.
    patterns: BTreeMap<Vec<u8>, i32>,
    names: BTreeMap<String, u32>,
    /// Index of every clip by where it is in memory: tableaux share theirs.
    acts: BTreeMap<Vec<u32>, u32>,
    /// Middle of every kind: the origin of its frame in the world.
    middles: Vec<DVec2>,
}

impl Bakery {
    fn new(
        mut info: WorldInfo,
        kinds: &[(&CrowdPatch, u32)],
        placements: &[Placement],
        identities: Identities,
    ) -> Result<Self> {
        let middles: Vec<DVec2> = kinds.iter().map(|(patch, _)| middle(patch)).collect();
        let walking = kinds.iter().find(|(patch, _)| !patch.walkers.is_empty());
        let step = walking.map_or(0.2, |(patch, _)| patch.walkers[0].path.step);
        info.period_secs = kinds.first().map_or(10.0, |(patch, _)| patch.frame.period());
        info.slots = (info.period_secs / step).round().max(1.0) as u32;
        info.metres_per_unit = unit(kinds, &middles)?;
        info.page = page(kinds, info.slots, info.period_secs);
        if let Some(bad) = placements.iter().position(|p| p.kind >= kinds.len()) {
            let problem = format!("expected a kind below {}, found {}", kinds.len(), placements[bad].kind);
            return Err(Error::invalid("world", format!("patch {bad}"), problem));
        }
        let tables = Tables { info, identities, ..Tables::default() };
        Ok(Self { tables, patterns: BTreeMap::new(), names: BTreeMap::new(), acts: BTreeMap::new(), middles })
    }

    fn add_kind(&mut self, index: usize, patch: &CrowdPatch, template: u32) -> Result<()> {
        let place = || format!("kind {index}");
        let info = &self.tables.info;
        let step = info.period_secs / info.slots as f32;
        let fits = patch.walkers.iter().all(|w| (w.path.step - step).abs() < 1e-6);
        if patch.frame.period() != info.period_secs || !fits {
            let problem = format!("expected a period of {} s in {} slots", info.period_secs, info.slots);
            return Err(Error::invalid("world", place(), problem));
        }
        let origin = self.middles[index].as_vec2();
        let frame = &patch.frame;
        self.tables.corners.extend(frame.outline.iter().flat_map(|&p| (p - origin).to_array()));
        for pattern in &frame.patterns {
            let edge = self.pattern(pattern);
            self.tables.edges.push(edge);
        }
        let outputs: Vec<_> = frame.outputs().collect();
        for walker in &patch.walkers {
            let output = outputs.iter().position(|&port| port == walker.output).unwrap_or(usize::MAX);
            if output > 0xffff || walker.laps > 0x7fff {
                return Err(Error::invalid("world", place(), "expected at most 65535 walkers"));
            }
            self.tables.walkers.push(output as u32 | walker.laps << 16);
            self.add_visit(patch, walker, self.middles[index]);
        }
        for object in &frame.objects {
            self.add_object(&object.name, &object.shape, origin);
        }
        for person in &frame.people {
            let name = self.name(&person.name);
            let at = person.position - origin;
            self.tables.stayer_names.push(name);
            self.tables.stayers.extend([at.x, at.y, person.heading, person.radius]);
            self.add_role(person);
        }
        let t = &mut self.tables;
        let ends = [t.edges.len(), t.walkers.len(), t.object_names.len(), t.stayer_names.len()].map(|n| n as u32);
        t.kinds.push(template);
        t.kinds.extend(ends);
        Ok(())
    }

    fn add_object(&mut self, name: &str, shape: &Shape, origin: Vec2) {
        let name = self.name(name);
        let t = &mut self.tables;
        let (points, radius) = match shape {
            Shape::Disc { centre, radius } => (std::slice::from_ref(centre), *radius),
            Shape::Convex(polygon) => (polygon.points.as_slice(), 0.0),
        };
        t.object_names.push(name);
        t.object_points.extend(points.iter().flat_map(|&p| (p - origin).to_array()));
        t.object_ends.push((t.object_points.len() / 2) as u32);
        t.object_radii.push(radius);
    }

    /// What somebody does who comes in and goes out.
    fn add_visit(&mut self, patch: &CrowdPatch, walker: &Walker, middle: DVec2) {
        if walker.role.is_none() && self.tables.acts.is_none() {
            return;
        }
        let everybody = self.tables.walkers.len();
        let acts = self.tables.acts.get_or_insert_default();
        acts.walkers.resize(everybody - 1, NO_ACT);
        acts.walker_times.resize(3 * (everybody - 1), 0.0);
        acts.walker_feet.resize(8 * (everybody - 1), 0.0);
        let act = walker.role.as_ref().map_or(NO_ACT, |role| acts.add(&moved(&role.act, -middle)));
        let (enter, leave) = patch.presence(walker);
        acts.walkers.push(act);
        let begin = walker.role.as_ref().map_or(0.0, |role| -role.lead);
        acts.walker_times.extend([begin, enter as f32, leave as f32]);
        acts.walker_feet.extend(feet_with_body(enter as f32, leave as f32));
    }

    /// What somebody does who stays.
    fn add_role(&mut self, person: &Standing) {
        if person.role.is_none() && self.tables.acts.is_none() {
            return;
        }
        let everybody = self.tables.stayer_names.len();
        let acts = self.tables.acts.get_or_insert_default();
        // Those before had none.
        acts.stayers.resize(everybody - 1, NO_ACT);
        acts.stayer_leads.resize(everybody - 1, 0.0);
        let known = &mut self.acts;
        let index = |role: &Role| *known.entry(role.act.bits()).or_insert_with(|| acts.add(&role.act));
        let act = person.role.as_ref().map_or(NO_ACT, index);
        acts.stayers.push(act);
        acts.stayer_leads.push(person.role.as_ref().map_or(0.0, |role| role.lead));
    }

    fn name(&mut self, name: &str) -> u32 {
        if let Some(&index) = self.names.get(name) {
            return index;
        }
        let index = self.tables.info.names.len() as u32;
        self.tables.info.names.push(name.into());
        self.names.insert(name.into(), index);
        index
    }

    /// Index of a pattern: one that is there already, the mirror image of one, or a new one.
    fn pattern(&mut self, pattern: &Pattern) -> i32 {
        if let Some(&index) = self.patterns.get(&key(pattern)) {
            return index;
        }
        if let Some(&index) = self.patterns.get(&key(&pattern.mirror())) {
            return !index;
        }
        let t = &mut self.tables;
        let index = t.pattern_lengths.len() as i32;
        t.pattern_lengths.push(pattern.length);
        for crossings in [&pattern.inputs, &pattern.outputs] {
            t.crossings.extend(crossings.iter().flat_map(|c| [c.place, c.time, c.across, c.along]));
            t.pattern_ends.push((t.crossings.len() / 4) as u32);
        }
        self.patterns.insert(key(pattern), index);
        index
    }

    fn add_pages(&mut self, kinds: &[(&CrowdPatch, u32)]) {
        let all: Vec<Vec<Stay>> = kinds.iter().map(|(patch, _)| self.stays(patch)).collect();
        for page in 0..self.tables.pages() {
            let begin = (page as u32 * self.tables.info.page) as i64;
            let slots = self.tables.page_slots(page);
            let lanes: Vec<Vec<Lane>> =
                all.iter().map(|stays| lanes(stays, begin, slots as i64, self.tables.info.slots.into())).collect();
            for kind in &lanes {
                self.tables.lanes.extend(kind.iter().map(|lane| lane.0));
                self.tables.lane_ends.push(self.tables.lanes.len() as u32);
            }
            for row in 0..slots as i64 + 3 {
                for (index, (patch, _)) in kinds.iter().enumerate() {
                    for axis in 0..2 {
                        for lane in &lanes[index] {
                            let knot = begin + row - 1 + lane.lap() * i64::from(self.tables.info.slots);
                            let value = self.control(patch, lane.walker(), knot, index)[axis];
                            self.tables.rows.push(value);
                        }
                    }
                }
            }
        }
    }

    /// Those after the last who does something have nothing to do.
    fn end_acts(&mut self) {
        let (stayers, walkers) = (self.tables.stayer_names.len(), self.tables.walkers.len());
        if let Some(acts) = &mut self.tables.acts {
            acts.stayers.resize(stayers, NO_ACT);
            acts.stayer_leads.resize(stayers, 0.0);
            acts.walkers.resize(walkers, NO_ACT);
            acts.walker_times.resize(3 * walkers, 0.0);
        }
    }

    /// Ends the rows with as many zeros as are read at a time.
    fn end_rows(&mut self) {
        self.tables.rows.extend([0; 8]);
    }

    /// Control point number `knot` of the common clock; where a way has none, its nearest.
    fn control(&self, patch: &CrowdPatch, walker: usize, knot: i64, kind: usize) -> [i16; 2] {
        let path = &patch.walkers[walker].path;
        let index = (knot - i64::from(path.first)).clamp(0, path.points.len() as i64 - 1);
        let place = path.points[index as usize].as_dvec2() - self.middles[kind];
        (place / f64::from(self.tables.info.metres_per_unit)).round().to_array().map(|v| v as i16)
    }

    fn stays(&self, patch: &CrowdPatch) -> Vec<Stay> {
        let per_sec = f64::from(self.tables.info.slots) / f64::from(self.tables.info.period_secs);
        patch.walkers.iter().map(|w| stay_slots(patch.presence(w), per_sec)).collect()
    }

    fn add_instances(&mut self, placements: &[Placement]) -> Result<()> {
        for (index, placement) in placements.iter().enumerate() {
            let turn = Vec2::from_angle(placement.turn).as_dvec2();
            let at = (placement.origin + turn.rotate(self.middles[placement.kind])) * UNITS_PER_METRE;
            if !(at.is_finite() && at.abs().max_element() < f64::from(i32::MAX)) {
                let problem = format!("expected a place within 2000 km, found {}", placement.origin);
                return Err(Error::invalid("world", format!("patch {index}"), problem));
            }
            let t = &mut self.tables;
            t.instance_kinds.push(placement.kind as u32);
            t.instance_places.extend(at.round().to_array().map(|v| v as i32));
            t.instance_turns.push(placement.turn);
            t.instance_phases.push(0);
        }
        Ok(())
    }
}

/// First slot of a stay and the slot after the last, counted from the period it begins in.
type Stay = (i64, i64);

/// The middle of an outline, in whole units.
fn middle(patch: &CrowdPatch) -> DVec2 {
    let corners = &patch.frame.outline;
    let least = corners.iter().copied().fold(Vec2::INFINITY, Vec2::min).as_dvec2();
    let most = corners.iter().copied().fold(Vec2::NEG_INFINITY, Vec2::max).as_dvec2();
    (0.5 * (least + most) * UNITS_PER_METRE).round() / UNITS_PER_METRE
}

/// The length that control points are whole numbers of.
fn unit(kinds: &[(&CrowdPatch, u32)], middles: &[DVec2]) -> Result<f32> {
    let far = |(patch, _): &(&CrowdPatch, u32), middle: &DVec2| {
        let points = patch.walkers.iter().flat_map(|w| &w.path.points);
        points.map(|p| (p.as_dvec2() - *middle).abs().max_element()).fold(0.0, f64::max)
    };
    let (kind, most) = kinds
        .iter()
        .zip(middles)
        .map(|(kind, middle)| far(kind, middle))
        .enumerate()
        .fold((0, 1.0), |best, (kind, far)| if far > best.1 { (kind, far) } else { best });
    // Two patches are off by half a unit each.
    if most > 25.0 {
        let problem =
            format!("expected patches of at most 50 m, so that a millimetre counts; found {:.1} m", 2.0 * most);
        return Err(Error::invalid("world", format!("kind {kind}"), problem));
    }
    Ok((most / f64::from(i16::MAX)) as f32)
}

/// The largest page that nobody comes in and leaves again in.
fn page(kinds: &[(&CrowdPatch, u32)], slots: u32, period: f32) -> u32 {
    let per_sec = f64::from(slots) / f64::from(period);
    let stays =
        kinds.iter().flat_map(|(patch, _)| patch.walkers.iter().map(|w| stay_slots(patch.presence(w), per_sec)));
    let shortest = stays.map(|(enter, leave)| leave - enter).min().unwrap_or(i64::MAX);
    PAGES.into_iter().find(|&page| i64::from(page) <= shortest).unwrap_or(1).min(slots)
}

/// Everybody present during a page, so ordered that those present in any of its slots are neighbours.
fn lanes(stays: &[Stay], begin: i64, slots: i64, period: i64) -> Vec<Lane> {
    let mut found: Vec<(i64, i64, Lane)> = Vec::new();
    for (walker, &(enter, leave)) in stays.iter().enumerate() {
        // Periods ago that it came in, so that it is present in the page.
        let first = (enter - begin - slots).div_euclid(period) + 1;
        let last = (leave - 1 - begin).div_euclid(period);
        for lap in first.max(0)..=last {
            let own = begin + lap * period;
            let (from, to) = ((enter - own).max(0), (leave - own).min(slots));
            found.push((from, to, Lane(walker as u32 | (lap as u32) << 16)));
        }
    }
    found.sort_by_key(|&(from, to, lane)| (from, if from == 0 { to } else { 0 }, lane.0));
    found.into_iter().map(|(_, _, lane)| lane).collect()
}

fn key(pattern: &Pattern) -> Vec<u8> {
    let numbers = |crossings: &[super::Crossing]| -> Vec<f32> {
        // The mirror image of a mirror image is off by a rounding.
        crossings.iter().flat_map(|c| [c.place, c.time, c.across, c.along].map(|v| (v * 1e4).round())).collect()
    };
    let (inputs, outputs) = (numbers(&pattern.inputs), numbers(&pattern.outputs));
    let all = [pattern.length, inputs.len() as f32].into_iter().chain(inputs).chain(outputs);
    all.flat_map(f32::to_le_bytes).collect()
}
