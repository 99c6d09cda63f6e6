/** Flat bands along closed outlines, as triangles: lines with a real width. */

import type { Vec2 } from "../crowd/model";

/** Triangles (x, y, z) of a band of `width` inside and along a convex or mild outline at height `y`. */
export function band(outline: readonly Vec2[], width: number, y: number): number[] {
  const inner = outline.map((_, i) => inset(outline, i, width));
  const out: number[] = [];
  for (let i = 0; i < outline.length; i++) {
    const j = (i + 1) % outline.length;
    const [a, b, c, d] = [outline[i], outline[j], inner[i], inner[j]];
    for (const [x, z] of [a, c, b, b, c, d]) out.push(x, y, z);
  }
  return facingUp(out);
}

/** Triangles (x, y, z) of a convex outline's inside at height `y`. */
export function fan(outline: readonly Vec2[], y: number): number[] {
  const out: number[] = [];
  for (let i = 1; i + 1 < outline.length; i++) {
    for (const [x, z] of [outline[0], outline[i], outline[i + 1]]) out.push(x, y, z);
  }
  return facingUp(out);
}

/** The corner `i` moved inwards so that both its edges move by `width`. */
function inset(outline: readonly Vec2[], i: number, width: number): Vec2 {
  const n = outline.length;
  const [p, q, r] = [outline[(i + n - 1) % n], outline[i], outline[(i + 1) % n]];
  const normal = (a: Vec2, b: Vec2): Vec2 => {
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
    return [-(b[1] - a[1]) / length, (b[0] - a[0]) / length];
  };
  const [e, f] = [normal(p, q), normal(q, r)];
  const scale = width / Math.max(1 + e[0] * f[0] + e[1] * f[1], 0.2);
  return [q[0] + (e[0] + f[0]) * scale, q[1] + (e[1] + f[1]) * scale];
}

/** Turns triangles so that they face up (counter-clockwise seen from above, y towards the viewer). */
function facingUp(t: number[]): number[] {
  for (let i = 0; i < t.length; i += 9) {
    const up = (t[i + 5] - t[i + 2]) * (t[i + 6] - t[i]) - (t[i + 3] - t[i]) * (t[i + 8] - t[i + 2]);
    if (up >= 0) continue;
    for (let k = 0; k < 3; k++) [t[i + 3 + k], t[i + 6 + k]] = [t[i + 6 + k], t[i + 3 + k]];
  }
  return t;
}
