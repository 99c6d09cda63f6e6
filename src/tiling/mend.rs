//! Mending: where something is wrong with the final bodies, a window of one person's track is ripped up and bridged anew.

use std::ops::RangeInclusive;

use rand::RngExt;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::bridge::Taste;
use super::draft::Draft;
use super::faults::Fault;
use super::occupancy::PieceId;
use super::piece::Company;
use super::seed::{is_free_to_stand, stand_aside};
use super::tracks::{TrackId, Tracks, Window};
use super::tryout::is_clean_beside;

/// Windows around a fault are widened by multiples of this, ticks.
const WINDOW: i32 = 24;
/// Neighbours of the piece at fault among which a patch of several people is given up.
const DISSOLVE_REACH: usize = 3;
/// Tries per fault.
const TRIES: i32 = 10;

/// Bridges one of the two people's tracks anew around the fault.
pub(super) fn mend(draft: &mut Draft, fault: Fault, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    (0..TRIES).find_map(|attempt| {
        let track = if rng.random_range(0..2) == 0 { fault.a } else { fault.b };
        let at = near(draft.base, track, fault.tick, 1, |id| draft.base.is_loose(id))?;
        rebridge(draft, fault, vec![Window { track, from: at, to: at + 1 }], attempt + 1..=attempt + 1, (taste, rng))
    })
}

/// Takes out the patch of several people nearest to a fault that nothing else mends, and bridges its people's tracks.
pub(super) fn dissolve(draft: &mut Draft, fault: Fault, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    let tracks = draft.base;
    (0..TRIES).find_map(|attempt| {
        let track = if rng.random_range(0..2) == 0 { fault.a } else { fault.b };
        let at = near(tracks, track, fault.tick, DISSOLVE_REACH, |id| tracks.people_of(id) > 1)?;
        let piece = tracks.piece(tracks.tracks[track][at]);
        // What a scene has placed stays.
        if !tracks.library.multi.contains(&tracks.library.roles[piece.role as usize].kind) {
            return None;
        }
        let instance = piece.instance;
        let window = |track| tracks.index_in(track, instance).map(|from| Window { track, from, to: from + 1 });
        let windows = (0..tracks.tracks.len()).filter_map(window).collect();
        rebridge(draft, fault, windows, 0..=attempt, (taste, rng))
    })
}

/// Lets one of the two people, if alone all the time, stand near where they began instead.
pub(super) fn restand(draft: &mut Draft, fault: Fault, stand: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    (0..TRIES).find_map(|_| {
        let track = if rng.random_range(0..2) == 0 { fault.a } else { fault.b };
        if !is_free_to_stand(draft.base, track) {
            return None;
        }
        draft.restart();
        draft.hide(Window { track, from: 0, to: draft.base.tracks[track].len() });
        let pieces = stand_aside(draft, track, stand, rng)?;
        draft.set_track(track, pieces);
        is_clean_beside(draft, &fault.people()).then_some(())
    })
}

/// Index of the piece at `tick`, or of the nearest of `reach` neighbours on either side, that is wanted.
fn near(tracks: &Tracks, track: TrackId, tick: i32, reach: usize, wanted: impl Fn(PieceId) -> bool) -> Option<usize> {
    let pieces = &tracks.tracks[track];
    let at = tracks.index_at(track, tick).min(pieces.len() - 1);
    let tick = tracks.fold(track, tick);
    let distance = |i: &usize| {
        let p = tracks.piece(pieces[*i]);
        (p.begin - tick).max(tick - p.end).max(0)
    };
    let neighbours = at.saturating_sub(reach)..(at + reach + 1).min(pieces.len());
    neighbours.filter(|&i| wanted(pieces[i])).min_by_key(distance)
}

/// Rips up windows of tracks, each widened by as many [`WINDOW`]s as are drawn, and bridges them another way, in random
/// order, on which everybody moves cleanly and the fault is no more.
fn rebridge(
    draft: &mut Draft,
    fault: Fault,
    mut windows: Vec<Window>,
    wider: RangeInclusive<i32>,
    (taste, rng): (Taste, &mut ChaCha8Rng),
) -> Option<()> {
    draft.restart();
    windows.shuffle(rng);
    for window in &mut windows {
        *window = draft.base.widen(*window, WINDOW * rng.random_range(wider.clone()));
        draft.hide(*window);
    }
    // What lets people part from an embrace may be what is wrong here.
    let apart = rng.random_range(0..2) == 0;
    windows.iter().try_for_each(|&w| match apart {
        true => draft.bridge_window_from(w, Company::NONE, taste, rng),
        false => draft.bridge_window(w, taste, rng),
    })?;
    is_clean_beside(draft, &fault.people()).then_some(())
}
