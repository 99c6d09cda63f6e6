//! The take file (`*.take.json`): several people's captures on one clock, and what is known of them.
//!
//! The generated samples carry one per take as ground truth; for real captures the same file is the hand-written
//! annotation that says which files make a take, how to import them, and where patches begin and end.

use super::{BodyPart, Foot};

/// How a capture's file is to be repaired on import. All optional; the defaults trust the file.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ImportOptions {
    /// Metres per unit of the file's lengths; by default guessed from the standing height.
    pub metres_per_unit: Option<f32>,
    /// True frames per second, where the header is wrong.
    pub fps: Option<f32>,
    /// Leading frames to drop (T-poses).
    pub drop_first_frames: u32,
    /// Put back the thorax bone that cgspeed's MotionBuilder conversion lost.
    pub restore_thorax: bool,
}

/// One person of a take.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TakePerson {
    /// Capture file, relative to the take file (or to the capture folder given beside it).
    pub file: String,
    /// Repairs.
    #[serde(default)]
    pub import: ImportOptions,
}

/// A foot plant, in seconds of the take.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TakePlant {
    /// Index of the person.
    pub person: usize,
    /// Which foot.
    pub foot: Foot,
    /// From.
    pub begin: f32,
    /// To.
    pub end: f32,
}

/// One side of a contact.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Touch {
    /// Index of the person (of a take) or role (of a patch).
    pub person: usize,
    /// With what.
    pub part: BodyPart,
}

/// Two people touching, in seconds of the take.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TakeContact {
    /// One side.
    pub a: Touch,
    /// The other.
    pub b: Touch,
    /// From.
    pub begin: f32,
    /// To.
    pub end: f32,
}

/// A moment at which a patch may begin or end for a person: a recurring pose (gait phase, standing).
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TakePort {
    /// Index of the person.
    pub person: usize,
    /// When, in seconds of the take.
    pub time: f32,
    /// Name of the pose group, e.g. `stand`, `walk_left` (left foot strikes), `walk_right`.
    pub pose: String,
}

/// One person's part in a patch.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TakeRole {
    /// Index of the person in the take.
    pub person: usize,
    /// First moment; must be one of the person's ports.
    pub begin: f32,
    /// Last moment; must be one of the person's ports.
    pub end: f32,
}

/// A motion patch to cut out of the take.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TakePatch {
    /// Name of the patch kind.
    pub name: String,
    /// Free words.
    #[serde(default)]
    pub labels: Vec<String>,
    /// Who takes part, from when to when.
    pub roles: Vec<TakeRole>,
    /// The time of interaction (seconds) over which people's relative placement must not change; absent if alone.
    #[serde(default)]
    pub core: Option<[f32; 2]>,
}

/// A box that people of the take hold in both hands, or that rests on the ground between holders.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TakeProp {
    /// Name, e.g. `box`.
    pub name: String,
    /// Full extents in metres: width between the hands, height, depth.
    pub size: [f32; 3],
    /// Who holds it from when to when, in order; the last holder begins where the one before ends.
    pub held: Vec<TakeHold>,
}

/// A time over which a person holds a prop between the palms.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TakeHold {
    /// Index of the person.
    pub person: usize,
    /// From, in seconds of the take.
    pub begin: f32,
    /// To.
    pub end: f32,
}

/// A take file.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TakeFile {
    /// Always `crowdquilt-take`.
    pub format: String,
    /// Always 1.
    pub version: u32,
    /// Name of the take.
    pub name: String,
    /// The people.
    pub people: Vec<TakePerson>,
    /// Foot plants; detected where the list is empty.
    #[serde(default)]
    pub plants: Vec<TakePlant>,
    /// Contacts.
    #[serde(default)]
    pub contacts: Vec<TakeContact>,
    /// Where patches may begin and end.
    #[serde(default)]
    pub ports: Vec<TakePort>,
    /// Patches to cut.
    #[serde(default)]
    pub patches: Vec<TakePatch>,
    /// Props.
    #[serde(default)]
    pub props: Vec<TakeProp>,
}
