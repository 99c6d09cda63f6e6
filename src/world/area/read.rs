//! Files of areas: which format one is in, by its content, else by its extension; and what its options mean there.

use std::path::Path;

use super::{Coordinates, FloorOptions, Ground, Sign, floor, geojson, svg};
use crate::{Error, Result};

/// How an area's file is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// Of GeoJSON, which has to say.
    pub coordinates: Option<Coordinates>,
    /// Metres of a unit of a drawing; without, the drawing's physical size counts.
    pub metres_per_unit: Option<f64>,
    /// Which floor of a mesh; the largest with usual limits if nothing is said.
    pub floor: Option<FloorOptions>,
}

/// What a file says of walkable ground.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Grounds {
    /// Polygons; what comes first lies on top.
    pub found: Vec<Ground>,
    /// What was left out, in words.
    pub notes: Vec<String>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    GeoJson,
    Svg,
    Gltf,
}

/// The ground of a file.
pub(super) fn load(path: &Path, reading: &Reading, signs: &[Sign]) -> Result<Grounds> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    grounds(path, &bytes, reading, signs).map_err(|e| e.in_file(path))
}

fn grounds(path: &Path, bytes: &[u8], reading: &Reading, signs: &[Sign]) -> Result<Grounds> {
    let format = format(path, bytes)?;
    for (key, given, of) in [
        ("coordinates", reading.coordinates.is_some(), Format::GeoJson),
        ("metres_per_unit", reading.metres_per_unit.is_some(), Format::Svg),
        ("slope_deg, step_m, head_m and height_m", reading.floor.is_some(), Format::Gltf),
    ] {
        if given && of != format {
            let problem = format!("expected {key} with {} only, found {}", of.name(), format.name());
            return Err(Error::invalid("area", "options", problem));
        }
    }
    let text = || {
        let wrong = |e: std::str::Utf8Error| {
            let line = bytes[..e.valid_up_to()].iter().filter(|&&b| b == b'\n').count() + 1;
            Error::invalid("area", format!("line {line}"), "expected text in UTF-8, found other bytes")
        };
        std::str::from_utf8(bytes).map_err(wrong)
    };
    match format {
        Format::GeoJson => {
            let coordinates = reading.coordinates.ok_or_else(|| {
                let problem = "expected coordinates = \"metres\" or \"degrees\" for GeoJSON, found none";
                Error::invalid("area", "options", problem)
            })?;
            let names: Vec<&str> = signs.iter().map(|sign| sign.name.as_str()).collect();
            Ok(Grounds { found: geojson::grounds(text()?, coordinates, &names)?, notes: Vec::new() })
        }
        Format::Svg => svg::grounds(text()?, reading.metres_per_unit, signs),
        Format::Gltf => floor::grounds(bytes, path.parent(), &reading.floor.unwrap_or_default(), signs),
    }
}

impl Format {
    fn name(self) -> &'static str {
        match self {
            Self::GeoJson => "GeoJSON",
            Self::Svg => "SVG",
            Self::Gltf => "glTF",
        }
    }
}

fn format(path: &Path, bytes: &[u8]) -> Result<Format> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let known = match extension.as_str() {
        "geojson" | "json" => Some(Format::GeoJson),
        "svg" => Some(Format::Svg),
        "gltf" | "glb" => Some(Format::Gltf),
        _ => None,
    };
    of_content(bytes).or(known).ok_or_else(|| {
        let problem = "expected an area: GeoJSON (.geojson), SVG (.svg), glTF (.gltf, .glb); found none of them";
        Error::invalid("area", "format", format!("{problem} (.{extension})"))
    })
}

/// The format that a file's beginning tells, or the keys of its JSON.
fn of_content(bytes: &[u8]) -> Option<Format> {
    /// Keys by which the formats in JSON differ.
    #[derive(serde::Deserialize)]
    struct Keys {
        asset: Option<serde::de::IgnoredAny>,
        #[serde(rename = "type")]
        kind: Option<serde::de::IgnoredAny>,
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    match bytes.first() {
        _ if bytes.starts_with(b"glTF") => Some(Format::Gltf),
        Some(b'<') => Some(Format::Svg),
        Some(b'{') => match serde_json::from_slice::<Keys>(bytes) {
            Ok(Keys { asset: Some(_), .. }) => Some(Format::Gltf),
            Ok(Keys { kind: Some(_), .. }) => Some(Format::GeoJson),
            _ => None,
        },
        _ => None,
    }
}
