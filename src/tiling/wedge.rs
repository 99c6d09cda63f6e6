//! Wedging: where nobody finds room any more somebody new stands where others only walk by or stand alone. Who walks by
//! is led around, who stands there steps aside.

use glam::Vec2;
use rand_chacha::ChaCha8Rng;

use super::bridge::Taste;
use super::draft::Draft;
use super::occupancy::PieceId;
use super::seed::{anywhere, is_free_to_stand, stand_aside, stand_at};
use super::tracks::{Tracks, Window};
use super::tryout::is_clean;

/// Places looked at, and ways to stand tried at the best.
const PLACES: usize = 24;
const TURNS: usize = 8;
/// Ticks between those at which a place is looked at.
const STEP: usize = 6;
/// Whoever comes nearer than this is in the way, metres.
const NEAR: f32 = 0.55;
/// Most people in the way, and ticks that they are, all together.
const MOST: usize = 4;
const LONGEST: i32 = 900;
/// Ticks before and after they are in the way over which people are led around.
const AROUND: i32 = 30;

/// Adds a person who stands somewhere all the time; those who are in the way live on elsewhere.
pub(super) fn wedge(draft: &mut Draft, stand: Taste, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    let tracks = draft.base;
    let (place, windows) = quietest(draft, rng)?;
    let windows: Vec<Window> = windows.into_iter().map(|w| tracks.widen(w, AROUND)).collect();
    windows.iter().for_each(|&w| draft.hide(w));
    let pieces = stand_at(draft, &[place; TURNS], stand, rng)?;
    draft.push_track(pieces);
    for window in windows {
        let Window { track, from, to } = window;
        let whole = from == 0 && to == tracks.tracks[track].len();
        if whole && is_free_to_stand(tracks, track) {
            let pieces = stand_aside(draft, track, stand, rng)?;
            draft.set_track(track, pieces);
        } else {
            draft.bridge_window(window, taste, rng)?;
        }
    }
    is_clean(draft).then_some(())
}

/// Of some places the one at which others are for the fewest ticks, and when they are.
fn quietest(draft: &Draft, rng: &mut ChaCha8Rng) -> Option<(Vec2, Vec<Window>)> {
    let (tracks, mut near) = (draft.base, Vec::new());
    let ticks = |w: &Window| tracks.port(w.track, w.to).tick - tracks.port(w.track, w.from).tick;
    let seen = (0..PLACES).filter_map(|_| {
        let place = anywhere(draft, rng);
        let windows = passers(tracks, place, &mut near)?;
        Some((windows.iter().map(ticks).sum::<i32>(), place, windows))
    });
    let (ticks, place, windows) = seen.min_by_key(|s| s.0)?;
    (ticks < LONGEST).then_some((place, windows))
}

/// When others are in the way of who stands at a place all the time; `None` if too many are, or people who meet there.
fn passers(tracks: &Tracks, place: Vec2, near: &mut Vec<PieceId>) -> Option<Vec<Window>> {
    let mut windows: Vec<Window> = Vec::new();
    for tick in (0..tracks.domain.horizon).step_by(STEP) {
        tracks.occupancy.near(tick, place, NEAR, near);
        for &id in near.iter() {
            let track = tracks.owner(id);
            let index = tracks.index_at(track, tick);
            match windows.iter_mut().find(|w| w.track == track) {
                Some(window) => window.to = index + 1,
                None => windows.push(Window { track, from: index, to: index + 1 }),
            }
        }
        if windows.len() > MOST || !near.iter().all(|&id| tracks.is_loose(id)) {
            return None;
        }
    }
    let is_loose = |w: &Window| tracks.tracks[w.track][w.from..w.to].iter().all(|&id| tracks.is_loose(id));
    windows.iter().all(is_loose).then_some(windows)
}

#[cfg(test)]
mod tests {
    use super::super::common::plain_set;
    use super::super::crew::Crew;
    use super::super::domain::Domain;
    use super::super::library::Library;
    use super::super::scene::Scene;
    use super::super::seed::seed_person;
    use super::*;
    use crate::deform::Limits;
    use crate::geom::Polygon;

    #[test]
    fn where_nobody_finds_room_others_make_it_and_live_on() {
        let set = plain_set();
        let library = Library::new(&set, Limits::default());
        let region = Polygon::rectangle(Vec2::ZERO, Vec2::splat(3.5));
        let domain = Domain::new(&Scene { region, ..Scene::demo() }).unwrap();
        let mut crew = Crew::new(Tracks::new(&library, &domain), 12.0, 1);
        let taste = Taste { calm: 0.3, compact: 0.0, expansions: 300 };
        let stand = Taste { calm: 0.02, compact: 4.0, expansions: 200 };
        let mut full = 0;
        while full < 10 {
            let made = crew.work(8, |_, draft, rng| seed_person(draft, false, taste, rng), |_, _| true);
            full = if made.contains(&true) { 0 } else { full + 1 };
        }
        let (before, version) = (crew.tracks.tracks.len(), crew.tracks.version());
        let mut made_way = false;
        for _ in 0..100 {
            crew.work(8, |_, draft, rng| wedge(draft, stand, taste, rng), |_, _| true);
            made_way |= crew.tracks.changed_since(version)[..before].contains(&true);
        }
        let tracks = &crew.tracks;
        assert!(made_way && tracks.tracks.len() > before, "{} of {before}", tracks.tracks.len());
        for track in 0..tracks.tracks.len() {
            assert!(tracks.begins_open(track) && tracks.ends_open(track));
            for pair in tracks.tracks[track].windows(2) {
                let (exit, entry) = (library.exit_of(tracks.piece(pair[0])), library.entry_of(tracks.piece(pair[1])));
                assert!(exit.tick == entry.tick && exit.group == entry.group);
                assert!(exit.at.position.distance(entry.at.position) < 1e-3);
            }
        }
    }
}
