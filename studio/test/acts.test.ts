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

  it("half seen keeps each foot where its own share has it", () => {
    const world = readWorld(bytes);
    if (!world.acts) throw new Error("the fixture has acts");
    const { joints } = world.acts;
    const people: Walker[] = [];
    actors(world, world.places[0], 1, [0, 0], people);
    const act = people[0].act;
    if (!act) throw new Error("who stays does something");
    const n = 4 * joints.length;
    const actor = new Actor(world.acts);
    const posed = (of: Partial<typeof act>, from = new Float32Array(n), turns = new Float32Array(n)) => {
      actor.pose({ ...act, ...of }, from, turns, 0);
      return { places: from, turns };
    };
    const [one, other] = [posed({}), posed({ secs: act.secs + 2, x: act.x + 0.05 })];
    const toe = (name: string) => 4 * joints.findIndex((j) => j.name === name);
    const [left, right] = [toe("left_toe"), toe("right_toe")];
    for (const share of [0, 0.4, 1]) {
      const half = posed(
        { secs: act.secs + 2, x: act.x + 0.05, share, feet: [0, 1] },
        one.places.slice(),
        one.turns.slice(),
      ).places;
      for (let axis = 0; axis < 3; axis++) {
        expect(half[left + axis]).toBeCloseTo(one.places[left + axis], 2);
        expect(half[right + axis]).toBeCloseTo(other.places[right + axis], 2);
      }
    }
  });

  it("is refused when a clip is missing", () => {
    const text = new TextDecoder("latin1").decode(bytes);
    const at = text.indexOf('"act_steps"');
    const changed = new Uint8Array(bytes.slice(0));
    changed[at + 1] = "x".charCodeAt(0);
    expect(() => readWorld(changed.buffer)).toThrow("act_steps");
  });
});
