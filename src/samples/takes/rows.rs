//! Ten people in two rows who bow to each other: a big patch, to be placed where a scene wants it.

use std::f32::consts::PI;

use glam::Vec2;

use super::meet::{Coming, arrive};
use crate::geom::Ground;
use crate::samples::acting::Sight;
use crate::samples::actor::{Actor, secs};
use crate::samples::posture::Channel::*;
use crate::samples::scene::Scene;

/// People in a row, and from one to the next, metres.
const ROW: usize = 5;
const BESIDE: f32 = 1.0;
/// Half the distance of the rows, metres.
const APART: f32 = 0.9;

pub(super) fn scenes() -> Vec<Scene> {
    let place = |i: usize| {
        let (row, along) = (i / ROW, (i % ROW) as f32 - (ROW - 1) as f32 / 2.0);
        let (z, heading) = if row == 0 { (-APART, 0.0) } else { (APART, PI) };
        Ground::new(Vec2::new(along * BESIDE, z), heading)
    };
    let places: Vec<Ground> = (0..2 * ROW).map(place).collect();
    let (mut actors, entries) = arrive(&places, Coming::Standing);
    actors.iter_mut().enumerate().for_each(|(i, a)| bow(a, i));
    let roles: Vec<(usize, i32, i32)> = (0..2 * ROW).map(|i| (i, entries[i], actors[i].now)).collect();
    let mut scene = Scene::new("bow-rows", actors);
    let core = [0.2, 2.1].map(|after| secs(entries[0]) + after);
    scene.patch("bow-rows", &["friendly", "staged"], &roles, Some(core));
    vec![scene]
}

/// Looks at who is opposite, and bows; nobody quite at the same moment as the others.
fn bow(a: &mut Actor, i: usize) {
    let t = 0.04 * ((i * 7) % 5) as f32;
    a.look([0.0, 0.4, 2.1, 2.4], Sight::Person((i + ROW) % (2 * ROW)));
    let down = [t + 0.2, t + 0.85, t + 1.15, t + 1.9];
    a.pose(down, &[(PelvisPitch, 0.32), (SpinePitch, 0.30), (HipsForward, -0.09), (HeadPitch, 0.22)]);
    a.stand(75);
}
