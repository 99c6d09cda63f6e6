//! Clause 6: a planted foot stays, and no foot sinks into the floor.

use glam::Vec2;
use rayon::prelude::*;

use super::limits::Limits;
use super::part::Part;
use super::report::{Row, Worst};
use crate::motion::{Foot, Plant, joint};
use crate::stage::{Character, Crowd};

/// The rows of clause 6. Slide is the largest distance between any two ground positions of the ball of the foot (its
/// toe joint) over the frames of the crowd that lie within the plant and the domain's time.
pub(super) fn rows(crowd: &Crowd, parts: &[Part], limits: &Limits) -> Vec<Row> {
    let mut worst = Worst::default();
    let mut slides = Vec::new();
    for part in parts {
        for plant in &part.source.motion.plants {
            let balls = positions(crowd, part, plant);
            if balls.len() < 2 {
                continue;
            }
            let slide = diameter(&balls) as f64;
            let place =
                || format!("{:?} foot, source frames {}..={} of {}", plant.foot, plant.begin, plant.end, part.name());
            worst.offer(slide, place);
            slides.push(slide);
        }
    }
    slides.sort_by(f64::total_cmp);
    let mut median = Worst::default();
    if let Some(&slide) = slides.get(slides.len() / 2) {
        median.offer(slide, || format!("{} plants", slides.len()));
    }
    vec![
        worst.row(6, "planted foot slides", limits.plant_slide, "m"),
        median.row(6, "planted foot slides, median", limits.plant_slide_median, "m"),
        sinking(crowd).row(6, "foot below the floor", limits.sinking, "m"),
    ]
}

/// How far ankles, balls of the feet and tips of the toes are below the floor.
fn sinking(crowd: &Crowd) -> Worst {
    let of = |(c, character): (usize, &Character)| {
        let (mut worst, mut globals) = (Worst::default(), Vec::new());
        for i in 0..character.frames() {
            character.globals(i, &mut globals);
            for toe in [joint::LEFT_TOE, joint::RIGHT_TOE] {
                let tip = character.skeleton().joints[toe].tip.map(|tip| globals[toe].0 + globals[toe].1 * tip);
                let lowest = tip.into_iter().chain([globals[toe].0, globals[toe - 1].0]).map(|p| p.y);
                let depth = -lowest.fold(f32::INFINITY, f32::min);
                worst.offer(depth.max(0.0) as f64, || format!("character {c}, frame {}", character.begin as usize + i));
            }
        }
        worst
    };
    let all: Vec<Worst> = crowd.characters.par_iter().enumerate().map(of).collect();
    all.into_iter().fold(Worst::default(), Worst::merge)
}

fn positions(crowd: &Crowd, part: &Part, plant: &Plant) -> Vec<Vec2> {
    // A whole frame that rounding puts a hair outside the plant still belongs to it.
    const HAIR: f64 = 1e-6;
    let character = &crowd.characters[part.character];
    let at = |sample: u32| part.used.begin as f64 + sample as f64 * part.rate();
    let first = (at(plant.begin) - HAIR).ceil().max(character.begin as f64);
    let last = (at(plant.end) + HAIR).floor().min(character.end().min(crowd.domain.last_frame) as f64);
    let toe = match plant.foot {
        Foot::Left => joint::LEFT_TOE,
        Foot::Right => joint::RIGHT_TOE,
    };
    let mut globals = Vec::new();
    let mut position = |frame: i64| {
        character.globals((frame - character.begin as i64) as usize, &mut globals);
        let ball = globals[toe].0;
        Vec2::new(ball.x, ball.z)
    };
    if character.frames() == 0 { Vec::new() } else { (first as i64..=last as i64).map(&mut position).collect() }
}

fn diameter(points: &[Vec2]) -> f32 {
    let from = |(i, p): (usize, &Vec2)| points[i + 1..].iter().map(|q| p.distance(*q)).fold(0.0, f32::max);
    points.iter().enumerate().map(from).fold(0.0, f32::max)
}
