//! Tryout: the people of a draft are seen with their final bodies before it is proposed, so that what moves as nobody can,
//! or lets partners run into each other, never comes into the tiling. Only what is new is looked at.

use std::ops::Range;

use super::bake::uses;
use super::draft::Draft;
use super::faults::{captured_depth, first_unclean};
use super::figure::{Figure, TOLERANCE, frame_at};
use super::occupancy::PieceId;
use super::piece::Piece;
use super::rehearsal::segments;
use super::sketch::Sketch;
use super::tracks::NEWCOMER;
use crate::motion::canonical;
use crate::refine::{Body, refine_all};

/// Ticks around what is new over which its stitches may change a body.
const BLEND_TICKS: i32 = 16;
/// Ticks around that whose patches are looked at as well, so that nothing is seen differently than in the end.
const LEAD_TICKS: i32 = 40;
/// Hips farther apart than this are of people who do not touch, metres.
const FAR: f32 = 2.2;

/// What is new of somebody.
struct Turn<'d> {
    /// The patches around it.
    pieces: Vec<&'d Piece>,
    /// When.
    ticks: Range<i32>,
}

impl<'d> Turn<'d> {
    /// `None` if nothing is new in a track.
    fn of(draft: &'d Draft, track: &[PieceId]) -> Option<Self> {
        let mut new = track.iter().filter(|&&id| Sketch::is_sketched(id)).map(|&id| draft.piece(id));
        let first = new.next()?;
        let last = new.next_back().unwrap_or(first);
        let ticks = first.begin - BLEND_TICKS..last.end + BLEND_TICKS;
        let is_near = |p: &&Piece| p.end > ticks.start - LEAD_TICKS && p.begin < ticks.end + LEAD_TICKS;
        Some(Self { pieces: track.iter().map(|&id| draft.piece(id)).filter(is_near).collect(), ticks })
    }

    fn piece_at(&self, tick: i32) -> Option<&'d Piece> {
        self.pieces.iter().copied().find(|p| tick < p.end)
    }
}

/// True if everybody in a draft moves as people can and no two of them run into each other. O(new ticks x joints).
pub(super) fn is_clean(draft: &Draft) -> bool {
    let (library, domain) = (draft.base.library, draft.base.domain);
    let turns: Vec<Turn> = tracks(draft).filter_map(|track| Turn::of(draft, track)).collect();
    let chains: Vec<_> = turns.iter().map(|t| uses(library, domain.horizon, t.pieces.iter().copied())).collect();
    let people: Vec<_> = chains.iter().map(|chain| segments(chain)).collect();
    let bodies = refine_all(&people, domain.horizon as u32 - 1).bodies;
    let alone = |(turn, body): (&Turn, &Body)| {
        let frame = |tick: i32| (tick - body.begin as i32).clamp(0, body.root.len() as i32) as usize;
        first_unclean(body, library, domain, frame(turn.ticks.start)..frame(turn.ticks.end)).is_none()
    };
    turns.iter().zip(&bodies).all(alone)
        && (0..turns.len()).all(|i| (0..i).all(|j| are_apart(draft, [&turns[i], &turns[j]], [&bodies[i], &bodies[j]])))
}

/// All pieces of those who change.
fn tracks<'d>(draft: &'d Draft) -> impl Iterator<Item = &'d [PieceId]> {
    let changed = draft.changed();
    let is_last = move |i: usize| changed[i].0 == NEWCOMER || changed[i + 1..].iter().all(|c| c.0 != changed[i].0);
    changed.iter().enumerate().filter(move |(i, _)| is_last(*i)).map(|(_, c)| c.1.as_slice())
}

/// True if two people are never deeper in each other than they were captured.
fn are_apart(draft: &Draft, turns: [&Turn; 2], bodies: [&Body; 2]) -> bool {
    let ticks = turns[0].ticks.start.max(turns[1].ticks.start)..turns[0].ticks.end.min(turns[1].ticks.end);
    let near = |tick: i32| {
        let [a, b] = bodies.map(|body| frame_at(body, tick).map(|frame| body.root[frame]));
        a.zip(b).is_some_and(|(a, b)| a.distance_squared(b) < FAR * FAR)
    };
    ticks.into_iter().filter(|&tick| near(tick)).all(|tick| {
        let [a, b] = bodies.map(|body| Figure::of(body, canonical(), tick).expect("near, so there"));
        let depth = a.depth_into(&b);
        let pieces = turns.map(|t| t.piece_at(tick));
        depth <= TOLERANCE || depth <= TOLERANCE + captured_depth(draft.base.library, pieces, tick)
    })
}
