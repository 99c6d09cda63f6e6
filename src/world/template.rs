//! Templates: what patches of a kind contain, and who crosses their borders.
//!
//! "Crowd Patches" (2009), section 5.2: a template groups patches that meet a set of constraints on their objects and
//! patterns. Objects are counted or by density; patterns depend on which template is on the other side.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Vec2;
use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;

use super::{FramePatch, Limits, Meeting, PatternType, Shape, Standing, Tableau};

/// How many of something.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Amount {
    /// From the first to the second number in a patch.
    Number(usize, usize),
    /// Per square metre of the patch.
    Density(f32),
}

/// More of one thing in a patch is a mistake.
const MOST: usize = 500;
/// People who gather in one group, at most.
const LARGEST_GROUP: usize = 12;

impl Amount {
    fn problem(self) -> Option<String> {
        match self {
            Self::Number(least, most) if least > most || most > MOST => {
                Some(format!("expected a range of numbers up to {MOST}, found {least} to {most}"))
            }
            Self::Density(density) if !(0.0..=10.0).contains(&density) => {
                Some(format!("expected a density from 0 to 10 per square metre, found {density}"))
            }
            _ => None,
        }
    }

    fn draw(self, area: f32, rng: &mut ChaCha8Rng) -> usize {
        match self {
            Self::Number(least, most) => rng.random_range(least..=most.max(least)),
            Self::Density(density) => {
                let wanted = (density * area).max(0.0);
                // What is left over after whole ones is the chance of one more.
                (wanted as usize + usize::from(rng.random::<f32>() < wanted.fract())).min(MOST)
            }
        }
    }
}

/// Outline of an object before it has a place.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Prototype {
    /// A disc of this radius, metres.
    Disc(f32),
    /// A box of these full extents, metres.
    Oblong(f32, f32),
}

impl Prototype {
    fn at(self, place: Vec2, angle: f32) -> Shape {
        match self {
            Self::Disc(radius) => Shape::disc(place, radius),
            Self::Oblong(x, z) => Shape::oblong(place, Vec2::new(x, z), angle),
        }
    }
}

/// Static objects of one kind.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Furnishing {
    /// What it is: picks its looks.
    pub name: String,
    /// Its outline.
    pub outline: Prototype,
    /// How many.
    pub amount: Amount,
}

/// Endogenous people who do something together, or alone.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gathering {
    /// What they do: picks their motion.
    pub name: String,
    /// From how many to how many people; those of a group look at each other.
    pub size: (usize, usize),
    /// Radius of the disc everyone stays in, metres.
    pub radius: f32,
    /// How many such groups.
    pub amount: Amount,
    /// What they do, if that is known; else nobody moves.
    #[serde(default)]
    pub tableaux: Arc<Vec<Tableau>>,
}

/// What patches of a kind contain.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Template {
    /// Its name.
    pub name: String,
    /// What the ground looks like.
    #[serde(default)]
    pub ground: String,
    /// Static objects.
    #[serde(default)]
    pub furnishings: Vec<Furnishing>,
    /// Endogenous people.
    #[serde(default)]
    pub gatherings: Vec<Gathering>,
    /// What people do who come in and meet, if they do.
    #[serde(default)]
    pub meeting: Option<Meeting>,
    /// Pattern type of the border to a patch of another (or the same) template, by its name, seen from this side. Where
    /// both templates name each other the one that comes first counts; where neither does nobody crosses.
    #[serde(default)]
    pub borders: BTreeMap<String, PatternType>,
}

impl Template {
    /// A template without anything.
    pub fn new(name: &str, ground: &str) -> Self {
        Self {
            name: name.into(),
            ground: ground.into(),
            furnishings: Vec::new(),
            gatherings: Vec::new(),
            meeting: None,
            borders: BTreeMap::new(),
        }
    }

    /// With objects.
    pub fn furnished(mut self, name: &str, outline: Prototype, amount: Amount) -> Self {
        self.furnishings.push(Furnishing { name: name.into(), outline, amount });
        self
    }

    /// With groups of people.
    pub fn gathered(mut self, name: &str, size: (usize, usize), amount: Amount) -> Self {
        self.gatherings.push(Gathering { name: name.into(), size, radius: 0.3, amount, tableaux: Arc::default() });
        self
    }

