//! Full bodies of walkers: a table of walking poses by speed and phase, and how far through its steps everybody is.
//!
//! A pose depends on speed and phase alone, so a crowd of any size shares one small table. Phases go on over borders and
//! periods: along a cycle of crossings the steps that people take add up to a whole number (everybody walks a trifle faster or
//! slower for that), and each crossing stores the phase it begins with. So the phase at any time is a function of the time, like
//! all else. Stride and cadence go together: strides are interpolated between the cycles of the table, cadence is speed
//! by stride, so that a planted foot goes back about as fast as the body goes on.
//!
//! Feet are then led to footprints (`feet.rs`): each is a function of the moment at which its foot is planted in the middle of its
//! stance, and the foot goes from one to the next by the phase alone. So a planted foot stays where it is, whatever the body does,
//! and nothing has to be remembered for it.
//!
//! | file | what |
//! |---|---|
//! | `mod.rs` | the table of poses, the steps of a world |
//! | `walks.rs` | ways of people over borders: where and how somebody is at a step before or after |
//! | `feet.rs` | footprints, and the feet between them |
//! | `leg.rs` | a pose whose legs reach the feet |

mod feet;
mod leg;
mod walks;

use glam::{Quat, Vec2, Vec3};

pub use feet::{Foot, Swing};
use leg::{Legs, WIDTH};
pub(super) use walks::Ways;
use walks::{Instant, Stay};

use super::tables::expect;
use super::{Spot, World};
use crate::Result;
use crate::geom::sin_cos;
use crate::motion::JOINT_COUNT;

/// Steps are stored in this part of a cycle of two steps.
pub(crate) const STEPS_PER_CYCLE: f32 = 512.0;
/// Headings are stored in this part of a radian.
pub(crate) const PER_RADIAN: f32 = 32_768.0 / std::f32::consts::PI;

/// Walking cycles of rising speed, the first of which stands; all begin as the right leg swings past the planted left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GaitTable {
    /// Speed of every cycle, m/s, rising from 0.
    pub speeds: Vec<f32>,
    /// Metres of every cycle (two steps); 0 for the first.
    pub strides: Vec<f32>,
    /// Poses of a cycle.
    pub phases: usize,
    /// Rotations of all joints, cycle by cycle, pose by pose: the hips' relative to where somebody walks to, all others local.
    pub rotations: Vec<Quat>,
    /// Hips of every pose, relative to where somebody is: x to the left, y up, z ahead.
    pub hips: Vec<Vec3>,
    /// Where the balls of the left and of the right foot are in the middle of their stances, cycle by cycle, relative to where
    /// somebody is: to the left, ahead. Empty if feet are not led to footprints.
    pub prints: Vec<[Vec2; 2]>,
    /// How the left and the right foot go from one footprint to the next, cycle by cycle, pose by pose; from the middle of each
    /// foot's own stance on: the left one's is at phase 0, the right one's at a half.
    pub swings: Vec<[Swing; 2]>,
}

/// A walker's body at some time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walking {
    /// Where it is, metres.
    pub place: Vec2,
    /// Its velocity, m/s.
    pub velocity: Vec2,
    /// Where it looks, radians about the vertical, 0 along +z.
    pub heading: f32,
    /// How far through its cycle of two steps it is, 0 to 1.
    pub phase: f32,
    /// Where its feet are; `None` if they are not led to footprints.
    pub feet: Option<[Foot; 2]>,
}

/// What the tables say about bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gait {
    /// The poses.
    pub table: GaitTable,
    /// Cycles since it came in of every walker of every kind, at the begin of every slot of its stay and at its end.
    pub steps: Vec<i16>,
    /// Where it looks at these times.
    pub headings: Vec<i16>,
    /// Phase at which every crossing begins.
    pub crossing_phases: Vec<f32>,
    /// By how much people step faster from there to the next crossing: a factor about 1.
    pub crossing_paces: Vec<f32>,
}

