//! What elements inherit: fill, fill rule, whether they are shown; their transforms; and which template their words name.

use std::str::FromStr;

use geo::bool_ops::FillRule;
use kurbo::Affine;
use roxmltree::Node;
use svgtypes::{Color, Transform};

use crate::world::area::sign::{self, Meaning, Sign};

/// What a shape is filled with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fill {
    None,
    Colour([u8; 3]),
    /// A gradient or a pattern.
    Other,
}

/// What is inherited, as far as it counts.
#[derive(Clone, Copy)]
pub(super) struct Style {
    pub fill: Fill,
    pub rule: FillRule,
    pub visible: bool,
}

impl Default for Style {
    fn default() -> Self {
        Self { fill: Fill::Colour([0; 3]), rule: FillRule::NonZero, visible: true }
    }
}

impl Style {
    /// The style of an element within one of this style. What cannot be understood is as if it were not there, as in browsers.
    pub fn of(self, node: Node) -> Self {
        let fill = match property(node, "fill") {
            None | Some("inherit") => self.fill,
            Some("none" | "transparent") => Fill::None,
            Some(text) if text.starts_with("url") || text.eq_ignore_ascii_case("currentcolor") => Fill::Other,
            Some(text) => Color::from_str(text).map_or(self.fill, |c| Fill::Colour([c.red, c.green, c.blue])),
        };
        let rule = match property(node, "fill-rule") {
            Some("evenodd") => FillRule::EvenOdd,
            Some("nonzero") => FillRule::NonZero,
            _ => self.rule,
        };
        let visible = match property(node, "visibility") {
            Some("hidden" | "collapse") => false,
            Some("visible") => true,
            _ => self.visible,
        };
        Self { fill, rule, visible }
    }
}

impl Fill {
    /// As a message has it.
    pub fn in_words(self) -> String {
        match self {
            Self::None => "without fill".into(),
            Self::Colour([r, g, b]) => format!("of colour #{r:02x}{g:02x}{b:02x}"),
            Self::Other => "filled with a gradient or pattern".into(),
        }
    }
}

/// A property of an element itself: of its `style`, else the attribute of that name.
pub(super) fn property<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    let declared = |text: &'a str| {
        let mut pairs = text.split(';').filter_map(|declaration| declaration.split_once(':'));
        let value = pairs.rfind(|(key, _)| key.trim() == name)?.1;
        Some(value.trim().trim_end_matches("!important").trim_end())
    };
    node.attribute("style").and_then(declared).or_else(|| node.attribute(name).map(str::trim))
}

/// From an element's own coordinates to those around it.
pub(super) fn transform(node: Node) -> Result<Affine, String> {
    let Some(text) = node.attribute("transform") else { return Ok(Affine::IDENTITY) };
    let wrong = |e: svgtypes::Error| format!("expected a transform, found {text:.60?}: {e}");
    let Transform { a, b, c, d, e, f } = Transform::from_str(text).map_err(wrong)?;
    Ok(Affine::new([a, b, c, d, e, f]))
}

/// What an element's own words mean: its classes, its label, its id.
pub(super) fn meaning(node: Node, signs: &[Sign]) -> Option<Meaning> {
    let classes = node.attribute("class").unwrap_or_default().split_whitespace();
    let label = node.attributes().find(|a| a.name() == "label" && a.namespace().is_some()).map(|a| a.value());
    let mut words = classes.chain(label).chain(node.attribute("id"));
    words.find_map(|word| sign::meaning(word, signs))
}
