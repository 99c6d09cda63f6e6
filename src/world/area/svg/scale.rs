//! How large a drawing is.

use std::str::FromStr;

use roxmltree::Node;
use svgtypes::{Length, LengthUnit, ViewBox};

use super::path::LARGEST;

/// Metres of an inch, and units of an inch where nothing else is said (CSS).
const INCH: f64 = 0.0254;
pub(super) const UNITS_PER_INCH: f64 = 96.0;
/// Scales of drawings that mean a place.
const SCALES: std::ops::RangeInclusive<f64> = 1e-6..=1e4;

/// Metres of a unit: as given, else by the drawing's physical width.
pub(super) fn metres_per_unit(root: Node, given: Option<f64>) -> Result<f64, String> {
    let scale = match given {
        Some(given) => given,
        None => physical(root)?,
    };
    if SCALES.contains(&scale) {
        return Ok(scale);
    }
    Err(format!("expected metres per unit from {} to {}, found {scale}", SCALES.start(), SCALES.end()))
}

/// Width in the world by width of the view box.
fn physical(root: Node) -> Result<f64, String> {
    let size = |name: &str| {
        let length = Length::from_str(root.attribute(name)?).ok()?;
        metres(length.unit).map(|metres| length.number * metres)
    };
    let width = size("width").ok_or_else(|| {
        let found = root.attribute("width").map_or("none".into(), |text| format!("{text:.30?}"));
        format!("expected metres_per_unit, or a width in mm, cm, in, pt or pc, found {found}")
    })?;
    let Some(text) = root.attribute("viewBox") else { return Ok(INCH / UNITS_PER_INCH) };
    let view = ViewBox::from_str(text).map_err(|e| format!("expected a viewBox, found {text:.60?}: {e}"))?;
    let scales = [Some(width / view.w), size("height").map(|height| height / view.h)];
    match scales {
        [Some(x), Some(y)] if (x - y).abs() > 0.01 * x.abs() => {
            Err(format!("expected one scale for width and height, found {x} and {y} m per unit: say metres_per_unit"))
        }
        _ => Ok(width / view.w),
    }
}

/// Metres of a physical unit.
fn metres(unit: LengthUnit) -> Option<f64> {
    match unit {
        LengthUnit::Mm => Some(0.001),
        LengthUnit::Cm => Some(0.01),
        LengthUnit::In => Some(INCH),
        LengthUnit::Pt => Some(INCH / 72.0),
        LengthUnit::Pc => Some(INCH / 6.0),
        _ => None,
    }
}

/// A length within the drawing, in its units.
pub(super) fn units(text: &str) -> Result<f64, String> {
    let wrong = || format!("expected a length in units of the drawing, px, mm, cm, in, pt or pc, found {text:.40?}");
    let length = Length::from_str(text.trim()).map_err(|_| wrong())?;
    if length.number.is_nan() || length.number.abs() > LARGEST {
        return Err(format!("expected a length of at most {LARGEST:e}, found {text:.40?}"));
    }
    match length.unit {
        LengthUnit::None | LengthUnit::Px => Ok(length.number),
        unit => metres(unit).map(|metres| length.number * metres / INCH * UNITS_PER_INCH).ok_or_else(wrong),
    }
}
