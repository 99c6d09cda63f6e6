//! Patterns: where, when and how fast people cross a border.
//!
//! "Crowd Patches" (2009), section 3.2: P = {l, pi, I_i [p_i, t_i], O_j [p_j, t_j]}. Departure: a crossing also has a
//! velocity, so that two patches meet not only in place (C0) but also in direction and speed (C1): the walker goes
//! along a straight line while its body touches the border.

use crate::{Error, Result};

/// One person crossing a border, once per period.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Crossing {
    /// Distance from the begin of the edge, metres.
    pub place: f32,
    /// When, seconds, in [0, period).
    pub time: f32,
    /// Speed at right angles to the border, m/s, above zero: into the patch for an input, out of it for an output.
    pub across: f32,
    /// Speed along the edge, m/s, from its begin to its end if positive.
    pub along: f32,
}

impl Crossing {
    /// Speed in m/s.
    pub fn speed(&self) -> f32 {
        self.across.hypot(self.along)
    }

    fn mirror(&self, length: f32) -> Self {
        Self { place: length - self.place, along: -self.along, ..*self }
    }
}

/// What crosses one edge of a patch.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pattern {
    /// Length of the edge, metres.
    pub length: f32,
    /// Period, seconds.
    pub period: f32,
    /// Where people come in.
    pub inputs: Vec<Crossing>,
    /// Where people go out.
    pub outputs: Vec<Crossing>,
}

impl Pattern {
    /// A border nobody crosses.
    pub fn empty(length: f32, period: f32) -> Self {
        Self { length, period, ..Self::default() }
    }

    /// The same crossings as the patch on the other side of the border sees them (eq. 2): inputs are outputs, and its
    /// edge runs the other way.
    pub fn mirror(&self) -> Self {
        let turned = |crossings: &[Crossing]| crossings.iter().map(|c| c.mirror(self.length)).collect();
        Self { length: self.length, period: self.period, inputs: turned(&self.outputs), outputs: turned(&self.inputs) }
    }

    /// Whether nobody crosses.
    pub fn is_empty(&self) -> bool {
        self.inputs.is_empty() && self.outputs.is_empty()
    }

    /// Inputs and outputs, one after the other.
    pub fn crossings(&self) -> impl Iterator<Item = &Crossing> {
        self.inputs.iter().chain(&self.outputs)
    }

    /// How many more people come in than go out, per period.
    pub fn surplus(&self) -> i32 {
        self.inputs.len() as i32 - self.outputs.len() as i32
    }

    /// All that is wrong with the numbers themselves, each with its place; empty if nothing is.
    pub fn problems(&self) -> Vec<String> {
        let mut found = Vec::new();
        for (what, value) in [("length", self.length), ("period", self.period)] {
            if !(value.is_finite() && value > 0.0) {
                found.push(format!("{what}: expected a number above zero, found {value}"));
            }
        }
        let named = |name, list: &[Crossing]| list.iter().enumerate().map(|(i, c)| (name, i, *c)).collect::<Vec<_>>();
        for (name, i, crossing) in named("input", &self.inputs).into_iter().chain(named("output", &self.outputs)) {
            found.extend(self.problem(&crossing).map(|problem| format!("{name} {i}: {problem}")));
        }
        found
    }

    fn problem(&self, c: &Crossing) -> Option<String> {
        if !(0.0..=self.length).contains(&c.place) {
            return Some(format!("expected a place in [0, {}] m, found {}", self.length, c.place));
        }
        if !(0.0..self.period).contains(&c.time) {
            return Some(format!("expected a time in [0, {}) s, found {}", self.period, c.time));
        }
        if !(c.across.is_finite() && c.across > 0.0 && c.along.is_finite()) {
            return Some(format!("expected a speed across the border above zero, found {}", c.across));
        }
        None
    }
}

/// Whether as many people come in as go out; a patch needs that (section 4.1).
///
/// # Errors
/// Says how many come in and how many go out.
pub fn balanced(patterns: &[Pattern]) -> Result<()> {
    let inputs: usize = patterns.iter().map(|p| p.inputs.len()).sum();
    let outputs: usize = patterns.iter().map(|p| p.outputs.len()).sum();
    if inputs != outputs {
        let problem = format!("expected as many inputs as outputs, found {inputs} and {outputs}");
        return Err(Error::invalid("patch", "patterns", problem));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mirror_of_the_mirror_is_the_pattern() {
        let crossing = Crossing { place: 2.0, time: 3.0, across: 1.25, along: 0.5 };
        let pattern = Pattern { inputs: vec![crossing], ..Pattern::empty(8.0, 10.0) };
        let mirror = pattern.mirror();
        assert_eq!(mirror.outputs, [Crossing { place: 6.0, time: 3.0, across: 1.25, along: -0.5 }]);
        assert_eq!(mirror.mirror(), pattern);
        assert_eq!(mirror.surplus(), -1);
    }

    #[test]
    fn problems_name_the_crossing() {
        let crossing = Crossing { place: 9.0, time: 3.0, across: 1.25, along: 0.5 };
        let pattern = Pattern { outputs: vec![crossing], ..Pattern::empty(8.0, 10.0) };
        assert_eq!(pattern.problems(), ["output 0: expected a place in [0, 8] m, found 9"]);
        assert_eq!(Pattern::empty(f32::NAN, -1.0).problems().len(), 2);
    }
}
