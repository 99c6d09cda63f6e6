/** Puts the drawn things together and draws a picture when something changed. */

import { Vector3 } from "three";
import { type Crowd, duration } from "../crowd/model";
import { sampleRoot } from "../crowd/sample";
import { COLOR_MODES, type Store, type View } from "../store";
import { Boxes } from "./boxes";
import { Cameras } from "./cameras";
import { discard } from "./discard";
import { Loom } from "./loom";
import type { Marks } from "./marks";
import { type Hull, hulls, PatchOutlines } from "./outlines";
import { People } from "./people";
import { Stage } from "./stage";
import { CrowdTextures } from "./textures";

/** Everything drawn of one crowd. */
interface Drawn {
  crowd: Crowd;
  textures: CrowdTextures;
  people: People;
  boxes: Boxes;
  outlines: PatchOutlines;
  loom: Loom;
  hulls: Hull[];
  /** Of a kind of a patch set. */
  marks: Marks | null;
}

/** How much farther one looks at a block of tiles than at one. */
const TILES_RADIUS = 2.6;

export interface FrameStats {
  /** JavaScript time of the last picture and a running mean, in milliseconds. */
  jsMs: number;
  meanMs: number;
  pictures: number;
  drawCalls: number;
  triangles: number;
}

export class Picture {
  readonly stage: Stage;
  readonly cameras: Cameras;
  readonly stats: FrameStats = { jsMs: 0, meanMs: 0, pictures: 0, drawCalls: 0, triangles: 0 };
  drawn: Drawn | null = null;
  private dirty = true;
  private readonly followed = new Vector3(Number.NaN);

  constructor(
    private readonly store: Store,
    private readonly canvas: HTMLCanvasElement,
  ) {
    this.stage = new Stage(canvas);
    this.cameras = new Cameras(canvas, () => this.invalidate());
    store.bus.on("redraw", () => this.invalidate());
    store.bus.on("view", (view) => this.aim(view, true));
    store.bus.on("aim", (view) => this.aim(view, true));
    store.bus.on("tiles", () => this.aim(store.get("view"), true));
    store.bus.on("person", () => this.followed.setScalar(Number.NaN));
    store.bus.on("follow", (on) => this.startFollowing(on));
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
  }

  invalidate(): void {
    this.dirty = true;
  }

  /** Builds everything that is drawn of a crowd, in place of the one before. */
  show(crowd: Crowd, marks: Marks | null = null): void {
    const before = this.drawn;
    const textures = new CrowdTextures(this.stage.renderer, crowd);
    const people = new People(crowd, textures);
    const boxes = new Boxes(crowd);
    const all = hulls(crowd);
    const outlines = new PatchOutlines(crowd, all);
    const loom = new Loom(crowd, all);
    this.stage.build(crowd);
    this.stage.scene.add(people.body, people.spots, boxes.group, outlines.mesh, loom.group);
    if (marks) this.stage.scene.add(marks.group);
    this.drawn = { crowd, textures, people, boxes, outlines, loom, hulls: all, marks };
    // After the new one is there: programs that both use are not compiled again.
    if (before) this.drop(before);
    this.aim(this.store.get("view"), false, before !== null);
  }

  private drop({ people, boxes, outlines, loom, marks, textures }: Drawn): void {
    for (const gone of [people.body, people.spots, boxes.group, outlines.mesh, loom.group, marks?.group])
      if (gone) discard(gone);
    textures.dispose();
  }

  /** How high the present moment is drawn: on the ground, or on the loom's plane. */
  get lift(): number {
    return this.drawn && this.store.get("view") === "loom" ? this.drawn.loom.heightAt(this.store.get("time")) : 0;
  }

