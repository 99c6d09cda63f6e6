//! What a compose file says, names resolved.

use crate::Error;
use crate::deform::Limits;
use crate::geom::Ground;
use crate::motion::{BodyPart, Foot};

/// A composition: rows are laid out, names are indices.
#[derive(Clone, Debug)]
pub(super) struct Composition {
    pub name: String,
    pub labels: Vec<String>,
    pub limits: Limits,
    pub clips: Vec<Clip>,
    pub roles: Vec<Role>,
    pub places: Vec<Place>,
    pub touches: Vec<Touches>,
    pub props: Vec<Prop>,
}

/// A piece of a take.
#[derive(Clone, Debug)]
pub(super) struct Clip {
    pub name: String,
    pub piece: Piece,
    /// The arm of which the other is to be the mirror image, if any.
    pub arms: Option<Foot>,
    /// Whether it is seen in a mirror.
    pub mirror: bool,
    /// Whether it ends in the pose in which it begins.
    pub looped: bool,
    /// Where it ends, seen from where it begins, if not as captured.
    pub end: Option<Ground>,
    pub line: usize,
}

/// Where a clip comes from.
#[derive(Clone, Debug)]
pub(super) enum Piece {
    /// What a person of a take does between two times, seconds.
    Take { name: String, person: usize, from: Option<f32>, to: Option<f32> },
    /// A role of a patch.
    Patch { name: String, role: usize },
}

/// Somebody, who plays clips.
#[derive(Clone, Debug)]
pub(super) struct Role {
    pub name: String,
    /// Indices of clips.
    pub plays: Vec<usize>,
    /// Where and when the first clip begins.
    pub start: Option<(Ground, Option<f32>)>,
    pub line: usize,
}

/// A moment of a role, or all of a clip.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Moment {
    pub role: usize,
    /// Index into what the role plays; `None`: all.
    pub part: Option<usize>,
    /// Seconds since that began; `None`: all through.
    pub seconds: Option<f32>,
    /// As written.
    pub text: String,
}

/// Where somebody stands, seen from another, at one moment or all through a clip.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub who: Moment,
    pub seen_from: Moment,
    pub at: Ground,
    /// Seconds by which `who` is later than what `seen_from` says.
    pub delay: f32,
    pub line: usize,
}

/// Hands that touch from one moment to another.
#[derive(Clone, Debug)]
pub(super) struct Touches {
    pub sides: [(usize, BodyPart); 2],
    pub from: Moment,
    pub to: Moment,
    pub line: usize,
}

/// A box, and who has it in the hands or sits on it, one after the other.
#[derive(Clone, Debug)]
pub(super) struct Prop {
    pub name: String,
    /// Full extents and grip, where the clips do not say them.
    pub size: Option<[f32; 3]>,
    pub grip: Option<[f32; 2]>,
    pub held: Vec<Use>,
    pub sat: Vec<Use>,
    /// Seconds for which it rests where one puts it down and the next takes it up.
    pub rest: f32,
    pub line: usize,
}

/// Somebody who holds a box or sits on it.
#[derive(Clone, Debug)]
pub(super) struct Use {
    pub who: Moment,
    /// From when to when, where the clip does not say it; a carried box's end that is left out is the clip's.
    pub span: [Option<Moment>; 2],
    /// How they look against the one before, radians.
    pub turn: f32,
    /// Where they have it at some moments, in order, where the clips know of no box; else empty.
    pub carried: Vec<Carried>,
}

/// Where somebody has a box at a moment, seen from the person.
#[derive(Clone, Debug)]
pub(super) struct Carried {
    pub at: Moment,
    /// Its middle above the ground, metres.
    pub up: f32,
    /// Its middle ahead of the hips, metres.
    pub ahead: f32,
}

/// A problem at a line of the file.
pub(super) fn bad(line: usize, problem: String) -> Error {
    Error::invalid("compose file", format!("line {line}"), problem)
}
