//! Frame-patches: all that is given before walkers are led through a patch ("Crowd Sculpting", section 4.1).

use glam::{DVec2, Vec2};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::shape::Obstacle;
use super::spacing;
use super::valid::check_outline;
use super::{Limits, Pattern, PatternType, Port, Role, Shape};
use crate::Result;

/// Something that never moves.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StaticObject {
    /// What it is: picks its looks.
    pub name: String,
    /// Its outline.
    pub shape: Shape,
}

/// An endogenous person: stays inside the patch.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Standing {
    /// What it does: picks its motion.
    pub name: String,
    /// Where it is, metres.
    pub position: Vec2,
    /// Where it looks, radians about the vertical, 0 along +z.
    pub heading: f32,
    /// Radius of the disc that its motion stays in, metres.
    pub radius: f32,
    /// Its motion, if it is known.
    #[serde(default)]
    pub role: Option<Role>,
}

/// Outline, patterns and objects of a patch.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FramePatch {
    /// Corners of a convex polygon, counter-clockwise seen with x right and z up, metres.
    pub outline: Vec<Vec2>,
    /// The pattern of every edge; edge i goes from corner i to the next.
    pub patterns: Vec<Pattern>,
    /// Static objects.
    #[serde(default)]
    pub objects: Vec<StaticObject>,
    /// Endogenous people.
    #[serde(default)]
    pub people: Vec<Standing>,
}

/// An edge of the outline as a frame of reference for crossings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Border {
    /// The corner it begins at.
    pub begin: DVec2,
    /// Unit vector along it.
    pub along: DVec2,
    /// Unit vector into the patch.
    pub inward: DVec2,
    /// Its length, metres.
    pub length: f64,
}

/// A crossing in the patch's frame: the walker's line while its body touches the border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    /// Which edge.
    pub edge: usize,
    /// Where on the ground.
    pub place: DVec2,
    /// Velocity, m/s.
    pub velocity: DVec2,
    /// When, seconds.
    pub time: f64,
    /// How long before and after the body touches the border, seconds.
    pub reach: f64,
}

impl Line {
    /// Place on the line at `time`.
    pub fn at(&self, time: f64) -> DVec2 {
        self.place + self.velocity * (time - self.time)
    }

    /// The same crossing `secs` later.
    pub fn later(self, secs: f64) -> Self {
        Self { time: self.time + secs, ..self }
    }
}

impl FramePatch {
    /// A square with corner (0, 0) and random patterns of the given types, without objects.
    ///
    /// # Errors
    /// If a pattern cannot be made ([`PatternType::generate`]) or the patch is not balanced.
    pub fn random_square(side: f32, period: f32, types: &[PatternType; 4], seed: u64) -> Result<Self> {
        let corners = [(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)];
        Self::random(corners.map(|(x, z)| Vec2::new(x, z)).to_vec(), period, types, &Limits::default(), seed)
    }

    /// A patch with random patterns of the given types, one per edge, without objects.
    ///
    /// # Errors
    /// If the outline is not convex, a pattern cannot be made, or the patch is not balanced.
    pub fn random(outline: Vec<Vec2>, period: f32, types: &[PatternType], limits: &Limits, seed: u64) -> Result<Self> {
        check_outline(&outline, types.len())?;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let n = outline.len();
        let length = |edge: usize| outline[edge].distance(outline[(edge + 1) % n]);
        let side = |edge: usize| outline[(edge + 1) % n] - outline[edge % n];
        let angle = |corner: usize| std::f32::consts::PI - side(corner + n - 1).angle_to(side(corner));
        let ends = |edge: usize| (spacing::corner_room(angle(edge)), spacing::corner_room(angle(edge + 1)));
        let patterns = types
            .iter()
            .enumerate()
            .map(|(edge, kind)| kind.generate_between(ends(edge), length(edge), period, limits, &mut rng))
            .collect::<Result<Vec<_>>>()?;
        super::pattern::balanced(&patterns)?;
        Ok(Self { outline, patterns, objects: Vec::new(), people: Vec::new() })
    }

    /// Period of its patterns in seconds.
    pub fn period(&self) -> f32 {
        self.patterns[0].period
    }

    /// The border along edge `edge`.
    pub fn border(&self, edge: usize) -> Border {
        let begin = self.outline[edge].as_dvec2();
        let side = self.outline[(edge + 1) % self.outline.len()].as_dvec2() - begin;
        let along = side.normalize();
        Border { begin, along, inward: along.perp(), length: side.length() }
    }

    /// All inputs, edge by edge.
    pub fn inputs(&self) -> impl Iterator<Item = Port> {
        self.patterns
            .iter()
            .enumerate()
            .flat_map(|(edge, p)| (0..p.inputs.len()).map(move |index| Port { edge, index }))
    }

    /// All outputs, edge by edge.
    pub fn outputs(&self) -> impl Iterator<Item = Port> {
        self.patterns
            .iter()
            .enumerate()
            .flat_map(|(edge, p)| (0..p.outputs.len()).map(move |index| Port { edge, index }))
    }

    /// The line of an input (`inward`) or output.
    pub(super) fn line(&self, port: Port, inward: bool, limits: &Limits) -> Line {
        let pattern = &self.patterns[port.edge];
        let crossing = if inward { pattern.inputs[port.index] } else { pattern.outputs[port.index] };
        let border = self.border(port.edge);
        let across = f64::from(crossing.across);
        let sign = if inward { 1.0 } else { -1.0 };
        Line {
            edge: port.edge,
            place: border.begin + border.along * f64::from(crossing.place),
            velocity: border.along * f64::from(crossing.along) + border.inward * (sign * across),
            time: f64::from(crossing.time),
            reach: f64::from(spacing::least_depth(limits)) / across,
        }
    }

    /// Objects and people as what a walker's centre stays out of.
    pub(super) fn obstacles(&self, limits: &Limits) -> Vec<Obstacle> {
        let radius = f64::from(limits.radius);
        let people = self.people.iter().map(|p| Shape::disc(p.position, p.radius));
        let people = people.map(|shape| Obstacle::new(&shape, radius));
        self.objects.iter().map(|o| Obstacle::new(&o.shape, radius)).chain(people).collect()
    }
}
