//! Types of patterns and random patterns of a type.
//!
//! "Crowd Patches" (2009), section 5.3: empty patterns along buildings, one-way flows, doors and lanes (limited in
//! space), crossings with a light (limited in time). All are the same few numbers: how many people, over which part
//! of the edge, in which part of the period.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::spacing::{self, CORNER};
use super::{Crossing, Limits, Pattern};
use crate::{Error, Result};

/// People who cross a border in one direction.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flow {
    /// How many per period.
    pub count: usize,
    /// The part of the edge they use, as fractions of its length.
    pub place: (f32, f32),
    /// The part of the period they come in, as fractions of it; a begin after the end goes over the end of the period.
    pub time: (f32, f32),
}

impl Flow {
    /// `count` people anywhere, at any time.
    pub const fn anywhere(count: usize) -> Self {
        Self { count, place: (0.0, 1.0), time: (0.0, 1.0) }
    }

    /// The same flow over a part of the edge.
    pub const fn through(self, begin: f32, end: f32) -> Self {
        Self { place: (begin, end), ..self }
    }

    /// The same flow in a part of the period.
    pub const fn during(self, begin: f32, end: f32) -> Self {
        Self { time: (begin, end), ..self }
    }
}

/// What kind of flow crosses a border.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PatternType {
    /// Who comes in.
    pub inputs: Flow,
    /// Who goes out.
    pub outputs: Flow,
}

impl PatternType {
    /// Nobody crosses: along a building.
    pub const fn empty() -> Self {
        Self::mixed(0, 0)
    }

    /// People only come in.
    pub const fn one_way_in(count: usize) -> Self {
        Self::mixed(count, 0)
    }

    /// People only go out.
    pub const fn one_way_out(count: usize) -> Self {
        Self::mixed(0, count)
    }

    /// Limited in space: a door between two fractions of the edge.
    pub const fn door(inputs: usize, outputs: usize, begin: f32, end: f32) -> Self {
        Self {
            inputs: Flow::anywhere(inputs).through(begin, end),
            outputs: Flow::anywhere(outputs).through(begin, end),
        }
    }

    /// Limited in space: people keep to the right. Edges run counter-clockwise about the patch, so those who come in use
    /// the second half of the edge and those who go out the first; both patches see it alike.
    pub const fn lanes(inputs: usize, outputs: usize) -> Self {
        Self { inputs: Flow::anywhere(inputs).through(0.5, 1.0), outputs: Flow::anywhere(outputs).through(0.0, 0.5) }
    }

    /// Limited in time: a light that is green between two fractions of the period.
    pub const fn light(inputs: usize, outputs: usize, begin: f32, end: f32) -> Self {
        Self { inputs: Flow::anywhere(inputs).during(begin, end), outputs: Flow::anywhere(outputs).during(begin, end) }
    }

    /// No limit.
    pub const fn mixed(inputs: usize, outputs: usize) -> Self {
        Self { inputs: Flow::anywhere(inputs), outputs: Flow::anywhere(outputs) }
    }

    /// The same border as its neighbour sees it.
    pub fn mirror(&self) -> Self {
        let turned = |flow: Flow| flow.through(1.0 - flow.place.1, 1.0 - flow.place.0);
        Self { inputs: turned(self.outputs), outputs: turned(self.inputs) }
    }

    /// A random pattern of this type whose walkers stay apart on the border, for an edge between right angles.
    ///
    /// # Errors
    /// If the edge is too short, or too many people are asked for: says how many found a place.
    pub fn generate(&self, length: f32, period: f32, limits: &Limits, rng: &mut ChaCha8Rng) -> Result<Pattern> {
        self.generate_between((CORNER, CORNER), length, period, limits, rng)
    }

