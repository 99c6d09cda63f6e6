//! Equation 7 of "Tiling Motion Patches": which patches are wanted where, which way, when.
//!
//! F = exp(-f_1(x, z)/s_1) exp(-f_2(theta)/s_2) exp(-f_3(t)/s_3) exp(-f_4(l)/s_4): a product of terms, each of which is
//! one f / s. [`Term`]s are ready-made: attract, avoid, directions, ratios of labels, a schedule; or tables that were
//! filled by somebody's own functions. Departures: a term may be of some labels and of some time only, and a direction may
//! depend on the place. Every f is at least 0, so that F is at most 1.

use glam::Vec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::grid::Grid;
use crate::geom::{Ground, wrap_angle};
use crate::motion::FPS;
use crate::patch::PatchSet;

/// The preference function of a scene. Without terms every patch is as good as any other: F = 1.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Preference {
    /// The factors of F.
    pub terms: Vec<Term>,
}

/// One factor of F: exp(-strength f).
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Term {
    /// What f is.
    pub form: Form,
    /// 1 / sigma.
    pub strength: f32,
    /// Only of kinds with one of these labels; of all kinds if there are none.
    pub labels: Vec<String>,
    /// Only from the first to the second, seconds; at any time if none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub during: Option<[f32; 2]>,
}

/// Ready-made functions f.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// f_1 = (distance / within)^2 from a point, or from a path of several.
    Attract {
        /// The point or path, metres.
        to: Vec<Vec2>,
        /// At this distance f is 1, metres.
        within: f32,
    },
    /// f_1 = (1 - distance / within)^2 where nearer than that to a point or path, else 0.
    Avoid {
        /// The point or path, metres.
        from: Vec<Vec2>,
        /// Farther away it does not count, metres.
        within: f32,
    },
    /// f_2 = 1 - cos(theta - the field's direction): 0 along it, 2 against it.
    Direction(Field),
    /// f_3 = (seconds to the nearest window / fade)^2.
    Schedule {
        /// From, to: seconds.
        times: Vec<[f32; 2]>,
        /// So long before and after a window f is 1, seconds.
        fade: f32,
    },
    /// f_4 = -ln(ratio / the largest ratio); the ratio of a kind is the product of those of its labels, 1 without any.
    Ratios(Vec<(String, f32)>),
    /// f_1 by tables: bilinear.
    Places(Grid),
    /// f_2 by tables over place and heading: bilinear in the place, the nearest of so many headings around.
    Headings(Vec<Grid>),
    /// f_3 at evenly spaced times from 0, in between linear.
    Times {
        /// Seconds from one to the next.
        step: f32,
        /// The values.
        values: Vec<f32>,
    },
    /// f_4 by name of the kind; 0 of kinds that are not named.
    Kinds(Vec<(String, f32)>),
}

/// A field of directions on the ground.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Field {
    /// The same everywhere, radians.
    Heading(f32),
    /// Towards a point.
    Toward(Vec2),
    /// Away from a point.
    Away(Vec2),
    /// As the nearest stretch of a path goes.
    Along(Vec<Vec2>),
    /// Around a point; true is clockwise seen from above with x right and z up.
    Around(Vec2, bool),
}

/// No f is larger: what is not wanted at all stays comparable.
const LARGEST: f32 = 50.0;

/// How much -ln F adds to the cost of a step, and the most of it that is charged.
const PRICE: f32 = 1.0;
const DEAREST: f32 = 10.0;

/// Least probability with which something is tried.
const LEAST: f32 = 1e-5;

/// Where, which way and when a patch is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stay {
    /// Metres.
    pub position: Vec2,
    /// Radians.
    pub heading: f32,
    /// Seconds.
    pub secs: f32,
}

impl Stay {
    /// At a place and heading at a tick.
    pub fn new(at: Ground, tick: i32) -> Self {
        Self { position: at.position, heading: at.heading, secs: tick as f32 / FPS }
    }
}

/// A preference made ready for the kinds of a set.
#[derive(Default)]
pub(super) struct Ready {
    terms: Vec<Term>,
    /// For each kind what its labels make of f_4, and which of the other terms are of it.
    kinds: Vec<(f32, Vec<u16>)>,
}

impl Preference {
    /// The labels that terms speak of.
    pub fn labels(&self) -> impl Iterator<Item = &str> {
        let ratios = self.terms.iter().filter_map(|t| match &t.form {
            Form::Ratios(ratios) => Some(ratios.iter().map(|r| r.0.as_str())),
            _ => None,
        });
        self.terms.iter().flat_map(|t| t.labels.iter().map(String::as_str)).chain(ratios.flatten())
    }
}

impl Ready {
    /// O(kinds x terms).
    pub fn new(preference: &Preference, set: &PatchSet) -> Self {
        let terms = preference.terms.clone();
        let of_kind = |kind: &crate::patch::PatchKind| {
            let is_of = |t: &&Term| t.labels.is_empty() || t.labels.iter().any(|l| kind.labels.contains(l));
            let fixed = terms.iter().filter(is_of).filter_map(|t| Some(t.strength * of_labels(&t.form, kind)?));
            let place = |t: &&Term| is_of(t) && of_labels(&t.form, kind).is_none();
            let others = terms.iter().enumerate().filter(|(_, t)| place(t)).map(|(i, _)| i as u16);
            (fixed.sum(), others.collect())
        };
        Self { kinds: set.kinds.iter().map(of_kind).collect(), terms }
    }

    /// True if all patches are alike: nothing need be asked.
    pub fn is_indifferent(&self) -> bool {
        self.terms.is_empty()
    }

