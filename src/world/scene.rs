//! Scenes of worlds: what is where, in a TOML file a person can read and write.
//!
//! Templates say what patches contain and who crosses which border; a map says where which template is: lines of
//! characters, or a picture whose colours are the templates' (a palette image, "Crowd Patches" (2009), section 5.1).
//! All problems are told at once, each with its line.

mod area;
mod border;
mod palette;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use toml::Spanned;

use super::{Amount, Area, Built, Furnishing, Gathering, Goal, Meeting, Plan, Prototype, Site, Spot, Template};
use crate::{Error, Result};
use area::AreaText;
use border::BorderText;

/// A world to build.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WorldScene {
    /// What it is called.
    pub name: String,
    /// What is where.
    pub layout: Layout,
}

/// What is where.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Layout {
    /// Templates on a grid.
    Map(Plan),
    /// Walkable polygons.
    Area(Area),
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneText {
    #[serde(default)]
    name: String,
    #[serde(default = "default_seed")]
    seed: u64,
    #[serde(default = "default_period")]
    period_secs: Spanned<f32>,
    #[serde(default = "default_side")]
    cell_m: Spanned<f32>,
    #[serde(default)]
    endless: bool,
    #[serde(default = "default_patterns")]
    patterns: Spanned<i64>,
    #[serde(default)]
    versions: u32,
    map: Option<Spanned<String>>,
    area: Option<Spanned<AreaText>>,
    #[serde(default)]
    goals: Vec<Spanned<GoalText>>,
    templates: Vec<Spanned<TemplateText>>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct TemplateText {
    name: Spanned<String>,
    key: Option<Spanned<char>>,
    colour: Option<Spanned<String>>,
    /// How often its patches repeat in a period.
    #[serde(default = "default_repeats")]
    repeats: u32,
    #[serde(default)]
    ground: String,
    #[serde(default)]
    objects: Vec<Spanned<ObjectText>>,
    #[serde(default)]
    people: Vec<Spanned<PeopleText>>,
    /// Labels of what people do who come in and meet.
    meet: Option<Vec<String>>,
    #[serde(default)]
    borders: BTreeMap<String, Spanned<BorderText>>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct ObjectText {
    name: String,
    disc: Option<f32>,
    #[serde(rename = "box")]
    oblong: Option<[f32; 2]>,
    number: Option<[usize; 2]>,
    density: Option<f32>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct PeopleText {
    name: String,
    group: [usize; 2],
    #[serde(default = "default_radius")]
    radius: f32,
    number: Option<[usize; 2]>,
    density: Option<f32>,
}

/// Who goes where on purpose.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct GoalText {
    from: SpotText,
    to: SpotText,
    rounds: usize,
}

#[derive(serde::Deserialize)]
#[serde(untagged)]
enum SpotText {
    At([f32; 2]),
    Template(String),
}

impl GoalText {
    fn goal(&self) -> Goal {
        Goal { from: self.from.spot(), to: self.to.spot(), rounds: self.rounds }
    }
}

impl SpotText {
    fn spot(&self) -> Spot {
        match self {
            Self::At(place) => Spot::At((*place).into()),
            Self::Template(name) => Spot::Template(name.clone()),
        }
    }
}

fn default_seed() -> u64 {
    1
}

fn default_period() -> Spanned<f32> {
    Spanned::new(0..0, 10.0)
}

fn default_side() -> Spanned<f32> {
    Spanned::new(0..0, 8.0)
}

fn default_patterns() -> Spanned<i64> {
    Spanned::new(0..0, 4)
}

fn default_repeats() -> u32 {
    1
}

fn default_radius() -> f32 {
    0.3
}

/// Problems with their places in the text.
struct Problems<'a> {
    text: &'a str,
    found: Vec<(usize, String)>,
}

impl Problems<'_> {
    fn add(&mut self, span: Range<usize>, problem: String) {
        self.found.push((line_of(self.text, span.start), problem));
    }

    fn within(&mut self, value: &Spanned<f32>, name: &str, range: std::ops::RangeInclusive<f32>) {
        if !range.contains(value.get_ref()) {
            let problem =
                format!("expected {name} from {} to {}, found {}", range.start(), range.end(), value.get_ref());
            self.add(value.span(), problem);
        }
    }

    fn finish(mut self) -> Result<()> {
        self.found.sort_by_key(|(line, _)| *line);
        match self.found.split_first() {
            None => Ok(()),
            Some(((line, first), rest)) => {
                let more = rest.iter().map(|(line, p)| format!("; line {line}: {p}")).collect::<String>();
                Err(Error::invalid("world scene", format!("line {line}"), first.clone() + &more))
            }
        }
    }
}

