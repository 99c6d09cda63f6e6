/** People who do something else than walk: clips of full bodies, as in src/stage/world/acts.rs. */

import { type Container, FileProblem } from "../crowd/container";
import type { Joint } from "../crowd/model";
import type { Acts, Place, World } from "./model";
import { added, times, turned } from "./pose";
import type { Walker } from "./sample";

/** In place of a clip: somebody without one. */
const NONE = 0xffffffff;

/** The clips of a world file. */
export function readActs(file: Container, joints: Joint[]): Acts {
  const acts: Acts = {
    joints,
    ends: file.array("act_ends", "u32"),
    steps: file.array("act_steps", "f32"),
    roots: file.array("act_roots", "f32"),
    rotations: file.array("act_rotations", "i16"),
    stayers: file.array("stayer_acts", "u32"),
    leads: file.array("stayer_act_leads", "f32"),
  };
  const frames = acts.ends.at(-1) ?? 0;
  const sizes: [string, number, number][] = [
    ["act_steps", acts.steps.length, acts.ends.length],
    ["act_roots", acts.roots.length, 3 * frames],
    ["act_rotations", acts.rotations.length, 4 * joints.length * frames],
    ["stayer_act_leads", acts.leads.length, acts.stayers.length],
  ];
  for (const [name, found, expected] of sizes) {
    if (found !== expected) throw new FileProblem(`array ${name}`, `expected ${expected} numbers, found ${found}`);
  }
  const odd = acts.stayers.find((clip) => clip !== NONE && clip >= acts.ends.length);
  if (odd !== undefined) throw new FileProblem("array stayer_acts", `expected a clip, found ${odd}`);
  return acts;
}

/** The clip of somebody who stays, or null. */
export function acts(world: World, place: Place, index: number): number | null {
  const clip = world.acts?.stayers[world.kinds[place.kind].firstStayer + index] ?? NONE;
  return clip === NONE ? null : clip;
}

/** All who stay in a patch and do something at a time, about `shift`, into `out`. */
export function actors(
  world: World,
  place: Place,
  secs: number,
  shift: readonly [number, number],
  out: Walker[],
): void {
  const kind = world.kinds[place.kind];
  const [cos, sin] = [Math.cos(place.turn), Math.sin(place.turn)];
  const own = secs + (place.phase * world.period) / world.slots;
  for (const [index, stayer] of kind.stayers.entries()) {
    const clip = acts(world, place, index);
    if (clip === null || !world.acts) continue;
    out.push({
      x: cos * stayer.x - sin * stayer.z + place.x + shift[0],
      z: sin * stayer.x + cos * stayer.z + place.z + shift[1],
      speed: 0,
      heading: stayer.heading - place.turn,
      phase: 0,
      // The same looks for the same place, whatever walks by.
      id: (Math.imul(place.firstCrossing + 1, 0x9e3779b1) ^ Math.imul(kind.firstStayer + index + 7, 0x85ebca6b)) >>> 0,
      act: {
        clip,
        secs: own - Math.floor(own / world.period) * world.period + world.acts.leads[kind.firstStayer + index],
      },
    });
  }
}

/** Full bodies out of clips. */
export class Actor {
  private readonly local: Float32Array;
  private readonly hips = [0, 0, 0];

  constructor(private readonly acts: Acts) {
    this.local = new Float32Array(4 * acts.joints.length);
  }

  /** Writes x, y, z, 1 of every joint into `places` and its rotation into `turns`, from number `at` on. */
  pose(walker: Walker, places: Float32Array, turns: Float32Array, at: number): void {
    if (!walker.act) return;
    this.sample(walker.act.clip, walker.act.secs);
    const { hips } = this;
    const half = walker.heading / 2;
    const [sin, cos] = [Math.sin(walker.heading), Math.cos(walker.heading)];
    const heading = [0, Math.sin(half), 0, Math.cos(half)];
    for (const [j, { parent, offset }] of this.acts.joints.entries()) {
      const [into, from] = [at + 4 * j, at + 4 * parent];
      const base = parent < 0 ? heading : turns.subarray(from, from + 4);
      times(base, this.local.subarray(4 * j, 4 * j + 4), turns, into);
      const place =
        parent < 0
          ? [walker.x + cos * hips[0] + sin * hips[2], hips[1], walker.z - sin * hips[0] + cos * hips[2]]
          : added(places, from, turned(base, offset));
      places.set(place, into);
      places[into + 3] = 1;
    }
  }

  /** Hips and local rotations of a clip that repeats. */
  private sample(clip: number, secs: number): void {
    const { ends, steps, roots, rotations } = this.acts;
    const begin = clip === 0 ? 0 : ends[clip - 1];
    const frames = ends[clip] - begin;
    const whole = secs / steps[clip];
    const at = whole - Math.floor(whole / frames) * frames;
    const first = Math.min(Math.floor(at), frames - 1);
    const share = at - first;
    const [a, b] = [begin + first, begin + ((first + 1) % frames)];
    for (let axis = 0; axis < 3; axis++) {
      this.hips[axis] = roots[3 * a + axis] * (1 - share) + roots[3 * b + axis] * share;
    }
    const n = this.local.length;
    for (let i = 0; i < n; i += 4) {
      let dot = 0;
      for (let k = i; k < i + 4; k++) dot += rotations[n * a + k] * rotations[n * b + k];
      const to = dot < 0 ? -share : share;
      for (let k = i; k < i + 4; k++) this.local[k] = rotations[n * a + k] * (1 - share) + rotations[n * b + k] * to;
      const length = Math.hypot(this.local[i], this.local[i + 1], this.local[i + 2], this.local[i + 3]) || 1;
      for (let k = i; k < i + 4; k++) this.local[k] /= length;
    }
  }
}
