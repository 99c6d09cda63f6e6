import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { FileProblem } from "../src/crowd/container";
import { Pose, samplePose, sampleProp } from "../src/crowd/sample";
import { crowdOf } from "../src/set/crowd";
import { listed, stepKind } from "../src/set/list";
import { measuresOf } from "../src/set/measure";
import { seconds } from "../src/set/model";
import { readSet } from "../src/set/reader";
import { MANY, Store } from "../src/store";

/** Made by tests/golden_set.rs. */
const golden = (name: string) => new URL(`golden/${name}`, import.meta.url);
const file = new Uint8Array(readFileSync(golden("kinds.patches")));
const bytes = () => file.slice().buffer;
const set = readSet(bytes());

describe("a patch set written by Rust", () => {
  it("has its kinds, people, ports and contacts", () => {
    expect(set.groups).toEqual(["stand", "walk_left", "walk_right"]);
    expect(set.joints).toHaveLength(22);
    const [step, meet] = set.kinds;
    expect(step).toMatchObject({ name: "step", labels: ["walk", "slow"], mirrored: false, core: null, contacts: [] });
    expect(step.roles).toEqual([{ begin: 0, frames: 7, firstFrame: 0, entry: 0, exit: 1 }]);
    expect(meet).toMatchObject({ name: "meet", mirrored: true, core: [3, 10], lastFrame: 11 });
    expect(meet.roles).toEqual([
      { begin: 2, frames: 9, firstFrame: 7, entry: 1, exit: 2 },
      { begin: 0, frames: 12, firstFrame: 16, entry: 2, exit: 0 },
    ]);
    expect(meet.contacts).toEqual([
      { a: { role: 0, part: "right_hand" }, b: { role: 1, part: "torso" }, begin: 4, end: 9 },
    ]);
    expect(seconds(set, meet)).toBeCloseTo(11 / 30, 6);
  });

  it("has every joint where Rust has it, once a kind is a crowd", () => {
    type Told = { kind: number; role: number; frame: number; joints: [number, number, number][] };
    const { bodies: told } = JSON.parse(readFileSync(golden("kinds.json"), "utf8")) as { bodies: Told[] };
    expect(told).toHaveLength(9);
    const pose = new Pose(set.joints.length);
    for (const { kind, role, frame, joints } of told) {
      const crowd = crowdOf(set, set.kinds[kind]);
      const own = set.kinds[kind].roles[role];
      // The crowd's floor is around the middle of the paths.
      const [dx, dz] = [0, 1].map((k) => {
        const at = crowd.characters[role].firstFrame * 2 + k;
        return set.points[own.firstFrame * 2 + k] - crowd.pathPoints[at];
      });
      expect(samplePose(crowd, role, (own.begin + frame) / set.fps, pose)).toBe(true);
      for (const [j, [x, y, z]] of joints.entries()) {
        expect(pose.positions[j * 3] + dx).toBeCloseTo(x, 3);
        expect(pose.positions[j * 3 + 1]).toBeCloseTo(y, 3);
        expect(pose.positions[j * 3 + 2] + dz).toBeCloseTo(z, 3);
      }
    }
  });
});

describe("the boxes of a patch set written by Rust", () => {
  it("have their sizes and holders", () => {
    expect(set.kinds[0].props[0]).toMatchObject({ name: "parcel", holds: [{ role: 0, begin: 2, end: 4 }] });
    expect(set.kinds[0].props[0].before?.middle[1]).toBeCloseTo(0.15, 6);
    expect(set.kinds[1].props[0]).toMatchObject({ name: "box", before: null, after: null });
    const [box] = crowdOf(set, set.kinds[1]).props;
    expect(box).toMatchObject({ begin: 0, frames: 11 });
    expect(box.holds).toEqual([
      { character: 1, begin: 0, end: 7 },
      { character: 0, begin: 5, end: 10 },
    ]);
  });

  it("are where Rust has them, at rest and in the hands", () => {
    type Told = { kind: number; frame: number; joints: [[number, number, number, number]] };
    const { boxes } = JSON.parse(readFileSync(golden("kinds.json"), "utf8")) as { boxes: Told[] };
    expect(boxes).toHaveLength(7 + 11);
    const at = [0, 0, 0, 0];
    for (const { kind, frame, joints } of boxes) {
      const crowd = crowdOf(set, set.kinds[kind]);
      const { firstFrame } = set.kinds[kind].roles[0];
      const [dx, dz] = [0, 1].map((k) => set.points[firstFrame * 2 + k] - crowd.pathPoints[k]);
      expect(sampleProp(crowd, 0, frame / set.fps, at)).toBe(true);
      const [x, y, z, heading] = joints[0];
      for (const [found, told] of [
        [at[0] + dx, x],
        [at[1], y],
        [at[2] + dz, z],
        [Math.sin(at[3]), Math.sin(heading)],
        [Math.cos(at[3]), Math.cos(heading)],
      ]) {
        expect(found).toBeCloseTo(told, 3);
      }
    }
    expect(sampleProp(crowdOf(set, set.kinds[1]), 0, 11 / set.fps, at)).toBe(false);
  });
});

