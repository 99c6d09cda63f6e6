/** Legs that reach their feet: the same as src/stage/world/gait/leg.rs. */

import type { Bone, Foot } from "./model";
import {
  about,
  conjugate,
  cross,
  dot,
  length,
  minus,
  normalized,
  plus,
  product,
  type Quat,
  scaled,
  turned,
  unit,
  type Vec,
} from "./quaternion";

const STRETCH = 0.995;
const LOWERING = 0.045;
const EASE = 0.012;
const LIFT = 0.45;
const HEEL = 0.06;
const STRAIGHT = 0.1;
const TOES = 0.005;
/** First joints of the legs in the skeleton of patch sets; shin, foot and toes follow each. */
export const LEGS = [1, 5] as const;

interface Leg {
  up: number;
  hip: Vec;
  knee: Vec;
  ankle: Vec;
  /** Rotations of thigh, shin, foot and toes. */
  turns: [Quat, Quat, Quat, Quat];
  ball: Vec;
  foot: Quat;
}

/** Leads the legs of a pose (local rotations, hips at `root`) to the feet; returns by how much the hips come down. */
export function lead(
  joints: readonly Bone[],
  local: Float32Array,
  root: readonly number[],
  heading: readonly number[],
  ahead: readonly [number, number],
  feet: readonly [Foot, Foot],
): number {
  const hips = product(heading, local.subarray(0, 4));
  const legs = LEGS.map((up, i) => legOf(joints, local, root, hips, ahead, up, feet[i]));
  const need = Math.max(...legs.map((leg) => lowering(joints, leg)));
  const over = Math.max(need + EASE, 0);
  const down = Math.min(need > EASE ? need : (over * over) / (4 * EASE), LOWERING);
  for (const leg of legs) {
    for (const joint of [leg.hip, leg.knee, leg.ankle]) joint[1] -= down;
    bend(joints, local, hips, leg);
  }
  return down;
}

function legOf(
  joints: readonly Bone[],
  local: Float32Array,
  root: readonly number[],
  hips: Quat,
  ahead: readonly [number, number],
  up: number,
  foot: Foot,
): Leg {
  const of = (j: number) => local.subarray(4 * j, 4 * j + 4);
  const thigh = product(hips, of(up));
  const shin = product(thigh, of(up + 1));
  const own = product(shin, of(up + 2));
  const hip = plus(root, turned(hips, joints[up].offset));
  const knee = plus(hip, turned(thigh, joints[up + 1].offset));
  const ankle = plus(knee, turned(shin, joints[up + 2].offset));
  const sole = product(aside(ahead, foot), own);
  const heel = HEEL - (foot.y - turned(sole, joints[up + 3].offset)[1]);
  const ball: Vec = [foot.x, foot.y + Math.max(heel, 0), foot.z];
  return { up, hip, knee, ankle, turns: [thigh, shin, sole, product(sole, of(up + 3))], ball, foot: sole };
}

/** The turn about the vertical from where a body looks to where its foot looks. */
function aside([sin, cos]: readonly [number, number], foot: Foot): Quat {
  const [sine, cosine] = [foot.sin * cos - foot.cos * sin, foot.sin * sin + foot.cos * cos];
  return normalized([0, sine, 0, Math.max(Math.hypot(sine, cosine) + cosine, 1e-3)]);
}

const target = (joints: readonly Bone[], leg: Leg): Vec => minus(leg.ball, turned(leg.foot, joints[leg.up + 3].offset));

const reachOf = (joints: readonly Bone[], leg: Leg): number =>
  Math.abs(joints[leg.up + 1].offset[1] + joints[leg.up + 2].offset[1]) * STRETCH;

function lowering(joints: readonly Bone[], leg: Leg): number {
  const [to, reach] = [target(joints, leg), reachOf(joints, leg)];
  const across = (to[0] - leg.hip[0]) ** 2 + (to[2] - leg.hip[2]) ** 2;
  return leg.hip[1] - to[1] - Math.sqrt(Math.max(reach * reach - across, 0));
}

