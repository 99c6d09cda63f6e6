//! Clause 2, on paths: stitches are closed in space, heading and time, and the hips are seen where the path is.

use super::limits::Limits;
use super::part::Part;
use super::report::{Row, Worst};
use crate::geom::wrap_angle;
use crate::motion::FPS;
use crate::stage::Crowd;

/// The rows of clause 2 on paths.
pub(super) fn rows(crowd: &Crowd, parts: &[Part], limits: &Limits) -> Vec<Row> {
    let (mut position, mut heading, mut time) = (Worst::default(), Worst::default(), Worst::default());
    for pair in parts.windows(2).filter(|p| p[0].character == p[1].character) {
        let (a, b) = (pair[0].used, pair[1].used);
        let gap = a.points[a.points.len() - 1].distance(b.points[0]);
        let turn = wrap_angle(b.headings[0] - a.headings[a.headings.len() - 1]).abs();
        let place = || format!("frame {}, end of {}", a.end, pair[0].name());
        position.offer(gap as f64, place);
        heading.offer((turn as f64).to_degrees(), place);
        time.offer(f64::from(a.end.abs_diff(b.begin)) / FPS as f64, place);
    }
    vec![
        position.row(2, "stitch: gap between the paths", limits.stitch_position, "m"),
        heading.row(2, "stitch: gap between the headings", limits.stitch_heading_deg, "deg"),
        time.row(2, "stitch: gap in time", limits.stitch_time, "s"),
        hips_offset(crowd, parts).row(2, "hips off the path", limits.hips_offset, "m"),
    ]
}

fn hips_offset(crowd: &Crowd, parts: &[Part]) -> Worst {
    let mut worst = Worst::default();
    for part in parts {
        let character = &crowd.characters[part.character];
        for frame in part.visible(crowd.domain.last_frame).filter(|&f| character.present(f)) {
            let hips = character.root[(frame - character.begin) as usize];
            let offset = glam::Vec2::new(hips.x, hips.z).distance(part.point_at(frame as f64));
            worst.offer(offset as f64, || format!("frame {frame}, {}", part.name()));
        }
    }
    worst
}
