//! Rigs of no known family: joints guessed from the words in their names, then completed and placed by the hierarchy.
//!
//! 1. Every name is taken apart into words; one says the side, the others what it is (`Upper_Arm.L`: left, upper arm).
//! 2. Feet, hands and head are found by name. The hips are where feet, hands and head meet, the chest where the hands do.
//! 3. On the way from hips to foot and from chest to hand, thigh and shin, upper arm and forearm are the two joints
//!    that their names and the lengths of their bones speak for most.

use super::rest::RestRig;
use crate::motion::skeleton::joint::*;
use crate::motion::{JOINT_COUNT, JointId};

/// What a name speaks of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    UpLeg,
    Leg,
    Foot,
    Toe,
    Neck,
    Head,
    Shoulder,
    Arm,
    ForeArm,
    Hand,
}

use Part::*;

/// Words for parts: the likeliest meaning first.
const WORDS: [(&str, &[Part]); 48] = [
    ("upleg", &[UpLeg]),
    ("upperleg", &[UpLeg]),
    ("legupper", &[UpLeg]),
    ("thigh", &[UpLeg]),
    ("femur", &[UpLeg]),
    ("hip", &[UpLeg]),
    ("leg", &[Leg, UpLeg]),
    ("lowerleg", &[Leg]),
    ("lowleg", &[Leg]),
    ("leglower", &[Leg]),
    ("shin", &[Leg]),
    ("calf", &[Leg]),
    ("tibia", &[Leg]),
    ("knee", &[Leg]),
    ("foot", &[Foot, Toe]),
    ("feet", &[Foot]),
    ("ankle", &[Foot]),
    ("toe", &[Toe]),
    ("toes", &[Toe]),
    ("ball", &[Toe]),
    ("forefoot", &[Toe]),
    ("neck", &[Neck]),
    ("lowerneck", &[Neck]),
    ("necklower", &[Neck]),
    ("upperneck", &[Neck]),
    ("neckupper", &[Neck]),
    ("head", &[Head]),
    ("skull", &[Head]),
    ("shoulder", &[Shoulder, Arm]),
    ("clavicle", &[Shoulder]),
    ("clav", &[Shoulder]),
    ("collar", &[Shoulder]),
    ("collarbone", &[Shoulder]),
    ("scapula", &[Shoulder]),
    ("arm", &[Arm]),
    ("upperarm", &[Arm]),
    ("uparm", &[Arm]),
    ("armupper", &[Arm]),
    ("humerus", &[Arm]),
    ("shldr", &[Arm]),
    ("forearm", &[ForeArm]),
    ("lowerarm", &[ForeArm]),
    ("lowarm", &[ForeArm]),
    ("armlower", &[ForeArm]),
    ("elbow", &[ForeArm]),
    ("radius", &[ForeArm]),
    ("hand", &[Hand]),
    ("wrist", &[Hand]),
];

/// Words that say nothing of the part.
const NOISE: [&str; 25] = [
    "m",
    "center",
    "centre",
    "j",
    "jnt",
    "jt",
    "joint",
    "bone",
    "bip",
    "b",
    "c",
    "def",
    "armature",
    "character",
    "rig",
    "skel",
    "skeleton",
    "base",
    "cc",
    "sk",
    "bind",
    "x",
    "bend",
    "stretch",
    "mixamorig",
];

/// Words of joints that are no bones of the body.
const HELPERS: [&str; 22] = [
    "twist", "roll", "ik", "pole", "target", "helper", "end", "nub", "tip", "effector", "dummy", "cloth", "hair",
    "skirt", "weapon", "prop", "ctrl", "control", "mch", "org", "socket", "slider",
];

/// What a joint's name says.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Meaning {
    /// 0 left, 1 right.
    side: Option<usize>,
    parts: &'static [Part],
    helper: bool,
}

