//! GeoJSON (RFC 7946): the polygons of features, collections and bare geometries.

use serde_json::Value;

use super::{Coordinates, Ground};
use crate::{Error, Result};

/// Nobody means coordinates beyond this, metres.
const FARTHEST: f64 = 1e7;
/// Metres of a degree of latitude.
const DEGREE: f64 = 111_195.0;

/// All polygons, about the middle of all coordinates.
pub(super) fn grounds(text: &str, coordinates: Coordinates, templates: &[&str]) -> Result<Vec<Ground>> {
    let bad = |place: String, problem: String| Error::invalid("geojson", place, problem);
    let root: Value =
        serde_json::from_str(text).map_err(|e| bad(format!("line {}", e.line()), format!("expected GeoJSON: {e}")))?;
    let mut found = Vec::new();
    match root["type"].as_str() {
        Some("FeatureCollection") => {
            let features = root["features"].as_array();
            let features = features.ok_or_else(|| bad("features".into(), "expected a list".into()))?;
            for (index, feature) in features.iter().enumerate() {
                read_feature(feature, &format!("feature {index}"), templates, &mut found)?;
            }
        }
        Some("Feature") => read_feature(&root, "feature", templates, &mut found)?,
        Some(_) => read_geometry(&root, "geometry", 0, &mut found)?,
        None => return Err(bad("type".into(), "expected a GeoJSON object with a type, found none".into())),
    }
    if found.is_empty() {
        return Err(bad("features".into(), "expected at least one Polygon or MultiPolygon, found none".into()));
    }
    centre(&mut found, coordinates)?;
    Ok(found)
}

fn read_feature(feature: &Value, place: &str, templates: &[&str], found: &mut Vec<Ground>) -> Result<()> {
    let name = &feature["properties"]["template"];
    let template = match name.as_str() {
        None => 0,
        Some(name) => templates.iter().position(|t| *t == name).ok_or_else(|| {
            Error::invalid("geojson", place, format!("expected a template of {templates:?}, found {name:?}"))
        })?,
    };
    read_geometry(&feature["geometry"], place, template, found)
}

/// Lines and points are nothing to walk on: they are passed over.
fn read_geometry(geometry: &Value, place: &str, template: usize, found: &mut Vec<Ground>) -> Result<()> {
    let coordinates = &geometry["coordinates"];
    match geometry["type"].as_str() {
        Some("Polygon") => found.push(Ground { template: Some(template), rings: rings(coordinates, place)? }),
        Some("MultiPolygon") => {
            for polygon in list(coordinates, place)? {
                found.push(Ground { template: Some(template), rings: rings(polygon, place)? });
            }
        }
        Some("GeometryCollection") => {
            for part in list(&geometry["geometries"], place)? {
                // Collections of collections have no use, and no end.
                if part["type"].as_str() != Some("GeometryCollection") {
                    read_geometry(part, place, template, found)?;
                }
            }
        }
        _ => {}
    }
    Ok(())
}

fn rings(value: &Value, place: &str) -> Result<Vec<Vec<[f64; 2]>>> {
    let point = |p: &Value| {
        let number = |i: usize| p.get(i).and_then(Value::as_f64);
        number(0).zip(number(1)).map(|(x, y)| [x, y]).ok_or_else(|| {
            let short: String = p.to_string().chars().take(60).collect();
            Error::invalid("geojson", place, format!("expected a position [x, y], found {short}"))
        })
    };
    list(value, place)?.iter().map(|ring| list(ring, place)?.iter().map(point).collect()).collect()
}

fn list<'a>(value: &'a Value, place: &str) -> Result<&'a Vec<Value>> {
    value.as_array().ok_or_else(|| Error::invalid("geojson", place, "expected lists of coordinates"))
}

/// Moves everything to the middle, in metres, north towards -z.
fn centre(grounds: &mut [Ground], coordinates: Coordinates) -> Result<()> {
    let all = || grounds.iter().flat_map(|g| g.rings.iter().flatten());
    let least = all().fold([f64::INFINITY; 2], |a, p| [a[0].min(p[0]), a[1].min(p[1])]);
    let most = all().fold([f64::NEG_INFINITY; 2], |a, p| [a[0].max(p[0]), a[1].max(p[1])]);
    let middle = [0, 1].map(|axis| 0.5 * (least[axis] + most[axis]));
    let scale = match coordinates {
        Coordinates::Metres => [1.0, 1.0],
        Coordinates::Degrees => {
            let inside = least[0] >= -180.0 && most[0] <= 180.0 && least[1] >= -90.0 && most[1] <= 90.0;
            if !inside {
                let problem = format!("expected degrees within 180 and 90, found {least:?} to {most:?}");
                return Err(Error::invalid("geojson", "coordinates", problem));
            }
            [DEGREE * middle[1].to_radians().cos(), DEGREE]
        }
    };
    for point in grounds.iter_mut().flat_map(|g| g.rings.iter_mut().flatten()) {
        if !point.iter().all(|v| v.abs() <= FARTHEST) {
            let problem = format!("expected coordinates within {FARTHEST:.0} m, found {point:?}");
            return Err(Error::invalid("geojson", "coordinates", problem));
        }
        *point = [(point[0] - middle[0]) * scale[0], (middle[1] - point[1]) * scale[1]];
    }
    Ok(())
}
