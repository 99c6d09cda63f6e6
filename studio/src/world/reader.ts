/** Reads world files (`*.world`). */

import { Container, count, FileProblem, finite, list, object, text } from "../crowd/container";
import type { Vec3 } from "../crowd/model";
import { readActs } from "./acts";
import {
  type Bone,
  type Gait,
  type Kind,
  type Place,
  type Stayer,
  type Thing,
  UNITS_PER_METRE,
  type World,
} from "./model";
import { linked } from "./walks";

export const MAGIC = "CQWORLD";
const KIND = 5;

/** The world in a file, or a FileProblem that says where it is broken. */
export function readWorld(bytes: ArrayBuffer): World {
  const file = Container.open(bytes, MAGIC, [1]);
  const { header } = file;
  const names = list(header.names, "header.names").map((name, i) => text(name, `name ${i}`));
  const period = finite(header.period_secs, "header.period_secs");
  const slots = count(header.slots, "header.slots");
  const kinds = readKinds(file, names);
  const stays = readStays(file, period, slots);
  const places = readPlaces(file, kinds);
  const crossings = places.reduce((sum, place) => sum + kinds[place.kind].walkers, 0);
  const world: World = {
    name: text(header.name, "header.name"),
    period,
    slots,
    pageSlots: count(header.page, "header.page"),
    unit: finite(header.metres_per_unit, "header.metres_per_unit"),
    templates: list(header.templates, "header.templates").map((t, i) => {
      const template = object(t, `template ${i}`);
      return { name: text(template.name, `template ${i}`), ground: text(template.ground, `template ${i}`) };
    }),
    repeat: repeatOf(header.repeat),
    kinds,
    places,
    rows: file.array("rows", "i16"),
    lanes: file.array("lanes", "u32"),
    laneEnds: file.array("lane_ends", "u32"),
    stays,
    identity: {
      cycle: file.array("crossing_cycles", "u32"),
      laps: file.array("crossing_laps", "i32"),
      copies: file.array("crossing_copies", "i32"),
      people: file.array("cycle_people", "u32"),
      around: file.array("cycle_copies", "i32"),
    },
    gait: header.gait_phases === null || header.gait_phases === undefined ? null : readGait(file, stays, crossings),
    acts: header.has_acts === true ? readActs(file, readJoints(file)) : null,
  };
  check(world, crossings);
  if (world.gait?.prints) world.gait.links = linked(world);
  return world;
}

function check(world: World, crossings: number): void {
  const pages = Math.ceil(world.slots / world.pageSlots);
  const sizes: [string, number, number][] = [
    ["lane_ends", world.laneEnds.length, pages * world.kinds.length],
    ["lanes", world.lanes.length, world.laneEnds.at(-1) ?? 0],
    ["crossing_cycles", world.identity.cycle.length, crossings],
    ["crossing_laps", world.identity.laps.length, crossings],
  ];
  for (const [name, found, expected] of sizes) {
    if (found !== expected) throw new FileProblem(`array ${name}`, `expected ${expected} numbers, found ${found}`);
  }
}

function repeatOf(value: unknown): [number, number] | null {
  if (value === null || value === undefined) return null;
  const [x, z] = list(value, "header.repeat").map((v) => finite(v, "header.repeat") / UNITS_PER_METRE);
  return [x, z];
}

/** Run `i` of cumulative ends. */
function run(end: (i: number) => number, i: number): [number, number] {
  return [i === 0 ? 0 : end(i - 1), end(i)];
}

function readKinds(file: Container, names: readonly string[]): Kind[] {
  const numbers = file.array("kinds", "u32");
  const corners = file.array("corners", "f32");
  const [objectNames, objectEnds] = [file.array("object_names", "u32"), file.array("object_ends", "u32")];
  const [points, radii] = [file.array("object_points", "f32"), file.array("object_radii", "f32")];
  const [stayerNames, stayers] = [file.array("stayer_names", "u32"), file.array("stayers", "f32")];
  const thing = (i: number): Thing => {
    const [begin, end] = run((k) => objectEnds[k], i);
    return { name: names[objectNames[i]] ?? "", points: points.subarray(2 * begin, 2 * end), radius: radii[i] };
  };
  const stayer = (i: number): Stayer => {
    const [x, z, heading] = stayers.subarray(4 * i);
    return { name: names[stayerNames[i]] ?? "", x, z, heading };
  };
  return Array.from({ length: numbers.length / KIND }, (_, kind) => {
    const column = (c: number) => run((i) => numbers[i * KIND + c], kind);
    const [edges, walkers, things, people] = [column(1), column(2), column(3), column(4)];
    const all = <T>([begin, end]: [number, number], of: (i: number) => T) =>
      Array.from({ length: end - begin }, (_, i) => of(begin + i));
    return {
      template: numbers[kind * KIND],
      outline: corners.subarray(2 * edges[0], 2 * edges[1]),
      things: all(things, thing),
      stayers: all(people, stayer),
      firstStayer: people[0],
      firstWalker: walkers[0],
      walkers: walkers[1] - walkers[0],
    };
  });
}

