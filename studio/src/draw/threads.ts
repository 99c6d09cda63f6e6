/** The loom's threads: a tube per person through (x, time, z). */

import { Color } from "three";
import type { Crowd } from "../crowd/model";
import { categorical } from "./palette";

const SIDES = 5;

export interface Threads {
  positions: number[];
  normals: number[];
  colors: number[];
  people: number[];
  indices: number[];
}

/** Tubes of all people; `rise` is the height of one frame, `radius` the thickness. */
export function threads(crowd: Crowd, rise: number, radius: number): Threads {
  const out: Threads = { positions: [], normals: [], colors: [], people: [], indices: [] };
  const every = crowd.characters.length > 500 ? 15 : 5;
  for (const [person, c] of crowd.characters.entries()) {
    // Pieces of one fragment each, so that the colour changes exactly at the stitch.
    const cuts = c.fragments.slice(1).map((f) => f.begin - c.begin);
    let from = 0;
    for (const [k, f] of c.fragments.entries()) {
      const to = Math.min(Math.max(cuts[k] ?? c.frames - 1, 0), c.frames - 1);
      if (to > from) {
        const shared = crowd.kinds[crowd.instances[f.instance]].people > 1;
        const color = new Color(categorical(f.instance));
        // Single-person patches step back: half-way to grey.
        if (!shared) color.lerp(new Color("#9f9b92"), 0.42);
        tube(crowd, person, from, to, every, rise, shared ? radius * 1.7 : radius, color, out);
        from = to;
      }
    }
  }
  return out;
}

function tube(
  crowd: Crowd,
  person: number,
  from: number,
  to: number,
  every: number,
  rise: number,
  radius: number,
  color: Color,
  out: Threads,
): void {
  const c = crowd.characters[person];
  const steps = Math.max(1, Math.round((to - from) / every));
  const point = (frame: number) => {
    const at = (c.firstFrame + frame) * 3;
    return [crowd.root[at], (c.begin + frame) * rise, crowd.root[at + 2]] as const;
  };
  const start = out.positions.length / 3;
  for (let s = 0; s <= steps; s++) {
    const [x, y, z] = point(Math.round(from + ((to - from) * s) / steps));
    for (let k = 0; k < SIDES; k++) {
      // Rings are level: threads never run level themselves, and level rings join without a twist.
      const angle = (k / SIDES) * Math.PI * 2;
      const [nx, nz] = [Math.cos(angle), Math.sin(angle)];
      out.positions.push(x + nx * radius, y, z + nz * radius);
      out.normals.push(nx, 0, nz);
      out.colors.push(color.r, color.g, color.b);
      out.people.push(person);
    }
    if (s === 0) continue;
    const ring = start + s * SIDES;
    for (let k = 0; k < SIDES; k++) {
      const next = (k + 1) % SIDES;
      out.indices.push(ring - SIDES + k, ring + k, ring - SIDES + next, ring - SIDES + next, ring + k, ring + next);
    }
  }
}
