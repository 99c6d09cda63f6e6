/** Obstacles of a crowd file: what they are and where they are when. */

import { FileProblem, finite, list, object } from "./container";
import type { Obstacle, Vec2, Waypoint } from "./model";

/** The obstacle of a header's value, whose corners have been read. */
export function obstacle(value: unknown, points: Vec2[], place: string): Obstacle {
  const v = object(value, place);
  const height = v.height === undefined || v.height === null ? null : finite(v.height, `${place}, height`);
  if (height !== null && height <= 0) throw new FileProblem(place, `expected a height above 0, found ${height}`);
  const path = (v.path === undefined ? [] : list(v.path, `${place}, path`)).map((w, i) =>
    waypoint(w, `${place}, ${i}`),
  );
  if (path.some((w, i) => i > 0 && w.secs <= path[i - 1].secs)) {
    throw new FileProblem(place, "expected way-points in order of time");
  }
  return { points, height, path };
}

function waypoint(value: unknown, place: string): Waypoint {
  const v = object(value, place);
  const [x, z] = list(v.position, `${place}, position`).map((n) => finite(n, `${place}, position`));
  if (x === undefined || z === undefined) throw new FileProblem(place, "expected a position of two numbers");
  return { secs: finite(v.secs, `${place}, secs`), position: [x, z], heading: finite(v.heading, `${place}, heading`) };
}

/** Where the origin of an obstacle's outline is at `secs`, and how it is turned: at rest before and after its path. */
export function placeOf({ path }: Obstacle, secs: number): { position: Vec2; heading: number } {
  if (path.length === 0) return { position: [0, 0], heading: 0 };
  const next = path.findIndex((w) => w.secs > secs);
  if (next === 0) return path[0];
  if (next < 0) return path[path.length - 1];
  const [a, b] = [path[next - 1], path[next]];
  const t = (secs - a.secs) / (b.secs - a.secs);
  const between = (p: number, q: number) => p + (q - p) * t;
  return {
    position: [between(a.position[0], b.position[0]), between(a.position[1], b.position[1])],
    heading: between(a.heading, b.heading),
  };
}