impl GaitTable {
    /// Cycles per second at a speed.
    pub fn cadence(&self, speed: f32) -> f32 {
        let (low, share) = self.between(speed);
        let stride = self.strides[low] + share * (self.strides[low + 1] - self.strides[low]);
        // Below the slowest cycle strides shrink with speed, and cadence stays.
        let slowest = self.speeds[1] / self.strides[1].max(0.1);
        if low == 0 { slowest } else { speed / stride.max(0.1) }
    }

    /// The cycle below a speed, and how far to the next.
    #[inline(always)]
    fn between(&self, speed: f32) -> (usize, f32) {
        let inner = &self.speeds[1..self.speeds.len() - 1];
        let low: usize = inner.iter().map(|&other| usize::from(other <= speed)).sum();
        let (a, b) = (self.speeds[low], self.speeds[low + 1]);
        (low, ((speed - a) / (b - a)).clamp(0.0, 1.0))
    }

    /// The pose at a speed and phase, and the hips relative to where somebody is. No allocation.
    #[inline(always)]
    pub fn pose(&self, speed: f32, phase: f32, pose: &mut [Quat; JOINT_COUNT]) -> Vec3 {
        let (low, fast) = self.between(speed);
        let at = phase.clamp(0.0, 1.0) * self.phases as f32;
        let first = (at as usize).min(self.phases - 1);
        let late = at - first as f32;
        let next = if first + 1 < self.phases { first + 1 } else { 0 };
        let (slower, faster) = (low * self.phases, (low + 1) * self.phases);
        let of = [slower + first, slower + next, faster + first, faster + next];
        let weights = [(1.0 - fast) * (1.0 - late), (1.0 - fast) * late, fast * (1.0 - late), fast * late];
        let rows = self.rotations.as_chunks::<JOINT_COUNT>().0;
        let (a, b, c, d) = (&rows[of[0]], &rows[of[1]], &rows[of[2]], &rows[of[3]]);
        let mut scales = [1.0_f32; JOINT_COUNT.next_multiple_of(8)];
        for joint in 0..JOINT_COUNT {
            pose[joint] = a[joint] * weights[0] + b[joint] * weights[1] + c[joint] * weights[2] + d[joint] * weights[3];
            scales[joint] = pose[joint].length_squared();
        }
        // All roots at once.
        scales.iter_mut().for_each(|scale| *scale = 1.0 / scale.sqrt());
        for joint in 0..JOINT_COUNT {
            pose[joint] = pose[joint] * scales[joint];
        }
        let hips = &self.hips;
        hips[of[0]] * weights[0] + hips[of[1]] * weights[1] + hips[of[2]] * weights[2] + hips[of[3]] * weights[3]
    }

    /// Poses of bodies, and their hips in the frame of their places, as many as there are of each. Eight bodies at a time cost half
    /// as much as one by one. No allocation.
    pub fn poses(&self, bodies: &[Walking], poses: &mut [[Quat; JOINT_COUNT]], hips: &mut [Vec3]) {
        pulp::Arch::new().dispatch(Posing { table: self, bodies, poses, hips });
    }

