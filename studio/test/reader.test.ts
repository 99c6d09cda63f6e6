import { describe, expect, it } from "vitest";
import { FileProblem } from "../src/crowd/container";
import { readCrowd } from "../src/crowd/reader";
import { sampleProp } from "../src/crowd/sample";
import { type FixtureOptions, fixtureCrowd } from "./fixture";

const small = (options: FixtureOptions = {}) => fixtureCrowd({ people: 3, secs: 2, ...options }).bytes;

function problem(bytes: ArrayBuffer): string {
  try {
    readCrowd(bytes);
  } catch (error) {
    expect(error).toBeInstanceOf(FileProblem);
    return (error as Error).message;
  }
  return "no problem";
}

type Json = Record<string, never>;
const broken = (alter: (header: never) => void) => problem(small({ alter: alter as FixtureOptions["alter"] & object }));

describe("teams", () => {
  const alter = (team: number) => (header: { domain: { teams?: string[] }; characters: { team?: number }[] }) => {
    header.domain.teams = ["red", "blue"];
    header.characters[1].team = team;
  };

  it("are read where there are some", () => {
    const crowd = readCrowd(small({ alter: alter(1) as never }));
    expect(crowd.teams).toEqual(["red", "blue"]);
    expect(crowd.characters.map((c) => c.team)).toEqual([null, 1, null]);
    expect(readCrowd(small()).teams).toEqual([]);
  });

  it("must be there", () => {
    expect(broken(alter(2) as never)).toContain("team 2 does not exist");
  });
});

describe("a valid crowd", () => {
  const crowd = readCrowd(small());

  it("has its people, patches and ground", () => {
    expect(crowd.characters).toHaveLength(3);
    expect(crowd.fps).toBe(30);
    expect(crowd.lastFrame).toBe(60);
    expect(crowd.joints.map((j) => j.name)).toContain("left_hand");
    expect(crowd.region).toHaveLength(4);
    expect(crowd.obstacles).toHaveLength(2);
    expect(crowd.kinds.map((k) => k.people)).toEqual([1, 1, 2, 3]);
    expect(crowd.characters[1].firstFrame).toBe(61);
  });

  it("keeps a seed of 64 bits exactly", () => {
    const bytes = small({
      alter: (h) => {
        h.seed = 123;
      },
    });
    const text = new TextDecoder("latin1").decode(bytes).replace('"seed":123', '"seed":18446744073709551615');
    const longer = Uint8Array.from(text, (c) => c.charCodeAt(0));
    new DataView(longer.buffer).setUint32(12, new DataView(bytes).getUint32(12, true) + 17, true);
    expect(readCrowd(longer.buffer).seed).toBe("18446744073709551615");
  });

  it("gives every fragment its own samples", () => {
    const fragments = crowd.characters.flatMap((c) => c.fragments);
    let next = 0;
    for (const f of fragments) {
      expect(f.firstSample).toBe(next);
      next += f.samples;
    }
    expect(crowd.pathPoints).toHaveLength(next * 2);
  });
});

