/** Convex hulls on the ground. */

import type { Vec2 } from "./model";

/** Convex hull, counter-clockwise with x right and z up (Andrew's monotone chain). O(n log n). */
export function convexHull(points: readonly Vec2[]): Vec2[] {
  const sorted = [...points]
    .sort((a, b) => a[0] - b[0] || a[1] - b[1])
    .filter((p, i, all) => i === 0 || p[0] !== all[i - 1][0] || p[1] !== all[i - 1][1]);
  if (sorted.length < 3) return sorted;
  const half = (source: readonly Vec2[]): Vec2[] => {
    const out: Vec2[] = [];
    for (const p of source) {
      while (out.length >= 2 && cross(out[out.length - 2], out[out.length - 1], p) <= 0) out.pop();
      out.push(p);
    }
    out.pop();
    return out;
  };
  return [...half(sorted), ...half(sorted.reverse())];
}

/** The hull of discs of `radius` around the points: an outline that keeps clear of the paths, with round corners. */
export function roundedHull(points: readonly Vec2[], radius: number, corners = 16): Vec2[] {
  const around = convexHull(points).flatMap(([x, z]) =>
    Array.from({ length: corners }, (_, i): Vec2 => {
      const angle = (i / corners) * Math.PI * 2;
      return [x + radius * Math.cos(angle), z + radius * Math.sin(angle)];
    }),
  );
  return convexHull(around);
}

/** Twice the signed area of the triangle a, b, c: positive if it turns left (x right, z up). */
export function cross(a: Vec2, b: Vec2, c: Vec2): number {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/** Lower and upper corner of the bounding box. */
export function bounds(points: readonly Vec2[]): { low: [number, number]; high: [number, number] } {
  const low: [number, number] = [Number.POSITIVE_INFINITY, Number.POSITIVE_INFINITY];
  const high: [number, number] = [Number.NEGATIVE_INFINITY, Number.NEGATIVE_INFINITY];
  for (const p of points) {
    for (const axis of [0, 1]) {
      low[axis] = Math.min(low[axis], p[axis]);
      high[axis] = Math.max(high[axis], p[axis]);
    }
  }
  return { low, high };
}
