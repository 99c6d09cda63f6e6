/** The one store: every long-lived state of the page. Setting a field emits an event of the field's name. */

import { Bus } from "./bus";
import type { Crowd } from "./crowd/model";
import type { Report } from "./report";
import type { PatchSet } from "./set/model";

export type View = "persp" | "top" | "front" | "loom";
export type ColorMode = "character" | "kind" | "shared";
export type Outlines = "none" | "shared" | "all";
export const VIEWS: readonly View[] = ["persp", "top", "front", "loom"];
export const COLOR_MODES: readonly ColorMode[] = ["character", "kind", "shared"];
export const OUTLINES: readonly Outlines[] = ["none", "shared", "all"];

/** Which kinds of a set are listed. */
export interface Filter {
  /** All of them must occur in a kind's name, labels or pose groups. */
  words: string;
  /** 0 is any number; MANY is that or more. */
  people: number;
  mirrored: boolean;
}
export const MANY = 3;

export interface State {
  crowd: Crowd | null;
  report: Report | null;
  /** The patch set whose kinds are shown, each as a crowd of its own. */
  set: PatchSet | null;
  /** Index of the kind that is shown. */
  kind: number | null;
  filter: Filter;
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
  /** The tiles around a crowd whose ground repeats are drawn as well. */
  tiles: boolean;
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
    set: null,
    kind: null,
    filter: { words: "", people: 0, mirrored: false },
    time: 0,
    playing: false,
    speed: 1,
    loop: true,
    view: "persp",
    color: "character",
    outlines: "shared",
    bodies: true,
    tiles: false,
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

  /** A copy of all fields but the big ones, for tests and debugging. */
  snapshot(): Omit<State, "crowd" | "set"> {
    const { crowd: _, set: __, ...rest } = this.state;
    return rest;
  }
}