    /// The same, no nearer to the ends of the edge than `ends` (metres).
    ///
    /// # Errors
    /// As [`Self::generate`].
    pub fn generate_between(
        &self,
        ends: (f32, f32),
        length: f32,
        period: f32,
        limits: &Limits,
        rng: &mut ChaCha8Rng,
    ) -> Result<Pattern> {
        let mut problem = String::new();
        for _ in 0..20 {
            match self.try_generate(ends, length, period, limits, rng) {
                Ok(pattern) => return Ok(pattern),
                Err(found) => problem = found,
            }
        }
        Err(Error::invalid("pattern", format!("edge of {length} m, period {period} s"), problem))
    }

    fn try_generate(
        &self,
        ends: (f32, f32),
        length: f32,
        period: f32,
        limits: &Limits,
        rng: &mut ChaCha8Rng,
    ) -> std::result::Result<Pattern, String> {
        let mut pattern = Pattern::empty(length, period);
        let total = self.inputs.count + self.outputs.count;
        // In turn, so that neither direction takes all the room.
        for i in 0..self.inputs.count.max(self.outputs.count) {
            for (flow, inward) in [(self.inputs, true), (self.outputs, false)] {
                if i >= flow.count {
                    continue;
                }
                let placed = pattern.inputs.len() + pattern.outputs.len();
                let crossing = flow
                    .place_in(&pattern, ends, inward, limits, rng)
                    .ok_or_else(|| format!("expected room for {total} crossings, found room for {placed}"))?;
                if inward { pattern.inputs.push(crossing) } else { pattern.outputs.push(crossing) }
            }
        }
        Ok(pattern)
    }
}

impl Flow {
    /// One more crossing that keeps its distance from those of `pattern`.
    fn place_in(
        &self,
        pattern: &Pattern,
        ends: (f32, f32),
        inward: bool,
        limits: &Limits,
        rng: &mut ChaCha8Rng,
    ) -> Option<Crossing> {
        let (low, high) = self.span(pattern.length, ends)?;
        let apart = 2.0 * limits.radius + spacing::GAP;
        (0..400).find_map(|_| {
            let crossing = self.random((low, high), pattern.period, limits, rng);
            let free = spacing::directed(pattern).all(|other| {
                spacing::distance((&crossing, inward), other, pattern.period) >= apart
                    && spacing::passable((&crossing, inward), other, pattern.period, apart)
            });
            free.then_some(crossing)
        })
    }

    /// The part of the edge in metres that is in the flow and off the corners.
    fn span(&self, length: f32, ends: (f32, f32)) -> Option<(f32, f32)> {
        let (low, high) = ((self.place.0 * length).max(ends.0), (self.place.1 * length).min(length - ends.1));
        (low <= high).then_some((low, high))
    }

    fn random(&self, (low, high): (f32, f32), period: f32, limits: &Limits, rng: &mut ChaCha8Rng) -> Crossing {
        let (begin, mut end) = self.time;
        if end < begin {
            end += 1.0;
        }
        let time = ((begin + (end - begin) * rng.random::<f32>()) * period).rem_euclid(period);
        // People walk at 1.3 m/s, give or take, and hardly ever askew over a border.
        let across = (1.3 + 0.14 * bell(rng)).clamp(1.0, 1.6).min(0.85 * limits.speed);
        let place = low + (high - low) * rng.random::<f32>();
        // Nobody drifts towards a corner on the straight part.
        let room = (place - low).min(high - place) / spacing::STRAIGHT_SECS;
        Crossing {
            place,
            // Rounding may lead to the period itself.
            time: if time < period { time } else { 0.0 },
            across,
            along: (0.25 * across).min(room) * (2.0 * rng.random::<f32>() - 1.0),
        }
    }
}

/// Nearly a normal deviate.
fn bell(rng: &mut ChaCha8Rng) -> f32 {
    (0..4).map(|_| rng.random::<f32>() - 0.5).sum::<f32>() * 3.0_f32.sqrt()
}

