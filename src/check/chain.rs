//! Clause 1: everybody present begins at the first frame or earlier, or later at a source, and ends at the last or later,
//! or earlier at a sink (time is cropped, space is closed), chains stitch like to like, and every role of every patch has its one player.

use super::part::Part;
use super::report::{Faults, Row};
use crate::geom::{Gate, Ground};
use crate::motion::JOINT_COUNT;
use crate::stage::{Character, Crowd, DomainInfo, FragmentUse, Holding, Prop};

/// Farthest from a source or a sink that somebody comes in or goes out, metres: bodies must be inside of the border.
const GATE_REACH: f32 = 0.75;
/// Headings may be beyond a gate's spread by this much, radians: rounding.
const GATE_TURN: f32 = 0.01;

/// More than a year of motion; keeps the arithmetic of frames far from overflow.
const LAST_FRAME: u32 = 1 << 30;

/// Everything the other clauses index by exists and the arrays agree in length.
pub(super) fn references(crowd: &Crowd) -> Row {
    let mut faults = Faults::default();
    for problem in crowd.set.validate() {
        faults.add(|| problem.to_string());
    }
    for kind in &crowd.set.kinds {
        for (role, f) in kind.fragments.iter().enumerate() {
            let n = f.motion.len();
            let sizes = (f.motion.path.headings.len(), f.motion.heights.len(), f.motion.rotations.len());
            if sizes != (n, n, n * JOINT_COUNT) {
                faults.add(|| format!("kind {}, role {role}: its arrays differ in length", kind.name));
            }
        }
    }
    if crowd.domain.last_frame > LAST_FRAME {
        faults
            .add(|| format!("domain: expected at most {LAST_FRAME} as last frame, found {}", crowd.domain.last_frame));
    }
    for (i, instance) in crowd.instances.iter().enumerate() {
        if instance.kind as usize >= crowd.set.kinds.len() {
            faults.add(|| format!("instance {i}: kind {} does not exist", instance.kind));
        }
    }
    for (c, character) in crowd.characters.iter().enumerate() {
        if character.rotations.len() != character.frames() * JOINT_COUNT {
            faults.add(|| format!("character {c}: {} rotations", character.rotations.len()));
        }
        let finite = character.root.iter().all(|p| p.is_finite())
            && character.rotations.iter().all(|q| q.is_finite())
            && character
                .fragments
                .iter()
                .all(|f| f.points.iter().all(|p| p.is_finite()) && f.headings.iter().all(|h| h.is_finite()));
        if !finite {
            faults.add(|| format!("character {c}: a number that is not finite"));
        }
        for k in (0..character.fragments.len()).filter(|&k| !fragment_is_sound(crowd, character, k)) {
            faults.add(|| format!("character {c}, fragment {k}: no such role, or not as long as the capture"));
        }
    }
    for (i, prop) in crowd.props.iter().enumerate().filter(|(_, p)| !prop_is_sound(crowd, p)) {
        let frames = prop.places.len();
        faults.add(|| {
            format!("box {i}: held by nobody who exists, or without size, or its {frames} frames are not places")
        });
    }
    faults.row(0, "references")
}

fn prop_is_sound(crowd: &Crowd, prop: &Prop) -> bool {
    let within = |h: &Holding| h.begin <= h.end && prop.begin <= h.begin && h.end <= prop.end();
    !prop.places.is_empty()
        && prop.begin <= LAST_FRAME
        && prop.size.iter().all(|&s| s > 0.0 && s.is_finite())
        && prop.places.iter().all(|p| p.middle.is_finite() && p.heading.is_finite())
        && prop.holds.iter().all(|h| (h.character as usize) < crowd.characters.len() && within(h))
}

fn fragment_is_sound(crowd: &Crowd, character: &Character, k: usize) -> bool {
    let used = &character.fragments[k];
    let kind = crowd.instances.get(used.instance as usize).and_then(|i| crowd.set.kinds.get(i.kind as usize));
    kind.and_then(|kind| kind.fragments.get(used.role as usize)).is_some_and(|source| {
        let n = source.motion.len();
        n >= 2 && used.points.len() == n && used.headings.len() == n && used.begin < used.end
    })
}

/// The rows of clause 1.
pub(super) fn rows(crowd: &Crowd, parts: &[Part]) -> Vec<Row> {
    vec![
        danglings(crowd).row(1, "dangling ports"),
        unlike_stitches(parts).row(1, "stitches of unlike poses"),
        miscast_roles(crowd, parts).row(1, "roles missing or doubled"),
        motion_spans(crowd).row(1, "characters whose motion does not span their chain"),
    ]
}

