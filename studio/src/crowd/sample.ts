/** Poses on the CPU: the reference for the GPU, and what picking and following use. No allocation per call. */

import type { Crowd, Vec3 } from "./model";
import { intoTile, type Tile, tileOf } from "./tiles";

/** Global joint transforms of one person. */
export class Pose {
  readonly positions: Float32Array;
  readonly rotations: Float32Array;
  constructor(readonly joints: number) {
    this.positions = new Float32Array(joints * 3);
    this.rotations = new Float32Array(joints * 4);
  }
}

/** Frame of the person's own motion at `secs` (may lie between frames), or -1 while absent. */
export function ownFrame(crowd: Crowd, person: number, secs: number): number {
  const { begin, frames } = crowd.characters[person];
  const at = secs * crowd.fps - begin;
  return frames > 0 && at >= 0 && at <= frames - 1 ? at : -1;
}

/** Hips position of a person into `out`, inside the region where the ground repeats; false while absent. */
export function sampleRoot(crowd: Crowd, person: number, secs: number, out: Float32Array | number[]): boolean {
  const at = ownFrame(crowd, person, secs);
  if (at < 0) return false;
  const c = crowd.characters[person];
  const i = Math.min(Math.floor(at), Math.max(c.frames - 2, 0));
  const j = Math.min(i + 1, c.frames - 1);
  for (let axis = 0; axis < 3; axis++) {
    const a = crowd.root[(c.firstFrame + i) * 3 + axis];
    const b = crowd.root[(c.firstFrame + j) * 3 + axis];
    out[axis] = a + (b - a) * (at - i);
  }
  const { middle, period } = tile(crowd);
  out[0] += intoTile(out[0], middle[0], period[0]);
  out[2] += intoTile(out[2], middle[1], period[1]);
  return true;
}

/** Worked out once per crowd. */
function tile(crowd: Crowd): Tile {
  const known = tiles.get(crowd) ?? tileOf(crowd);
  tiles.set(crowd, known);
  return known;
}
const tiles = new WeakMap<Crowd, Tile>();

/** Middle and heading of a prop at `secs` into `out` (x, y, z, heading); false while it is not there. */
export function sampleProp(crowd: Crowd, prop: number, secs: number, out: Float32Array | number[]): boolean {
  const { begin, frames, firstFrame } = crowd.props[prop];
  const at = secs * crowd.fps - begin;
  if (!(frames > 0 && at >= 0 && at <= frames - 1)) return false;
  const i = Math.min(Math.floor(at), Math.max(frames - 2, 0));
  const j = Math.min(i + 1, frames - 1);
  for (let k = 0; k < 4; k++) {
    const a = crowd.propPlaces[(firstFrame + i) * 4 + k];
    const b = crowd.propPlaces[(firstFrame + j) * 4 + k];
    // Headings take the short way.
    const step = k < 3 ? b - a : b - a - 2 * Math.PI * Math.round((b - a) / (2 * Math.PI));
    out[k] = a + step * (at - i);
  }
  return true;
}

const local = new Float64Array(4);

/** Global joint transforms of a person at `secs` into `pose`; false while absent. */
export function samplePose(crowd: Crowd, person: number, secs: number, pose: Pose): boolean {
  if (!sampleRoot(crowd, person, secs, pose.positions)) return false;
  const c = crowd.characters[person];
  const at = ownFrame(crowd, person, secs);
  const i = Math.min(Math.floor(at), Math.max(c.frames - 2, 0));
  const j = Math.min(i + 1, c.frames - 1);
  const { offsets } = crowd.builds[c.build];
  for (let k = 0; k < crowd.joints.length; k++) {
    const a = ((c.firstFrame + i) * crowd.joints.length + k) * 4;
    const b = ((c.firstFrame + j) * crowd.joints.length + k) * 4;
    blend(crowd.rotations, a, b, at - i, local);
    attach(crowd, offsets[k], k, pose);
  }
  return true;
}

/** Normalised linear interpolation along the shorter way, as glam's `Quat::lerp`. */
function blend(packed: Int16Array, a: number, b: number, t: number, out: Float64Array): void {
  let [lengthA, lengthB, dot] = [0, 0, 0];
  for (let n = 0; n < 4; n++) {
    lengthA += packed[a + n] ** 2;
    lengthB += packed[b + n] ** 2;
    dot += packed[a + n] * packed[b + n];
  }
  const s = (1 - t) / Math.sqrt(lengthA || 1);
  const e = ((dot < 0 ? -1 : 1) * t) / Math.sqrt(lengthB || 1);
  for (let n = 0; n < 4; n++) out[n] = packed[a + n] * s + packed[b + n] * e;
  const length = Math.hypot(out[0], out[1], out[2], out[3]) || 1;
  for (let n = 0; n < 4; n++) out[n] /= length;
}

function attach(crowd: Crowd, offset: Vec3, k: number, pose: Pose): void {
  const { parent } = crowd.joints[k];
  if (parent < 0) {
    pose.rotations.set(local, k * 4);
    return;
  }
  const r = pose.rotations.subarray(parent * 4, parent * 4 + 4);
  const turned = rotate(r, offset[0], offset[1], offset[2]);
  for (let axis = 0; axis < 3; axis++) {
    pose.positions[k * 3 + axis] = pose.positions[parent * 3 + axis] + turned[axis];
  }
  const [ax, ay, az, aw] = r;
  const [bx, by, bz, bw] = local;
  pose.rotations[k * 4] = aw * bx + ax * bw + ay * bz - az * by;
  pose.rotations[k * 4 + 1] = aw * by - ax * bz + ay * bw + az * bx;
  pose.rotations[k * 4 + 2] = aw * bz + ax * by - ay * bx + az * bw;
  pose.rotations[k * 4 + 3] = aw * bw - ax * bx - ay * by - az * bz;
}

const turned = new Float64Array(3);

/** The vector (x, y, z) turned by the quaternion `q`; the result is overwritten by the next call. */
export function rotate(q: ArrayLike<number>, x: number, y: number, z: number): Float64Array {
  const tx = 2 * (q[1] * z - q[2] * y);
  const ty = 2 * (q[2] * x - q[0] * z);
  const tz = 2 * (q[0] * y - q[1] * x);
  turned[0] = x + q[3] * tx + q[1] * tz - q[2] * ty;
  turned[1] = y + q[3] * ty + q[2] * tx - q[0] * tz;
  turned[2] = z + q[3] * tz + q[0] * ty - q[1] * tx;
  return turned;
}
