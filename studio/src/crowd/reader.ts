/** Reads a crowd file (`*.crowd`); see src/stage/file.rs for the format. */

import { Container, count, FileProblem, finite, list, object, text, whole } from "./container";
import type { Build, Character, Crowd, Flesh, Fragment, Joint, Kind, Prop, Vec2, Vec3 } from "./model";
import { obstacle } from "./obstacle";

export const MAGIC = "CQCROWD";
/** Files of version 1 have no boxes, of version 2 only obstacles that are walls, of version 3 nothing that repeats. */
export const VERSIONS = [1, 2, 3, 4];

/** The crowd in `buffer`. Throws a FileProblem that names the place. */
export function readCrowd(buffer: ArrayBuffer): Crowd {
  const file = Container.open(buffer, MAGIC, VERSIONS);
  const { header } = file;
  const domain = object(header.domain, "header.domain");
  const joints = list(object(header.skeleton, "header.skeleton").joints, "header.skeleton.joints").map(joint);
  const root = file.array("root", "f32");
  const rotations = file.array("rotations", "i16");
  const pathPoints = file.array("path_points", "f32");
  const boxes = props(header.props);
  const crowd: Crowd = {
    fps: finite(header.fps, "header.fps"),
    seed: seedText(header.seed, file.headerText),
    joints,
    builds: builds(header.builds, joints),
    region: polygon(domain.region, "header.domain.region"),
    obstacles: list(domain.obstacles, "header.domain.obstacles").map((o, i) => {
      return obstacle(o, polygon(o, `obstacle ${i}`), `obstacle ${i}`);
    }),
    lastFrame: count(domain.last_frame, "header.domain.last_frame"),
    periodic: periodic(domain.periodic),
    teams: list(domain.teams ?? [], "header.domain.teams").map((t) => text(t, "header.domain.teams")),
    kinds: list(object(header.set, "header.set").kinds, "header.set.kinds").map(kind),
    instances: list(header.instances, "header.instances").map((v, i) => {
      return count(object(v, `instance ${i}`).kind, `instance ${i}, kind`);
    }),
    characters: characters(list(header.characters, "header.characters")),
    root,
    rotations,
    pathPoints,
    props: boxes,
    propPlaces: boxes.length > 0 ? file.array("prop_places", "f32") : new Float32Array(),
  };
  checkLengths(crowd);
  checkReferences(crowd);
  return crowd;
}

function periodic(value: unknown): Crowd["periodic"] {
  const v = value === undefined ? {} : object(value, "header.domain.periodic");
  return { x: v.x === true, z: v.z === true, t: v.t === true };
}

function seedText(value: unknown, header: string): string {
  const rounded = finite(value, "header.seed");
  const exact = [...header.matchAll(/"seed":\s*(\d+)/g)].find((m) => Number(m[1]) === rounded);
  return exact?.[1] ?? String(rounded);
}

export function joint(value: unknown, index: number, all: unknown[]): Joint {
  const place = `joint ${index}`;
  const v = object(value, place);
  const parent = v.parent === null || v.parent === undefined ? -1 : count(v.parent, `${place}, parent`);
  if (parent >= index || (parent < 0 && index > 0)) {
    throw new FileProblem(place, `expected a parent before it among ${all.length} joints, found ${parent}`);
  }
  return { name: text(v.name, `${place}, name`), parent, offset: vector(v.offset, 3, `${place}, offset`) as Vec3 };
}

/** Files without builds are of people on the skeleton itself. */
function builds(value: unknown, joints: readonly Joint[]): Build[] {
  const found = value === undefined ? [] : list(value, "header.builds");
  if (found.length === 0) {
    return [{ name: "average", offsets: joints.map((j) => j.offset), flesh: joints.map((): Flesh => [1, 1, 1, 0]) }];
  }
  return found.map((b, i) => {
    const place = `build ${i}`;
    const v = object(b, place);
    const rows = (key: "offsets" | "flesh", width: number) => {
      const all = list(v[key], `${place}, ${key}`);
      if (all.length !== joints.length) {
        throw new FileProblem(`${place}, ${key}`, `expected ${joints.length} rows, found ${all.length}`);
      }
      return all.map((row) => vector(row, width, `${place}, ${key}`));
    };
    return {
      name: text(v.name, `${place}, name`),
      offsets: rows("offsets", 3) as Vec3[],
      flesh: rows("flesh", 4) as unknown as Flesh[],
    };
  });
}

export function vector(value: unknown, length: number, place: string): readonly number[] {
  const v = list(value, place).map((n) => finite(n, place));
  if (v.length !== length) throw new FileProblem(place, `expected ${length} numbers, found ${v.length}`);
  return v;
}

function polygon(value: unknown, place: string): Vec2[] {
  const points = list(object(value, place).points, `${place}, points`).map((p) => vector(p, 2, place) as Vec2);
  if (points.length < 3) throw new FileProblem(place, `expected at least 3 corners, found ${points.length}`);
  return points;
}

