//! Tryout: the people of a draft are seen with their final bodies before it is proposed, so that what moves as nobody can,
//! or lets partners run into each other, never comes into the tiling. Only what is new is looked at.

use std::ops::Range;

use super::bake::uses;
use super::domain::Domain;
use super::draft::Draft;
use super::faults::{captured_depth, first_unclean};
use super::figure::{Figure, TOLERANCE, frame_at};
use super::library::Library;
use super::occupancy::PieceId;
use super::piece::Piece;
use super::rehearsal::segments;
use super::sketch::Sketch;
use super::tracks::{NEWCOMER, TrackId};
use crate::motion::canonical;
use crate::refine::{Body, refine_all};

/// Ticks around what is new over which its stitches may change a body: a blend, the plant that it moves, the swing after
/// that one.
const STITCH_TICKS: i32 = 56;
/// Ticks around that whose patches are looked at as well, so that nothing is seen differently than in the end.
const LEAD_TICKS: i32 = 40;
/// Hips farther apart than this are of people who do not touch, metres.
const FAR: f32 = 2.2;

/// Somebody's part in a draft.
struct Turn<'d> {
    /// The patches around all that is new.
    pieces: Vec<&'d Piece>,
    /// When there is something new of this person.
    ticks: Option<Range<i32>>,
}

impl<'d> Turn<'d> {
    fn new(draft: &'d Draft, track: &[PieceId], ticks: Option<Range<i32>>, around: &Range<i32>) -> Self {
        let loops = draft.base.domain.cycle.loops();
        let is_near = |p: &&Piece| p.end > around.start - LEAD_TICKS && p.begin < around.end + LEAD_TICKS;
        let pieces = track.iter().map(|&id| draft.piece(id)).filter(|p| loops || is_near(p));
        Self { pieces: pieces.collect(), ticks }
    }

    fn piece_at(&self, tick: i32) -> Option<&'d Piece> {
        self.pieces.iter().copied().find(|p| tick < p.end)
    }
}

/// From the first to the last new piece of a track, and as far around it as it may change something.
fn ticks_of(draft: &Draft, track: &[PieceId], is_new: impl Fn(PieceId) -> bool) -> Option<Range<i32>> {
    let mut new = track.iter().filter(|&&id| is_new(id)).map(|&id| draft.piece(id));
    let first = new.next()?;
    let last = new.next_back().unwrap_or(first);
    Some(first.begin - STITCH_TICKS..last.end + STITCH_TICKS)
}

/// True if everybody in a draft moves as people can and no two of them run into each other. Where time comes round, each
/// person counts ticks from somewhere else; there only the former is told. O(new ticks x joints).
pub(super) fn is_clean(draft: &Draft) -> bool {
    try_out(draft, &[], Sketch::is_sketched)
}

/// The same, and nobody runs into some others either.
pub(super) fn is_clean_beside(draft: &Draft, others: &[TrackId]) -> bool {
    let changes = |other: &TrackId| draft.changed().iter().any(|(track, _)| track == other);
    let mut others: Vec<TrackId> = others.iter().copied().filter(|other| !changes(other)).collect();
    others.dedup();
    try_out(draft, &others, Sketch::is_sketched)
}

/// The same as [`is_clean`] from the first to the last of some pieces of each person.
pub(super) fn is_clean_where(draft: &Draft, is_new: impl Fn(PieceId) -> bool) -> bool {
    try_out(draft, &[], is_new)
}

/// Looks at everybody in a draft with new pieces, and at some others who stay as they are.
fn try_out(draft: &Draft, others: &[TrackId], is_new: impl Fn(PieceId) -> bool) -> bool {
    let (library, domain) = (draft.base.library, draft.base.domain);
    let new = |track: &'_ [PieceId]| ticks_of(draft, track, &is_new);
    let union = |a: Range<i32>, b: Range<i32>| a.start.min(b.start)..a.end.max(b.end);
    let Some(around) = tracks(draft).filter_map(new).reduce(union) else { return true };
    let tracks = tracks(draft).map(|track| (track, new(track)));
    let others = others.iter().map(|&other| (draft.base.tracks[other].as_slice(), None));
    let turns: Vec<Turn> = tracks.chain(others).map(|(track, new)| Turn::new(draft, track, new, &around)).collect();
    let chains: Vec<_> = turns.iter().map(|t| uses(library, domain, t.pieces.iter().copied())).collect();
    let people: Vec<_> = chains.iter().map(|chain| segments(chain)).collect();
    let bodies = refine_all(&people, domain.last_frame(), domain.torus).bodies;
    turns.iter().zip(&bodies).all(|(turn, body)| moves_cleanly(library, domain, turn, body))
        && (domain.cycle.loops() || all_are_apart(draft, &turns, &bodies, &around))
}

fn moves_cleanly(library: &Library, domain: &Domain, turn: &Turn, body: &Body) -> bool {
    let Some(ticks) = &turn.ticks else { return true };
    // Where time comes round, in the second lap or right before it.
    let lap = domain.cycle.fold(ticks.start, domain.frames().start) - ticks.start;
    let frame = |tick: i32| (tick + lap - body.begin as i32).clamp(0, body.root.len() as i32) as usize;
    first_unclean(body, library, domain, frame(ticks.start)..frame(ticks.end)).is_none()
}

fn all_are_apart(draft: &Draft, turns: &[Turn], bodies: &[Body], ticks: &Range<i32>) -> bool {
    let apart = |i: usize, j: usize| are_apart(draft, [&turns[i], &turns[j]], [&bodies[i], &bodies[j]], ticks);
    (0..turns.len()).all(|i| (0..i).all(|j| apart(i, j)))
}

