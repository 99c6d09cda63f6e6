//! Which joints of a rig play the canonical joints: by tables of names first, else guessed from names and hierarchy.

use std::collections::BTreeMap;

use super::families::{FAMILIES, Family};
use super::guess;
use super::rest::RestRig;
use crate::motion::skeleton::joint::*;
use crate::motion::{JOINT_COUNT, JointId, canonical};
use crate::{Error, Result};

/// Name space of joints that a rig file or a person has named: they play the canonical joint of that name (several
/// with `+` between them), whatever else is found. See [`super::rigfile`].
pub(super) const PINNED: &str = "crowdquilt:";

/// What was found of a rig.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RigMatch {
    /// The family whose names it has, or `guessed`.
    pub family: &'static str,
    /// The rig's joint for every canonical joint; `None` where it has none.
    pub joints: [Option<JointId>; JOINT_COUNT],
}

/// Joints that a rig may lack; and of the spine's joints any one will do.
const OPTIONAL: [usize; 8] = [LEFT_TOE, RIGHT_TOE, LEFT_SHOULDER, RIGHT_SHOULDER, SPINE, SPINE1, SPINE2, NECK];

/// Finds the canonical joints among a rig's joints, from their names and hierarchy.
///
/// Families of rigs whose names are known (25: Mixamo, CMU's in four forms, Rokoko, Xsens, Vicon Plug-in Gait,
/// Unreal, Unity, VRM, SMPL, Rigify, Biped, Daz, Character Creator, ...) go first, name spaces (`mixamorig:`), common
/// prefixes (`Armature_`, `Bip01 `) and export numbers (`_058`) aside. Others are guessed from the words in their names
/// and checked against the hierarchy: a shin hangs from its thigh, both legs are alike, and so on. Toes, shoulders,
/// the neck and all but one joint of the spine may be missing.
///
/// # Errors
/// No joint found for a canonical joint that is needed: names them, and the family that came nearest.
pub fn match_rig(rig: &RestRig) -> Result<RigMatch> {
    let spellings = Spellings::of(&rig.names);
    let pinned = pinned(&rig.names);
    let mut found: Vec<RigMatch> = Vec::new();
    let mut nearest: Option<(&Family, Vec<usize>)> = None;
    for family in &FAMILIES {
        let joints = by_names(family, &spellings, &pinned);
        let missing = missing(&joints);
        if missing.is_empty() && faults(rig, &joints).is_empty() {
            found.push(RigMatch { family: family.name, joints });
        } else if nearest.as_ref().is_none_or(|(_, fewest)| missing.len() < fewest.len()) {
            nearest = Some((family, missing));
        }
    }
    let count = |m: &RigMatch| m.joints.iter().flatten().count();
    // The first of those with most joints: `max_by_key` would take the last.
    if let Some(best) = found.into_iter().rev().max_by_key(count) {
        return Ok(best);
    }
    let guessed = guess::joints(rig, &spellings.short, &pinned);
    let lacks = missing(&guessed);
    let faults = faults(rig, &guessed);
    if lacks.is_empty() && faults.is_empty() {
        return Ok(RigMatch { family: "guessed", joints: guessed });
    }
    // What a family that is nearly there lacks says more than what the guess could not make out.
    let lacks = nearest.iter().map(|(_, lacks)| lacks).find(|l| l.len() < lacks.len()).cloned().unwrap_or(lacks);
    Err(unknown(&lacks, &faults, nearest))
}

fn unknown(lacks: &[usize], faults: &[String], nearest: Option<(&Family, Vec<usize>)>) -> Error {
    let names: Vec<&str> = lacks.iter().map(|&j| canonical().joints[j].name.as_str()).collect();
    let mut problem = match lacks {
        [] => format!("expected a rig of a person, found that {}", faults.join("; ")),
        _ => format!("expected a rig of a person, found no joint for {}", names.join(", ")),
    };
    if let Some((family, missing)) = nearest.filter(|(_, missing)| missing.len() < JOINT_COUNT / 2) {
        let names = family.joints();
        let lacking: Vec<&str> = missing.iter().filter_map(|&j| names[j].as_deref()).collect();
        problem += &format!("; the nearest family, {}, has {} for them", family.name, lacking.join(", "));
    }
    problem += "; a rig file can say which joints they are";
    Error::invalid("rig", "skeleton", problem)
}

/// The canonical joints that are needed and not there.
fn missing(joints: &[Option<JointId>; JOINT_COUNT]) -> Vec<usize> {
    let mut out: Vec<usize> = (0..JOINT_COUNT).filter(|j| joints[*j].is_none() && !OPTIONAL.contains(j)).collect();
    if [SPINE, SPINE1, SPINE2].iter().all(|&j| joints[j].is_none()) {
        out.push(SPINE);
    }
    out
}

fn by_names(
    family: &Family,
    spellings: &Spellings,
    pinned: &[Option<JointId>; JOINT_COUNT],
) -> [Option<JointId>; JOINT_COUNT] {
    let wanted = family.joints();
    std::array::from_fn(|slot| pinned[slot].or_else(|| wanted[slot].as_ref().and_then(|name| spellings.find(name))))
}

