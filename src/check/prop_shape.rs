//! A box as a shape: exact distances by parry3d.

use glam::{Quat, Vec2, Vec3};
use parry3d::math::{Pose, Vector};
use parry3d::query::contact;
use parry3d::shape::{Capsule, Cuboid, Shape};

use super::depth::Body;
use super::prop::on_ground;
use crate::geom::{Obstacle, Polygon, Upright};
use crate::motion::joint;
use crate::stage::DomainInfo;

/// No body reaches farther from its hips than this, metres.
const REACH: f32 = 1.3;

/// A box at one moment.
pub(super) struct Block {
    at: Upright,
    half: Vec3,
}

fn vector(v: Vec3) -> Vector {
    Vector::from_array(v.to_array())
}

/// How deep two shapes are in each other, metres; 0 if they are apart.
fn depth(a: (&Pose, &dyn Shape), b: (&Pose, &dyn Shape)) -> f32 {
    let found = contact(a.0, a.1, b.0, b.1, 0.0).ok().flatten();
    found.map_or(0.0, |c| (-c.dist).max(0.0))
}

impl Block {
    pub(super) fn new(at: Upright, size: [f32; 3]) -> Self {
        Self { at, half: Vec3::from_array(size) * 0.5 }
    }

    fn pose(&self) -> Pose {
        Pose::new(vector(self.at.middle), Vector::new(0.0, self.at.heading, 0.0))
    }

    fn shape(&self) -> Cuboid {
        Cuboid::new(vector(self.half))
    }

    /// False if a body whose hips are there cannot touch the box.
    pub(super) fn is_near(&self, hips: Vec3) -> bool {
        on_ground(hips).distance(on_ground(self.at.middle)) < REACH + self.half.length()
    }

    /// How deep the box is in the deepest capsule of a body, metres.
    pub(super) fn depth_in(&self, body: &Body) -> f32 {
        let (pose, shape) = (self.pose(), self.shape());
        let in_capsule = |c: &crate::geom::Capsule| {
            depth((&pose, &shape), (&Pose::IDENTITY, &Capsule::new(vector(c.a), vector(c.b), c.radius)))
        };
        body.capsules.iter().map(in_capsule).fold(0.0, f32::max)
    }

    /// How deep it is in another box, metres.
    pub(super) fn depth_into(&self, other: &Self) -> f32 {
        if self.at.middle.distance(other.at.middle) >= self.half.length() + other.half.length() {
            return 0.0;
        }
        depth((&self.pose(), &self.shape()), (&other.pose(), &other.shape()))
    }

    /// How far the worse of two palms, left and right, is from where it holds the box: each from its own face of the
    /// box's width. Metres.
    pub(super) fn palms_off(&self, [left, right]: [Vec3; 2]) -> f32 {
        let turn = Quat::from_rotation_y(-self.at.heading);
        let [l, r] = [left, right].map(|p| turn * (p - self.at.middle));
        let side = if l.x >= r.x { 1.0 } else { -1.0 };
        let off = |p: Vec3, side: f32| {
            let beyond = Vec2::new(p.y.abs() - self.half.y, p.z.abs() - self.half.z).max(Vec2::ZERO);
            (p.x * side - self.half.x).hypot(beyond.length())
        };
        off(l, side).max(off(r, -side))
    }

    /// How far a body's pelvis, the lower end of its first capsule, is from where it would sit on the box. Metres.
    pub(super) fn seat_off(&self, body: &Body) -> f32 {
        let pelvis = &body.capsules[0];
        let at = Quat::from_rotation_y(-self.at.heading) * (pelvis.a - self.at.middle);
        let beyond = Vec2::new(at.x.abs() - self.half.x, at.z.abs() - self.half.z).max(Vec2::ZERO);
        (at.y - pelvis.radius - self.half.y).hypot(beyond.length())
    }

    /// How far the box reaches out of the region or into obstacles, metres.
    pub(super) fn depth_in_walls(&self, domain: &DomainInfo, secs: f32) -> f32 {
        let turn = Quat::from_rotation_y(self.at.heading);
        let corner =
            |x: f32, z: f32| on_ground(self.at.middle + turn * Vec3::new(x * self.half.x, 0.0, z * self.half.z));
        let plan = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let out = plan.iter().map(|&p| domain.region.signed_distance(p)).fold(0.0, f32::max);
        let bottom = self.at.middle.y - self.half.y;
        let inside = |o: &Obstacle| {
            let below = o.height.map_or(f32::INFINITY, |top| top - bottom);
            if below > 0.0 { depth_of_plan(plan, &o.outline_at(secs)).min(below) } else { 0.0 }
        };
        domain.obstacles.iter().map(inside).fold(out, f32::max)
    }
}

