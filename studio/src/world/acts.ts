/** People who do something else than walk: clips of full bodies, as in src/stage/world/acts.rs. */

import { type Container, FileProblem } from "../crowd/container";
import type { Joint } from "../crowd/model";
import { fade, isWhole } from "./fade";
import type { Acts, Place, World } from "./model";
import { added, times, turned } from "./quaternion";
import type { Act, Walker } from "./sample";

/** In place of a clip: somebody without one. */
const NONE = 0xffffffff;
/** Walk and clip fade into each other over so many seconds. */
const FADE_SECS = 0.5;

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
    walkers: file.array("walker_acts", "u32"),
    times: file.array("walker_act_times", "f32"),
    feet: file.has("walker_act_feet") ? file.array("walker_act_feet", "f32") : new Float32Array(),
  };
  if (!file.has("walker_act_feet")) acts.feet = withBody(acts.times);
  const frames = acts.ends.at(-1) ?? 0;
  const sizes: [string, number, number][] = [
    ["act_steps", acts.steps.length, acts.ends.length],
    ["act_roots", acts.roots.length, 3 * frames],
    ["act_rotations", acts.rotations.length, 4 * joints.length * frames],
    ["stayer_act_leads", acts.leads.length, acts.stayers.length],
    ["walker_act_times", acts.times.length, 3 * acts.walkers.length],
    ["walker_act_feet", acts.feet.length, 8 * acts.walkers.length],
  ];
  for (const [name, found, expected] of sizes) {
    if (found !== expected) throw new FileProblem(`array ${name}`, `expected ${expected} numbers, found ${found}`);
  }
  for (const [name, clips] of Object.entries({ stayer_acts: acts.stayers, walker_acts: acts.walkers })) {
    const odd = clips.find((clip) => clip !== NONE && clip >= acts.ends.length);
    if (odd !== undefined) throw new FileProblem(`array ${name}`, `expected a clip, found ${odd}`);
  }
  return acts;
}

/** In older worlds feet go over from walk to clip and back as the body does. */
function withBody(times: Float32Array): Float32Array {
  const feet = Array.from({ length: times.length / 3 }, (_, i) => {
    const [, enter, leave] = times.subarray(3 * i);
    const [first, last] = [enter + FADE_SECS, leave - FADE_SECS];
    return [enter, first, enter, first, last, leave, last, leave];
  });
  return Float32Array.from(feet.flat());
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
    const at = {
      x: cos * stayer.x - sin * stayer.z + place.x + shift[0],
      z: sin * stayer.x + cos * stayer.z + place.z + shift[1],
      heading: stayer.heading - place.turn,
    };
    const lead = world.acts.leads[kind.firstStayer + index];
    out.push({
      ...at,
      speed: 0,
      phase: 0,
      feet: null,
      // The same looks for the same place, whatever walks by.
      id: (Math.imul(place.firstCrossing + 1, 0x9e3779b1) ^ Math.imul(kind.firstStayer + index + 7, 0x85ebca6b)) >>> 0,
      act: {
        ...at,
        clip,
        secs: own - Math.floor(own / world.period) * world.period + lead,
        repeats: true,
        share: 1,
        feet: [1, 1],
      },
    });
  }
}

/** What a walker does, who came in in period `lap`, if it does not just walk. */
export function visit(
  world: World,
  place: Place,
  walker: number,
  secs: number,
  lap: number,
  shift: readonly [number, number],
): Act | undefined {
  const clip = world.acts?.walkers[walker] ?? NONE;
  if (clip === NONE || !world.acts) return undefined;
  const [begin, enter, leave] = world.acts.times.subarray(3 * walker);
  const own = secs + (place.phase * world.period) / world.slots - lap * world.period;
  const feet = world.acts.feet.subarray(8 * walker, 8 * walker + 8);
  const gone = (i: number) => eased((own - feet[i]) / Math.max(feet[i + 1] - feet[i], 1e-3));
  const shown = (foot: number) => Math.min(gone(foot), 1 - gone(foot + 4));
  const at = { x: place.x + shift[0], z: place.z + shift[1], heading: -place.turn };
  const share = eased(Math.min(own - enter, leave - own) / FADE_SECS);
  return { ...at, clip, secs: own - begin, repeats: false, share, feet: [shown(0), shown(2)] };
}