/// Entries after the first frame but at a source, and exits before the last but at a sink.
pub(super) fn danglings(crowd: &Crowd) -> Faults {
    let mut faults = Faults::default();
    let DomainInfo { sources, sinks, .. } = &crowd.domain;
    for (c, character) in crowd.characters.iter().enumerate() {
        match (character.fragments.first(), character.fragments.last()) {
            (Some(first), Some(last)) => {
                if first.begin > 0 && !is_at(crowd, sources, first, Side::Entry) {
                    faults.add(|| format!("character {c}: entry at frame {}", first.begin));
                }
                if last.end < crowd.domain.last_frame as i32 && !is_at(crowd, sinks, last, Side::Exit) {
                    faults.add(|| format!("character {c}: exit at frame {}", last.end));
                }
            }
            _ => faults.add(|| format!("character {c}: no fragment")),
        }
    }
    faults
}

/// An end of a fragment.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Entry,
    Exit,
}

/// True if an end of a fragment is at one of some gates, looks as people there look and is in their pose.
fn is_at(crowd: &Crowd, gates: &[Gate], used: &FragmentUse, side: Side) -> bool {
    let kind = crowd.instances.get(used.instance as usize).and_then(|i| crowd.set.kinds.get(i.kind as usize));
    let Some(source) = kind.and_then(|kind| kind.fragments.get(used.role as usize)) else { return false };
    let (sample, group) = match side {
        Side::Entry => (0, source.entry_group),
        Side::Exit => (used.points.len() - 1, source.exit_group),
    };
    let at = Ground::new(used.points[sample], used.headings[sample]);
    let pose = crowd.set.groups.get(group as usize).map(|g| &g.name);
    let fits = |gate: &Gate| {
        gate.distance(at.position) <= GATE_REACH
            && gate.turned_away(at) <= GATE_TURN
            && (gate.group.is_none() || gate.group.as_ref() == pose)
    };
    gates.iter().any(fits)
}

fn unlike_stitches(parts: &[Part]) -> Faults {
    let mut faults = Faults::default();
    for pair in parts.windows(2).filter(|p| p[0].character == p[1].character) {
        if pair[0].source.exit_group != pair[1].source.entry_group {
            faults.add(|| format!("{} ends in another pose than the next begins", pair[0].name()));
        }
    }
    faults
}

fn miscast_roles(crowd: &Crowd, parts: &[Part]) -> Faults {
    let mut players: Vec<Vec<Vec<&Part>>> = crowd
        .instances
        .iter()
        .map(|instance| vec![Vec::new(); crowd.set.kinds[instance.kind as usize].people()])
        .collect();
    for part in parts {
        players[part.used.instance as usize][part.used.role as usize].push(part);
    }
    let mut faults = Faults::default();
    for (i, roles) in players.iter().enumerate() {
        let Some(known) = roles.iter().flatten().next() else {
            faults.add(|| format!("instance {i} ({}): nobody plays it", kind_name(crowd, i)));
            continue;
        };
        for (role, who) in roles.iter().enumerate() {
            let visible = who.len() != 1 && is_visible(crowd, known, role);
            if who.len() > 1 || (who.is_empty() && visible) {
                faults.add(|| format!("instance {i} ({}), role {role}: {} players", kind_name(crowd, i), who.len()));
            }
        }
    }
    faults
}

/// Whether a role without a player would be seen, going by the clock of another role of its instance. Half a frame
/// of either border is left to rounding.
fn is_visible(crowd: &Crowd, known: &Part, role: usize) -> bool {
    let source = &known.kind.fragments[role];
    let begin = known.frame_at_clock(source.begin as f64);
    let end = known.frame_at_clock((source.begin as usize + source.motion.len() - 1) as f64);
    end > 0.5 && begin < crowd.domain.last_frame as f64 - 0.5
}

fn kind_name(crowd: &Crowd, instance: usize) -> &str {
    &crowd.set.kinds[crowd.instances[instance].kind as usize].name
}

fn motion_spans(crowd: &Crowd) -> Faults {
    let mut faults = Faults::default();
    for (c, character) in crowd.characters.iter().enumerate() {
        let (Some(first), Some(last)) = (character.fragments.first(), character.fragments.last()) else { continue };
        let expected = (first.begin.max(0), last.end.min(crowd.domain.last_frame as i32));
        let found = (character.begin as i32, character.end() as i32);
        if character.frames() == 0 || expected != found {
            faults.add(|| format!("character {c}: expected first and last frame {expected:?}, found {found:?}"));
        }
    }
    faults
}
