//! What a compose file says of boxes.

use super::moment::Names;
use super::story::{Carried, Prop, Use, bad};
use super::text::LARGEST;
use crate::Result;

/// Longest edge of a box, metres.
const LARGEST_BOX: f32 = 3.0;
/// Farthest that anybody has a box from the hips, metres.
const FARTHEST: f32 = 3.0;
/// Longest time for which a box rests between two who hold it, seconds.
const LONGEST_REST: f32 = 60.0;

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PropText {
    name: String,
    size: Option<[f32; 3]>,
    grip: Option<[f32; 2]>,
    #[serde(default)]
    held: Vec<UseText>,
    #[serde(default)]
    sat: Vec<UseText>,
    #[serde(default = "a_second")]
    rest: f32,
}

fn a_second() -> f32 {
    1.0
}

#[derive(serde::Deserialize)]
#[serde(
    untagged,
    expecting = "expected a role's name, or a table with who, from, to, turn_deg, carried (at, up, ahead), found another"
)]
enum UseText {
    Who(String),
    When(UseTable),
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct UseTable {
    who: String,
    from: Option<String>,
    to: Option<String>,
    #[serde(default = "face_to_face")]
    turn_deg: f32,
    #[serde(default)]
    carried: Vec<CarriedText>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct CarriedText {
    at: String,
    up: f32,
    ahead: f32,
}

fn face_to_face() -> f32 {
    180.0
}

impl PropText {
    /// Checks it and resolves the names.
    pub fn read(self, line: usize, names: &Names) -> Result<Prop> {
        let Self { name, size, grip, held, sat, rest } = self;
        let fail = |problem: String| Err(bad(line, format!("prop {name}: {problem}")));
        if let Some(found) = size.filter(|s| !s.iter().all(|&e| e > 0.0 && e <= LARGEST_BOX)) {
            return fail(format!("expected three extents above 0 and up to {LARGEST_BOX} m, found {found:?}"));
        }
        if let Some(found) = grip.filter(|g| !g.iter().all(|e| e.abs() <= LARGEST_BOX)) {
            return fail(format!("expected a grip of up to {LARGEST_BOX} m, found {found:?}"));
        }
        if !(0.1..=LONGEST_REST).contains(&rest) {
            return fail(format!("expected a rest of 0.1 to {LONGEST_REST} s, found {rest}"));
        }
        match (held.is_empty(), sat.is_empty()) {
            (true, true) => return fail("expected somebody to hold it or to sit on it, found nobody".into()),
            (false, false) => return fail("expected a box that is held or one that is sat on, found both".into()),
            _ => {}
        }
        if sat.iter().any(|u| matches!(u, UseText::When(table) if !table.carried.is_empty())) {
            return fail("expected a box that is held to be carried, found one that is sat on".into());
        }
        let uses = |all: Vec<UseText>| all.into_iter().map(|u| u.read(line, names)).collect::<Result<Vec<_>>>();
        Ok(Prop { held: uses(held)?, sat: uses(sat)?, name, size, grip, rest, line })
    }
}

impl UseText {
    fn read(self, line: usize, names: &Names) -> Result<Use> {
        let UseTable { who, from, to, turn_deg, carried } = match self {
            Self::Who(who) => UseTable { who, from: None, to: None, turn_deg: 180.0, carried: vec![] },
            Self::When(table) => table,
        };
        if turn_deg.is_nan() || turn_deg.abs() > LARGEST {
            return Err(bad(line, format!("expected degrees within {LARGEST}, found {turn_deg}")));
        }
        if carried.is_empty() && from.is_some() != to.is_some() {
            return Err(bad(line, format!("'{who}': expected both from and to, or neither, found one")));
        }
        let who = names.moment(&who, line)?;
        let moment = |text: &str| match names.moment(text, line)? {
            moment if moment.seconds.is_none() => Err(bad(line, format!("expected a moment (with @), found '{text}'"))),
            moment if moment.role != who.role => {
                Err(bad(line, format!("expected moments of '{}', found '{text}'", who.text)))
            }
            moment => Ok(moment),
        };
        let end = |text: Option<String>| text.map(|text| moment(&text)).transpose();
        let span = [end(from)?, end(to)?];
        let carried = carried.into_iter().map(|CarriedText { at, up, ahead }| {
            if let Some(found) = [up, ahead].into_iter().find(|v| v.is_nan() || v.abs() > FARTHEST) {
                return Err(bad(line, format!("'{at}': expected a box within {FARTHEST} m, found {found}")));
            }
            Ok(Carried { at: moment(&at)?, up, ahead })
        });
        let carried = carried.collect::<Result<Vec<_>>>()?;
        Ok(Use { who, span, turn: turn_deg.to_radians(), carried })
    }
}
