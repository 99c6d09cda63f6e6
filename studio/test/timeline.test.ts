import { describe, expect, it } from "vitest";
import { fragmentAt, multiPersonShare, presence } from "../src/crowd/lookup";
import { readCrowd } from "../src/crowd/reader";
import { readParameters } from "../src/parameters";
import { advance, clockText, Player, stepFrame } from "../src/play/player";
import { parseReport, shortNumber } from "../src/report";
import { Store } from "../src/store";
import { fixtureCrowd } from "./fixture";

const crowd = readCrowd(fixtureCrowd({ people: 5, secs: 8 }).bytes);

describe("the clock", () => {
  it("wraps around or stops at the end", () => {
    expect(advance(1, 0.5, 10, true)).toEqual({ time: 1.5, ended: false });
    expect(advance(9.8, 0.5, 10, true).time).toBeCloseTo(0.3);
    expect(advance(9.8, 0.5, 10, false)).toEqual({ time: 10, ended: true });
    expect(advance(0, 0.5, 0, true)).toEqual({ time: 0, ended: true });
  });

  it("steps from frame to frame, and first onto a frame", () => {
    expect(stepFrame(1, 1, 30, 10)).toBeCloseTo(31 / 30);
    expect(stepFrame(1.01, 1, 30, 10)).toBeCloseTo(31 / 30);
    expect(stepFrame(1.01, -1, 30, 10)).toBeCloseTo(1);
    expect(stepFrame(0, -1, 30, 10)).toBe(0);
    expect(stepFrame(10, 10, 30, 10)).toBe(10);
    let time = 0;
    for (let i = 0; i < 299; i++) time = stepFrame(time, 1, 30, 10);
    expect(time).toBeCloseTo(299 / 30, 9);
  });

  it("reads well", () => {
    expect(clockText(0)).toBe("0:00.00");
    expect(clockText(75.5)).toBe("1:15.50");
  });

  it("plays, holds at the end, and starts again", () => {
    const store = new Store();
    const player = new Player(store);
    store.set("crowd", crowd);
    store.set("loop", false);
    player.toggle();
    player.tick(0.1);
    expect(store.get("time")).toBeCloseTo(0.1);
    store.set("speed", 0.5);
    player.tick(0.1);
    expect(store.get("time")).toBeCloseTo(0.15);
    player.seek(99);
    expect(store.get("time")).toBe(8);
    player.tick(0.1);
    expect(store.get("playing")).toBe(false);
    player.toggle();
    expect(store.get("time")).toBe(0);
    player.step(3);
    expect([store.get("playing"), store.get("time")]).toEqual([false, 0.1]);
    player.faster(-1);
    player.faster(-1);
    expect(store.get("speed")).toBe(0.25);
  });
});

describe("the store", () => {
  it("tells of changes, and only of changes", () => {
    const store = new Store();
    const seen: unknown[] = [];
    const stop = store.bus.on("speed", (s) => seen.push(s));
    store.bus.on("redraw", () => seen.push("redraw"));
    store.set("speed", 2);
    store.set("speed", 2);
    stop();
    store.set("speed", 1);
    expect(seen).toEqual([2, "redraw", "redraw"]);
  });
});

describe("lookups", () => {
  it("find the fragment of a frame as a plain search does", () => {
    for (const c of crowd.characters) {
      for (let frame = 0; frame <= crowd.lastFrame; frame += 3) {
        const plain = c.fragments.findLastIndex((f) => f.begin <= frame);
        expect(fragmentAt(c, frame)).toBe(plain);
      }
    }
  });

  it("count people and shares as frame by frame does", () => {
    let [shared, all] = [0, 0];
    for (const c of crowd.characters) {
      for (let i = 0; i + 1 < c.frames; i++) {
        const f = c.fragments[fragmentAt(c, c.begin + i)];
        all++;
        if (crowd.kinds[crowd.instances[f.instance]].people > 1) shared++;
      }
    }
    expect(multiPersonShare(crowd)).toBeCloseTo(shared / all, 4);
    const bins = presence(crowd, 10).all;
    for (const value of bins) expect(value).toBeCloseTo(5);
  });
});

describe("the address", () => {
  it("is read with defaults", () => {
    expect(readParameters("?t=2.5&view=loom&person=3&color=kind&paused=1")).toMatchObject({
      t: 2.5,
      view: "loom",
      person: 3,
      color: "kind",
      paused: true,
      crowd: "/data/crowd.crowd",
      report: "/data/report.json",
    });
    expect(readParameters("?t=-1&view=sideways&person=x")).toMatchObject({
      t: 0,
      view: "persp",
      person: null,
      paused: false,
    });
    expect(readParameters("?crowd=/here/a.crowd").report).toBe("/here/report.json");
  });
});

describe("the report", () => {
  it("keeps what it knows and drops the rest", () => {
    const row = { row: "stitch_gap", value: 0.0003, limit: 0.001, unit: "m", ok: true };
    expect(parseReport({ characters: 4, seed: "x", odd: 1, check: [row, { row: 3 }] })).toEqual({
      characters: 4,
      check: [row],
    });
    expect(parseReport(null)).toBeNull();
    expect(parseReport({})).toEqual({ check: [] });
  });

  it("writes numbers shortly", () => {
    expect([0, 12, 1234, 0.00031, 1.5, 12.345, Number.NaN].map(shortNumber)).toEqual([
      "0",
      "12",
      "1,234",
      "0.0003",
      "1.5",
      "12.3",
      "–",
    ]);
  });
});
