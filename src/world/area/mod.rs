//! Worlds from walkable ground: polygons cut into convex cells, each a crowd patch.
//!
//! "Crowd Patches" (2009), section 5, top-down: here any ground will do, not only a grid. Polygons come from maps (`geojson.rs`),
//! drawings (`svg/`) or the floor of a mesh (`floor/`). Then all is one: they are repaired (`repair.rs`), cut into convex cells of
//! sane shape (`cells.rs`), borders get patterns by their length (`patterns.rs`), and cells become patches (`solve.rs`). What
//! cannot be as the file says is repaired or left out, and told.

mod cells;
mod floor;
mod geojson;
mod grid;
mod patterns;
mod read;
mod repair;
mod sign;
mod solve;
mod svg;

use std::path::Path;

use super::{Goal, Layout, Template, WorldScene};
use crate::Result;
use crate::stage::World;
pub use floor::FloorOptions;
pub use read::{Grounds, Reading};
pub use sign::Sign;
pub(super) use solve::Works;

/// Outlines of areas have at most so many corners.
const MOST_CORNERS: usize = 20_000;
/// Drawings and meshes are within this of their origin, metres.
const FARTHEST: f64 = 1e5;

/// Walkable ground and who is on it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Area {
    /// The templates; ground that names none is of the first.
    pub templates: Vec<Template>,
    /// Walkable polygons, and blocked ones; where several lie on each other the first counts.
    pub grounds: Vec<Ground>,
    /// Size that cells should have, metres.
    pub side: f32,
    /// Period, seconds.
    pub period: f32,
    /// Who goes where on purpose.
    #[serde(default)]
    pub goals: Vec<Goal>,
    /// What reading the ground left out, in words.
    #[serde(default)]
    pub notes: Vec<String>,
    /// Same seed, same world.
    pub seed: u64,
}

/// A polygon as a file says it: perhaps broken.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Ground {
    /// Which template it is of; none where nobody can walk, whatever else is there.
    pub template: Option<usize>,
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
        let names: Vec<&str> = templates.iter().map(|t| t.name.as_str()).collect();
        geojson::grounds(text, coordinates, &names)
    }

    /// The closed shapes of an SVG drawing; its x is the world's, its y (down the page) is z. Curves are followed to within 2 cm.
    ///
    /// A shape is what one of its words says: of `class`, Inkscape's `label` or `id`, of its own or of the nearest group around it
    /// that has such a word. A word is a template's name or key, or `blocked`. Where there is none, a shape is of the template of
    /// its fill colour; where no template has a colour, of the first.
    ///
    /// # Errors
    /// If the file is no SVG, is without a scale, or a shape in it cannot be: names line and shape.
    pub fn grounds_of_svg(text: &str, metres_per_unit: Option<f64>, signs: &[Sign]) -> Result<Grounds> {
        svg::grounds(text, metres_per_unit, signs)
    }

    /// One storey of the floor of a mesh in glTF, in its own coordinates: triangles that are not too steep, without what has
    /// anything above it that is too high to step on and too low to walk under. Materials and nodes name templates as shapes of
    /// drawings do. `folder` is where files beside it lie; without one they are refused.
    ///
    /// # Errors
    /// If the file is not sound, or too large, or there is no floor: names mesh and primitive.
    pub fn grounds_of_mesh(
        bytes: &[u8],
        folder: Option<&Path>,
        options: &FloorOptions,
        signs: &[Sign],
    ) -> Result<Grounds> {
        floor::grounds(bytes, folder, options, signs)
    }

    /// The ground of a file: GeoJSON, SVG or glTF, told by its content, else by its extension.
    ///
    /// # Errors
    /// As those of the formats, if it cannot be read, or `reading` says what the format does not know.
    pub fn load_grounds(path: &Path, reading: &Reading, signs: &[Sign]) -> Result<Grounds> {
        read::load(path, reading, signs)
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
