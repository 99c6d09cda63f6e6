//! The published method, to compare: random connections, and particles that are pulled along them and push each other.
//!
//! "Crowd Patches" (2009), section 4.3. A connection too fast for a human gets another period (eq. 4, 5: splitting a
//! trajectory at the end of the period is the same as letting it last one longer). Every particle tracks a point that
//! moves along its straight trajectory, is repelled by all others and by objects, and the attraction grows with the
//! distance from the point and towards the end. Trajectories are smoothed afterwards. The simulation runs until nobody
//! is left who came in while the patch was still filling up, and the people of one period are kept. Departure: the
//! paper gives no constants.

use glam::DVec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::planner::Planner;
use crate::world::shape::Obstacle;

/// Simulation steps per step of the grid.
const FINE: i32 = 4;
/// Pull to the moving point per metre of distance, m/s per m; it grows towards the end by up to the same again.
const PULL: f64 = 1.2;
/// Distance from touching within which particles repel, metres.
const VICINITY: f64 = 0.5;
/// Greatest repulsion, m/s.
const REPEL: f64 = 1.5;
/// Tries to find a random connection that leads nobody back.
const TRIES: usize = 200;
/// How often trajectories are averaged over three knots.
const SMOOTHING: usize = 3;

/// Somebody in the patch while the simulation runs.
struct Particle {
    walker: usize,
    lap: i32,
    place: DVec2,
}

impl Planner {
    /// Leads walkers by particles. Returns who touches somebody or something, or breaks the limits.
    pub fn run_particles(&mut self, rng: &mut ChaCha8Rng) -> Vec<usize> {
        self.connect_at_random(rng);
        for j in 0..self.tracks.len() {
            self.aim(j);
        }
        self.simulate();
        for j in 0..self.tracks.len() {
            self.smooth(j);
        }
        self.bad()
    }

    fn connect_at_random(&mut self, rng: &mut ChaCha8Rng) {
        let n = self.tracks.len();
        self.outputs = (0..n).collect();
        for _ in 0..TRIES {
            for i in (1..n).rev() {
                self.outputs.swap(i, rng.random_range(0..=i));
            }
            let back = |j: usize| self.pairing.inputs[j].edge == self.pairing.outputs[self.outputs[j]].edge;
            if !(0..n).any(back) {
                return;
            }
        }
    }

    /// Steps the whole patch through time; the free points of all tracks become the places at the knots.
    fn simulate(&mut self) {
        let longest = (0..self.tracks.len()).map(|j| self.tracks[j].end()).max().unwrap_or(0) / self.grid() + 1;
        // People of this lap are kept: all they meet came in when the patch was full.
        let kept = longest;
        let mut particles: Vec<Particle> = Vec::new();
        let last = (kept + longest + 1) * self.grid();
        for step in 0..last * FINE {
            let now = f64::from(step) / f64::from(FINE);
            self.admit(now, &mut particles);
            if step % FINE == 0 {
                self.record(step / FINE, kept, &particles);
            }
            self.push(now, &mut particles);
        }
    }

    /// Lets in who comes within this simulation step, and takes out who has gone.
    fn admit(&self, now: f64, particles: &mut Vec<Particle>) {
        let grid = f64::from(self.grid());
        for (walker, track) in self.tracks.iter().enumerate() {
            let since = now - track.entry.time / self.step;
            let lap = (since / grid).floor();
            if since >= 0.0 && since - lap * grid < 1.0 / f64::from(FINE) {
                particles.push(Particle { walker, lap: lap as i32, place: track.entry.place });
            }
        }
        particles.retain(|p| now < self.tracks[p.walker].exit.time / self.step + f64::from(p.lap) * grid);
    }

    fn record(&mut self, knot: i32, kept: i32, particles: &[Particle]) {
        for particle in particles.iter().filter(|p| p.lap == kept) {
            let own = knot - kept * self.grid();
            let track = &mut self.tracks[particle.walker];
            let k = (own - track.first) as usize;
            if track.free.contains(&k) {
                track.points[k] = particle.place;
            }
        }
    }

    /// Moves all particles by one simulation step.
    fn push(&self, now: f64, particles: &mut [Particle]) {
        let secs = self.step / f64::from(FINE);
        let velocities: Vec<DVec2> = particles.iter().map(|p| self.velocity(now, p, particles)).collect();
        for (particle, velocity) in particles.iter_mut().zip(velocities) {
            particle.place += velocity.clamp_length_max(self.ground.speed / self.step) * secs;
        }
    }

    fn velocity(&self, now: f64, of: &Particle, all: &[Particle]) -> DVec2 {
        let track = &self.tracks[of.walker];
        let own = (now - f64::from(of.lap * self.grid())) * self.step;
        let share = (own - track.entry.time) / (track.exit.time - track.entry.time);
        let along = track.exit.place - track.entry.place;
        let pull = PULL * (1.0 + share) * (track.entry.place + along * share - of.place);
        let others = all.iter().filter(|p| !std::ptr::eq(*p, of)).map(|p| of.place - p.place);
        let pushed: DVec2 = others.map(|away| repulsion(away.length() - self.apart(), away)).sum();
        let objects: DVec2 = self.ground.obstacles.iter().map(|o| off(o, of.place)).sum();
        along / (track.exit.time - track.entry.time) + pull + pushed + objects
    }

    fn smooth(&mut self, j: usize) {
        let track = &mut self.tracks[j];
        for _ in 0..SMOOTHING {
            let mut before = track.points[track.free.start - 1];
            for k in track.free.clone() {
                let mean = (before + 2.0 * track.points[k] + track.points[k + 1]) / 4.0;
                before = std::mem::replace(&mut track.points[k], mean);
            }
        }
        track.update_knots();
        self.touch(j);
    }
}

fn repulsion(gap: f64, away: DVec2) -> DVec2 {
    away.normalize_or(DVec2::X) * REPEL * (1.0 - gap / VICINITY).clamp(0.0, 1.0)
}

/// Repulsion by an object, from its nearest side.
fn off(obstacle: &Obstacle, place: DVec2) -> DVec2 {
    if obstacle.clear(place, place, VICINITY) {
        return DVec2::ZERO;
    }
    repulsion(obstacle.segment_distance(place, place), place - obstacle.centre())
}
