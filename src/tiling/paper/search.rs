//! Algorithm 2: deterministic search and jittering that removes danglings (section 5.2). Line numbers are the paper's.

use std::collections::HashSet;

use glam::Vec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::super::bridge::Port;
use super::super::clock::Clock;
use super::super::outcome::Phase;
use super::patchwork::{Patchwork, Placement, Proposal};
use super::ports::{EXIT, PortId, Reach};
use super::prefer::Preference;
use crate::geom::{Ground, wrap_angle};

/// Jitters per candidate: i_max, which the paper does not state.
const I_MAX: usize = 12;

/// Where a removed patch was, coarsely: kind, x and z in 0.25 m, heading in 20 degrees, clock in 5 ticks.
type Place = (u32, i32, i32, i32, i32);

/// The search with its history of removed patches.
pub(super) struct Search<'a> {
    preference: Preference<'a>,
    removed: HashSet<Place>,
    proposal: Proposal,
}

impl<'a> Search<'a> {
    /// Nothing removed yet.
    pub fn new(preference: Preference<'a>) -> Self {
        Self { preference, removed: HashSet::new(), proposal: Proposal::default() }
    }

    /// Algorithm 2, until no port dangles or time is up.
    pub fn close(&mut self, tiling: &mut Patchwork, clock: &mut Clock, rng: &mut ChaCha8Rng) {
        while tiling.dangling() > 0 {
            // 1
            for d in tiling.danglings() {
                // 2
                if !clock.goes_on(|| tiling.state(Phase::Close)) {
                    return;
                }
                if tiling.dangles(d) && !self.resolve(tiling, d, rng) {
                    // 20
                    let instance = tiling.instance_of(d);
                    self.discard(tiling, instance); // 21
                }
            }
        }
    }

    /// Removes a patch and keeps in mind that it was there.
    pub fn discard(&mut self, tiling: &mut Patchwork, instance: u32) {
        if let Some(placement) = tiling.placement(instance) {
            self.removed.insert(place(&placement));
            tiling.remove(instance);
        }
    }

    /// Lines 3 to 19 for one dangling; true if it is resolved.
    fn resolve(&mut self, tiling: &mut Patchwork, d: PortId, rng: &mut ChaCha8Rng) -> bool {
        let port = tiling.port(d);
        for candidate in self.candidates(tiling, d, &port, rng) {
            // 3
            if self.fit(tiling, d, &port, candidate, rng) {
                return true; // 16, 17
            }
        }
        false
    }

    /// Every kind that has a port matching d, placed so that the two coincide, but for those removed from there. Those
    /// that leave fewer danglings come first, then the preferred ones.
    fn candidates(&mut self, tiling: &Patchwork, d: PortId, port: &Port, rng: &mut ChaCha8Rng) -> Vec<Placement> {
        let mut found: Vec<(isize, f32, Placement)> = Vec::new();
        for role in &tiling.library.roles {
            let (entry, begin, group) = match d % 2 {
                EXIT => (port.at, port.tick, role.entry_group),
                _ => (port.at.then(role.exit.inverse()), port.tick - role.ticks, role.exit_group),
            };
            if group != port.group || !self.preference.wants(role.kind) {
                continue;
            }
            let world_from_patch = entry.then(role.entry.inverse());
            let placement = Placement { kind: role.kind, world_from_patch, clock: begin - role.begin };
            if self.removed.contains(&place(&placement)) {
                continue;
            }
            tiling.propose(placement, &Reach::FIRST, &mut self.proposal); // 4
            let change = self.proposal.change().1;
            if change <= 0 && self.proposal.stitches.iter().any(|s| s.old == d) {
                // 5
                found.push((change, self.preference.rank(&placement, rng), placement));
            }
        }
        found.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        found.into_iter().map(|f| f.2).collect()
    }

    /// Lines 4 to 15: the candidate as it is, then jittered in growing ranges; true if it was put in.
    fn fit(
        &mut self,
        tiling: &mut Patchwork,
        d: PortId,
        port: &Port,
        candidate: Placement,
        rng: &mut ChaCha8Rng,
    ) -> bool {
        for i in 0..=I_MAX {
            // 6, 7, 13
            let reach = Reach::grown(i.saturating_sub(1) as f32 / (I_MAX - 1) as f32);
            let placement = if i == 0 { candidate } else { jitter(candidate, port, &reach, rng) }; // 12
            tiling.propose(placement, &reach, &mut self.proposal);
            let resolves = self.proposal.stitches.iter().any(|s| s.old == d);
            if resolves && self.proposal.change().1 <= 0 && tiling.try_insert(&self.proposal) {
                return true; // 8, 9, 10
            }
        }
        false
    }
}

/// The placement turned about the port, moved and shifted in time at random within `range`.
fn jitter(placement: Placement, port: &Port, range: &Reach, rng: &mut ChaCha8Rng) -> Placement {
    let angle = rng.random_range(-std::f32::consts::PI..std::f32::consts::PI);
    let distance = range.place * rng.random_range(0.0_f32..1.0).sqrt();
    let turn = Ground::new(Vec2::ZERO, rng.random_range(-range.heading..range.heading));
    let pivot = Ground::new(port.at.position, 0.0);
    let moved = Ground::new(Vec2::new(angle.sin(), angle.cos()) * distance, 0.0).then(pivot);
    Placement {
        world_from_patch: moved.then(turn).then(pivot.inverse()).then(placement.world_from_patch),
        clock: placement.clock + rng.random_range(-range.ticks..=range.ticks).round() as i32,
        ..placement
    }
}

fn place(p: &Placement) -> Place {
    let at = p.world_from_patch;
    let (x, z) = (at.position.x / 0.25, at.position.y / 0.25);
    let heading = wrap_angle(at.heading).to_degrees() / 20.0;
    (p.kind, x.round() as i32, z.round() as i32, heading.round() as i32, p.clock.div_euclid(5))
}