  /** Looks from a view's side, or, `turned`, from where one looks now. */
  aim(view: View, fly: boolean, turned = false): void {
    if (!this.drawn) return;
    this.store.set("follow", false);
    const { center } = this.stage;
    const radius = this.stage.radius * (this.store.get("tiles") ? TILES_RADIUS : 1);
    if (view === "loom") {
      const middle = center.clone().setY(this.drawn.loom.height * 0.43);
      this.cameras.aim(view, middle, Math.hypot(radius, this.drawn.loom.height / 2) * 1.12, fly, turned);
    } else {
      this.cameras.aim(
        view,
        center.clone().setY(this.drawn.marks ? 0.55 : view === "front" ? 0.2 : view === "persp" ? -radius * 0.05 : 0),
        radius,
        fly,
        turned,
      );
    }
    this.invalidate();
  }

  /** Moves on by `seconds` of real time and draws if anything is to be seen of it. */
  frame(seconds: number): void {
    const start = performance.now();
    this.follow();
    if (this.cameras.update(seconds)) this.invalidate();
    if (!this.dirty || !this.drawn) return;
    this.dirty = false;
    this.draw(this.drawn);
    const { stats } = this;
    stats.jsMs = performance.now() - start;
    stats.meanMs = stats.pictures === 0 ? stats.jsMs : stats.meanMs * 0.9 + stats.jsMs * 0.1;
    stats.pictures += 1;
    stats.drawCalls = this.stage.renderer.info.render.calls;
    stats.triangles = this.stage.renderer.info.render.triangles;
  }

  private draw({ people, boxes, outlines, loom, marks }: Drawn): void {
    const { store, stage, cameras, lift } = this;
    const time = store.get("time");
    const inLoom = store.get("view") === "loom";
    stage.renderer.info.reset();
    stage.update(time);
    people.uniforms.colorMode.value = COLOR_MODES.indexOf(store.get("color"));
    people.uniforms.chosen.value = store.get("person") ?? -1;
    people.body.visible = people.spots.visible = store.get("bodies");
    people.repeat(store.get("tiles"));
    stage.repeat(store.get("tiles"));
    people.update(time, lift);
    boxes.group.visible = store.get("bodies");
    boxes.update(time, lift, !inLoom);
    outlines.update(time, lift, store.get("outlines"), store.get("color"));
    if (marks) {
      marks.group.visible = !inLoom;
      marks.update(time);
    }
    loom.group.visible = inLoom;
    if (inLoom) loom.update(time, store.get("person") ?? -1);
    people.body.castShadow = !inLoom;
    const distance = cameras.camera.position.distanceTo(cameras.controls.target);
    stage.light(cameras.controls.target, distance * 0.62);
    stage.renderer.render(stage.scene, cameras.camera);
  }

  private startFollowing(on: boolean): void {
    const person = this.store.get("person");
    this.followed.setScalar(Number.NaN);
    if (!on || person === null || !this.drawn) return;
    const at = this.placeOf(person);
    if (at) this.cameras.close(at, 6.2, this.stats.pictures > 0);
  }

  private follow(): void {
    const person = this.store.get("person");
    if (!this.store.get("follow") || person === null) return;
    const at = this.placeOf(person);
    if (!at) return;
    if (!Number.isNaN(this.followed.x)) {
      const by = at.clone().sub(this.followed);
      if (by.lengthSq() > 0) this.cameras.shift(by);
    }
    this.followed.copy(at);
  }

  /** Hips of a person as drawn; null while absent. */
  placeOf(person: number): Vector3 | null {
    if (!this.drawn) return null;
    const out = [0, 0, 0];
    if (!sampleRoot(this.drawn.crowd, person, this.store.get("time"), out)) return null;
    return new Vector3(out[0], 0.95 + this.lift, out[2]);
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.stage.resize(clientWidth, clientHeight, window.devicePixelRatio);
    this.cameras.resize(clientWidth / clientHeight);
    this.invalidate();
  }

  /** Length of the crowd's life in seconds. */
  get duration(): number {
    return this.drawn ? duration(this.drawn.crowd) : 0;
  }
}
