/** The page of a world in a real browser. */

import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { changed, screenshot } from "./pixels";
import { Site } from "./site";

/** Of tests/world_gait.rs: walkers whose feet are planted. */
const bytes = readFileSync(new URL("../test/golden/feet.world", import.meta.url));
const site = new Site({ "crowd.crowd": new Uint8Array(bytes) });

/** Stops the clock at a time and waits for a picture of it. */
const stop = (secs: number) =>
  site.page.evaluate(async (t) => {
    const world = window.crowdquiltWorld as NonNullable<typeof window.crowdquiltWorld>;
    world.playing = false;
    world.time = t;
    const before = world.stats.pictures;
    while (world.stats.pictures < before + 1) await new Promise(requestAnimationFrame);
    const { x, y, z } = world.walk.camera.position;
    return { ...world.stats, camera: [x, y, z] };
  }, secs);

describe("the page of a world", () => {
  it("shows people with full bodies where there are some, and they move", async () => {
    await site.open("bare=1");
    const { near, patches } = await stop(1);
    expect(near).toBeGreaterThan(0);
    expect(patches).toBeGreaterThan(0);
    const before = await screenshot(site.page);
    await stop(1);
    expect(changed(before, await screenshot(site.page))).toBe(0);
    await stop(1.5);
    expect(changed(before, await screenshot(site.page))).toBeGreaterThan(50);
    // An hour later it goes on as it did.
    expect((await stop(3600.5)).near).toBeGreaterThan(0);
    expect(site.complaints).toEqual([]);
  });

  it("is walked through by keys, and stops by its button", async () => {
    await site.open("");
    const from = (await stop(0)).camera;
    await site.page.keyboard.down("w");
    await stop(0.1);
    await stop(0.2);
    await site.page.keyboard.up("w");
    const to = (await stop(0)).camera;
    expect(Math.hypot(to[0] - from[0], to[2] - from[2])).toBeGreaterThan(0.3);
    await site.page.evaluate(() => {
      (window.crowdquiltWorld as NonNullable<typeof window.crowdquiltWorld>).playing = true;
    });
    await site.page.click("text=Pause");
    expect(await site.page.evaluate(() => window.crowdquiltWorld?.playing)).toBe(false);
  });
});
