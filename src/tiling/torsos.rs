//! Bodies that touch without hands: people whose torsos meet must still meet when they have builds of their own.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use glam::Vec3;

use super::bake::Chains;
use super::piece::Piece;
use crate::geom::Capsule;
use crate::motion::{BodyPart, Skeleton, joint};
use crate::patch::Contact;
use crate::refine::Body;

/// Torsos may be this much farther apart than with canonical bodies, metres.
const APART: f32 = 0.012;

/// Two people whose torsos touch, and over which ticks.
pub(super) struct Meeting {
    /// The people.
    pub people: [usize; 2],
    ticks: RangeInclusive<i32>,
}

/// All meetings of torsos of a crowd, in order of instances. O(pieces).
pub(super) fn meetings(chains: Chains) -> Vec<Meeting> {
    let mut players: BTreeMap<u32, Vec<(usize, &Piece)>> = BTreeMap::new();
    for person in 0..chains.lists.len() {
        for piece in chains.pieces(person).filter(|p| chains.people_of(p) > 1) {
            players.entry(piece.instance).or_default().push((person, piece));
        }
    }
    players.values().flat_map(|players| of_instance(chains, players)).collect()
}

fn of_instance(chains: Chains, players: &[(usize, &Piece)]) -> Vec<Meeting> {
    let library = chains.library;
    let kind = &library.set.kinds[library.roles[players[0].1.role as usize].kind as usize];
    let torsos = kind.contacts.iter().filter(|c| [c.a.part, c.b.part] == [BodyPart::Torso; 2]);
    let meeting = |c: &Contact| {
        let player = |role: u32| players.iter().find(|p| library.roles[p.1.role as usize].role == role);
        let (a, b) = (player(c.a.role)?, player(c.b.role)?);
        // Patches of several people are not warped in time.
        let tick = |clock: u32| a.1.begin + clock as i32 - library.roles[a.1.role as usize].begin;
        Some(Meeting { people: [a.0, b.0], ticks: tick(c.begin)..=tick(c.end) })
    };
    torsos.filter_map(meeting).collect()
}

impl Meeting {
    /// True if two worn bodies are farther apart than the canonical ones are.
    pub fn is_missed(&self, worn: [(&Body, &Skeleton); 2], canonical: [(&Body, &Skeleton); 2]) -> bool {
        let gap = |[a, b]: [(&Body, &Skeleton); 2], tick: i32| Some(distance(&spine(a, tick)?, &spine(b, tick)?));
        self.ticks.clone().any(|tick| match (gap(worn, tick), gap(canonical, tick)) {
            (Some(worn), Some(canonical)) => worn > canonical + APART,
            _ => false,
        })
    }
}

fn spine((body, bones): (&Body, &Skeleton), tick: i32) -> Option<Capsule> {
    let frame = super::figure::frame_at(body, tick)?;
    let mut globals = Vec::new();
    bones.globals(body.root[frame], body.pose(frame), &mut globals);
    Some(Capsule { a: globals[joint::SPINE].0, b: globals[joint::NECK].0, radius: 0.0 })
}

/// Least distance between two axes, to the nearest half centimetre or so: points along both are compared.
fn distance(a: &Capsule, b: &Capsule) -> f32 {
    const POINTS: usize = 12;
    let points = |c: &Capsule| -> Vec<Vec3> { (0..=POINTS).map(|i| c.a.lerp(c.b, i as f32 / POINTS as f32)).collect() };
    let (p, q) = (points(a), points(b));
    p.iter().flat_map(|x| q.iter().map(move |y| x.distance(*y))).fold(f32::INFINITY, f32::min)
}
