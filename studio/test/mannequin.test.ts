import { describe, expect, it } from "vitest";
import { readCrowd } from "../src/crowd/reader";
import { buildMannequin, restPositions } from "../src/draw/mannequin";
import { lookOf, looksOf, PART_COUNT } from "../src/draw/palette";
import { fixtureCrowd } from "./fixture";
import looks from "./looks.json";

const { joints } = readCrowd(fixtureCrowd({ people: 1, secs: 1 }).bytes);

describe.each([1, 0.6, 0.45])("the mannequin at detail %f", (detail) => {
  const made = buildMannequin(joints, detail);
  const vertices = made.positions.length / 3;
  const vertex = (v: number) => Array.from(made.positions.subarray(v * 3, v * 3 + 3));

  it("stands 1.75 m tall on the ground, arms out", () => {
    const span = (axis: number) => {
      const values = Array.from({ length: vertices }, (_, v) => made.positions[v * 3 + axis]);
      return [Math.min(...values), Math.max(...values)];
    };
    expect(span(1)[0]).toBeCloseTo(0, 3);
    expect(span(1)[1]).toBeGreaterThan(1.73);
    expect(span(1)[1]).toBeLessThan(1.79);
    expect(span(0)[1]).toBeCloseTo(0.875, 1);
    expect(span(0)[0]).toBeCloseTo(-0.875, 1);
  });

  it("is small enough for crowds, and every index is inside", () => {
    expect(made.indices.length / 3).toBeLessThan(6000 * detail + 500);
    expect(Math.max(...made.indices)).toBeLessThan(vertices);
    expect(vertices).toBeLessThan(65536);
  });

  it("has weights that add up and normals of unit length", () => {
    for (let v = 0; v < vertices; v++) {
      const w = made.weights.subarray(v * 4, v * 4 + 4);
      expect(w.reduce((a, b) => a + b, 0)).toBeCloseTo(1, 5);
      expect(Math.hypot(...made.normals.subarray(v * 3, v * 3 + 3))).toBeCloseTo(1, 4);
      expect(made.parts[v]).toBeLessThan(PART_COUNT);
    }
  });

  it("hangs every vertex on joints near it", () => {
    const rest = restPositions(joints);
    for (let v = 0; v < vertices; v++) {
      for (let k = 0; k < 4; k++) {
        if (made.weights[v * 4 + k] < 0.05) continue;
        const joint = rest[made.bones[v * 4 + k]];
        const d = Math.hypot(...vertex(v).map((x, a) => x - joint[a]));
        expect(d).toBeLessThan(0.48);
      }
    }
  });

  it("is symmetric", () => {
    const key = (v: number, sign: number) =>
      vertex(v)
        .map((x, a) => Math.round((a === 0 ? sign * x : x) * 2000))
        .join();
    const all = new Set(Array.from({ length: vertices }, (_, v) => key(v, 1)));
    const lone = Array.from({ length: vertices }, (_, v) => key(v, -1)).filter((k) => !all.has(k));
    // Lofts with an odd number of sides (nose, ears, thumbs) need not have mirrored vertices.
    expect(lone.length / vertices).toBeLessThan(detail === 1 ? 0.08 : 0.6);
  });
});

describe("looks", () => {
  it("belong to the person and differ", () => {
    expect(looksOf(3)).toEqual(looksOf(3));
    const different = new Set(Array.from({ length: 50 }, (_, i) => looksOf(i).join()));
    expect(different.size).toBeGreaterThan(45);
    expect(looksOf(0)).toHaveLength(PART_COUNT * 4);
  });

  it("are the same as in exported files", () => {
    for (const [i, expected] of looks.entries()) {
      const [person, team] = i < 40 ? [i, null] : [i - 40, i - 40];
      const found = lookOf(person, team).map((color) => (color === null ? null : Number.parseInt(color.slice(1), 16)));
      expect(found).toEqual(expected);
    }
  });

  it("need the canonical joints", () => {
    expect(() => buildMannequin(joints.slice(0, 10))).toThrow('the skeleton has no joint "spine1"');
  });
});
