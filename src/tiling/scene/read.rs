//! Reading a table of a TOML file so that every problem in it is told, each with its line.

use std::cell::RefCell;
use std::ops::{Range, RangeInclusive};

use glam::Vec2;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::geom::Polygon;

/// Largest coordinate accepted, metres.
pub(super) const MAX_COORDINATE: f64 = 10_000.0;

/// What is wrong with a text, at which byte.
#[derive(Default)]
pub(super) struct Problems(RefCell<Vec<(usize, String)>>);

impl Problems {
    /// One more.
    pub fn add(&self, span: &Range<usize>, problem: impl Into<String>) {
        self.0.borrow_mut().push((span.start, problem.into()));
    }

    /// True if there are none so far.
    pub fn is_empty(&self) -> bool {
        self.0.borrow().is_empty()
    }

    /// All of them in order, each with its line: the first, and the rest in one text.
    pub fn told(self, text: &str) -> Option<(usize, String)> {
        let mut all = self.0.into_inner();
        all.sort_by_key(|p| p.0);
        let mut lines = all.into_iter().map(|(at, problem)| (line_of(text, at), problem));
        let (line, first) = lines.next()?;
        Some((line, lines.fold(first, |sum, (line, problem)| format!("{sum}; line {line}: {problem}"))))
    }
}

fn line_of(text: &str, at: usize) -> usize {
    text.as_bytes()[..at.min(text.len())].iter().filter(|&&b| b == b'\n').count() + 1
}

type Value<'a> = Spanned<DeValue<'a>>;

/// A table whose keys are asked for one by one; those that nobody asked for are problems in the end.
pub(super) struct Section<'a> {
    /// What the table is, for messages; empty for the whole file.
    name: String,
    table: &'a DeTable<'a>,
    /// Where it begins.
    pub span: Range<usize>,
    /// Where problems go.
    pub problems: &'a Problems,
    asked: RefCell<Vec<&'static str>>,
}

impl<'a> Section<'a> {
    /// A table called `name` that begins at `span`.
    pub fn new(name: &str, table: &'a DeTable<'a>, span: Range<usize>, problems: &'a Problems) -> Self {
        Self { name: name.into(), table, span, problems, asked: RefCell::default() }
    }

    /// The problem of a key.
    pub fn bad(&self, span: &Range<usize>, key: &str, problem: &str) {
        let name = if self.name.is_empty() { key.to_owned() } else { format!("{} {key}", self.name) };
        self.problems.add(span, format!("{name}: {problem}"));
    }

    /// The value of a key, if it is there.
    pub fn get(&self, key: &'static str) -> Option<&'a Value<'a>> {
        let mut asked = self.asked.borrow_mut();
        if !asked.contains(&key) {
            asked.push(key);
        }
        self.table.get(key)
    }

    /// True if a key is there.
    pub fn has(&self, key: &'static str) -> bool {
        self.get(key).is_some()
    }

    /// The span of a key's value, or of the table.
    pub fn span_of(&self, key: &str) -> Range<usize> {
        self.table.get(key).map_or(self.span.clone(), Spanned::span)
    }

    /// A key that must be there is not.
    pub fn missing(&self, key: &str, expected: &str) {
        self.bad(&self.span, key, &format!("expected {expected}, found nothing"));
    }

    /// A number in a range.
    pub fn number(&self, key: &'static str, range: RangeInclusive<f64>, unit: &str) -> Option<f32> {
        let value = self.get(key)?;
        let expected = format!("expected a number from {} to {}{unit}", range.start(), range.end());
        match number(value.get_ref()) {
            Some(n) if range.contains(&n) => Some(n as f32),
            _ => {
                self.bad(&value.span(), key, &format!("{expected}, found {}", shown(value)));
                None
            }
        }
    }

    /// A whole number in a range.
    pub fn count(&self, key: &'static str, range: RangeInclusive<usize>) -> Option<usize> {
        let value = self.get(key)?;
        let found = value.get_ref().as_integer().and_then(|_| number(value.get_ref()));
        let found = found.filter(|n| *n >= 0.0).map(|n| n as usize).filter(|n| range.contains(n));
        if found.is_none() {
            let (low, high) = (range.start(), range.end());
            let problem = format!("expected a whole number from {low} to {high}, found {}", shown(value));
            self.bad(&value.span(), key, &problem);
        }
        found
    }

