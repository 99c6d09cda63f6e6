//! Clause 6, on joints: nobody turns a joint further beyond what people can do than the captures that are shown.
//!
//! What people can do is data about the skeleton, like its body capsules, and shared with the solver
//! ([`crate::motion::limits`]); what a crowd makes of it is measured here.

use rayon::prelude::*;

use super::limits::Limits;
use super::part::Part;
use super::report::{Row, Worst};
use crate::motion::limits::excess;
use crate::motion::{FPS, canonical};
use crate::stage::Crowd;

/// Captures that are blended at a stitch are seen up to this long before and after it, seconds.
const BLEND: f32 = 0.6;

/// The row on joints. Captures may exceed the limits, since they measure joints of skin and cloth, so that a joint may
/// be as far beyond them as in any capture that the frame shows. O(people x frames x joints), parallel over people.
pub(super) fn rows(crowd: &Crowd, parts: &[Part], limits: &Limits) -> Vec<Row> {
    let chains: Vec<&[Part]> = parts.chunk_by(|a, b| a.character == b.character).collect();
    let all: Vec<Worst> = chains.into_par_iter().map(|chain| character(crowd, chain)).collect();
    let worst = all.into_iter().fold(Worst::default(), Worst::merge);
    vec![worst.row(6, "joint further beyond its limits than captured", limits.joint_excess_deg, "deg")]
}

fn character(crowd: &Crowd, chain: &[Part]) -> Worst {
    let mut worst = Worst::default();
    let character = &crowd.characters[chain[0].character];
    for (i, frame) in (character.begin..).take(character.frames()).enumerate() {
        for (joint, &rotation) in character.pose(i).iter().enumerate() {
            let found = excess(joint, rotation);
            let captured = if found > 0.0 {
                seen(chain, frame).map(|p| captured(p, frame, joint)).fold(0.0, f32::max)
            } else {
                0.0
            };
            worst.offer((found - captured).to_degrees() as f64, || {
                let (name, number) = (&canonical().joints[joint].name, chain[0].character);
                format!("character {number}, frame {frame}, {name} ({:.0} deg beyond)", found.to_degrees())
            });
        }
    }
    worst
}

/// The fragments of a chain that a frame shows, blends at stitches included.
fn seen<'a, 'b>(chain: &'b [Part<'a>], frame: u32) -> impl Iterator<Item = &'b Part<'a>> {
    let (frame, blend) = (frame as i32, (BLEND * FPS) as i32);
    let first = chain.partition_point(|part| part.used.end.saturating_add(blend) < frame);
    chain[first..].iter().take_while(move |part| part.used.begin.saturating_sub(blend) <= frame)
}

/// How far a fragment's capture turns a joint beyond its limits at a frame of the crowd, or at its end nearest to it.
fn captured(part: &Part, frame: u32, joint: usize) -> f32 {
    let motion = &part.source.motion;
    let at = part.clock_at_frame(frame as f64) - part.source.begin as f64;
    let at = at.clamp(0.0, (motion.len() - 1) as f64);
    let of_frame = |f: f64| excess(joint, motion.pose(f as usize)[joint]);
    of_frame(at.floor()).max(of_frame(at.ceil()))
}
