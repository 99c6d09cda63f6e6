//! The tiling P of Algorithms 1 and 2: instances, which ports are stitched and which dangle, and the one way in which
//! it grows: a new instance is stitched to matching danglings, it and the directly adjacent patches deform, all others
//! are pinned (section 5.1).

use super::super::bake::Chains;
use super::super::bridge::Port;
use super::super::domain::Domain;
use super::super::library::Library;
use super::super::occupancy::{Occupancy, PieceId};
use super::super::outcome::{Phase, Progress};
use super::super::piece::{Piece, depth};
use super::super::view::View;
use super::anneal::energy;
use super::ports::{ENTRY, EXIT, NONE, PortId, Ports, Reach};
use super::shape::{Shape, same, shapes};
use crate::geom::{Ground, wrap_angle};

/// People of one patch may come this much closer than captured, metres.
const CLOSER: f32 = 0.01;

/// A kind placed as it was captured.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    /// Index of the kind.
    pub kind: u32,
    /// Where.
    pub world_from_patch: Ground,
    /// Tick at which the patch's clock begins.
    pub clock: i32,
}

/// An instance of the tiling.
struct Instance {
    placement: Placement,
    /// A piece per role.
    pieces: Vec<PieceId>,
}

/// A stitch to be made: a port of the new instance, a dangling, and where and when they are to meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stitch {
    /// Role of the new instance.
    pub role: usize,
    /// The dangling.
    pub old: PortId,
    /// Where they meet.
    pub at: Port,
}

/// P' = P with a new instance, before anything is deformed.
#[derive(Default)]
pub(super) struct Proposal {
    placement: Option<Placement>,
    /// Entry and exit of each role.
    ends: Vec<[Port; 2]>,
    /// The new stitches.
    pub stitches: Vec<Stitch>,
    /// Ports of the new instance inside the domain's time.
    active: usize,
}

impl Proposal {
    /// By how much the numbers of connected and of dangling ports change.
    pub fn change(&self) -> (usize, isize) {
        (2 * self.stitches.len(), self.active as isize - 2 * self.stitches.len() as isize)
    }
}

/// The tiling.
pub(super) struct Patchwork<'a> {
    /// The patches.
    pub library: &'a Library<'a>,
    /// Walls and time.
    pub domain: &'a Domain,
    shapes: Vec<Shape>,
    occupancy: Occupancy,
    instances: Vec<Option<Instance>>,
    /// The port each port is stitched to, or NONE.
    partners: Vec<PortId>,
    /// N_c of equation 6.
    connected: usize,
    /// Ticks of all pieces inside the domain's time.
    filled: usize,
    ports: Ports,
}

impl<'a> Patchwork<'a> {
    /// An empty tiling.
    pub fn new(library: &'a Library<'a>, domain: &'a Domain) -> Self {
        Self {
            library,
            domain,
            shapes: shapes(library),
            occupancy: Occupancy::new(domain, library),
            instances: vec![],
            partners: vec![],
            connected: 0,
            filled: 0,
            ports: Ports::new(domain, library.set.groups.len()),
        }
    }

