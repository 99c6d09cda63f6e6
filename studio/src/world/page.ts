/** The page of a world: its patches around the spectator, its people at the time of the clock. */

import { Color, DirectionalLight, Fog, type Group, HemisphereLight, Scene, type WebGLRenderer } from "three";
import { discard } from "../draw/discard";
import { button, headed, pairs } from "../panels/dom";
import { actors } from "./acts";
import { Figures } from "./figures";
import { beyond, patchMesh } from "./ground";
import type { Place, World } from "./model";
import { Sampler, type Walker } from "./sample";
import { Walk } from "./walk";

const SKY = "#dfe6ea";
const SIGHT = 130;
const NEAR = 28;
/** Half the side of the box in which things cast shadows, metres: what is shown near by. */
const SHADED = 24;

/** A patch at its place or at one of its repetitions. */
interface Spot {
  key: string;
  place: Place;
  shift: [number, number];
  copy: [number, number];
}

export class WorldPage {
  readonly walk: Walk;
  time = 0;
  playing = true;
  /** What the last picture showed, and how long it took. */
  readonly stats = { pictures: 0, patches: 0, near: 0, far: 0, jsMs: 0 };
  private readonly scene = new Scene();
  private readonly sampler: Sampler;
  private readonly figures: Figures;
  private readonly shown = new Map<string, Group>();
  private readonly sun = new DirectionalLight("#fff1da", 2.1);
  private readonly words: HTMLElement;

  constructor(
    private readonly world: World,
    private readonly renderer: WebGLRenderer,
    page: HTMLElement,
  ) {
    this.sampler = new Sampler(world);
    this.figures = new Figures(world.gait, world.acts);
    this.walk = new Walk(renderer.domElement, () => {});
    this.scene.background = new Color(SKY);
    this.scene.fog = new Fog(SKY, SIGHT * 0.45, SIGHT * 0.98);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    const box = this.sun.shadow.camera;
    [box.left, box.bottom, box.right, box.top] = [-SHADED, -SHADED, SHADED, SHADED];
    [box.near, box.far] = [10, 110];
    box.updateProjectionMatrix();
    // A centimetre or two: what is moved farther from who casts it no longer meets the feet.
    this.sun.shadow.normalBias = 0.01;
    this.sun.shadow.bias = -0.0002;
    this.scene.add(new HemisphereLight("#f3f6ff", "#b9a994", 1.7), this.sun, this.sun.target, this.figures.far);
    if (this.figures.near) this.scene.add(this.figures.near);
    this.scene.add(beyond("#c9cac4"));
    this.words = this.panel(page);
    this.begin();
  }

  /** One picture, `seconds` after the last. */
  frame(seconds: number): void {
    const begin = performance.now();
    if (this.playing) this.time += Math.min(seconds, 0.25);
    this.walk.update(Math.min(seconds, 0.25));
    const { camera } = this.walk;
    const spots = this.near(camera.position.x, camera.position.z);
    this.build(spots);
    const people: Walker[] = [];
    for (const { place, shift, copy } of spots) {
      this.sampler.patch(place, this.time, shift, copy, people);
      actors(this.world, place, this.time, shift, people);
    }
    const drawn = this.figures.show(people, camera.position, NEAR);
    this.light();
    this.resize();
    this.renderer.render(this.scene, camera);
    Object.assign(this.stats, drawn, { patches: spots.length, jsMs: performance.now() - begin });
    this.stats.pictures++;
    if (this.stats.pictures % 15 === 1) this.tell(people.length);
  }

  /** Puts the shadows' box where one looks, by whole metres, so that edges of shadows do not swim. */
  private light(): void {
    const { camera, yaw } = this.walk;
    const ahead = 0.7 * SHADED;
    const x = Math.round(camera.position.x - Math.sin(yaw) * ahead);
    const z = Math.round(camera.position.z - Math.cos(yaw) * ahead);
    this.sun.target.position.set(x, 0, z);
    this.sun.position.set(x - 30, 55, z + 24);
  }

