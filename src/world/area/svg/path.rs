//! Path data (SVG 1.1, section 8.3) as curves in absolute coordinates; arcs are as precise as their size asks for.

use kurbo::{Arc, BezPath, PathEl, Point, SvgArc, Vec2};
use svgtypes::{PathParser, PathSegment};

/// How far curves may be off an arc, of its radius.
pub(super) const PRECISION: f64 = 1e-6;

/// Numbers beyond this mean no place.
pub(super) const LARGEST: f64 = 1e12;

/// The curves of path data.
///
/// # Errors
/// In words, with the place in the text.
pub(super) fn curves(text: &str) -> Result<BezPath, String> {
    let mut pen = Pen { path: BezPath::new(), at: Point::ZERO, begin: Point::ZERO, last: Last::Other };
    for segment in PathParser::from(text) {
        pen.draw(segment.map_err(|e| format!("expected path data, found: {e}"))?);
    }
    Ok(pen.path)
}

/// The control point that a smooth curve goes on from.
enum Last {
    Cubic(Point),
    Quadratic(Point),
    Other,
}

struct Pen {
    path: BezPath,
    at: Point,
    /// Where the part of the path began.
    begin: Point,
    last: Last,
}

impl Pen {
    fn draw(&mut self, segment: PathSegment) {
        use PathSegment as S;
        let at = self.at;
        let place = |abs: bool, x: f64, y: f64| if abs { Point::new(x, y) } else { at + Vec2::new(x, y) };
        match segment {
            S::MoveTo { abs, x, y } => {
                self.begin = place(abs, x, y);
                self.end(PathEl::MoveTo(self.begin), self.begin, Last::Other);
            }
            S::LineTo { abs, x, y } => self.line(place(abs, x, y)),
            S::HorizontalLineTo { abs, x } => self.line(Point::new(if abs { x } else { at.x + x }, at.y)),
            S::VerticalLineTo { abs, y } => self.line(Point::new(at.x, if abs { y } else { at.y + y })),
            S::CurveTo { abs, x1, y1, x2, y2, x, y } => {
                self.cubic(place(abs, x1, y1), place(abs, x2, y2), place(abs, x, y));
            }
            S::SmoothCurveTo { abs, x2, y2, x, y } => {
                let first = if let Last::Cubic(control) = self.last { at + (at - control) } else { at };
                self.cubic(first, place(abs, x2, y2), place(abs, x, y));
            }
            S::Quadratic { abs, x1, y1, x, y } => self.quadratic(place(abs, x1, y1), place(abs, x, y)),
            S::SmoothQuadratic { abs, x, y } => {
                let control = if let Last::Quadratic(control) = self.last { at + (at - control) } else { at };
                self.quadratic(control, place(abs, x, y));
            }
            S::EllipticalArc { abs, rx, ry, x_axis_rotation, large_arc, sweep, x, y } => {
                let to = place(abs, x, y);
                let (radii, x_rotation) = (Vec2::new(rx, ry), x_axis_rotation.to_radians());
                self.arc(&SvgArc { from: at, to, radii, x_rotation, large_arc, sweep });
            }
            S::ClosePath { .. } => self.end(PathEl::ClosePath, self.begin, Last::Other),
        }
    }

    fn end(&mut self, element: PathEl, at: Point, last: Last) {
        if !matches!(element, PathEl::MoveTo(_)) && !self.is_drawing() {
            // Whoever draws on after closing begins where the last part began.
            self.path.move_to(self.begin);
        }
        self.path.push(element);
        (self.at, self.last) = (at, last);
    }

    fn is_drawing(&self) -> bool {
        self.path.elements().last().is_some_and(|last| *last != PathEl::ClosePath)
    }

    fn line(&mut self, to: Point) {
        self.end(PathEl::LineTo(to), to, Last::Other);
    }

    fn cubic(&mut self, first: Point, second: Point, to: Point) {
        self.end(PathEl::CurveTo(first, second, to), to, Last::Cubic(second));
    }

    fn quadratic(&mut self, control: Point, to: Point) {
        self.end(PathEl::QuadTo(control, to), to, Last::Quadratic(control));
    }

    /// An arc; a line where a radius is nothing (SVG 1.1, section F.6.2), or so large that it makes no difference.
    fn arc(&mut self, arc: &SvgArc) {
        let [from, to] = [arc.from, arc.to].map(Point::to_vec2);
        let plain = [from, to, arc.radii].iter().all(|v| v.x.abs().max(v.y.abs()) <= LARGEST);
        let Some(curves) = Some(arc).filter(|_| plain).and_then(Arc::from_svg_arc) else { return self.line(arc.to) };
        let radius = curves.radii.x.abs().max(curves.radii.y.abs());
        let elements: Vec<PathEl> = curves.append_iter(PRECISION * radius).collect();
        let count = elements.len();
        for (index, element) in elements.into_iter().enumerate() {
            match element {
                // The last one ends where the data says.
                PathEl::CurveTo(a, b, end) => self.cubic(a, b, if index + 1 == count { arc.to } else { end }),
                other => self.path.push(other),
            }
        }
        self.last = Last::Other;
    }
}