    /// With a border to `other`.
    pub fn bordered(mut self, other: &str, kind: PatternType) -> Self {
        self.borders.insert(other.into(), kind);
        self
    }

    /// All that is wrong with it, each with its place; empty if nothing is.
    pub fn problems(&self) -> Vec<String> {
        let mut found = Vec::new();
        for furnishing in &self.furnishings {
            let problem = furnishing.amount.problem().or_else(|| furnishing.outline.at(Vec2::ZERO, 0.0).problem());
            found.extend(problem.map(|problem| format!("furnishing {:?}: {problem}", furnishing.name)));
        }
        for gathering in &self.gatherings {
            let problem = gathering.amount.problem().or_else(|| gathering.problem());
            found.extend(problem.map(|problem| format!("gathering {:?}: {problem}", gathering.name)));
        }
        if self.meeting.is_some() && !(self.furnishings.is_empty() && self.gatherings.is_empty()) {
            found.push("expected a place to meet without objects and people who stay".into());
        }
        for (name, kind) in &self.borders {
            let flows = [kind.inputs, kind.outputs];
            let odd = flows
                .iter()
                .find(|f| ![f.place.0, f.place.1, f.time.0, f.time.1].iter().all(|s| (0.0..=1.0).contains(s)));
            found.extend(odd.map(|f| {
                format!("border to {name:?}: expected fractions in [0, 1], found {:?} and {:?}", f.place, f.time)
            }));
        }
        found
    }

    /// Puts objects and people into `frame`, at random; what finds no room is left out.
    pub fn furnish(&self, frame: &mut FramePatch, limits: &Limits, rng: &mut ChaCha8Rng) {
        let corners = &frame.outline;
        let area = (1..corners.len().saturating_sub(1))
            .map(|i| 0.5 * (corners[i] - corners[0]).perp_dot(corners[i + 1] - corners[0]))
            .sum();
        for furnishing in &self.furnishings {
            for _ in 0..furnishing.amount.draw(area, rng) {
                let make = |at: Vec2, angle: f32| furnishing.outline.at(at, angle);
                frame.scatter_object(&furnishing.name, make, limits, rng);
            }
        }
        for gathering in &self.gatherings {
            for _ in 0..gathering.amount.draw(area, rng) {
                gathering.join(frame, limits, rng);
            }
        }
    }
}

impl Gathering {
    fn problem(&self) -> Option<String> {
        if self.size.0 > self.size.1 || self.size.1 > LARGEST_GROUP {
            return Some(format!("expected a range of sizes up to {LARGEST_GROUP}, found {:?}", self.size));
        }
        let fits = (0.1..=3.0).contains(&self.radius);
        (!fits).then(|| format!("expected a radius from 0.1 to 3 m, found {}", self.radius))
    }

    /// Adds one group: people on a circle who look at its middle.
    fn join(&self, frame: &mut FramePatch, limits: &Limits, rng: &mut ChaCha8Rng) {
        let size = rng.random_range(self.size.0..=self.size.1.max(self.size.0));
        let fitting: Vec<&Tableau> = self.tableaux.iter().filter(|t| t.members.len() == size).collect();
        if let Some(tableau) = fitting.choose(rng) {
            tableau.join(&self.name, frame, limits, rng);
            return;
        }
        if size < 2 {
            if size == 1 {
                frame.scatter_person(&self.name, self.radius, limits, rng);
            }
            return;
        }
        // Neighbours on the circle do not overlap.
        let circle = (self.radius / (std::f32::consts::PI / size as f32).sin()).max(0.45);
        let make = |at: Vec2, _| Shape::disc(at, circle + self.radius);
        let Some(Shape::Disc { centre, .. }) = frame.find_room(make, limits, rng) else { return };
        let turn = rng.random::<f32>();
        for i in 0..size {
            let away = Vec2::from_angle((turn + i as f32 / size as f32) * std::f32::consts::TAU);
            let position = centre + away * circle;
            let heading = (-away.x).atan2(-away.y);
            frame.people.push(Standing { name: self.name.clone(), position, heading, radius: self.radius, role: None });
        }
    }
}
