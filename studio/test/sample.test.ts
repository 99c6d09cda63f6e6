import { describe, expect, it } from "vitest";
import { readCrowd } from "../src/crowd/reader";
import { ownFrame, Pose, samplePose, sampleRoot } from "../src/crowd/sample";
import { packBuilds, packFragmentColors, packPeople, packRoots, packRotations } from "../src/draw/packing";
import { fixtureCrowd } from "./fixture";

const fixture = fixtureCrowd({ people: 7, secs: 3 });
const crowd = readCrowd(fixture.bytes);
const last = crowd.lastFrame;

describe("sampling", () => {
  it("gives the joints the fixture was made from, within the packing's error", () => {
    const pose = new Pose(crowd.joints.length);
    for (let person = 0; person < 7; person++) {
      for (const frame of [0, 17, 44, last]) {
        expect(samplePose(crowd, person, frame / crowd.fps, pose)).toBe(true);
        const truth = fixture.truth(person, frame);
        for (let j = 0; j < crowd.joints.length; j++) {
          for (let axis = 0; axis < 3; axis++) expect(pose.positions[j * 3 + axis]).toBeCloseTo(truth[j][axis], 3);
        }
      }
    }
  });

  it("keeps bones as long as they are between frames", () => {
    const pose = new Pose(crowd.joints.length);
    const { offsets } = crowd.builds[1];
    expect(offsets).not.toEqual(crowd.builds[0].offsets);
    for (let secs = 0; secs < 3; secs += 0.0137) {
      samplePose(crowd, 4, secs, pose);
      for (const [j, { parent }] of crowd.joints.entries()) {
        if (parent < 0) continue;
        const d = [0, 1, 2].map((a) => pose.positions[j * 3 + a] - pose.positions[parent * 3 + a]);
        expect(Math.hypot(...d)).toBeCloseTo(Math.hypot(...offsets[j]), 4);
      }
    }
  });

  it("goes half-way between two frames and knows who is absent", () => {
    const [a, b, half] = [
      [0, 0, 0],
      [0, 0, 0],
      [0, 0, 0],
    ];
    sampleRoot(crowd, 1, 10 / 30, a);
    sampleRoot(crowd, 1, 11 / 30, b);
    sampleRoot(crowd, 1, 10.5 / 30, half);
    for (let axis = 0; axis < 3; axis++) expect(half[axis]).toBeCloseTo((a[axis] + b[axis]) / 2, 5);
    expect(ownFrame(crowd, 1, -0.01)).toBe(-1);
    expect(ownFrame(crowd, 1, (last + 0.5) / 30)).toBe(-1);
    expect(ownFrame(crowd, 1, last / 30)).toBeCloseTo(last, 4);
  });
});

describe("the textures' layout", () => {
  const width = 50;
  /** Value `i` as the shader fetches it. */
  const texel = (packed: { data: ArrayLike<number>; width: number }, i: number) => {
    const at = (Math.floor(i / packed.width) * packed.width + (i % packed.width)) * 4;
    return [0, 1, 2, 3].map((k) => packed.data[at + k]);
  };
  const people = packPeople(crowd, width);
  const rotations = packRotations(crowd, width);
  const roots = packRoots(crowd, width);

  it("holds every person's frames where the shader looks", () => {
    for (const [person, c] of crowd.characters.entries()) {
      const [firstFrame, begin, frames, build] = texel(people, person);
      expect([firstFrame, begin, frames, build]).toEqual([c.firstFrame, c.begin, c.frames, person % 3 === 1 ? 1 : 0]);
      const out = [0, 0, 0];
      for (const frame of [0, 31, last]) {
        sampleRoot(crowd, person, frame / 30, out);
        const [x, y, z] = texel(roots, firstFrame + frame);
        for (const [axis, v] of [x, y, z].entries()) expect(v).toBeCloseTo(out[axis], 4);
        const q = texel(rotations, (firstFrame + frame) * 22 + 5);
        expect(Math.hypot(...q)).toBeCloseTo(32767, -1);
      }
    }
  });

  it("holds every build's bones and flesh", () => {
    const builds = packBuilds(crowd, width);
    for (const [b, build] of crowd.builds.entries()) {
      for (let j = 0; j < crowd.joints.length; j++) {
        const at = (b * crowd.joints.length + j) * 2;
        for (const [k, v] of [...build.offsets[j], 0].entries()) expect(texel(builds, at)[k]).toBeCloseTo(v, 6);
        for (const [k, v] of build.flesh[j].entries()) expect(texel(builds, at + 1)[k]).toBeCloseTo(v, 6);
      }
    }
  });

  it("names the fragment of every frame", () => {
    let first = 0;
    for (const c of crowd.characters) {
      for (let i = 0; i < c.frames; i += 7) {
        const fragment = texel(roots, c.firstFrame + i)[3] - first;
        const { begin, end } = c.fragments[fragment];
        expect(begin).toBeLessThanOrEqual(c.begin + i);
        expect(end).toBeGreaterThanOrEqual(c.begin + i);
      }
      first += c.fragments.length;
    }
  });

  it("marks the colours of shared patches", () => {
    const colors = packFragmentColors(
      crowd,
      width,
      (kind) => [kind, 1, 2],
      (instance) => [instance % 256, 3, 4],
    );
    let i = 0;
    for (const f of crowd.characters.flatMap((c) => c.fragments)) {
      const kind = crowd.instances[f.instance];
      const alpha = crowd.kinds[kind].people > 1 ? 255 : 0;
      expect(texel(colors, i * 2)).toEqual([kind, 1, 2, alpha]);
      expect(texel(colors, i * 2 + 1)).toEqual([f.instance % 256, 3, 4, alpha]);
      i++;
    }
  });
});
