import { describe, expect, it } from "vitest";
import { readCrowd } from "../src/crowd/reader";
import { sampleRoot } from "../src/crowd/sample";
import { intoTile, repeatsInSpace, tileOf, tileOffsets } from "../src/crowd/tiles";
import { advance } from "../src/play/player";
import { fixtureCrowd } from "./fixture";

function crowd(periodic?: object) {
  const alter = (header: Record<string, unknown>) => {
    const domain = header.domain as Record<string, unknown>;
    if (periodic) domain.periodic = periodic;
    domain.region = {
      points: [
        [-1, -2],
        [3, -2],
        [3, 1],
        [-1, 1],
      ],
    };
  };
  return readCrowd(fixtureCrowd({ people: 7, secs: 3, version: periodic ? 4 : 2, alter }).bytes);
}

describe("a crowd whose ground repeats", () => {
  it("is shown inside its region, every person a whole number of tiles from where the file has them", () => {
    const [plain, tiled] = [crowd(), crowd({ x: true, z: true, t: true })];
    const [a, b] = [
      [0, 0, 0],
      [0, 0, 0],
    ];
    for (let person = 0; person < 7; person++) {
      for (let secs = 0; secs <= 3; secs += 0.37) {
        sampleRoot(plain, person, secs, a);
        sampleRoot(tiled, person, secs, b);
        expect(b[0]).toBeGreaterThanOrEqual(-1.001);
        expect(b[0]).toBeLessThanOrEqual(3.001);
        expect(b[2]).toBeGreaterThanOrEqual(-2.001);
        expect(b[2]).toBeLessThanOrEqual(1.001);
        for (const [axis, period] of [
          [0, 4],
          [2, 3],
        ]) {
          const laps = (b[axis] - a[axis]) / period;
          expect(laps).toBeCloseTo(Math.round(laps), 5);
        }
        expect(b[1]).toBe(a[1]);
      }
    }
  });

  it("has tiles around it along what repeats, its own first", () => {
    expect(tileOffsets(tileOf(crowd()))).toEqual([[0, 0]]);
    expect(tileOffsets(tileOf(crowd({ x: true })))).toEqual([
      [0, 0],
      [-4, 0],
      [4, 0],
    ]);
    const all = tileOffsets(tileOf(crowd({ x: true, z: true })));
    expect(all[0]).toEqual([0, 0]);
    expect(new Set(all.map(String)).size).toBe(9);
    expect(all).toContainEqual([4, -3]);
  });

  it("is told from others", () => {
    expect([crowd(), crowd({ t: true }), crowd({ z: true }), null].map(repeatsInSpace)).toEqual([
      false,
      false,
      true,
      false,
    ]);
    expect([intoTile(7, 0, 0), intoTile(7, 0, 4), intoTile(-7, 0, 4)]).toEqual([0, -8, 8]);
  });

  it("comes round without a jump: the end is the beginning", () => {
    const { time, ended } = advance(19.99, 1 / 60, 20, true);
    expect(ended).toBe(false);
    expect(time).toBeCloseTo(19.99 + 1 / 60 - 20, 9);
  });
});
