/** The wiring: everything is made and connected here, and only here. */

import "@fontsource-variable/inter/wght.css";
import "./style.css";
import type { Crowd } from "./crowd/model";
import { repeatsInSpace } from "./crowd/tiles";
import { debugHandle } from "./debug";
import { Picture } from "./draw/picture";
import { loadReport, loadShown } from "./load";
import { installInspector } from "./panels/inspector";
import { installMessage } from "./panels/message";
import { installStats } from "./panels/stats";
import { installTimeline } from "./panels/timeline";
import { installToolbar } from "./panels/toolbar";
import { readParameters } from "./parameters";
import { Player } from "./play/player";
import { stepKind } from "./set/list";
import { openSet } from "./set/page";
import { COLOR_MODES, OUTLINES, Store } from "./store";
import { installKeys } from "./tools/keys";
import { installPicking } from "./tools/picking";
import type { World } from "./world/model";
import { WorldPage } from "./world/page";

const parameters = readParameters(location.search);
const canvas = document.querySelector("canvas") as HTMLCanvasElement;
const page = document.querySelector("#page") as HTMLElement;
document.body.classList.toggle("bare", parameters.bare);

const store = new Store();
store.set("view", parameters.view);
store.set("color", parameters.color);
store.set("outlines", parameters.outlines);
store.set("bodies", parameters.bodies);
store.set("tiles", parameters.tiles);

const player = new Player(store);
installMessage(page, store);
installToolbar(page, store);
const track = installTimeline(page, store, player);
installKeys(store, player, {
  color: () => store.set("color", after(COLOR_MODES, store.get("color"))),
  outlines: () => store.set("outlines", after(OUTLINES, store.get("outlines"))),
  kind: (step) => stepKind(store, step),
  tiles: () => store.set("tiles", repeatsInSpace(store.get("crowd")) && !store.get("tiles")),
});

const picture = openPicture();
if (picture) {
  installPicking(canvas, store, picture);
  window.crowdquilt = debugHandle(start(picture), store, player, picture);
}

function after<T>(values: readonly T[], value: T): T {
  return values[(values.indexOf(value) + 1) % values.length];
}

function openPicture(): Picture | null {
  try {
    return new Picture(store, canvas);
  } catch {
    store.set(
      "problem",
      "This browser gives no WebGL 2 picture. Turn on hardware acceleration, or use another browser.",
    );
    return null;
  }
}

async function start(shown: Picture): Promise<void> {
  try {
    const { set, crowd, world } = await loadShown(parameters.crowd);
    if (world) return await openWorld(world, shown);
    // The signs on the floor are painted once, in the page's font.
    if (set) await document.fonts.load('600 44px "Inter Variable"');
    if (set) openSet(set, parameters.kind, { parent: page, track }, store, player, shown);
    else if (crowd) openCrowd(crowd, shown);
  } catch (error) {
    store.set("problem", (error as Error).message);
    throw error;
  }
  player.seek(parameters.t);
  if (parameters.person !== null && store.get("crowd")?.characters[parameters.person]) {
    store.set("person", parameters.person);
    store.set("follow", parameters.follow);
  }
  store.set("playing", !parameters.paused);
  animate((seconds) => {
    player.tick(seconds);
    shown.frame(seconds);
  });
  while (shown.stats.pictures === 0) await new Promise(requestAnimationFrame);
}

/** A world has a page of its own: one walks in it. */
async function openWorld(world: World, shown: Picture): Promise<void> {
  page.replaceChildren();
  const walk = new WorldPage(world, shown.stage.renderer, page);
  walk.time = parameters.t;
  walk.playing = !parameters.paused;
  window.crowdquiltWorld = walk;
  animate((seconds) => walk.frame(seconds));
  while (walk.stats.pictures === 0) await new Promise(requestAnimationFrame);
}

function openCrowd(crowd: Crowd, shown: Picture): void {
  installStats(page, store);
  installInspector(page, store, player);
  shown.show(crowd);
  store.set("crowd", crowd);
  if (!repeatsInSpace(crowd)) store.set("tiles", false);
  void loadReport(parameters.report).then((report) => store.set("report", report));
}

function animate(draw: (seconds: number) => void): void {
  let last = performance.now();
  const next = (time: number) => {
    const seconds = Math.max(time - last, 0) / 1000;
    last = time;
    draw(seconds);
    requestAnimationFrame(next);
  };
  requestAnimationFrame(next);
}
