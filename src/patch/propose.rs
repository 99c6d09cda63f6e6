//! Proposes where to cut a single person's capture: annotation for take files, to be kept, edited or thrown away.
//!
//! Ports are set at all frames whose poses are near a pose group's exemplar; every stretch between two neighbouring
//! ports becomes a patch, labelled by what it does (walk, turn, start, stop, idle). Longer stretches over one port in
//! between are proposed for walks (two steps), since a whole cycle bends more gracefully than one step.

use glam::Vec3;

use super::boundary::{self, Boundary, Exemplar};
use crate::motion::gait::{self, GaitOptions, Phase};
use crate::motion::take::{TakePatch, TakePort, TakeRole};
use crate::motion::{FPS, Motion, plants};

/// What is proposed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProposeOptions {
    /// Ports lie within these seconds of the capture; default all.
    pub within: (f32, f32),
    /// A mid-stance is a port if its pose is this near its exemplar, metres; default 0.10.
    pub walk_distance: f32,
    /// A frame is a standing port if its pose is this near the exemplar, metres; default 0.075 (a mid-stance is 0.09
    /// from standing).
    pub stand_distance: f32,
    /// and the hips move slower than this on the ground, m/s; default 0.35.
    pub stand_speed: f32,
    /// Longest patch, seconds; default 4.
    pub max_seconds: f32,
    /// A walk that turns by more than this is labelled `turn`, radians; default 20 degrees.
    pub turn: f32,
}

impl Default for ProposeOptions {
    fn default() -> Self {
        Self {
            within: (0.0, f32::INFINITY),
            walk_distance: 0.10,
            stand_distance: 0.075,
            stand_speed: 0.35,
            max_seconds: 4.0,
            turn: 20f32.to_radians(),
        }
    }
}

/// Time in seconds of a frame, rounded to milliseconds for files.
pub fn seconds(frame: usize) -> f32 {
    (frame as f32 / FPS * 1000.0).round() / 1000.0
}

/// Frames that may be ports, sorted, at least 0.3 s apart if of one group.
pub fn ports(motion: &Motion, exemplars: &[Exemplar], options: &ProposeOptions) -> Vec<Boundary> {
    let mut found = walk_ports(motion, exemplars, options);
    found.extend(stand_ports(motion, exemplars, options));
    let inside = |b: &Boundary| (options.within.0..=options.within.1).contains(&(b.frame as f32 / FPS));
    found.retain(inside);
    found.sort_by_key(|b| (b.frame, b.phase));
    // Passing the mid-stance slowly can look like standing: where the two nearly coincide, the nearer pose wins.
    let near = |a: &Boundary, b: &Boundary| a.frame.abs_diff(b.frame) < (0.3 * FPS) as usize;
    let all = found.clone();
    found.retain(|b| !all.iter().any(|o| o != b && near(o, b) && o.phase != b.phase && o.distance < b.distance));
    found
}

fn walk_ports(motion: &Motion, exemplars: &[Exemplar], options: &ProposeOptions) -> Vec<Boundary> {
    let moments = gait::moments(motion, &GaitOptions::default());
    let walks = moments.into_iter().filter(|m| m.phase != Phase::Stand);
    let boundaries = walks.filter_map(|m| {
        let exemplar = exemplars.iter().find(|e| e.phase == m.phase)?;
        Some(Boundary { frame: m.frame, phase: m.phase, distance: boundary::distance(motion, m.frame, exemplar) })
    });
    boundaries.filter(|b| b.distance < options.walk_distance).collect()
}

/// Of every stretch of standing poses both ends, and the middle of a stretch that leads on to nothing else.
fn stand_ports(motion: &Motion, exemplars: &[Exemplar], options: &ProposeOptions) -> Vec<Boundary> {
    let Some(stand) = exemplars.iter().find(|e| e.phase == Phase::Stand) else { return Vec::new() };
    // Walkers who pass through a stand-like pose are too fast; at the ends, where the poses' window is cut short, only
    // the speed tells.
    let hips: Vec<Vec3> = motion.path.points.iter().map(|p| Vec3::new(p.x, 0.0, p.y)).collect();
    let speeds = plants::speeds(&hips, FPS);
    let still = |f: usize| speeds[f] < options.stand_speed;
    let far = |f: usize| if still(f) { boundary::distance(motion, f, stand) } else { f32::INFINITY };
    let all: Vec<f32> = (0..motion.len()).map(far).collect();
    let mut found: Vec<Boundary> = Vec::new();
    let mut frame = 0;
    while frame < all.len() {
        if all[frame] >= options.stand_distance {
            frame += 1;
            continue;
        }
        let begin = frame;
        while frame < all.len() && all[frame] < options.stand_distance {
            frame += 1;
        }
        let at = |frame: usize| Boundary { frame, phase: Phase::Stand, distance: all[frame] };
        // Short stretches give their best frame, long ones two frames, an idle apart.
        if frame - begin < (0.6 * FPS) as usize {
            found.extend((begin..frame).map(at).min_by(|a, b| a.distance.total_cmp(&b.distance)));
        } else {
            found.extend([at(begin), at(frame - 1)]);
        }
    }
    found
}

