//! What counts as an event.

/// What counts as an event. `None`: chosen from the captures' own distribution, see [`super::Thresholds`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EpisodeOptions {
    /// Bodies touch where their surfaces are nearer than this, metres; default 0.03 (captures retargeted to another
    /// body miss each other by some centimetres).
    pub touch_gap: f32,
    /// A contact lasts while what touches is within this of its nearest, metres; default 0.03.
    pub touch_slack: f32,
    /// Half of the window of eq. 4 in frames; default 8 (about half a second in all, one step).
    pub half_window: usize,
    /// People are near each other below this distance of their hips, metres; default 1.2, where Hall's personal
    /// distance ends and the social one begins.
    pub near: f32,
    /// A person acts noticeably above this variation (eq. 4), square metres; default chosen.
    pub variation: Option<f32>,
    /// People act together above this synchronicity (eq. 5); default chosen.
    pub synchronicity: Option<f32>,
    /// Nobody sees farther than this, metres; default 10.
    pub sight: f32,
    /// Proximity and synchronicity last at least this long, seconds; default 0.2.
    pub min_seconds: f32,
    /// Events this near in time merge, seconds between end and begin; default 0.7 (gestures pause, and
    /// are seen a little after they begin and before they end),
    pub merge_seconds: f32,
    /// if they have somebody in common or their middles are this near, metres; default 2.
    pub merge_metres: f32,
}

impl Default for EpisodeOptions {
    fn default() -> Self {
        Self {
            touch_gap: 0.03,
            touch_slack: 0.03,
            half_window: 8,
            near: 1.2,
            variation: None,
            synchronicity: None,
            sight: 10.0,
            min_seconds: 0.2,
            merge_seconds: 0.7,
            merge_metres: 2.0,
        }
    }
}
