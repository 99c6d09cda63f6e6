//! One crowd patch over its whole period.

use glam::DVec2;

use super::ROUNDING;
use super::curve::{CHORDS, Curve};
use super::distance::{to_origin, to_shape};
use crate::world::{Crossing, CrowdPatch, Limits, Path, Port, Shape, Walker};

/// What was found in one patch. Distances are lower bounds, speeds and accelerations upper bounds.
#[derive(Clone, Debug, Default)]
pub struct PatchReport {
    /// Everything that is not as it must be, in words; empty if the patch is right.
    pub violations: Vec<String>,
    /// Least distance between the centres of two walkers, metres.
    pub closest: f64,
    /// Least distance of a walker's centre from objects and standing people, metres.
    pub objects: f64,
    /// Greatest speed of every walker, m/s.
    pub speed: Vec<f64>,
    /// Greatest acceleration of every walker, m/s2.
    pub acceleration: Vec<f64>,
    /// Greatest turning of every walker while it walks, rad/s.
    pub turning: Vec<f64>,
    /// Least speed of every walker, m/s.
    pub slowest: Vec<f64>,
}

impl PatchReport {
    /// Whether the patch is right.
    pub fn ok(&self) -> bool {
        self.violations.is_empty()
    }
}

impl PatchReport {
    /// Whether no body touches another or an object, whatever else is wrong.
    pub fn collision_free(&self, limits: &Limits) -> bool {
        let radius = f64::from(limits.radius);
        self.closest >= 2.0 * radius - ROUNDING && self.objects >= radius - ROUNDING
    }
}

/// Checks `patch`: everybody comes in and goes out where, when and as fast as the patterns say, in a straight line
/// while its body reaches over a border; bodies never touch, nor objects; nobody leaves; limits hold. O(walkers^2 x
/// length of paths).
pub fn check_patch(patch: &CrowdPatch, limits: &Limits) -> PatchReport {
    let mut report = PatchReport { closest: f64::INFINITY, objects: f64::INFINITY, ..PatchReport::default() };
    check_ports(patch, &mut report);
    let curves: Vec<Option<Curve>> = patch.walkers.iter().map(|w| Curve::new(&w.path)).collect();
    let Some(curves) = curves.into_iter().collect::<Option<Vec<_>>>() else {
        report.violations.push("expected finite paths of at least four points".into());
        return report;
    };
    let Some(period) = chords_per_period(patch) else {
        report.violations.push("expected paths with one step that divides the period".into());
        return report;
    };
    for (index, (walker, curve)) in patch.walkers.iter().zip(&curves).enumerate() {
        let mut found = Vec::new();
        check_crossings(patch, walker, curve, limits, &mut found);
        check_limits(walker, curve, limits, &mut report, &mut found);
        check_surroundings(patch, walker, curve, limits, &mut report, &mut found);
        report.violations.extend(found.into_iter().map(|f| format!("walker {index}: {f}")));
    }
    check_pairs(&curves, period, chord_secs(patch), limits, &mut report);
    report
}

/// Seconds per chord.
pub(super) fn chord_secs(patch: &CrowdPatch) -> f64 {
    f64::from(patch.walkers.first().map_or(1.0, |w| w.path.step)) / CHORDS as f64
}

/// Chords per period, if all walkers share a step that divides it.
pub(super) fn chords_per_period(patch: &CrowdPatch) -> Option<i64> {
    let Some(first) = patch.walkers.first() else { return Some(CHORDS) };
    let steps = f64::from(patch.frame.period()) / f64::from(first.path.step);
    let same = patch.walkers.iter().all(|w| w.path.step == first.path.step);
    (same && (steps - steps.round()).abs() < 1e-4).then_some(steps.round() as i64 * CHORDS)
}

/// Every input and every output is used once, and nobody goes back over the same edge if that can be.
fn check_ports(patch: &CrowdPatch, report: &mut PatchReport) {
    let sorted = |mut ports: Vec<Port>| {
        ports.sort();
        ports
    };
    let frame = &patch.frame;
    let inputs = sorted(patch.walkers.iter().map(|w| w.input).collect());
    let outputs = sorted(patch.walkers.iter().map(|w| w.output).collect());
    if inputs != sorted(frame.inputs().collect()) || outputs != sorted(frame.outputs().collect()) {
        report.violations.push("expected every input and output to be used once".into());
    }
    let total = frame.inputs().count();
    let can = frame.patterns.iter().all(|p| p.inputs.len() + p.outputs.len() <= total);
    let back = patch.walkers.iter().filter(|w| w.input.edge == w.output.edge).count();
    if can && back > 0 {
        report.violations.push(format!("expected nobody to go back over the edge it came by, found {back}"));
    }
}

