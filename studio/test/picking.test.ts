import { describe, expect, it } from "vitest";
import { pickPerson, rayCapsule } from "../src/crowd/capsules";
import type { Vec3 } from "../src/crowd/model";
import { readCrowd } from "../src/crowd/reader";
import { Pose, samplePose } from "../src/crowd/sample";
import { fixtureCrowd } from "./fixture";

const INFINITY = Number.POSITIVE_INFINITY;

describe("a ray and a capsule", () => {
  const [a, b]: Vec3[] = [
    [0, 0, 0],
    [0, 2, 0],
  ];
  it("meets the side, the caps, or nothing", () => {
    expect(rayCapsule([-5, 1, 0], [1, 0, 0], a, b, 0.5)).toBeCloseTo(4.5);
    expect(rayCapsule([0, 9, 0], [0, -1, 0], a, b, 0.5)).toBeCloseTo(6.5);
    expect(rayCapsule([-5, 2.3, 0], [1, 0, 0], a, b, 0.5)).toBeCloseTo(5 - 0.4);
    expect(rayCapsule([-5, 2.6, 0], [1, 0, 0], a, b, 0.5)).toBe(INFINITY);
    expect(rayCapsule([-5, 1, 0], [-1, 0, 0], a, b, 0.5)).toBe(INFINITY);
  });

  it("agrees with marching along the ray", () => {
    let seed = 1;
    const random = () => {
      seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
      return (seed / 2 ** 31 - 1) * 2;
    };
    let hits = 0;
    for (let i = 0; i < 200; i++) {
      const [p, q]: Vec3[] = [
        [random(), random(), random()],
        [random(), random(), random()],
      ];
      const origin: Vec3 = [-8, random(), random()];
      const to = [random() + 8, random(), random()];
      const length = Math.hypot(...to);
      const direction = to.map((v) => v / length) as unknown as Vec3;
      let t = 0;
      for (let step = 0; step < 400 && t < 30; step++)
        t +=
          distance(
            origin.map((v, k) => v + direction[k] * t),
            p,
            q,
          ) - 0.4;
      const found = rayCapsule(origin, direction, p, q, 0.4);
      if (t < 29) {
        hits++;
        expect(found).toBeCloseTo(t, 2);
      } else expect(found).toBe(INFINITY);
    }
    expect(hits).toBeGreaterThan(20);
  });
});

function distance(x: number[], a: Vec3, b: Vec3): number {
  const ab = b.map((v, k) => v - a[k]);
  const ax = x.map((v, k) => v - a[k]);
  const t = ab.reduce((s, v, k) => s + v * ax[k], 0) / ab.reduce((s, v) => s + v * v, 0);
  return Math.hypot(...ax.map((v, k) => v - ab[k] * Math.min(Math.max(t, 0), 1)));
}

describe("picking", () => {
  const crowd = readCrowd(fixtureCrowd({ people: 12 }).bytes);

  it("finds everybody from above, and from above nobody beside them", () => {
    const pose = new Pose(crowd.joints.length);
    for (let person = 0; person < 12; person++) {
      samplePose(crowd, person, 2, pose);
      const head = 13 * 3;
      const above: Vec3 = [pose.positions[head], 9, pose.positions[head + 2]];
      expect(pickPerson(crowd, 2, above, [0, -1, 0])).toBe(person);
      expect(pickPerson(crowd, 2, [above[0], 109, above[2]], [0, -1, 0], 100)).toBe(person);
    }
    expect(pickPerson(crowd, 2, [50, 9, 50], [0, -1, 0])).toBeNull();
    expect(pickPerson(crowd, 99, [0, 9, 0], [0, -1, 0])).toBeNull();
  });

  it("finds the nearer of two in line", () => {
    const pose = new Pose(crowd.joints.length);
    const chest = (person: number): Vec3 => {
      samplePose(crowd, person, 4.8, pose);
      return Array.from(pose.positions.subarray(11 * 3, 11 * 3 + 3)) as unknown as Vec3;
    };
    const [a, b] = [chest(0), chest(1)];
    const ray = (from: Vec3, to: Vec3): [Vec3, Vec3] => {
      const d = to.map((v, k) => v - from[k]);
      const length = Math.hypot(...d);
      const unit = d.map((v) => v / length) as unknown as Vec3;
      return [from.map((v, k) => v - unit[k] * 0.8) as unknown as Vec3, unit];
    };
    expect(pickPerson(crowd, 4.8, ...ray(a, b))).toBe(0);
    expect(pickPerson(crowd, 4.8, ...ray(b, a))).toBe(1);
  });
});