    fn validate(&self) -> Result<()> {
        let cycles = self.speeds.len();
        let shape = (2..=64).contains(&cycles) && self.strides.len() == cycles && (1..=1024).contains(&self.phases);
        expect(shape, "gait_speeds", || format!("{cycles} cycles of {} phases", self.phases))?;
        let rising = self.speeds[0] == 0.0
            && self.speeds.windows(2).all(|w| w[1] > w[0] + 1e-3)
            && self.speeds[cycles - 1] < 20.0;
        expect(rising, "gait_speeds", || format!("{:?}", self.speeds))?;
        let strides = self.strides.iter().all(|s| (0.0..20.0).contains(s));
        expect(strides && self.strides[1] > 0.0, "gait_strides", || format!("{:?}", self.strides))?;
        let poses = cycles * self.phases;
        expect(self.hips.len() == poses, "gait_hips", || format!("{} places instead of {poses}", self.hips.len()))?;
        let found = self.rotations.len();
        expect(found == poses * JOINT_COUNT, "gait_rotations", || format!("{found} rotations for {poses} poses"))?;
        let finite = self.hips.iter().all(|h| h.is_finite()) && self.rotations.iter().all(|q| q.is_finite());
        expect(finite, "gait_rotations", || "a number that is none".into())?;
        if self.prints.is_empty() && self.swings.is_empty() {
            return Ok(());
        }
        let (prints, swings) = (self.prints.len(), self.swings.len());
        expect(prints == cycles, "gait_prints", || format!("{prints} pairs for {cycles} cycles"))?;
        expect(swings == poses, "gait_swings", || format!("{swings} pairs for {poses} poses"))?;
        expect(self.phases.is_multiple_of(2), "gait_phases", || format!("{} is odd", self.phases))?;
        let near = self.prints.iter().flatten().all(|p| p.length() < 2.0);
        expect(near, "gait_prints", || "a foot that is not at its leg".into())?;
        let sane = |s: &Swing| (-0.5..=1.5).contains(&s.share) && (-0.5..2.0).contains(&s.height);
        expect(self.swings.iter().flatten().all(sane), "gait_swings", || "a foot that is not between footprints".into())
    }
}

impl Walking {
    /// Root and rotations of the canonical skeleton for this body, in the frame of its place. No allocation.
    pub fn pose(&self, table: &GaitTable, pose: &mut [Quat; JOINT_COUNT]) -> Vec3 {
        let mut hips = Vec3::ZERO;
        table.poses(std::slice::from_ref(self), std::slice::from_mut(pose), std::slice::from_mut(&mut hips));
        hips
    }

    /// The same without regard to feet, the hips relative to where it is; and where it looks, as x and z.
    #[inline(always)]
    fn stride(&self, table: &GaitTable, pose: &mut [Quat; JOINT_COUNT]) -> (Vec3, Vec2) {
        let hips = table.pose(self.velocity.length(), self.phase, pose);
        let (half_sin, half_cos) = sin_cos(0.5 * self.heading);
        let facing = Vec2::new(2.0 * half_sin * half_cos, half_cos * half_cos - half_sin * half_sin);
        pose[0] = leg::about_vertical(half_cos, half_sin, pose[0].into()).into();
        let left = Vec2::new(facing.y, -facing.x);
        let across = left * hips.x + facing * hips.z;
        (Vec3::new(across.x, hips.y, across.y), facing)
    }
}

impl Gait {
    /// Whether it fits a world whose walkers stay so many slots, with so many crossings.
    pub(super) fn validate(&self, stays: u64, crossings: usize) -> Result<()> {
        self.table.validate()?;
        let (steps, headings) = (self.steps.len() as u64, self.headings.len() as u64);
        expect(steps == stays, "gait_steps", || format!("{steps} numbers instead of {stays}"))?;
        expect(headings == stays, "gait_headings", || format!("{headings} numbers instead of {stays}"))?;
        let (phases, paces) = (self.crossing_phases.len(), self.crossing_paces.len());
        expect(phases == crossings, "crossing_phases", || format!("{phases} numbers instead of {crossings}"))?;
        expect(paces == crossings, "crossing_paces", || format!("{paces} numbers instead of {crossings}"))?;
        let finite = self.crossing_phases.iter().chain(&self.crossing_paces).all(|v| v.is_finite() && v.abs() < 1e3);
        expect(finite, "crossing_phases", || "a number that is no phase".into())?;
        let slow = self.crossing_paces.iter().find(|&&pace| pace < 0.1);
        expect(slow.is_none(), "crossing_paces", || format!("{slow:?}"))
    }

