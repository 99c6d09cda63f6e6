//! What a finished crowd is held against.

/// Limits of [`super::check_with`]; the defaults are the contract of a finished crowd.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Distance between the two paths at a stitch, metres. Default 0.001.
    pub stitch_position: f64,
    /// Angle between the two headings at a stitch, degrees. Default 0.5.
    pub stitch_heading_deg: f64,
    /// Time between exit and entry at a stitch, seconds. Default 0.001.
    pub stitch_time: f64,
    /// Fastest turn of a joint over the fastest of the same joint in all captures of the set. Default 1.2.
    pub joint_speed_ratio: f64,
    /// Largest acceleration of a joint over the largest of the same joint in all captures of the set. Default 1.5.
    pub acceleration_ratio: f64,
    /// Horizontal distance of the hips from the deformed path, metres: the path is what is seen. Default 0.06.
    pub hips_offset: f64,
    /// Change of an edge's length from one source frame to the next, metres. Default 0.014 (published: 0.03).
    pub stretch: f64,
    /// Change of turning from one source frame to the next, degrees. Default 3 (published: 7).
    pub bend_deg: f64,
    /// Change of the time between two source frames, seconds. Default 0.011 (published: 0.018).
    pub time_shift: f64,
    /// Change of an edge's direction seen from the heading, degrees. Default 20.
    pub slip_deg: f64,
    /// Edges shorter than this have no direction to speak of (standing people), metres. Default 0.003.
    pub slip_edge: f64,
    /// How deep two bodies, or a body and an obstacle or the region's border, may enter each other; inside a patch,
    /// how much deeper than in the capture. Metres. Default 0.01.
    pub penetration: f64,
    /// Change of where one person stands in the other's frame while they touch, metres. Default 0.01.
    pub contact_position: f64,
    /// Change of the heading between two people while they touch, degrees. Default 1.
    pub contact_heading_deg: f64,
    /// Difference between two people's clocks while they touch, seconds. Default 0.017 (ports lie on whole frames,
    /// so that half a frame cannot be helped).
    pub contact_time: f64,
    /// How much farther apart than in the capture touching parts may be, metres. Default 0.02.
    pub contact_distance: f64,
    /// Largest distance between any two ground positions of the ball of a planted foot, metres. Default 0.01.
    pub plant_slide: f64,
    /// The same, median over all plants, metres. Default 0.003.
    pub plant_slide_median: f64,
    /// How far a foot's joints may be below the floor, metres. Default 0.02.
    pub sinking: f64,
    /// How much further beyond its limits a joint may be turned than in the captures shown, degrees. Default 5.
    pub joint_excess_deg: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            stitch_position: 0.001,
            stitch_heading_deg: 0.5,
            stitch_time: 0.001,
            joint_speed_ratio: 1.2,
            acceleration_ratio: 1.5,
            hips_offset: 0.06,
            stretch: 0.014,
            bend_deg: 3.0,
            time_shift: 0.011,
            slip_deg: 20.0,
            slip_edge: 0.003,
            penetration: 0.01,
            contact_position: 0.01,
            contact_heading_deg: 1.0,
            contact_time: 0.017,
            contact_distance: 0.02,
            plant_slide: 0.01,
            plant_slide_median: 0.003,
            sinking: 0.02,
            joint_excess_deg: 5.0,
        }
    }
}
