/** One role's path on the floor: where it goes, every second, where it comes from and leads to. */

import { BufferGeometry, DoubleSide, Float32BufferAttribute, Mesh, MeshBasicMaterial, type Sprite } from "three";
import type { Crowd, Vec2 } from "../crowd/model";
import type { PatchSet, SetKind } from "../set/model";
import { sign } from "./signs";

const PATH_WIDTH = 0.03;
const CORE_WIDTH = 0.055;
/** From corner to corner of a path, metres. */
const STEP = 0.03;
/** From a port to its label, metres. */
const LABEL_AWAY = 0.4;
const LABEL_ASIDE = 0.3;

export class Way {
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

  /** All of it but the labels, which face the viewer. */
  onFloor(color: string): Mesh[] {
    return [flat(this.triangles(), color, 0), flat(this.seconds(), "#fdfcfa", 1)];
  }

  /** The path, wider where people act together; a ring at the entry, an arrowhead at the exit. */
  private triangles(): number[] {
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
  private seconds(): number[] {
    const out: number[] = [];
    for (let frame = 0; frame <= this.kind.lastFrame; frame += this.set.fps) {
      const own = Math.round(frame) - this.begin;
      if (own >= 0 && own < this.points.length) disc(this.points[own], 0, 0.026, out);
    }
    return out;
  }

  /** The name of a pose group: behind an entry; ahead of an exit and to its left, or those of two face to face would meet. */
  label(frame: number, text: string, color: string): Sprite {
    const made = sign(text, color);
    const [sin, cos] = [Math.sin(this.headings[frame]), Math.cos(this.headings[frame])];
    const [ahead, left] = frame === 0 ? [-LABEL_AWAY, 0] : [LABEL_AWAY, LABEL_ASIDE];
    const [x, z] = this.points[frame];
    made.position.set(x + sin * ahead + cos * left, 0.1, z + cos * ahead - sin * left);
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
