/** Reads a patch-set file (`*.patches`); see src/patch/file.rs for the format. */

import { Container, count, FileProblem, finite, list, object, shown, text } from "../crowd/container";
import type { Vec3 } from "../crowd/model";
import { joint, vector } from "../crowd/reader";
import {
  type BodyPart,
  type Contact,
  PARTS,
  type PatchSet,
  type Role,
  type SetKind,
  type SetProp,
  type Touch,
  type Upright,
} from "./model";

export const MAGIC = "CQPATCH";
/** Files of version 1 have no boxes. */
export const VERSIONS = [1, 2];

/** The set in `buffer`. Throws a FileProblem that names the place. */
export function readSet(buffer: ArrayBuffer): PatchSet {
  const file = Container.open(buffer, MAGIC, VERSIONS);
  const { header } = file;
  const set: PatchSet = {
    fps: finite(header.fps, "header.fps"),
    joints: list(object(header.skeleton, "header.skeleton").joints, "header.skeleton.joints").map(joint),
    groups: list(header.groups, "header.groups").map((g, i) => text(object(g, `group ${i}`).name, `group ${i}, name`)),
    kinds: kinds(list(header.kinds, "header.kinds")),
    points: file.array("points", "f32"),
    headings: file.array("headings", "f32"),
    heights: file.array("heights", "f32"),
    rotations: file.array("rotations", "i16"),
  };
  if (set.fps <= 0) throw new FileProblem("header.fps", `expected a positive rate, found ${set.fps}`);
  checkLengths(set);
  for (const kind of set.kinds) checkKind(set, kind);
  return set;
}

function kinds(values: unknown[]): SetKind[] {
  let firstFrame = 0;
  return values.map((value, index) => {
    const place = `kind ${index}`;
    const v = object(value, place);
    const roles = list(v.fragments, `${place}, fragments`).map((f, r) => {
      const read = role(f, `${place}, role ${r}`, firstFrame);
      firstFrame += read.frames;
      return read;
    });
    return {
      name: text(v.name, `${place}, name`),
      labels: list(v.labels, `${place}, labels`).map((l) => text(l, `${place}, labels`)),
      mirrored: v.mirrored === true,
      core: core(v.core, `${place}, core`),
      contacts: list(v.contacts, `${place}, contacts`).map((c, i) => contact(c, `${place}, contact ${i}`)),
      props: list(v.props ?? [], `${place}, props`).map((p, i) => prop(p, `${place}, prop ${i}`)),
      roles,
      lastFrame: Math.max(0, ...roles.map((r) => r.begin + r.frames - 1)),
    };
  });
}

function role(value: unknown, place: string, firstFrame: number): Role {
  const v = object(value, place);
  const frames = count(v.frames, `${place}, frames`);
  if (frames < 2) throw new FileProblem(place, `expected at least 2 frames, found ${frames}`);
  return {
    begin: count(v.begin, `${place}, begin`),
    frames,
    firstFrame,
    entry: count(v.entry_group, `${place}, entry_group`),
    exit: count(v.exit_group, `${place}, exit_group`),
  };
}

function core(value: unknown, place: string): SetKind["core"] {
  if (value === null || value === undefined) return null;
  const ends = list(value, place).map((n) => count(n, place));
  if (ends.length !== 2) throw new FileProblem(place, `expected 2 frames, found ${ends.length}`);
  return [ends[0], ends[1]];
}

function contact(value: unknown, place: string): Contact {
  const v = object(value, place);
  return {
    a: touch(v.a, `${place}, a`),
    b: touch(v.b, `${place}, b`),
    begin: count(v.begin, `${place}, begin`),
    end: count(v.end, `${place}, end`),
  };
}

function prop(value: unknown, place: string): SetProp {
  const v = object(value, place);
  const holds = list(v.holds, `${place}, holds`).map((h, k) => {
    const hold = object(h, `${place}, hold ${k}`);
    const [role, begin, end] = ["role", "begin", "end"].map((key) => count(hold[key], `${place}, hold ${k}, ${key}`));
    return { role, begin, end };
  });
  if (holds.length === 0 && !(v.before && v.after)) {
    throw new FileProblem(place, "expected somebody to hold it, or it to rest all the time; found neither");
  }
  return {
    name: text(v.name, `${place}, name`),
    size: vector(v.size, 3, `${place}, size`) as Vec3,
    grip: vector(v.grip, 2, `${place}, grip`) as unknown as SetProp["grip"],
    holds,
    before: upright(v.before, `${place}, before`),
    after: upright(v.after, `${place}, after`),
  };
}

function upright(value: unknown, place: string): Upright | null {
  if (value === null || value === undefined) return null;
  const v = object(value, place);
  return { middle: vector(v.middle, 3, `${place}, middle`) as Vec3, heading: finite(v.heading, `${place}, heading`) };
}

function touch(value: unknown, place: string): Touch {
  const v = object(value, place);
  if (!PARTS.includes(v.part as BodyPart)) {
    throw new FileProblem(place, `expected a part (${PARTS.join(", ")}), found ${shown(v.part)}`);
  }
  return { role: count(v.role, `${place}, role`), part: v.part as BodyPart };
}

function checkLengths(set: PatchSet): void {
  const frames = set.kinds.reduce((sum, kind) => sum + kind.roles.reduce((s, r) => s + r.frames, 0), 0);
  const expectations: [string, number, number][] = [
    ["points", set.points.length, frames * 2],
    ["headings", set.headings.length, frames],
    ["heights", set.heights.length, frames],
    ["rotations", set.rotations.length, frames * set.joints.length * 4],
  ];
  for (const [name, found, expected] of expectations) {
    if (found !== expected) {
      throw new FileProblem(`array ${name}`, `expected ${expected} numbers for its kinds, found ${found}`);
    }
  }
}

function checkKind(set: PatchSet, kind: SetKind): void {
  const place = `kind ${kind.name}`;
  if (kind.roles.length === 0) throw new FileProblem(place, "expected at least one person, found none");
  for (const [r, own] of kind.roles.entries()) {
    const group = Math.max(own.entry, own.exit);
    if (group >= set.groups.length) throw new FileProblem(`${place}, role ${r}`, `pose group ${group} does not exist`);
  }
  for (const { name, holds } of kind.props) {
    for (const { role, begin, end } of holds) {
      const own = kind.roles[role];
      if (own === undefined || begin < own.begin || end < begin || end >= own.begin + own.frames) {
        throw new FileProblem(`${place}, prop ${name}`, `role ${role} cannot hold it from frame ${begin} to ${end}`);
      }
    }
  }
  for (const { a, b } of kind.contacts) {
    const role = Math.max(a.role, b.role);
    if (role >= kind.roles.length) throw new FileProblem(`${place}, contacts`, `role ${role} does not exist`);
  }
}
