/**
 * Walk and clip fade into each other, feet one by one in their steps: the same as src/stage/world/fade.rs. Joints are x, y, z, 1 and
 * rotations in the world, as pictures need them.
 */

import type { Joint } from "../crowd/model";
import { twoBone } from "./ik";
import { LEGS } from "./leg";
import { conjugate, minus, type Numbers, normalized, plus, product, type Quat, turned, type Vec } from "./quaternion";

const STRETCH = 0.995;
const LOWERING = 0.06;

/** Joints in the world, from a number on. */
export interface Body {
  places: Float32Array;
  turns: Float32Array;
  at: number;
}

/** How much of a clip is seen: of the body, of the left and of the right foot. */
export interface Shares {
  share: number;
  feet: readonly [number, number];
}

/** Whether nothing but the clip is seen. */
export const isWhole = ({ share, feet }: Shares): boolean => share === 1 && feet[0] === 1 && feet[1] === 1;

/** Leads `body` to the other one as far as the shares say. */
export function fade(joints: readonly Joint[], body: Body, other: Body, { share, feet }: Shares): void {
  const steps = LEGS.map((up, i) => ({
    foot: between(turn(body, up + 2), turn(other, up + 2), feet[i]),
    toes: between(turn(body, up + 3), turn(other, up + 3), feet[i]),
    ball: on(place(body, up + 3), place(other, up + 3), feet[i]),
  }));
  const pose = joints.map((_, j) => between(local(joints, body, j), local(joints, other, j), share));
  const root = on(place(body, 0), place(other, 0), share);
  const ankles = LEGS.map((up, i) => minus(steps[i].ball, turned(steps[i].foot, joints[up + 3].offset)));
  const down = LEGS.map((up, i) => lowering(leg(joints, pose, root, up), ankles[i]));
  root[1] -= Math.min(Math.max(...down, 0), LOWERING);
  for (const [i, up] of LEGS.entries()) {
    const { places, turns } = leg(joints, pose, root, up);
    const [swing, bend] = twoBone(places[0], places[1], places[2], ankles[i], turned(turns[0], [0, 0, 1]), 0.9999);
    const thigh = product(swing, turns[0]);
    const shin = product(product(swing, bend), turns[1]);
    pose[up] = normalized(product(conjugate(pose[0]), thigh));
    pose[up + 1] = normalized(product(conjugate(thigh), shin));
    pose[up + 2] = normalized(product(conjugate(shin), steps[i].foot));
    pose[up + 3] = normalized(product(conjugate(steps[i].foot), steps[i].toes));
  }
  for (const [j, { parent, offset }] of joints.entries()) {
    const base = parent < 0 ? null : turn(body, parent);
    const at = base ? plus(place(body, parent), turned(base, offset)) : root;
    body.places.set([...at, 1], body.at + 4 * j);
    body.turns.set(base ? product(base, pose[j]) : pose[j], body.at + 4 * j);
  }
}

const turn = ({ turns, at }: Body, j: number): Numbers => turns.subarray(at + 4 * j, at + 4 * j + 4);
const place = ({ places, at }: Body, j: number): Numbers => places.subarray(at + 4 * j, at + 4 * j + 3);

function local(joints: readonly Joint[], body: Body, j: number): Numbers {
  const { parent } = joints[j];
  return parent < 0 ? turn(body, j) : product(conjugate(turn(body, parent)), turn(body, j));
}

function on(from: Numbers, to: Numbers, share: number): Vec {
  const axis = (i: number) => from[i] + (to[i] - from[i]) * share;
  return [axis(0), axis(1), axis(2)];
}

function between(a: Numbers, b: Numbers, share: number): Quat {
  const near = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] < 0 ? -share : share;
  const part = (i: number) => a[i] * (1 - share) + b[i] * near;
  return normalized([part(0), part(1), part(2), part(3)]);
}

/** Places and rotations of thigh, shin, foot and toes. */
function leg(joints: readonly Joint[], pose: readonly Quat[], root: Vec, up: number): { places: Vec[]; turns: Quat[] } {
  const [places, turns]: [Vec[], Quat[]] = [[], []];
  let [at, base] = [root, pose[0]];
  for (let j = up; j < up + 4; j++) {
    at = plus(at, turned(base, joints[j].offset));
    base = product(base, pose[j]);
    places.push(at);
    turns.push(base);
  }
  return { places, turns };
}

/** How far the hips should come down for an ankle to be in reach. */
function lowering({ places: [hip, knee, own] }: { places: Vec[] }, ankle: Vec): number {
  const far = (a: Vec, b: Vec) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  const reach = Math.max(far(hip, own), STRETCH * (far(hip, knee) + far(knee, own)));
  const across = (ankle[0] - hip[0]) ** 2 + (ankle[2] - hip[2]) ** 2;
  return hip[1] - ankle[1] - Math.sqrt(Math.max(reach * reach - across, 0));
}
