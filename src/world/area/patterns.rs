//! Patterns of the borders between cells: as many people as the border is long, as few as there is room for.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::Area;
use super::cells::Cell;
use crate::stage::world::mix;
use crate::world::{Limits, Pattern, PatternType, spacing};

/// A border between two cells, as the first sees it.
#[derive(Clone, Debug)]
pub(super) struct Border {
    /// The cell with the smaller index, and which of its edges it is.
    pub first: (usize, usize),
    /// The cell on the other side, and its edge.
    pub second: (usize, usize),
    /// What crosses it.
    pub pattern: Pattern,
    /// By how much its people were reduced.
    pub calm: u32,
}

/// All borders that somebody may cross, with patterns.
pub(super) fn borders(area: &Area, cells: &[Cell]) -> Vec<Border> {
    let mut found = Vec::new();
    for (index, cell) in cells.iter().enumerate() {
        for (edge, beyond) in cell.beyond.iter().enumerate() {
            if let Some(second) = beyond.filter(|other| other.0 > index) {
                let pattern = Pattern::empty(length(cell, edge), area.period);
                let mut border = Border { first: (index, edge), second, pattern, calm: 0 };
                fill(area, cells, &mut border);
                found.push(border);
            }
        }
    }
    found
}

/// Gives a border a pattern with fewer people than before.
pub(super) fn calm(area: &Area, cells: &[Cell], border: &mut Border) {
    border.calm += 1;
    fill(area, cells, border);
}

/// A random pattern of the border's type, scaled by its length.
fn fill(area: &Area, cells: &[Cell], border: &mut Border) {
    let (cell, edge) = (&cells[border.first.0], border.first.1);
    let length = length(cell, edge);
    border.pattern = Pattern::empty(length, area.period);
    let Some(kind) = kind(area, cell.template, cells[border.second.0].template) else { return };
    let share = length / area.side / (1 << border.calm.min(16)) as f32;
    let most = kind.inputs.count.min(kind.outputs.count) as f32 * share;
    let ends = ends(cells, border);
    // As many in as out, so that any cell is balanced.
    for count in (1..=most.round() as usize).rev() {
        let (mut inputs, mut outputs) = (kind.inputs, kind.outputs);
        (inputs.count, outputs.count) = (count, count);
        let seed =
            [border.first.0, border.first.1, border.calm as usize].into_iter().fold(area.seed, |h, v| mix(h, v as u64));
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let scaled = PatternType { inputs, outputs };
        if let Ok(pattern) = scaled.generate_between(ends, length, area.period, &Limits::default(), &mut rng) {
            border.pattern = pattern;
            return;
        }
    }
}

fn kind(area: &Area, first: usize, second: usize) -> Option<PatternType> {
    let [a, b] = [first, second].map(|index| &area.templates[index]);
    a.borders.get(&b.name).copied().or_else(|| b.borders.get(&a.name).map(PatternType::mirror))
}

/// How near to the ends of a border people may cross it: the corners of both cells count.
fn ends(cells: &[Cell], border: &Border) -> (f32, f32) {
    let room = |(cell, edge): (usize, usize)| {
        let n = cells[cell].corners.len();
        (spacing::corner_room(angle(&cells[cell], edge)), spacing::corner_room(angle(&cells[cell], (edge + 1) % n)))
    };
    let (own, theirs) = (room(border.first), room(border.second));
    (own.0.max(theirs.1), own.1.max(theirs.0))
}

/// Interior angle at a corner.
fn angle(cell: &Cell, corner: usize) -> f32 {
    let n = cell.corners.len();
    let side = |i: usize| cell.corners[(i + 1) % n] - cell.corners[i % n];
    (std::f64::consts::PI - side(corner + n - 1).angle_to(side(corner))) as f32
}

fn length(cell: &Cell, edge: usize) -> f32 {
    let n = cell.corners.len();
    // From differences in single precision, as the frame's outline has them.
    (cell.corners[(edge + 1) % n] - cell.corners[edge]).as_vec2().length()
}
