//! Worlds from walkable ground: polygons cut into convex cells, each a crowd patch.
//!
//! "Crowd Patches" (2009), section 5, top-down: here any ground will do, not only a grid. Polygons are repaired (`repair.rs`),
//! cut into convex cells of sane shape (`cells.rs`), borders get patterns by their length (`patterns.rs`), and cells become
//! patches (`solve.rs`). What cannot be as the file says is repaired or left out, and told.

mod cells;
mod geojson;
mod patterns;
mod repair;
mod solve;

use std::path::Path;

use super::{Layout, Template, WorldScene};
use crate::stage::World;
use crate::{Error, Result};
pub(super) use solve::Works;

/// Walkable ground and who is on it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Area {
    /// The templates; ground that names none is of the first.
    pub templates: Vec<Template>,
    /// Walkable polygons.
    pub grounds: Vec<Ground>,
    /// Size that cells should have, metres.
    pub side: f32,
    /// Period, seconds.
    pub period: f32,
    /// Same seed, same world.
    pub seed: u64,
}

/// A walkable polygon as a file says it: perhaps broken.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Ground {
    /// Which template it is of.
    pub template: usize,
    /// Its outline, then its holes: x, z in metres.
    pub rings: Vec<Vec<[f64; 2]>>,
}

/// How coordinates of a map are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinates {
    /// Metres; the second number grows to the north.
    Metres,
    /// Degrees of longitude and latitude, as GeoJSON has them.
    Degrees,
}

/// A world, and what had to be changed or left out on the way.
#[derive(Clone, Debug)]
pub struct Built {
    /// The world.
    pub world: World,
    /// In words; empty if all is as the scene says.
    pub notes: Vec<String>,
}

impl Area {
    /// The polygons of a GeoJSON file. A feature's property `template` names its template; north is -z, the middle of the map
    /// is the origin.
    ///
    /// # Errors
    /// If the file is no GeoJSON, has no polygons, or a number or a name in it cannot be: names the feature.
    pub fn grounds_of_geojson(text: &str, coordinates: Coordinates, templates: &[Template]) -> Result<Vec<Ground>> {
        geojson::grounds(text, coordinates, templates)
    }

    /// The same of a file.
    ///
    /// # Errors
    /// As [`Self::grounds_of_geojson`], or it cannot be read.
    pub fn load_geojson(path: &Path, coordinates: Coordinates, templates: &[Template]) -> Result<Vec<Ground>> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, e))?;
        Self::grounds_of_geojson(&text, coordinates, templates).map_err(|e| e.in_file(path))
    }

    /// Builds the world; on all cores, the result does not depend on their number. `progress` is told how many of how many
    /// patches are done, and stops the work by returning false.
    ///
    /// # Errors
    /// If nothing walkable is left, the area is too large, or it was stopped.
    pub fn build(&self, name: &str, progress: &(dyn Fn(usize, usize) -> bool + Sync)) -> Result<Built> {
        let layout = Layout::Area(self.clone());
        WorldScene { name: name.into(), layout }.build(progress)
    }
}
