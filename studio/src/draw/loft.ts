/** Lofts: smooth surfaces through rings. What the mannequin is built of. */

import type { Vec3 } from "../crowd/model";
import type { Part } from "./palette";

/** Up to four (joint, weight) pairs. */
export type Weights = readonly (readonly [joint: number, weight: number])[];

export interface Ring {
  center: Vec3;
  /** Half-axes: points are center + cos * u + sin * v. */
  u: Vec3;
  v: Vec3;
  /** Superellipse exponent: 2 is an ellipse, more is boxier. */
  power?: number;
  part: Part;
  weights: Weights | ((point: Vec3) => Weights);
}

export class MeshBuilder {
  readonly positions: number[] = [];
  readonly normals: number[] = [];
  readonly bones: number[] = [];
  readonly weights: number[] = [];
  readonly parts: number[] = [];
  readonly indices: number[] = [];
  /** First vertex of every loft. */
  private readonly starts: number[] = [];

  /** `detail` scales the number of sides of all lofts. */
  constructor(private readonly detail: number) {}

  /** A closed surface through `rings`; ends are closed by their centres. Where the part changes, a crisp border. */
  loft(rings: readonly Ring[], sides: number): void {
    const n = Math.max(5, Math.round(sides * this.detail));
    const first = this.positions.length / 3;
    const firstIndex = this.indices.length;
    this.starts.push(first);
    let previous = -1;
    for (const [i, ring] of rings.entries()) {
      if (i === 0) this.cap(ring, n, true);
      else {
        const last = rings[i - 1];
        if (ring.part !== last.part) previous = this.ring({ ...last, part: ring.part }, n);
        const current = this.ring(ring, n);
        this.band(previous, current, n);
        previous = current;
        continue;
      }
      previous = this.positions.length / 3 - n;
    }
    this.cap(rings[rings.length - 1], n, false, previous);
    this.smooth(first, firstIndex);
  }

  /**
   * Softens the creases where lofts of the same part run into each other (sleeve and shirt, leg and seat): within
   * `reach` metres, normals lean towards those of the other loft.
   */
  blendNormals(reach: number): void {
    const p = this.positions;
    const total = p.length / 3;
    const loft = new Uint16Array(total);
    for (const start of this.starts) for (let v = start; v < total; v++) loft[v]++;
    const before = [...this.normals];
    for (let v = 0; v < total; v++) {
      let [nearest, other] = [reach, -1];
      for (let w = 0; w < total; w++) {
        if (loft[w] === loft[v] || this.parts[w] !== this.parts[v]) continue;
        const d = Math.hypot(p[v * 3] - p[w * 3], p[v * 3 + 1] - p[w * 3 + 1], p[v * 3 + 2] - p[w * 3 + 2]);
        if (d < nearest) [nearest, other] = [d, w];
      }
      if (other < 0) continue;
      const share = 0.5 * (1 - nearest / reach);
      const n = [0, 1, 2].map((k) => before[v * 3 + k] * (1 - share) + before[other * 3 + k] * share);
      const length = Math.hypot(...n) || 1;
      for (let k = 0; k < 3; k++) this.normals[v * 3 + k] = n[k] / length;
    }
  }

  private ring(ring: Ring, n: number): number {
    const start = this.positions.length / 3;
    for (let s = 0; s < n; s++) {
      const angle = (s / n) * Math.PI * 2;
      const power = 2 / (ring.power ?? 2);
      const c = Math.sign(Math.cos(angle)) * Math.abs(Math.cos(angle)) ** power;
      const d = Math.sign(Math.sin(angle)) * Math.abs(Math.sin(angle)) ** power;
      const point = [0, 1, 2].map((a) => ring.center[a] + c * ring.u[a] + d * ring.v[a]) as unknown as Vec3;
      this.vertex(point, ring);
    }
    return start;
  }

  private vertex(point: Vec3, ring: Ring): void {
    const weights = typeof ring.weights === "function" ? ring.weights(point) : ring.weights;
    const sum = weights.reduce((total, [, w]) => total + w, 0);
    this.positions.push(...point);
    this.normals.push(0, 0, 0);
    for (let k = 0; k < 4; k++) {
      this.bones.push(weights[k]?.[0] ?? 0);
      this.weights.push((weights[k]?.[1] ?? 0) / sum);
    }
    this.parts.push(ring.part);
  }

  private band(a: number, b: number, n: number): void {
    for (let s = 0; s < n; s++) {
      const next = (s + 1) % n;
      this.indices.push(a + s, b + s, a + next, a + next, b + s, b + next);
    }
  }

  private cap(ring: Ring, n: number, first: boolean, start = -1): void {
    const center = this.positions.length / 3;
    this.vertex(ring.center, ring);
    const rim = first ? this.ring(ring, n) : start;
    for (let s = 0; s < n; s++) {
      const next = (s + 1) % n;
      if (first) this.indices.push(center, rim + s, rim + next);
      else this.indices.push(center, rim + next, rim + s);
    }
  }

  /** Area-weighted normals of a loft; doubled vertices at borders share them. Turned outwards as a whole. */
  private smooth(first: number, firstIndex: number): void {
    const p = this.positions;
    const sums = new Map<string, [number, number, number]>();
    const key = (v: number) => [0, 1, 2].map((a) => Math.round(p[v * 3 + a] * 1e5)).join();
    let volume = 0;
    for (let i = firstIndex; i < this.indices.length; i += 3) {
      const [a, b, c] = this.indices.slice(i, i + 3);
      const e = [0, 1, 2].map((k) => p[b * 3 + k] - p[a * 3 + k]);
      const f = [0, 1, 2].map((k) => p[c * 3 + k] - p[a * 3 + k]);
      const normal = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
      volume += normal[0] * p[a * 3] + normal[1] * p[a * 3 + 1] + normal[2] * p[a * 3 + 2];
      for (const v of [a, b, c]) {
        const sum = sums.get(key(v)) ?? [0, 0, 0];
        for (let k = 0; k < 3; k++) sum[k] += normal[k];
        sums.set(key(v), sum);
      }
    }
    const sign = volume < 0 ? -1 : 1;
    for (let v = first; v < p.length / 3; v++) {
      const sum = sums.get(key(v)) ?? [0, 1, 0];
      const length = sign * (Math.hypot(...sum) || 1);
      for (let k = 0; k < 3; k++) this.normals[v * 3 + k] = sum[k] / length;
    }
    if (sign < 0) {
      for (let i = firstIndex; i < this.indices.length; i += 3) {
        [this.indices[i + 1], this.indices[i + 2]] = [this.indices[i + 2], this.indices[i + 1]];
      }
    }
  }
}
