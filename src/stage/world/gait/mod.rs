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
//! | `walks.rs` | ways of people over borders: when somebody is at a step before or after |
//! | `bodies.rs` | where bodies are at a time |
//! | `feet.rs` | footprints, and the feet between them |
//! | `poses.rs` | poses of bodies |
//! | `leg.rs` | poses whose legs reach the feet |
//! | `eights.rs` | numbers of eight people side by side |

mod bodies;
mod eights;
mod feet;
mod leg;
mod poses;
mod walks;

use glam::{Quat, Vec2, Vec3};

pub use feet::{Foot, Swing};
pub(super) use walks::Ways;

use super::World;
use super::tables::expect;
use crate::Result;
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
