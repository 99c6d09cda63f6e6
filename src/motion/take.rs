//! The take file (`*.take.json`): several people's captures on one clock, and what is known of them.
//!
//! The generated samples carry one per take as ground truth; for real captures the same file is the hand-written
//! annotation that says which files make a take, how to import them, and where patches begin and end.

use std::path::Path;

use super::{BodyPart, Foot};
use crate::{Error, Result};

/// How a capture's file is to be repaired on import. All optional; the defaults trust the file.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ImportOptions {
    /// Name of a set of repairs for well-known files, e.g. `cmu-mb` (see [`super::presets`]); the options below override
    /// it one by one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// Metres per unit of the file's lengths; by default guessed from the standing height.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub metres_per_unit: Option<f32>,
    /// True frames per second, where the header is wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fps: Option<f32>,
    /// Leading frames to drop (T-poses); default none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drop_first_frames: Option<u32>,
    /// Put back the thorax bone that cgspeed's MotionBuilder conversion lost; default no.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub restore_thorax: Option<bool>,
    /// A rig file that says which joint is which (see [`super::retarget::rigfile`]), beside the capture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rig: Option<String>,
    /// Which character of a file of several (FBX, glTF), by name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub character: Option<String>,
    /// Which animation of a file of several (FBX, glTF), by name; by default the first that moves somebody.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub animation: Option<String>,
    /// The ASF file of an AMC file, relative to it; by default found beside it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skeleton: Option<String>,
}

/// One person of a take.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TakePerson {
    /// Capture file, relative to the take file (or to the capture folder given beside it).
    pub file: String,
    /// Repairs.
    #[serde(default)]
    pub import: ImportOptions,
    /// Which person of a file that holds several: number (from 0) or name; not needed where it holds one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub character: Option<Character>,
    /// Where and when this capture's origin is in the take.
    #[serde(default, skip_serializing_if = "Offset::is_none")]
    pub offset: Offset,
}

/// A person of a capture file that holds several.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(untagged)]
pub enum Character {
    /// By number, from 0.
    Index(usize),
    /// By name.
    Name(String),
}

/// How a capture is moved into its take: first turned about the vertical, then moved over the ground. For people who
/// were captured apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Offset {
    /// When the capture begins, seconds. Where any of a take has one, all are cut to the time that they share, with which
    /// the take's clock begins.
    pub time: f32,
    /// Moved along x, metres (of the capture, before it is scaled to the canonical body).
    pub x: f32,
    /// Moved along z, metres.
    pub z: f32,
    /// Turned, degrees, counter-clockwise from above (from +z towards +x).
    pub heading_deg: f32,
}

impl Offset {
    fn is_none(&self) -> bool {
        *self == Self::default()
    }
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
    /// Name of the pose group, e.g. `stand`, `walk_left` (mid-stance on the left foot), `walk_right`.
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

/// A box that people of the take hold in both hands or sit on, or that rests where it was put down or will be picked up.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TakeProp {
    /// Name, e.g. `box`.
    pub name: String,
    /// Full extents in metres: width between the hands, height, depth.
    pub size: [f32; 3],
    /// Where the box's middle is, seen from the middle between the palms: up, and ahead of the person. Metres.
    #[serde(default)]
    pub grip: [f32; 2],
    /// Who holds it from when to when, in order. Between two holds it rests, unless the second begins when the first
    /// ends or before: then it is passed, and over the time that they share both hold it.
    #[serde(default)]
    pub held: Vec<TakeHold>,
    /// Who sits on it from when to when, in order. Where nobody holds it, it stands on the ground under who sits on it
    /// first, turned as the sitter looks.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sat: Vec<TakeHold>,
    /// How far ahead of a sitter's hips its middle is; negative behind. Metres.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub seat: f32,
}

fn is_zero(value: &f32) -> bool {
    *value == 0.0
}

/// A time over which a person holds a prop between the palms, or sits on it.
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
    /// What it shows, in words; they become labels of patches that are found in it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
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

/// Longest edge of a box that somebody can carry, metres.
const LARGEST_BOX: f32 = 3.0;