/// The ports of a motion and the patches between them, all of one person (`person` 0 of a take); patches are called
/// `NAME-1`, `NAME-2`, ... and labelled.
pub fn single(
    name: &str,
    motion: &Motion,
    exemplars: &[Exemplar],
    options: &ProposeOptions,
) -> (Vec<TakePort>, Vec<TakePatch>) {
    let ports = ports(motion, exemplars, options);
    let mut patches: Vec<TakePatch> = Vec::new();
    for (i, from) in ports.iter().enumerate() {
        for (skipped, to) in ports[i + 1..].iter().take(2).enumerate() {
            let (fits, label) = describe(motion, *from, *to, options);
            let one_phase = from.phase == to.phase && ports[i + 1].phase != Phase::Stand && from.phase != Phase::Stand;
            if fits && (skipped == 0 || one_phase) {
                patches.push(TakePatch {
                    name: format!("{label}-{name}-{}", patches.len() + 1),
                    labels: vec![label.to_owned()],
                    roles: vec![TakeRole { person: 0, begin: seconds(from.frame), end: seconds(to.frame) }],
                    core: None,
                });
            }
        }
    }
    let port = |b: &Boundary| TakePort { person: 0, time: seconds(b.frame), pose: b.phase.group().into() };
    (ports.iter().map(port).collect(), patches)
}

fn describe(motion: &Motion, from: Boundary, to: Boundary, options: &ProposeOptions) -> (bool, &'static str) {
    let seconds = (to.frame - from.frame) as f32 / FPS;
    let turned = (motion.path.headings[to.frame] - motion.path.headings[from.frame]).abs();
    let label = match (from.phase == Phase::Stand, to.phase == Phase::Stand) {
        (true, true) if turned > options.turn => "turn",
        (true, true) => "idle",
        (true, false) => "start",
        (false, true) => "stop",
        _ if turned > options.turn => "turn",
        _ => "walk",
    };
    ((0.4..=options.max_seconds).contains(&seconds), label)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::testing::{standing, walking};

    #[test]
    fn a_walk_is_cut_into_steps_and_cycles() {
        let walk = walking(4.0);
        let exemplars = boundary::exemplars(&[walk.clone(), standing(1.0)]);
        let (ports, patches) = single("w", &walk, &exemplars, &ProposeOptions::default());
        assert!(ports.len() >= 6, "{ports:?}");
        assert_eq!(patches.len(), 2 * ports.len() - 3, "{ports:?}");
        for p in &patches {
            assert_eq!(p.labels, ["walk"]);
            let pose = |time: f32| ports.iter().find(|port| port.time == time).map(|port| port.pose.as_str());
            let (begin, end) = (p.roles[0].begin, p.roles[0].end);
            let one_step = pose(begin).unwrap() != pose(end).unwrap();
            assert!(((end - begin) - if one_step { 0.533 } else { 1.067 }).abs() < 0.05, "{p:?}");
        }
        let names: std::collections::BTreeSet<&String> = patches.iter().map(|p| &p.name).collect();
        assert_eq!(names.len(), patches.len());
    }

    #[test]
    fn standing_is_one_idle_and_the_window_holds() {
        let stand = standing(2.0);
        let exemplars = boundary::exemplars(std::slice::from_ref(&stand));
        let (ports, patches) = single("s", &stand, &exemplars, &ProposeOptions::default());
        assert_eq!((ports.len(), patches.len(), patches[0].labels[0].as_str()), (2, 1, "idle"));
        let options = ProposeOptions { within: (0.5, 1.0), ..Default::default() };
        assert!(single("s", &stand, &exemplars, &options).0.is_empty());
    }
}
