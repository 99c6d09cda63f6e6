/** The built page in a real browser. CROWD=path tests with a crowd file of one's own. */

import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { duration } from "../src/crowd/model";
import { readCrowd } from "../src/crowd/reader";
import { Pose, samplePose } from "../src/crowd/sample";
import { fixtureCrowd } from "../test/fixture";
import { changed, screenshot } from "./pixels";
import { Site } from "./site";

const own = process.env.CROWD;
const bytes = own ? new Uint8Array(readFileSync(own)) : new Uint8Array(fixtureCrowd().bytes);
const crowd = readCrowd(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
const end = duration(crowd);
const REPORT = {
  characters: crowd.characters.length,
  danglings: 0,
  solve_secs: 0.42,
  check: [
    { row: "stitch_gap", value: 0.0002, limit: 0.001, unit: "m", ok: true },
    { row: "foot_slide", value: 0.02, limit: 0.01, unit: "m", ok: false },
  ],
};

const site = new Site({ "crowd.crowd": bytes, "report.json": new TextEncoder().encode(JSON.stringify(REPORT)) });
const { open, seek, state } = site;

/** Somebody present at `secs`. */
function somebody(secs: number): number {
  const frame = secs * crowd.fps;
  return crowd.characters.findIndex((c) => c.begin <= frame && frame <= c.begin + c.frames - 1);
}

describe("the page", () => {
  it("loads a crowd and its report without a complaint", async () => {
    await open("paused=1&t=1");
    expect(await site.page.textContent(".stats")).toContain(`People${crowd.characters.length.toLocaleString("en")}`);
    await site.page.waitForSelector(".checks li.bad");
    expect(await site.page.textContent("summary")).toBe("1 of 2 checks fail");
    expect(await site.page.locator(".checks li.good").count()).toBe(1);
    expect((await state()).time).toBeCloseTo(1, 6);
    expect(site.complaints).toEqual([]);
  });

  it("asks nobody but its own server", async () => {
    const asked: string[] = [];
    site.page.on("request", (r) => asked.push(r.url()));
    await open("paused=1");
    expect(asked.filter((url) => !url.startsWith(site.server.url) && !url.startsWith("data:"))).toEqual([]);
  });

  it("plays, stops, steps and shows the time", async () => {
    await open("t=0.5");
    expect((await state()).playing).toBe(true);
    await site.page.waitForFunction(() => window.crowdquilt.state().time > 0.6);
    await site.page.keyboard.press(" ");
    const stopped = await state();
    expect(stopped.playing).toBe(false);
    await site.page.keyboard.press("ArrowRight");
    await site.page.keyboard.press("ArrowRight");
    const frames = (await state()).time * crowd.fps;
    expect(frames).toBeCloseTo(Math.floor(stopped.time * crowd.fps + 1e-4) + 2, 3);
    expect(await site.page.textContent(".clock")).toBe(`0:${(await state()).time.toFixed(2).padStart(5, "0")}`);
    const track = await site.page.locator(".track").boundingBox();
    await site.page.mouse.click(track!.x + track!.width / 2, track!.y + 10);
    expect((await state()).time / end).toBeCloseTo(0.5, 2);
  });
});

describe("the picture", () => {
  it("has the GPU's joints where the CPU's are, within a millimetre", async () => {
    await open("paused=1");
    const pose = new Pose(crowd.joints.length);
    for (const secs of [0, end * 0.31, end * 0.5017, end * 0.77, end]) {
      await seek(secs);
      const joints = await site.page.evaluate(() => window.crowdquilt.joints());
      expect(joints).toHaveLength(crowd.characters.length * crowd.joints.length * 4);
      let worst = 0;
      let present = 0;
      for (let person = 0; person < crowd.characters.length; person++) {
        const there = samplePose(crowd, person, secs, pose);
        expect(joints[person * crowd.joints.length * 4 + 3] > 0.5).toBe(there);
        if (!there) continue;
        present++;
        for (let j = 0; j < crowd.joints.length; j++) {
          for (let axis = 0; axis < 3; axis++) {
            const gpu = joints[(person * crowd.joints.length + j) * 4 + axis];
            worst = Math.max(worst, Math.abs(gpu - pose.positions[j * 3 + axis]));
          }
        }
      }
      expect(present).toBeGreaterThan(0);
      expect(worst).toBeLessThan(0.001);
    }
  });

  it("shows bodies where the hips are, and nothing of them elsewhere", async () => {
    const secs = end * 0.4;
    await open(`paused=1&t=${secs}&view=persp&outlines=none&bare=1`);
    const shown = await screenshot(site.page);
    await site.page.evaluate(() => window.crowdquilt.bodies(false));
    const hidden = await screenshot(site.page);
    expect(changed(shown, hidden)).toBeGreaterThan(crowd.characters.length * 20);
    let seen = 0;
    let present = 0;
    for (let person = 0; person < crowd.characters.length; person++) {
      const at = await site.page.evaluate((p) => window.crowdquilt.project(p), person);
      if (!at) continue;
      present++;
      if (changed(shown, hidden, at, 2) >= 8) seen++;
    }
    // An obstacle may hide one or the other.
    expect(seen).toBeGreaterThanOrEqual(Math.ceil(present * 0.9));
    expect(changed(shown, hidden, { x: 30, y: 30 }, 25)).toBe(0);
  });

  it("changes with the time, and is the same at the same time", async () => {
    await open(`paused=1&t=${end * 0.2}&bare=1`);
    const first = await screenshot(site.page);
    await seek(end * 0.6);
    expect(changed(first, await screenshot(site.page))).toBeGreaterThan(500);
    await seek(end * 0.2);
    expect(changed(first, await screenshot(site.page))).toBe(0);
  });

  it("changes with colours, outlines and views", async () => {
    await open(`paused=1&t=${end * 0.5}`);
    let before = await screenshot(site.page);
    for (const key of ["c", "c", "o", "2", "3", "l"]) {
      await site.page.keyboard.press(key);
      await site.page.waitForTimeout(1200);
      const after = await screenshot(site.page);
      expect(changed(before, after), `key ${key}`).toBeGreaterThan(100);
      before = after;
    }
    expect((await state()).view).toBe("loom");
    await site.page.keyboard.press("l");
    expect((await state()).view).toBe("persp");
    expect(site.complaints).toEqual([]);
  });
});

describe("a click", () => {
  it("selects the person under it, and lets go beside everybody", async () => {
    await open(`paused=1&t=${end * 0.4}&view=top`);
    const person = somebody(end * 0.4);
    const at = await site.page.evaluate((p) => window.crowdquilt.project(p), person);
    await site.page.mouse.click(at!.x, at!.y);
    expect((await state()).person).toBe(person);
    expect(await site.page.textContent(".inspector h2")).toBe(`Person ${person}`);
    expect(await site.page.locator(".chain li").count()).toBe(crowd.characters[person].fragments.length);
    const last = site.page.locator(".chain button").last();
    await last.click();
    const fragment = crowd.characters[person].fragments.at(-1)!;
    expect((await state()).time * crowd.fps).toBeCloseTo(Math.max(fragment.begin, crowd.characters[person].begin), 1);
    await site.page.keyboard.press("Escape");
    expect((await state()).person).toBeNull();
    expect(await site.page.locator(".inspector").isVisible()).toBe(false);
  });

  it("selects on the loom's plane too", async () => {
    await open(`paused=1&t=${end * 0.4}&view=loom`);
    const person = somebody(end * 0.4);
    const at = await site.page.evaluate((p) => window.crowdquilt.project(p), person);
    await site.page.mouse.click(at!.x, at!.y);
    // Somebody else may stand in front.
    expect((await state()).person).not.toBeNull();
  });

  it("follows", async () => {
    await open(`paused=1&t=${end * 0.2}&person=${somebody(end * 0.2)}&follow=1`);
    const place = () => site.page.evaluate((p) => window.crowdquilt.project(p), somebody(end * 0.2));
    const before = await place();
    await seek(end * 0.2 + 1);
    const after = await place();
    expect(Math.hypot(after!.x - before!.x, after!.y - before!.y)).toBeLessThan(2);
  });
});

describe("broken files", () => {
  const cases: [string, Uint8Array | null, RegExp][] = [
    ["missing", null, /expected a crowd, a patch set or a world, the server says 404/],
    ["cut", bytes.slice(0, bytes.length >> 1), /byte 12: expected \d+ bytes in all, found \d+: the file is cut/],
    [
      "other",
      new TextEncoder().encode("PK, not a crowd at all, but longer than a prelude"),
      /byte 0: expected the magic bytes "CQCROWD"/,
    ],
    ["newer", Uint8Array.from(bytes.slice(0, 64)).fill(9, 8, 9), /byte 8: expected version 1 or 2 or 3 or 4, found 9/],
  ];
  it.each(cases)("give one clear message: %s", async (name, content, message) => {
    if (content) site.server.data.set(`${name}.crowd`, content);
    await site.page.goto(`${site.server.url}/?crowd=/data/${name}.crowd`);
    await site.page.waitForSelector(".problem");
    expect(await site.page.textContent(".problem p")).toMatch(message);
    expect(await site.page.textContent(".problem p")).toContain(`/data/${name}.crowd`);
    const refused = await site.page.evaluate(() => window.crowdquilt.ready.then(() => "", String));
    expect(refused).toMatch(message);
  });
});

describe("the cost of a picture", () => {
  const many = (people: number, secs: number) => {
    // No obstacles: whether they are in sight would change the number of draw calls.
    const alter = (header: Record<string, unknown>) => Object.assign(header.domain as object, { obstacles: [] });
    site.server.data.set("many.crowd", new Uint8Array(fixtureCrowd({ people, secs, alter }).bytes));
    return site.page.setViewportSize({ width: 320, height: 200 });
  };

  it("is a dozen draw calls for 12 people as for 200", async () => {
    const calls = async (people: number) => {
      await many(people, 2);
      await open("paused=1&crowd=/data/many.crowd&outlines=all");
      // A picture of a new time: one of the same time needs no new poses, which saves a call.
      return site.page.evaluate(() => window.crowdquilt.seek(1).then(() => window.crowdquilt.frame().drawCalls));
    };
    const few = await calls(12);
    expect(few).toBeLessThan(15);
    expect(await calls(200)).toBe(few);
  });

  it("in JavaScript does not grow from 12 to 200 and to 2,000 people", async () => {
    const cost = async (people: number) => {
      await many(people, 1);
      // Without a graphics card 2,000 bodies take seconds: their draw calls are left out, everything else is done.
      await open("paused=1&crowd=/data/many.crowd&outlines=all&bodies=0");
      const measure = () => site.page.evaluate(() => window.crowdquilt.measure(20));
      // The first pictures compile code; of the others the quietest batch counts, for the machine has other work too.
      await measure();
      const batches = [await measure(), await measure(), await measure()];
      return Math.min(...batches);
    };
    const costs = [await cost(12), await cost(200), await cost(2000)];
    const [few, some, most] = costs.map((ms) => ms.toFixed(2));
    console.log(`JavaScript per picture: 12 people ${few} ms, 200 people ${some} ms, 2,000 people ${most} ms`);
    expect(costs[1]).toBeLessThan(costs[0] + 0.5);
    expect(costs[2]).toBeLessThan(costs[0] + 0.8);
  });
});
