//! Builds: people of other heights, proportions and girths on the joints of the canonical body.
//!
//! A build has a bone offset of its own for every joint, and says how the flesh around each joint differs from that of
//! the canonical body. Feet are everybody's own size but one length, so that whoever stands where the canonical body
//! stands has ankle, ball and toes in the same places.

use std::sync::{Arc, LazyLock};

use glam::Vec3;

use super::skeleton::joint::*;
use super::{JOINT_COUNT, JointId, Skeleton, canonical};
use crate::{Error, Result};

/// Height of the canonical body's ankles over the ground, metres.
pub(crate) const ANKLE_HEIGHT: f32 = 0.075;

/// How the body's surface around a joint differs from the canonical body's.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Flesh {
    /// Scale about the joint along the axes of the rest pose.
    pub scale: Vec3,
    /// Shift along z (forward in the rest pose), metres: bellies.
    pub forward: f32,
}

/// A person's build: bones and flesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Build {
    /// What it is called, e.g. `tall`.
    pub name: String,
    /// The canonical joints with this build's offsets.
    pub skeleton: Skeleton,
    /// The flesh around every joint.
    pub flesh: [Flesh; JOINT_COUNT],
}

impl Default for Build {
    fn default() -> Self {
        Proportions::default().build("average")
    }
}

/// The form in which a build is written into files: offset of every joint, then scale x, y, z and shift of its flesh.
#[derive(Clone, serde::Serialize, serde::Deserialize)]
pub(crate) struct BuildRows {
    name: String,
    offsets: Vec<Vec3>,
    flesh: Vec<[f32; 4]>,
}

/// Factors on the canonical body's measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proportions {
    /// Length of thighs and shins.
    pub legs: f32,
    /// Length of the back.
    pub torso: f32,
    /// Size of neck and head.
    pub head: f32,
    /// Length of upper and lower arms; hands follow by half.
    pub arms: f32,
    /// Distance between the shoulders.
    pub shoulders: f32,
    /// Distance between the hip joints, and width of the pelvis.
    pub hips: f32,
    /// Thickness of limbs.
    pub limbs: f32,
    /// Girth of the chest.
    pub chest: f32,
    /// Girth of the waist.
    pub waist: f32,
}

impl Default for Proportions {
    fn default() -> Self {
        let (legs, torso, head, arms) = (1.0, 1.0, 1.0, 1.0);
        Self { legs, torso, head, arms, shoulders: 1.0, hips: 1.0, limbs: 1.0, chest: 1.0, waist: 1.0 }
    }
}

impl Proportions {
    /// The build of these proportions.
    pub fn build(&self, name: &str) -> Build {
        let mut skeleton = canonical().clone();
        let flesh = std::array::from_fn(|j| self.flesh(j));
        for (j, joint) in skeleton.joints.iter_mut().enumerate() {
            joint.offset *= self.bone(j);
            joint.tip = joint.tip.map(|tip| tip * flesh[j].scale);
        }
        skeleton.joints[HIPS].offset.y += (self.legs - 1.0) * leg_length(canonical());
        Build { name: name.into(), skeleton, flesh }
    }

    /// The same girth on bones that keep `part` of what sets them apart from the canonical ones; 1 keeps all.
    pub fn toned(&self, part: f32) -> Self {
        let mix = |factor: f32| 1.0 + (factor - 1.0) * part;
        Self {
            legs: mix(self.legs),
            torso: mix(self.torso),
            head: mix(self.head),
            arms: mix(self.arms),
            shoulders: mix(self.shoulders),
            hips: mix(self.hips),
            ..*self
        }
    }

    /// Factors on a joint's offset from its parent.
    fn bone(&self, joint: JointId) -> Vec3 {
        match joint {
            LEFT_UP_LEG | RIGHT_UP_LEG => Vec3::new(self.hips, 1.0, 1.0),
            LEFT_LEG | LEFT_FOOT | RIGHT_LEG | RIGHT_FOOT => Vec3::splat(self.legs),
            SPINE | SPINE1 | SPINE2 | NECK => Vec3::splat(self.torso),
            HEAD => Vec3::splat(self.head),
            LEFT_SHOULDER | RIGHT_SHOULDER => Vec3::new(self.shoulders, self.torso, 1.0),
            LEFT_ARM | RIGHT_ARM => Vec3::new(self.shoulders, 1.0, 1.0),
            LEFT_FORE_ARM | LEFT_HAND | RIGHT_FORE_ARM | RIGHT_HAND => Vec3::splat(self.arms),
            _ => Vec3::ONE,
        }
    }

