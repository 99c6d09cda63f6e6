/** The boxes of a kind as those of its crowd: where they are follows from the palms of who holds them. */

import type { Crowd, Prop, Vec2, Vec3 } from "../crowd/model";
import { Pose, samplePose } from "../crowd/sample";
import type { SetKind, SetProp } from "./model";
import { partOf } from "./parts";

type Place = readonly [x: number, y: number, z: number, heading: number];

/** Props and their places; `centre` is the point of the kind's own ground that is the middle of the crowd's floor. */
export function boxesOf(kind: SetKind, crowd: Crowd, centre: Vec2): Pick<Crowd, "props" | "propPlaces"> {
  const places: number[] = [];
  const props = kind.props.map((prop): Prop => {
    const [begin, end] = lifetime(prop, kind);
    const firstFrame = places.length / 4;
    for (let frame = begin; frame <= end; frame++) places.push(...placeOf(prop, frame, crowd, centre));
    const holds = prop.holds.map((h) => ({ character: h.role, begin: h.begin, end: h.end }));
    return { name: prop.name, size: prop.size, begin, frames: end - begin + 1, firstFrame, holds };
  });
  return { props, propPlaces: new Float32Array(places) };
}

/** What was brought along is there from the first hold, what is taken along to the last. */
function lifetime({ holds, before, after }: SetProp, kind: SetKind): [begin: number, end: number] {
  return [before ? 0 : holds[0].begin, after ? kind.lastFrame : holds[holds.length - 1].end];
}

function placeOf(prop: SetProp, frame: number, crowd: Crowd, centre: Vec2): Place {
  const hold = prop.holds.find((h) => h.begin <= frame && frame <= h.end);
  if (hold) return inHands(prop, hold.role, frame, crowd);
  const done = prop.holds.filter((h) => h.end < frame);
  if (done.length > 0 && done.length < prop.holds.length) {
    const last = done[done.length - 1];
    return settled(inHands(prop, last.role, last.end, crowd), prop.size[1]);
  }
  const rest = done.length === 0 ? prop.before : prop.after;
  const [x, y, z] = rest?.middle ?? [centre[0], 0, centre[1]];
  return [x - centre[0], y, z - centre[1], rest?.heading ?? 0];
}

function inHands(prop: SetProp, role: number, frame: number, crowd: Crowd): Place {
  const pose = new Pose(crowd.joints.length);
  samplePose(crowd, role, inside(crowd, role, frame), pose);
  return between(partOf(crowd, pose, "left_hand"), partOf(crowd, pose, "right_hand"), prop.grip);
}

/** On the ground where it all but is; as src/patch/prop.rs has it. */
function settled([x, y, z, heading]: Place, height: number): Place {
  const nearly = 0.08;
  return [x, y < height / 2 + nearly ? height / 2 : y, z, heading];
}

/** Seconds of a frame, kept inside a person's life where rounding would put it a hair outside. */
function inside(crowd: Crowd, person: number, frame: number): number {
  const { begin, frames } = crowd.characters[person];
  const hair = 1e-6;
  return Math.min(Math.max(frame, begin + hair), begin + frames - 1 - hair) / crowd.fps;
}

/** A level box between two palms, its width from the right one to the left one. */
function between(left: Vec3, right: Vec3, [up, ahead]: SetProp["grip"]): Place {
  const heading = Math.atan2(-(left[2] - right[2]), left[0] - right[0]);
  const middle = [0, 1, 2].map((k) => (left[k] + right[k]) / 2);
  return [middle[0] + Math.sin(heading) * ahead, middle[1] + up, middle[2] + Math.cos(heading) * ahead, heading];
}
