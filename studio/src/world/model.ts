/** A baked world of crowd patches, as its file holds it. See docs/formats/world.md. */

import type { Joint, Vec3 } from "../crowd/model";

export const UNITS_PER_METRE = 1024;

/** A joint, and where its bone ends if no other joint does. */
export interface Bone extends Joint {
  tip: Vec3 | null;
}

/** Walking poses by speed and phase, and everybody's steps. */
export interface Gait {
  joints: Bone[];
  phases: number;
  speeds: Float32Array;
  strides: Float32Array;
  /** x, y, z, w of every joint of every pose of every cycle. */
  rotations: Float32Array;
  hips: Float32Array;
  steps: Int16Array;
  headings: Int16Array;
  crossingPhases: Float32Array;
  /** By how much people step faster from every crossing to the next. */
  paces: Float32Array;
  /** Left and ahead of where somebody is, of both feet in the middle of their stances, of every cycle; null in old files. */
  prints: Float32Array | null;
  /** Share of the way between footprints and height of the ball, of both feet in every pose of every cycle. */
  swings: Float32Array | null;
  /** Crossings before and after every crossing; -1 for none. */
  links: Int32Array;
  /** First number in steps of every walker of every kind. */
  tracks: Uint32Array;
}

/** Full-body clips, one after the other, and whose they are. */
export interface Acts {
  joints: Joint[];
  /** End of every clip, in frames of all clips. */
  ends: Uint32Array;
  /** Seconds from frame to frame of every clip. */
  steps: Float32Array;
  /** x, y, z of the hips at every frame. */
  roots: Float32Array;
  /** x, y, z, w of every joint at every frame. */
  rotations: Int16Array;
  /** The clip of everybody who stays, or none; and by how many seconds it is ahead. */
  stayers: Uint32Array;
  leads: Float32Array;
  /** The clip of every walker of every kind, or none; when it begins, and when the walker comes in and goes out. */
  walkers: Uint32Array;
  times: Float32Array;
  /** When its left and its right foot begin and end to go over from walk to clip, then from clip to walk. */
  feet: Float32Array;
}

export interface Thing {
  name: string;
  /** x, z pairs: the corners of a polygon, or the middle of a disc. */
  points: Float32Array;
  /** 0 for polygons. */
  radius: number;
}

export interface Stayer {
  name: string;
  x: number;
  z: number;
  heading: number;
}

export interface Kind {
  template: number;
  /** x, z pairs. */
  outline: Float32Array;
  things: Thing[];
  stayers: Stayer[];
  /** Index of the first of them among those of all kinds. */
  firstStayer: number;
  /** Index of its first walker among those of all kinds. */
  firstWalker: number;
  walkers: number;
}

export interface Place {
  kind: number;
  x: number;
  z: number;
  turn: number;
  phase: number;
  /** Index of its first crossing. */
  firstCrossing: number;
}

/** Where a foot is. */
export interface Foot {
  /** Of its ball, relative to where its owner is. */
  x: number;
  y: number;
  z: number;
  /** Where it looks: sine and cosine of its heading, about a unit long. */
  sin: number;
  cos: number;
}

export interface World {
  name: string;
  period: number;
  slots: number;
  pageSlots: number;
  unit: number;
  templates: { name: string; ground: string }[];
  /** Size of what repeats, metres; null if the world ends. */
  repeat: [number, number] | null;
  kinds: Kind[];
  places: Place[];
  rows: Int16Array;
  lanes: Uint32Array;
  laneEnds: Uint32Array;
  /** First and last slot of every walker of every kind. */
  stays: Int32Array;
  identity: { cycle: Uint32Array; laps: Int32Array; copies: Int32Array; people: Uint32Array; around: Int32Array };
  gait: Gait | null;
  acts: Acts | null;
}
