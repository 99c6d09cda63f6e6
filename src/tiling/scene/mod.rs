//! The scene: where, how long, how many, and what is wished for. A human-editable TOML file (docs/formats/scene.md),
//! read so that all its problems are told at once, each with its line.

mod blocks;
mod parts;
mod read;
mod sound;
mod wants;

use std::path::Path;

use glam::Vec2;
use toml::de::DeTable;

use self::read::{Problems, Section};
use super::prefer::Preference;
use crate::deform::Limits;
use crate::geom::{Obstacle, Polygon};
use crate::motion::FPS;
use crate::{Error, Result};

pub use parts::{KindFilter, Periodic, Placed, Sink, Source, Team, Wang};

/// What to tile: a domain open (cropped) in time, and wishes.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Scene {
    /// Everybody stays inside.
    pub region: Polygon,
    /// Everybody stays out of each.
    pub obstacles: Vec<Obstacle>,
    /// Seconds.
    pub duration_secs: f32,
    /// How many people are wished for besides those of teams and those who come in at sources.
    pub characters: usize,
    /// Share of the people's time that is wished for inside patches of two or more, 0 to 1.
    pub interaction: f32,
    /// Deformation limits.
    pub limits: Limits,
    /// Which kinds of the patch set are used.
    pub kinds: KindFilter,
    /// Which patches are wanted where, which way, when.
    pub preference: Preference,
    /// Where people come in.
    pub sources: Vec<Source>,
    /// Where people go out.
    pub sinks: Vec<Sink>,
    /// Patches that are where they are; the rest is tiled around them.
    pub placed: Vec<Placed>,
    /// People who belong together.
    pub teams: Vec<Team>,
    /// Labels of kinds of several people that are only of people of different teams.
    pub rivals: Vec<String>,
    /// In which directions the domain repeats.
    pub periodic: Periodic,
    /// How it is covered by tiles, if it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wang: Option<Wang>,
}

/// Longest scene accepted, in seconds.
const MAX_SECS: f64 = 3600.0;
/// Most people accepted.
const MAX_CHARACTERS: usize = 1_000_000;
/// Share of the time in company unless a scene says it.
const INTERACTION: f32 = 0.3;

impl Scene {
    /// A scene without obstacles or particular wishes.
    pub fn new(region: Polygon, duration_secs: f32, characters: usize) -> Self {
        Self {
            region,
            obstacles: vec![],
            duration_secs,
            characters,
            interaction: INTERACTION,
            limits: Limits::TIGHT,
            kinds: KindFilter::default(),
            preference: Preference::default(),
            sources: vec![],
            sinks: vec![],
            placed: vec![],
            teams: vec![],
            rivals: vec![],
            periodic: Periodic::default(),
            wang: None,
        }
    }

    /// The demo's scene: 12 x 12 m, 20 s, 72 people, 26 % of their time in patches of two or more.
    pub fn demo() -> Self {
        let region = Polygon::rectangle(Vec2::ZERO, Vec2::splat(12.0));
        Self { interaction: 0.26, ..Self::new(region, 20.0, 72) }
    }

    /// How many people are wished for: those who are there anyway, those of the teams, and those who come in.
    pub fn people(&self) -> usize {
        let coming = super::source::arrivals(self).len();
        self.characters + self.teams.iter().map(|t| t.characters).sum::<usize>() + coming
    }

    /// The last frame, inclusive.
    pub fn last_frame(&self) -> i32 {
        (self.duration_secs * FPS).round() as i32
    }

    /// As many people as so many per square metre of the region are, at least one.
    pub fn people_at(&self, density: f32) -> usize {
        ((density * self.region.area()).round() as usize).clamp(1, MAX_CHARACTERS)
    }

    /// A scene from TOML text.
    ///
    /// # Errors
    /// All problems of syntax and content, each with its line.
    pub fn from_toml(text: &str) -> Result<Self> {
        let problems = Problems::default();
        let (table, faults) = DeTable::parse_recoverable(text);
        for fault in faults {
            problems.add(&fault.span().unwrap_or(0..0), fault.message());
        }
        // What is wrong in syntax is missed or misread afterwards.
        let scene = if problems.is_empty() { read(Section::new("", table.get_ref(), 0..0, &problems)) } else { None };
        match (problems.told(text), scene) {
            (None, Some(scene)) => Ok(scene),
            (Some((line, problem)), _) => Err(Error::invalid("scene", format!("line {line}"), problem)),
            (None, None) => Err(Error::invalid("scene", "line 1", "expected a scene, found nothing")),
        }
    }