/// The joint for each canonical joint, as far as they can be told; pinned ones as they are.
pub(super) fn joints(
    rig: &RestRig,
    plain: &[String],
    pinned: &[Option<JointId>; JOINT_COUNT],
) -> [Option<JointId>; JOINT_COUNT] {
    let guess = Guess { rig, means: plain.iter().map(|n| meaning(n)).collect() };
    let mut out = *pinned;
    let ends = [(LEFT_FOOT, Foot, 0), (RIGHT_FOOT, Foot, 1), (LEFT_HAND, Hand, 0), (RIGHT_HAND, Hand, 1)];
    for (slot, part, side) in ends {
        out[slot] = out[slot].or_else(|| guess.topmost(part, Some(side)));
    }
    out[HEAD] = out[HEAD].or_else(|| guess.topmost(Head, None));
    let limbs = [LEFT_FOOT, RIGHT_FOOT, LEFT_HAND, RIGHT_HAND, HEAD];
    let meet = |slots: &[usize]| {
        let mut known = slots.iter().map(|&slot| out[slot]);
        let first = known.next().flatten();
        known.fold(first, |met, next| rig.common(met?, next?))
    };
    let (hips, chest) = (out[HIPS].or_else(|| meet(&limbs)), meet(&limbs[2..4]));
    out[HIPS] = hips;
    let Some(hips) = hips else { return out };
    for (side, thigh, foot) in [(0, LEFT_UP_LEG, LEFT_FOOT), (1, RIGHT_UP_LEG, RIGHT_FOOT)] {
        guess.limb(hips, [thigh, thigh + 1, foot], (UpLeg, Leg), &mut out);
        out[foot + 1] = out[foot + 1].or_else(|| guess.toe(out[foot]?, side));
    }
    let Some(chest) = chest else { return out };
    for shoulder in [LEFT_SHOULDER, RIGHT_SHOULDER] {
        guess.limb(chest, [shoulder + 1, shoulder + 2, shoulder + 3], (Arm, ForeArm), &mut out);
        out[shoulder] = out[shoulder].or_else(|| guess.shoulder(chest, out[shoulder + 1]?));
    }
    out[NECK] = out[NECK].or_else(|| guess.neck(chest, out[HEAD]?));
    guess.spine(hips, chest, &mut out);
    out
}

struct Guess<'a> {
    rig: &'a RestRig,
    means: Vec<Meaning>,
}

impl Guess<'_> {
    /// The joint of a part that is nearest to the root.
    fn topmost(&self, part: Part, side: Option<usize>) -> Option<JointId> {
        let fits = |j: &JointId| {
            let m = &self.means[*j];
            !m.helper && m.side == side && m.parts.contains(&part)
        };
        (0..self.rig.len()).filter(fits).min_by_key(|&j| self.rig.up_from(j).count())
    }

    /// 2 for a joint whose name says first of all that it is this part, 1 if among others, else 0.
    fn says(&self, joint: JointId, part: Part) -> f32 {
        match self.means[joint].parts.iter().position(|&p| p == part) {
            Some(0) => 2.0,
            Some(_) => 1.0,
            None => 0.0,
        }
    }

    /// The joints of a limb that are no helpers, strictly between its root and its end.
    fn way(&self, from: JointId, to: JointId) -> Vec<JointId> {
        let mut way = self.rig.between(from, to);
        way.retain(|&j| !self.means[j].helper);
        way
    }

    /// Upper and lower bone of a limb.
    fn limb(&self, root: JointId, slots: [usize; 3], parts: (Part, Part), out: &mut [Option<JointId>; JOINT_COUNT]) {
        let Some(end) = out[slots[2]].filter(|&end| self.rig.hangs_from(end, root)) else { return };
        let way = self.way(root, end);
        let all = way.first().map_or(0.0, |&top| self.rig.length(top, end)).max(f32::MIN_POSITIVE);
        let mut best = (0.0, None);
        for (i, &upper) in way.iter().enumerate() {
            for &lower in &way[i + 1..] {
                // Of two that are as good the one further down: CMU's hip joints lie before the thighs.
                let even = self.rig.length(upper, lower).min(self.rig.length(lower, end)) / all;
                let score = self.says(upper, parts.0) + self.says(lower, parts.1) + 2.0 * even + 0.05 * i as f32;
                if even > 0.1 && score > best.0 {
                    best = (score, Some((upper, lower)));
                }
            }
        }
        if let Some((upper, lower)) = best.1 {
            out[slots[0]] = out[slots[0]].or(Some(upper));
            out[slots[1]] = out[slots[1]].or(Some(lower));
        }
    }

    fn toe(&self, foot: JointId, side: usize) -> Option<JointId> {
        let fits = |&j: &JointId| {
            let m = &self.means[j];
            !m.helper && m.side == Some(side) && m.parts.contains(&Toe) && self.rig.hangs_from(j, foot)
        };
        (0..self.rig.len()).filter(fits).min_by_key(|&j| self.rig.up_from(j).count())
    }

    fn shoulder(&self, chest: JointId, arm: JointId) -> Option<JointId> {
        let way = self.way(chest, arm);
        way.iter().copied().find(|&j| self.says(j, Shoulder) > 0.0).or(way.last().copied())
    }

    fn neck(&self, chest: JointId, head: JointId) -> Option<JointId> {
        let way = self.way(chest, head);
        way.iter().copied().find(|&j| self.says(j, Neck) > 0.0).or(way.first().copied())
    }

    /// The spine: three joints are the canonical ones; of more or fewer, those whose bones cover the middles of the
    /// canonical bones. A joint is used once; where one covers two, the upper one moves with the lower.
    fn spine(&self, hips: JointId, chest: JointId, out: &mut [Option<JointId>; JOINT_COUNT]) {
        const MIDDLES: [f32; 3] = [0.32, 0.57, 0.85];
        if [SPINE, SPINE1, SPINE2].iter().any(|&j| out[j].is_some()) {
            return;
        }
        let mut chain = self.way(hips, chest);
        chain.extend((chest != hips).then_some(chest));
        match chain.as_slice() {
            [] => {}
            [one] => out[SPINE] = Some(*one),
            [a, b] => (out[SPINE], out[SPINE2]) = (Some(*a), Some(*b)),
            [a, b, c] => (out[SPINE], out[SPINE1], out[SPINE2]) = (Some(*a), Some(*b), Some(*c)),
            _ => {
                let top = out[NECK].or(out[HEAD]).unwrap_or(chest);
                let all = self.rig.length(hips, top).max(f32::MIN_POSITIVE);
                for (slot, middle) in [SPINE, SPINE1, SPINE2].into_iter().zip(MIDDLES) {
                    let below = chain.iter().rev().find(|&&j| self.rig.length(hips, j) <= middle * all);
                    out[slot] = below.copied().filter(|&j| out[..slot].iter().all(|&o| o != Some(j)));
                }
            }
        }
    }
}