    fn view(&self) -> View<'_> {
        View::new(self.library, self.domain, &self.occupancy)
    }

    /// N_c of equation 6.
    pub fn connected(&self) -> usize {
        self.connected
    }

    /// N_d of equation 6, N(P) of Algorithm 2.
    pub fn dangling(&self) -> usize {
        self.ports.len()
    }

    /// Ticks of people placed so far.
    pub fn filled(&self) -> usize {
        self.filled
    }

    /// The set D of Algorithm 2.
    pub fn danglings(&self) -> Vec<PortId> {
        self.ports.iter().collect()
    }

    /// True if the port is in D now.
    pub fn dangles(&self, id: PortId) -> bool {
        let live = self.instances.get(self.instance_of_dead_or_live(id)).is_some_and(Option::is_some);
        live && self.partners[id as usize] == NONE && self.is_active(self.port(id).tick)
    }

    fn instance_of_dead_or_live(&self, id: PortId) -> usize {
        self.occupancy.get(id / 2).map_or(usize::MAX, |p| p.instance as usize)
    }

    /// Index of the instance a port belongs to.
    pub fn instance_of(&self, id: PortId) -> u32 {
        self.occupancy.piece(id / 2).instance
    }

    /// Where a live instance was placed.
    pub fn placement(&self, instance: u32) -> Option<Placement> {
        Some(self.instances[instance as usize].as_ref()?.placement)
    }

    /// State of a port.
    pub fn port(&self, id: PortId) -> Port {
        let piece = self.occupancy.piece(id / 2);
        let role = &self.library.roles[piece.role as usize];
        if id % 2 == ENTRY {
            Port { at: piece.entry(), tick: piece.begin, group: role.entry_group }
        } else {
            Port { at: piece.exit(), tick: piece.end, group: role.exit_group }
        }
    }

    /// A port outside the domain's time never dangles.
    fn is_active(&self, tick: i32) -> bool {
        0 < tick && tick < self.domain.horizon
    }

    /// P' for a placement: the rigid ports, and the danglings within reach that they are to be stitched to.
    pub fn propose(&self, placement: Placement, reach: &Reach, proposal: &mut Proposal) {
        proposal.placement = Some(placement);
        proposal.ends.clear();
        proposal.stitches.clear();
        proposal.active = 0;
        for (index, role_id) in self.library.roles_of(placement.kind).enumerate() {
            let role = &self.library.roles[role_id as usize];
            let entry = placement.world_from_patch.then(role.entry);
            let begin = placement.clock + role.begin;
            let mut ends = [
                Port { at: entry, tick: begin, group: role.entry_group },
                Port { at: entry.then(role.exit), tick: begin + role.ticks, group: role.exit_group },
            ];
            for side in [ENTRY, EXIT] {
                let own = ends[side as usize];
                if !self.is_active(own.tick) {
                    continue;
                }
                proposal.active += 1;
                if let Some((old, at)) = self.partner(role_id, side, &own, reach, &proposal.stitches) {
                    ends[side as usize] = at;
                    proposal.stitches.push(Stitch { role: index, old, at });
                }
            }
            proposal.ends.push(ends);
        }
    }

    /// The nearest dangling that a new port can be stitched to, and where they meet.
    fn partner(&self, role: u32, side: u32, own: &Port, reach: &Reach, taken: &[Stitch]) -> Option<(PortId, Port)> {
        let mut best: Option<(f32, PortId, Port)> = None;
        self.ports.near(1 - side, own, reach, |old| {
            let theirs = self.port(old);
            let Some(distance) = reach.distance(own, &theirs) else { return };
            let nearer = best.is_none_or(|(d, id, _)| (distance, old) < (d, id));
            if nearer
                && taken.iter().all(|s| s.old != old)
                && let Some(at) = self.meeting(role, side, own, old, &theirs)
            {
                best = Some((distance, old, at));
            }
        });
        best.map(|(_, old, at)| (old, at))
    }

    /// Equations 1 to 3: where a new port and a dangling meet. The midpoint if both patches can be deformed, else
    /// where the one that cannot is.
    fn meeting(&self, role: u32, side: u32, own: &Port, old: PortId, theirs: &Port) -> Option<Port> {
        let old_role = self.occupancy.piece(old / 2).role;
        let bends = (self.shapes[role as usize].bends(side), self.shapes[old_role as usize].bends(old % 2));
        let at = if same(own.at, theirs.at) {
            theirs.at
        } else {
            match bends {
                (true, true) => midpoint(own.at, theirs.at),
                (true, false) => theirs.at,
                (false, true) => own.at,
                (false, false) => return None,
            }
        };
        let tick = match (self.is_single(role), self.is_single(old_role)) {
            _ if own.tick == theirs.tick => own.tick,
            (true, true) => (own.tick + theirs.tick).div_euclid(2),
            (true, false) => theirs.tick,
            (false, true) => own.tick,
            (false, false) => return None,
        };
        // An end moved out of the domain's time would no longer be stitched to anything.
        self.is_active(tick).then_some(Port { at, tick, group: own.group })
    }

    fn is_single(&self, role: u32) -> bool {
        self.library.set.kinds[self.library.roles[role as usize].kind as usize].people() == 1
    }

    /// IsValid and NoCollision, and if both hold P := P'. Otherwise nothing has changed, and the answer is false.
    pub fn try_insert(&mut self, proposal: &Proposal) -> bool {
        let Some(new) = self.new_pieces(proposal) else { return false };
        let Some(changed) = self.adjacent_pieces(proposal) else { return false };
        changed.iter().for_each(|(id, _)| self.occupancy.hide(*id));
        let clear = |p: &Piece| self.view().is_free(p);
        if !new.iter().all(clear) || !changed.iter().all(|(_, p)| clear(p)) {
            changed.iter().for_each(|(id, _)| self.occupancy.show(*id));
            return false;
        }
        // Each is clear of all that stay; now against each other.
        let mut done: Vec<(PieceId, Option<Piece>)> = Vec::new();
        let old = changed.iter().map(|(id, _)| *id).collect::<Vec<_>>();
        let mut fits = true;
        for (id, piece) in changed.into_iter().map(|(id, p)| (Some(id), p)).chain(new.into_iter().map(|p| (None, p))) {
            if !self.view().is_free(&piece) {
                fits = false;
                break;
            }
            done.push(match id {
                Some(id) => (id, Some(self.occupancy.replace(id, piece))),
                None => (self.occupancy.insert(piece), None),
            });
        }
        let fits = fits && self.keeps_distance(proposal, &done);
        if fits {
            self.commit(proposal, &done);
        } else {
            self.roll_back(&old, done);
        }
        fits
    }

    fn new_pieces(&self, proposal: &Proposal) -> Option<Vec<Piece>> {
        let placement = proposal.placement?;
        let instance = self.instances.len() as u32;
        self.library
            .roles_of(placement.kind)
            .zip(&proposal.ends)
            .map(|(role, ends)| self.deformed(role, instance, placement, ends))
            .collect()
    }

    /// The pieces at the other side of the stitches, deformed. A piece may be stitched at both ends.
    fn adjacent_pieces(&self, proposal: &Proposal) -> Option<Vec<(PieceId, Piece)>> {
        let mut ends: Vec<(PieceId, [Port; 2])> = Vec::new();
        for stitch in &proposal.stitches {
            let id = stitch.old / 2;
            let at = ends.iter().position(|e| e.0 == id).unwrap_or_else(|| {
                ends.push((id, [self.port(2 * id + ENTRY), self.port(2 * id + EXIT)]));
                ends.len() - 1
            });
            let end = &mut ends[at].1[(stitch.old % 2) as usize];
            if !same(end.at, stitch.at.at) {
                end.at = stitch.at.at;
            }
            end.tick = stitch.at.tick;
        }
        let unmoved = |id: PieceId, e: &[Port; 2]| [self.port(2 * id + ENTRY), self.port(2 * id + EXIT)] == *e;
        ends.into_iter()
            .filter(|(id, e)| !unmoved(*id, e))
            .map(|(id, e)| {
                let piece = self.occupancy.piece(id);
                let placement = self.instances[piece.instance as usize].as_ref()?.placement;
                Some((id, self.deformed(piece.role, piece.instance, placement, &e)?))
            })
            .collect()
    }

    /// A role between two ends, `None` if a limit is broken.
    fn deformed(&self, role_id: u32, instance: u32, placement: Placement, ends: &[Port; 2]) -> Option<Piece> {
        let role = &self.library.roles[role_id as usize];
        let (begin, end) = (ends[0].tick, ends[1].tick);
        let (fewest, most) = role.tick_range;
        if end - begin < fewest || end - begin > most {
            return None;
        }
        let rest = placement.world_from_patch.then(role.entry);
        let grounds = [ends[0].at, ends[1].at];
        let path = self.shapes[role_id as usize].deform(role, rest, grounds, &self.library.limits)?;
        if self.library.is_hurried(role_id, &path, end - begin) {
            return None;
        }
        Some(Piece::along(self.library, self.domain, role_id, instance, path, begin, end))
    }

    /// True if no two people of one patch came closer than captured by the deformation of their legs.
    fn keeps_distance(&self, proposal: &Proposal, done: &[(PieceId, Option<Piece>)]) -> bool {
        done.iter().all(|&(id, _)| {
            let piece = self.occupancy.piece(id);
            if self.is_single(piece.role) {
                return true;
            }
            let known = self.instances.get(piece.instance as usize).and_then(Option::as_ref);
            let placement = known.map(|i| i.placement).or(proposal.placement);
            let others: Vec<PieceId> = match known {
                Some(instance) => instance.pieces.clone(),
                None => done.iter().filter(|d| d.1.is_none()).map(|d| d.0).collect(),
            };
            placement.is_some_and(|p| others.iter().all(|&other| other == id || self.is_no_closer(p, id, other)))
        })
    }

    fn is_no_closer(&self, placement: Placement, a: PieceId, b: PieceId) -> bool {
        let (a, b) = (self.occupancy.piece(a), self.occupancy.piece(b));
        let rest = |p: &Piece| {
            let entry = placement.world_from_patch.then(self.library.roles[p.role as usize].entry);
            Piece::rigid(self.library, self.domain, p.role, p.instance, entry, p.begin)
        };
        let captured = (rest(a), rest(b));
        (a.begin.max(b.begin)..a.end.min(b.end)).all(|tick| {
            depth(self.library, a, b, tick).is_none_or(|now| {
                let then = depth(self.library, &captured.0, &captured.1, tick).unwrap_or(0.0);
                now <= then + CLOSER
            })
        })
    }

    fn commit(&mut self, proposal: &Proposal, done: &[(PieceId, Option<Piece>)]) {
        let pieces: Vec<PieceId> = done.iter().filter(|d| d.1.is_none()).map(|d| d.0).collect();
        for &id in &pieces {
            let needed = 2 * id as usize + 2;
            if self.partners.len() < needed {
                self.partners.resize(needed, NONE);
            }
            for side in [ENTRY, EXIT] {
                self.partners[(2 * id + side) as usize] = NONE;
            }
        }
        for (id, before) in done {
            let gone = before.as_ref().map_or(0, Piece::ticks_inside);
            self.filled = self.filled + self.occupancy.piece(*id).ticks_inside() - gone;
        }
        for stitch in &proposal.stitches {
            let own = 2 * pieces[stitch.role] + (1 - stitch.old % 2);
            // The table knows the dangling by where it was before it was deformed.
            let before = done.iter().find(|d| d.0 == stitch.old / 2).and_then(|d| d.1.as_ref());
            let port = self.port(stitch.old);
            let was = before.map_or(port, |p| {
                let (at, tick) = if stitch.old % 2 == ENTRY { (p.entry(), p.begin) } else { (p.exit(), p.end) };
                Port { at, tick, ..port }
            });
            self.ports.remove(stitch.old, &was);
            self.partners[own as usize] = stitch.old;
            self.partners[stitch.old as usize] = own;
            self.connected += 2;
        }
        for id in pieces.iter().flat_map(|&p| [2 * p + ENTRY, 2 * p + EXIT]) {
            let port = self.port(id);
            if self.partners[id as usize] == NONE && self.is_active(port.tick) {
                self.ports.insert(id, &port);
            }
        }
        self.instances.push(proposal.placement.map(|placement| Instance { placement, pieces }));
    }

    fn roll_back(&mut self, changed: &[PieceId], done: Vec<(PieceId, Option<Piece>)>) {
        let replaced: Vec<PieceId> = done.iter().filter(|d| d.1.is_some()).map(|d| d.0).collect();
        for (id, before) in done.into_iter().rev() {
            self.occupancy.hide(id);
            match before {
                Some(piece) => drop(self.occupancy.replace(id, piece)),
                None => self.occupancy.forget(id),
            }
        }
        changed.iter().filter(|id| !replaced.contains(id)).for_each(|&id| self.occupancy.show(id));
    }

    /// P := P \ instance; its neighbours' ports dangle.
    pub fn remove(&mut self, instance: u32) {
        let Some(Instance { pieces, .. }) = self.instances[instance as usize].take() else { return };
        for id in pieces.iter().flat_map(|&p| [2 * p + ENTRY, 2 * p + EXIT]) {
            let port = self.port(id);
            match std::mem::replace(&mut self.partners[id as usize], NONE) {
                NONE if self.is_active(port.tick) => self.ports.remove(id, &port),
                NONE => {}
                partner => {
                    self.partners[partner as usize] = NONE;
                    self.connected -= 2;
                    let theirs = self.port(partner);
                    self.ports.insert(partner, &theirs);
                }
            }
        }
        for id in pieces {
            self.filled -= self.occupancy.piece(id).ticks_inside();
            self.occupancy.hide(id);
            self.occupancy.forget(id);
        }
    }

    /// The people: chains of stitched pieces, those that are seen within the domain's time.
    pub fn characters(&self) -> Vec<Vec<PieceId>> {
        let pieces = self.instances.iter().flatten().flat_map(|i| &i.pieces);
        let first = pieces.filter(|&&id| self.partners[(2 * id + ENTRY) as usize] == NONE);
        let chain = |&id: &PieceId| {
            std::iter::successors(Some(id), |&id| match self.partners[(2 * id + EXIT) as usize] {
                NONE => None,
                next => Some(next / 2),
            })
            .collect::<Vec<_>>()
        };
        let seen = |id: &PieceId| self.occupancy.piece(*id).ticks_inside() > 0;
        first.map(chain).filter(|chain| chain.iter().any(seen)).collect()
    }

    /// The people as baking wants them.
    pub fn chains<'s>(&'s self, lists: &'s [Vec<PieceId>]) -> Chains<'s> {
        Chains { library: self.library, domain: self.domain, occupancy: &self.occupancy, lists }
    }

    /// How far the run is.
    pub fn state(&self, phase: Phase) -> Progress {
        let characters = self.characters();
        Progress {
            phase,
            patches: self.instances.iter().flatten().count(),
            characters: characters.len(),
            danglings: self.dangling(),
            multi_person_share: self.chains(&characters).multi_person_share(),
            energy: energy(self.connected, self.dangling()),
            secs: 0.0,
        }
    }
}

fn midpoint(a: Ground, b: Ground) -> Ground {
    Ground::new((a.position + b.position) * 0.5, b.heading + wrap_angle(a.heading - b.heading) * 0.5)
}

#[cfg(test)]
#[path = "patchwork_tests.rs"]
mod tests;
