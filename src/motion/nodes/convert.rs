//! From global transforms of joints to a clip.
//!
//! With G the global rotation of a joint at some moment and B the one in the bind pose, G B^-1 is how far the joint
//! has turned from it: the global rotation of a clip, whose rest pose has none. In that frame a bone does not change
//! but for its length, so that the mean over all frames is the joint's offset.

use glam::{DQuat, DVec3, Quat, Vec3};

use super::{Figure, Local, Posed, Timing, Tree};
use crate::motion::{Clip, Joint, JointId, Skeleton};
use crate::{Error, Result};

/// Global places and turns from the bind pose, frame-major.
struct Track {
    places: Vec<Vec3>,
    turns: Vec<Quat>,
    joints: usize,
}

pub(super) fn clip(
    tree: &Tree,
    figure: &Figure,
    timing: Timing,
    local: impl FnMut(usize, f64) -> Local,
) -> Result<Clip> {
    let bind = bind(tree, figure);
    let track = sample(tree, figure, &bind, timing, local)?;
    let offsets = offsets(figure, &track);
    let names = names(tree, figure);
    let root = root(figure, &track, &offsets, &names);
    let kept = below(&figure.parents, root);
    let mut place = vec![usize::MAX; figure.joints.len()];
    kept.iter().enumerate().for_each(|(at, &j)| place[j] = at);
    let joint = |&j: &JointId| Joint {
        name: names[j].clone(),
        parent: figure.parents[j].filter(|_| j != root).map(|p| place[p]),
        offset: if j == root { Vec3::ZERO } else { offsets[j].as_vec3() },
        tip: tree.nodes[figure.joints[j]].tip.map(|tip| (bind[j] * tip).as_vec3()),
    };
    let skeleton = Skeleton { joints: kept.iter().map(joint).collect() };
    let n = track.joints;
    let frames = track.places.len() / n;
    let mut rotations = Vec::with_capacity(frames * kept.len());
    for turns in track.turns.chunks_exact(n) {
        rotations.extend(kept.iter().map(|&j| match figure.parents[j].filter(|_| j != root) {
            Some(parent) => (turns[parent].inverse() * turns[j]).normalize(),
            None => turns[j],
        }));
    }
    let places = track.places.iter().skip(root).step_by(n).copied().collect();
    Ok(Clip { name: figure.name.clone(), skeleton, fps: timing.fps as f32, root: places, rotations })
}

/// Global rotations in the bind pose; joints the file gives none for keep their rest rotation to their parent.
fn bind(tree: &Tree, figure: &Figure) -> Vec<DQuat> {
    let rest = tree.rest_rotations();
    let mut bind: Vec<DQuat> = Vec::with_capacity(figure.joints.len());
    for (&i, &parent) in figure.joints.iter().zip(&figure.parents) {
        let by_parent = parent.map_or(rest[i], |p| bind[p] * rest[figure.joints[p]].inverse() * rest[i]);
        bind.push(tree.nodes[i].bind.unwrap_or(by_parent).normalize());
    }
    bind
}

fn sample(
    tree: &Tree,
    figure: &Figure,
    bind: &[DQuat],
    timing: Timing,
    mut local: impl FnMut(usize, f64) -> Local,
) -> Result<Track> {
    let joints = figure.joints.len();
    let (mut places, mut turns, mut end) = (Vec::new(), Vec::new(), 0);
    let mut posed = Posed::new();
    for frame in 0..timing.frames {
        let time = timing.time(frame);
        let moment = posed.at(tree, figure, |node| local(node, time));
        if !moment.shown && end == 0 {
            continue;
        }
        for ((place, rotation), bind) in moment.joints.iter().zip(bind) {
            places.push(place.as_vec3());
            turns.push((*rotation * bind.inverse()).normalize().as_quat());
        }
        if moment.shown {
            end = places.len();
        }
    }
    places.truncate(end);
    turns.truncate(end);
    let problem = |text: &str| Error::invalid("animation", format!("character '{}'", figure.name), text);
    if places.is_empty() {
        return Err(problem("expected a character that is shown at some time, found one of no size"));
    }
    if !(places.iter().all(|p| p.is_finite()) && turns.iter().all(|q| q.is_finite())) {
        return Err(problem("expected finite places and rotations, found one that is not a number"));
    }
    Ok(Track { places, turns, joints })
}

