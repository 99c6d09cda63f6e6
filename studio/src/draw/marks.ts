/** What is marked on the floor around a kind's people: paths, seconds, ports with their pose groups, who touches now. */

import {
  BufferGeometry,
  CanvasTexture,
  Color,
  DoubleSide,
  Float32BufferAttribute,
  Group,
  Mesh,
  MeshBasicMaterial,
  RingGeometry,
  Sprite,
  SpriteMaterial,
  SRGBColorSpace,
} from "three";
import type { Crowd, Vec2, Vec3 } from "../crowd/model";
import { Pose, samplePose, sampleRoot } from "../crowd/sample";
import type { BodyPart, PatchSet, SetKind } from "../set/model";
import { partOf } from "../set/parts";
import { roleColor } from "./palette";

const PATH_WIDTH = 0.03;
const CORE_WIDTH = 0.055;
/** From corner to corner of a path, metres. */
const STEP = 0.03;
/** From a port to its label, metres. */
const LABEL_AWAY = 0.4;

export class Marks {
  readonly group = new Group();
  private readonly rings: Mesh[] = [];
  private readonly touches: Sprite[] = [];
  private readonly poses: Pose[];

  constructor(
    set: PatchSet,
    private readonly kind: SetKind,
    private readonly crowd: Crowd,
  ) {
    this.poses = crowd.characters.map(() => new Pose(crowd.joints.length));
    for (const [role, own] of kind.roles.entries()) {
      const color = roleColor(role);
      const ways = new Way(set, kind, crowd, role);
      this.group.add(flat(ways.triangles(), color, 0), flat(ways.seconds(), "#fdfcfa", 1));
      this.group.add(ways.label(0, `${words(set.groups[own.entry])} →`, color));
      this.group.add(ways.label(own.frames - 1, `→ ${words(set.groups[own.exit])}`, color));
      this.rings.push(ring(color));
    }
    this.touches = kind.contacts.map(() => halo());
    this.group.add(...this.rings, ...this.touches);
  }

  /** Moves what moves. */
  update(secs: number): void {
    const at = [0, 0, 0];
    for (const [person, ring] of this.rings.entries()) {
      ring.visible = sampleRoot(this.crowd, person, secs, at);
      ring.position.set(at[0], 0.012, at[2]);
    }
    const frame = secs * this.crowd.fps;
    for (const [i, { a, b, begin, end }] of this.kind.contacts.entries()) {
      const touch = this.touches[i];
      touch.visible = frame >= begin - 0.5 && frame <= end + 0.5;
      if (!touch.visible) continue;
      const [p, q] = [a, b].map((side) => this.part(side.role, side.part, secs));
      if (p && q) touch.position.set((p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2);
      else touch.visible = false;
    }
  }

  /** Where a part of somebody's body is; null while absent. */
  private part(role: number, part: BodyPart, secs: number): Vec3 | null {
    const pose = this.poses[role];
    if (!samplePose(this.crowd, role, secs, pose)) return null;
    return partOf(this.crowd, pose, part);
  }
}

/** One role's path on the floor. */
class Way {
  private readonly points: Vec2[] = [];
  private readonly headings: Float32Array;
  private readonly begin: number;

  constructor(
    private readonly set: PatchSet,
    private readonly kind: SetKind,
    crowd: Crowd,
    role: number,
  ) {
    const { firstFrame, frames, begin } = kind.roles[role];
    const first = crowd.characters[role].firstFrame;
    for (let f = 0; f < frames; f++) {
      this.points.push([crowd.pathPoints[(first + f) * 2], crowd.pathPoints[(first + f) * 2 + 1]]);
    }
    this.headings = set.headings.subarray(firstFrame, firstFrame + frames);
    this.begin = begin;
  }

  /** The path, wider where people act together; a ring at the entry, an arrowhead at the exit. */
  triangles(): number[] {
    const last = this.points.length - 1;
    const out: number[] = [];
    const [from, to] = this.kind.core ?? [0, -1];
    const corners = this.corners();
    for (const [i, f] of corners.entries()) {
      const next = corners[i + 1] ?? f;
      const inside = f + this.begin >= from && next + this.begin <= to;
      const width = inside ? CORE_WIDTH : PATH_WIDTH;
      strip(this.points[f], this.points[next], width, out);
      disc(this.points[f], 0, width / 2, out, 12);
    }
    disc(this.points[0], 0.11, 0.15, out);
    this.pointer(0, 0.18, 0.13, out);
    this.pointer(last, 0.02, 0.3, out);
    return out;
  }

  /** Frames that are some way from each other: somebody who stands sways, and a band along that would bristle. */
  private corners(): number[] {
    const last = this.points.length - 1;
    const kept = [0];
    for (let f = 1; f < last; f++) {
      const [a, b] = [this.points[kept[kept.length - 1]], this.points[f]];
      if (Math.hypot(b[0] - a[0], b[1] - a[1]) >= STEP) kept.push(f);
    }
    return [...kept, last];
  }

  /** A dot at every second of the kind's clock. */
  seconds(): number[] {
    const out: number[] = [];
    for (let frame = 0; frame <= this.kind.lastFrame; frame += this.set.fps) {
      const own = Math.round(frame) - this.begin;
      if (own >= 0 && own < this.points.length) disc(this.points[own], 0, 0.026, out);
    }
    return out;
  }