    /// A text.
    pub fn text(&self, key: &'static str) -> Option<&'a str> {
        let value = self.get(key)?;
        let text = value.get_ref().as_str();
        if text.is_none() {
            self.bad(&value.span(), key, &format!("expected a text in quotes, found {}", shown(value)));
        }
        text
    }

    /// One of some words.
    pub fn word<T: Copy>(&self, key: &'static str, words: &[(&str, T)]) -> Option<T> {
        let text = self.text(key)?;
        let found = words.iter().find(|w| w.0 == text).map(|w| w.1);
        if found.is_none() {
            let all: Vec<String> = words.iter().map(|w| format!("{:?}", w.0)).collect();
            self.bad(&self.span_of(key), key, &format!("expected {}, found {text:?}", all.join(" or ")));
        }
        found
    }

    /// A list of texts; empty if it is not there.
    pub fn texts(&self, key: &'static str) -> Vec<String> {
        let read = |v: &Value| {
            let text = v.get_ref().as_str().map(str::to_owned);
            if text.is_none() {
                self.bad(&v.span(), key, &format!("expected texts in quotes, found {}", shown(v)));
            }
            text
        };
        self.items(key).into_iter().filter_map(read).collect()
    }

    /// Rows of so many numbers each, within the largest coordinate; empty if the key is not there.
    pub fn rows(&self, key: &'static str, columns: RangeInclusive<usize>, what: &str) -> Vec<Vec<f32>> {
        let row = |v: &'a Value<'a>| self.row(v, key, &columns, what);
        self.items(key).into_iter().filter_map(row).collect()
    }

    /// One row of numbers.
    pub fn tuple(&self, key: &'static str, columns: RangeInclusive<usize>, what: &str) -> Option<Vec<f32>> {
        self.row(self.get(key)?, key, &columns, what)
    }

    fn row(&self, value: &Value, key: &str, columns: &RangeInclusive<usize>, what: &str) -> Option<Vec<f32>> {
        let numbers = value.get_ref().as_array().map(|a| a.iter().map(|v| number(v.get_ref())).collect::<Vec<_>>());
        let fits = |n: &Option<f64>| n.is_some_and(|n| n.abs() <= MAX_COORDINATE);
        match numbers {
            Some(row) if columns.contains(&row.len()) && row.iter().all(fits) => {
                Some(row.into_iter().flatten().map(|n| n as f32).collect())
            }
            _ => {
                let most = format!("numbers within {MAX_COORDINATE}");
                self.bad(&value.span(), key, &format!("expected {what}, {most}, found {}", shown(value)));
                None
            }
        }
    }

    /// A point on the ground, [x, z].
    pub fn point(&self, key: &'static str) -> Option<Vec2> {
        self.tuple(key, 2..=2, "a point [x, z]").map(|p| Vec2::new(p[0], p[1]))
    }

    /// A polygon of points.
    pub fn polygon(&self, key: &'static str) -> Option<Polygon> {
        self.polygon_in(self.get(key)?, key)
    }

    /// A polygon that is the value of a key or one of its items.
    pub fn polygon_in(&self, value: &Value, key: &str) -> Option<Polygon> {
        let Some(corners) = value.get_ref().as_array() else {
            self.bad(&value.span(), key, &format!("expected corners [x, z], found {}", shown(value)));
            return None;
        };
        let corner = |v: &Value| self.row(v, key, &(2..=2), "corners [x, z]").map(|p| Vec2::new(p[0], p[1]));
        let points: Vec<Option<Vec2>> = corners.iter().map(corner).collect();
        let points: Option<Vec<Vec2>> = points.into_iter().collect();
        Polygon::new(points?).map_err(|problem| self.bad(&value.span(), key, &problem)).ok()
    }

    /// The items of a list; none if the key is not there.
    pub fn items(&self, key: &'static str) -> Vec<&'a Value<'a>> {
        let Some(value) = self.get(key) else { return vec![] };
        match value.get_ref().as_array() {
            Some(array) => array.iter().collect(),
            None => {
                self.bad(&value.span(), key, &format!("expected a list, found {}", shown(value)));
                vec![]
            }
        }
    }

    /// A table in this one.
    pub fn section(&self, key: &'static str) -> Option<Section<'a>> {
        self.section_in(self.get(key)?, key)
    }

    /// The tables of a list, `[[key]]`.
    pub fn sections(&self, key: &'static str) -> Vec<Section<'a>> {
        self.items(key).into_iter().filter_map(|v| self.section_in(v, key)).collect()
    }

    fn section_in(&self, value: &'a Value<'a>, key: &str) -> Option<Section<'a>> {
        let table = value.get_ref().as_table();
        if table.is_none() {
            self.bad(&value.span(), key, &format!("expected a table, found {}", shown(value)));
        }
        Some(Section::new(key, table?, value.span(), self.problems))
    }

    /// All keys and values: for tables whose keys are names.
    pub fn entries(&self) -> impl Iterator<Item = (String, &'a Value<'a>)> {
        self.table.iter().map(|(key, value)| (key.get_ref().to_string(), value))
    }

    /// Tells the keys that nobody asked for.
    pub fn finish(self) {
        let asked = self.asked.borrow();
        for (key, _) in self.table.iter().filter(|(k, _)| !asked.contains(&k.get_ref().as_ref())) {
            let problem = format!("no such key; expected one of {}", asked.join(", "));
            self.bad(&key.span(), key.get_ref(), &problem);
        }
    }
}

/// A number, whole or not.
pub(super) fn number(value: &DeValue) -> Option<f64> {
    match value {
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok().map(|n| n as f64),
        DeValue::Float(f) => f.as_str().parse().ok(),
        _ => None,
    }
}

/// A value as a message shows it.
fn shown(value: &Value) -> String {
    match value.get_ref() {
        DeValue::String(s) => format!("{s:?}"),
        DeValue::Integer(i) => i.to_string(),
        DeValue::Float(f) => f.to_string(),
        DeValue::Boolean(b) => b.to_string(),
        DeValue::Array(a) if a.len() <= 4 => format!("[{}]", a.iter().map(shown).collect::<Vec<_>>().join(", ")),
        DeValue::Array(a) => format!("a list of {}", a.len()),
        other => format!("a {}", other.type_str()),
    }
}
