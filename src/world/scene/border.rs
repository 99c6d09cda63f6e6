//! How a scene says who crosses a border.

use crate::world::PatternType;

/// A pattern type in words.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BorderText {
    #[serde(rename = "type")]
    kind: String,
    #[serde(rename = "in", default)]
    inputs: usize,
    #[serde(rename = "out", default)]
    outputs: usize,
    /// Part of the edge that is a door.
    door: Option<[f32; 2]>,
    /// Part of the period in which a light is green.
    green: Option<[f32; 2]>,
}

/// More people over one border in a period find no room.
const MOST: usize = 200;

impl BorderText {
    /// The pattern type, or what is wrong.
    pub fn pattern_type(&self) -> Result<PatternType, String> {
        let (n, m) = (self.inputs, self.outputs);
        if n.max(m) > MOST {
            return Err(format!("expected at most {MOST} people, found {}", n.max(m)));
        }
        self.check_extras()?;
        match self.kind.as_str() {
            "empty" if n + m == 0 => Ok(PatternType::empty()),
            "one-way" if n == 0 || m == 0 => Ok(PatternType::mixed(n, m)),
            "mixed" => Ok(PatternType::mixed(n, m)),
            "lanes" => Ok(PatternType::lanes(n, m)),
            "door" => self.door.map(|[a, b]| PatternType::door(n, m, a, b)).ok_or_else(|| missing("door")),
            "light" => self.green.map(|[a, b]| PatternType::light(n, m, a, b)).ok_or_else(|| missing("green")),
            "empty" => Err(format!("expected nobody over an empty border, found {} people", n + m)),
            "one-way" => Err(format!("expected people in one direction, found {n} in and {m} out")),
            other => Err(format!("expected type empty, one-way, mixed, lanes, door or light, found {other:?}")),
        }
    }

    /// Parts that the type does not know would be without effect.
    fn check_extras(&self) -> Result<(), String> {
        for (name, given, kind) in [("door", self.door, "door"), ("green", self.green, "light")] {
            if given.is_some() && self.kind != kind {
                return Err(format!("expected {name} only with type {kind:?}, found it with {:?}", self.kind));
            }
        }
        Ok(())
    }
}

fn missing(name: &str) -> String {
    format!("expected {name} = [begin, end] as fractions, found none")
}
