/** Where parts of bodies are, as contacts and boxes want them. */

import type { Crowd, Vec3 } from "../crowd/model";
import { type Pose, rotate } from "../crowd/sample";
import type { BodyPart } from "./model";

/** From the wrist to the middle of the palm, as src/motion/contacts.rs: half a hand. */
const PALM = 0.085;
/** The joint that stands for a part. */
const JOINTS: Record<BodyPart, string> = {
  left_hand: "left_hand",
  right_hand: "right_hand",
  torso: "spine2",
  head: "head",
};

/** The middle of a part of a body: a palm for a hand. */
export function partOf(crowd: Crowd, pose: Pose, part: BodyPart): Vec3 {
  const joint = Math.max(
    crowd.joints.findIndex((j) => j.name === JOINTS[part]),
    0,
  );
  const out = part === "left_hand" ? PALM : part === "right_hand" ? -PALM : 0;
  const turned = rotate(pose.rotations.subarray(joint * 4, joint * 4 + 4), out, 0, 0);
  const [x, y, z] = pose.positions.subarray(joint * 3, joint * 3 + 3);
  return [x + turned[0], y + turned[1], z + turned[2]];
}