describe("a broken crowd", () => {
  it("is refused wherever it is cut", () => {
    const bytes = small();
    const lengths = Array.from({ length: 400 }, (_, i) => Math.floor((i / 400) * bytes.byteLength));
    for (const length of [...lengths, ...Array.from({ length: 32 }, (_, i) => i), bytes.byteLength - 1]) {
      expect(problem(bytes.slice(0, length))).toMatch(/^byte/);
    }
  });

  it("is refused with extra bytes", () => {
    const bytes = small();
    const longer = new Uint8Array(bytes.byteLength + 3);
    longer.set(new Uint8Array(bytes));
    expect(problem(longer.buffer)).toMatch(/found \d+: there are extra bytes/);
  });

  it("names the wrong magic and version", () => {
    const bytes = small();
    new Uint8Array(bytes).set([80, 75], 0);
    expect(problem(bytes)).toMatch(/byte 0: expected the magic bytes "CQCROWD", found "PK/);
    expect(problem(small({ version: 5 }))).toBe("byte 8: expected version 1 or 2 or 3 or 4, found 5");
    expect(problem(new ArrayBuffer(0))).toMatch(/^byte 0/);
  });

  it("names the field that is missing or of another type", () => {
    expect(broken((h: Json) => delete h.fps)).toBe("header.fps: expected a number, found nothing");
    expect(broken((h: Json) => delete h.domain)).toBe("header.domain: expected an object, found nothing");
    expect(broken((h: { instances: unknown }) => (h.instances = 3))).toBe("header.instances: expected a list, found 3");
    expect(broken((h: { arrays: Json }) => delete h.arrays.root)).toBe("array root: expected, not found");
  });

  it("names arrays of another type, place or length", () => {
    const root = (change: Record<string, unknown>) =>
      broken((h: { arrays: { root: object } }) => Object.assign(h.arrays.root, change));
    expect(root({ type: "i16" })).toBe('array root: expected type f32, found "i16"');
    expect(root({ offset: 1e9 })).toBe("array root: lies outside the data");
    expect(root({ offset: 2 })).toBe("array root: lies outside the data");
    expect(root({ count: 9 })).toBe("array root: expected 549 numbers for its characters, found 9");
  });

  it("names people and patches that do not fit", () => {
    expect(broken((h: { instances: { kind: number }[] }) => (h.instances[1].kind = 9))).toBe(
      "instance 1: kind 9 does not exist",
    );
    const fragment = (change: object) =>
      broken((h: { characters: { fragments: object[] }[] }) => Object.assign(h.characters[2].fragments[0], change));
    expect(fragment({ role: 5 })).toMatch(/character 2, fragment 0: instance \d+ has no role 5/);
    expect(fragment({ instance: 999 })).toBe("character 2, fragment 0: instance 999 has no role 0");
    expect(fragment({ end: -100 })).toMatch(/ends at frame -100 before it begins/);
    expect(fragment({ begin: 0.5 })).toBe("character 2, fragment 0, begin: expected a whole number, found 0.5");
  });

  it("names builds that are not there or not whole, and takes files without builds for people on the skeleton", () => {
    type Header = { builds?: { offsets: number[][] }[]; characters: { build?: number }[] };
    expect(broken((h: Header) => (h.characters[1].build = 7))).toBe("character 1: build 7 does not exist");
    expect(broken((h: Header) => h.builds?.[1].offsets.pop())).toBe("build 1, offsets: expected 22 rows, found 21");
    expect(broken((h: Header) => h.builds?.[1].offsets[3].pop())).toMatch(/^build 1, offsets: expected 3 numbers/);
    const alter = (header: object) => {
      const h = header as Header;
      delete h.builds;
      for (const c of h.characters) delete c.build;
    };
    const old = readCrowd(fixtureCrowd({ people: 3, secs: 2, alter }).bytes);
    expect(old.builds).toHaveLength(1);
    expect(old.builds[0].offsets).toEqual(old.joints.map((j) => j.offset));
    expect(old.characters.map((c) => c.build)).toEqual([0, 0, 0]);
  });

  it("names joints whose parents come later", () => {
    expect(broken((h: { skeleton: { joints: { parent: number }[] } }) => (h.skeleton.joints[3].parent = 8))).toMatch(
      /^joint 3/,
    );
  });
});

describe("boxes", () => {
  type Header = { props?: object[] };
  const box = {
    name: "box",
    size: [0.4, 0.3, 0.3],
    begin: 20,
    frames: 3,
    holds: [{ character: 1, begin: 20, end: 22 }],
  };
  const places = new Float32Array([0, 1, 0, 3, 0.2, 1, 0, -3, 0.4, 1, 0, -3]);
  const withBox = (change: object = {}) =>
    small({ props: places, alter: (h) => ((h as Header).props = [{ ...box, ...change }]) });

  it("are read, and sampled the short way round", () => {
    const crowd = readCrowd(withBox());
    expect(crowd.props[0]).toEqual({ ...box, firstFrame: 0 });
    const out = [0, 0, 0, 0];
    expect(sampleProp(crowd, 0, 20.5 / 30, out)).toBe(true);
    expect(out[0]).toBeCloseTo(0.1);
    expect(out[3]).toBeCloseTo(Math.PI);
    expect(sampleProp(crowd, 0, 19 / 30, out)).toBe(false);
    expect(sampleProp(crowd, 0, 23 / 30, out)).toBe(false);
    expect(sampleProp(crowd, 0, Number.NaN, out)).toBe(false);
  });

  it("are none in files of the first version", () => {
    expect(readCrowd(small({ version: 1 })).props).toEqual([]);
  });

  it("are refused where they do not fit", () => {
    expect(problem(withBox({ frames: 4 }))).toBe("array prop_places: expected 16 numbers for its props, found 12");
    expect(problem(withBox({ size: [1, 2] }))).toBe("prop 0, size: expected 3 numbers, found 2");
    expect(problem(withBox({ holds: [{ character: 9, begin: 1, end: 2 }] }))).toBe(
      "prop 0: character 9 does not exist",
    );
    expect(problem(withBox({ holds: [{ character: 1, begin: 1 }] }))).toMatch(/^prop 0, hold 0, end/);
  });
});
