/** Who is drawn how: a committed world in which somebody does something, and nobody has a walking body. */

import { readFileSync } from "node:fs";
import { Vector3 } from "three";
import { expect, it } from "vitest";
import { actors } from "../src/world/acts";
import { Figures } from "../src/world/figures";
import { readWorld } from "../src/world/reader";
import type { Walker } from "../src/world/sample";

it("without a gait those who do something have bodies, and walkers are drawn as from afar", () => {
  const file = readFileSync(new URL("../../tests/files/acts.world", import.meta.url));
  const world = readWorld(file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength) as ArrayBuffer);
  expect(world.gait).toBeNull();
  const busy: Walker[] = [];
  for (const place of world.places) actors(world, place, 1, [0, 0], busy);
  expect(busy.length).toBe(1);
  const walking: Walker[] = [1, 2, 3].map((x) => ({ ...busy[0], x: busy[0].x + x, act: undefined }));
  const figures = new Figures(world.gait, world.acts);
  expect(figures.near).not.toBeNull();
  const eye = new Vector3(busy[0].x, 1.7, busy[0].z);
  expect(figures.show([...walking, ...busy], eye, 1000)).toEqual({ near: 1, far: walking.length });
  expect(figures.show([...walking, ...busy], eye, 0)).toEqual({ near: 0, far: walking.length + 1 });
});
