/** Where everybody is at any time: the same sums as src/stage/world/rows.rs, for the patches that are near. */

import { visit } from "./acts";
import type { Place, World } from "./model";

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
  /** Who does something else than walk. */
  act?: Act | undefined;
}

/** A clip at some second of it, seen from a place on the ground, and how much it shows through. */
export interface Act {
  clip: number;
  secs: number;
  repeats: boolean;
  x: number;
  z: number;
  heading: number;
  share: number;
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
  const [u, v] = [at - whole, 1 - (at - whole)];
  const shifted = whole + phase;
  const slot = ((shifted % world.slots) + world.slots) % world.slots;
  const perSec = world.slots / world.period;
  return {
    lap: Math.floor(shifted / world.slots),
    slot,
    u,
    place: [v * v * v, (3 * u - 6) * u * u + 4, ((-3 * u + 3) * u + 3) * u + 1, u * u * u].map((w) => w / 6),
    velocity: [-0.5 * v * v, (1.5 * u - 2) * u, (-1.5 * u + 1) * u + 0.5, 0.5 * u * u].map((w) => w * perSec),
  };
}

export class Sampler {
  /** First row number of every page. */
  private readonly pageBegins: number[] = [];

  constructor(private readonly world: World) {
    let begin = 0;
    for (let page = 0; page * world.pageSlots < world.slots; page++) {
      this.pageBegins.push(begin);
      begin += this.stride(page) * (Math.min(world.pageSlots, world.slots - page * world.pageSlots) + 3);
    }
  }

  /** Everybody in a patch at a time, about `shift` (where the world repeats) into `out`. */
  patch(place: Place, secs: number, shift: readonly [number, number], copy: readonly number[], out: Walker[]): void {
    const { world } = this;
    const now = moment(world, secs, place.phase);
    const kind = world.kinds[place.kind];
    const page = Math.floor(now.slot / world.pageSlots);
    const index = page * world.kinds.length + place.kind;
    const [first, last] = [this.laneBegin(index), world.laneEnds[index]];
    const lanes = last - first;
    const stride = this.stride(page);
    const row = this.pageBegins[page] + (now.slot % world.pageSlots) * stride;
    const base = row + 2 * (first - this.laneBegin(page * world.kinds.length));
    const [cos, sin] = [Math.cos(place.turn), Math.sin(place.turn)];
    for (let lane = 0; lane < lanes; lane++) {
      const [own, ago] = [world.lanes[first + lane] & 0xffff, world.lanes[first + lane] >>> 16];
      const walker = kind.firstWalker + own;
      const slot = now.slot + ago * world.slots;
      if (slot < world.stays[2 * walker] || slot >= world.stays[2 * walker + 1]) continue;
      const x = this.sum(now.place, base + lane, stride);
      const z = this.sum(now.place, base + lanes + lane, stride);
      const vx = this.sum(now.velocity, base + lane, stride);
      const vz = this.sum(now.velocity, base + lanes + lane, stride);
      const crossing = place.firstCrossing + own;
      const body = this.body(walker, slot - world.stays[2 * walker], now.u, crossing, Math.atan2(vx, vz));
      out.push({
        x: cos * x - sin * z + place.x + shift[0],
        z: sin * x + cos * z + place.z + shift[1],
        speed: Math.hypot(vx, vz),
        heading: body.heading - place.turn,
        phase: body.phase,
        id: this.person(crossing, now.lap - ago, copy),
        act: visit(world, place, walker, secs, now.lap - ago, shift),
      });
    }
  }

  /** Four control points, weighed, in metres. */
  private sum(w: readonly number[], at: number, stride: number): number {
    const { rows, unit } = this.world;
    const near = w[0] * rows[at] + w[1] * rows[at + stride];
    return (near + w[2] * rows[at + 2 * stride] + w[3] * rows[at + 3 * stride]) * unit;
  }

  private body(walker: number, slot: number, u: number, crossing: number, ahead: number) {
    const { gait, identity } = this.world;
    if (!gait) return { heading: ahead, phase: 0 };
    const at = gait.tracks[walker] + slot;
    const steps = (gait.steps[at] + (gait.steps[at + 1] - gait.steps[at]) * u) / 512;
    const turn = ((gait.headings[at + 1] - gait.headings[at]) << 16) >> 16;
    const phase = gait.crossingPhases[crossing] + steps * gait.paces[identity.cycle[crossing]];
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

  private laneBegin(index: number): number {
    return index === 0 ? 0 : this.world.laneEnds[index - 1];
  }

  private stride(page: number): number {
    const { laneEnds, kinds } = this.world;
    return 2 * ((laneEnds[(page + 1) * kinds.length - 1] ?? 0) - this.laneBegin(page * kinds.length));
  }
}
