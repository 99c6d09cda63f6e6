/** The clock: turns real time into crowd time. Pure, so that tests need no browser. */

import { duration } from "../crowd/model";
import type { Store } from "../store";

export const SPEEDS: readonly number[] = [0.25, 0.5, 1, 2];

/** Where `time + step` lands in [0, end]: wrapped if `loop`, else held at the end. */
export function advance(time: number, step: number, end: number, loop: boolean): { time: number; ended: boolean } {
  const next = time + step;
  if (next <= end && next >= 0) return { time: next, ended: false };
  if (loop && end > 0) return { time: ((next % end) + end) % end, ended: false };
  return { time: Math.min(Math.max(next, 0), end), ended: true };
}

/** The time of the frame `steps` frames after the one at or next to `time`. */
export function stepFrame(time: number, steps: number, fps: number, end: number): number {
  const frame = time * fps;
  const nearest = Math.round(frame);
  // Between frames, the first step goes to the neighbour on that side.
  const onFrame = Math.abs(frame - nearest) < 1e-4;
  const base = onFrame ? nearest : steps > 0 ? Math.floor(frame) : Math.ceil(frame);
  return Math.min(Math.max((base + steps) / fps, 0), end);
}

/** `m:ss.ff` with the frame number after the dot. */
export function clockText(time: number): string {
  const minutes = Math.floor(time / 60);
  const seconds = time - minutes * 60;
  return `${minutes}:${seconds.toFixed(2).padStart(5, "0")}`;
}

export class Player {
  constructor(private readonly store: Store) {}

  private get end(): number {
    const crowd = this.store.get("crowd");
    return crowd ? duration(crowd) : 0;
  }

  /** Called once per picture with the real seconds since the last one. */
  tick(seconds: number): void {
    if (!this.store.get("playing")) return;
    // A hidden tab makes one huge step when it comes back.
    const step = Math.min(seconds, 0.25) * this.store.get("speed");
    const { time, ended } = advance(this.store.get("time"), step, this.end, this.store.get("loop"));
    this.store.set("time", time);
    if (ended) this.store.set("playing", false);
  }

  toggle(): void {
    const playing = !this.store.get("playing");
    if (playing && this.store.get("time") >= this.end) this.store.set("time", 0);
    this.store.set("playing", playing);
  }

  seek(time: number): void {
    this.store.set("time", Math.min(Math.max(time, 0), this.end));
  }

  step(frames: number): void {
    const crowd = this.store.get("crowd");
    if (!crowd) return;
    this.store.set("playing", false);
    this.store.set("time", stepFrame(this.store.get("time"), frames, crowd.fps, this.end));
  }

  faster(direction: 1 | -1): void {
    const at = SPEEDS.indexOf(this.store.get("speed")) + direction;
    this.store.set("speed", SPEEDS[Math.min(Math.max(at, 0), SPEEDS.length - 1)]);
  }
}