impl WorldScene {
    /// A scene from TOML text; a map in a picture is looked for in `folder`.
    ///
    /// # Errors
    /// Syntax errors and all problems of content, each with its line.
    pub fn from_toml(text: &str, folder: &Path) -> Result<Self> {
        let raw: SceneText = toml::from_str(text).map_err(|e| {
            let line = e.span().map_or(1, |span| line_of(text, span.start));
            Error::invalid("world scene", format!("line {line}"), e.message().to_owned())
        })?;
        let mut bad = Problems { text, found: Vec::new() };
        bad.within(&raw.period_secs, "period_secs", 2.0..=300.0);
        bad.within(&raw.cell_m, "cell_m", 4.0..=40.0);
        if !(1..=1_000_000).contains(raw.patterns.get_ref()) {
            bad.add(
                raw.patterns.span(),
                format!("expected patterns from 1 to 1000000, found {}", raw.patterns.get_ref()),
            );
        }
        let templates: Vec<Template> = raw.templates.iter().map(|t| template(t, &raw.templates, &mut bad)).collect();
        if templates.is_empty() {
            bad.found.push((1, "expected at least one template, found none".into()));
        }
        let layout = match (&raw.map, &raw.area) {
            (Some(map), None) => Layout::Map(raw.plan(templates, cells(&raw, map, folder, &mut bad))),
            (None, Some(area)) => Layout::Area(area::area(&raw, area, templates, folder, &mut bad)),
            _ => {
                bad.found.push((1, "expected either a map or an area".into()));
                Layout::Map(raw.plan(Vec::new(), Vec::new()))
            }
        };
        bad.finish()?;
        if let Layout::Map(plan) = &layout {
            plan.validate()?;
        }
        Ok(Self { name: raw.name, layout })
    }

    /// The same scene with another seed.
    pub fn with_seed(mut self, seed: u64) -> Self {
        match &mut self.layout {
            Layout::Map(plan) => plan.seed = seed,
            Layout::Area(area) => area.seed = seed,
        }
        self
    }

    /// Builds its world; on all cores, the result does not depend on their number. `progress` is told how many of how many
    /// patches are done, and stops the work by returning false.
    ///
    /// # Errors
    /// As [`Plan::build`] and [`Area::build`].
    pub fn build(&self, progress: &(dyn Fn(usize, usize) -> bool + Sync)) -> Result<Built> {
        let mut site = Site::new(self)?;
        while !site.left().is_empty() {
            site.work(progress)?;
        }
        site.bake()
    }

    /// A scene from a TOML file; a scene without a name is called as its file.
    ///
    /// # Errors
    /// As [`Self::from_toml`], or a file cannot be read.
    pub fn load(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, e))?;
        let folder = path.parent().unwrap_or(Path::new("."));
        let mut scene = Self::from_toml(&text, folder).map_err(|e| e.in_file(path))?;
        if scene.name.is_empty() {
            scene.name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        }
        Ok(scene)
    }
}

impl SceneText {
    fn plan(&self, templates: Vec<Template>, cells: Vec<Vec<usize>>) -> Plan {
        let repeats: Vec<u32> = self.templates.iter().map(|t| t.get_ref().repeats).collect();
        Plan {
            templates,
            cells,
            side: *self.cell_m.get_ref(),
            period: *self.period_secs.get_ref(),
            endless: self.endless,
            patterns: *self.patterns.get_ref() as u64,
            versions: self.versions.into(),
            repeats: if repeats.iter().all(|&times| times == 1) { Vec::new() } else { repeats },
            goals: self.goals.iter().map(|g| g.get_ref().goal()).collect(),
            seed: self.seed,
        }
    }
}

