//! How a scene says where its walkable ground comes from.

use std::path::Path;

use toml::Spanned;

use super::{Problems, SceneText, colours};
use crate::world::{Area, Coordinates, FloorOptions, Goal, Grounds, Reading, Sign, Spot, Template};

/// A file and how it is meant.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AreaText {
    file: String,
    coordinates: Option<String>,
    metres_per_unit: Option<f64>,
    slope_deg: Option<f64>,
    step_m: Option<f64>,
    head_m: Option<f64>,
    height_m: Option<f64>,
}

impl AreaText {
    fn reading(&self) -> Result<Reading, String> {
        let coordinates = match self.coordinates.as_deref() {
            None => None,
            Some("metres") => Some(Coordinates::Metres),
            Some("degrees") => Some(Coordinates::Degrees),
            Some(other) => {
                return Err(format!("expected coordinates \"metres\" or \"degrees\", found {other:?}"));
            }
        };
        let given = [self.slope_deg, self.step_m, self.head_m, self.height_m];
        let usual = FloorOptions::default();
        let floor = FloorOptions {
            slope_deg: self.slope_deg.unwrap_or(usual.slope_deg),
            step_m: self.step_m.unwrap_or(usual.step_m),
            head_m: self.head_m.unwrap_or(usual.head_m),
            height_m: self.height_m,
        };
        let floor = given.iter().any(Option::is_some).then_some(floor);
        Ok(Reading { coordinates, metres_per_unit: self.metres_per_unit, floor })
    }
}

/// The ground of a scene.
pub(super) fn area(
    raw: &SceneText,
    text: &Spanned<AreaText>,
    templates: Vec<Template>,
    folder: &Path,
    bad: &mut Problems,
) -> Area {
    if raw.templates.iter().any(|t| t.get_ref().repeats != 1) {
        bad.add(text.span(), "expected templates that repeat on a map only, found one on an area".into());
    }
    if raw.endless {
        bad.add(text.span(), "expected an area to end, found endless = true".into());
    }
    let signs = signs(raw, bad);
    let read = |reading: Reading| {
        let path = folder.join(&text.get_ref().file);
        Area::load_grounds(&path, &reading, &signs).map_err(|error| error.to_string())
    };
    let grounds = text.get_ref().reading().and_then(read).unwrap_or_else(|problem| {
        bad.add(text.span(), problem);
        Grounds::default()
    });
    let goals: Vec<Goal> = raw.goals.iter().map(|goal| goal.get_ref().goal()).collect();
    for (goal, text) in goals.iter().zip(&raw.goals) {
        for spot in [&goal.from, &goal.to] {
            if let Spot::Template(name) = spot
                && !templates.iter().any(|template| template.name == *name)
            {
                bad.add(text.span(), format!("expected a template or a place [x, z], found {name:?}"));
            }
        }
    }
    let (side, period) = (*raw.cell_m.get_ref(), *raw.period_secs.get_ref());
    let Grounds { found, notes } = grounds;
    Area { templates, grounds: found, side, period, goals, notes, seed: raw.seed }
}

fn signs(raw: &SceneText, bad: &mut Problems) -> Vec<Sign> {
    let colours = colours(raw, bad);
    let sign = |(text, colour): (&Spanned<super::TemplateText>, Option<[u8; 3]>)| Sign {
        name: text.get_ref().name.get_ref().clone(),
        key: text.get_ref().key.as_ref().map(|key| *key.get_ref()),
        colour,
    };
    raw.templates.iter().zip(colours).map(sign).collect()
}
