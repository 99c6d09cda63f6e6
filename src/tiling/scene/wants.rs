//! `[[prefer]]` blocks: the preference function of a scene file. What each key means: docs/formats/scene.md.

use glam::Vec2;

use super::super::prefer::{Field, Form, Term};
use super::read::{Section, number};

/// Most points of a path.
const MAX_POINTS: usize = 1000;

#[derive(Clone, Copy)]
enum What {
    Attract,
    Avoid,
    Direction,
    Labels,
    Schedule,
}

const WHATS: [(&str, What); 5] = [
    ("attract", What::Attract),
    ("avoid", What::Avoid),
    ("direction", What::Direction),
    ("labels", What::Labels),
    ("schedule", What::Schedule),
];

/// `[[prefer]]`.
pub(super) fn term(block: Section) -> Option<Term> {
    if !block.has("what") {
        block.missing("what", "\"attract\", \"avoid\", \"direction\", \"labels\" or \"schedule\"");
    }
    let what = block.word("what", &WHATS)?;
    let form = match what {
        What::Attract => course(&block).zip(within(&block)).map(|(to, within)| Form::Attract { to, within }),
        What::Avoid => course(&block).zip(within(&block)).map(|(from, within)| Form::Avoid { from, within }),
        What::Direction => field(&block).map(Form::Direction),
        What::Labels => ratios(&block).map(Form::Ratios),
        What::Schedule => schedule(&block),
    };
    let strength = block.number("strength", 0.0..=100.0, "");
    let during = block.tuple("during", 2..=2, "[from, to] in seconds").map(|d| [d[0], d[1]]);
    let labels = block.texts("labels");
    block.finish();
    Some(Term { form: form?, strength: strength.unwrap_or(1.0), labels, during })
}

/// The `point` or the `path` of a block.
fn course(block: &Section) -> Option<Vec<Vec2>> {
    let (point, path) = (block.has("point"), path(block, "path"));
    match (point, path.len()) {
        (true, 0) => Some(vec![block.point("point")?]),
        (false, 2..=MAX_POINTS) => Some(path),
        _ => {
            let problem = format!("expected either a `point` [x, z] or a `path` of 2 to {MAX_POINTS} points");
            block.bad(&block.span_of("path"), "point", &problem);
            None
        }
    }
}

fn path(block: &Section, key: &'static str) -> Vec<Vec2> {
    block.rows(key, 2..=2, "points [x, z]").into_iter().map(|p| Vec2::new(p[0], p[1])).collect()
}

fn within(block: &Section) -> Option<f32> {
    if !block.has("within") {
        block.missing("within", "a distance in metres");
    }
    block.number("within", 0.01..=10_000.0, " m")
}

fn field(block: &Section) -> Option<Field> {
    let clockwise = block.get("clockwise").map(|v| (v.span(), v.get_ref().as_bool()));
    if let Some((span, None)) = &clockwise {
        block.bad(span, "clockwise", "expected true or false");
    }
    let clockwise = clockwise.is_some_and(|c| c.1 == Some(true));
    let heading = block.number("heading_deg", -360.0..=360.0, " degrees").map(|d| Field::Heading(d.to_radians()));
    let around = block.point("around").map(|c| Field::Around(c, clockwise));
    let along = path(block, "along");
    let along = (2..=MAX_POINTS).contains(&along.len()).then_some(Field::Along(along));
    let ways =
        [heading, block.point("toward").map(Field::Toward), block.point("away_from").map(Field::Away), along, around];
    let mut ways = ways.into_iter().flatten();
    match (ways.next(), ways.next()) {
        (Some(field), None) => Some(field),
        _ => {
            let problem =
                "expected one of `toward`, `away_from`, `around` (points), `along` (2 points or more), `heading_deg`";
            block.bad(&block.span, "what", problem);
            None
        }
    }
}

fn schedule(block: &Section) -> Option<Form> {
    let times: Vec<[f32; 2]> =
        block.rows("times", 2..=2, "windows [from, to] in seconds").iter().map(|w| [w[0], w[1]]).collect();
    let fade = block.number("fade_secs", 0.01..=3600.0, " s").unwrap_or(1.0);
    if times.is_empty() || times.iter().any(|[from, to]| from > to) {
        block.bad(&block.span_of("times"), "times", "expected windows [from, to] in seconds, from before to");
        return None;
    }
    Some(Form::Schedule { times, fade })
}

fn ratios(block: &Section) -> Option<Vec<(String, f32)>> {
    let Some(table) = block.section("ratios") else {
        if !block.has("ratios") {
            block.missing("ratios", "a table of labels and how often they are wanted, 1 being as often as without");
        }
        return None;
    };
    let read = |(label, value): (String, &toml::Spanned<toml::de::DeValue>)| {
        let ratio = number(value.get_ref()).filter(|n| (1e-6..=1e6).contains(n));
        if ratio.is_none() {
            let problem = "expected a number from 0.000001 to 1000000; `kinds.without` leaves kinds out";
            block.bad(&value.span(), &format!("ratios {label}"), problem);
        }
        Some((label, ratio? as f32))
    };
    Some(table.entries().filter_map(read).collect())
}