fn template(text: &Spanned<TemplateText>, all: &[Spanned<TemplateText>], bad: &mut Problems) -> Template {
    let (raw, span) = (text.get_ref(), text.span());
    let mut made = Template::new(raw.name.get_ref(), &raw.ground);
    if all.iter().filter(|other| other.get_ref().name.get_ref() == raw.name.get_ref()).count() > 1 {
        bad.add(raw.name.span(), format!("expected one template of a name, found two called {:?}", raw.name.get_ref()));
    }
    made.meeting = raw.meet.clone().map(|labels| Meeting { labels, ..Meeting::default() });
    for object in &raw.objects {
        let (o, span) = (object.get_ref(), object.span());
        let outline = match (o.disc, o.oblong) {
            (Some(radius), None) => Prototype::Disc(radius),
            (None, Some([x, z])) => Prototype::Oblong(x, z),
            _ => {
                bad.add(span.clone(), format!("object {:?}: expected either disc or box", o.name));
                continue;
            }
        };
        if let Some(amount) = amount(o.number, o.density, &o.name, span, bad) {
            made.furnishings.push(Furnishing { name: o.name.clone(), outline, amount });
        }
    }
    for people in &raw.people {
        let p = people.get_ref();
        if let Some(amount) = amount(p.number, p.density, &p.name, people.span(), bad) {
            let size = (p.group[0], p.group[1]);
            made.gatherings.push(Gathering {
                name: p.name.clone(),
                size,
                radius: p.radius,
                amount,
                tableaux: Default::default(),
            });
        }
    }
    for (name, border) in &raw.borders {
        if !all.iter().any(|other| other.get_ref().name.get_ref() == name) {
            bad.add(border.span(), format!("expected a border to one of the templates, found {name:?}"));
        }
        match border.get_ref().pattern_type() {
            Ok(kind) => drop(made.borders.insert(name.clone(), kind)),
            Err(problem) => bad.add(border.span(), format!("border to {name:?}: {problem}")),
        }
    }
    for problem in made.problems() {
        bad.add(span.clone(), format!("template {:?}: {problem}", made.name));
    }
    made
}

fn amount(
    number: Option<[usize; 2]>,
    density: Option<f32>,
    name: &str,
    span: Range<usize>,
    bad: &mut Problems,
) -> Option<Amount> {
    match (number, density) {
        (Some([least, most]), None) => Some(Amount::Number(least, most)),
        (None, Some(density)) => Some(Amount::Density(density)),
        _ => {
            bad.add(span, format!("{name:?}: expected either number or density"));
            None
        }
    }
}

/// Template of every cell: of a picture if the map names one, else of lines of characters.
fn cells(raw: &SceneText, map: &Spanned<String>, folder: &Path, bad: &mut Problems) -> Vec<Vec<usize>> {
    let (map, span) = (map.get_ref(), map.span());
    let found = if map.trim_end().ends_with(".png") && !map.contains('\n') {
        palette::cells(&folder.join(map), &colours(raw, bad))
    } else {
        let keys: Vec<Option<char>> =
            raw.templates.iter().map(|t| t.get_ref().key.as_ref().map(|k| *k.get_ref())).collect();
        lines(map, &keys)
    };
    found.unwrap_or_else(|problem| {
        bad.add(span, format!("map: {problem}"));
        Vec::new()
    })
}

/// Rows of characters, the last one first.
fn lines(map: &str, keys: &[Option<char>]) -> std::result::Result<Vec<Vec<usize>>, String> {
    let mut rows = Vec::new();
    for (line, text) in map.lines().map(str::trim).filter(|l| !l.is_empty()).enumerate() {
        let find = |(column, c): (usize, char)| {
            keys.iter().position(|&key| key == Some(c)).ok_or_else(|| {
                format!("row {}, column {}: expected the key of a template, found {c:?}", line + 1, column + 1)
            })
        };
        rows.push(text.chars().enumerate().map(find).collect::<std::result::Result<Vec<_>, _>>()?);
    }
    rows.reverse();
    Ok(rows)
}

/// Colour of every template, as red, green, blue.
fn colours(raw: &SceneText, bad: &mut Problems) -> Vec<Option<[u8; 3]>> {
    let parse = |text: &str| {
        let digits = text.strip_prefix('#').filter(|d| d.len() == 6)?;
        let part = |at: usize| u8::from_str_radix(digits.get(at..at + 2)?, 16).ok();
        Some([part(0)?, part(2)?, part(4)?])
    };
    let mut colour = |text: &Spanned<String>| {
        let found = parse(text.get_ref());
        if found.is_none() {
            bad.add(text.span(), format!("expected a colour as #rrggbb, found {:?}", text.get_ref()));
        }
        found
    };
    raw.templates.iter().map(|t| t.get_ref().colour.as_ref().and_then(&mut colour)).collect()
}

fn line_of(text: &str, at: usize) -> usize {
    text.as_bytes()[..at.min(text.len())].iter().filter(|&&b| b == b'\n').count() + 1
}