impl TakeProp {
    /// What is wrong with the prop itself, each with its place in it.
    fn problems(&self) -> Vec<(String, String)> {
        let mut problems = Vec::new();
        if !self.size.iter().all(|&s| s > 0.0 && s <= LARGEST_BOX) {
            let found = format!("expected three extents above 0 and up to {LARGEST_BOX} m, found {:?}", self.size);
            problems.push((".size".into(), found));
        }
        if !self.grip.iter().all(|g| g.abs() <= LARGEST_BOX) {
            problems.push((".grip".into(), format!("expected up to {LARGEST_BOX} m, found {:?}", self.grip)));
        }
        if self.seat.is_nan() || self.seat.abs() > LARGEST_BOX {
            problems.push((".seat".into(), format!("expected up to {LARGEST_BOX} m, found {}", self.seat)));
        }
        for (k, pair) in self.held.windows(2).enumerate() {
            if !(pair[0].begin < pair[1].begin && pair[0].end < pair[1].end) {
                let found = "expected to begin and to end after the hold before";
                problems.push((
                    format!(".held[{}]", k + 1),
                    format!("{found}, found {} to {}", pair[1].begin, pair[1].end),
                ));
            } else if pair[0].person == pair[1].person && pair[1].begin <= pair[0].end {
                let found = format!("expected another person to take over, found person {} again", pair[1].person);
                problems.push((format!(".held[{}]", k + 1), found));
            }
        }
        problems
    }
}

impl TakeFile {
    /// Reads and checks a take file.
    ///
    /// # Errors
    /// The file cannot be read; the JSON is malformed or has unknown or missing fields (names the line); the first
    /// of [`validate`](Self::validate)'s problems.
    pub fn load(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, e))?;
        Self::parse(&text).map_err(|e| e.in_file(path))
    }

    /// Reads and checks the text of a take file.
    ///
    /// # Errors
    /// As [`load`](Self::load), without the file's name.
    pub fn parse(text: &str) -> Result<Self> {
        let take: Self = serde_json::from_str(text).map_err(|e| {
            let place = format!("line {} column {}", e.line(), e.column());
            Error::invalid("take", place, e.to_string())
        })?;
        match take.validate().into_iter().next() {
            Some(problem) => Err(problem),
            None => Ok(take),
        }
    }

    /// The text of the take file.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("plain data") + "\n"
    }

    /// All problems: another format or version, no people, people who do not exist, times that are not finite,
    /// negative or end before they begin, patches without roles or with one person twice, props without size or held
    /// by people out of order.
    pub fn validate(&self) -> Vec<Error> {
        let mut problems = Vec::new();
        let mut bad = |place: String, problem: String| problems.push(Error::invalid("take", place, problem));
        if (self.format.as_str(), self.version) != ("crowdquilt-take", 1) {
            let found = format!("'{}' version {}", self.format, self.version);
            bad("format".into(), format!("expected 'crowdquilt-take' version 1, found {found}"));
        }
        if self.people.is_empty() {
            bad("people".into(), "expected at least one person, found none".into());
        }
        let mut spans: Vec<(String, usize, f32, f32)> = Vec::new();
        let mut span = |place: String, person: usize, begin: f32, end: f32| spans.push((place, person, begin, end));
        for (i, p) in self.plants.iter().enumerate() {
            span(format!("plants[{i}]"), p.person, p.begin, p.end);
        }
        for (i, c) in self.contacts.iter().enumerate() {
            span(format!("contacts[{i}].a"), c.a.person, c.begin, c.end);
            span(format!("contacts[{i}].b"), c.b.person, c.begin, c.end);
        }
        for (i, p) in self.ports.iter().enumerate() {
            span(format!("ports[{i}]"), p.person, p.time, p.time);
        }
        for (i, prop) in self.props.iter().enumerate() {
            prop.problems().into_iter().for_each(|(place, problem)| bad(format!("props[{i}]{place}"), problem));
            for (k, hold) in prop.held.iter().enumerate() {
                span(format!("props[{i}].held[{k}]"), hold.person, hold.begin, hold.end);
            }
            for (k, seat) in prop.sat.iter().enumerate() {
                span(format!("props[{i}].sat[{k}]"), seat.person, seat.begin, seat.end);
            }
        }
        for patch in &self.patches {
            if patch.roles.is_empty() {
                bad(format!("patch {}", patch.name), "expected at least one role, found none".into());
            }
            for (i, role) in patch.roles.iter().enumerate() {
                span(format!("patch {} roles[{i}]", patch.name), role.person, role.begin, role.end);
                if patch.roles[..i].iter().any(|other| other.person == role.person) {
                    bad(format!("patch {} roles[{i}]", patch.name), format!("person {} twice", role.person));
                }
            }
            if let (Some([begin, end]), Some(role)) = (patch.core, patch.roles.first()) {
                span(format!("patch {} core", patch.name), role.person, begin, end);
            }
        }
        for (place, person, begin, end) in spans {
            if person >= self.people.len() {
                let problem = format!("expected a person below {}, found {person}", self.people.len());
                bad(place, problem);
            } else if !(begin >= 0.0 && end >= begin && end.is_finite()) {
                bad(place, format!("expected times 0 <= begin <= end, found {begin} to {end}"));
            }
        }
        problems
    }
}