    fn flesh(&self, joint: JointId) -> Flesh {
        let around = |along: f32, x: f32, z: f32| Vec3::new(x, along, z);
        let (limbs, hand) = (self.limbs, 0.5 + 0.5 * self.arms);
        let scale = match joint {
            HIPS => {
                around(1.0, self.hips * (0.4 + 0.3 * self.waist + 0.3 * limbs), 0.3 + 0.4 * self.waist + 0.3 * limbs)
            }
            SPINE => around(self.torso, 0.3 + 0.7 * self.waist, self.waist),
            SPINE1 => around(self.torso, 0.5 * (self.waist + self.chest), 0.6 * self.waist + 0.4 * self.chest),
            SPINE2 => around(self.torso, 0.5 * (self.shoulders + self.chest), self.chest),
            NECK => around(self.head, 0.5 * (self.head + limbs), 0.5 * (self.head + limbs)),
            HEAD => Vec3::splat(self.head),
            LEFT_UP_LEG | RIGHT_UP_LEG => around(self.legs, 0.5 + 0.5 * limbs, limbs),
            LEFT_LEG | RIGHT_LEG => around(self.legs, limbs, limbs),
            LEFT_FOOT | LEFT_TOE | RIGHT_FOOT | RIGHT_TOE => Vec3::new(0.5 + 0.5 * limbs, 1.0, 1.0),
            LEFT_SHOULDER | RIGHT_SHOULDER => Vec3::new(self.shoulders, limbs, self.chest),
            LEFT_ARM | LEFT_FORE_ARM | RIGHT_ARM | RIGHT_FORE_ARM => Vec3::new(self.arms, limbs, limbs),
            _ => Vec3::splat(hand),
        };
        let belly = 0.14 * (self.waist - 1.0).max(0.0);
        let forward = match joint {
            SPINE => belly,
            HIPS | SPINE1 => 0.5 * belly,
            _ => 0.0,
        };
        Flesh { scale, forward }
    }
}

impl Build {
    /// The canonical body's build, shared.
    pub fn canonical() -> Arc<Self> {
        static CANONICAL: LazyLock<Arc<Build>> = LazyLock::new(|| Arc::new(Build::default()));
        CANONICAL.clone()
    }

    /// The builds that crowds are made of. Each comes three times, its bones more and more like the canonical ones
    /// and its girth the same; the last has canonical bones. The first is the canonical build.
    pub fn catalogue() -> &'static [[Arc<Self>; 3]] {
        static CATALOGUE: LazyLock<Vec<[Arc<Build>; 3]>> = LazyLock::new(|| {
            let toned = |&(name, factors): &(&str, Factors)| {
                [(1.0, ""), (0.5, "-half"), (0.0, "-none")]
                    .map(|(part, suffix)| Arc::new(proportions(factors).toned(part).build(&format!("{name}{suffix}"))))
            };
            let canonical = std::array::from_fn(|_| Build::canonical());
            std::iter::once(canonical).chain(NAMED.iter().skip(1).map(toned)).collect()
        });
        &CATALOGUE
    }

    /// Height from the soles to the crown, metres.
    pub fn stature(&self) -> f32 {
        let up = [HIPS, SPINE, SPINE1, SPINE2, NECK, HEAD].map(|j| self.skeleton.joints[j].offset.y);
        up.iter().sum::<f32>() + self.skeleton.joints[HEAD].tip.map_or(0.0, |tip| tip.y)
    }

    /// Length of thigh and shin together, metres.
    pub fn leg(&self) -> f32 {
        leg_length(&self.skeleton)
    }

    pub(crate) fn to_rows(&self) -> BuildRows {
        BuildRows {
            name: self.name.clone(),
            offsets: self.skeleton.joints.iter().map(|j| j.offset).collect(),
            flesh: self.flesh.iter().map(|f| [f.scale.x, f.scale.y, f.scale.z, f.forward]).collect(),
        }
    }

    /// # Errors
    /// Not one row per canonical joint, or bones that no body has.
    pub(crate) fn from_rows(rows: BuildRows) -> Result<Self> {
        let bad =
            |what: &str, problem: String| Err(Error::invalid("build", format!("{:?}, {what}", rows.name), problem));
        for (what, found) in [("offsets", rows.offsets.len()), ("flesh", rows.flesh.len())] {
            if found != JOINT_COUNT {
                return bad(what, format!("expected {JOINT_COUNT} rows, found {found}"));
            }
        }
        let mut build = Self { name: rows.name.clone(), ..Self::default() };
        for (j, joint) in build.skeleton.joints.iter_mut().enumerate() {
            let (ratio, [x, y, z, forward]) = (rows.offsets[j].length() / joint.offset.length(), rows.flesh[j]);
            if !(0.5..=2.0).contains(&ratio) {
                return bad(&joint.name, format!("expected 0.5 to 2 times the canonical bone, found {ratio}"));
            }
            if !([x, y, z].iter().all(|v| (0.25..=4.0).contains(v)) && forward.abs() <= 0.5) {
                return bad(&joint.name, format!("expected flesh that a body can have, found {:?}", rows.flesh[j]));
            }
            joint.offset = rows.offsets[j];
            joint.tip = joint.tip.map(|tip| tip * Vec3::new(x, y, z));
            build.flesh[j] = Flesh { scale: Vec3::new(x, y, z), forward };
        }
        Ok(build)
    }
}

