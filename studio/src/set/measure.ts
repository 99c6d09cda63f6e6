/** What is measured of a kind, as src/patch/measure.rs does it: figures, and what people do in words. */

import { bodyCapsules } from "../crowd/capsules";
import type { Crowd, Vec2, Vec3 } from "../crowd/model";
import { Pose, samplePose, sampleProp } from "../crowd/sample";
import { crowdOf } from "./crowd";
import type { PatchSet, Role, SetKind } from "./model";

/** Who is faster travels, slower stands, faster runs: m/s. */
const [TRAVELS, STANDS, RUNS] = [0.5, 0.3, 2.1];
/** From standing to standing over less than this is a step: m. Who turns by more turns: degrees. */
const [STEP, TURNS] = [1, 20];
/** Hips below crouch, lowest points above jump: m. */
const [LOW, AIR] = [0.65, 0.08];
/** Frames on either side over which a speed is taken. */
const AROUND = 3;
const DIRECTIONS = 64;

export interface Measures {
  people: number;
  seconds: number;
  /** Mean of all, and of anybody the most, over the ground: m/s. */
  speed: number;
  fastest: number;
  /** Of the smallest circle around everything, seen from above: m. */
  radius: number;
  /** From entry to exit, of who turns most: degrees, left positive. */
  turnDeg: number;
  props: number;
  words: string[];
}

const known = new WeakMap<SetKind, Measures>();

/** Measures a kind, once. */
export function measuresOf(set: PatchSet, kind: SetKind): Measures {
  const found = known.get(kind) ?? measure(set, kind);
  known.set(kind, found);
  return found;
}

interface Person {
  seconds: number;
  way: number;
  fastest: number;
  turnDeg: number;
  stands: [entry: boolean, exit: boolean];
  low: boolean;
  jumps: boolean;
}

function measure(set: PatchSet, kind: SetKind): Measures {
  const crowd = crowdOf(set, kind);
  const outline = new Outline();
  const people = kind.roles.map((role, person) => ({
    ...alongPath(set, role),
    jumps: addBodies(crowd, person, role.frames, outline),
  }));
  addBoxes(crowd, outline);
  const sum = (of: (p: Person) => number) => people.reduce((total, p) => total + of(p), 0);
  const all = sum((p) => p.seconds);
  return {
    people: people.length,
    seconds: kind.lastFrame / set.fps,
    speed: all > 0 ? sum((p) => p.way) / all : 0,
    fastest: Math.max(0, ...people.map((p) => p.fastest)),
    radius: outline.radius(),
    turnDeg: people.reduce((most, p) => (Math.abs(p.turnDeg) > Math.abs(most) ? p.turnDeg : most), 0),
    props: kind.props.length,
    words: words(kind, people),
  };
}

function words(kind: SetKind, people: Person[]): string[] {
  const told: [string, boolean][] = [
    ...["stand", "step", "walk", "run"].map((word): [string, boolean] => [word, people.some((p) => gait(p) === word)]),
    ["start", people.some((p) => p.stands[0] && !p.stands[1])],
    ["stop", people.some((p) => !p.stands[0] && p.stands[1])],
    ["turn", people.some((p) => Math.abs(p.turnDeg) > TURNS)],
    ["low", people.some((p) => p.low)],
    ["jump", people.some((p) => p.jumps)],
    ["together", people.length > 1],
    ["contact", kind.contacts.length > 0],
    ["prop", kind.props.length > 0],
  ];
  return told.filter(([, holds]) => holds).map(([word]) => word);
}

function gait({ fastest, stands, way }: Person): string {
  if (fastest <= TRAVELS) return "stand";
  if (fastest > RUNS) return "run";
  return stands[0] && stands[1] && way < STEP ? "step" : "walk";
}

function alongPath({ points, headings, heights, fps }: PatchSet, { firstFrame, frames }: Role): Omit<Person, "jumps"> {
  const between = (a: number, b: number) =>
    Math.hypot(
      points[(firstFrame + b) * 2] - points[(firstFrame + a) * 2],
      points[(firstFrame + b) * 2 + 1] - points[(firstFrame + a) * 2 + 1],
    );
  const speed = (at: number) => {
    const [from, to] = [Math.max(at - AROUND, 0), Math.min(at + AROUND, frames - 1)];
    return (between(from, to) * fps) / Math.max(to - from, 1);
  };
  const speeds = Array.from({ length: frames }, (_, i) => speed(i));
  const fastest = Math.max(...speeds);
  const still = (at: number) => speeds[at] < STANDS || fastest < TRAVELS;
  let way = 0;
  for (let i = 1; i < frames; i++) way += between(i - 1, i);
  const turn = headings[firstFrame + frames - 1] - headings[firstFrame];
  return {
    seconds: (frames - 1) / fps,
    way,
    fastest,
    turnDeg: (turn * 180) / Math.PI,
    stands: [still(0), still(frames - 1)],
    low: heights.subarray(firstFrame, firstFrame + frames).some((h) => h < LOW),
  };
}

