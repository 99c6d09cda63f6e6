/** People who do something else than walk play what the Rust core plays: a committed file. */

import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { Actor, actors } from "../src/world/acts";
import { readWorld } from "../src/world/reader";
import type { Walker } from "../src/world/sample";

const FILES = new URL("../../tests/files/", import.meta.url);
const file = readFileSync(new URL("acts.world", FILES));
const bytes = file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength) as ArrayBuffer;
const golden = JSON.parse(readFileSync(new URL("acts.world.json", FILES), "utf8")) as {
  time: number;
  joints: number[];
}[];

describe("somebody who stays", () => {
  it("does what the core says, at any time", () => {
    const world = readWorld(bytes);
    if (!world.acts) throw new Error("the fixture has acts");
    const actor = new Actor(world.acts);
    const n = world.acts.joints.length;
    for (const { time, joints } of golden) {
      const people: Walker[] = [];
      for (const place of world.places) actors(world, place, time, [0, 0], people);
      expect(people.length).toBe(1);
      const { act } = people[0];
      if (!act) throw new Error("who stays does something");
      const [places, turns] = [new Float32Array(4 * n), new Float32Array(4 * n)];
      actor.pose(act, places, turns, 0);
      for (let i = 0; i < 3 * n; i++) {
        expect(places[4 * Math.floor(i / 3) + (i % 3)]).toBeCloseTo(joints[i], 3);
      }
    }
  });

  it("half seen is between", () => {
    const world = readWorld(bytes);
    if (!world.acts) throw new Error("the fixture has acts");
    const people: Walker[] = [];
    actors(world, world.places[0], 1, [0, 0], people);
    const act = people[0].act;
    if (!act) throw new Error("who stays does something");
    const n = 4 * world.acts.joints.length;
    const [whole, half] = [new Float32Array(n), new Float32Array(n)];
    const actor = new Actor(world.acts);
    actor.pose(act, whole, new Float32Array(n), 0);
    actor.pose({ ...act, share: 0.5 }, half, new Float32Array(n).fill(0.5), 0);
    for (let i = 0; i < n; i++) expect(half[i]).toBeCloseTo(whole[i] / 2, 4);
  });

  it("is refused when a clip is missing", () => {
    const text = new TextDecoder("latin1").decode(bytes);
    const at = text.indexOf('"act_steps"');
    const changed = new Uint8Array(bytes.slice(0));
    changed[at + 1] = "x".charCodeAt(0);
    expect(() => readWorld(changed.buffer)).toThrow("act_steps");
  });
});
