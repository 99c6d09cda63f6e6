//! BVH files, written: any skeleton, metres, degrees.

use std::fmt::Write as _;

use glam::{DQuat, EulerRot};

use crate::motion::{Clip, Joint, JointId};

/// The clip as the text of a BVH file: lengths in metres, the root with six channels (X, Y, Z position; Z, Y, X
/// rotation), every other joint with three (Z, Y, X rotation); End Sites from the joints' tips.
///
/// The root's OFFSET is zero, so that readers that add it to the position channels and readers that do not agree.
/// Angles run on over 180 degrees instead of jumping, so that files may be resampled. Joint positions survive
/// reading back to better than 0.1 mm. O(frames x joints).
pub fn write(clip: &Clip) -> String {
    let joints = &clip.skeleton.joints;
    let order = depth_first(joints);
    let mut text = String::with_capacity(clip.frames() * joints.len() * 36 + 4096);
    text.push_str("HIERARCHY\n");
    for (root, _) in joints.iter().enumerate().filter(|(_, j)| j.parent.is_none()) {
        write_joint(&mut text, joints, root, 0);
    }
    let _ = writeln!(text, "MOTION\nFrames: {}\nFrame Time: {:.8}", clip.frames(), 1.0 / f64::from(clip.fps));
    let mut angles = vec![[0.0; 3]; joints.len()];
    for frame in 0..clip.frames() {
        write_frame(&mut text, clip, frame, &order, &mut angles);
    }
    text
}

fn children(joints: &[Joint], parent: JointId) -> impl Iterator<Item = JointId> + '_ {
    joints.iter().enumerate().filter(move |(_, j)| j.parent == Some(parent)).map(|(id, _)| id)
}

/// The order of the channels: the order in which the hierarchy names the joints.
fn depth_first(joints: &[Joint]) -> Vec<JointId> {
    let mut order = Vec::with_capacity(joints.len());
    let mut stack: Vec<JointId> = (0..joints.len()).filter(|&j| joints[j].parent.is_none()).rev().collect();
    while let Some(joint) = stack.pop() {
        order.push(joint);
        let first = stack.len();
        stack.extend(children(joints, joint));
        stack[first..].reverse();
    }
    order
}

fn write_joint(text: &mut String, joints: &[Joint], id: JointId, depth: usize) {
    let joint = &joints[id];
    let pad = "  ".repeat(depth);
    let (keyword, offset, channels) = match joint.parent {
        None => ("ROOT", glam::Vec3::ZERO, "6 Xposition Yposition Zposition Zrotation Yrotation Xrotation"),
        Some(_) => ("JOINT", joint.offset, "3 Zrotation Yrotation Xrotation"),
    };
    let _ = writeln!(text, "{pad}{keyword} {}\n{pad}{{", joint.name);
    let _ = writeln!(text, "{pad}  OFFSET {:.6} {:.6} {:.6}", offset.x, offset.y, offset.z);
    let _ = writeln!(text, "{pad}  CHANNELS {channels}");
    let mut leaf = true;
    for child in children(joints, id) {
        leaf = false;
        write_joint(text, joints, child, depth + 1);
    }
    if leaf {
        let tip = joint.tip.unwrap_or_default();
        let _ = writeln!(text, "{pad}  End Site\n{pad}  {{");
        let _ = writeln!(text, "{pad}    OFFSET {:.6} {:.6} {:.6}\n{pad}  }}", tip.x, tip.y, tip.z);
    }
    let _ = writeln!(text, "{pad}}}");
}

fn write_frame(text: &mut String, clip: &Clip, frame: usize, order: &[JointId], angles: &mut [[f64; 3]]) {
    let pose = clip.pose(frame);
    for (i, &joint) in order.iter().enumerate() {
        if clip.skeleton.joints[joint].parent.is_none() {
            let p = clip.root[frame];
            let _ = write!(text, "{}{:.6} {:.6} {:.6} ", if i > 0 { " " } else { "" }, p.x, p.y, p.z);
        } else {
            text.push(' ');
        }
        // In double precision, since single loses 0.02 degrees where the middle angle nears 90.
        let q = pose[joint];
        let q = DQuat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into()).normalize();
        let (z, y, x) = q.to_euler(EulerRot::ZYX);
        angles[joint] = nearest_turns([z, y, x].map(f64::to_degrees), angles[joint]);
        let [z, y, x] = angles[joint];
        let _ = write!(text, "{z:.6} {y:.6} {x:.6}");
    }
    text.push('\n');
}

