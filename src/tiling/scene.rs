//! The scene: where, how long and how many. A human-editable TOML file.

use std::path::Path;

use glam::Vec2;
use toml::Spanned;

use crate::deform::Limits;
use crate::geom::{Obstacle, Polygon};
use crate::motion::FPS;
use crate::{Error, Result};

/// What to tile: a domain closed in space and open (cropped) in time, and wishes.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Everybody stays inside.
    pub region: Polygon,
    /// Everybody stays out of each.
    pub obstacles: Vec<Obstacle>,
    /// Seconds.
    pub duration_secs: f32,
    /// How many people are wished for.
    pub characters: usize,
    /// Share of the people's time that is wished for inside patches of two or more, 0 to 1.
    pub interaction: f32,
    /// Deformation limits.
    pub limits: Limits,
}

/// Longest scene accepted, in seconds.
const MAX_SECS: f64 = 3600.0;
/// Largest coordinate accepted, in metres.
const MAX_COORDINATE: f64 = 10_000.0;

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneText {
    region: Spanned<Vec<[f64; 2]>>,
    #[serde(default)]
    obstacles: Vec<Spanned<Vec<[f64; 2]>>>,
    duration_secs: Spanned<f64>,
    characters: Spanned<i64>,
    #[serde(default = "default_interaction")]
    interaction: Spanned<f64>,
    #[serde(default = "default_limits")]
    limits: Spanned<String>,
}

fn default_interaction() -> Spanned<f64> {
    Spanned::new(0..0, 0.3)
}

fn default_limits() -> Spanned<String> {
    Spanned::new(0..0, "tight".into())
}

impl Scene {
    /// The demo's scene: 12 x 12 m, 20 s, 72 people, 26 % of their time in patches of two or more.
    pub fn demo() -> Self {
        Self {
            region: Polygon::rectangle(Vec2::ZERO, Vec2::splat(12.0)),
            obstacles: vec![],
            duration_secs: 20.0,
            characters: 72,
            interaction: 0.26,
            limits: Limits::TIGHT,
        }
    }

    /// The last frame, inclusive.
    pub fn last_frame(&self) -> i32 {
        (self.duration_secs * FPS).round() as i32
    }

    /// A scene from TOML text.
    ///
    /// # Errors
    /// Syntax errors and all problems of content, each with its line.
    pub fn from_toml(text: &str) -> Result<Self> {
        let raw: SceneText = toml::from_str(text).map_err(|e| {
            let line = e.span().map_or(1, |s| line_of(text, s.start));
            Error::invalid("scene", format!("line {line}"), e.message().to_owned())
        })?;
        let mut problems = Vec::new();
        let mut bad = |span: std::ops::Range<usize>, problem: String| {
            problems.push((line_of(text, span.start), problem));
        };
        let region = polygon(&raw.region, "region", &mut bad);
        let obstacles: Vec<_> =
            raw.obstacles.iter().filter_map(|o| polygon(o, "obstacle", &mut bad)).map(Obstacle::from).collect();
        let duration = *raw.duration_secs.get_ref();
        if !(duration > 0.0 && duration <= MAX_SECS) {
            bad(raw.duration_secs.span(), format!("expected duration_secs in (0, {MAX_SECS}], found {duration}"));
        }
        let characters = *raw.characters.get_ref();
        if !(1..=1_000_000).contains(&characters) {
            bad(raw.characters.span(), format!("expected characters from 1 to 1000000, found {characters}"));
        }
        let interaction = *raw.interaction.get_ref();
        if !(0.0..=1.0).contains(&interaction) {
            bad(raw.interaction.span(), format!("expected interaction from 0 to 1, found {interaction}"));
        }
        let limits = match raw.limits.get_ref().as_str() {
            "tight" => Limits::TIGHT,
            "published" => Limits::PUBLISHED,
            other => {
                bad(raw.limits.span(), format!("expected limits \"tight\" or \"published\", found {other:?}"));
                Limits::TIGHT
            }
        };
        match (region, problems.split_first()) {
            (Some(region), None) => Ok(Self {
                region,
                obstacles,
                duration_secs: duration as f32,
                characters: characters as usize,
                interaction: interaction as f32,
                limits,
            }),
            (_, Some((first, rest))) => {
                let more = rest.iter().map(|(line, p)| format!("; line {line}: {p}"));
                Err(Error::invalid("scene", format!("line {}", first.0), first.1.clone() + &more.collect::<String>()))
            }
            (None, None) => unreachable!("a region that is missing has a problem"),
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

fn polygon(
    corners: &Spanned<Vec<[f64; 2]>>,
    what: &str,
    bad: &mut impl FnMut(std::ops::Range<usize>, String),
) -> Option<Polygon> {
    if let Some(c) = corners.get_ref().iter().find(|c| c.iter().any(|v| v.is_nan() || v.abs() > MAX_COORDINATE)) {
        bad(corners.span(), format!("{what}: expected coordinates within {MAX_COORDINATE} m, found {c:?}"));
        return None;
    }
    let points = corners.get_ref().iter().map(|c| Vec2::new(c[0] as f32, c[1] as f32)).collect();
    Polygon::new(points).map_err(|problem| bad(corners.span(), format!("{what}: {problem}"))).ok()
}

fn line_of(text: &str, at: usize) -> usize {
    text.as_bytes()[..at.min(text.len())].iter().filter(|&&b| b == b'\n').count() + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALID: &str =
        "region = [[0, 0], [12, 0], [12, 12], [0, 12]]\nduration_secs = 20.0\ncharacters = 70\ninteraction = 0.3\n";

    fn problem(text: &str) -> String {
        Scene::from_toml(text).unwrap_err().to_string()
    }

    #[test]
    fn valid_scene_loads() {
        let scene = Scene::from_toml(VALID).unwrap();
        assert_eq!(scene.characters, 70);
        assert_eq!(scene.last_frame(), 600);
    }

    #[test]
    fn each_fault_names_its_line() {
        let crossed = VALID.replace("[12, 12], [0, 12]", "[0, 12], [12, 12]");
        assert!(problem(&crossed).contains("line 1") && problem(&crossed).contains("cross"), "{}", problem(&crossed));
        let negative = VALID.replace("20.0", "-1.0");
        assert!(problem(&negative).contains("line 2"), "{}", problem(&negative));
        assert!(problem(&VALID.replace("70", "0")).contains("line 3"));
        assert!(problem(&VALID.replace("0.3", "nan")).contains("line 4"));
        assert!(problem("region = 3").contains("line 1"));
        assert!(problem(&format!("{VALID}colour = 1")).contains("line 5"));
    }

    #[test]
    fn all_problems_are_told_at_once() {
        let text = VALID.replace("20.0", "-1.0").replace("70", "0");
        assert!(problem(&text).contains("line 2") && problem(&text).contains("line 3"));
    }
}
