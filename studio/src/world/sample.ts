/** Where everybody is at any time: the same sums as src/stage/world/sample.rs, for the patches that are near. */

import { visit } from "./acts";
import { Feet } from "./feet";
import type { Foot, Place, World } from "./model";
import { type At, Walks } from "./walks";

/** Somebody who walks. */
export interface Walker {
  x: number;
  z: number;
  speed: number;
  /** Radians about the vertical, 0 along +z. */
  heading: number;
  /** How far through a cycle of two steps. */
  phase: number;
  /** The same for the same person at any time. */
  id: number;
  /** Null if feet are not led to footprints. */
  feet: [Foot, Foot] | null;

  /** Who does something else than walk. */
  act?: Act | undefined;
}

/** A clip at some second of it, seen from a place on the ground, and how much of the body and of both feet it shows through. */
export interface Act {
  clip: number;
  secs: number;
  repeats: boolean;
  x: number;
  z: number;
  heading: number;
  share: number;
  feet: [number, number];
}

/** A time slot and the weights of control points in it. */
interface Moment {
  lap: number;
  slot: number;
  u: number;
  place: readonly number[];
  velocity: readonly number[];
}

function moment(world: World, secs: number, phase: number): Moment {
  const at = (secs / world.period) * world.slots;
  const whole = Math.floor(at);
  const u = at - whole;
  const shifted = whole + phase;
  const slot = ((shifted % world.slots) + world.slots) % world.slots;
  const perSec = world.slots / world.period;
  return {
    lap: Math.floor(shifted / world.slots),
    slot,
    u,
    ...weights(u, perSec),
  };
}

/** Of four control points at a fraction of a slot, for the place and for the velocity. */
export function weights(u: number, perSec: number): { place: number[]; velocity: number[] } {
  const v = 1 - u;
  return {
    place: [v * v * v, (3 * u - 6) * u * u + 4, ((-3 * u + 3) * u + 3) * u + 1, u * u * u].map((w) => w / 6),
    velocity: [-0.5 * v * v, (1.5 * u - 2) * u, (-1.5 * u + 1) * u + 0.5, 0.5 * u * u].map((w) => w * perSec),
  };
}

export class Sampler {
  private readonly rows: Rows;
  private readonly feet: Feet | null;

  constructor(private readonly world: World) {
    this.rows = new Rows(world);
    this.feet = world.gait?.prints ? new Feet(world.gait, new Walks(world, this.rows)) : null;
  }

  /** Everybody in a patch at a time, about `shift` (where the world repeats) into `out`. */
  patch(place: Place, secs: number, shift: readonly [number, number], copy: readonly number[], out: Walker[]): void {
    const { world } = this;
    const now = moment(world, secs, place.phase);
    const kind = world.kinds[place.kind];
    const { first, lanes, base, stride } = this.rows.of(place.kind, now.slot);
    const [cos, sin] = [Math.cos(place.turn), Math.sin(place.turn)];
    for (let lane = 0; lane < lanes; lane++) {
      const [own, ago] = [world.lanes[first + lane] & 0xffff, world.lanes[first + lane] >>> 16];
      const walker = kind.firstWalker + own;
      const slot = now.slot + ago * world.slots;
      if (slot < world.stays[2 * walker] || slot >= world.stays[2 * walker + 1]) continue;
      const x = this.rows.sum(now.place, base + lane, stride);
      const z = this.rows.sum(now.place, base + lanes + lane, stride);
      const vx = this.rows.sum(now.velocity, base + lane, stride);
      const vz = this.rows.sum(now.velocity, base + lanes + lane, stride);
      const crossing = place.firstCrossing + own;
      const at = { place, own, slot: slot - world.stays[2 * walker], u: now.u };
      const body = this.body(walker, at, crossing, Math.atan2(vx, vz));
      const speed = Math.hypot(vx, vz);
      const here: [number, number] = [cos * x - sin * z, sin * x + cos * z];
      out.push({
        x: here[0] + place.x + shift[0],
        z: here[1] + place.z + shift[1],
        speed,
        heading: body.heading - place.turn,
        phase: body.phase,
        id: this.person(crossing, now.lap - ago, copy),
        feet: this.feet?.of(at, here, speed, body.phase) ?? null,
        act: visit(world, place, walker, secs, now.lap - ago, shift),
      });
    }
  }

  private body(walker: number, { slot, u }: At, crossing: number, ahead: number) {
    const { gait } = this.world;
    if (!gait) return { heading: ahead, phase: 0 };
    const at = gait.tracks[walker] + slot;
    const steps = (gait.steps[at] + (gait.steps[at + 1] - gait.steps[at]) * u) / 512;
    const turn = ((gait.headings[at + 1] - gait.headings[at]) << 16) >> 16;
    const phase = gait.crossingPhases[crossing] + steps * gait.paces[crossing];
    return { heading: ((gait.headings[at] + turn * u) * Math.PI) / 32768, phase: phase - Math.floor(phase) };
  }

  /** A number for whoever comes in at a crossing in a period. */
  private person(crossing: number, lap: number, copy: readonly number[]): number {
    const { cycle, laps, copies, people, around } = this.world.identity;
    const own = cycle[crossing];
    const since = lap - laps[crossing];
    const rounds = people[own] > 0 ? Math.floor(since / people[own]) : 0;
    const [x, z] = [0, 1].map((axis) => copy[axis] - copies[2 * crossing + axis] - rounds * around[2 * own + axis]);
    let hash = Math.imul(own + 1, 0x9e3779b1) ^ Math.imul(since - rounds * people[own] + 7, 0x85ebca6b);
    hash ^= Math.imul(x + 3, 0x27d4eb2f) ^ Math.imul(z + 5, 0x165667b1);
    hash = Math.imul(hash ^ (hash >>> 15), 0x2c1b3c6d);
    return (hash ^ (hash >>> 13)) >>> 0;
  }
}

/** Where control points are. */
export class Rows {
  /** First row number of every page. */
  private readonly pageBegins: number[] = [];

  constructor(private readonly world: World) {
    let begin = 0;
    for (let page = 0; page * world.pageSlots < world.slots; page++) {
      this.pageBegins.push(begin);
      begin += this.stride(page) * (Math.min(world.pageSlots, world.slots - page * world.pageSlots) + 3);
    }
  }

  /** Lanes of a kind in a slot: the first, how many, the first one's x, and from row to row. */
  of(kind: number, slot: number): { first: number; lanes: number; base: number; stride: number } {
    const { world } = this;
    const page = Math.floor(slot / world.pageSlots);
    const index = page * world.kinds.length + kind;
    const first = this.laneBegin(index);
    const stride = this.stride(page);
    const row = this.pageBegins[page] + (slot % world.pageSlots) * stride;
    const base = row + 2 * (first - this.laneBegin(page * world.kinds.length));
    return { first, lanes: world.laneEnds[index] - first, base, stride };
  }

  /** Four control points, weighed, in metres. */
  sum(w: readonly number[], at: number, stride: number): number {
    const { rows, unit } = this.world;
    const near = w[0] * rows[at] + w[1] * rows[at + stride];
    return (near + w[2] * rows[at + 2 * stride] + w[3] * rows[at + 3 * stride]) * unit;
  }

  private laneBegin(index: number): number {
    return index === 0 ? 0 : this.world.laneEnds[index - 1];
  }

  private stride(page: number): number {
    const { laneEnds, kinds } = this.world;
    return 2 * ((laneEnds[(page + 1) * kinds.length - 1] ?? 0) - this.laneBegin(page * kinds.length));
  }
}