    /// -ln F: 0 for what is wanted most. O(terms).
    #[inline]
    pub fn reluctance(&self, kind: u32, stay: Stay) -> f32 {
        if self.terms.is_empty() {
            return 0.0;
        }
        let (fixed, terms) = &self.kinds[kind as usize];
        terms.iter().fold(*fixed, |sum, &i| sum + self.terms[i as usize].reluctance(stay)).min(LARGEST)
    }

    /// By how much more than its time a step costs that leads to some place: 1 where F is 1.
    #[inline]
    pub fn price(&self, kind: u32, stay: Stay) -> f32 {
        1.0 + PRICE * self.reluctance(kind, stay).min(DEAREST)
    }

    /// F: from 0 to 1.
    pub fn weight(&self, kind: u32, stay: Stay) -> f32 {
        (-self.reluctance(kind, stay)).exp()
    }

    /// True with a probability of F, but at times of what is hardly wanted as well, so that a search goes on.
    pub fn is_wanted(&self, kind: u32, stay: Stay, rng: &mut ChaCha8Rng) -> bool {
        self.terms.is_empty() || rng.random_range(0.0..1.0) < self.weight(kind, stay).max(LEAST)
    }

    /// The same of a kind that was drawn by [`Self::weight_of_kind`].
    pub fn is_wanted_there(&self, kind: u32, stay: Stay, rng: &mut ChaCha8Rng) -> bool {
        self.terms.is_empty() || rng.random_range(0.0..1.0) < self.weight_of_stay(kind, stay).max(LEAST)
    }

    fn fixed(&self, kind: u32) -> f32 {
        self.kinds.get(kind as usize).map_or(0.0, |k| k.0.min(LARGEST))
    }

    /// F of a kind as far as its labels decide it.
    pub fn weight_of_kind(&self, kind: u32) -> f32 {
        (-self.fixed(kind)).exp()
    }

    /// F but for what labels alone decide.
    pub fn weight_of_stay(&self, kind: u32, stay: Stay) -> f32 {
        (self.fixed(kind) - self.reluctance(kind, stay)).min(0.0).exp()
    }
}

impl Term {
    fn reluctance(&self, stay: Stay) -> f32 {
        if self.during.is_some_and(|[from, to]| !(from..=to).contains(&stay.secs)) {
            return 0.0;
        }
        self.strength * self.form.value(stay)
    }
}

impl Form {
    /// f of a place, direction and time; 0 if it is of labels.
    fn value(&self, stay: Stay) -> f32 {
        let square = |x: f32| x * x;
        match self {
            Self::Attract { to, within } => square(nearest(to, stay.position).0 / within),
            Self::Avoid { from, within } => square((1.0 - nearest(from, stay.position).0 / within).max(0.0)),
            Self::Direction(field) => {
                field.at(stay.position).map_or(0.0, |heading| 1.0 - wrap_angle(stay.heading - heading).cos())
            }
            Self::Schedule { times, fade } => {
                let away = |[from, to]: &[f32; 2]| (from - stay.secs).max(stay.secs - to).max(0.0);
                square(times.iter().map(away).fold(f32::INFINITY, f32::min) / fade)
            }
            Self::Places(grid) => grid.at(stay.position),
            Self::Headings(grids) => {
                let turn = wrap_angle(stay.heading).rem_euclid(std::f32::consts::TAU) / std::f32::consts::TAU;
                grids[(turn * grids.len() as f32).round() as usize % grids.len()].at(stay.position)
            }
            Self::Times { step, values } => {
                let at = (stay.secs / step).clamp(0.0, (values.len() - 1) as f32);
                let i = (at as usize).min(values.len().saturating_sub(2));
                let next = values[(i + 1).min(values.len() - 1)];
                values[i] + (next - values[i]) * (at - i as f32)
            }
            Self::Ratios(_) | Self::Kinds(_) => 0.0,
        }
    }
}

/// f of a kind by its labels or name; `None` if the form is of something else.
fn of_labels(form: &Form, kind: &crate::patch::PatchKind) -> Option<f32> {
    match form {
        Form::Ratios(ratios) => {
            let ratio: f32 = ratios.iter().filter(|(l, _)| kind.labels.contains(l)).map(|r| r.1).product();
            let largest = ratios.iter().map(|r| r.1.max(1.0)).product::<f32>();
            Some(-(ratio / largest).ln())
        }
        Form::Kinds(values) => Some(values.iter().find(|v| v.0 == kind.name).map_or(0.0, |v| v.1)),
        _ => None,
    }
}

impl Field {
    /// The direction at a place, radians; none where there is none, as in the point that is gone to.
    fn at(&self, p: Vec2) -> Option<f32> {
        let of = |v: Vec2| (v.length_squared() > 1e-6).then(|| v.x.atan2(v.y));
        match self {
            Self::Heading(heading) => Some(*heading),
            Self::Toward(to) => of(*to - p),
            Self::Away(from) => of(p - *from),
            Self::Along(path) => of(nearest(path, p).1),
            Self::Around(center, clockwise) => {
                let out = p - *center;
                of(if *clockwise { Vec2::new(out.y, -out.x) } else { Vec2::new(-out.y, out.x) })
            }
        }
    }
}

/// Distance from a path, and how its nearest stretch goes. O(points).
fn nearest(path: &[Vec2], p: Vec2) -> (f32, Vec2) {
    if let [point] = path {
        return (point.distance(p), Vec2::ZERO);
    }
    let stretch = |w: &[Vec2]| {
        let along = w[1] - w[0];
        let t = ((p - w[0]).dot(along) / along.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        (p.distance(w[0] + along * t), along)
    };
    path.windows(2).map(stretch).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, Vec2::ZERO))
}

#[cfg(test)]
#[path = "prefer_tests.rs"]
mod tests;
