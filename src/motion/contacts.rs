//! Contacts between people of a take: hands that hold or touch another's hand (paper section 4.1, "Contact").

use glam::{Quat, Vec3};

use super::skeleton::{JOINT_COUNT, canonical, joint};
use super::take::{TakeContact, Touch};
use super::{BodyPart, FPS, Motion};

/// When two hands count as in contact. Distances are between the palms' centres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactOptions {
    /// A contact begins below this distance, metres; default 0.10 (palms are about 0.03 thick; captures of held hands
    /// retargeted to another body miss each other by some centimetres more).
    pub begin_below: f32,
    /// It lasts while the distance is below this, metres; default 0.16.
    pub end_above: f32,
    /// Shorter contacts are dropped, seconds; default 0.2.
    pub min_seconds: f32,
}

impl Default for ContactOptions {
    fn default() -> Self {
        Self { begin_below: 0.10, end_above: 0.16, min_seconds: 0.2 }
    }
}

const HANDS: [(BodyPart, usize); 2] =
    [(BodyPart::LeftHand, joint::LEFT_HAND), (BodyPart::RightHand, joint::RIGHT_HAND)];

/// All contacts between hands of different people, in take time, sorted by begin. O(people^2 x frames).
pub fn detect(motions: &[Motion], options: &ContactOptions) -> Vec<TakeContact> {
    let palms: Vec<[Vec<Vec3>; 2]> = motions.iter().map(|m| HANDS.map(|(_, hand)| palm_trajectory(m, hand))).collect();
    let mut contacts = Vec::new();
    for a in 0..motions.len() {
        for b in a + 1..motions.len() {
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let gaps: Vec<f32> = palms[a][i].iter().zip(&palms[b][j]).map(|(p, q)| p.distance(*q)).collect();
                let touch = |person: usize, hand: usize| Touch { person, part: HANDS[hand].0 };
                contacts.extend(spans(&gaps, options).into_iter().map(|(begin, end)| TakeContact {
                    a: touch(a, i),
                    b: touch(b, j),
                    begin: begin as f32 / FPS,
                    end: end as f32 / FPS,
                }));
            }
        }
    }
    contacts.sort_by(|x, y| x.begin.total_cmp(&y.begin));
    contacts
}

/// From the middle of a hand to the palm's surface, metres.
pub(crate) const PALM_DEPTH: f32 = 0.012;

/// Centre of a hand's palm: half-way along the hand.
pub fn palm(globals: &[(Vec3, Quat)], hand: usize) -> Vec3 {
    globals[hand].0 + globals[hand].1 * palm_in_hand(hand)
}

/// The same in the hand's own frame.
pub(crate) fn palm_in_hand(hand: usize) -> Vec3 {
    0.5 * canonical().joints[hand].tip.expect("hands have tips")
}

/// The palm of a hand at every frame. O(frames).
pub fn palm_trajectory(motion: &Motion, hand: usize) -> Vec<Vec3> {
    let mut globals = Vec::with_capacity(JOINT_COUNT);
    let at = |frame| {
        motion.globals(frame, &mut globals);
        palm(&globals, hand)
    };
    (0..motion.len()).map(at).collect()
}

/// First and last frames of the times in contact.
fn spans(gaps: &[f32], options: &ContactOptions) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut frame = 0;
    while frame < gaps.len() {
        if gaps[frame] >= options.begin_below {
            frame += 1;
            continue;
        }
        let begin = frame;
        while frame + 1 < gaps.len() && gaps[frame + 1] < options.end_above {
            frame += 1;
        }
        if (frame - begin) as f32 >= options.min_seconds * FPS {
            found.push((begin, frame));
        }
        frame += 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_have_hysteresis_and_a_least_length() {
        let gaps: Vec<f32> = (0..60).map(|f| 0.055 + 0.01 * (f as f32 - 30.0).abs()).collect();
        assert_eq!(spans(&gaps, &ContactOptions::default()), [(26, 40)]);
        let brief: Vec<f32> = (0..60).map(|f| 0.05 + 0.04 * (f as f32 - 30.0).abs()).collect();
        assert!(spans(&brief, &ContactOptions::default()).is_empty());
    }
}