describe("what is measured of a kind", () => {
  type Told = { turn_deg: number; words: string[] } & Record<
    "people" | "seconds" | "speed" | "fastest" | "radius",
    number
  >;
  const { measures } = JSON.parse(readFileSync(golden("kinds.json"), "utf8")) as { measures: Told[] };

  it("is what Rust measures", () => {
    expect(measures).toHaveLength(set.kinds.length);
    for (const [k, told] of measures.entries()) {
      const found = measuresOf(set, set.kinds[k]);
      expect(found.words).toEqual(told.words);
      expect(found.people).toBe(told.people);
      for (const name of ["seconds", "speed", "fastest", "radius"] as const) {
        expect(found[name]).toBeCloseTo(told[name], 2);
      }
      expect(found.turnDeg).toBeCloseTo(told.turn_deg, 2);
    }
  });

  it("is found by the words of the search", () => {
    const all = { words: "", people: 0, mirrored: true };
    expect(measures[1].words).toContain("contact");
    expect(listed(set, { ...all, words: "contact" })).toEqual([1]);
    expect(listed(set, { ...all, words: "step prop" })).toEqual([0]);
  });
});

describe("a kind as a crowd", () => {
  const crowd = crowdOf(set, set.kinds[1]);

  it("has a person for every role, there from entry to exit", () => {
    expect(crowd.characters.map((c) => [c.begin, c.frames])).toEqual([
      [2, 9],
      [0, 12],
    ]);
    expect(crowd.lastFrame).toBe(11);
    expect(crowd.kinds).toEqual([{ name: "meet", labels: ["friendly"], people: 2 }]);
    const pose = new Pose(crowd.joints.length);
    expect(samplePose(crowd, 0, 1 / 30, pose)).toBe(false);
    expect(samplePose(crowd, 1, 1 / 30, pose)).toBe(true);
  });

  it("stands in the middle of a floor with room around everybody", () => {
    const [[left, back], , [right, front]] = crowd.region;
    expect(left).toBeCloseTo(-right, 6);
    expect(back).toBeCloseTo(-front, 6);
    expect(Math.min(right, front)).toBeGreaterThanOrEqual(2);
    for (let i = 0; i < crowd.pathPoints.length; i += 2) {
      expect(Math.abs(crowd.pathPoints[i])).toBeLessThan(right - 0.8);
      expect(Math.abs(crowd.pathPoints[i + 1])).toBeLessThan(front - 0.8);
    }
  });
});

describe("the list of kinds", () => {
  const all = { words: "", people: 0, mirrored: true };

  it("is filtered by words in names, labels and groups, by people, and by mirrored copies", () => {
    expect(listed(set, all)).toEqual([0, 1]);
    expect(listed(set, { ...all, mirrored: false })).toEqual([0]);
    expect(listed(set, { ...all, words: "MEET" })).toEqual([1]);
    expect(listed(set, { ...all, words: "slow walk" })).toEqual([0]);
    expect(listed(set, { ...all, words: "walk_right" })).toEqual([1]);
    expect(listed(set, { ...all, words: "slow friendly" })).toEqual([]);
    expect(listed(set, { ...all, people: 2 })).toEqual([1]);
    expect(listed(set, { ...all, people: MANY })).toEqual([]);
  });

  it("is stepped through round and round", () => {
    const store = new Store();
    stepKind(store, 1);
    expect(store.get("kind")).toBeNull();
    store.set("set", set);
    store.set("filter", all);
    const steps = ([1, 1, 1, -1, -1] as const).map((step) => {
      stepKind(store, step);
      return store.get("kind");
    });
    expect(steps).toEqual([0, 1, 0, 1, 0]);
    store.set("filter", { ...all, words: "nothing of the kind" });
    stepKind(store, 1);
    expect(store.get("kind")).toBe(0);
  });
});

describe("a broken set", () => {
  const problem = (buffer: ArrayBuffer): string => {
    try {
      readSet(buffer);
    } catch (error) {
      expect(error).toBeInstanceOf(FileProblem);
      return (error as Error).message;
    }
    return "no problem";
  };
  /** The file with a piece of its header replaced by one of the same length. */
  const altered = (from: string, to: string) => {
    expect(to).toHaveLength(from.length);
    const text = new TextDecoder("latin1").decode(file);
    expect(text).toContain(from);
    return Uint8Array.from(text.replace(from, to), (c) => c.charCodeAt(0)).buffer;
  };

  it("is refused wherever it is cut", () => {
    for (let length = 0; length < file.length; length += 37) {
      expect(problem(file.slice(0, length).buffer)).toMatch(/^byte/);
    }
  });

  it.each([
    ["another version", () => problem(file.slice().fill(9, 8, 9).buffer), /byte 8: expected version/],
    ["a crowd", () => problem(new TextEncoder().encode("CQCROWD\0".padEnd(99)).buffer as ArrayBuffer), /byte 0/],
    ["a group that is not there", () => problem(altered('"entry_group":2', '"entry_group":7')), /pose group 7/],
    ["a role that is not there", () => problem(altered('"role":1', '"role":5')), /kind meet, contacts: role 5/],
    ["a part that is none", () => problem(altered('"torso"', '"tarso"')), /kind 1, contact 0, b: expected a part/],
    ["too many frames", () => problem(altered('"frames":7', '"frames":8')), /array points: expected 58/],
    ["a role of one frame", () => problem(altered('"frames":7', '"frames":1')), /kind 0, role 0: expected at least 2/],
    ["a box in nobody's hands", () => problem(altered('"begin":5,"end":10', '"begin":1,"end":10')), /prop box: role 0/],
    ["no rate", () => problem(altered('"fps":30', '"fps":-1')), /header.fps/],
  ])("gives one clear message: %s", (_, found, message) => {
    expect(found()).toMatch(message);
  });
});