/// How deep a quadrilateral is in a polygon, by points along its edges and by the polygon's corners inside it.
fn depth_of_plan(plan: [Vec2; 4], obstacle: &Polygon) -> f32 {
    const STEPS: usize = 16;
    let edges = (0..4).flat_map(|i| (0..STEPS).map(move |k| (i, k as f32 / STEPS as f32)));
    let points = edges.map(|(i, t)| plan[i].lerp(plan[(i + 1) % 4], t));
    let own = points.map(|p| -obstacle.signed_distance(p)).fold(0.0, f32::max);
    let inside = |p: Vec2| {
        let beside = |i: usize| {
            let (a, b) = (plan[i], plan[(i + 1) % 4]);
            (b - a).normalize_or_zero().perp_dot(p - a)
        };
        (0..4).map(beside).fold(f32::INFINITY, f32::min)
    };
    obstacle.points.iter().map(|&p| inside(p)).fold(own, f32::max)
}

/// The middles of both palms, left and right: 9 cm along the hand.
pub(super) fn palms(globals: &[(Vec3, Quat)]) -> [Vec3; 2] {
    let at = |hand: usize, along: f32| globals[hand].0 + globals[hand].1 * Vec3::new(along, 0.0, 0.0);
    [at(joint::LEFT_HAND, 0.09), at(joint::RIGHT_HAND, -0.09)]
}

/// The level place of a box between two palms, `grip` (up, ahead) from their middle.
pub(super) fn place_between([left, right]: [Vec3; 2], grip: [f32; 2]) -> Upright {
    let across = (left - right).with_y(0.0).normalize_or(Vec3::X);
    // Ahead is to the left of going left.
    let ahead = across.cross(Vec3::Y);
    let middle = left.midpoint(right) + Vec3::Y * grip[0] + ahead * grip[1];
    Upright { middle, heading: ahead.x.atan2(ahead.z) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_between_palms_is_ahead_of_them() {
        let at = place_between([Vec3::new(0.2, 1.0, 0.0), Vec3::new(-0.2, 1.0, 0.0)], [0.1, 0.05]);
        assert!(at.middle.distance(Vec3::new(0.0, 1.1, 0.05)) < 1e-6 && at.heading.abs() < 1e-6, "{at:?}");
        // Facing +x, left is -z.
        let at = place_between([Vec3::new(0.0, 1.0, -0.2), Vec3::new(0.0, 1.0, 0.2)], [0.0, 0.3]);
        assert!(at.middle.distance(Vec3::new(0.3, 1.0, 0.0)) < 1e-6, "{at:?}");
        assert!((at.heading - std::f32::consts::FRAC_PI_2).abs() < 1e-6, "{at:?}");
    }

    #[test]
    fn palms_on_both_faces_are_on_it_and_others_are_not() {
        let block = Block::new(Upright { middle: Vec3::Y, heading: 0.0 }, [0.4, 0.3, 0.2]);
        let palm = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        assert!(block.palms_off([palm(0.21, 1.0), palm(-0.19, 1.1)]) < 0.0101);
        // Taken from the other side it is held as well.
        assert!(block.palms_off([palm(-0.2, 1.0), palm(0.2, 1.0)]) < 1e-6);
        assert!((block.palms_off([palm(0.2, 1.2), palm(-0.2, 1.0)]) - 0.05).abs() < 1e-6);
        assert!((block.palms_off([palm(0.2, 1.0), palm(0.15, 1.0)]) - 0.35).abs() < 1e-6);
    }

    #[test]
    fn a_corner_of_an_obstacle_in_a_box_is_found() {
        let block = Block::new(Upright { middle: Vec3::Y, heading: 0.3 }, [0.4, 0.3, 0.2]);
        let domain = |points: [(f32, f32); 3]| DomainInfo {
            region: Polygon::rectangle(Vec2::splat(-3.0), Vec2::splat(3.0)),
            obstacles: vec![Polygon::new(points.map(|(x, z)| Vec2::new(x, z)).to_vec()).unwrap().into()],
            sources: vec![],
            sinks: vec![],
            last_frame: 0,
            periodic: crate::geom::Periodic::default(),
            teams: vec![],
        };
        assert!(block.depth_in_walls(&domain([(0.0, 0.0), (2.0, -0.01), (2.0, 0.01)]), 0.0) > 0.05);
        assert_eq!(block.depth_in_walls(&domain([(0.4, 0.0), (2.0, -0.01), (2.0, 0.01)]), 0.0), 0.0);
    }
}
