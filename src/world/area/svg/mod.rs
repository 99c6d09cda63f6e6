//! SVG drawings (SVG 1.1 and 2): closed shapes as ground.
//!
//! Only what says where the ground is counts: shapes, groups, transforms, fill and its rule, what is shown. What would draw more
//! than that (text, copies, pictures, clipping) is left out and told. Elements are gone through without recursion, with limits on
//! depth, number and corners, so that no drawing takes for ever.

mod outline;
mod path;
mod scale;
mod style;

use std::collections::BTreeMap;

use geo::{Area as _, BooleanOps, LineString, MultiPolygon, Polygon, bool_ops::FillRule};
use kurbo::Affine;
use roxmltree::{Document, Node, ParsingOptions};

use super::grid::snap;
use super::read::Grounds;
use super::sign::{Meaning, Sign};
use super::{Ground, MOST_CORNERS};
use crate::{Error, Result};
use outline::Ring;
use style::{Fill, Style};

/// No drawing of a place has more elements, or groups within groups.
const MOST_NODES: u32 = 2_000_000;
const DEEPEST: usize = 200;

/// A drawing as it is gone through.
struct Drawing<'a> {
    document: &'a Document<'a>,
    signs: &'a [Sign],
    /// Of every kind of thing that is left out: how many, and the first.
    left_out: BTreeMap<String, (usize, Node<'a, 'a>)>,
    found: Vec<Ground>,
    corners: usize,
}

/// What an element has from those around it.
#[derive(Clone, Copy)]
struct Context {
    metres_from_own: Affine,
    style: Style,
    meaning: Option<Meaning>,
    depth: usize,
}

/// What an element is to us.
enum Kind {
    Group,
    Shape,
    /// It draws something that is not read.
    Other,
    /// It draws nothing.
    Silent,
}

/// All closed shapes, the last one drawn first.
pub(super) fn grounds(text: &str, metres_per_unit: Option<f64>, signs: &[Sign]) -> Result<Grounds> {
    let options = ParsingOptions { allow_dtd: true, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options)
        .map_err(|e| bad(format!("line {}", e.pos().row), format!("expected a sound SVG file, found: {e}")))?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        let problem = format!("expected an svg element, found {:?}", root.tag_name().name());
        return Err(bad(place(&document, root), problem));
    }
    let scale = scale::metres_per_unit(root, metres_per_unit).map_err(|problem| bad("svg", problem))?;
    let mut drawing = Drawing { document: &document, signs, left_out: BTreeMap::new(), found: Vec::new(), corners: 0 };
    let context = Context { metres_from_own: Affine::scale(scale), style: Style::default(), meaning: None, depth: 0 };
    let mut open = vec![(root, context)];
    while let Some((node, around)) = open.pop() {
        let Some(context) = drawing.enter(node, around)? else { continue };
        open.extend(node.children().filter(Node::is_element).rev().map(|child| (child, context)));
    }
    drawing.finish()
}

impl<'a> Drawing<'a> {
    /// Reads an element. Returns what those in it have from it; none if what is in it does not count.
    fn enter(&mut self, node: Node<'a, 'a>, around: Context) -> Result<Option<Context>> {
        let kind = kind(node, around.depth == 0);
        match kind {
            Kind::Silent => return Ok(None),
            Kind::Other => {
                self.leave_out(node, format!("{} elements", node.tag_name().name()));
                return Ok(None);
            }
            Kind::Group | Kind::Shape => {}
        }
        let wrong = |problem: String| bad(place(self.document, node), problem);
        if around.depth > DEEPEST {
            return Err(wrong(format!("expected groups at most {DEEPEST} deep, found deeper ones")));
        }
        let own = style::transform(node).map_err(wrong)?;
        let context = Context {
            metres_from_own: around.metres_from_own * own,
            style: around.style.of(node),
            meaning: style::meaning(node, self.signs).or(around.meaning),
            depth: around.depth + 1,
        };
        if style::property(node, "display") == Some("none") {
            self.leave_out(node, "hidden elements".into());
            return Ok(None);
        }
        for name in ["clip-path", "mask"] {
            if style::property(node, name).is_some_and(|value| value != "none") {
                self.leave_out(node, format!("{name} attributes"));
            }
        }
        if matches!(kind, Kind::Shape) {
            self.shape(node, &context)?;
            return Ok(None);
        }
        Ok(Some(context))
    }

