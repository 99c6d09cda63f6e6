//! Clause 3: how far every source frame of a deformed path is from the capture's.

use glam::Vec2;

use super::limits::Limits;
use super::part::Part;
use super::report::{Row, Worst};
use crate::geom::wrap_angle;
use crate::motion::FPS;

#[derive(Default)]
struct Deformation {
    stretch: Worst,
    bend: Worst,
    slip: Worst,
    time_shift: Worst,
}

/// The rows of clause 3; cropped frames count too, since patches are deformed whole.
pub(super) fn rows(parts: &[Part], limits: &Limits) -> Vec<Row> {
    let mut all = Deformation::default();
    for part in parts {
        measure(part, limits, &mut all);
    }
    vec![
        all.stretch.row(3, "deformation: stretch per frame", limits.stretch, "m"),
        all.bend.row(3, "deformation: bend per frame", limits.bend_deg, "deg"),
        all.time_shift.row(3, "deformation: time shift per frame", limits.time_shift, "s"),
        all.slip.row(3, "deformation: slip, path against heading", limits.slip_deg, "deg"),
    ]
}

/// Stretch is the change of an edge's length, bend the change of the heading's increment along it, slip the change
/// of its direction as seen from the heading, time shift the change of its duration.
fn measure(part: &Part, limits: &Limits, worst: &mut Deformation) {
    let (source, used) = (&part.source.motion.path, part.used);
    worst.time_shift.offer((part.rate() - 1.0).abs() / FPS as f64, || part.name());
    for i in 0..used.points.len() - 1 {
        let place = || format!("source frame {i} of {}", part.name());
        let captured = source.points[i + 1] - source.points[i];
        let deformed = used.points[i + 1] - used.points[i];
        worst.stretch.offer((deformed.length() - captured.length()).abs() as f64, place);
        let turns = (used.headings[i + 1] - used.headings[i], source.headings[i + 1] - source.headings[i]);
        worst.bend.offer(degrees(turns.0 - turns.1), place);
        if captured.length().min(deformed.length()) as f64 > limits.slip_edge {
            let seen = |edge: Vec2, heading: f32| edge.x.atan2(edge.y) - heading;
            worst.slip.offer(degrees(seen(deformed, used.headings[i]) - seen(captured, source.headings[i])), place);
        }
    }
}

fn degrees(angle: f32) -> f64 {
    (wrap_angle(angle).abs() as f64).to_degrees()
}
