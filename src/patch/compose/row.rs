//! Rows: roles of which there are several, side by side.

use glam::Vec2;

use super::story::{Carried, Composition, Moment, Place, Prop, Role, Touches, Use};
use crate::geom::Ground;

/// What a compose file's `row` says.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// Indices of roles.
    pub roles: Vec<usize>,
    pub count: usize,
    /// To the left of the first of the roles, metres.
    pub spacing: f32,
    /// Seconds by which each acts later than the one before.
    pub delay: f32,
    pub line: usize,
}

/// The composition with the row's roles repeated, called `NAME-1`, `NAME-2`, ... Whatever holds among the row's roles
/// holds in every repetition; what holds between them and others, only in the first.
pub(super) fn lay_out(story: &Composition, row: &Row) -> Composition {
    let mut out = story.clone();
    let (people, among) = (story.roles.len(), row.roles.len());
    let repeated = |copy: usize, role: usize| match row.roles.iter().position(|&r| r == role) {
        Some(at) if copy > 0 => people + (copy - 1) * among + at,
        _ => role,
    };
    for &role in &row.roles {
        out.roles[role].name += "-1";
    }
    for copy in 1..row.count {
        for &role in &row.roles {
            let Role { name, plays, line, .. } = story.roles[role].clone();
            out.roles.push(Role { name: format!("{name}-{}", copy + 1), plays, start: None, line });
        }
        let inside = |role: usize| row.roles.contains(&role);
        let moved = |m: &Moment| Moment { role: repeated(copy, m.role), ..m.clone() };
        let own = story.places.iter().filter(|p| inside(p.who.role) && inside(p.seen_from.role));
        out.places.extend(own.map(|p| Place { who: moved(&p.who), seen_from: moved(&p.seen_from), ..p.clone() }));
        let own = story.touches.iter().filter(|t| t.sides.iter().all(|s| inside(s.0)));
        out.touches.extend(own.map(|t| Touches {
            sides: t.sides.map(|(role, part)| (repeated(copy, role), part)),
            from: moved(&t.from),
            to: moved(&t.to),
            line: t.line,
        }));
        let used = |p: &&Prop| p.held.iter().chain(&p.sat).all(|u| inside(u.who.role));
        out.props.extend(story.props.iter().filter(used).map(|p| {
            let own = |u: &Use| {
                let span = u.span.each_ref().map(|m| m.as_ref().map(moved));
                let carried = u.carried.iter().map(|c| Carried { at: moved(&c.at), ..*c }).collect();
                Use { who: moved(&u.who), span, turn: u.turn, carried }
            };
            let [held, sat] = [&p.held, &p.sat].map(|all| all.iter().map(own).collect());
            Prop { name: format!("{}-{}", p.name, copy + 1), held, sat, ..p.clone() }
        }));
        let beside = moment_of(story, row.roles[0]);
        out.places.push(Place {
            who: Moment { role: repeated(copy, row.roles[0]), ..beside.clone() },
            seen_from: Moment { role: repeated(copy - 1, row.roles[0]), ..beside },
            at: Ground::new(Vec2::new(row.spacing, 0.0), 0.0),
            delay: row.delay,
            line: row.line,
        });
    }
    out
}

/// When people of a row stand beside each other: when anything is said of the role, else all the time.
fn moment_of(story: &Composition, role: usize) -> Moment {
    let told = story.places.iter().flat_map(|p| [&p.seen_from, &p.who]).find(|m| m.role == role);
    let all = || Moment { role, part: None, seconds: None, text: story.roles[role].name.clone() };
    told.cloned().unwrap_or_else(all)
}
