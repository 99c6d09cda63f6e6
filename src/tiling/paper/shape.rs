//! How the role of a kind deforms when its ports are moved (section 3).
//!
//! The motion of a single person is one strand from entry to exit. In a patch of several people the frames of the
//! interaction stay rigid, in space and in time, and the legs to and from them are strands.

use super::super::library::{Library, Role};
use super::ports::ENTRY;
use crate::deform::{Limits, Strand};
use crate::geom::Ground;
use crate::motion::MotionPath;
use crate::patch::PatchKind;

/// A strand that covers less way than this has nothing to bend, metres.
const LEAST_WAY: f32 = 0.3;

/// A role made ready to be deformed.
pub(super) enum Shape {
    /// Deforms from entry to exit.
    Whole(Strand),
    /// Frames `first..=last` are rigid.
    Legs {
        /// From the entry to frame `first`.
        entry: Option<Strand>,
        /// From frame `last` to the exit.
        exit: Option<Strand>,
        /// First rigid frame.
        first: usize,
        /// Last rigid frame.
        last: usize,
    },
    /// Does not deform at all.
    Rigid,
}

/// The shapes of all roles of a library.
pub(super) fn shapes(library: &Library) -> Vec<Shape> {
    library.roles.iter().map(|role| shape(role, &library.set.kinds[role.kind as usize])).collect()
}

fn shape(role: &Role, kind: &PatchKind) -> Shape {
    let end = role.path.len() - 1;
    if kind.people() == 1 {
        return strand(&role.path, 0, end).map_or(Shape::Rigid, Shape::Whole);
    }
    let Some((begin, finish)) = interaction(kind) else { return Shape::Rigid };
    let first = (begin as i32 - role.begin).clamp(0, end as i32) as usize;
    let last = (finish as i32 - role.begin).clamp(first as i32, end as i32) as usize;
    Shape::Legs { entry: strand(&role.path, 0, first), exit: strand(&role.path, last, end), first, last }
}

/// The frames over which relative placement must not change: the core, or else from the first contact to the last.
fn interaction(kind: &PatchKind) -> Option<(u32, u32)> {
    let contacts = kind.contacts.iter().map(|c| (c.begin, c.end));
    kind.core.into_iter().chain(contacts).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

fn strand(path: &MotionPath, from: usize, to: usize) -> Option<Strand> {
    let way: f32 = path.points[from..=to].windows(2).map(|w| w[0].distance(w[1])).sum();
    (way > LEAST_WAY).then(|| {
        Strand::new(&MotionPath {
            points: path.points[from..=to].to_vec(),
            headings: path.headings[from..=to].to_vec(),
        })
    })
}

impl Shape {
    /// True if the port on `side` can be moved in place.
    pub fn bends(&self, side: u32) -> bool {
        match self {
            Shape::Whole(_) => true,
            Shape::Legs { entry, exit, .. } => if side == ENTRY { entry } else { exit }.is_some(),
            Shape::Rigid => false,
        }
    }

    /// The role's path with its ends moved to `ends`; `rest` is where its rigid part puts the entry. `None` if a
    /// limit is broken.
    pub fn deform(&self, role: &Role, rest: Ground, ends: [Ground; 2], limits: &Limits) -> Option<MotionPath> {
        let rest_exit = rest.then(role.exit);
        let mut out = MotionPath::default();
        match self {
            Shape::Whole(strand) if same(ends[0].then(role.exit), ends[1]) => {
                debug_assert_eq!(strand.frames(), role.path.len());
                Some(placed(role, ends[0]))
            }
            Shape::Whole(strand) => strand.deform(ends[0], ends[1], limits, &mut out).then_some(out),
            Shape::Rigid if same(rest, ends[0]) && same(rest_exit, ends[1]) => Some(placed(role, rest)),
            Shape::Rigid => None,
            Shape::Legs { entry, exit, first, last } => {
                let mut path = placed(role, rest);
                if !same(rest, ends[0]) {
                    // The turn that leads back to the rigid part without a jump of 2 pi.
                    let to = path.at(*first);
                    if !entry.as_ref()?.deform(ends[0], to, limits, &mut out) {
                        return None;
                    }
                    let shift = to.heading - out.headings[*first];
                    path.points[..=*first].copy_from_slice(&out.points);
                    (0..=*first).for_each(|i| path.headings[i] = out.headings[i] + shift);
                }
                if !same(rest_exit, ends[1]) {
                    if !exit.as_ref()?.deform(path.at(*last), ends[1], limits, &mut out) {
                        return None;
                    }
                    path.points[*last..].copy_from_slice(&out.points);
                    path.headings[*last..].copy_from_slice(&out.headings);
                }
                Some(path)
            }
        }
    }
}

/// The role's own path from an entry.
fn placed(role: &Role, entry: Ground) -> MotionPath {
    MotionPath {
        points: role.path.points.iter().map(|&p| entry.apply(p)).collect(),
        headings: role.path.headings.iter().map(|h| h + entry.heading).collect(),
    }
}

/// True if two states differ by rounding only.
pub(super) fn same(a: Ground, b: Ground) -> bool {
    a.position.distance_squared(b.position) < 1e-8 && crate::geom::wrap_angle(a.heading - b.heading).abs() < 1e-4
}
