/** Footprints, and the feet between them: the same as src/stage/world/gait/feet.rs. */

import type { Foot, Gait } from "./model";
import type { At, Instant, Walks } from "./walks";

/** Who takes small steps lifts feet by this share of them, and by at most so many metres. */
const [SMALL_STEP, SMALL_LIFT] = [0.25, 0.03];

export class Feet {
  constructor(
    private readonly gait: Gait,
    private readonly walks: Walks,
  ) {}

  /** Both feet of somebody who is `here`, relative to the patch's origin. */
  of(at: At, here: readonly number[], speed: number, phase: number): [Foot, Foot] {
    const foot = (index: number): Foot => {
      const since = phase - 0.5 * index < 0 ? phase - 0.5 * index + 1 : phase - 0.5 * index;
      const [share, height] = this.swing(speed, index, since);
      const print = (cycles: number) => this.print(index, this.walks.later(at, cycles), here);
      if (share <= 0 || share >= 1) return { ...print(share <= 0 ? -since : 1 - since), y: height };
      const [a, b] = [print(-since), print(1 - since)];
      const far = Math.hypot(a.x - b.x, a.z - b.z) + 0.1 * Math.hypot(a.sin - b.sin, a.cos - b.cos);
      const [low, fast] = between(this.gait.speeds, speed);
      const slow = low === 0 ? 1 - fast : 0;
      const lift = Math.min(far * SMALL_STEP, SMALL_LIFT) * slow * 4 * share * (1 - share);
      const mix = (p: number, q: number) => p + (q - p) * share;
      const [x, z] = [mix(a.x, b.x), mix(a.z, b.z)];
      return { x, y: height + lift, z, sin: mix(a.sin, b.sin), cos: mix(a.cos, b.cos) };
    };
    return [foot(0), foot(1)];
  }

  /** Share of the way to the next footprint, and height, so far after the middle of the stance (0 to 1). */
  private swing(speed: number, foot: number, since: number): [number, number] {
    const { phases, speeds, swings } = this.gait;
    if (!swings) return [0, 0];
    const first = Math.min(Math.floor(since * phases), phases - 1);
    const late = since * phases - first;
    const [low, fast] = between(speeds, speed);
    const value = (cycle: number, pose: number, what: number) =>
      swings[((cycle * phases + pose) * 2 + foot) * 2 + what];
    const of = (cycle: number, what: number) => {
      const from = value(cycle, first, what);
      const last = what === 0 ? 1 : value(cycle, 0, 1);
      return from + ((first + 1 < phases ? value(cycle, first + 1, what) : last) - from) * late;
    };
    const mix = (what: number) => of(low, what) + (of(low + 1, what) - of(low, what)) * fast;
    return [mix(0), mix(1)];
  }

  /** Where a foot stands in the middle of its stance. */
  private print(foot: number, { x, z, speed, sin, cos }: Instant, here: readonly number[]): Foot {
    const { speeds, prints } = this.gait;
    const [low, fast] = between(speeds, speed);
    const value = (axis: number) => {
      const [a, b] = [low, low + 1].map((cycle) => prints?.[(cycle * 2 + foot) * 2 + axis] ?? 0);
      return a + (b - a) * fast;
    };
    const [left, ahead] = [value(0), value(1)];
    return { x: x + cos * left + sin * ahead - here[0], y: 0, z: z - sin * left + cos * ahead - here[1], sin, cos };
  }
}

/** The cycle below a speed, and how far it is to the next. */
export function between(speeds: Float32Array, speed: number): [number, number] {
  let low = 0;
  while (low + 2 < speeds.length && speeds[low + 1] <= speed) low++;
  return [low, Math.min(Math.max((speed - speeds[low]) / (speeds[low + 1] - speeds[low]), 0), 1)];
}
