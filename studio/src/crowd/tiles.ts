/** Crowds whose ground repeats: people are shown inside the region, and the tiles around it are images of it. */

import { bounds } from "./hull";
import type { Crowd, Vec2 } from "./model";

/** Where the region's middle is, and how far it is to the next tile along x and z; 0 where the ground does not repeat. */
export interface Tile {
  middle: Vec2;
  period: Vec2;
}

export function tileOf(crowd: Crowd): Tile {
  const { low, high } = bounds(crowd.region);
  const side = (axis: 0 | 1, repeats: boolean) => (repeats ? high[axis] - low[axis] : 0);
  return {
    middle: [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2],
    period: [side(0, crowd.periodic.x), side(1, crowd.periodic.z)],
  };
}

/** What to add along one axis so that a place is in the region. */
export function intoTile(at: number, middle: number, period: number): number {
  return period > 0 ? -period * Math.round((at - middle) / period) : 0;
}

/** Where the tiles of a block of 3 x 3 are, seen from the middle one, which comes first; fewer along what does not repeat. */
export function tileOffsets({ period }: Tile): Vec2[] {
  const steps = (p: number) => (p > 0 ? [0, -1, 1] : [0]);
  return steps(period[1]).flatMap((z) => steps(period[0]).map((x): Vec2 => [x * period[0], z * period[1]]));
}

/** True if there is more than one tile to show. */
export function repeatsInSpace(crowd: Crowd | null): boolean {
  return crowd !== null && (crowd.periodic.x || crowd.periodic.z);
}
