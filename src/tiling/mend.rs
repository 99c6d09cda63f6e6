//! Mending: where something is wrong with the final bodies, a window of one person's track is ripped up and bridged anew.

use std::ops::RangeInclusive;

use rand::RngExt;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::bake::{Chains, segments_of};
use super::bridge::Taste;
use super::faults::{Fault, first_unclean};
use super::tracks::{TrackId, Tracks, Undo, Window};
use crate::patch::PatchKind;
use crate::refine::{Body, Performance, Segment, refine, refine_all};
use crate::stage::FragmentUse;

/// Windows around a fault are widened by multiples of this, ticks.
const WINDOW: i32 = 24;
/// Neighbours of the piece at fault among which a patch of several people is given up.
const DISSOLVE_REACH: usize = 3;
/// Tries per fault.
const TRIES: i32 = 10;
/// Ticks around a window over which its stitches may change a body.
const BLEND_TICKS: i32 = 16;

/// The final bodies of all people, and the boxes that they carry.
pub(super) fn perform(chains: Chains) -> Performance {
    let uses: Vec<_> = (0..chains.lists.len()).map(|t| segments_of(chains, t)).collect();
    let people: Vec<Vec<Segment>> = uses.iter().map(|uses| segments(uses)).collect();
    refine_all(&people, chains.domain.horizon as u32 - 1)
}

/// The final body of a person, but for touching others.
fn body(chains: Chains, track: TrackId) -> Body {
    refine(&segments(&segments_of(chains, track)), chains.domain.horizon as u32 - 1)
}

fn segments<'a>(uses: &'a [(&'a PatchKind, FragmentUse)]) -> Vec<Segment<'a>> {
    uses.iter().map(|(kind, placed)| Segment { kind, placed }).collect()
}

/// Bridges one of the two people's tracks anew around the fault; false if no way was found.
pub(super) fn mend(tracks: &mut Tracks, fault: Fault, taste: Taste, rng: &mut ChaCha8Rng) -> bool {
    (0..TRIES).any(|attempt| {
        let track = if rng.random_range(0..2) == 0 { fault.a } else { fault.b };
        near(tracks, track, fault.tick, 1, |people| people == 1).is_some_and(|at| {
            rebridge(tracks, vec![Window { track, from: at, to: at + 1 }], attempt + 1..=attempt + 1, taste, rng)
        })
    })
}

/// Takes out the patch of several people nearest to a fault that nothing else mends, and bridges its people's tracks;
/// false if there is none or no way was found.
pub(super) fn dissolve(tracks: &mut Tracks, fault: Fault, taste: Taste, rng: &mut ChaCha8Rng) -> bool {
    (0..TRIES).any(|attempt| {
        let track = if rng.random_range(0..2) == 0 { fault.a } else { fault.b };
        let Some(at) = near(tracks, track, fault.tick, DISSOLVE_REACH, |people| people > 1) else { return false };
        let instance = tracks.piece(tracks.tracks[track][at]).instance;
        let windows: Vec<Window> = (0..tracks.tracks.len())
            .filter_map(|t| {
                let from = tracks.tracks[t].iter().position(|&id| tracks.piece(id).instance == instance)?;
                Some(Window { track: t, from, to: from + 1 })
            })
            .collect();
        rebridge(tracks, windows, 0..=attempt, taste, rng)
    })
}

/// Index of the piece at `tick`, or of the nearest of `reach` neighbours on either side, whose patch has the wanted
/// number of people.
fn near(tracks: &Tracks, track: TrackId, tick: i32, reach: usize, wanted: impl Fn(usize) -> bool) -> Option<usize> {
    let pieces = &tracks.tracks[track];
    let at = tracks.index_at(track, tick).min(pieces.len() - 1);
    let distance = |i: &usize| {
        let p = tracks.piece(pieces[*i]);
        (p.begin - tick).max(tick - p.end).max(0)
    };
    let neighbours = at.saturating_sub(reach)..(at + reach + 1).min(pieces.len());
    neighbours.filter(|&i| wanted(tracks.people_of(pieces[i]))).min_by_key(distance)
}

/// Rips up windows of tracks, each widened by as many [`WINDOW`]s as are drawn, and bridges them another way, in random
/// order, on which everybody moves cleanly.
fn rebridge(
    tracks: &mut Tracks,
    mut windows: Vec<Window>,
    wider: RangeInclusive<i32>,
    taste: Taste,
    rng: &mut ChaCha8Rng,
) -> bool {
    let mut undo = Undo::default();
    windows.shuffle(rng);
    for window in &mut windows {
        *window = tracks.widen(*window, WINDOW * rng.random_range(wider.clone()));
    }
    let spans: Vec<_> =
        windows.iter().map(|w| (tracks.port(w.track, w.from).tick, tracks.port(w.track, w.to).tick)).collect();
    windows.iter().for_each(|&w| tracks.hide_window(w, &mut undo));
    let done = windows.iter().all(|&w| tracks.bridge_window(w, taste, rng, &mut undo).is_some())
        && windows.iter().zip(&spans).all(|(w, span)| is_clean(tracks.chains(), w.track, *span));
    if done {
        tracks.commit(undo);
    } else {
        tracks.roll_back(undo);
    }
    done
}

/// True if a person moves cleanly over some ticks and a blend's length around them.
fn is_clean(chains: Chains, track: TrackId, (from, to): (i32, i32)) -> bool {
    let body = body(chains, track);
    let frame = |tick: i32| (tick - body.begin as i32).clamp(0, body.root.len() as i32) as usize;
    first_unclean(&body, chains, frame(from - BLEND_TICKS)..frame(to + BLEND_TICKS)).is_none()
}
