/** The one store: every long-lived state of the page. Setting a field emits an event of the field's name. */

import { Bus } from "./bus";
import type { Crowd } from "./crowd/model";
import type { Report } from "./report";

export type View = "persp" | "top" | "front" | "loom";
export type ColorMode = "character" | "kind" | "shared";
export type Outlines = "none" | "shared" | "all";
export const VIEWS: readonly View[] = ["persp", "top", "front", "loom"];
export const COLOR_MODES: readonly ColorMode[] = ["character", "kind", "shared"];
export const OUTLINES: readonly Outlines[] = ["none", "shared", "all"];

export interface State {
  crowd: Crowd | null;
  report: Report | null;
  /** Seconds on the crowd's clock. */
  time: number;
  playing: boolean;
  speed: number;
  loop: boolean;
  view: View;
  color: ColorMode;
  outlines: Outlines;
  /** Bodies are drawn. */
  bodies: boolean;
  /** Index of the selected person. */
  person: number | null;
  follow: boolean;
  problem: string | null;
}

/** Events beside the changes of state. */
export interface Signals {
  /** Something changed that is seen: draw again. */
  redraw: undefined;
  /** A click on the picture, in normalised device coordinates. */
  pick: { x: number; y: number };
  /** Go to a view even if it is the present one. */
  aim: View;
}

export type Events = State & Signals;

export class Store {
  readonly bus = new Bus<Events>();
  private readonly state: State = {
    crowd: null,
    report: null,
    time: 0,
    playing: false,
    speed: 1,
    loop: true,
    view: "persp",
    color: "character",
    outlines: "shared",
    bodies: true,
    person: null,
    follow: false,
    problem: null,
  };

  get<K extends keyof State>(key: K): State[K] {
    return this.state[key];
  }

  set<K extends keyof State>(key: K, value: State[K]): void {
    if (Object.is(this.state[key], value)) return;
    this.state[key] = value;
    // The bus cannot see that a key of State is a key of Events with the same payload.
    this.bus.emit(key, value as Events[K]);
    this.bus.emit("redraw", undefined);
  }

  /** A copy of all fields, for tests and debugging. */
  snapshot(): Omit<State, "crowd"> {
    const { crowd: _, ...rest } = this.state;
    return rest;
  }
}
