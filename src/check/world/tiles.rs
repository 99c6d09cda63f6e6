//! Patches side by side: people of one never touch those of another, and hand over without a jump.

use std::collections::HashMap;

use glam::{DVec2, Vec2};
use rayon::prelude::*;

use super::ROUNDING;
use super::curve::Curve;
use super::distance::to_origin;
use super::patch::{chord_secs, chords_per_period};
use crate::world::{CrowdPatch, Limits};

/// A patch at its place in a world. All patches of a world share one period and one clock.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'a> {
    /// The patch.
    pub patch: &'a CrowdPatch,
    /// Where its origin is, metres.
    pub origin: Vec2,
}

/// What was found where patches meet.
#[derive(Clone, Debug, Default)]
pub struct TilesReport {
    /// Everything that is not as it must be, in words (the first hundred).
    pub violations: Vec<String>,
    /// People inside on average.
    pub people: f64,
    /// Least distance of the centres of any two people, metres; a lower bound.
    pub closest: f64,
    /// Hand-overs from patch to patch, per period.
    pub crossings: usize,
    /// Greatest jump in place at a hand-over, metres.
    pub gap: f64,
    /// Greatest jump in velocity, m/s.
    pub jump: f64,
}

impl TilesReport {
    /// Whether all is right.
    pub fn ok(&self) -> bool {
        self.violations.is_empty()
    }

    fn note(&mut self, violation: String) {
        if self.violations.len() < 100 {
            self.violations.push(violation);
        }
    }
}

/// Somebody during one chord.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    pub from: DVec2,
    pub to: DVec2,
    /// How far it may leave the line between.
    pub sag: f64,
    /// The patch it is in.
    pub tile: usize,
    /// Whether it does something there, maybe with others: who meets may touch.
    pub acts: bool,
}

/// Checks the patches of a world over a whole period, everybody against everybody near. With `torus` the world repeats
/// with that size and no border may be open. O(people x chords).
pub fn check_tiles(tiles: &[Placed], torus: Option<Vec2>, limits: &Limits) -> TilesReport {
    let mut report = TilesReport { closest: f64::INFINITY, ..TilesReport::default() };
    check_hand_overs(tiles, torus, &mut report);
    let walking = tiles.iter().find(|t| !t.patch.walkers.is_empty());
    let Some(chords) = walking.and_then(|t| chords_per_period(t.patch)) else { return report };
    let secs = walking.map_or(1.0, |t| chord_secs(t.patch));
    let curves: Vec<Vec<Curve>> =
        tiles.iter().map(|t| t.patch.walkers.iter().filter_map(|w| Curve::new(&w.path)).collect()).collect();
    let found: Vec<(usize, f64, Option<String>)> = (0..chords)
        .into_par_iter()
        .map(|chord| {
            let bodies = bodies(tiles, &curves, chord, chords, secs);
            let (least, tile) = closest(&bodies, torus, limits);
            let apart = 2.0 * f64::from(limits.radius);
            let time = chord as f64 * secs;
            let bad = least < apart - ROUNDING;
            (
                bodies.len(),
                least,
                bad.then(|| format!("people near tile {tile} come as near as {least:.3} m at {time:.2} s")),
            )
        })
        .collect();
    report.people = found.iter().map(|f| f.0 as f64).sum::<f64>() / chords as f64;
    for (_, least, violation) in found {
        report.closest = report.closest.min(least);
        violation.into_iter().for_each(|v| report.note(v));
    }
    report
}

/// Everybody inside a tile at the begin of a chord.
fn bodies(tiles: &[Placed], curves: &[Vec<Curve>], chord: i64, chords: i64, secs: f64) -> Vec<Body> {
    let mut bodies = Vec::new();
    for (tile, (placed, curves)) in tiles.iter().zip(curves).enumerate() {
        let origin = placed.origin.as_dvec2();
        for (walker, curve) in placed.patch.walkers.iter().zip(curves) {
            let (enter, leave) = placed.patch.presence(walker);
            let (first, last) = ((enter / secs).ceil() as i64, (leave / secs).ceil() as i64);
            // Chords of this phase during which it is inside: one for every lap it is about.
            let mut own = first + (chord - first).rem_euclid(chords);
            while own < last.min(curve.end()) {
                let (from, to, sag) = curve.chord(own, secs);
                bodies.push(Body { from: from + origin, to: to + origin, sag, tile, acts: false });
                own += chords;
            }
        }
    }
    bodies
}

