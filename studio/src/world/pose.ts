/** Full bodies out of the gait table: joints' places and rotations, blended by speed and phase as in src/stage/world/gait. */

import { lead } from "./leg";
import type { Gait } from "./model";
import { added, times, turned } from "./quaternion";
import type { Walker } from "./sample";

export class Poser {
  private readonly local: Float32Array;
  private readonly count: number;

  constructor(private readonly gait: Gait) {
    this.count = gait.joints.length;
    this.local = new Float32Array(4 * this.count);
  }

  /** Writes x, y, z, 1 of every joint into `places` and its rotation into `turns`, from number `at` on. */
  pose(walker: Walker, places: Float32Array, turns: Float32Array, at: number): void {
    const hips = this.blend(walker.speed, walker.phase);
    const half = walker.heading / 2;
    const [sin, cos] = [Math.sin(walker.heading), Math.cos(walker.heading)];
    const heading = [0, Math.sin(half), 0, Math.cos(half)];
    if (walker.feet) {
      const root = [cos * hips[0] + sin * hips[2], hips[1], cos * hips[2] - sin * hips[0]] as const;
      hips[1] -= lead(this.gait.joints, this.local, root, heading, [sin, cos], walker.feet);
    }
    for (let j = 0; j < this.count; j++) {
      const { parent, offset } = this.gait.joints[j];
      const own = this.local.subarray(4 * j, 4 * j + 4);
      const into = at + 4 * j;
      const from = at + 4 * parent;
      const base = parent < 0 ? heading : turns.subarray(from, from + 4);
      times(base, own, turns, into);
      const place =
        parent < 0
          ? [walker.x + cos * hips[0] + sin * hips[2], hips[1], walker.z - sin * hips[0] + cos * hips[2]]
          : added(places, from, turned(base, offset));
      places.set(place, into);
      places[into + 3] = 1;
    }
  }

  /** Local rotations at a speed and phase; returns the hips. */
  private blend(speed: number, phase: number): [number, number, number] {
    const { speeds, phases, rotations, hips } = this.gait;
    let low = 0;
    while (low + 2 < speeds.length && speeds[low + 1] <= speed) low++;
    const fast = Math.min(Math.max((speed - speeds[low]) / (speeds[low + 1] - speeds[low]), 0), 1);
    const first = Math.min(Math.floor(phase * phases), phases - 1);
    const late = phase * phases - first;
    const next = (first + 1) % phases;
    const of = [low * phases + first, low * phases + next, (low + 1) * phases + first, (low + 1) * phases + next];
    const weights = [(1 - fast) * (1 - late), (1 - fast) * late, fast * (1 - late), fast * late];
    const n = 4 * this.count;
    for (let i = 0; i < n; i++) {
      this.local[i] = weights.reduce((sum, w, k) => sum + w * rotations[of[k] * n + i], 0);
    }
    for (let i = 0; i < n; i += 4) {
      const length = Math.hypot(this.local[i], this.local[i + 1], this.local[i + 2], this.local[i + 3]) || 1;
      for (let k = 0; k < 4; k++) this.local[i + k] /= length;
    }
    const place = (axis: number) => weights.reduce((sum, w, k) => sum + w * hips[of[k] * 3 + axis], 0);
    return [place(0), place(1), place(2)];
  }
}