    /// A scene from a TOML file.
    ///
    /// # Errors
    /// As [`Scene::from_toml`], or the file cannot be read.
    pub fn load(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, e))?;
        Self::from_toml(&text).map_err(|e| e.in_file(path))
    }
}

/// The scene of a file; `None` or one that is not to be used if there are problems.
fn read(file: Section) -> Option<Scene> {
    for (key, expected) in [("region", "corners [x, z]"), ("duration_secs", "seconds")] {
        if !file.has(key) {
            file.missing(key, expected);
        }
    }
    let region = file.polygon("region");
    let duration_secs = file.number("duration_secs", 0.1..=MAX_SECS, " s");
    let (region, duration_secs, whole) = match (region, duration_secs) {
        (Some(region), Some(secs)) => (region, secs, true),
        // Stand-ins, so that the rest is looked at as well.
        (region, secs) => {
            (region.unwrap_or(Polygon::rectangle(Vec2::ZERO, Vec2::ONE)), secs.unwrap_or(MAX_SECS as f32), false)
        }
    };
    let mut scene = Scene::new(region, duration_secs, 0);
    scene.characters = characters(&file, &scene);
    scene.interaction = file.number("interaction", 0.0..=1.0, "").unwrap_or(INTERACTION);
    let limits = [("tight", Limits::TIGHT), ("published", Limits::PUBLISHED)];
    scene.limits = file.word("limits", &limits).unwrap_or(Limits::TIGHT);
    scene.obstacles = file
        .items("obstacles")
        .into_iter()
        .filter_map(|o| file.polygon_in(o, "obstacles"))
        .map(Obstacle::from)
        .collect();
    scene.obstacles.extend(file.sections("obstacle").into_iter().filter_map(blocks::obstacle));
    scene.kinds = file.section("kinds").map(blocks::kinds).unwrap_or_default();
    scene.preference.terms = file.sections("prefer").into_iter().filter_map(wants::term).collect();
    scene.sources = file.sections("source").into_iter().filter_map(|s| blocks::source(s, duration_secs)).collect();
    scene.sinks = file.sections("sink").into_iter().filter_map(blocks::sink).collect();
    scene.placed = file.sections("place").into_iter().filter_map(blocks::placed).collect();
    scene.teams = file.sections("team").into_iter().filter_map(blocks::team).collect();
    scene.rivals = file.texts("rivals");
    scene.periodic = blocks::periodic(&file);
    scene.wang = file.section("wang").and_then(blocks::wang);
    teams_agree(&file, &scene);
    if whole {
        tiles_fit(&file, &scene);
    }
    file.finish();
    whole.then_some(scene)
}

/// `characters`, or as many as `density` makes; nobody besides those whom teams and sources bring.
fn characters(file: &Section, scene: &Scene) -> usize {
    let characters = file.count("characters", 1..=MAX_CHARACTERS);
    let density = file.number("density", 1e-6..=10.0, " people per square metre");
    match (file.has("characters"), file.has("density")) {
        (true, true) => {
            file.bad(&file.span_of("density"), "density", "expected either `characters` or `density`, found both")
        }
        (false, false) if !file.has("team") && !file.has("source") => {
            file.missing("characters", "a whole number, or `density`")
        }
        _ => {}
    }
    characters.unwrap_or_else(|| density.map_or(0, |d| scene.people_at(d)))
}

/// Teams have names of their own, and those who come belong to teams that there are.
fn teams_agree(file: &Section, scene: &Scene) {
    let names: Vec<&str> = scene.teams.iter().map(|t| t.name.as_str()).collect();
    for (i, name) in names.iter().enumerate() {
        if names[..i].contains(name) {
            file.bad(&file.span_of("team"), "team", &format!("expected every name once, found {name:?} twice"));
        }
    }
    for team in scene.sources.iter().filter_map(|s| s.team.as_deref()) {
        if !names.contains(&team) {
            file.bad(&file.span_of("source"), "source team", &format!("expected one of {names:?}, found {team:?}"));
        }
    }
    if !scene.rivals.is_empty() && names.len() < 2 {
        file.bad(&file.span_of("rivals"), "rivals", "expected two teams or more");
    }
}

/// The region is made of whole tiles, and nothing is asked for that tiles cannot have.
fn tiles_fit(file: &Section, scene: &Scene) {
    for (key, problem) in super::wang::problems(scene) {
        // Walls are a list of their own.
        let key = if key == "obstacle" && !file.has(key) { "obstacles" } else { key };
        file.bad(&file.span_of(key), key, &problem);
    }
}

#[cfg(test)]
mod tests;