/// Least distance of any two bodies, by cells of a metre and a bit; and the tile of one.
pub(super) fn closest(bodies: &[Body], torus: Option<Vec2>, limits: &Limits) -> (f64, usize) {
    let size = 2.0 * f64::from(limits.radius) + 2.0 * f64::from(limits.speed) * 0.1;
    let cells = torus.map(|t| (t.as_dvec2() / size).floor());
    let cell = |p: DVec2| match (torus, cells) {
        (Some(t), Some(n)) => {
            let c = (p / t.as_dvec2() * n).floor();
            ((c.x as i64).rem_euclid(n.x as i64), (c.y as i64).rem_euclid(n.y as i64))
        }
        _ => ((p.x / size).floor() as i64, (p.y / size).floor() as i64),
    };
    let mut grid: HashMap<(i64, i64), Vec<usize>> = HashMap::new();
    for (i, body) in bodies.iter().enumerate() {
        grid.entry(cell(body.from)).or_default().push(i);
    }
    let mut least = (f64::INFINITY, 0);
    for (i, a) in bodies.iter().enumerate() {
        let at = cell(a.from);
        for (dx, dz) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dz| (dx, dz))) {
            let mut next = (at.0 + dx, at.1 + dz);
            if let Some(n) = cells {
                next = (next.0.rem_euclid(n.x as i64), next.1.rem_euclid(n.y as i64));
            }
            for &j in grid.get(&next).into_iter().flatten().filter(|&&j| j > i) {
                if a.acts && bodies[j].acts && a.tile == bodies[j].tile {
                    continue;
                }
                let distance = distance(a, &bodies[j], torus);
                if distance < least.0 {
                    least = (distance, a.tile);
                }
            }
        }
    }
    least
}

fn distance(a: &Body, b: &Body, torus: Option<Vec2>) -> f64 {
    let from = b.from - a.from;
    let wrapped = torus.map_or(from, |t| from - (from / t.as_dvec2()).round() * t.as_dvec2());
    to_origin(wrapped, wrapped + (b.to - a.to) - (b.from - a.from)) - a.sag - b.sag
}

/// A crossing in the world: where, when and how fast.
#[derive(Clone, Copy, Debug)]
struct HandOver {
    place: DVec2,
    velocity: DVec2,
    time: f64,
    tile: usize,
}

/// Whoever goes out of a tile comes into another at the same place and time, just as fast.
fn check_hand_overs(tiles: &[Placed], torus: Option<Vec2>, report: &mut TilesReport) {
    let (mut outs, mut ins) = (Vec::new(), Vec::new());
    for (tile, placed) in tiles.iter().enumerate() {
        let period = f64::from(placed.patch.frame.period());
        for walker in &placed.patch.walkers {
            let (enter, leave) = placed.patch.presence(walker);
            let at = |time: f64| HandOver {
                place: walker.path.position(time).as_dvec2() + placed.origin.as_dvec2(),
                velocity: walker.path.velocity(time).as_dvec2(),
                time: time.rem_euclid(period),
                tile,
            };
            ins.push(at(enter));
            outs.push(at(leave));
        }
    }
    for out in &outs {
        let near = ins.iter().filter(|i| (i.time - out.time).abs() < 1e-4).map(|i| (gap(out, i, torus), i));
        match near.min_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((gap, input)) if gap < 0.1 => {
                report.crossings += 1;
                report.gap = report.gap.max(gap);
                report.jump = report.jump.max(out.velocity.distance(input.velocity));
            }
            _ if torus.is_some() => report
                .note(format!("nobody takes over at {:.2} at {:.3} s from tile {}", out.place, out.time, out.tile)),
            _ => {}
        }
    }
    if report.gap > 1e-3 || report.jump > 0.1 {
        report.note(format!(
            "expected gaps below 1 mm and 0.1 m/s, found {:.5} m and {:.4} m/s",
            report.gap, report.jump
        ));
    }
}

fn gap(a: &HandOver, b: &HandOver, torus: Option<Vec2>) -> f64 {
    let d = b.place - a.place;
    torus.map_or(d, |t| d - (d / t.as_dvec2()).round() * t.as_dvec2()).length()
}