/// Where a joint is in its parent's frame.
fn placed(track: &Track, frame: usize, joint: JointId, parent: JointId) -> DVec3 {
    let at = frame * track.joints;
    let apart = track.places[at + joint].as_dvec3() - track.places[at + parent].as_dvec3();
    track.turns[at + parent].as_dquat().inverse() * apart
}

fn offsets(figure: &Figure, track: &Track) -> Vec<DVec3> {
    let frames = track.places.len() / track.joints;
    let mean = |(joint, parent): (JointId, &Option<JointId>)| {
        let sum = |parent| (0..frames).map(|f| placed(track, f, joint, parent)).sum::<DVec3>();
        parent.map_or(DVec3::ZERO, |parent| sum(parent) / frames as f64)
    };
    figure.parents.iter().enumerate().map(mean).collect()
}

/// The clip's root: the hips, where a still or trailing joint stands above them and they move in its frame. That is
/// the deepest joint that moves, on the way down through only children and through hips or pelvis.
fn root(figure: &Figure, track: &Track, offsets: &[DVec3], names: &[String]) -> JointId {
    let mut children = vec![Vec::new(); names.len()];
    let mut size = vec![1; names.len()];
    for (j, parent) in figure.parents.iter().enumerate().rev() {
        if let Some(parent) = *parent {
            children[parent].push(j);
            size[parent] += size[j];
        }
    }
    let is_hips = |j: &&JointId| {
        let name = names[**j].to_ascii_lowercase();
        let called = name.contains("hips") || name.contains("pelvis") || name.ends_with("hip");
        called && 3 * size[**j] >= 2 * names.len()
    };
    // A hundredth of a person's size, which is about a tenth of all bones laid end to end.
    let still = 0.001 * offsets.iter().map(|o| o.length()).sum::<f64>();
    let frames = track.places.len() / track.joints;
    let (mut root, mut at) = (0, 0);
    loop {
        let next = if children[at].len() == 1 { children[at].first() } else { children[at].iter().find(is_hips) };
        let Some(&next) = next else { return root };
        if (0..frames).any(|f| placed(track, f, next, at).distance(offsets[next]) > still) {
            root = next;
        }
        at = next;
    }
}

/// A joint and all below it, parents first.
fn below(parents: &[Option<JointId>], root: JointId) -> Vec<JointId> {
    let mut inside = vec![false; parents.len()];
    for (j, parent) in parents.iter().enumerate() {
        inside[j] = j == root || parent.is_some_and(|p| inside[p]);
    }
    (0..parents.len()).filter(|&j| inside[j]).collect()
}

/// The joints' names without what they all begin with: a namespace (`mixamorig:`) or the figure's name (`person_3_`).
fn names(tree: &Tree, figure: &Figure) -> Vec<String> {
    let plain = |&i: &usize| tree.nodes[i].name.as_str();
    let by_space = |name: &str| name.rsplit_once(':').map_or(name, |(_, rest)| rest).to_owned();
    let names: Vec<String> = figure.joints.iter().map(plain).map(by_space).collect();
    let own = format!("{}_", figure.name);
    let short: Option<Vec<String>> = names.iter().map(|n| Some(n.strip_prefix(&own)?.to_owned())).collect();
    unique(short.unwrap_or(names))
}

/// Joints' names are unique; those that are not get their number.
fn unique(mut names: Vec<String>) -> Vec<String> {
    let mut used = std::collections::BTreeSet::new();
    for (i, name) in names.iter_mut().enumerate() {
        while name.is_empty() || !used.insert(name.clone()) {
            *name = format!("{name}_{i}");
        }
    }
    names
}
