/**
 * Pictures of a crowd from the built page: SHOTS="folder query ..." npm run shots; each query is the page's parameters.
 * CROWD=path takes a real file (a crowd, a set, a world) instead of the synthetic crowd; LOOK=x,y,z,tx,ty,tz places the camera.
 */

import { mkdir, readFile } from "node:fs/promises";
import { fixtureCrowd } from "../test/fixture";
import { findChrome, launch } from "./browser";
import { serve } from "./server";

const [folder, ...queries] = (process.env.SHOTS ?? "shots t=3 t=3&view=loom").split(" ");
const server = await serve("dist");
const crowd = process.env.CROWD ? await readFile(process.env.CROWD) : new Uint8Array(fixtureCrowd({}).bytes);
server.data.set("crowd.crowd", crowd);
if (process.env.REPORT) server.data.set("report.json", await readFile(process.env.REPORT));
const browser = await launch(findChrome() ?? "chromium");
await mkdir(folder, { recursive: true });
const page = await browser.newPage({ viewport: { width: 1440, height: 860 } });
page.on("console", (m) => console.log(m.type(), m.text()));
page.on("pageerror", (e) => console.log("pageerror", e.message));
for (const [i, query] of queries.entries()) {
  await page.goto(`${server.url}/?${query}&paused=1`);
  await page.evaluate(() => window.crowdquilt.ready).catch((e) => console.log(String(e)));
  const look = process.env.LOOK?.split(",").map(Number);
  const view = (v: number[]) => {
    const [eye, at] = [v.slice(0, 3), v.slice(3)] as [[number, number, number], [number, number, number]];
    window.crowdquiltWorld ? window.crowdquiltWorld.walk.look(eye, at) : window.crowdquilt.camera(eye, at);
  };
  if (look) await page.evaluate(view, look);
  await page.waitForTimeout(700);
  await page.screenshot({ path: `${folder}/${i}.png` });
  const shown = () => window.crowdquiltWorld?.stats ?? window.crowdquilt.frame();
  console.log(query, JSON.stringify(await page.evaluate(shown)));
}
await browser.close();
await server.close();