/// What a name says.
fn meaning(name: &str) -> Meaning {
    let words = words(name);
    let helper = words.iter().any(|w| HELPERS.contains(&w.as_str()));
    let mut side = None;
    let mut key = String::new();
    for word in words.iter().filter(|w| !NOISE.contains(&w.as_str()) && !w.bytes().all(|b| b.is_ascii_digit())) {
        match side_of(word) {
            Some(found) if side.is_none() => side = Some(found),
            _ => key += word,
        }
    }
    let parts = |key: &str| WORDS.iter().find(|(word, _)| *word == key).map(|(_, parts)| *parts);
    if let Some(parts) = parts(&key) {
        // A hip without a side is the hips, which the hierarchy finds.
        let central = [Neck, Head].contains(&parts[0]);
        let parts = if side.is_none() && !central { &[] as &[Part] } else { parts };
        return Meaning { side: if central { None } else { side }, parts, helper };
    }
    // Side and part written as one: `lthigh`, `leftupperarm`, `handr`.
    for (glued, this) in [("left", 0), ("right", 1), ("l", 0), ("r", 1)] {
        let rest = key.strip_prefix(glued).or_else(|| key.strip_suffix(glued));
        if let Some(parts) = rest.and_then(parts).filter(|_| side.is_none()) {
            return Meaning { side: Some(this), parts, helper };
        }
    }
    Meaning { side, parts: &[], helper }
}

fn side_of(word: &str) -> Option<usize> {
    match word {
        "l" | "left" | "lft" | "lf" => Some(0),
        "r" | "right" | "rgt" | "rt" => Some(1),
        _ => None,
    }
}

/// The words of a name in lower case: parted by other characters, digits, and capitals.
fn words(name: &str) -> Vec<String> {
    let chars: Vec<char> = name.chars().collect();
    let mut words: Vec<String> = Vec::new();
    for (i, &c) in chars.iter().enumerate() {
        let before = i.checked_sub(1).map(|j| chars[j]);
        let begins = before.is_none_or(|b| {
            let hump = c.is_uppercase() && (b.is_lowercase() || chars.get(i + 1).is_some_and(|n| n.is_lowercase()));
            !b.is_alphanumeric() || b.is_numeric() != c.is_numeric() || hump
        });
        if c.is_alphanumeric() {
            if begins || words.is_empty() {
                words.push(String::new());
            }
            words.last_mut().expect("pushed").extend(c.to_lowercase());
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_understood() {
        let said = |name: &str| {
            let m = meaning(name);
            (m.side, m.parts.first().copied())
        };
        for (name, side, part) in [
            ("Upper_Arm.L", 0, Arm),
            ("lThigh", 0, UpLeg),
            ("rtibia", 1, Leg),
            ("LEFTUPPERARM", 0, Arm),
            ("RightLowerLeg", 1, Leg),
            ("hand_r", 1, Hand),
            ("L Foot", 0, Foot),
            ("jnt_r_elbow_01", 1, ForeArm),
            ("ShoulderLeft", 0, Shoulder),
            ("LHipJoint", 0, UpLeg),
        ] {
            assert_eq!(said(name), (Some(side), Some(part)), "{name}");
        }
        assert_eq!(said("Head"), (None, Some(Head)));
        assert_eq!(said("Hips"), (None, None));
        assert_eq!(said("LeftHandIndex1").1, None);
        assert!(meaning("upperarm_twist_01_l").helper && meaning("RightFoot_End").helper);
    }
}
