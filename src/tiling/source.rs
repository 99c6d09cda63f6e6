//! Sources and sinks: people come in at gates while the scene lasts, and go out at others.
//!
//! Their tracks begin or end at ports, like bridges do, so that nothing else needs to know. Who would reach a sink only
//! after the end of time is on the way there when it comes.

use glam::Vec2;
use rand::{Rng, RngExt};
use rand_chacha::ChaCha8Rng;

use super::bridge::{Goal, Port, Taste};
use super::domain::Spot;
use super::draft::Draft;
use super::library::Library;
use super::occupancy::PieceId;
use super::piece::Company;
use super::scene::Scene;
use super::tryout::is_clean;
use crate::geom::{Gate, Ground};
use crate::motion::FPS;

/// Farthest from a gate that somebody comes in or goes out, metres: gates mostly lie on borders, bodies inside.
const REACH: f32 = 0.7;
/// Room that somebody at a gate must have to walls, metres.
const ROOM: f32 = 0.4;
/// Places at a gate that are tried, the nearest first.
const PLACES: usize = 60;
/// Ways in that are tried for one person in a round.
const WAYS_IN: usize = 6;
/// Speed on the way to a sink, m/s, and time for detours, seconds.
const PACE: [f32; 2] = [0.85, 1.1];
const DETOUR: [f32; 2] = [0.8, 2.5];
/// States expanded at least on the way to a sink.
const EXPANSIONS: usize = 500;
/// A pose group whose people go faster than this at their ports, m/s, is one of people on the move.
const MOVING: f32 = 0.5;

/// A gate and the pose groups of its ports.
pub(super) struct Way {
    gate: Gate,
    groups: Vec<u32>,
    team: Option<usize>,
}

/// All sources and sinks of a scene.
#[derive(Default)]
pub(super) struct Gates {
    sources: Vec<Way>,
    sinks: Vec<Way>,
}

impl Gates {
    /// Those of a scene. At a gate without a group people are on the move with empty hands, if the set has such.
    pub fn new(scene: &Scene, library: &Library) -> Self {
        let team = |name: &Option<String>| scene.teams.iter().position(|t| Some(&t.name) == name.as_ref());
        let source = |s: &super::Source| Way {
            groups: groups(library, &s.gate, |g| !library.forward[g].is_empty()),
            gate: s.gate.clone(),
            team: team(&s.team),
        };
        let sink = |s: &super::Sink| Way {
            groups: groups(library, &s.gate, |g| !library.backward[g].is_empty()),
            gate: s.gate.clone(),
            team: None,
        };
        Self { sources: scene.sources.iter().map(source).collect(), sinks: scene.sinks.iter().map(sink).collect() }
    }

    /// The team of those who come in at a place, if any.
    pub fn team_at(&self, place: Vec2) -> Option<usize> {
        self.sources.iter().find(|w| w.team.is_some() && w.gate.distance(place) <= REACH).and_then(|w| w.team)
    }
}

/// The pose groups of a gate's ports.
fn groups(library: &Library, gate: &Gate, leads_on: impl Fn(usize) -> bool) -> Vec<u32> {
    let all = || (0..library.set.groups.len()).filter(|&g| leads_on(g));
    if let Some(name) = &gate.group {
        return all().filter(|&g| library.set.groups[g].name == *name).map(|g| g as u32).collect();
    }
    let empty: Vec<usize> = all().filter(|&g| !library.laden[g]).collect();
    let moving: Vec<usize> = empty.iter().copied().filter(|&g| speed_at(library, g) > MOVING).collect();
    let chosen = if moving.is_empty() { empty } else { moving };
    chosen.into_iter().map(|g| g as u32).collect()
}

/// How fast people go at a pose group's ports on average, m/s.
fn speed_at(library: &Library, group: usize) -> f32 {
    let first = |role: u32| library.roles[role as usize].path.points.windows(2).next().map(|w| w[0].distance(w[1]));
    let speeds: Vec<f32> = library.forward[group].iter().filter_map(|m| first(m.role)).collect();
    speeds.iter().sum::<f32>() * FPS / speeds.len().max(1) as f32
}

/// A port at a gate at a tick.
fn port(draft: &Draft, way: &Way, tick: i32, rng: &mut ChaCha8Rng) -> Option<Port> {
    let Way { gate, groups, .. } = way;
    let group = *groups.get(rng.next_u32() as usize % groups.len().max(1))?;
    (0..PLACES).find_map(|i| {
        let farthest = REACH * i as f32 / PLACES as f32;
        let aside = Vec2::new(rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0)).clamp_length_max(1.0);
        let position = gate.from.lerp(gate.to, rng.random_range(0.0..1.0)) + aside * farthest;
        let heading = gate.heading.unwrap_or(0.0)
            + gate.heading.map_or(std::f32::consts::PI, |_| gate.spread) * rng.random_range(-1.0..1.0);
        let near = gate.distance(position) <= REACH && draft.base.domain.holds(Spot::ground(tick), position, ROOM);
        near.then(|| Port { at: Ground::new(position, heading), tick, group })
    })
}

/// Where somebody goes from a port on: out at a sink if there are such, else to the end of time.
pub(super) fn way_out(draft: &Draft, from: Port, rng: &mut ChaCha8Rng) -> Goal {
    let (sinks, horizon) = (&draft.base.library.gates.sinks, draft.base.domain.horizon);
    if sinks.is_empty() {
        return Goal::Until(horizon);
    }
    let sink = &sinks[rng.random_range(0..sinks.len())];
    let distance = sink.gate.distance(from.at.position);
    let secs = distance / rng.random_range(PACE[0]..PACE[1]) + rng.random_range(DETOUR[0]..DETOUR[1]);
    let port = port(draft, sink, from.tick + (secs * FPS) as i32, rng);
    port.map_or(Goal::Until(horizon), Goal::Port)
}

/// Leads somebody from a port to where they go.
pub(super) fn lead_out(
    draft: &mut Draft,
    from: Port,
    company: Company,
    taste: Taste,
    rng: &mut ChaCha8Rng,
) -> Option<Vec<PieceId>> {
    let goal = way_out(draft, from, rng);
    draft.search(from, goal, company, with_patience(taste, goal), rng)
}

/// A way to a certain place takes a longer search than one to anywhere.
pub(super) fn with_patience(taste: Taste, goal: Goal) -> Taste {
    let least = if matches!(goal, Goal::Port(_)) { EXPANSIONS } else { 0 };
    Taste { expansions: taste.expansions.max(least), ..taste }
}

/// Who comes in: the source and when, in order of the sources and of time.
pub(super) fn arrivals(scene: &Scene) -> Vec<(usize, i32)> {
    let of = |(i, s): (usize, &super::Source)| {
        let tick = |&secs: &f32| (i, (secs * FPS).round() as i32);
        s.times.iter().map(tick).collect::<Vec<_>>()
    };
    scene.sources.iter().enumerate().flat_map(of).filter(|a| a.1 < scene.last_frame()).collect()
}

/// Lets somebody in at a source at a tick.
pub(super) fn let_in(
    draft: &mut Draft,
    (source, tick): (usize, i32),
    taste: Taste,
    rng: &mut ChaCha8Rng,
) -> Option<()> {
    (0..WAYS_IN).find_map(|_| {
        draft.restart();
        let library = draft.base.library;
        let from = port(draft, &library.gates.sources[source], tick, rng)?;
        let pieces = lead_out(draft, from, Company::NONE, taste, rng)?;
        draft.push_track(pieces);
        is_clean(draft).then_some(())
    })
}