    fn shape(&mut self, node: Node<'a, 'a>, context: &Context) -> Result<()> {
        if !context.style.visible {
            self.leave_out(node, "hidden elements".into());
            return Ok(());
        }
        let Some(meaning) = self.meaning(node, context) else { return Ok(()) };
        let wrong = |problem: String| bad(place(self.document, node), problem);
        let path = outline::path(node).map_err(wrong)?;
        let mut rings = outline::rings(&path, context.metres_from_own, MOST_CORNERS - self.corners).map_err(wrong)?;
        self.corners += rings.iter().map(|ring| ring.corners.len()).sum::<usize>();
        if context.style.fill == Fill::None {
            let before = rings.len();
            rings.retain(|ring| ring.closed);
            if rings.len() < before {
                self.leave_out(node, "open lines without fill".into());
            }
        }
        let shape = surface(&rings, context.style.rule);
        if shape.unsigned_area() < 1e-6 {
            if !rings.is_empty() {
                self.leave_out(node, "shapes without area".into());
            }
            return Ok(());
        }
        let template = match meaning {
            Meaning::Template(template) => Some(template),
            Meaning::Blocked => None,
        };
        let ring = |ring: &LineString<f64>| ring.0.iter().map(|p| [p.x, p.y]).collect();
        self.found.extend(shape.0.iter().map(|polygon| Ground {
            template,
            rings: std::iter::once(polygon.exterior()).chain(polygon.interiors()).map(ring).collect(),
        }));
        Ok(())
    }

    /// What a shape is: by words, else by its colour, else of the first template if none has a colour.
    fn meaning(&mut self, node: Node<'a, 'a>, context: &Context) -> Option<Meaning> {
        if context.meaning.is_some() {
            return context.meaning;
        }
        let coloured = self.signs.iter().any(|sign| sign.colour.is_some());
        let fill = context.style.fill;
        let by_colour = |colour| self.signs.iter().position(|sign| sign.colour == Some(colour));
        let found = match fill {
            Fill::Colour(colour) if coloured => by_colour(colour),
            Fill::Colour(_) | Fill::Other if !coloured => Some(0),
            _ => None,
        };
        if found.is_none() {
            self.leave_out(node, format!("shapes {} that name no template", fill.in_words()));
        }
        found.map(Meaning::Template)
    }

    fn leave_out(&mut self, node: Node<'a, 'a>, what: String) {
        self.left_out.entry(what).or_insert((0, node)).0 += 1;
    }

    fn finish(mut self) -> Result<Grounds> {
        let note = |(what, (count, first)): (&String, &(usize, Node))| {
            format!("left out: {count} {what}, the first at {}", place(self.document, *first))
        };
        let notes: Vec<String> = self.left_out.iter().map(note).collect();
        if !self.found.iter().any(|ground| ground.template.is_some()) {
            let told: String = notes.iter().map(|note| format!("; {note}")).collect();
            return Err(bad("svg", format!("expected at least one closed shape to walk on, found none{told}")));
        }
        self.found.reverse();
        Ok(Grounds { found: self.found, notes })
    }
}

/// What rings surround by a fill rule.
fn surface(rings: &[Ring], rule: FillRule) -> MultiPolygon<f64> {
    let line = |ring: &Ring| LineString::from(ring.corners.iter().map(|p| (snap(p.x), snap(p.y))).collect::<Vec<_>>());
    let all = rings.iter().filter(|ring| ring.corners.len() > 2).map(|ring| Polygon::new(line(ring), Vec::new()));
    MultiPolygon::new(all.collect()).union_with_fill_rule(&MultiPolygon::new(Vec::new()), rule)
}

fn kind(node: Node, root: bool) -> Kind {
    let drawn = node.tag_name().namespace().is_none_or(|space| space == "http://www.w3.org/2000/svg");
    match node.tag_name().name() {
        _ if !drawn => Kind::Silent,
        "svg" if root => Kind::Group,
        "g" | "a" => Kind::Group,
        "path" | "rect" | "circle" | "ellipse" | "polygon" | "polyline" => Kind::Shape,
        "text" | "use" | "image" | "foreignObject" | "svg" | "switch" | "style" => Kind::Other,
        _ => Kind::Silent,
    }
}

fn bad(place: impl Into<String>, problem: impl Into<String>) -> Error {
    Error::invalid("svg", place, problem)
}

/// Where an element is, and which.
fn place(document: &Document, node: Node) -> String {
    let line = document.text_pos_at(node.range().start).row;
    let id = node.attribute("id").map(|id| format!(" {id:.40?}")).unwrap_or_default();
    format!("line {line}: {}{id}", node.tag_name().name())
}
