//! What is wrong with a scene that does not come from a scene file, as one that a checkpoint keeps.

use super::{MAX_CHARACTERS, MAX_SECS, Scene};
use crate::geom::Polygon;
use crate::tiling::prefer::{Field, Form, Term};

impl Scene {
    /// What is wrong with it, if anything.
    pub(in super::super) fn problem(&self) -> Option<String> {
        // What is not finite becomes null, and nothing else does.
        let text = serde_json::to_value(self).ok()?;
        if has_null(&text) {
            return Some("expected finite numbers".into());
        }
        let polygons = self.obstacles.iter().map(|o| &o.outline).chain(self.teams.iter().map(|t| &t.start));
        if let Some(problem) = polygons.chain([&self.region]).find_map(|p| Polygon::new(p.points.clone()).err()) {
            return Some(problem);
        }
        if let Some(problem) = self.obstacles.iter().find_map(|o| o.problem()) {
            return Some(problem);
        }
        let limits = [self.limits.stretch, self.limits.bend, self.limits.time, self.limits.slip];
        let sound = (0.1..=MAX_SECS as f32).contains(&self.duration_secs)
            && (0.0..=1.0).contains(&self.interaction)
            && self.characters <= MAX_CHARACTERS
            && self.teams.iter().all(|t| t.characters <= MAX_CHARACTERS)
            && limits.iter().all(|l| (0.0..1e3).contains(l));
        if !sound {
            return Some("expected wishes and limits as scene files may have them".into());
        }
        self.preference.terms.iter().any(|t| !is_sound(t)).then(|| "expected whole tables and paths to prefer".into())
    }
}

fn has_null(value: &serde_json::Value) -> bool {
    match value {
        serde_json::Value::Null => true,
        serde_json::Value::Array(all) => all.iter().any(has_null),
        serde_json::Value::Object(all) => all.values().any(has_null),
        _ => false,
    }
}

fn is_sound(term: &Term) -> bool {
    let whole = |g: &super::super::Grid| {
        g.cell > 0.0 && g.columns > 0 && !g.values.is_empty() && g.values.len().is_multiple_of(g.columns)
    };
    match &term.form {
        Form::Attract { to: path, within } | Form::Avoid { from: path, within } => !path.is_empty() && *within > 0.0,
        Form::Direction(Field::Along(path)) => !path.is_empty(),
        Form::Direction(_) | Form::Kinds(_) => true,
        Form::Schedule { times, fade } => !times.is_empty() && *fade > 0.0,
        Form::Ratios(ratios) => ratios.iter().all(|r| r.1 >= 0.0),
        Form::Places(grid) => whole(grid),
        Form::Headings(grids) => !grids.is_empty() && grids.iter().all(whole),
        Form::Times { step, values } => *step > 0.0 && !values.is_empty(),
    }
}
