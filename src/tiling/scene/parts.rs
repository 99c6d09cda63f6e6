//! What a scene may hold besides walls and wishes.

pub use crate::geom::Periodic;
use crate::geom::{Gate, Ground, Polygon};

/// Which kinds of a patch set are used, by their labels.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct KindFilter {
    /// Only kinds with one of these labels; all if there are none.
    pub only: Vec<String>,
    /// No kinds with one of these.
    pub without: Vec<String>,
}

impl KindFilter {
    /// True if a kind of some labels passes.
    pub fn lets_pass(&self, labels: &[String]) -> bool {
        let has = |wanted: &[String]| wanted.iter().any(|l| labels.contains(l));
        (self.only.is_empty() || has(&self.only)) && !has(&self.without)
    }
}

/// Where people come in.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Source {
    /// Where.
    pub gate: Gate,
    /// When one comes, seconds, in order.
    pub times: Vec<f32>,
    /// Whose they are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub team: Option<String>,
}

/// Where people go out.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Sink {
    /// Where.
    pub gate: Gate,
}

/// The region is covered by tiles with coloured edges, each of which is worked out by itself.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Wang {
    /// Side of a tile, metres.
    pub tile: f32,
    /// In how many ways people cross an edge.
    pub colours: u32,
    /// Tiles for the same four edges.
    pub variants: u32,
}

/// A patch that the user put where it is: the rest is tiled around it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Placed {
    /// Name of the kind.
    pub kind: String,
    /// `world_from_patch`.
    pub at: Ground,
    /// When the patch begins, seconds.
    pub secs: f32,
}

/// People who belong together.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Team {
    /// Its name.
    pub name: String,
    /// How many.
    pub characters: usize,
    /// Where they are at the first moment.
    pub start: Polygon,
    /// Which way they look then, radians; any if none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heading: Option<f32>,
}