    pub(super) fn bytes(&self) -> usize {
        let table = 16 * self.table.rotations.len() + 28 * self.table.hips.len() + 24 * self.table.speeds.len();
        table
            + 2 * (self.steps.len() + self.headings.len())
            + 4 * (self.crossing_phases.len() + self.crossing_paces.len())
    }
}

impl World {
    /// Bodies of all who walk in a patch at `time` (seconds, any), in the order of [`World::roots`]; none if the world has no gait.
    /// Places are relative to the patch's own origin, turned as the patch is. O(1) for each.
    pub fn bodies(&self, spot: Spot, time: f64) -> Vec<Walking> {
        let mut bodies = Vec::new();
        self.bodies_of(std::iter::once(spot), time, &mut bodies);
        bodies
    }

    /// The same for several patches, one after the other, appended to `bodies`. Allocates only where these have never been as many.
    pub fn bodies_of(&self, spots: impl Iterator<Item = Spot>, time: f64, bodies: &mut Vec<Walking>) {
        if let Some(gait) = &self.tables.gait {
            pulp::Arch::new().dispatch(Walks { world: self, gait, spots, time, bodies });
        }
    }
}

/// Poses of bodies, in the widest instructions there are.
struct Posing<'a> {
    table: &'a GaitTable,
    bodies: &'a [Walking],
    poses: &'a mut [[Quat; JOINT_COUNT]],
    hips: &'a mut [Vec3],
}

impl pulp::NullaryFnOnce for Posing<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { table, bodies, poses, hips } = self;
        let mut legs = Legs::default();
        for ((bodies, poses), hips) in bodies.chunks(WIDTH).zip(poses.chunks_mut(WIDTH)).zip(hips.chunks_mut(WIDTH)) {
            for (i, body) in bodies.iter().enumerate() {
                let (root, facing) = body.stride(table, &mut poses[i]);
                hips[i] = root;
                if let Some(feet) = &body.feet {
                    legs.put(i, &poses[i], root, facing, feet);
                }
            }
            legs.lead(bodies.len());
            for (i, body) in bodies.iter().enumerate() {
                if body.feet.is_some() {
                    hips[i].y = legs.take(i, &mut poses[i]);
                }
                hips[i] += Vec3::new(body.place.x, 0.0, body.place.y);
            }
        }
    }
}

/// Bodies of all who walk in some patches, likewise.
struct Walks<'a, S> {
    world: &'a World,
    gait: &'a Gait,
    spots: S,
    time: f64,
    bodies: &'a mut Vec<Walking>,
}

impl<S: Iterator<Item = Spot>> pulp::NullaryFnOnce for Walks<'_, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { world, gait, spots, time, bodies } = self;
        let (info, moment) = (world.info(), world.moment(time));
        let at = time / f64::from(info.period_secs) * f64::from(info.slots);
        let fraction = (at - at.floor()) as f32;
        for spot in spots {
            let instance = spot.instance as usize;
            let own = moment.later(world.tables.instance_phases[instance], info.slots);
            for lane in world.rows.lanes(&world.tables, world.kind_of(instance), own.slot) {
                let stay = world.ways.stay(world, gait, instance, lane.walker());
                let slot = own.slot as i32 + lane.lap() as i32 * info.slots as i32 - stay.enter;
                bodies.push(world.body(gait, &stay, (slot, fraction)));
            }
        }
    }
}

impl World {
    /// The body of somebody in a slot of its stay.
    #[inline(always)]
    fn body<'a>(&'a self, gait: &Gait, stay: &Stay<'a>, at: (i32, f32)) -> Walking {
        let Instant { place, velocity, heading } = stay.at(at.0, at.1);
        let body = Walking { place, velocity, heading, phase: fraction_of(stay.phase(at.0, at.1)), feet: None };
        Walking { feet: self.feet(gait, stay, at, &body), ..body }
    }
}

/// What a phase is beyond whole cycles. Phases are not below zero, so this needs no call of the system's mathematics.
fn fraction_of(phase: f32) -> f32 {
    phase - phase as i32 as f32
}