function eased(share: number): number {
  const inside = Math.min(Math.max(share, 0), 1);
  return inside * inside * (3 - 2 * inside);
}

/** Full bodies out of clips. */
export class Actor {
  private readonly local: Float32Array;
  private readonly hips = [0, 0, 0];
  private readonly places: Float32Array;
  private readonly turns: Float32Array;

  constructor(private readonly acts: Acts) {
    const n = 4 * acts.joints.length;
    [this.local, this.places, this.turns] = [new Float32Array(n), new Float32Array(n), new Float32Array(n)];
  }

  /** Brings x, y, z, 1 of every joint in `places` and its rotation in `turns`, from number `at` on, to what the clip has. */
  pose(act: Act, places: Float32Array, turns: Float32Array, at: number): void {
    this.sample(act);
    const { hips } = this;
    const half = act.heading / 2;
    const [sin, cos] = [Math.sin(act.heading), Math.cos(act.heading)];
    const heading = [0, Math.sin(half), 0, Math.cos(half)];
    for (const [j, { parent, offset }] of this.acts.joints.entries()) {
      const [into, from] = [4 * j, 4 * parent];
      const base = parent < 0 ? heading : this.turns.subarray(from, from + 4);
      times(base, this.local.subarray(into, into + 4), this.turns, into);
      const place =
        parent < 0
          ? [act.x + cos * hips[0] + sin * hips[2], hips[1], act.z - sin * hips[0] + cos * hips[2]]
          : added(this.places, from, turned(base, offset));
      this.places.set(place, into);
      this.places[into + 3] = 1;
    }
    if (isWhole(act)) {
      places.set(this.places, at);
      turns.set(this.turns, at);
    } else {
      fade(this.acts.joints, { places, turns, at }, { places: this.places, turns: this.turns, at: 0 }, act);
    }
  }

  /** Hips and local rotations of a clip. */
  private sample({ clip, secs, repeats }: Act): void {
    const { ends, steps, roots, rotations } = this.acts;
    const begin = clip === 0 ? 0 : ends[clip - 1];
    const frames = ends[clip] - begin;
    const whole = secs / steps[clip];
    const at = repeats ? whole - Math.floor(whole / frames) * frames : Math.min(Math.max(whole, 0), frames - 1);
    const first = Math.min(Math.floor(at), frames - 1);
    const next = repeats ? (first + 1) % frames : Math.min(first + 1, frames - 1);
    const [a, b, share] = [begin + first, begin + next, at - first];
    for (let axis = 0; axis < 3; axis++) {
      this.hips[axis] = roots[3 * a + axis] * (1 - share) + roots[3 * b + axis] * share;
    }
    const n = this.local.length;
    this.local.set(rotations.subarray(n * a, n * (a + 1)));
    for (let i = 0; i < n; i += 4) {
      mix(this.local, i, rotations, n * b + i, share);
      unit(this.local, i);
    }
  }
}

/** Four numbers on the way to four others, or to their negatives if those are nearer: rotations have two names. */
function mix(into: Float32Array, at: number, from: ArrayLike<number>, begin: number, share: number): void {
  let dot = 0;
  for (let k = 0; k < 4; k++) dot += into[at + k] * from[begin + k];
  const sign = dot < 0 ? -1 : 1;
  for (let k = 0; k < 4; k++) into[at + k] += (sign * from[begin + k] - into[at + k]) * share;
}

function unit(q: Float32Array, at: number): void {
  const length = Math.hypot(q[at], q[at + 1], q[at + 2], q[at + 3]) || 1;
  for (let k = at; k < at + 4; k++) q[k] /= length;
}