/** Adds a person's body at every frame; whether it is somewhere wholly in the air. */
function addBodies(crowd: Crowd, person: number, frames: number, outline: Outline): boolean {
  const pose = new Pose(crowd.joints.length);
  const { begin } = crowd.characters[person];
  let jumps = false;
  for (let frame = 0; frame < frames; frame++) {
    // A hair inside, where rounding would put it outside.
    const at = Math.min(Math.max(frame, 1e-6), frames - 1 - 1e-6);
    if (!samplePose(crowd, person, (begin + at) / crowd.fps, pose)) continue;
    let lowest = Number.POSITIVE_INFINITY;
    for (const { a, b, radius } of bodyCapsules(crowd, pose)) {
      for (const [x, y, z] of [a, b]) {
        outline.add([x, z], radius);
        lowest = Math.min(lowest, y - radius);
      }
    }
    jumps ||= lowest > AIR;
  }
  return jumps;
}

/** Adds the corners of all boxes at every frame at which they are there. */
function addBoxes(crowd: Crowd, outline: Outline): void {
  const at: [number, number, number, number] = [0, 0, 0, 0];
  for (const [index, { size, begin, frames }] of crowd.props.entries()) {
    for (let frame = 0; frame < frames; frame++) {
      const inside = Math.min(Math.max(frame, 1e-6), frames - 1 - 1e-6);
      if (!sampleProp(crowd, index, (begin + inside) / crowd.fps, at)) continue;
      for (const corner of corners(at, size)) outline.add(corner, 0);
    }
  }
}

function corners([x, , z, heading]: readonly number[], size: Vec3): Vec2[] {
  const [sin, cos] = [Math.sin(heading), Math.cos(heading)];
  return [-0.5, 0.5].flatMap((i) =>
    [-0.5, 0.5].map((j): Vec2 => {
      const [aside, ahead] = [i * size[0], j * size[2]];
      return [x + aside * cos + ahead * sin, z - aside * sin + ahead * cos];
    }),
  );
}

/** The points of discs that are outermost in a number of directions. */
class Outline {
  private readonly reach = new Float64Array(DIRECTIONS).fill(Number.NEGATIVE_INFINITY);
  private readonly points: Vec2[] = [];

  add([x, y]: Vec2, radius: number): void {
    for (const [i, [dx, dy]] of FACING.entries()) {
      const reach = x * dx + y * dy + radius;
      if (reach <= this.reach[i]) continue;
      this.reach[i] = reach;
      this.points[i] = [x + radius * dx, y + radius * dy];
    }
  }

  /** Of the smallest circle around all: whoever is outside of that of those before is on its edge. */
  radius(): number {
    const { points } = this;
    let circle: Circle = { middle: [0, 0], radius: 0 };
    const outside = (p: Vec2) => apart(circle.middle, p) > circle.radius * (1 + 1e-9) + 1e-12;
    for (const [i, p] of points.entries()) {
      if (i > 0 && !outside(p)) continue;
      circle = { middle: p, radius: 0 };
      for (const [j, q] of points.slice(0, i).entries()) {
        if (!outside(q)) continue;
        circle = { middle: [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2], radius: apart(p, q) / 2 };
        for (const r of points.slice(0, j)) if (outside(r)) circle = around(p, q, r);
      }
    }
    return circle.radius;
  }
}

interface Circle {
  middle: Vec2;
  radius: number;
}

const FACING = Array.from({ length: DIRECTIONS }, (_, i): Vec2 => {
  const angle = (2 * Math.PI * i) / DIRECTIONS;
  return [Math.cos(angle), Math.sin(angle)];
});

function apart(a: Vec2, b: Vec2): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}

/** The circle through three points. */
function around(p: Vec2, q: Vec2, r: Vec2): Circle {
  const [a, b] = [
    [q[0] - p[0], q[1] - p[1]],
    [r[0] - p[0], r[1] - p[1]],
  ];
  const [aa, bb, twice] = [a[0] ** 2 + a[1] ** 2, b[0] ** 2 + b[1] ** 2, 2 * (a[0] * b[1] - a[1] * b[0])];
  const [x, y] = [(b[1] * aa - a[1] * bb) / twice, (a[0] * bb - b[0] * aa) / twice];
  return { middle: [p[0] + x, p[1] + y], radius: Math.hypot(x, y) };
}