/// Crossing, its place, its velocity and when, in the patch's frame.
struct Gate {
    crossing: Crossing,
    place: DVec2,
    velocity: DVec2,
    time: f64,
}

fn gate(patch: &CrowdPatch, port: Port, inward: bool, laps: u32) -> Gate {
    let frame = &patch.frame;
    let pattern = &frame.patterns[port.edge];
    let crossing = if inward { pattern.inputs[port.index] } else { pattern.outputs[port.index] };
    let begin = frame.outline[port.edge].as_dvec2();
    let along = (frame.outline[(port.edge + 1) % frame.outline.len()].as_dvec2() - begin).normalize();
    // The outline runs counter-clockwise: inside is to the left.
    let left = DVec2::new(-along.y, along.x);
    let across = f64::from(crossing.across) * if inward { 1.0 } else { -1.0 };
    Gate {
        crossing,
        place: begin + along * f64::from(crossing.place),
        velocity: along * f64::from(crossing.along) + left * across,
        time: f64::from(crossing.time) + f64::from(laps) * f64::from(frame.period()),
    }
}

/// The path is the crossing's straight line while the body reaches over the border, on both sides of it.
fn check_crossings(patch: &CrowdPatch, walker: &Walker, curve: &Curve, limits: &Limits, found: &mut Vec<String>) {
    let secs = chord_secs(patch);
    let gates = [gate(patch, walker.input, true, 0), gate(patch, walker.output, false, walker.laps)];
    if gates[0].time >= gates[1].time {
        found.push("expected it to come in before it goes out".into());
    }
    for gate in &gates {
        let reach = f64::from(limits.radius) / f64::from(gate.crossing.across);
        let (begin, end) = ((gate.time - reach) / secs, (gate.time + reach) / secs);
        if begin < curve.begin as f64 - 1e-6 || end > curve.end() as f64 + 1e-6 {
            found.push(format!("expected a path from {:.2} to {:.2} s", begin * secs, end * secs));
            continue;
        }
        let first = (begin.floor() as i64).max(curve.begin);
        let last = (end.ceil() as i64).min(curve.end());
        for chord in first..=last {
            let i = (chord - curve.begin) as usize;
            let expected = gate.place + gate.velocity * (chord as f64 * secs - gate.time);
            let (gap, jump) = (curve.places[i].distance(expected), curve.velocities[i].distance(gate.velocity));
            // The chords that the straight part ends in may begin to bend.
            let inner = chord as f64 >= begin && chord as f64 <= end;
            if inner && (gap > ROUNDING || jump > 1e-3) {
                found.push(format!("expected a straight crossing, found it {gap:.4} m and {jump:.4} m/s off"));
                break;
            }
        }
    }
}

fn check_limits(walker: &Walker, curve: &Curve, limits: &Limits, report: &mut PatchReport, found: &mut Vec<String>) {
    let acceleration = curve.accelerations.iter().copied().fold(0.0, f64::max);
    let turning = turning(&walker.path, f64::from(limits.standing));
    let slowest = curve.velocities.iter().map(|v| v.length()).fold(f64::INFINITY, f64::min);
    let over = [
        ("speed", curve.speed, limits.speed),
        ("acceleration", acceleration, limits.acceleration),
        ("turning", turning, limits.turning),
    ];
    for (name, value, limit) in over {
        if value > f64::from(limit) * 1.0005 {
            found.push(format!("expected {name} at most {limit}, found {value:.3}"));
        }
    }
    report.speed.push(curve.speed);
    report.acceleration.push(acceleration);
    report.turning.push(turning);
    report.slowest.push(slowest);
}

/// Greatest turning while faster than `standing`, sampled sixteen times per step.
pub(super) fn turning(path: &Path, standing: f64) -> f64 {
    const SAMPLES: usize = 16;
    let p: Vec<DVec2> = path.points.iter().map(|p| p.as_dvec2()).collect();
    let step = f64::from(path.step);
    let mut greatest = 0.0_f64;
    for w in p.windows(4) {
        let (d0, d1, d2) = (w[1] - w[0], w[2] - w[1], w[3] - w[2]);
        for i in 0..=SAMPLES {
            let u = i as f64 / SAMPLES as f64;
            // The derivative is a quadratic spline over the differences.
            let v = d0 * (0.5 * (1.0 - u) * (1.0 - u)) + d1 * (0.5 + u - u * u) + d2 * (0.5 * u * u);
            let a = (d1 - d0).lerp(d2 - d1, u);
            if v.length() > standing * step {
                greatest = greatest.max(v.perp_dot(a).abs() / (v.length_squared() * step));
            }
        }
    }
    greatest
}

