//! What a walker can do, and how close people come.

/// Limits on walkers. All hold at every instant of the period.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Radius of a body, metres: centres of two walkers stay twice as far apart.
    pub radius: f32,
    /// Greatest speed, m/s.
    pub speed: f32,
    /// Greatest acceleration, m/s2.
    pub acceleration: f32,
    /// Greatest turning of the direction of walking, rad/s.
    pub turning: f32,
    /// Below this speed, m/s, a walker stands and may turn freely.
    pub standing: f32,
}

impl Default for Limits {
    fn default() -> Self {
        Self { radius: 0.25, speed: 2.0, acceleration: 2.5, turning: std::f32::consts::PI, standing: 0.2 }
    }
}
