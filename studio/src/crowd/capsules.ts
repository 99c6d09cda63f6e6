/** The body as capsules (as src/motion/body.rs has them), and rays against them. For picking. */

import type { Crowd, Vec3 } from "./model";
import { Pose, rotate, samplePose } from "./sample";

type End = readonly [joint: string, offset: Vec3];
type Row = readonly [a: End, b: End, radius: number];
const O: Vec3 = [0, 0, 0];
const bone = (a: string, b: string, radius: number): Row => [[a, O], [b, O], radius];
const tip = (a: string, offset: Vec3, radius: number): Row => [[a, O], [a, offset], radius];

const ROWS: readonly Row[] = [
  bone("hips", "spine1", 0.13),
  bone("spine1", "spine2", 0.13),
  bone("left_arm", "right_arm", 0.08),
  tip("head", [0, 0.11, 0.01], 0.095),
  bone("left_up_leg", "left_leg", 0.075),
  bone("right_up_leg", "right_leg", 0.075),
  bone("left_leg", "left_foot", 0.055),
  bone("right_leg", "right_foot", 0.055),
  bone("left_foot", "left_toe", 0.045),
  bone("right_foot", "right_toe", 0.045),
  bone("left_arm", "left_fore_arm", 0.05),
  bone("right_arm", "right_fore_arm", 0.05),
  bone("left_fore_arm", "left_hand", 0.042),
  bone("right_fore_arm", "right_hand", 0.042),
  tip("left_hand", [0.1, 0, 0], 0.035),
  tip("right_hand", [-0.1, 0, 0], 0.035),
];

type Point = [number, number, number];
const dot = (a: Vec3, b: Vec3) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const minus = (a: Vec3, b: Vec3): Point => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];

/** Distance along the ray (unit `direction`) to a sphere; infinity if it misses. */
function raySphere(origin: Vec3, direction: Vec3, center: Vec3, radius: number): number {
  const oc = minus(origin, center);
  const b = dot(oc, direction);
  const h = b * b - dot(oc, oc) + radius * radius;
  if (h < 0) return Number.POSITIVE_INFINITY;
  const t = -b - Math.sqrt(h);
  return t >= 0 ? t : Number.POSITIVE_INFINITY;
}

/** Distance along the ray (unit `direction`, origin outside) to a capsule; infinity if it misses. */
export function rayCapsule(origin: Vec3, direction: Vec3, a: Vec3, b: Vec3, radius: number): number {
  const ba = minus(b, a);
  const oa = minus(origin, a);
  const [baba, bard, baoa] = [dot(ba, ba), dot(ba, direction), dot(ba, oa)];
  const qa = baba - bard * bard;
  const qb = baba * dot(direction, oa) - baoa * bard;
  const qc = baba * dot(oa, oa) - baoa * baoa - radius * radius * baba;
  const h = qb * qb - qa * qc;
  if (qa > 1e-12 && h >= 0) {
    const t = (-qb - Math.sqrt(h)) / qa;
    const y = baoa + t * bard;
    if (t >= 0 && y > 0 && y < baba) return t;
  }
  return Math.min(raySphere(origin, direction, a, radius), raySphere(origin, direction, b, radius));
}

export interface Capsule {
  a: Vec3;
  b: Vec3;
  radius: number;
}

/** The capsules of a body in a pose. */
export function bodyCapsules(crowd: Crowd, pose: Pose): Capsule[] {
  const at = placing(crowd, pose);
  return ROWS.map(([a, b, radius]) => ({ a: at(a), b: at(b), radius }));
}

/** Where ends of capsules are in a pose. */
function placing(crowd: Crowd, pose: Pose): (end: End) => Vec3 {
  const index = new Map(crowd.joints.map((j, i) => [j.name, i]));
  return ([name, offset]) => {
    const j = index.get(name) ?? 0;
    const [x, y, z] = rotate(pose.rotations.subarray(j * 4, j * 4 + 4), ...offset);
    return [pose.positions[j * 3] + x, pose.positions[j * 3 + 1] + y, pose.positions[j * 3 + 2] + z];
  };
}

/** The person whose body the ray meets first at `secs`; null if none. `lift` raises everybody (the loom). */
export function pickPerson(crowd: Crowd, secs: number, origin: Vec3, direction: Vec3, lift = 0): number | null {
  const pose = new Pose(crowd.joints.length);
  const from: Vec3 = [origin[0], origin[1] - lift, origin[2]];
  const at = placing(crowd, pose);
  let best: number | null = null;
  let nearest = Number.POSITIVE_INFINITY;
  for (let person = 0; person < crowd.characters.length; person++) {
    if (!samplePose(crowd, person, secs, pose)) continue;
    const hips = pose.positions.subarray(0, 3) as unknown as Vec3;
    // A ball around the whole body first.
    const inside = dot(minus(from, hips), minus(from, hips)) < 1.44;
    if (!inside && raySphere(from, direction, hips, 1.2) > nearest) continue;
    for (const [a, b, radius] of ROWS) {
      const t = rayCapsule(from, direction, at(a), at(b), radius);
      if (t < nearest) [nearest, best] = [t, person];
    }
  }
  return best;
}
