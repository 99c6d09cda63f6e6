import { describe, expect, it } from "vitest";
import { FileProblem } from "../src/crowd/container";
import { obstacle, placeOf } from "../src/crowd/obstacle";
import { readCrowd } from "../src/crowd/reader";
import { fixtureCrowd } from "./fixture";

const path = [
  { secs: 2, position: [0, 0], heading: 0 },
  { secs: 4, position: [4, 2], heading: Math.PI / 2 },
];

describe("obstacles", () => {
  it("are where they are when, and rest at both ends", () => {
    const cart = obstacle({ height: 0.3, path }, [], "cart");
    expect(placeOf(cart, -1)).toMatchObject({ position: [0, 0], heading: 0 });
    expect(placeOf(cart, 3)).toEqual({ position: [2, 1], heading: Math.PI / 4 });
    expect(placeOf(cart, 9).position).toEqual([4, 2]);
    expect(placeOf(obstacle({}, [], "wall"), 3)).toEqual({ position: [0, 0], heading: 0 });
  });

  it("are read from files, walls from older ones as well", () => {
    const crowd = readCrowd(
      fixtureCrowd({
        people: 3,
        secs: 2,
        version: 3,
        alter: (header) => {
          const domain = header.domain as { obstacles: object[] };
          domain.obstacles[0] = { ...domain.obstacles[0], height: 0.3, path };
        },
      }).bytes,
    );
    expect(crowd.obstacles.map((o) => o.height)).toEqual([0.3, null]);
    expect(crowd.obstacles.map((o) => o.path.length)).toEqual([2, 0]);
    expect(crowd.obstacles[0].points).toHaveLength(4);
  });

  it("that are broken are named", () => {
    const broken = [
      { height: 0 },
      { path: [path[1], path[0]] },
      { path: [{ ...path[0], position: [1] }] },
      { path: 3 },
    ];
    for (const value of broken) expect(() => obstacle(value, [], "obstacle 0")).toThrow(FileProblem);
  });
});
