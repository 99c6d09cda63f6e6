/** What all parts of the body are made with: joint names, rings, and weights along chains of joints. */

import type { Ring, Weights } from "../loft";
import type { Part } from "../palette";

/** Joint names the mannequin is built on; a skeleton without one of them cannot be dressed. */
export const NAMES = [
  "hips", "spine", "spine1", "spine2", "neck", "head",
  "left_up_leg", "left_leg", "left_foot", "left_toe", "right_up_leg", "right_leg", "right_foot", "right_toe",
  "left_shoulder", "left_arm", "left_fore_arm", "left_hand",
  "right_shoulder", "right_arm", "right_fore_arm", "right_hand",
] as const; // biome-ignore format: by limb
type Name = (typeof NAMES)[number];
export type Ids = Record<Name, number>;

/** Weights along a chain of joints: each takes over from the one before around its place, over +-`width`. */
export function chain(at: number, width: number, places: readonly (readonly [joint: number, from: number])[]): Weights {
  const out: [number, number][] = [];
  let left = 1;
  for (let i = places.length - 1; i > 0 && left > 0; i--) {
    const [joint, from] = places[i];
    const x = Math.min(Math.max((at - from + width) / (2 * width), 0), 1);
    const share = x * x * (3 - 2 * x) * left;
    if (share > 0) out.push([joint, share]);
    left -= share;
  }
  if (left > 1e-6) out.push([places[0][0], left]);
  return out.slice(0, 4);
}

/** A level ring: height, half-width, half-depth, middle in depth. */
export function level(
  y: number,
  half: number,
  depth: number,
  z: number,
  part: Part,
  weights: Weights,
  power = 2,
  x = 0,
): Ring {
  return { center: [x, y, z], u: [half, 0, 0], v: [0, 0, depth], part, weights, power };
}

/** A ring across an arm, which runs along x. */
export function cuff(
  x: number,
  y: number,
  z: number,
  high: number,
  deep: number,
  part: Part,
  weights: Weights,
  power = 2,
): Ring {
  return { center: [x, y, z], u: [0, high, 0], v: [0, 0, deep], part, weights, power };
}