  /** The name of a pose group: behind an entry, ahead of an exit. */
  label(frame: number, text: string, color: string): Sprite {
    const made = sign(text, color);
    const [sin, cos] = [Math.sin(this.headings[frame]), Math.cos(this.headings[frame])];
    const away = frame === 0 ? -LABEL_AWAY : LABEL_AWAY + 0.18;
    made.position.set(this.points[frame][0] + sin * away, 0.1, this.points[frame][1] + cos * away);
    return made;
  }

  /** An arrowhead that begins `from` metres ahead of a frame's point and is `size` long, along the heading. */
  private pointer(frame: number, from: number, size: number, out: number[]): void {
    const [sin, cos] = [Math.sin(this.headings[frame]), Math.cos(this.headings[frame])];
    const [x, z] = this.points[frame];
    const place = (ahead: number, left: number): Vec2 => [x + sin * ahead + cos * left, z + cos * ahead - sin * left];
    const [tip, left, right, notch] = [
      place(from + size, 0),
      place(from, size * 0.42),
      place(from, -size * 0.42),
      place(from + size * 0.22, 0),
    ];
    for (const [px, pz] of [tip, notch, left, tip, right, notch]) out.push(px, 0, pz);
  }
}

/** A band of `width` from `a` to `b`. */
function strip(a: Vec2, b: Vec2, width: number, out: number[]): void {
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
  if (length < 1e-6) return;
  const [x, z] = [((b[0] - a[0]) / length) * (width / 2), ((b[1] - a[1]) / length) * (width / 2)];
  const corners: Vec2[] = [
    [a[0] - z, a[1] + x],
    [a[0] + z, a[1] - x],
    [b[0] + z, b[1] - x],
    [b[0] - z, b[1] + x],
  ];
  for (const i of [0, 2, 1, 0, 3, 2]) out.push(corners[i][0], 0, corners[i][1]);
}

/** A ring, or a disc if `inner` is 0. */
function disc([x, z]: Vec2, inner: number, outer: number, out: number[], corners = 28): void {
  const point = (i: number, r: number) => {
    const angle = (i / corners) * Math.PI * 2;
    return [x + Math.sin(angle) * r, 0, z + Math.cos(angle) * r];
  };
  for (let i = 0; i < corners; i++) {
    out.push(...point(i, inner), ...point(i, outer), ...point(i + 1, outer));
    if (inner > 0) out.push(...point(i, inner), ...point(i + 1, outer), ...point(i + 1, inner));
  }
}

/** Triangles on the floor, in layers. */
function flat(triangles: number[], color: string, layer: number): Mesh {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(triangles, 3));
  // Transparent only so that it is drawn after the ground, in the order of the layers.
  const material = new MeshBasicMaterial({ color, transparent: true, depthWrite: false, side: DoubleSide });
  const mesh = new Mesh(geometry, material);
  mesh.position.y = 0.006 + 0.002 * layer;
  mesh.renderOrder = 1.6 + 0.1 * layer;
  return mesh;
}

/** The ring under somebody, in the colour of the role. */
function ring(color: string): Mesh {
  const material = new MeshBasicMaterial({ color, transparent: true, opacity: 0.9, depthWrite: false });
  const mesh = new Mesh(new RingGeometry(0.27, 0.305, 48).rotateX(-Math.PI / 2), material);
  mesh.renderOrder = 1.8;
  return mesh;
}

function words(group: string): string {
  return group.replaceAll("_", " ");
}

/** A small sign with rounded corners that always faces the viewer. */
function sign(text: string, color: string): Sprite {
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("2d") as CanvasRenderingContext2D;
  const font = '600 44px "Inter Variable", Inter, system-ui, sans-serif';
  context.font = font;
  [canvas.width, canvas.height] = [Math.ceil(context.measureText(text).width) + 44, 76];
  context.font = font;
  context.fillStyle = "rgb(252 251 249 / 88%)";
  context.beginPath();
  context.roundRect(2, 2, canvas.width - 4, canvas.height - 4, 34);
  context.fill();
  context.fillStyle = `#${new Color(color).lerp(new Color("#25231f"), 0.25).getHexString()}`;
  context.textBaseline = "middle";
  context.fillText(text, 22, canvas.height / 2 + 2);
  const made = sprite(canvas, true);
  made.scale.set((0.15 * canvas.width) / canvas.height, 0.15, 1);
  made.renderOrder = 3;
  return made;
}

/** A bright ring around the place where people touch, seen through bodies. */
function halo(): Sprite {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 128;
  const context = canvas.getContext("2d") as CanvasRenderingContext2D;
  const glow = context.createRadialGradient(64, 64, 0, 64, 64, 62);
  glow.addColorStop(0, "rgb(255 190 90 / 55%)");
  glow.addColorStop(0.5, "rgb(255 170 60 / 25%)");
  glow.addColorStop(0.68, "rgb(240 140 40 / 30%)");
  glow.addColorStop(0.74, "rgb(255 176 70 / 100%)");
  glow.addColorStop(0.84, "rgb(255 176 70 / 100%)");
  glow.addColorStop(0.9, "rgb(240 140 40 / 20%)");
  glow.addColorStop(1, "rgb(240 140 40 / 0%)");
  context.fillStyle = glow;
  context.fillRect(0, 0, 128, 128);
  const made = sprite(canvas, false);
  made.scale.setScalar(0.24);
  made.renderOrder = 4;
  return made;
}

function sprite(canvas: HTMLCanvasElement, depthTest: boolean): Sprite {
  const map = new CanvasTexture(canvas);
  map.colorSpace = SRGBColorSpace;
  return new Sprite(new SpriteMaterial({ map, depthTest, depthWrite: false, toneMapped: false }));
}
