/** The page's address parameters, for pictures that can be made again. */

import { COLOR_MODES, type ColorMode, OUTLINES, type Outlines, VIEWS, type View } from "./store";

export interface Parameters {
  crowd: string;
  report: string;
  t: number;
  view: View;
  color: ColorMode;
  outlines: Outlines;
  bodies: boolean;
  /** Around a crowd whose ground repeats. */
  tiles: boolean;
  person: number | null;
  /** Name of the kind of a patch set to begin with. */
  kind: string | null;
  follow: boolean;
  paused: boolean;
  /** Panels hidden: only the picture. */
  bare: boolean;
}

/** Parameters from a query string; what is missing or makes no sense has its default. */
export function readParameters(query: string): Parameters {
  const q = new URLSearchParams(query);
  const one = <T extends string>(name: string, options: readonly T[], fallback: T): T => {
    const value = q.get(name) as T | null;
    return value !== null && options.includes(value) ? value : fallback;
  };
  const number = (name: string) => {
    const value = Number.parseFloat(q.get(name) ?? "");
    return Number.isFinite(value) && value >= 0 ? value : null;
  };
  const person = number("person");
  const crowd = q.get("crowd") ?? "/data/crowd.crowd";
  return {
    crowd,
    report: q.get("report") ?? new URL("report.json", new URL(crowd, "http://x/")).pathname,
    t: number("t") ?? 0,
    view: one("view", VIEWS, "persp"),
    color: one("color", COLOR_MODES, "character"),
    outlines: one("outlines", OUTLINES, "shared"),
    bodies: q.get("bodies") !== "0",
    tiles: q.get("tiles") === "1",
    kind: q.get("kind"),
    person: person === null ? null : Math.floor(person),
    follow: q.get("follow") === "1",
    paused: q.get("paused") === "1",
    bare: q.get("bare") === "1",
  };
}
