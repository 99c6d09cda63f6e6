//! Clauses 4 and 7: on every frame, bodies stay apart, inside the region and out of obstacles.

use rayon::prelude::*;

use super::depth::Body;
use super::limits::Limits;
use super::part::Part;
use super::report::{Row, Worst};
use crate::motion::FPS;
use crate::stage::Crowd;

#[derive(Default)]
pub(super) struct Depths {
    pub apart: Worst,
    pub together: Worst,
    region: Worst,
    obstacle: Worst,
}

impl Depths {
    pub(super) fn merge(self, other: Self) -> Self {
        Self {
            apart: self.apart.merge(other.apart),
            together: self.together.merge(other.together),
            region: self.region.merge(other.region),
            obstacle: self.obstacle.merge(other.obstacle),
        }
    }
}

/// The rows of clauses 4 and 7. People who are in one patch together may be as deep in each other as in the capture
/// at that moment; all others not at all.
pub(super) fn rows(crowd: &Crowd, parts: &[Part], limits: &Limits) -> Vec<Row> {
    let chains = chains(crowd, parts);
    let seen = crowd.characters.iter().map(|c| c.end() + 1).max().unwrap_or(0).min(crowd.domain.last_frame + 1);
    let frames: Vec<Depths> = (0..seen).into_par_iter().map(|frame| frame_depths(crowd, &chains, frame)).collect();
    let all = frames.into_iter().fold(Depths::default(), Depths::merge);
    vec![
        all.apart.row(4, "bodies of different patches overlap", limits.penetration, "m"),
        all.together.row(4, "bodies of one patch overlap more than captured", limits.penetration, "m"),
        all.region.row(7, "bodies outside the region", limits.penetration, "m"),
        all.obstacle.row(7, "bodies inside obstacles", limits.penetration, "m"),
    ]
}

/// The fragments of every character.
pub(super) fn chains<'a, 'b>(crowd: &Crowd, parts: &'b [Part<'a>]) -> Vec<&'b [Part<'a>]> {
    let mut rest = parts;
    let take = |c: &crate::stage::Character| {
        let (chain, after) = rest.split_at(c.fragments.len());
        rest = after;
        chain
    };
    crowd.characters.iter().map(take).collect()
}

fn frame_depths(crowd: &Crowd, chains: &[&[Part]], frame: u32) -> Depths {
    let mut bodies = bodies_at(crowd, frame);
    let mut depths = Depths::default();
    for (c, body) in &bodies {
        let place = || format!("character {c}, frame {frame}");
        let out = body.depth_out_of(&crowd.domain.region);
        if out > 0.0 {
            depths.region.offer(out as f64, place);
        }
        for (o, obstacle) in crowd.domain.obstacles.iter().enumerate() {
            let inside = body.depth_in(obstacle, frame as f32 / FPS);
            if inside > 0.0 {
                depths.obstacle.offer(inside as f64, || format!("{}, obstacle {o}", place()));
            }
        }
    }
    // Sweep along x: whoever begins before the other ends may touch it.
    let left = |body: &Body| body.center.x - body.radius;
    bodies.sort_by(|a, b| left(&a.1).total_cmp(&left(&b.1)).then(a.0.cmp(&b.0)));
    for (i, (a, body)) in bodies.iter().enumerate() {
        let right = body.center.x + body.radius;
        for (b, other) in bodies[i + 1..].iter().take_while(|(_, other)| left(other) < right) {
            let depth = body.depth_into(other);
            if depth > 0.0 {
                pair_depth(chains, frame, (*a.min(b), *a.max(b)), depth, &mut depths);
            }
        }
    }
    depths
}

pub(super) fn bodies_at(crowd: &Crowd, frame: u32) -> Vec<(usize, Body)> {
    let mut globals = Vec::new();
    let present = crowd.characters.iter().enumerate().filter(|(_, c)| c.frames() > 0 && c.present(frame));
    let body = |(c, character): (usize, &crate::stage::Character)| {
        character.globals((frame - character.begin) as usize, &mut globals);
        (c, Body::new(&globals))
    };
    present.map(body).collect()
}

pub(super) fn pair_depth(chains: &[&[Part]], frame: u32, (a, b): (usize, usize), depth: f32, depths: &mut Depths) {
    match shared_patch(chains, frame, a, b) {
        None => depths.apart.offer(depth as f64, || format!("characters {a} and {b}, frame {frame}")),
        Some((role_a, role_b)) => {
            let captured = captured_depth(role_a, role_b, frame);
            depths.together.offer((depth - captured) as f64, || {
                let (name, instance) = (&role_a.kind.name, role_a.used.instance);
                format!("characters {a} and {b}, frame {frame} ({name}, instance {instance}: {depth:.3} m, captured {captured:.3} m)")
            });
        }
    }
}

/// The two people's parts in the patch they are in together. At the frame of a stitch a person is in both patches.
fn shared_patch<'a, 'b>(
    chains: &[&'b [Part<'a>]],
    frame: u32,
    a: usize,
    b: usize,
) -> Option<(&'b Part<'a>, &'b Part<'a>)> {
    let at = |c: usize| chains[c].iter().filter(move |p| p.used.begin <= frame as i32 && frame as i32 <= p.used.end);
    at(a).find_map(|p| at(b).find(|q| q.used.instance == p.used.instance).map(|q| (p, q)))
}

/// Depth in the capture at the moment `frame` shows; between two captured frames the deeper of them.
fn captured_depth(a: &Part, b: &Part, frame: u32) -> f32 {
    const HAIR: f64 = 1e-6;
    let clocks = [a, b].map(|p| p.clock_at_frame(frame as f64));
    let first = (clocks[0].min(clocks[1]) + HAIR).floor() as u32;
    let last = (clocks[0].max(clocks[1]) - HAIR).ceil() as u32;
    let body = |part: &Part, clock: u32| {
        let (begin, end) = part.clock_range();
        let mut globals = Vec::new();
        part.source.motion.globals((clock.clamp(begin, end) - begin) as usize, &mut globals);
        Body::new(&globals)
    };
    (first..=last).map(|clock| body(a, clock).depth_into(&body(b, clock))).fold(0.0, f32::max)
}
