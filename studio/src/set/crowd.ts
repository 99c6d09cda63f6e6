/** One kind of a set as a crowd of its own, which the player and the renderer know how to show: every role a person. */

import type { Character, Crowd, Flesh, Vec2 } from "../crowd/model";
import { boxesOf } from "./boxes";
import type { PatchSet, Role, SetKind } from "./model";

/** Floor around everybody's path, metres. */
const MARGIN = 0.9;
/** The floor is at least this long and wide, so that short kinds are not seen from too near. */
const LEAST = 4;

/** A kind's people on a floor of their own; the middle of their paths is its middle. */
export function crowdOf(set: PatchSet, kind: SetKind): Crowd {
  const centre = middle(set, kind);
  const frames = kind.roles.reduce((sum, r) => sum + r.frames, 0);
  const joints = set.joints.length;
  const root = new Float32Array(frames * 3);
  const pathPoints = new Float32Array(frames * 2);
  const rotations = new Int16Array(frames * joints * 4);
  const characters: Character[] = [];
  let at = 0;
  for (const [role, own] of kind.roles.entries()) {
    characters.push(character(own, role, at));
    for (let f = own.firstFrame; f < own.firstFrame + own.frames; f++, at++) {
      const [x, z] = [set.points[f * 2] - centre[0], set.points[f * 2 + 1] - centre[1]];
      root.set([x, set.heights[f], z], at * 3);
      pathPoints.set([x, z], at * 2);
      rotations.set(set.rotations.subarray(f * joints * 4, (f + 1) * joints * 4), at * joints * 4);
      turn(rotations, at * joints * 4, set.headings[f]);
    }
  }
  const crowd: Crowd = {
    fps: set.fps,
    seed: "0",
    joints: set.joints,
    builds: [{ name: "average", offsets: set.joints.map((j) => j.offset), flesh: set.joints.map(canonical) }],
    region: floor(pathPoints),
    obstacles: [],
    lastFrame: kind.lastFrame,
    periodic: { x: false, z: false, t: false },
    teams: [],
    kinds: [{ name: kind.name, labels: kind.labels, people: kind.roles.length }],
    instances: [0],
    characters,
    root,
    rotations,
    pathPoints,
    props: [],
    propPlaces: new Float32Array(),
  };
  return { ...crowd, ...boxesOf(kind, crowd, centre) };
}

function canonical(): Flesh {
  return [1, 1, 1, 0];
}

function character(own: Role, role: number, firstFrame: number): Character {
  const { begin, frames } = own;
  const fragment = { instance: 0, role, begin, end: begin + frames - 1, firstSample: firstFrame, samples: frames };
  return { begin, frames, firstFrame, build: 0, team: null, fragments: [fragment] };
}

/** Turns a packed rotation by `heading` about the vertical: in sets hips are relative to the path, in crowds global. */
function turn(packed: Int16Array, at: number, heading: number): void {
  const [s, c] = [Math.sin(heading / 2), Math.cos(heading / 2)];
  const [x, y, z, w] = packed.subarray(at, at + 4);
  const turned = [c * x + s * z, c * y + s * w, c * z - s * x, c * w - s * y];
  for (const [k, v] of turned.entries()) packed[at + k] = Math.round(v);
}

/** The corners of the smallest box around ground points. */
function box(points: Float32Array, from: number, to: number): { low: Vec2; high: Vec2 } {
  let [left, back, right, front] = [Infinity, Infinity, -Infinity, -Infinity];
  for (let i = from; i < to; i += 2) {
    [left, right] = [Math.min(left, points[i]), Math.max(right, points[i])];
    [back, front] = [Math.min(back, points[i + 1]), Math.max(front, points[i + 1])];
  }
  return { low: [left, back], high: [right, front] };
}

function middle(set: PatchSet, kind: SetKind): Vec2 {
  // The frames of a kind's roles follow each other.
  const [first, last] = [kind.roles[0], kind.roles[kind.roles.length - 1]];
  const { low, high } = box(set.points, first.firstFrame * 2, (last.firstFrame + last.frames) * 2);
  return [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2];
}

function floor(points: Float32Array): Vec2[] {
  const { high } = box(points, 0, points.length);
  const [x, z] = high.map((v) => Math.max(v + MARGIN, LEAST / 2));
  return [
    [-x, -z],
    [x, -z],
    [x, z],
    [-x, z],
  ];
}
