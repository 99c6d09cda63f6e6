//! What a patch kind consists of: views into the tables, and copies of the small parts.

use glam::Vec2;

use super::Tables;
use super::tables::{KIND, expect};
use crate::Result;

/// Somebody crosses a border, once per period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Distance from the begin of the edge, metres.
    pub place: f32,
    /// When, seconds, in [0, period).
    pub time: f32,
    /// Speed at right angles to the border, m/s, above zero.
    pub across: f32,
    /// Speed along the edge, m/s.
    pub along: f32,
}

/// What crosses an edge of a kind, as the kind sees it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pattern {
    /// Length of the edge, metres.
    pub length: f32,
    /// Who comes in.
    pub inputs: Vec<Crossing>,
    /// Who goes out.
    pub outputs: Vec<Crossing>,
}

/// Outline of a static object.
#[derive(Clone, Debug, PartialEq)]
pub enum ObjectShape {
    /// Middle and radius.
    Disc(Vec2, f32),
    /// Corners of a convex polygon.
    Polygon(Vec<Vec2>),
}

/// Somebody who stays inside the patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stayer {
    /// What it does: an index into the world's names.
    pub name: u32,
    /// Where it is, metres, in the kind's frame.
    pub place: Vec2,
    /// Where it looks, radians, 0 along +z.
    pub heading: f32,
    /// Radius of the disc that its motion stays in.
    pub radius: f32,
}

/// A patch kind.
#[derive(Clone, Copy, Debug)]
pub struct Kind<'a> {
    tables: &'a Tables,
    index: usize,
}

impl<'a> Kind<'a> {
    pub(super) fn new(tables: &'a Tables, index: usize) -> Self {
        Self { tables, index }
    }

    /// The run of things in one of the columns of the kind's record.
    fn run(&self, column: usize) -> std::ops::Range<usize> {
        let word = |kind: usize| self.tables.kinds[kind * KIND + 1 + column] as usize;
        let begin = if self.index == 0 { 0 } else { word(self.index - 1) };
        begin..word(self.index)
    }

    /// Which template it is of.
    pub fn template(&self) -> usize {
        self.tables.kinds[self.index * KIND] as usize
    }

    /// Corners of its outline, counter-clockwise seen with x right and z up, metres.
    pub fn outline(&self) -> Vec<Vec2> {
        self.run(0).map(|c| Vec2::from_slice(&self.tables.corners[2 * c..])).collect()
    }

    /// How far its corners are from its origin at most, metres.
    pub fn reach(&self) -> f64 {
        let far = self.run(0).map(|c| Vec2::from_slice(&self.tables.corners[2 * c..]).length());
        f64::from(far.fold(0.0, f32::max))
    }

    /// The pattern of every edge.
    pub fn patterns(&self) -> Vec<Pattern> {
        self.run(0).map(|edge| pattern(self.tables, self.tables.edges[edge])).collect()
    }

    /// How many people cross it per period.
    pub fn walkers(&self) -> usize {
        self.run(1).len()
    }

