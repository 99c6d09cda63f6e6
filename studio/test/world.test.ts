/** Worlds read and played by the viewer are those of the Rust core: a committed file and what it plays. */

import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { Poser } from "../src/world/pose";
import { readWorld } from "../src/world/reader";
import { Sampler, type Walker } from "../src/world/sample";

const FILES = new URL("../../tests/files/", import.meta.url);
const file = readFileSync(new URL("v1.world", FILES));
const bytes = file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength) as ArrayBuffer;
const golden = JSON.parse(readFileSync(new URL("v1.world.json", FILES), "utf8")) as {
  time: number;
  places: number[][];
  joints: number[][];
}[];

function everybody(time: number, world = readWorld(bytes)): Walker[] {
  const sampler = new Sampler(world);
  const people: Walker[] = [];
  for (const place of world.places) sampler.patch(place, time, [0, 0], [0, 0], people);
  return people;
}

describe("a world", () => {
  it("plays what the core plays, at any time", () => {
    for (const { time, places } of golden) {
      const people = everybody(time);
      expect(people.length).toBe(places.length);
      for (const [i, { x, z }] of people.entries()) {
        expect(x).toBeCloseTo(places[i][0], 3);
        expect(z).toBeCloseTo(places[i][1], 3);
      }
    }
  });

  it("has bodies like the core's", () => {
    const { gait } = readWorld(bytes);
    if (!gait) throw new Error("the fixture has bodies");
    const poser = new Poser(gait);
    const n = gait.joints.length;
    const [places, turns] = [new Float32Array(4 * n), new Float32Array(4 * n)];
    for (const { time, joints } of golden) {
      // Everybody of the first copy is among those near, about the origin.
      for (const walker of everybody(time)) {
        poser.pose(walker, places, turns, 0);
        const hips = [places[0], places[1], places[2]];
        const gap = (row: number[]) => Math.hypot(row[0] - hips[0], row[1] - hips[1], row[2] - hips[2]);
        const same = joints.filter((row) => gap(row) < 5e-3);
        if (same.length === 0) continue;
        const far = same.map((row) =>
          Math.max(
            ...Array.from({ length: 3 * n }, (_, i) => Math.abs(row[i] - places[4 * Math.floor(i / 3) + (i % 3)])),
          ),
        );
        expect(Math.min(...far)).toBeLessThan(0.01);
      }
    }
  });

  it("puts feet where the core does", () => {
    const golden = new URL("golden/", import.meta.url);
    const file = readFileSync(new URL("feet.world", golden));
    const world = readWorld(file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength) as ArrayBuffer);
    if (!world.gait?.prints) throw new Error("the golden world has footprints");
    const poser = new Poser(world.gait);
    const n = world.gait.joints.length;
    const [places, turns] = [new Float32Array(4 * n), new Float32Array(4 * n)];
    const expected = JSON.parse(readFileSync(new URL("feet.json", golden), "utf8")) as {
      time: number;
      joints: number[][];
    }[];
    for (const { time, joints } of expected) {
      const people = everybody(time, world);
      expect(people.length).toBe(joints.length);
      for (const [i, walker] of people.entries()) {
        poser.pose(walker, places, turns, 0);
        const far = joints[i].map((v, k) => Math.abs(v - places[4 * Math.floor(k / 3) + (k % 3)]));
        expect(Math.max(...far)).toBeLessThan(1e-3);
      }
    }
  });

  it("knows people again a moment later", () => {
    const [now, later] = [everybody(12.3), everybody(12.35)];
    expect(new Set(now.map((w) => w.id)).size).toBe(now.length);
    const stayed = now.filter((w) => later.some((l) => l.id === w.id && Math.hypot(l.x - w.x, l.z - w.z) < 0.12));
    expect(stayed.length).toBeGreaterThan(now.length * 0.85);
  });

  it("is refused when cut or changed", () => {
    for (let cut = 0; cut < bytes.byteLength; cut += 997) expect(() => readWorld(bytes.slice(0, cut))).toThrow();
    const changed = bytes.slice(0);
    new Uint8Array(changed)[8] = 9;
    expect(() => readWorld(changed)).toThrow("version");
  });
});
