//! Several periods in one world: patches that repeat a whole number of times while others go round once.
//!
//! Beyond "Crowd Patches" (2009), whose worlds have one period. A border repeats as often as both its patches do (the least common
//! multiple); a patch is solved in its own, shorter period, and its people are then told apart by which repetition they came
//! in. So to identities, files and players it is a patch like any other.

use super::{Crossing, CrowdPatch, FramePatch, Path, Pattern, Plan, Port, Walker};

/// More repetitions are a mistake.
const MOST: u32 = 100;

impl Plan {
    /// How often patches of a template repeat in a period.
    pub fn repeats_of(&self, template: usize) -> u32 {
        self.repeats.get(template).copied().unwrap_or(1).clamp(1, MOST)
    }

    /// How often a border between two templates repeats in a period.
    pub(super) fn border_repeats(&self, first: usize, second: usize) -> u32 {
        let (a, b) = (self.repeats_of(first), self.repeats_of(second));
        a / divisor(a, b) * b
    }

    /// What is wrong with the periods of a template, if anything.
    pub(super) fn repeats_problem(&self, template: usize) -> Option<String> {
        let found = self.repeats.get(template).copied().unwrap_or(1);
        if !(1..=MOST).contains(&found) {
            return Some(format!("expected from 1 to {MOST} repetitions in a period, found {found}"));
        }
        // Everything runs on one clock.
        let ticks = |secs: f64| (secs / super::solve::STEP).round() as u64;
        let period = f64::from(self.period);
        let fits = ticks(period / f64::from(found)) * u64::from(found) == ticks(period);
        let whole = super::solve::STEP * f64::from(found);
        (!fits).then(|| {
            format!("expected a period that is a multiple of {whole:.1} s to repeat {found} times in, found {period} s")
        })
    }
}

fn divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { divisor(b, a % b) }
}

impl Pattern {
    /// A pattern of `period` in which this one's crossings repeat.
    pub(super) fn repeated(&self, times: u32, period: f32) -> Self {
        let all = |crossings: &[Crossing]| {
            let once = |j: u32| {
                let shift = period * (j as f32 / times as f32);
                // Rounding may lead to the period itself.
                crossings.iter().map(move |c| Crossing { time: (c.time + shift).min(period.next_down()), ..*c })
            };
            (0..times).flat_map(once).collect()
        };
        Self { length: self.length, period, inputs: all(&self.inputs), outputs: all(&self.outputs) }
    }

    /// One of `times` repetitions that this pattern consists of.
    fn once(&self, times: u32) -> Self {
        let first = |crossings: &[Crossing]| crossings[..crossings.len() / times as usize].to_vec();
        let period = self.period / times as f32;
        let within = |c: Crossing| Crossing { time: c.time.min(period.next_down()), ..c };
        let part = |crossings: &[Crossing]| first(crossings).into_iter().map(within).collect();
        Self { length: self.length, period, inputs: part(&self.inputs), outputs: part(&self.outputs) }
    }
}

impl FramePatch {
    /// One of `times` repetitions that this frame consists of.
    pub(super) fn once(&self, times: u32) -> Self {
        Self { patterns: self.patterns.iter().map(|p| p.once(times)).collect(), ..self.clone() }
    }
}

/// A patch with the patterns of `full`, which are `times` repetitions of those of `once`.
pub(super) fn unroll(once: CrowdPatch, full: &FramePatch, times: u32) -> CrowdPatch {
    let short = &once.frame;
    let inputs_before = |edge: usize| short.patterns[..edge].iter().map(|p| p.inputs.len()).sum::<usize>();
    let walker = |edge: usize, repetition: u32, index: usize| {
        let walker = &once.walkers[inputs_before(edge) + index];
        let ticks = (short.period() / walker.path.step).round() as i32;
        let (left, count) = (repetition + walker.laps, short.patterns[walker.output.edge].outputs.len());
        let output = Port { index: walker.output.index + (left % times) as usize * count, ..walker.output };
        let input = Port { edge, index: index + repetition as usize * short.patterns[edge].inputs.len() };
        let path = Path { first: walker.path.first + repetition as i32 * ticks, ..walker.path.clone() };
        Walker { input, output, laps: left / times, path, role: None }
    };
    let edges = 0..short.patterns.len();
    let of =
        |edge: usize| (0..times).flat_map(move |j| (0..short.patterns[edge].inputs.len()).map(move |i| (edge, j, i)));
    let walkers = edges.flat_map(of).map(|(edge, j, i)| walker(edge, j, i)).collect();
    let frame = FramePatch { objects: short.objects.clone(), people: short.people.clone(), ..full.clone() };
    CrowdPatch { frame, walkers }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::world::check_world;
    use crate::world::{Layout, WorldScene, scenes};

    /// Squares repeat three times, parks twice, all else once.
    fn city() -> Plan {
        let plan = scenes::city(16, true, 3).unwrap();
        let repeats = plan.templates.iter().map(|t| match t.name.as_str() {
            "place" => 3,
            "park" => 2,
            _ => 1,
        });
        Plan { repeats: repeats.collect(), period: 12.0, ..plan }
    }

    #[test]
    fn patches_repeat_within_a_period_and_the_world_holds() {
        let plan = city();
        let built =
            WorldScene { name: "periods".into(), layout: Layout::Map(plan.clone()) }.build(&|_, _| true).unwrap();
        let world = &built.world;
        let report = check_world(world);
        assert!(report.ok(), "{report}");
        let mut compared = 0;
        for instance in 0..world.instances() {
            let times = plan.repeats_of(world.kind(world.kind_of(instance)).template());
            let kind = world.kind_of(instance);
            let own = 12.0 / f64::from(times);
            // Everybody's twin comes a repetition later and does the same.
            for secs in [0.3, 2.0, 5.5] {
                let places = |secs: f64| {
                    let moment = world.moment(secs);
                    let mut roots = crate::stage::world::Roots::default();
                    let spot = crate::stage::world::Spot { instance: instance as u32, shift: glam::DVec2::ZERO };
                    world.roots_of(&moment, std::iter::once(spot), world.place(instance), &mut roots);
                    let mut all: Vec<[i32; 2]> = (0..roots.len())
                        .map(|i| [roots.x()[i], roots.z()[i]].map(|v| (v * 500.0).round() as i32))
                        .collect();
                    all.sort_unstable();
                    all
                };
                if times > 1 && world.kind(kind).walkers() > 0 {
                    let (now, then) = (places(secs), places(secs + own));
                    assert_eq!(now.len(), then.len());
                    assert!(
                        now.iter().zip(&then).all(|(a, b)| (0..2).all(|i| (a[i] - b[i]).abs() <= 1)),
                        "{now:?} {then:?}"
                    );
                    compared += now.len();
                }
            }
        }
        assert!(compared > 200, "{compared}");
    }

    #[test]
    fn a_period_that_is_no_multiple_is_refused() {
        let error = Plan { period: 10.0, ..city() }.validate().unwrap_err().to_string();
        assert!(error.contains("multiple of 0.6 s") && error.contains("place"), "{error}");
        let zero = Plan { repeats: vec![0], ..city() };
        assert!(zero.validate().unwrap_err().to_string().contains("from 1 to 100"));
    }
}
