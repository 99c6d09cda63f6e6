import { describe, expect, it } from "vitest";
import { bounds, convexHull, cross, roundedHull } from "../src/crowd/hull";
import type { Vec2 } from "../src/crowd/model";
import { readCrowd } from "../src/crowd/reader";
import { hulls } from "../src/draw/outlines";
import { band, fan } from "../src/draw/strips";
import { fixtureCrowd } from "./fixture";

let seed = 5;
const random = () => {
  seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
  return (seed / 2 ** 32) * 4 - 2;
};
const inside = (hull: readonly Vec2[], p: Vec2) =>
  hull.every((a, i) => cross(a, hull[(i + 1) % hull.length], p) >= -1e-9);

describe("hulls", () => {
  it("are convex, hold all points, and are made of them", () => {
    for (let round = 0; round < 50; round++) {
      const points = Array.from({ length: 3 + round }, (): Vec2 => [random(), random()]);
      const hull = convexHull(points);
      for (const p of points) expect(inside(hull, p)).toBe(true);
      for (const p of hull) expect(points).toContainEqual(p);
    }
  });

  it("survive one point, equal points, and points in a line", () => {
    expect(convexHull([[1, 2]])).toEqual([[1, 2]]);
    expect(
      convexHull([
        [1, 2],
        [1, 2],
        [1, 2],
      ]),
    ).toHaveLength(1);
    expect(
      convexHull([
        [0, 0],
        [1, 1],
        [2, 2],
        [3, 3],
      ]),
    ).toEqual([
      [0, 0],
      [3, 3],
    ]);
    expect(roundedHull([[1, 2]], 0.5)).toHaveLength(16);
  });

  it("keep clear of the points when rounded", () => {
    const points = Array.from({ length: 12 }, (): Vec2 => [random(), random()]);
    const hull = roundedHull(points, 0.5);
    const clearance = 0.5 * Math.cos(Math.PI / 16) - 1e-9;
    for (const p of points) {
      for (const [i, a] of hull.entries()) {
        const b = hull[(i + 1) % hull.length];
        expect(cross(a, b, p) / Math.hypot(b[0] - a[0], b[1] - a[1])).toBeGreaterThanOrEqual(clearance);
      }
    }
    const { low, high } = bounds(points);
    expect(bounds(hull).low[0]).toBeCloseTo(low[0] - 0.5);
    expect(bounds(hull).high[1]).toBeCloseTo(high[1] + 0.5);
  });

  it("turn into triangles that face up and cover the right area", () => {
    const square: Vec2[] = [
      [0, 0],
      [2, 0],
      [2, 2],
      [0, 2],
    ];
    const area = (t: number[]) => {
      let sum = 0;
      for (let i = 0; i < t.length; i += 9) {
        const up = (t[i + 5] - t[i + 2]) * (t[i + 6] - t[i]) - (t[i + 3] - t[i]) * (t[i + 8] - t[i + 2]);
        expect(up).toBeGreaterThanOrEqual(0);
        sum += up / 2;
      }
      return sum;
    };
    expect(area(fan(square, 0))).toBeCloseTo(4);
    expect(area(band(square, 0.1, 0))).toBeCloseTo(4 - 1.8 ** 2);
  });

  it("of a crowd's patches hold everybody who is in them, while they are", () => {
    const crowd = readCrowd(fixtureCrowd({ people: 12 }).bytes);
    const byInstance = new Map(hulls(crowd).map((h) => [h.instance, h]));
    for (const c of crowd.characters) {
      for (const f of c.fragments) {
        const hull = byInstance.get(f.instance);
        if (!hull) continue;
        expect(hull.begin).toBeGreaterThanOrEqual(0);
        expect(hull.end).toBeLessThanOrEqual(crowd.lastFrame);
        for (let frame = Math.max(f.begin, 0); frame <= Math.min(f.end, crowd.lastFrame); frame += 4) {
          const at = (c.firstFrame + frame) * 3;
          expect(inside(hull.outline, [crowd.root[at], crowd.root[at + 2]])).toBe(true);
        }
      }
    }
  });
});