/** First slot of every walker of every kind, and the slot after its last. */
function readStays(file: Container, period: number, slots: number): Int32Array {
  const numbers = file.array("kinds", "u32");
  const [edges, ends] = [file.array("edges", "i32"), file.array("pattern_ends", "u32")];
  const [crossings, walkers] = [file.array("crossings", "f32"), file.array("walkers", "u32")];
  const stays = new Int32Array(2 * walkers.length);
  const times = (edge: number): [number[], number[]] => {
    const pattern = edge < 0 ? -1 - edge : edge;
    const begin = pattern === 0 ? 0 : ends[2 * pattern - 1];
    const read = (from: number, to: number) =>
      Array.from({ length: to - from }, (_, i) => crossings[4 * (from + i) + 1]);
    const [inputs, outputs] = [read(begin, ends[2 * pattern]), read(ends[2 * pattern], ends[2 * pattern + 1])];
    return edge < 0 ? [outputs, inputs] : [inputs, outputs];
  };
  // Half a slot up, as everybody else rounds: half away from zero.
  const round = (v: number) => Math.floor(v + 0.5);
  for (let kind = 0; kind < numbers.length / KIND; kind++) {
    const [firstEdge, lastEdge] = run((i) => numbers[i * KIND + 1], kind);
    const [first, last] = run((i) => numbers[i * KIND + 2], kind);
    const patterns = Array.from({ length: lastEdge - firstEdge }, (_, i) => times(edges[firstEdge + i]));
    const [inputs, outputs] = [patterns.flatMap((p) => p[0]), patterns.flatMap((p) => p[1])];
    for (let w = first; w < last; w++) {
      const leave = outputs[walkers[w] & 0xffff] + (walkers[w] >>> 16) * period;
      stays[2 * w] = round((inputs[w - first] * slots) / period);
      stays[2 * w + 1] = round((leave * slots) / period);
    }
  }
  return stays;
}

function readPlaces(file: Container, kinds: readonly Kind[]): Place[] {
  const [kind, at] = [file.array("instance_kinds", "u32"), file.array("instance_places", "i32")];
  const [turns, phases] = [file.array("instance_turns", "f32"), file.array("instance_phases", "u32")];
  let crossing = 0;
  return Array.from(kind, (k, i) => {
    if (k >= kinds.length) throw new FileProblem(`patch ${i}`, `expected a kind below ${kinds.length}, found ${k}`);
    const [x, z] = [at[2 * i] / UNITS_PER_METRE, at[2 * i + 1] / UNITS_PER_METRE];
    const place = { kind: k, x, z, turn: turns[i], phase: phases[i], firstCrossing: crossing };
    crossing += kinds[k].walkers;
    return place;
  });
}

function readGait(file: Container, stays: Int32Array, crossings: number): Gait {
  const tracks = new Uint32Array(stays.length / 2);
  let at = 0;
  for (let w = 0; w < tracks.length; w++) {
    tracks[w] = at;
    at += Math.max(stays[2 * w + 1] - stays[2 * w], 0) + 1;
  }
  const joints = readJoints(file);
  const gait: Gait = {
    joints,
    phases: count(file.header.gait_phases, "header.gait_phases"),
    speeds: file.array("gait_speeds", "f32"),
    strides: file.array("gait_strides", "f32"),
    rotations: file.array("gait_rotations", "f32"),
    hips: file.array("gait_hips", "f32"),
    steps: file.array("gait_steps", "i16"),
    headings: file.array("gait_headings", "i16"),
    crossingPhases: file.array("crossing_phases", "f32"),
    paces: readPaces(file),
    prints: file.has("gait_prints") ? file.array("gait_prints", "f32") : null,
    swings: file.has("gait_swings") ? file.array("gait_swings", "f32") : null,
    links: new Int32Array(),
    tracks,
  };
  const poses = gait.speeds.length * gait.phases;
  const sizes: [string, number, number][] = [
    ["gait_steps", gait.steps.length, at],
    ["gait_headings", gait.headings.length, at],
    ["gait_rotations", gait.rotations.length, poses * joints.length * 4],
    ["gait_hips", gait.hips.length, poses * 3],
    ["crossing_phases", gait.crossingPhases.length, crossings],
    ["crossing_paces", gait.paces.length, crossings],
    ["gait_prints", gait.prints?.length ?? 0, gait.prints || gait.swings ? gait.speeds.length * 4 : 0],
    ["gait_swings", gait.swings?.length ?? 0, gait.prints || gait.swings ? poses * 4 : 0],
  ];
  for (const [name, found, expected] of sizes) {
    if (found !== expected) throw new FileProblem(`array ${name}`, `expected ${expected} numbers, found ${found}`);
  }
  return gait;
}

/** Older worlds have one for every cycle. */
function readPaces(file: Container): Float32Array {
  if (file.has("crossing_paces")) return file.array("crossing_paces", "f32");
  const paces = file.array("cycle_paces", "f32");
  return Float32Array.from(file.array("crossing_cycles", "u32"), (cycle) => paces[cycle] ?? 1);
}

function readJoints(file: Container): Bone[] {
  return list(object(file.header.skeleton, "header.skeleton").joints, "header.skeleton.joints").map(joint);
}

function joint(value: unknown, i: number): Bone {
  const j = object(value, `joint ${i}`);
  const vector = (v: unknown) => list(v, `joint ${i}`).map((n) => finite(n, `joint ${i}`)) as unknown as Vec3;
  const parent = j.parent === null ? -1 : count(j.parent, `joint ${i}`);
  const tip = j.tip === null || j.tip === undefined ? null : vector(j.tip);
  return { name: text(j.name, `joint ${i}`), parent, offset: vector(j.offset), tip };
}
