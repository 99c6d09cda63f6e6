/**
 * Pictures of a crowd from the built page: SHOTS="folder query ..." npm run shots; each query is the page's parameters.
 * CROWD=path takes a real crowd file instead of the synthetic one; LOOK=x,y,z,tx,ty,tz places the camera.
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
  if (look) await page.evaluate((v) => window.crowdquilt.camera(v.slice(0, 3), v.slice(3)), look);
  await page.waitForTimeout(700);
  await page.screenshot({ path: `${folder}/${i}.png` });
  console.log(query, JSON.stringify(await page.evaluate(() => window.crowdquilt.frame())));
}
await browser.close();
await server.close();
