/** The page of a patch set in a real browser. */

import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { Pose, samplePose } from "../src/crowd/sample";
import { crowdOf } from "../src/set/crowd";
import { readSet } from "../src/set/reader";
import { changed, screenshot } from "./pixels";
import { Site } from "./site";

/** Of tests/golden_set.rs: `step` of one person, `meet` of two, which is a mirrored copy. */
const bytes = new Uint8Array(readFileSync(new URL("../test/golden/kinds.patches", import.meta.url)));
const set = readSet(bytes.slice().buffer);

const site = new Site({ "crowd.crowd": bytes });
const { open, seek, state } = site;
const shownKind = () => site.page.textContent(".kind h2");

describe("the page of a patch set", () => {
  it("lists kinds without mirrored copies, and plays the first in a loop", async () => {
    await open("");
    expect(await site.page.locator(".kinds li").count()).toBe(1);
    expect(await site.page.textContent(".found")).toBe("1 kind");
    expect(await shownKind()).toBe("step");
    expect(await site.page.textContent(".roles")).toContain("stand → walk left");
    expect(await site.page.locator(".stats").count()).toBe(0);
    // Six frames take 0.2 s: later it has begun anew.
    await site.page.waitForTimeout(600);
    const { playing, time } = await state();
    expect(playing).toBe(true);
    expect(time).toBeLessThanOrEqual(0.2);
    expect(site.complaints).toEqual([]);
  });

  it("finds kinds by words and by people", async () => {
    await open("paused=1");
    await site.page.click("text=Mirrored");
    expect(await site.page.locator(".kinds li").count()).toBe(2);
    expect(await site.page.textContent(".found")).toBe("2 kinds");
    await site.page.fill(".search", "friendly");
    expect(await site.page.textContent(".found")).toBe("1 of 2 kinds");
    expect(await site.page.locator(".kinds .name").allTextContents()).toEqual(["meet"]);
    await site.page.fill(".search", "");
    await site.page.locator(".set .row button", { hasText: /^1$/ }).click();
    expect(await site.page.locator(".kinds .name").allTextContents()).toEqual(["step"]);
  });

  it("steps through the listed kinds by arrow keys, round and round, also from the search field", async () => {
    await open("paused=1");
    await site.page.click("text=Mirrored");
    await site.page.keyboard.press("ArrowDown");
    expect(await shownKind()).toBe("meet");
    await site.page.keyboard.press("ArrowDown");
    expect(await shownKind()).toBe("step");
    await site.page.focus(".search");
    await site.page.keyboard.press("ArrowUp");
    expect(await shownKind()).toBe("meet");
    expect(await site.page.locator(".current .name").textContent()).toBe("meet");
    // Letters and the space bar belong to the field.
    await site.page.keyboard.type("a b");
    expect(await site.page.inputValue(".search")).toBe("a b");
    expect((await state()).playing).toBe(false);
  });

  it("tells who touches whom and who has a box when, and goes there", async () => {
    await open("paused=1&kind=meet");
    const told = site.page.locator(".touches li");
    expect(await told.allTextContents()).toEqual(["0:00.00holds box", "0:00.13right handtorso", "0:00.17holds box"]);
    await told.nth(1).locator("button").click();
    expect((await state()).time).toBeCloseTo(4 / set.fps, 3);
  });

  it("has the GPU's joints where the CPU's are, in every kind that is shown", async () => {
    await open("paused=1&kind=meet");
    for (const index of [1, 0, 1]) {
      await site.page.locator(".kinds .name", { hasText: set.kinds[index].name }).click();
      const crowd = crowdOf(set, set.kinds[index]);
      const pose = new Pose(crowd.joints.length);
      for (const frame of [0, 2.5, 5]) {
        await seek(frame / set.fps);
        const joints = await site.page.evaluate(() => window.crowdquilt.joints());
        expect(joints).toHaveLength(crowd.characters.length * crowd.joints.length * 4);
        for (let person = 0; person < crowd.characters.length; person++) {
          const there = samplePose(crowd, person, frame / set.fps, pose);
          expect(joints[person * crowd.joints.length * 4 + 3] > 0.5).toBe(there);
          if (!there) continue;
          for (const [i, v] of pose.positions.entries()) {
            const joint = person * crowd.joints.length + Math.floor(i / 3);
            expect(Math.abs(joints[joint * 4 + (i % 3)] - v)).toBeLessThan(0.001);
          }
        }
      }
    }
  });

  it("marks paths and ports on the floor, and a touch only while it lasts", async () => {
    await open("paused=1&kind=meet&bare=1");
    await site.page.evaluate(() => window.crowdquilt.bodies(false));
    const at = async (frame: number) => {
      await seek(frame / set.fps);
      return screenshot(site.page);
    };
    const orange = (image: { data: ArrayLike<number> }) => {
      let count = 0;
      for (let i = 0; i < image.data.length; i += 4) {
        const [r, g, b] = [image.data[i], image.data[i + 1], image.data[i + 2]];
        if (r > 225 && g > 150 && g < 215 && b < 140) count++;
      }
      return count;
    };
    const [before, during, after] = [await at(3), await at(6), await at(10.8)];
    expect(orange(during)).toBeGreaterThan(orange(before) + 40);
    expect(orange(during)).toBeGreaterThan(orange(after) + 40);
    // Rings under people move along their paths.
    expect(changed(before, after)).toBeGreaterThan(100);
  });

  it("frees what was drawn of one kind when the next is shown", async () => {
    await open("paused=1&kind=meet");
    const memory = async () => {
      await site.page.keyboard.press("ArrowDown");
      await site.page.keyboard.press("ArrowDown");
      await seek(0.1);
      return site.page.evaluate(() => window.crowdquilt.frame().memory);
    };
    await memory();
    const before = await memory();
    for (let i = 0; i < 3; i++) await memory();
    expect(await memory()).toEqual(before);
    expect(site.complaints).toEqual([]);
  });

  it("says what is wrong with a set that is cut", async () => {
    site.server.data.set("cut.patches", bytes.slice(0, 900));
    await site.page.goto(`${site.server.url}/?crowd=/data/cut.patches`);
    await site.page.waitForSelector(".problem");
    expect(await site.page.textContent(".problem p")).toMatch(/cut\.patches: byte 12: expected .* the file is cut/);
  });
});
