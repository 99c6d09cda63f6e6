/** Play, scrub, speed, at the bottom. The track shows how many people are there, and how many of them together. */

import { presence } from "../crowd/lookup";
import { type Crowd, duration } from "../crowd/model";
import { clockText, type Player, SPEEDS } from "../play/player";
import type { Store } from "../store";
import { button, choice, el, icon } from "./dom";

const PLAY = "M4 2.5v11l9-5.5z";
const PAUSE = "M3.5 2.5h3v11h-3zM9.5 2.5h3v11h-3z";
const LOOP = "M3 8a5 5 0 0 1 8.5-3.5V2h1.5v5H8V5.5h2.6A3.5 3.5 0 1 0 11.5 8H13A5 5 0 1 1 3 8z";

/** Returns the track, for marks on it. */
export function installTimeline(parent: HTMLElement, store: Store, player: Player): HTMLElement {
  const play = button("", "Play or pause (Space)", () => player.toggle(), "round play");
  const back = button("‹", "One frame back (←)", () => player.step(-1), "round small");
  const forth = button("›", "One frame on (→)", () => player.step(1), "round small");
  const loop = button("", "Start again at the end", () => store.set("loop", !store.get("loop")), "round small");
  loop.append(icon(LOOP));
  const clock = el("output", "clock", ["0:00.00"], { "aria-label": "Time" });
  const end = el("span", "end");
  const graph = el("canvas", "graph");
  const head = el("div", "head");
  const track = el("div", "track", [graph, head], { role: "slider", tabindex: "-1", "aria-label": "Time" });
  const speeds = choice<string>(
    "Speed",
    SPEEDS.map((s) => [String(s), `${s}×`, `Speed ${s}`] as const),
    (s) => store.set("speed", Number(s)),
  );
  parent.append(el("div", "timeline panel", [back, play, forth, clock, end, track, speeds.element, loop]));

  const showPlaying = (playing: boolean) => play.replaceChildren(icon(playing ? PAUSE : PLAY));
  const showTime = (time: number) => {
    const crowd = store.get("crowd");
    const share = crowd ? time / Math.max(duration(crowd), 1e-6) : 0;
    clock.textContent = clockText(time);
    head.style.left = `${share * 100}%`;
    track.setAttribute("aria-valuenow", time.toFixed(2));
  };
  store.bus.on("playing", showPlaying);
  store.bus.on("time", showTime);
  store.bus.on("speed", (s) => speeds.mark(String(s)));
  store.bus.on("loop", (on) => loop.setAttribute("aria-pressed", String(on)));
  store.bus.on("crowd", (crowd) => {
    if (!crowd) return;
    end.textContent = `/ ${clockText(duration(crowd))}`;
    drawGraph(graph, crowd);
  });
  new ResizeObserver(() => {
    const crowd = store.get("crowd");
    if (crowd) drawGraph(graph, crowd);
  }).observe(track);
  showPlaying(store.get("playing"));
  showTime(store.get("time"));
  speeds.mark(String(store.get("speed")));
  loop.setAttribute("aria-pressed", String(store.get("loop")));
  installScrubbing(track, store, player);
  return track;
}

function installScrubbing(track: HTMLElement, store: Store, player: Player): void {
  const seek = (event: PointerEvent) => {
    const crowd = store.get("crowd");
    const box = track.getBoundingClientRect();
    if (crowd) player.seek(((event.clientX - box.left) / box.width) * duration(crowd));
  };
  track.addEventListener("pointerdown", (event) => {
    track.setPointerCapture(event.pointerId);
    seek(event);
  });
  track.addEventListener("pointermove", (event) => {
    if (track.hasPointerCapture(event.pointerId)) seek(event);
  });
}

function drawGraph(canvas: HTMLCanvasElement, crowd: Crowd): void {
  const ratio = window.devicePixelRatio;
  const [width, height] = [canvas.clientWidth * ratio, canvas.clientHeight * ratio];
  const context = canvas.getContext("2d");
  if (!context || width === 0) return;
  [canvas.width, canvas.height] = [width, height];
  const bins = Math.max(8, Math.min(240, crowd.lastFrame));
  const { all, shared } = presence(crowd, bins);
  const most = Math.max(...all, 1);
  const style = getComputedStyle(canvas);
  const area = (values: Float32Array, color: string) => {
    context.fillStyle = color;
    context.beginPath();
    context.moveTo(0, height);
    for (const [i, v] of values.entries()) context.lineTo(((i + 0.5) / bins) * width, height * (1 - (v / most) * 0.86));
    context.lineTo(width, height * (1 - (values[bins - 1] / most) * 0.86));
    context.lineTo(width, height);
    context.fill();
  };
  area(all, style.getPropertyValue("--graph-all"));
  area(shared, style.getPropertyValue("--graph-shared"));
}
