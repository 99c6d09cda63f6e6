//! Shapes as rings of corners, in metres.

use kurbo::{Affine, BezPath, Ellipse, PathEl, Point, Shape};
use roxmltree::Node;
use svgtypes::NumberListParser;

use super::path::{PRECISION, curves};
use super::scale;
use crate::world::area::{FARTHEST, MOST_CORNERS};

/// Curves are followed to within this, metres.
const TOLERANCE: f64 = 0.02;

/// A part of a shape.
pub(super) struct Ring {
    pub corners: Vec<Point>,
    /// Whether it ends where it began.
    pub closed: bool,
}

/// The outline of a shape in its own coordinates; of none, if it says that it has none.
///
/// # Errors
/// In words: which attribute is not what it must be.
pub(super) fn path(node: Node) -> Result<BezPath, String> {
    let number = |name: &str| node.attribute(name).map_or(Ok(0.0), |text| of_attribute(name, scale::units(text)));
    match node.tag_name().name() {
        "path" => of_attribute("d", curves(node.attribute("d").unwrap_or_default())),
        "rect" => {
            let [x, y, w, h] = ["x", "y", "width", "height"].map(number);
            rect(node, [x?, y?, size("width", w?)?, size("height", h?)?])
        }
        "circle" => Ok(ellipse(number("cx")?, number("cy")?, [size("r", number("r")?)?; 2])),
        "ellipse" => {
            let radii = [size("rx", number("rx")?)?, size("ry", number("ry")?)?];
            Ok(ellipse(number("cx")?, number("cy")?, radii))
        }
        name => points(node.attribute("points").unwrap_or_default(), name == "polygon"),
    }
}

fn of_attribute<T>(name: &str, found: Result<T, String>) -> Result<T, String> {
    found.map_err(|problem| format!("{name}: {problem}"))
}

fn size(name: &str, value: f64) -> Result<f64, String> {
    if value >= 0.0 { Ok(value) } else { Err(format!("{name}: expected 0 or more, found {value}")) }
}

/// A box, perhaps with round corners; one radius alone counts for both.
fn rect(node: Node, [x, y, w, h]: [f64; 4]) -> Result<BezPath, String> {
    let radius = |name: &str| match node.attribute(name) {
        None | Some("auto") => Ok(None),
        Some(text) => of_attribute(name, scale::units(text)).and_then(|r| size(name, r)).map(Some),
    };
    let (rx, ry) = (radius("rx")?, radius("ry")?);
    let (rx, ry) = (rx.or(ry).unwrap_or(0.0).min(0.5 * w), ry.or(rx).unwrap_or(0.0).min(0.5 * h));
    if w == 0.0 || h == 0.0 {
        return Ok(BezPath::new());
    }
    let text = if rx > 0.0 && ry > 0.0 {
        let (inner, deep) = (w - 2.0 * rx, h - 2.0 * ry);
        let arc = |dx: f64, dy: f64| format!("a{rx},{ry} 0 0 1 {dx},{dy}");
        let corners = [arc(rx, ry), arc(-rx, ry), arc(-rx, -ry), arc(rx, -ry)];
        let [a, b, c, d] = corners;
        format!("M{},{y}h{inner}{a}v{deep}{b}h{}{c}v{}{d}z", x + rx, -inner, -deep)
    } else {
        format!("M{x},{y}h{w}v{h}h{}z", -w)
    };
    curves(&text)
}

fn ellipse(x: f64, y: f64, [rx, ry]: [f64; 2]) -> BezPath {
    if rx == 0.0 || ry == 0.0 {
        return BezPath::new();
    }
    let ellipse = Ellipse::new(Point::new(x, y), (rx, ry), 0.0);
    let mut path = ellipse.to_path(PRECISION * rx.max(ry));
    path.close_path();
    path
}

fn points(text: &str, closed: bool) -> Result<BezPath, String> {
    let wrong = |found: String| format!("points: expected pairs of numbers, found {found}");
    let numbers = NumberListParser::from(text).collect::<Result<Vec<f64>, _>>().map_err(|e| wrong(e.to_string()))?;
    if !numbers.len().is_multiple_of(2) {
        return Err(wrong(format!("{} numbers", numbers.len())));
    }
    let mut path = BezPath::new();
    for (index, pair) in numbers.chunks_exact(2).enumerate() {
        let place = Point::new(pair[0], pair[1]);
        path.push(if index == 0 { PathEl::MoveTo(place) } else { PathEl::LineTo(place) });
    }
    if closed && !path.is_empty() {
        path.close_path();
    }
    Ok(path)
}

/// The rings of a path, with at most so many corners.
///
/// # Errors
/// In words: it is too far away, or has more corners.
pub(super) fn rings(path: &BezPath, metres_from_own: Affine, most: usize) -> Result<Vec<Ring>, String> {
    let (mut rings, mut left, mut last): (Vec<Ring>, usize, Point) = (Vec::new(), most, Point::ZERO);
    for element in path.iter().map(|element| metres_from_own * element) {
        near(element)?;
        match (element, rings.last_mut()) {
            (PathEl::MoveTo(begin), _) => {
                rings.push(Ring { corners: vec![begin], closed: false });
                last = begin;
            }
            (PathEl::ClosePath, Some(ring)) => {
                ring.closed = true;
                last = ring.corners[0];
            }
            (element, Some(ring)) => {
                let before = ring.corners.len();
                kurbo::flatten([PathEl::MoveTo(last), element], TOLERANCE, |flat| {
                    if let PathEl::LineTo(corner) = flat {
                        ring.corners.push(corner);
                    }
                });
                last = element.end_point().unwrap_or(last);
                let added = ring.corners.len() - before;
                let problem = || format!("expected at most {MOST_CORNERS} corners in all, found more");
                left = left.checked_sub(added).ok_or_else(problem)?;
            }
            (_, None) => {}
        }
    }
    for ring in &mut rings {
        ring.closed |= ring.corners.len() > 2 && ring.corners.first() == ring.corners.last();
    }
    Ok(rings)
}

/// Nobody means places farther away.
fn near(element: PathEl) -> Result<(), String> {
    let points = match element {
        PathEl::MoveTo(a) | PathEl::LineTo(a) => [a; 3],
        PathEl::QuadTo(a, b) => [a, b, b],
        PathEl::CurveTo(a, b, c) => [a, b, c],
        PathEl::ClosePath => return Ok(()),
    };
    match points.iter().find(|p| !(p.x.abs() <= FARTHEST && p.y.abs() <= FARTHEST)) {
        None => Ok(()),
        Some(p) => Err(format!("expected places within {FARTHEST} m of the origin, found [{}, {}] m", p.x, p.y)),
    }
}