    /// Of every walker, in the order of edges and inputs: the output it leaves by, counted over all edges, and how many periods
    /// later.
    pub fn ways(&self) -> impl ExactSizeIterator<Item = (usize, u32)> + use<'a> {
        self.tables.walkers[self.run(1)].iter().map(|&w| ((w & 0xffff) as usize, w >> 16))
    }

    /// Its static objects: an index into the world's names, and an outline.
    pub fn objects(&self) -> impl ExactSizeIterator<Item = (u32, ObjectShape)> + use<'a> {
        let tables = self.tables;
        self.run(2).map(move |object| {
            let begin = if object == 0 { 0 } else { tables.object_ends[object - 1] as usize };
            let points = begin..tables.object_ends[object] as usize;
            let mut points = points.map(|p| Vec2::from_slice(&tables.object_points[2 * p..])).collect::<Vec<_>>();
            let radius = tables.object_radii[object];
            let disc = radius > 0.0 && points.len() == 1;
            let shape = if disc { ObjectShape::Disc(points.remove(0), radius) } else { ObjectShape::Polygon(points) };
            (tables.object_names[object], shape)
        })
    }

    /// Who stays inside.
    pub fn stayers(&self) -> impl ExactSizeIterator<Item = Stayer> + use<'a> {
        let tables = self.tables;
        self.run(3).map(move |s| {
            let v = &tables.stayers[4 * s..4 * s + 4];
            let (heading, radius) = (v[2], v[3]);
            Stayer { name: tables.stayer_names[s], place: Vec2::new(v[0], v[1]), heading, radius }
        })
    }

    /// Number of walkers of the kinds before.
    pub(crate) fn first_walker(&self) -> usize {
        self.run(1).start
    }

    /// Number of those who stay in the kinds before.
    pub(super) fn first_stayer(&self) -> usize {
        self.run(3).start
    }

    /// When every walker comes in and goes out, seconds after the begin of the period it comes in.
    pub fn presences(&self, period: f32) -> Vec<(f64, f64)> {
        let patterns = self.patterns();
        let times = |of: &dyn Fn(&Pattern) -> Vec<Crossing>| -> Vec<f64> {
            patterns.iter().flat_map(of).map(|c| f64::from(c.time)).collect()
        };
        let inputs = times(&|p| p.inputs.clone());
        let outputs = times(&|p| p.outputs.clone());
        let ways = self.ways().zip(inputs);
        ways.map(|((output, laps), enter)| (enter, outputs[output] + f64::from(laps) * f64::from(period))).collect()
    }

    /// Whether its numbers fit each other.
    pub(super) fn validate(&self, tables: &Tables, index: usize) -> Result<()> {
        let place = || format!("kind {index}");
        let corners = self.run(0).len();
        expect(corners == 0 || corners >= 3, place(), || format!("{corners} corners"))?;
        let patterns = tables.pattern_lengths.len();
        for edge in self.run(0) {
            let pattern = tables.edges[edge];
            let own = if pattern < 0 { -1 - i64::from(pattern) } else { i64::from(pattern) };
            expect((own as usize) < patterns, place(), || format!("pattern {pattern} of {patterns}"))?;
        }
        let (inputs, outputs) = self.ports();
        let walkers = self.walkers();
        expect(walkers == inputs && walkers == outputs && walkers < 0x1_0000, place(), || {
            format!("{inputs} inputs, {outputs} outputs and {walkers} walkers")
        })?;
        let odd = self.ways().find(|&(output, laps)| output >= outputs || laps > 0x7fff);
        expect(odd.is_none(), place(), || format!("a walker with output and periods {odd:?}"))
    }

    /// Numbers of inputs and outputs, without copying patterns.
    fn ports(&self) -> (usize, usize) {
        let count = |edge: usize| {
            let pattern = self.tables.edges[edge];
            let (index, mirrored) = if pattern < 0 { (!pattern as usize, true) } else { (pattern as usize, false) };
            let ends = &self.tables.pattern_ends;
            let begin = if index == 0 { 0 } else { ends[2 * index - 1] };
            let counts = ((ends[2 * index] - begin) as usize, (ends[2 * index + 1] - ends[2 * index]) as usize);
            if mirrored { (counts.1, counts.0) } else { counts }
        };
        self.run(0).map(count).fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1))
    }
}

/// A pattern, or the mirror image of one.
fn pattern(tables: &Tables, edge: i32) -> Pattern {
    let (index, mirrored) = if edge < 0 { (!edge as usize, true) } else { (edge as usize, false) };
    let ends = &tables.pattern_ends;
    let begin = if index == 0 { 0 } else { ends[2 * index - 1] as usize };
    let (middle, end) = (ends[2 * index] as usize, ends[2 * index + 1] as usize);
    let length = tables.pattern_lengths[index];
    let read = |range: std::ops::Range<usize>| {
        let each = range.map(|c| {
            let v = &tables.crossings[4 * c..4 * c + 4];
            let (place, along) = if mirrored { (length - v[0], -v[3]) } else { (v[0], v[3]) };
            Crossing { place, time: v[1], across: v[2], along }
        });
        each.collect()
    };
    let (inputs, outputs) = (read(begin..middle), read(middle..end));
    if mirrored { Pattern { length, inputs: outputs, outputs: inputs } } else { Pattern { length, inputs, outputs } }
}
