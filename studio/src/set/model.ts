/** A patch set as the studio sees it. Names and units as in src/patch/set.rs: metres, seconds, radians. */

import type { Joint, Vec3 } from "../crowd/model";

/** One person's part in a kind. Its first frame is the entry, its last the exit. */
export interface Role {
  /** Frame of the kind's clock at which it begins. */
  begin: number;
  frames: number;
  /** Place of its first frame in the set's arrays. */
  firstFrame: number;
  /** Indices of pose groups. */
  entry: number;
  exit: number;
}

export const PARTS = ["left_hand", "right_hand", "torso", "head"] as const;
export type BodyPart = (typeof PARTS)[number];

export interface Touch {
  role: number;
  part: BodyPart;
}

/** Who touches whom, from frame to frame of the kind's clock, both included. */
export interface Contact {
  a: Touch;
  b: Touch;
  begin: number;
  end: number;
}

/** A place that stays upright: middle and heading (radians about +y). */
export interface Upright {
  middle: Vec3;
  heading: number;
}

/** A box that people hold in both hands or sit on; see src/patch/prop.rs. */
export interface SetProp {
  name: string;
  /** Full extents: width between the hands, height, depth. */
  size: Vec3;
  /** Where its middle is, seen from the middle between the palms: up, and ahead of the person. */
  grip: readonly [up: number, ahead: number];
  /** Who holds it from frame to frame of the kind's clock, both included; in order; none if they only sit on it. */
  holds: { role: number; begin: number; end: number }[];
  /** Where it rests before the first takes it up and after the last put it down. */
  before: Upright | null;
  after: Upright | null;
}

export interface SetKind {
  name: string;
  labels: string[];
  mirrored: boolean;
  /** First and last frame of what people do together. */
  core: readonly [begin: number, end: number] | null;
  contacts: Contact[];
  props: SetProp[];
  roles: Role[];
  /** Last frame of the kind's clock. */
  lastFrame: number;
}

export interface PatchSet {
  fps: number;
  joints: Joint[];
  /** Names of the pose groups. */
  groups: string[];
  kinds: SetKind[];
  /** x, z per frame. */
  points: Float32Array;
  /** Radians per frame. */
  headings: Float32Array;
  /** Of the hips, per frame. */
  heights: Float32Array;
  /** x, y, z, w per frame and joint, times 32767; the hips' relative to the path, others local. */
  rotations: Int16Array;
}

/** Length of a kind in seconds. */
export function seconds(set: PatchSet, kind: SetKind): number {
  return kind.lastFrame / set.fps;
}
