//! The dangling ports by side, pose group, place and time, so that those near a new port are found without a search.

use glam::Vec2;

use super::super::bridge::Port;
use super::super::domain::Domain;
use crate::geom::wrap_angle;

/// Index of a port: twice its piece's, plus its side.
pub(super) type PortId = u32;
/// The side at which a fragment begins.
pub(super) const ENTRY: u32 = 0;
/// The side at which it ends.
pub(super) const EXIT: u32 = 1;
/// No port.
pub(super) const NONE: PortId = PortId::MAX;

/// Cell size in metres and ticks: twice the usual thresholds, so that a box lies in at most two cells each way.
const CELL: f32 = 1.2;
const CELL_TICKS: i32 = 18;

/// How far two ports may be apart to be stitched, or how far a patch is jittered (section 5.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reach {
    /// Metres.
    pub place: f32,
    /// Radians.
    pub heading: f32,
    /// Ticks.
    pub ticks: f32,
}

impl Reach {
    /// 0.6 m, 15 degrees, 0.3 s.
    pub const FIRST: Self = Self { place: 0.6, heading: 15.0 * DEG, ticks: 9.0 };
    /// 1.0 m, 25 degrees, 0.5 s.
    pub const LAST: Self = Self { place: 1.0, heading: 25.0 * DEG, ticks: 15.0 };

    /// From the first (0) to the last (1).
    pub fn grown(t: f32) -> Self {
        let mix = |a: f32, b: f32| a + (b - a) * t;
        Self {
            place: mix(Self::FIRST.place, Self::LAST.place),
            heading: mix(Self::FIRST.heading, Self::LAST.heading),
            ticks: mix(Self::FIRST.ticks, Self::LAST.ticks),
        }
    }

    /// Squared distance of two ports in units of the reach, `None` if they are out of reach.
    pub fn distance(&self, a: &Port, b: &Port) -> Option<f32> {
        let place = a.at.position.distance_squared(b.at.position) / (self.place * self.place);
        let heading = wrap_angle(a.at.heading - b.at.heading) / self.heading;
        let ticks = (a.tick - b.tick) as f32 / self.ticks;
        (place <= 1.0 && heading.abs() <= 1.0 && ticks.abs() <= 1.0)
            .then_some(place + heading * heading + ticks * ticks)
    }
}

const DEG: f32 = std::f32::consts::PI / 180.0;

/// The table: per cell the first port of a linked list.
pub(super) struct Ports {
    heads: Vec<PortId>,
    next: Vec<PortId>,
    count: usize,
    origin: Vec2,
    columns: i32,
    rows: i32,
    layers: i32,
    groups: u32,
}

impl Ports {
    /// An empty one.
    pub fn new(domain: &Domain, groups: usize) -> Self {
        let cells = ((domain.max - domain.min) / CELL).ceil();
        let (columns, rows) = (cells.x as i32 + 1, cells.y as i32 + 1);
        let layers = domain.horizon / CELL_TICKS + 1;
        let size = 2 * groups * (columns * rows) as usize * layers as usize;
        let heads = vec![NONE; size];
        Self { heads, next: vec![], count: 0, origin: domain.min, columns, rows, layers, groups: groups as u32 }
    }

    /// Number of danglings.
    pub fn len(&self) -> usize {
        self.count
    }

    /// All danglings, cell by cell.
    pub fn iter(&self) -> impl Iterator<Item = PortId> {
        self.heads.iter().flat_map(|&head| self.list(head))
    }

    fn list(&self, head: PortId) -> impl Iterator<Item = PortId> {
        std::iter::successors((head != NONE).then_some(head), |&id| {
            let next = self.next[id as usize];
            (next != NONE).then_some(next)
        })
    }

    /// Takes a dangling port in.
    pub fn insert(&mut self, id: PortId, port: &Port) {
        if self.next.len() <= id as usize {
            self.next.resize(id as usize + 1, NONE);
        }
        let cell = self.cell_of(id % 2, port);
        self.next[id as usize] = std::mem::replace(&mut self.heads[cell], id);
        self.count += 1;
    }

    /// Takes a dangling port out.
    pub fn remove(&mut self, id: PortId, port: &Port) {
        let cell = self.cell_of(id % 2, port);
        let after = self.next[id as usize];
        let before = self.list(self.heads[cell]).take_while(|&p| p != id).last();
        match before {
            Some(before) => self.next[before as usize] = after,
            None => self.heads[cell] = after,
        }
        self.count -= 1;
    }

    /// Calls `found` with each dangling on `side` of `port`'s group in the cells within reach.
    pub fn near(&self, side: u32, port: &Port, reach: &Reach, mut found: impl FnMut(PortId)) {
        let low = ((port.at.position - reach.place - self.origin) / CELL).floor().max(Vec2::ZERO);
        let high = ((port.at.position + reach.place - self.origin) / CELL).floor();
        let ticks = reach.ticks as i32;
        let layers = (port.tick - ticks).max(0) / CELL_TICKS..=((port.tick + ticks) / CELL_TICKS).min(self.layers - 1);
        for layer in layers {
            for z in low.y as i32..=(high.y as i32).min(self.rows - 1) {
                for x in low.x as i32..=(high.x as i32).min(self.columns - 1) {
                    self.list(self.heads[self.cell(side, port.group, layer, z, x)]).for_each(&mut found);
                }
            }
        }
    }

    fn cell(&self, side: u32, group: u32, layer: i32, z: i32, x: i32) -> usize {
        let slab = (side * self.groups + group) as usize * self.layers as usize + layer as usize;
        (slab * self.rows as usize + z as usize) * self.columns as usize + x as usize
    }

    fn cell_of(&self, side: u32, port: &Port) -> usize {
        let c = ((port.at.position - self.origin) / CELL).floor();
        let (x, z) = ((c.x as i32).clamp(0, self.columns - 1), (c.y as i32).clamp(0, self.rows - 1));
        self.cell(side, port.group, port.tick / CELL_TICKS, z, x)
    }
}
