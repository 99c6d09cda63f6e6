/** Ways of people over borders, counted in steps: the same as src/stage/world/gait/walks.rs. */

import type { Gait, Place, World } from "./model";
import { type Rows, weights } from "./sample";

const FAR = 64;
const STEPS_PER_CYCLE = 512;

/** Somebody in a patch: number `own` of its walkers, in a slot of its stay. */
export interface At {
  place: Place;
  own: number;
  slot: number;
  u: number;
}

/** How somebody is at a step. */
export interface Instant {
  x: number;
  z: number;
  speed: number;
  sin: number;
  cos: number;
}

/** Crossings before and after every crossing: stays follow each other without a gap. */
export function linked(world: World): Int32Array {
  const { identity } = world;
  const cycles = new Map<number, [number, number, number][]>();
  for (const place of world.places) {
    const kind = world.kinds[place.kind];
    for (let own = 0; own < kind.walkers; own++) {
      const [crossing, walker] = [place.firstCrossing + own, kind.firstWalker + own];
      const [enter, leave] = [world.stays[2 * walker], world.stays[2 * walker + 1]];
      const stays = cycles.get(identity.cycle[crossing]) ?? [];
      const when = identity.laps[crossing] * world.slots + enter - place.phase;
      if (leave > enter) stays.push([when, crossing, leave - enter]);
      cycles.set(identity.cycle[crossing], stays);
    }
  }
  const links = new Int32Array(2 * identity.cycle.length).fill(-1);
  for (const [cycle, stays] of cycles) {
    stays.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
    const around = identity.people[cycle] * world.slots;
    if (around > 0 && stays.length > 0) stays.push([stays[0][0] + around, stays[0][1], stays[0][2]]);
    for (let i = 0; i + 1 < stays.length; i++) {
      if (stays[i][0] + stays[i][2] !== stays[i + 1][0]) continue;
      links[2 * stays[i][1] + 1] = stays[i + 1][1];
      links[2 * stays[i + 1][1]] = stays[i][1];
    }
  }
  return links;
}

/** A stay, its patch's origin relative to that of the patch it is seen from. */
interface Stay {
  place: Place;
  own: number;
  walker: number;
  crossing: number;
  slots: number;
  x: number;
  z: number;
}

export class Walks {
  private readonly gait: Gait;

  constructor(
    private readonly world: World,
    private readonly rows: Rows,
  ) {
    if (!world.gait) throw new Error("a world without bodies");
    this.gait = world.gait;
  }

  /** How somebody is `cycles` of two steps later (earlier if negative), seen from its patch. */
  later(at: At, cycles: number): Instant {
    const { gait } = this;
    let stay = this.stay(at.place, at.own, 0, 0);
    let slot = at.slot;
    const begin = gait.tracks[stay.walker] + slot;
    const now = gait.steps[begin] + (gait.steps[begin + 1] - gait.steps[begin]) * at.u;
    const pace = gait.paces[stay.crossing];
    let target = now + (cycles * STEPS_PER_CYCLE) / pace;
    for (let i = 0; i < FAR; i++) {
      const track = gait.tracks[stay.walker] + slot;
      const side = target > gait.steps[track + 1] ? 1 : 0;
      if (side === 0 && target >= gait.steps[track]) break;
      const on = side === 1 ? slot + 1 : slot - 1;
      if (on >= 0 && on < stay.slots) {
        slot = on;
        continue;
      }
      const next = this.neighbour(stay, side);
      if (!next) break;
      const whole = side === 1 ? stay : next;
      const taken = gait.steps[gait.tracks[whole.walker] + whole.slots];
      // What is left goes by the pace of the next stay.
      const faster = gait.paces[stay.crossing] / gait.paces[next.crossing];
      target = side === 1 ? (target - taken) * faster : taken + target * faster;
      slot = side === 1 ? 0 : next.slots - 1;
      stay = next;
    }
    const track = gait.tracks[stay.walker] + slot;
    const [from, to] = [gait.steps[track], gait.steps[track + 1]];
    return this.instant(stay, slot, (target - from) / Math.max(to - from, 1));
  }

  private stay(place: Place, own: number, x: number, z: number): Stay {
    const { kinds, stays } = this.world;
    const walker = kinds[place.kind].firstWalker + own;
    const slots = Math.max(stays[2 * walker + 1] - stays[2 * walker], 0);
    return { place, own, walker, crossing: place.firstCrossing + own, slots, x, z };
  }

  /** The stay before (`side` 0) or after (1). */
  private neighbour(stay: Stay, side: number): Stay | null {
    const { identity, repeat, slots, stays } = this.world;
    const to = this.gait.links[2 * stay.crossing + side] ?? -1;
    if (to < 0) return null;
    const place = this.placeOf(to);
    const next = this.stay(place, to - place.firstCrossing, 0, 0);
    const when = (s: Stay) => identity.laps[s.crossing] * slots + stays[2 * s.walker] - s.place.phase;
    const [now, then] = [when(stay), when(next)];
    const rounds = side === 1 ? Number(then <= now) : -Number(then >= now);
    const cycle = identity.cycle[to];
    const copies = (axis: number) =>
      identity.copies[2 * to + axis] -
      identity.copies[2 * stay.crossing + axis] +
      rounds * identity.around[2 * cycle + axis];
    next.x = stay.x + place.x - stay.place.x + (repeat ? copies(0) * repeat[0] : 0);
    next.z = stay.z + place.z - stay.place.z + (repeat ? copies(1) * repeat[1] : 0);
    return next;
  }

  private placeOf(crossing: number): Place {
    const { places } = this.world;
    let [low, high] = [0, places.length];
    while (low + 1 < high) {
      const middle = (low + high) >> 1;
      if (places[middle].firstCrossing <= crossing) low = middle;
      else high = middle;
    }
    return places[low];
  }

  /** How somebody is at a share of a slot of a stay; straight on, before and after what is known of it. */
  private instant(stay: Stay, slot: number, share: number): Instant {
    const { gait, world } = this;
    const inside = Math.min(Math.max(share, 0), 1);
    const own = world.stays[2 * stay.walker] + slot;
    const track = gait.tracks[stay.walker] + slot;
    const turn = ((gait.headings[track + 1] - gait.headings[track]) << 16) >> 16;
    const heading = ((gait.headings[track] + turn * inside) * Math.PI) / 32768 - stay.place.turn;
    const [sin, cos] = [Math.sin(heading), Math.cos(heading)];
    const { first, lanes, base, stride } = this.rows.of(stay.place.kind, own % world.slots);
    const wanted = stay.own + 65536 * Math.floor(own / world.slots);
    const lane = world.lanes.subarray(first, first + lanes).indexOf(wanted);
    if (lane < 0) return { x: stay.x, z: stay.z, speed: 0, sin, cos };
    const w = weights(inside, world.slots / world.period);
    const beyond = ((share - inside) * world.period) / world.slots;
    const sum = (weight: readonly number[], axis: number) => this.rows.sum(weight, base + lane + axis * lanes, stride);
    const [vx, vz] = [sum(w.velocity, 0), sum(w.velocity, 1)];
    const [x, z] = [sum(w.place, 0) + vx * beyond, sum(w.place, 1) + vz * beyond];
    const [c, s] = [Math.cos(stay.place.turn), Math.sin(stay.place.turn)];
    return { x: c * x - s * z + stay.x, z: s * x + c * z + stay.z, speed: Math.hypot(vx, vz), sin, cos };
  }
}