function liftHeel(joints: readonly Bone[], leg: Leg): void {
  const [to, reach] = [target(joints, leg), reachOf(joints, leg)];
  const [bone, toHip] = [minus(to, leg.ball), minus(leg.hip, leg.ball)];
  if (length(minus(to, leg.hip)) <= reach) return;
  const [foot, whole] = [length(bone), length(toHip)];
  const acos = (v: number) => Math.acos(Math.min(Math.max(v, -1), 1));
  const now = acos(dot(bone, toHip) / (foot * whole));
  const then = acos((foot * foot + whole * whole - reach * reach) / (2 * foot * whole));
  const angle = Math.min(Math.max(now - then, 0), LIFT);
  leg.foot = product(about(unit(cross(bone, toHip), [1, 0, 0]), angle), leg.foot);
}

function bend(joints: readonly Bone[], local: Float32Array, hips: Quat, leg: Leg): void {
  const flat = leg.foot;
  liftHeel(joints, leg);
  const [thigh, shin] = reached(joints, leg);
  const bent = toes(joints, leg);
  local.set(product(conjugate(hips), thigh), 4 * leg.up);
  local.set(product(conjugate(thigh), shin), 4 * (leg.up + 1));
  local.set(product(conjugate(shin), leg.foot), 4 * (leg.up + 2));
  if (bent !== leg.turns[3] || leg.foot !== flat) {
    local.set(normalized(product(conjugate(leg.foot), bent)), 4 * (leg.up + 3));
  }
}

/** Rotations of thigh and shin that bring the ankle to its target. */
function reached(joints: readonly Bone[], leg: Leg): [Quat, Quat] {
  const [thigh, shin] = [minus(leg.knee, leg.hip), minus(leg.ankle, leg.knee)];
  const way = minus(target(joints, leg), leg.hip);
  const [a, b] = [length(joints[leg.up + 1].offset), length(joints[leg.up + 2].offset)];
  const line = plus(thigh, shin);
  const [a2, b2, now, far] = [a * a, b * b, dot(line, line), length(way)];
  const reach = Math.min(Math.max(far, 0.1), (a + b) * 0.9999);
  const then = reach * reach;
  const over = cross(thigh, shin);
  const before = { area: length(over), hip: 0.5 * (a2 + now - b2), ankle: 0.5 * (b2 + now - a2) };
  const hip = 0.5 * (a2 + then - b2);
  const after = { area: Math.sqrt(Math.max(a2 * then - hip * hip, 0)), hip, ankle: 0.5 * (b2 + then - a2) };
  const hinge = unit(plus(over, scaled(turned(leg.turns[0], [1, 0, 0]), STRAIGHT * a * b)), [1, 0, 0]);
  const whole = Math.sqrt(now) * reach;
  const open = opened(hinge, [after.hip, after.area], [before.hip, before.area], a2 * whole);
  const close = opened(hinge, [before.ankle, before.area], [after.ankle, after.area], b2 * whole);
  const from = plus(turned(open, thigh), turned(close, shin));
  const swing = normalized([...cross(from, way), Math.max(reach * far + dot(from, way), 1e-6)]);
  return [product(product(swing, open), leg.turns[0]), product(product(swing, close), leg.turns[1])];
}

/** The turn about an axis from one angle to another, given as cosines and sines times lengths whose product is `whole`. */
function opened(axis: Vec, from: readonly number[], to: readonly number[], whole: number): Quat {
  const cosine = from[0] * to[0] + from[1] * to[1];
  const sine = to[1] * from[0] - to[0] * from[1];
  return normalized([...scaled(axis, sine), whole + cosine]);
}

/** How the toes are turned: as they were, but not into the floor. */
function toes(joints: readonly Bone[], leg: Leg): Quat {
  const turn = leg.turns[3];
  const tip = turned(turn, joints[leg.up + 3].tip ?? [0, 0, 0]);
  const lowest = -TOES - leg.ball[1];
  if (tip[1] >= lowest) return turn;
  const slope = (y: number) => Math.asin(Math.min(Math.max(y / length(tip), -1), 1));
  const axis = unit(cross(tip, [0, 1, 0]), turned(turn, [-1, 0, 0]));
  return product(about(axis, slope(lowest) - slope(tip[1])), turn);
}
