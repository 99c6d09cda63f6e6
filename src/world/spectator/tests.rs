//! People walk around whoever stands or walks among them, and are back on their way at every border.

use std::collections::BTreeMap;

use super::*;
use crate::world::scenes;

fn street() -> World {
    let plan = scenes::street(5).unwrap();
    plan.bake("street", &plan.build().unwrap()).unwrap()
}

/// What is seen from a place, at times from 0 on, `step` seconds apart.
fn watch(world: &World, track: impl Fn(f64) -> DVec2, secs: f64, step: f64) -> Vec<Vec<Seen>> {
    let mut spectator = Spectator::new(0.25);
    let count = (secs / step).round() as usize;
    (0..=count)
        .map(|i| {
            let (now, place) = (i as f64 * step, track(i as f64 * step));
            spectator.look(world, now, place).unwrap();
            spectator.people(world, world.nearby().within(place, 14.0), now)
        })
        .collect()
}

/// Middles of street patches without things near the middle.
fn spots(world: &World) -> Vec<DVec2> {
    let kinds = (0..world.instances()).filter(|&i| world.kind(world.kind_of(i)).walkers() > 12);
    let free = |&i: &usize| {
        let mut room = Grounds::default();
        let stay = Stay { instance: i as u32, copy: [0, 0], walker: 0, lap: 0 };
        let middle = world.place(i);
        room.room(world, stay, middle, middle, 1.2, 1.0) >= 0.0
    };
    kinds.filter(free).map(|i| world.place(i)).collect()
}

#[test]
fn whoever_stands_is_walked_around() {
    let world = street();
    let (mut least, mut pairs, mut moved, mut met, mut spots_seen) = (f64::MAX, f64::MAX, 0, 0, 0);
    let (mut close, mut overlaps, mut samples, mut worst) = (0, 0, 0, String::new());
    for spot in spots(&world).into_iter().take(6) {
        spots_seen += 1;
        // People who are where the spectator appears need a moment.
        for seen in watch(&world, |_| spot, 24.0, 0.05).iter().skip(60) {
            let gaps = seen.iter().map(|p| p.place.distance(spot));
            let gap = gaps.fold(f64::MAX, f64::min);
            close += usize::from(gap < 0.5);
            least = least.min(gap);
            met += seen.iter().filter(|p| (p.place - p.aside).distance(spot) < 0.5).count();
            moved += seen.iter().filter(|p| p.aside.length() > 0.05).count();
            for (i, a) in seen.iter().enumerate() {
                for b in &seen[i + 1..] {
                    let gap = a.place.distance(b.place);
                    samples += 1;
                    overlaps += usize::from(gap < 0.499);
                    if gap < pairs {
                        (pairs, worst) = (gap, format!("{a:?} {b:?} about {spot}"));
                    }
                }
            }
        }
    }
    println!(
        "{spots_seen} places: least gap {least:.3} m, pairs {pairs:.3} m; {met} would have been met, {moved} aside, {close} too close; {overlaps} of {samples} pairs overlap; worst: {worst}"
    );
    assert!(spots_seen >= 4 && met > 50 && moved > 500);
    assert!(least >= 0.5 - 1e-6, "{least} m from the spectator");
    // Pushes are bounded, so that people never brush against each other is not certain: once in a million pairs at most.
    assert!(overlaps * 1_000_000 <= samples, "{overlaps} of {samples} pairs overlap, {pairs} m apart");
}

#[test]
fn nobody_jumps_and_all_are_on_their_way_at_borders() {
    let world = street();
    let spot = spots(&world)[0];
    let step = 0.02;
    let frames = watch(&world, |secs| spot + DVec2::new(0.9 * (secs - 6.0), 0.3 * secs.sin()), 12.0, step);
    let maps: Vec<BTreeMap<Person, &Seen>> = frames.iter().map(|f| f.iter().map(|s| (s.person, s)).collect()).collect();
    let (mut fastest, mut hardest) = (0.0_f64, 0.0_f64);
    for pair in maps.windows(2) {
        for (who, a) in &pair[0] {
            let Some(b) = pair[1].get(who) else { continue };
            let jump = (b.place - a.place - (a.velocity + b.velocity) * (0.5 * step)).length();
            assert!(jump < 2e-3, "{jump} m from {a:?} to {b:?}");
            fastest = fastest.max(b.velocity.length());
            hardest = hardest.max((b.velocity - a.velocity).length() / step);
        }
    }
    println!("fastest {fastest:.2} m/s, hardest {hardest:.2} m/s2");
    assert!(fastest < 3.2 && hardest < 7.0);
    let mut crossed = 0;
    for seen in frames.iter().flatten() {
        let way = seen.place - seen.aside;
        let border = way / 8.0;
        let gap = [border.x, border.y].map(|v| (v - v.round()).abs() * 8.0).into_iter().fold(f64::MAX, f64::min);
        if gap < 0.01 {
            crossed += 1;
            assert!(seen.aside.length() < 0.02, "{} m aside at a border", seen.aside.length());
        }
    }
    assert!(crossed > 0);
}

#[test]
fn what_is_seen_follows_from_the_track_alone() {
    let world = street();
    let spot = spots(&world)[1];
    let track = |secs: f64| spot + DVec2::new(0.8 * secs, 0.0);
    let fine = watch(&world, track, 6.0, 0.05);
    let coarse = watch(&world, track, 6.0, 0.4);
    let (a, b) = (fine.last().unwrap(), coarse.last().unwrap());
    assert_eq!(a.len(), b.len());
    assert!(a.iter().zip(b).all(|(a, b)| a.person == b.person && a.place.distance(b.place) < 1e-6));
    assert!(a.iter().any(|s| s.aside.length() > 0.05));
    // Who looks away for long has not been there.
    let mut spectator = Spectator::new(0.25);
    spectator.look(&world, 0.0, spot).unwrap();
    spectator.look(&world, 3.0, spot).unwrap();
    spectator.look(&world, 100.0, spot).unwrap();
    let seen = spectator.people(&world, world.nearby().within(spot, 10.0), 100.0);
    assert!(!seen.is_empty() && seen.iter().all(|s| s.aside == DVec2::ZERO));
    assert!(spectator.look(&world, f64::NAN, spot).is_err());
}