/// Of the triples of Z, Y, X angles (degrees) that mean the same rotation, the one nearest to `before`.
fn nearest_turns([z, y, x]: [f64; 3], before: [f64; 3]) -> [f64; 3] {
    let candidates = [[z, y, x], [z + 180.0, 180.0 - y, x + 180.0]];
    let unwound = candidates.map(|c| std::array::from_fn(|i| c[i] - ((c[i] - before[i]) / 360.0).round() * 360.0));
    let far = |c: &[f64; 3]| c.iter().zip(before).map(|(a, b)| (a - b).abs()).sum::<f64>();
    if far(&unwound[0]) <= far(&unwound[1]) { unwound[0] } else { unwound[1] }
}

#[cfg(test)]
mod tests {
    use glam::{EulerRot, Quat, Vec3};

    use super::*;
    use crate::motion::Skeleton;

    /// A skeleton whose joints are not in depth-first order.
    fn clip(turns: &[Quat]) -> Clip {
        let joint = |name: &str, parent, offset: [f32; 3], tip| Joint {
            name: name.into(),
            parent,
            offset: offset.into(),
            tip: Option::map(tip, |t: [f32; 3]| t.into()),
        };
        let skeleton = Skeleton {
            joints: vec![
                joint("root", None, [0.0, 1.0, 0.0], None),
                joint("a", Some(0), [0.1, 0.2, 0.3], None),
                joint("b", Some(0), [-0.1, 0.5, 0.0], Some([0.0, 0.1, 0.0])),
                joint("a1", Some(1), [0.4, 0.0, 0.0], None),
            ],
        };
        let rotations = turns.iter().flat_map(|&q| [q, q * q, q.inverse(), Quat::from_rotation_x(0.3) * q]).collect();
        let root = (0..turns.len()).map(|f| Vec3::new(f as f32, 1.0, -2.0)).collect();
        Clip { name: "test".into(), skeleton, fps: 60.0, root, rotations }
    }

    #[test]
    fn hierarchy_and_channels_are_in_depth_first_order() {
        let text = write(&clip(&[Quat::IDENTITY]));
        let names: Vec<&str> =
            text.lines().filter_map(|l| l.trim().strip_prefix("JOINT ").or(l.trim().strip_prefix("ROOT "))).collect();
        assert_eq!(names, ["root", "a", "a1", "b"]);
        assert_eq!(text.matches('{').count(), text.matches('}').count());
        assert_eq!(text.matches("End Site").count(), 2);
        assert_eq!(text.lines().last().unwrap().split_whitespace().count(), 15);
        assert!(text.contains("Frames: 1\nFrame Time: 0.01666667\n"));
    }

    #[test]
    fn rotations_survive_even_at_the_pole_and_never_jump() {
        let turns: Vec<Quat> = (0..400)
            .map(|i| Quat::from_rotation_y(i as f32 * 0.05) * Quat::from_rotation_z((i as f32 * 0.03).sin()))
            .chain([Quat::from_rotation_y(std::f32::consts::FRAC_PI_2)])
            .collect();
        let clip = clip(&turns);
        let text = write(&clip);
        let rows: Vec<Vec<f32>> = text
            .lines()
            .skip_while(|l| !l.starts_with("Frame Time"))
            .skip(1)
            .map(|l| l.split_whitespace().map(|w| w.parse().unwrap()).collect())
            .collect();
        assert_eq!(rows.len(), turns.len());
        for (frame, row) in rows.iter().enumerate() {
            for (slot, joint) in [0, 1, 3, 2].into_iter().enumerate() {
                let at = 3 + slot * 3;
                let [z, y, x] = [row[at], row[at + 1], row[at + 2]].map(f32::to_radians);
                let read = Quat::from_euler(EulerRot::ZYX, z, y, x);
                let want = clip.pose(frame)[joint];
                assert!((read * Vec3::ONE - want * Vec3::ONE).length() < 5e-5, "frame {frame} joint {joint}");
            }
        }
        for pair in rows[..400].windows(2) {
            assert!((pair[1][3] - pair[0][3]).abs() < 60.0, "the root's first angle jumps");
        }
    }
}
