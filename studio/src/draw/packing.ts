/**
 * How a crowd lies in textures. Plain arrays, so that tests can check the layout without a GPU.
 *
 * A list of values is cut into rows of `width` texels: value i is texel (i % width, i / width).
 */

import type { Crowd } from "../crowd/model";

export interface Packed<T> {
  data: T;
  width: number;
  height: number;
}

function size(texels: number, width: number): { width: number; height: number; length: number } {
  const height = Math.max(1, Math.ceil(texels / width));
  return { width, height, length: width * height * 4 };
}

/** One texel per frame and joint: x, y, z, w times 32767, as in the file. */
export function packRotations(crowd: Crowd, width: number): Packed<Int16Array> {
  const { length, ...shape } = size(crowd.rotations.length / 4, width);
  const data = new Int16Array(length);
  data.set(crowd.rotations);
  return { data, ...shape };
}

/** One texel per frame: hips x, y, z, and the place of the frame's fragment in the list of all fragments. */
export function packRoots(crowd: Crowd, width: number): Packed<Float32Array> {
  const { length, ...shape } = size(crowd.root.length / 3, width);
  const data = new Float32Array(length);
  let firstFragment = 0;
  for (const c of crowd.characters) {
    let k = 0;
    for (let i = 0; i < c.frames; i++) {
      while (k + 1 < c.fragments.length && c.fragments[k + 1].begin <= c.begin + i) k++;
      const at = c.firstFrame + i;
      data.set(crowd.root.subarray(at * 3, at * 3 + 3), at * 4);
      data[at * 4 + 3] = c.fragments.length > 0 ? firstFragment + k : -1;
    }
    firstFragment += c.fragments.length;
  }
  return { data, ...shape };
}

/** One texel per person: first frame in the lists above, first frame on the crowd's clock, number of frames, build. */
export function packPeople(crowd: Crowd, width: number): Packed<Int32Array> {
  const { length, ...shape } = size(crowd.characters.length, width);
  const data = new Int32Array(length);
  for (const [i, c] of crowd.characters.entries()) data.set([c.firstFrame, c.begin, c.frames, c.build], i * 4);
  return { data, ...shape };
}

/** Two texels per build and joint: the offset x, y, z from the parent and 0; the flesh's scale x, y, z and shift. */
export function packBuilds(crowd: Crowd, width: number): Packed<Float32Array> {
  const { length, ...shape } = size(crowd.builds.length * crowd.joints.length * 2, width);
  const data = new Float32Array(length);
  const rows = crowd.builds.flatMap((b) => b.offsets.flatMap((offset, j) => [...offset, 0, ...b.flesh[j]]));
  data.set(rows);
  return { data, ...shape };
}

/** Two texels (sRGB) per fragment: the colour of its kind, that of its instance; alpha 255 where people share it. */
export function packFragmentColors(
  crowd: Crowd,
  width: number,
  kindColor: (kind: number) => readonly number[],
  instanceColor: (instance: number) => readonly number[],
): Packed<Uint8Array> {
  const fragments = crowd.characters.reduce((sum, c) => sum + c.fragments.length, 0);
  const { length, ...shape } = size(fragments * 2, width);
  const data = new Uint8Array(length);
  let at = 0;
  for (const c of crowd.characters) {
    for (const f of c.fragments) {
      const kind = crowd.instances[f.instance];
      const shared = crowd.kinds[kind].people > 1 ? 255 : 0;
      data.set([...kindColor(kind), shared, ...instanceColor(f.instance), shared], at);
      at += 8;
    }
  }
  return { data, ...shape };
}
