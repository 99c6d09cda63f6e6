//! Who is near whom at a moment: everybody's hips, sorted so that near ones are found by looking at few others.

use std::ops::RangeInclusive;

use glam::Vec2;

use crate::geom::Torus;
use crate::refine::Body;

/// Somebody, or an image of them where the ground repeats.
#[derive(Clone, Copy)]
struct Place {
    strip: i32,
    at: Vec2,
    person: usize,
}

/// Where everybody's hips are, in strips along x and within them sorted along it. Where the ground repeats, all are in the
/// region, and images of those who are near its border beyond it.
#[derive(Default)]
pub(super) struct Places {
    all: Vec<Place>,
    /// Width of the strips, metres.
    width: f32,
}

impl Places {
    /// Those who are there at some ticks instead of whoever was before: each where they are in the middle of that time, or
    /// at the tick that is nearest to it. Nobody will be looked for farther from a place than `reach`, metres. O(people log people).
    pub fn look<'b>(
        &mut self,
        ticks: RangeInclusive<i32>,
        bodies: impl Iterator<Item = &'b Body>,
        torus: Torus,
        reach: f32,
    ) {
        self.width = reach;
        self.all.clear();
        for (person, body) in bodies.enumerate() {
            if let Some(frame) = middle_frame(body, &ticks) {
                let root = body.root[frame];
                self.all.push(self.place(torus.wrap(Vec2::new(root.x, root.z)), person));
            }
        }
        if !torus.is_plane() {
            let images = |p: &Place| {
                let person = p.person;
                torus.images(p.at, reach).map(move |at| (at, person))
            };
            self.all = self.all.iter().flat_map(images).map(|(at, person)| self.place(at, person)).collect();
        }
        self.all.sort_unstable_by(|a, b| {
            a.strip.cmp(&b.strip).then(a.at.x.total_cmp(&b.at.x)).then(a.person.cmp(&b.person))
        });
    }

    fn place(&self, at: Vec2, person: usize) -> Place {
        Place { strip: self.strip(at.y), at, person }
    }

    fn strip(&self, z: f32) -> i32 {
        (z / self.width).floor() as i32
    }

    /// People within a distance.
    pub fn near(&self, position: Vec2, distance: f32) -> impl Iterator<Item = usize> {
        let strips = self.strip(position.y - distance)..=self.strip(position.y + distance);
        let rows = strips.flat_map(move |strip| {
            let first = self.all.partition_point(|p| (p.strip, p.at.x) < (strip, position.x - distance));
            self.all[first..].iter().take_while(move |p| p.strip == strip && p.at.x <= position.x + distance)
        });
        rows.filter(move |p| p.at.distance_squared(position) <= distance * distance).map(|p| p.person)
    }

    /// Calls `meet` with all pairs of different people within a distance; where the ground repeats some more than once.
    pub fn pairs(&self, distance: f32, mut meet: impl FnMut(usize, usize)) {
        let all = &self.all;
        // Where in the strip beyond to begin.
        let mut beyond = 0;
        for (i, here) in all.iter().enumerate() {
            let from = (here.strip + 1, here.at.x - distance);
            beyond += all[beyond..].iter().take_while(|p| (p.strip, p.at.x) < from).count();
            let reached = |p: &&Place, strip: i32| p.strip == strip && p.at.x <= here.at.x + distance;
            let own = all[i + 1..].iter().take_while(|p| reached(p, here.strip));
            let next = all[beyond..].iter().take_while(|p| reached(p, here.strip + 1));
            for there in own.chain(next) {
                if here.person != there.person && here.at.distance_squared(there.at) <= distance * distance {
                    meet(here.person, there.person);
                }
            }
        }
    }
}

/// The frame of a body's motion in the middle of some ticks, or the nearest to it of those ticks.
fn middle_frame(body: &Body, ticks: &RangeInclusive<i32>) -> Option<usize> {
    let (begin, frames) = (body.begin as i32, body.root.len() as i32);
    let (first, last) = (begin.max(*ticks.start()), (begin + frames - 1).min(*ticks.end()));
    let middle = (ticks.start() + ticks.end()) / 2;
    (first <= last).then(|| (middle.clamp(first, last) - begin) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Periodic;
    use crate::motion::JOINT_COUNT;
    use glam::{Quat, Vec3};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use std::collections::BTreeSet;

    /// Somebody upright at a place, at tick 0.
    fn body(at: Vec2) -> Body {
        Body {
            root: vec![Vec3::new(at.x, 0.935, at.y)],
            rotations: vec![Quat::IDENTITY; JOINT_COUNT],
            ..Body::default()
        }
    }

    const REACH: f32 = 2.2;

    fn met(places: &Places) -> BTreeSet<(usize, usize)> {
        let mut met = BTreeSet::new();
        places.pairs(REACH, |p, q| {
            met.insert((p.min(q), p.max(q)));
        });
        met
    }

    #[test]
    fn all_who_are_near_are_found_and_nobody_else() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut places = Places::default();
        let both = Periodic { x: true, z: true, t: false };
        for torus in [Torus::default(), Torus::new(Vec2::new(-4.0, -6.0), Vec2::new(5.0, 5.0), both)] {
            let near = |a: Vec2, b: Vec2, reach: f32| torus.nearest(a - b).length() < reach;
            let mut anywhere = || Vec2::new(rng.random_range(-4.0..5.0), rng.random_range(-6.0..5.0));
            let hips: Vec<Vec2> = (0..120).map(|_| anywhere()).collect();
            let bodies: Vec<Body> = hips.iter().map(|&at| body(at)).collect();
            places.look(0..=0, bodies.iter(), torus, REACH);
            let all = (0..hips.len()).flat_map(|q| (0..q).map(move |p| (p, q)));
            let expected: BTreeSet<_> = all.filter(|&(p, q)| near(hips[p], hips[q], REACH)).collect();
            assert_eq!(met(&places), expected);
            for _ in 0..20 {
                let (at, reach) = (anywhere(), 1.3);
                let found: BTreeSet<usize> = places.near(torus.wrap(at), reach).collect();
                let expected = (0..hips.len()).filter(|&p| near(hips[p], at, reach)).collect();
                assert_eq!(found, expected, "{at}");
            }
        }
    }

    #[test]
    fn who_is_there_for_a_part_of_the_time_is_where_they_are_nearest_to_its_middle() {
        let walker = Body { begin: 7, root: (0..5).map(|i| Vec3::X * i as f32).collect(), ..Body::default() };
        let mut places = Places::default();
        for (ticks, x) in [(0..=6, None), (0..=8, Some(0.0)), (6..=10, Some(1.0)), (8..=30, Some(4.0)), (12..=20, None)]
        {
            places.look(ticks, [&walker].into_iter(), Torus::default(), 1.0);
            assert_eq!(places.all.first().map(|p| p.at.x), x);
        }
    }
}