/// All pieces of those who change.
fn tracks<'d>(draft: &'d Draft) -> impl Iterator<Item = &'d [PieceId]> + Clone {
    let changed = draft.changed();
    let is_last = move |i: usize| changed[i].0 == NEWCOMER || changed[i + 1..].iter().all(|c| c.0 != changed[i].0);
    changed.iter().enumerate().filter(move |(i, _)| is_last(*i)).map(|(_, c)| c.1.as_slice())
}

/// True if two people are never deeper in each other than they were captured.
fn are_apart(draft: &Draft, turns: [&Turn; 2], bodies: [&Body; 2], ticks: &Range<i32>) -> bool {
    let near = |tick: i32| {
        let [a, b] = bodies.map(|body| frame_at(body, tick).map(|frame| body.root[frame]));
        a.zip(b).is_some_and(|(a, b)| a.distance_squared(b) < FAR * FAR)
    };
    ticks.clone().filter(|&tick| near(tick)).all(|tick| {
        let [a, b] = bodies.map(|body| Figure::of(body, canonical(), tick).expect("near, so there"));
        let depth = a.depth_into(&b);
        let pieces = turns.map(|t| t.piece_at(tick));
        depth <= TOLERANCE || depth <= TOLERANCE + captured_depth(draft.base.library, draft.base.domain, pieces, tick)
    })
}

#[cfg(test)]
mod tests {
    use super::super::common::plain_set;
    use super::super::draft::Desk;
    use super::super::scene::Scene;
    use super::super::tracks::Tracks;
    use super::*;
    use crate::deform::Limits;
    use crate::geom::Ground;
    use crate::patch::PatchSet;
    use glam::Vec2;

    /// Puts somebody into a draft who does what the first role of a kind does.
    fn add(draft: &mut Draft, kind: &str, x: f32) {
        let (library, domain) = (draft.base.library, draft.base.domain);
        let kind = library.set.kinds.iter().position(|k| k.name == kind).unwrap();
        let (role, at) = (library.first_role[kind], Ground::new(Vec2::new(x, 5.0), 0.0));
        let id = draft.add(Piece::rigid(library, domain, role, super::super::bridge::NO_INSTANCE, at, 100));
        draft.push_track(vec![id]);
    }

    /// Two people alone, the second `apart` metres beside the first; true if they are let pass.
    fn tried(set: &PatchSet, kind: &str, apart: f32) -> bool {
        let library = Library::new(set, Limits::default());
        let domain = Domain::new(&Scene::demo()).unwrap();
        let tracks = Tracks::new(&library, &domain);
        let mut desk = Desk::default();
        let mut draft = Draft::new(&tracks, &mut desk);
        [5.0, 5.0 + apart].into_iter().for_each(|x| add(&mut draft, kind, x));
        is_clean(&draft)
    }

    #[test]
    fn who_runs_into_somebody_who_stays_as_they_are_is_not_let_pass_beside_them() {
        let (set, domain) = (plain_set(), Domain::new(&Scene::demo()).unwrap());
        let library = Library::new(&set, Limits::default());
        let mut tracks = Tracks::new(&library, &domain);
        let (mut desk, mut later) = (Desk::default(), Desk::default());
        let mut draft = Draft::new(&tracks, &mut desk);
        add(&mut draft, "idle-40", 5.0);
        let change = draft.finish();
        assert!(tracks.apply(change));
        for (apart, passes) in [(0.15, false), (0.9, true)] {
            let mut draft = Draft::new(&tracks, &mut later);
            add(&mut draft, "idle-40", 5.0 + apart);
            assert!(is_clean(&draft));
            assert_eq!(is_clean_beside(&draft, &[0, 0]), passes, "{apart}");
        }
    }

    #[test]
    fn people_who_run_into_each_other_are_not_let_pass() {
        let set = plain_set();
        for kind in ["idle-40", "cycle-1"] {
            assert!(!tried(&set, kind, 0.15) && tried(&set, kind, 0.9), "{kind}");
        }
    }

    #[test]
    fn who_moves_as_nobody_can_is_not_let_pass() {
        let mut set = plain_set();
        let limb = crate::motion::joint::LEFT_FORE_ARM;
        let turned = |set: &mut PatchSet, angle: f32| {
            let kind = set.kinds.iter_mut().find(|k| k.name == "idle-40").unwrap();
            let rotations = &mut kind.fragments[0].motion.rotations;
            // Between two frames, far from the ends, and back again.
            rotations[20 * JOINT_COUNT + limb] = glam::Quat::from_rotation_y(angle);
        };
        turned(&mut set, 0.0);
        assert!(tried(&set, "idle-40", 1.5));
        // The fastest turn of the set is this one itself; played at another speed it would be too fast.
        turned(&mut set, 1.0);
        let library = Library::new(&set, Limits::default());
        let body = |frames: std::ops::Range<usize>| {
            let kind = set.kinds.iter().find(|k| k.name == "idle-40").unwrap();
            let poses = frames.flat_map(|f| kind.fragments[0].motion.pose(f).to_vec());
            Body { root: vec![glam::Vec3::new(5.0, 0.9, 5.0); 6], rotations: poses.collect(), ..Body::default() }
        };
        let mut fast = body(17..23);
        fast.rotations[3 * JOINT_COUNT + limb] = glam::Quat::from_rotation_y(1.3);
        let domain = Domain::new(&Scene::demo()).unwrap();
        assert!(first_unclean(&body(17..23), &library, &domain, 0..6).is_none());
        assert_eq!(first_unclean(&fast, &library, &domain, 0..6), Some(3));
    }

    use crate::motion::JOINT_COUNT;
}
