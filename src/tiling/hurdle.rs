//! Hurdling: new people who jump over an obstacle that is low enough, led from and to the edges of time. Searches that
//! lead people somewhere else seldom find the one place and moment at which a jump is high enough.

use std::f32::consts::PI;

use glam::Vec2;
use rand::{Rng, RngExt};
use rand_chacha::ChaCha8Rng;

use super::bridge::{Goal, NO_INSTANCE, Taste};
use super::draft::Draft;
use super::library::Library;
use super::piece::{Company, Piece, Rigid};
use super::tryout::is_clean;
use crate::geom::Ground;

/// Places, times and headings tried for one jump.
const TRIES: usize = 300;

/// The roles of single people who jump.
pub(super) fn jumpers(library: &Library) -> Vec<u32> {
    let roles = library.forward.iter().flatten().map(|m| m.role);
    roles.filter(|&r| library.roles[r as usize].leap.is_some()).collect()
}

/// Adds a person who jumps over something, present over the whole time.
pub(super) fn hurdle(draft: &mut Draft, jumpers: &[u32], taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    let jump = (0..TRIES).find_map(|_| jump(draft, jumpers, rng))?;
    let (library, horizon) = (draft.base.library, draft.base.domain.horizon);
    let (entry, exit) = (library.entry_of(&jump), library.exit_of(&jump));
    let id = draft.add(jump);
    let mut pieces = if entry.tick > 0 && !draft.base.domain.cycle.loops() {
        draft.search(entry, Goal::Since(0), Company::NONE, taste, rng)?
    } else {
        vec![]
    };
    pieces.push(id);
    if exit.tick < horizon || draft.base.domain.cycle.loops() {
        pieces.extend(draft.lead_to_the_end(entry, exit, taste, rng)?);
    }
    draft.push_track(pieces);
    is_clean(draft).then_some(())
}

/// A free jump that is highest somewhere over a low obstacle at some time.
fn jump(draft: &Draft, jumpers: &[u32], rng: &mut ChaCha8Rng) -> Option<Piece> {
    let (library, domain) = (draft.base.library, draft.base.domain);
    let role = jumpers[rng.random_range(0..jumpers.len())];
    let source = &library.roles[role as usize];
    let top = source.leap.expect("a jumper");
    let tick = rng.random_range(0..domain.horizon);
    let aside = Vec2::new(rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0));
    let place = domain.over_obstacle(tick, aside, rng.next_u32() as usize)?;
    let entry = Ground::new(place, rng.random_range(-PI..PI)).then(source.path.at(top).inverse());
    let begin = tick - top as i32;
    let free = draft.view().is_free_rigid(role, Rigid::new(library, role, entry, begin), Company::NONE);
    free.then(|| Piece::rigid(library, domain, role, NO_INSTANCE, entry, begin))
}

#[cfg(test)]
mod tests {
    use super::super::audition::plays_cleanly;
    use super::super::domain::Domain;
    use super::super::draft::Desk;
    use super::super::scene::Scene;
    use super::super::tracks::Tracks;
    use super::*;
    use crate::geom::{Obstacle, Polygon, Waypoint};
    use rand::SeedableRng;

    #[test]
    fn jumps_over_a_low_obstacle_are_found_and_over_a_higher_one_are_not() {
        let folder = std::env::temp_dir().join(format!("crowdquilt-hurdle-{}", std::process::id()));
        crate::samples::write(&folder, 1).unwrap();
        let set = crate::patch::cut_folder(&folder, None).unwrap();
        std::fs::remove_dir_all(&folder).unwrap();
        for kind in set.kinds.iter().filter(|k| k.labels.iter().any(|l| l == "jump")) {
            assert!(plays_cleanly(kind), "{}", kind.name);
        }
        let library = Library::new(&set, crate::deform::Limits::default());
        let jumpers = jumpers(&library);
        assert_eq!(jumpers.len(), 4, "two jumps and their mirror images");
        let found = |height: f32| {
            let way = [(0.0, 1.5), (10.0, 10.5), (20.0, 1.5)];
            let path = way.map(|(secs, x)| Waypoint { secs, position: Vec2::new(x, 3.0), heading: 0.0 }).to_vec();
            let outline = Polygon::rectangle(Vec2::new(-0.14, -0.9), Vec2::new(0.14, 0.9));
            let mut scene = Scene::demo();
            scene.obstacles.push(Obstacle { outline, height: Some(height), path });
            let domain = Domain::new(&scene).unwrap();
            let tracks = Tracks::new(&library, &domain);
            let mut desk = Desk::default();
            let draft = Draft::new(&tracks, &mut desk);
            let mut rng = ChaCha8Rng::seed_from_u64(1);
            (0..3000).filter(|_| jump(&draft, &jumpers, &mut rng).is_some()).count()
        };
        let counts = [0.08, 0.16, 0.24, 0.7].map(found);
        println!("{counts:?} of 3000");
        assert!(counts[1] > 20 && counts.is_sorted_by(|a, b| a >= b) && counts[3] == 0, "{counts:?}");
    }
}