/// Legs, torso, head, arms, shoulders, hips, limbs, chest, waist.
type Factors = [f32; 9];

const NAMED: [(&str, Factors); 8] = [
    ("average", [1.0; 9]),
    ("tall", [1.085, 1.055, 1.015, 1.065, 1.06, 1.02, 1.03, 1.03, 1.01]),
    ("slight", [0.945, 0.945, 0.975, 0.940, 0.90, 1.00, 0.90, 0.91, 0.86]),
    ("sturdy", [0.985, 1.010, 1.010, 0.990, 1.07, 1.07, 1.14, 1.13, 1.30]),
    ("lean", [1.050, 1.020, 0.995, 1.040, 0.97, 0.95, 0.90, 0.91, 0.86]),
    ("small", [0.915, 0.915, 0.965, 0.915, 0.90, 0.98, 0.96, 0.95, 0.96]),
    ("athletic", [1.025, 1.025, 1.000, 1.025, 1.10, 0.98, 1.10, 1.10, 0.96]),
    ("round", [0.955, 0.965, 0.990, 0.955, 1.02, 1.10, 1.12, 1.12, 1.40]),
];

fn proportions([legs, torso, head, arms, shoulders, hips, limbs, chest, waist]: Factors) -> Proportions {
    Proportions { legs, torso, head, arms, shoulders, hips, limbs, chest, waist }
}

fn leg_length(skeleton: &Skeleton) -> f32 {
    skeleton.joints[LEFT_LEG].offset.length() + skeleton.joints[LEFT_FOOT].offset.length()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rest_positions(skeleton: &Skeleton) -> Vec<Vec3> {
        let mut places: Vec<Vec3> = Vec::with_capacity(skeleton.joints.len());
        for joint in &skeleton.joints {
            places.push(joint.parent.map_or(Vec3::ZERO, |p| places[p]) + joint.offset);
        }
        places
    }

    #[test]
    fn builds_differ_stand_on_the_floor_and_are_as_tall_as_people() {
        for build in Build::catalogue().iter().flatten() {
            let rest = rest_positions(&build.skeleton);
            assert!((rest[LEFT_FOOT].y - ANKLE_HEIGHT).abs() < 1e-5, "{}", build.name);
            assert!((1.58..1.90).contains(&build.stature()), "{}: {}", build.name, build.stature());
            for j in 0..JOINT_COUNT {
                let twin = rest[mirror(j)];
                assert!(rest[j].distance(twin * Vec3::new(-1.0, 1.0, 1.0)) < 1e-6, "{}, joint {j}", build.name);
            }
        }
        let statures: Vec<f32> = Build::catalogue().iter().map(|b| b[0].stature()).collect();
        let spread = statures.iter().fold(0.0f32, |a, &s| a.max(s)) - statures.iter().fold(9.0f32, |a, &s| a.min(s));
        assert!(spread > 0.2, "{statures:?}");
        assert!(Build::catalogue().iter().all(|b| &b[2].skeleton == canonical()));
    }

    #[test]
    fn rows_say_everything_and_bad_ones_are_named() {
        for build in Build::catalogue().iter().flatten() {
            assert_eq!(&Build::from_rows(build.to_rows()).unwrap(), build.as_ref());
        }
        let mut rows = Build::canonical().to_rows();
        rows.offsets[LEFT_LEG].y = -9.0;
        let told = Build::from_rows(rows).unwrap_err().to_string();
        assert!(told.contains("left_leg") && told.contains("0.5 to 2"), "{told}");
        let mut rows = Build::canonical().to_rows();
        rows.flesh.pop();
        assert!(Build::from_rows(rows).unwrap_err().to_string().contains("22 rows, found 21"));
    }
}