/// Raises or lowers the counts of `free` flows by turns until inputs less outputs are `surplus`; for a patch some of
/// whose patterns are given by its neighbours, the surplus of the others must be minus theirs.
///
/// Empty flows stay empty.
///
/// # Errors
/// If no free flow can take the difference.
pub fn balance(free: &mut [PatternType], surplus: i32) -> Result<()> {
    let now: i32 = free.iter().map(|t| t.inputs.count as i32 - t.outputs.count as i32).sum();
    let inward = surplus > now;
    let mut open: Vec<&mut Flow> = free
        .iter_mut()
        .map(|t| if inward { &mut t.inputs } else { &mut t.outputs })
        .filter(|flow| flow.count > 0)
        .collect();
    let missing = (surplus - now).unsigned_abs() as usize;
    if missing > 0 && open.is_empty() {
        let problem = format!("expected a border that takes {missing} more people, found none");
        return Err(Error::invalid("patch", "patterns", problem));
    }
    let width = open.len();
    (0..missing).for_each(|i| open[i % width].count += 1);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::SeedableRng;

    fn generate(kind: PatternType, seed: u64) -> Pattern {
        kind.generate(8.0, 10.0, &Limits::default(), &mut ChaCha8Rng::seed_from_u64(seed)).unwrap()
    }

    proptest! {
        #[test]
        fn random_patterns_keep_their_distances(inputs in 0usize..8, outputs in 0usize..8, seed: u64) {
            let pattern = generate(PatternType::mixed(inputs, outputs), seed);
            prop_assert_eq!((pattern.inputs.len(), pattern.outputs.len()), (inputs, outputs));
            prop_assert_eq!(pattern.problems(), Vec::<String>::new());
            prop_assert_eq!(spacing::problems(&pattern, &Limits::default()), Vec::<String>::new());
        }
    }

    #[test]
    fn a_door_and_a_light_keep_to_their_part() {
        let door = generate(PatternType::door(2, 2, 0.4, 0.6), 3);
        assert!(door.crossings().all(|c| (3.2..=4.8).contains(&c.place)));
        let light = generate(PatternType::light(2, 2, 0.9, 0.2), 3);
        assert!(light.crossings().all(|c| c.time >= 9.0 || c.time <= 2.0));
    }

    #[test]
    fn lanes_look_alike_from_both_sides() {
        assert_eq!(PatternType::lanes(3, 3).mirror(), PatternType::lanes(3, 3));
    }

    #[test]
    fn mirrored_types_make_mirrored_patterns() {
        let lanes = generate(PatternType::lanes(3, 2), 5).mirror();
        let mirror = PatternType::lanes(3, 2).mirror();
        assert_eq!((lanes.inputs.len(), lanes.outputs.len()), (mirror.inputs.count, mirror.outputs.count));
        let within = |c: &Crossing, flow: Flow| (flow.place.0 * 8.0..=flow.place.1 * 8.0).contains(&c.place);
        assert!(lanes.inputs.iter().all(|c| within(c, mirror.inputs)));
        assert!(lanes.outputs.iter().all(|c| within(c, mirror.outputs)));
    }

    #[test]
    fn too_many_people_are_refused_with_a_count() {
        let crowd = PatternType::mixed(200, 200);
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let error = crowd.generate(8.0, 10.0, &Limits::default(), &mut rng).unwrap_err().to_string();
        assert!(error.contains("room for 400 crossings"), "{error}");
        assert!(PatternType::mixed(1, 0).generate(2.0, 10.0, &Limits::default(), &mut rng).is_err());
    }

    #[test]
    fn balance_fills_up_what_is_missing() {
        let mut types = [PatternType::mixed(3, 1), PatternType::empty(), PatternType::mixed(1, 1)];
        balance(&mut types, -2).unwrap();
        assert_eq!(types.iter().map(|t| t.inputs.count as i32 - t.outputs.count as i32).sum::<i32>(), -2);
        assert_eq!(types[1], PatternType::empty());
        assert!(balance(&mut [PatternType::empty()], 1).is_err());
    }
}