  private resize(): void {
    const canvas = this.renderer.domElement;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const ratio = Math.min(devicePixelRatio, 2);
    if (canvas.width === Math.floor(width * ratio) && canvas.height === Math.floor(height * ratio)) return;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.walk.camera.aspect = width / height;
    this.walk.camera.updateProjectionMatrix();
  }

  /** Patches in sight, repetitions included. */
  private near(x: number, z: number): Spot[] {
    const { repeat, places } = this.world;
    const range = (c: number, size: number) => {
      const low = Math.floor((c - SIGHT) / size) - 1;
      return Array.from({ length: Math.floor((c + SIGHT) / size) + 2 - low }, (_, i) => low + i);
    };
    const columns = repeat ? range(x, repeat[0]) : [0];
    const rows = repeat ? range(z, repeat[1]) : [0];
    const found: Spot[] = [];
    for (const [index, place] of places.entries()) {
      for (const i of columns) {
        for (const k of rows) {
          const shift: [number, number] = [i * (repeat?.[0] ?? 0), k * (repeat?.[1] ?? 0)];
          if (Math.hypot(place.x + shift[0] - x, place.z + shift[1] - z) > SIGHT) continue;
          found.push({ key: `${index},${i},${k}`, place, shift, copy: [i, k] });
        }
      }
    }
    return found;
  }

  /** Ground and objects of the patches in sight; those out of sight are forgotten. */
  private build(spots: readonly Spot[]): void {
    const wanted = new Set(spots.map((spot) => spot.key));
    for (const [key, group] of this.shown) {
      if (wanted.has(key)) continue;
      discard(group);
      this.shown.delete(key);
    }
    for (const { key, place, shift } of spots) {
      if (this.shown.has(key)) continue;
      const group = patchMesh(this.world, place);
      group.position.set(place.x + shift[0], 0, place.z + shift[1]);
      this.scene.add(group);
      this.shown.set(key, group);
    }
  }

  /** Begins where people walk, looking along the longer side of the world. */
  private begin(): void {
    const { places, kinds } = this.world;
    const walked = places.filter((place) => kinds[place.kind].walkers > 0);
    if (walked.length === 0) return;
    const most = Math.max(...walked.map((p) => kinds[p.kind].walkers));
    const busy = walked.filter((p) => kinds[p.kind].walkers === most);
    const from = busy[busy.length >> 1];
    const span = (of: (p: Place) => number) => Math.max(...walked.map(of)) - Math.min(...walked.map(of));
    const along = span((p) => p.x) >= span((p) => p.z);
    this.walk.look([from.x, 1.7, from.z], along ? [from.x + 20, 1.2, from.z] : [from.x, 1.2, from.z - 20]);
  }

  private panel(page: HTMLElement): HTMLElement {
    const facts = pairs("facts", []);
    const play = button("Pause", "Stop and go on", () => {
      this.playing = !this.playing;
      play.textContent = this.playing ? "Pause" : "Play";
    });
    const hint = document.createElement("p");
    hint.className = "tagline";
    hint.textContent = "Walk: W A S D or arrows, Shift is fast. Look: drag. Rise: wheel.";
    page.append(headed("stats", this.world.name || "A world", [facts, hint, play]));
    return facts;
  }

  private tell(people: number): void {
    const rows = [
      ["people in sight", String(people)],
      ["full bodies", String(this.stats.near)],
      ["patches in sight", String(this.stats.patches)],
      ["time", `${this.time.toFixed(1)} s`],
    ];
    const cells = rows.flatMap(([name, value]) => {
      const [dt, dd] = [document.createElement("dt"), document.createElement("dd")];
      dt.textContent = name;
      dd.textContent = value;
      return [dt, dd];
    });
    this.words.replaceChildren(...cells);
  }
}