function kind(value: unknown, index: number): Kind {
  const place = `kind ${index}`;
  const v = object(value, place);
  const people = list(v.fragments, `${place}, fragments`).length;
  const labels = list(v.labels, `${place}, labels`).map((l) => text(l, `${place}, labels`));
  return { name: text(v.name, `${place}, name`), labels, people };
}

function characters(values: unknown[]): Character[] {
  let firstFrame = 0;
  let firstSample = 0;
  return values.map((value, index) => {
    const place = `character ${index}`;
    const v = object(value, place);
    const fragments = list(v.fragments, `${place}, fragments`).map((f, k) => {
      const fragment = readFragment(f, `${place}, fragment ${k}`, firstSample);
      firstSample += fragment.samples;
      return fragment;
    });
    const frames = count(v.frames, `${place}, frames`);
    const build = v.build === undefined ? 0 : count(v.build, `${place}, build`);
    const team = v.team === undefined ? null : count(v.team, `${place}, team`);
    const character = { begin: count(v.begin, `${place}, begin`), frames, firstFrame, build, team, fragments };
    firstFrame += frames;
    return character;
  });
}

function readFragment(value: unknown, place: string, firstSample: number): Fragment {
  const v = object(value, place);
  const begin = whole(v.begin, `${place}, begin`);
  const end = whole(v.end, `${place}, end`);
  if (end <= begin) throw new FileProblem(place, `ends at frame ${end} before it begins at ${begin}`);
  return {
    instance: count(v.instance, `${place}, instance`),
    role: count(v.role, `${place}, role`),
    begin,
    end,
    firstSample,
    samples: count(v.samples, `${place}, samples`),
  };
}

/** Files of version 1 have none. */
function props(value: unknown): Prop[] {
  let firstFrame = 0;
  return (value === undefined ? [] : list(value, "header.props")).map((p, index) => {
    const place = `prop ${index}`;
    const v = object(p, place);
    const holds = list(v.holds, `${place}, holds`).map((h, k) => {
      const hold = object(h, `${place}, hold ${k}`);
      const [character, begin, end] = ["character", "begin", "end"].map((key) =>
        count(hold[key], `${place}, hold ${k}, ${key}`),
      );
      return { character, begin, end };
    });
    const frames = count(v.frames, `${place}, frames`);
    const prop: Prop = {
      name: text(v.name, `${place}, name`),
      size: vector(v.size, 3, `${place}, size`) as Vec3,
      begin: count(v.begin, `${place}, begin`),
      frames,
      firstFrame,
      holds,
    };
    firstFrame += frames;
    return prop;
  });
}

function checkLengths(crowd: Crowd): void {
  const frames = crowd.characters.reduce((sum, c) => sum + c.frames, 0);
  const samples = crowd.characters.reduce((sum, c) => c.fragments.reduce((s, f) => s + f.samples, sum), 0);
  const expectations: [string, number, number][] = [
    ["root", crowd.root.length, frames * 3],
    ["rotations", crowd.rotations.length, frames * crowd.joints.length * 4],
    ["path_points", crowd.pathPoints.length, samples * 2],
    ["prop_places", crowd.propPlaces.length, crowd.props.reduce((sum, p) => sum + p.frames, 0) * 4],
  ];
  for (const [name, found, expected] of expectations) {
    if (found !== expected) {
      throw new FileProblem(
        `array ${name}`,
        `expected ${expected} numbers for its ${name === "prop_places" ? "props" : "characters"}, found ${found}`,
      );
    }
  }
}

function checkReferences(crowd: Crowd): void {
  if (crowd.fps <= 0) throw new FileProblem("header.fps", `expected a positive rate, found ${crowd.fps}`);
  for (const [i, kind] of crowd.instances.entries()) {
    if (kind >= crowd.kinds.length) throw new FileProblem(`instance ${i}`, `kind ${kind} does not exist`);
  }
  for (const [i, prop] of crowd.props.entries()) {
    const stranger = prop.holds.find((h) => h.character >= crowd.characters.length);
    if (stranger) throw new FileProblem(`prop ${i}`, `character ${stranger.character} does not exist`);
  }
  for (const [i, character] of crowd.characters.entries()) {
    if (character.build >= crowd.builds.length) {
      throw new FileProblem(`character ${i}`, `build ${character.build} does not exist`);
    }
    if (character.team !== null && character.team >= crowd.teams.length) {
      throw new FileProblem(`character ${i}`, `team ${character.team} does not exist`);
    }
    for (const [k, f] of character.fragments.entries()) {
      const kind = crowd.kinds[crowd.instances[f.instance] ?? -1];
      if (kind === undefined || f.role >= kind.people) {
        throw new FileProblem(`character ${i}, fragment ${k}`, `instance ${f.instance} has no role ${f.role}`);
      }
    }
  }
}
