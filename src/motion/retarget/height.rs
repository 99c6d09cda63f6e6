//! How tall a person is by the bones, whatever the posture.

use super::{RestRig, match_rig};
use crate::Result;
use crate::motion::Clip;
use crate::motion::skeleton::joint::*;

/// Height of ankles over the ground, metres.
const ANKLE: f32 = 0.07;
/// From the head's joint to the crown, metres: of rigs whose head has no tip, and the least of others.
const CROWN: f32 = 0.2;
const LEAST_CROWN: f32 = 0.15;

/// Height of the body of a clip in metres: its bones from sole to crown, one after another.
///
/// # Errors
/// The rig is none of a person that can be told.
pub fn body_height(clip: &Clip) -> Result<f32> {
    let rest = RestRig::of(&clip.skeleton);
    let found = match_rig(&rest)?.joints;
    let way: Vec<(usize, usize)> = [LEFT_FOOT, LEFT_LEG, LEFT_UP_LEG, SPINE, SPINE1, SPINE2, NECK, HEAD]
        .into_iter()
        .filter_map(|slot| Some((slot, found[slot]?)))
        .collect();
    let bone = |pair: &[(usize, usize)]| {
        let (from, to) = (rest.places[pair[0].1], rest.places[pair[1].1]);
        // From the hip joint up: only what the spine's foot is higher counts.
        if pair[0].0 == LEFT_UP_LEG { (to.y - from.y).abs() } else { to.distance(from) }
    };
    let head = found[HEAD].and_then(|head| clip.skeleton.joints[head].tip);
    let crown = head.map_or(CROWN, |tip| tip.length().max(LEAST_CROWN));
    Ok(ANKLE + way.windows(2).map(bone).sum::<f32>() + crown)
}