/// Inside the outline, but for the crossings; off objects and standing people.
fn check_surroundings(
    patch: &CrowdPatch,
    walker: &Walker,
    curve: &Curve,
    limits: &Limits,
    report: &mut PatchReport,
    found: &mut Vec<String>,
) {
    let secs = chord_secs(patch);
    let radius = f64::from(limits.radius);
    let mut deepest = f64::INFINITY;
    let mut nearest = f64::INFINITY;
    let people = patch.frame.people.iter().map(|p| Shape::disc(p.position, p.radius));
    let shapes: Vec<Shape> = patch.frame.objects.iter().map(|o| o.shape.clone()).chain(people).collect();
    for chord in curve.begin..curve.end() {
        let (a, b, sag) = curve.chord(chord, secs);
        for edge in 0..patch.frame.outline.len() {
            if !crosses(patch, walker, edge, chord as f64 * secs, secs, limits) {
                let depth = |p: DVec2| depth(patch, edge, p);
                deepest = deepest.min(depth(a).min(depth(b)) - sag);
            }
        }
        for shape in &shapes {
            nearest = nearest.min(to_shape(shape, a, b) - sag);
        }
    }
    if deepest < radius - ROUNDING {
        found.push(format!("expected it {radius} m inside the border, found {deepest:.3} m"));
    }
    if nearest < radius - ROUNDING {
        found.push(format!("expected it {radius} m off objects, found {nearest:.3} m"));
    }
    report.objects = report.objects.min(nearest);
}

/// How far `p` is inside an edge.
fn depth(patch: &CrowdPatch, edge: usize, p: DVec2) -> f64 {
    let outline = &patch.frame.outline;
    let (begin, end) = (outline[edge].as_dvec2(), outline[(edge + 1) % outline.len()].as_dvec2());
    (end - begin).normalize().perp_dot(p - begin)
}

/// Whether the walker's body may reach over `edge` at some time of a chord: when it crosses it, or is in the next patch.
fn crosses(patch: &CrowdPatch, walker: &Walker, edge: usize, time: f64, secs: f64, limits: &Limits) -> bool {
    let reach = |gate: &Gate| f64::from(limits.radius) / f64::from(gate.crossing.across);
    let input = gate(patch, walker.input, true, 0);
    let output = gate(patch, walker.output, false, walker.laps);
    time < input.time
        || time + secs > output.time
        || (walker.input.edge == edge && time < input.time + reach(&input))
        || (walker.output.edge == edge && time + secs > output.time - reach(&output))
}

/// Everybody against everybody, and against themselves a period later.
fn check_pairs(curves: &[Curve], period: i64, secs: f64, limits: &Limits, report: &mut PatchReport) {
    for (i, a) in curves.iter().enumerate() {
        for (j, b) in curves.iter().enumerate().skip(i) {
            let first = (a.begin - b.end()).div_euclid(period);
            let last = (a.end() - b.begin).div_euclid(period) + 1;
            for lap in first..=last {
                if i == j && lap <= 0 {
                    continue;
                }
                let least = least_distance(a, b, lap * period, secs);
                report.closest = report.closest.min(least);
                if least < 2.0 * f64::from(limits.radius) - ROUNDING {
                    report
                        .violations
                        .push(format!("walkers {i} and {j}, {lap} periods later, come as near as {least:.3} m"));
                }
            }
        }
    }
}

/// Lower bound of the distance of `a` and `b` begun `shift` chords later.
fn least_distance(a: &Curve, b: &Curve, shift: i64, secs: f64) -> f64 {
    let chords = a.begin.max(b.begin + shift)..a.end().min(b.end() + shift);
    chords.fold(f64::INFINITY, |least, chord| {
        let (a0, a1, sag_a) = a.chord(chord, secs);
        let (b0, b1, sag_b) = b.chord(chord - shift, secs);
        least.min(to_origin(a0 - b0, a1 - b1) - sag_a - sag_b)
    })
}