/// The joints named by hand.
fn pinned(names: &[String]) -> [Option<JointId>; JOINT_COUNT] {
    let plays = |name: &str, slot: usize| {
        name.strip_prefix(PINNED).is_some_and(|n| n.split('+').any(|n| n == canonical().joints[slot].name))
    };
    std::array::from_fn(|slot| names.iter().position(|name| plays(name, slot)))
}

/// The names of a rig's joints, less and less as exporters have left them.
struct Spellings {
    full: Vec<String>,
    /// Without name spaces and the numbers that some exporters append to all.
    bare: Vec<String>,
    /// Without a prefix that most share, too.
    short: Vec<String>,
}

impl Spellings {
    fn of(names: &[String]) -> Self {
        let own: Vec<&str> = names.iter().map(|n| own_name(n)).collect();
        let most = |count: usize, share: f32| count as f32 >= share * names.len() as f32;
        let unnumbered = |name: &str| match name.rsplit_once('_') {
            Some((head, number)) if !head.is_empty() && digits(number) => Some(head.to_owned()),
            _ => None,
        };
        let number_all = most(own.iter().filter(|n| unnumbered(n).is_some()).count(), 0.9);
        let bare_name = |n: &&str| unnumbered(n).filter(|_| number_all).unwrap_or_else(|| (*n).to_owned());
        let bare: Vec<String> = own.iter().map(bare_name).collect();
        let mut prefixes: BTreeMap<&str, usize> = BTreeMap::new();
        for name in &bare {
            if let Some(at) = name.find(['_', ' ', '-', '.']) {
                *prefixes.entry(&name[..=at]).or_default() += 1;
            }
        }
        let prefix = prefixes.into_iter().find(|&(_, count)| most(count, 0.7)).map_or("", |(prefix, _)| prefix);
        let short = bare.iter().map(|n| n.strip_prefix(prefix).unwrap_or(n).to_owned()).collect();
        Self { full: names.to_vec(), short, bare }
    }

    fn find(&self, name: &str) -> Option<JointId> {
        [&self.full, &self.bare, &self.short].iter().find_map(|names| names.iter().position(|n| n == name))
    }
}

/// A name without its name space (`mixamorig:Hips`, `Armature|Hips`), also where an exporter has eaten the colon.
fn own_name(name: &str) -> &str {
    let name = name.rsplit([':', '|']).next().unwrap_or(name);
    match name.strip_prefix("mixamorig") {
        Some(rest) => rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == '_' || c == ' '),
        None => name,
    }
}

fn digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
}

/// What in the hierarchy speaks against these joints; joints that are missing are not tested.
fn faults(rig: &RestRig, joints: &[Option<JointId>; JOINT_COUNT]) -> Vec<String> {
    let mut out = Vec::new();
    let name = |slot: usize| canonical().joints[slot].name.as_str();
    let mut under = |low: usize, high: usize| {
        if let (Some(a), Some(b)) = (joints[low], joints[high])
            && !rig.hangs_from(a, b)
        {
            let (theirs, above) = (&rig.names[a], &rig.names[b]);
            out.push(format!("'{theirs}' ({}) does not hang from '{above}' ({})", name(low), name(high)));
        }
    };
    for (low, high) in [(LEFT_LEG, LEFT_UP_LEG), (LEFT_FOOT, LEFT_LEG), (LEFT_TOE, LEFT_FOOT), (LEFT_UP_LEG, HIPS)] {
        under(low, high);
        under(mirror(low), mirror(high));
    }
    for (low, high) in
        [(LEFT_FORE_ARM, LEFT_ARM), (LEFT_HAND, LEFT_FORE_ARM), (LEFT_ARM, HIPS), (LEFT_ARM, LEFT_SHOULDER)]
    {
        under(low, high);
        under(mirror(low), mirror(high));
    }
    under(HEAD, HIPS);
    under(HEAD, NECK);
    for (upper, middle, lower) in [(LEFT_UP_LEG, LEFT_LEG, LEFT_FOOT), (LEFT_ARM, LEFT_FORE_ARM, LEFT_HAND)] {
        out.extend(unlike(rig, joints, [upper, middle, lower]));
    }
    out
}

/// A limb that is another joint's on the other side, or whose length differs much from side to side.
fn unlike(rig: &RestRig, joints: &[Option<JointId>; JOINT_COUNT], limb: [usize; 3]) -> Option<String> {
    let left: Vec<JointId> = limb.iter().filter_map(|&j| joints[j]).collect();
    let right: Vec<JointId> = limb.iter().filter_map(|&j| joints[mirror(j)]).collect();
    let ([a, b, c], [d, e, f]) = (left.as_slice(), right.as_slice()) else { return None };
    let (left, right) = (rig.length(*a, *b) + rig.length(*b, *c), rig.length(*d, *e) + rig.length(*e, *f));
    let part = canonical().joints[limb[0]].name.trim_start_matches("left_").replace("up_", "");
    if a == d || c == f {
        return Some(format!("both {part}s are '{}'", rig.names[*a]));
    }
    let alike = left > 0.0 && right > 0.0 && (0.8..1.25).contains(&(left / right));
    (!alike).then(|| format!("the left {part} is {left:.3} long, the right {right:.3}"))
}
