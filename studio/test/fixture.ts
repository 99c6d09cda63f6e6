/** Writes small synthetic crowds in the real file format: people walk in arcs, meet, talk, and part. */

import { container } from "./container";
import { at, CANONICAL, FPS, type Ground, kinematics, LANKY, pose, type Q, SKELETON, type V3, walk } from "./gait";

export interface FixtureOptions {
  people?: number;
  secs?: number;
  /** Changes the JSON header before it is written: for faults. */
  alter?: (header: Record<string, unknown>) => void;
  version?: number;
  /** Places of props, four numbers per frame. */
  props?: Float32Array;
}

interface Plan {
  states: Ground[];
  fragments: { instance: number; role: number; begin: number; end: number }[];
}

const KINDS = [
  { name: "walk", people: 1, labels: ["walk"] },
  { name: "turn", people: 1, labels: ["walk", "turn"] },
  { name: "greet", people: 2, labels: ["talk"] },
  { name: "chat_of_three", people: 3, labels: ["talk", "group"] },
];

/** Groups of 2, 2, 3, 1 people, ... each on its own spot. */
function plan(people: number, last: number): { plans: Plan[]; instances: number[]; reach: number } {
  const sizes: number[] = [];
  for (let left = people, k = 0; left > 0; k++) {
    const size = Math.min([2, 3, 2, 1][k % 4], left);
    sizes.push(size);
    left -= size;
  }
  const columns = Math.ceil(Math.sqrt(sizes.length));
  const instances: number[] = [];
  const plans: Plan[] = [];
  for (const [k, size] of sizes.entries()) {
    const center = { x: ((k % columns) - (columns - 1) / 2) * 4, z: (Math.floor(k / columns) - (columns - 1) / 2) * 4 };
    const from = Math.round(last * 0.35) + ((k * 37) % 40);
    const to = size === 1 ? from : from + 75;
    const meeting = size > 1 ? instances.push(size) - 1 : -1;
    for (let role = 0; role < size; role++) {
      const angle = (role / size) * Math.PI * 2 + k;
      const stand = size === 3 ? 0.62 : 0.5;
      const meet = { x: center.x - Math.sin(angle) * stand, z: center.z - Math.cos(angle) * stand, heading: angle };
      const states = walk(meet, from, to, last, role % 2 === 0 ? 0.5 : 0.42);
      plans.push({ states, fragments: chainOf(instances, meeting, role, from, to, last, plans.length) });
    }
  }
  return { plans, instances, reach: columns * 2 + 2.6 };
}

function chainOf(
  instances: number[],
  meeting: number,
  role: number,
  from: number,
  to: number,
  last: number,
  person: number,
) {
  const fragments: Plan["fragments"] = [];
  const single = (begin: number, end: number) => {
    const instance = instances.push((person + fragments.length) % 2) - 1;
    fragments.push({ instance, role: 0, begin, end });
  };
  const [enter, leave] = meeting < 0 ? [last + 30, last + 30] : [from - 18, to + 15];
  let f = -15 - (person % 7);
  for (; enter - f > 70; f += 40) single(f, f + 40);
  single(f, enter);
  if (meeting < 0) return fragments;
  fragments.push({ instance: meeting, role, begin: enter, end: leave });
  for (f = leave; f < last; f += 45) single(f, f + 45);
  return fragments;
}

export interface Fixture {
  bytes: ArrayBuffer;
  /** The true joint positions of a person at a whole frame, before packing. */
  truth: (person: number, frame: number) => V3[];
  lastFrame: number;
}

export function fixtureCrowd({ people = 12, secs = 10, alter, version = 2, props }: FixtureOptions = {}): Fixture {
  const last = Math.round(secs * FPS);
  const { plans, instances, reach } = plan(people, last);
  const root: number[] = [];
  const rotations: number[] = [];
  const points: number[] = [];
  const headings: number[] = [];
  // Every third person has another build.
  const buildOf = (person: number) => (person % 3 === 1 ? 1 : 0);
  const bones = (person: number) => [CANONICAL, LANKY][buildOf(person)];
  const exact = (person: number, frame: number): { root: V3; q: Q[] } => {
    const g = plans[person].states[frame + 60];
    const q = pose(g, person, frame / FPS);
    const lowest = Math.min(
      ...["left_toe", "right_toe"].map((name) => kinematics([0, 0, 0], q, bones(person))[at(name)][1]),
    );
    return { root: [g.x, 0.02 - lowest, g.z], q };
  };
  for (const [person, p] of plans.entries()) {
    for (let frame = 0; frame <= last; frame++) {
      const { root: hips, q } = exact(person, frame);
      root.push(...hips);
      for (const r of q) rotations.push(...r.map((v) => Math.round(v * 32767)));
    }
    for (const f of p.fragments) {
      for (let frame = f.begin; frame <= f.end; frame++) {
        const g = p.states[Math.min(Math.max(frame + 60, 0), p.states.length - 1)];
        points.push(g.x, g.z);
        headings.push(g.heading);
      }
    }
  }
  const header: Record<string, unknown> = {
    fps: FPS,
    seed: 7,
    skeleton: {
      joints: SKELETON.map(([name, parent, offset]) => ({
        name,
        parent: parent < 0 ? null : parent,
        offset,
        tip: null,
      })),
    },
    domain: {
      region: {
        points: [
          [-reach, -reach],
          [reach, -reach],
          [reach, reach],
          [-reach, reach],
        ],
      },
      obstacles: [
        {
          points: [
            [-reach + 1, -reach + 1],
            [-reach + 2.6, -reach + 1],
            [-reach + 2.6, -reach + 2],
            [-reach + 1, -reach + 2],
          ],
        },
        {
          points: [
            [reach - 1.6, reach - 3],
            [reach - 0.8, reach - 2],
            [reach - 1.8, reach - 1.4],
            [reach - 2.6, reach - 2.2],
          ],
        },
      ],
      last_frame: last,
    },
    instances: instances.map((kind) => ({ kind })),
    builds: [CANONICAL, LANKY].map((offsets, i) => ({
      name: ["average", "lanky"][i],
      offsets: offsets.map((o) => [...o]),
      flesh: offsets.map(() => (i === 0 ? [1, 1, 1, 0] : [0.9, 1, 0.9, 0.01])),
    })),
    characters: plans.map((p, person) => ({
      begin: 0,
      build: buildOf(person),
      frames: last + 1,
      fragments: p.fragments.map((f) => ({ ...f, samples: f.end - f.begin + 1 })),
    })),
    set: {
      kinds: KINDS.map(({ name, people: n, labels }) => ({
        name,
        labels,
        mirrored: false,
        core: null,
        contacts: [],
        fragments: Array.from({ length: n }, () => ({
          begin: 0,
          frames: 2,
          entry_group: 0,
          exit_group: 0,
          plants: [],
        })),
      })),
    },
  };
  const bytes = container(
    header,
    version,
    {
      root: ["f32", new Float32Array(root)],
      rotations: ["i16", new Int16Array(rotations)],
      path_points: ["f32", new Float32Array(points)],
      path_headings: ["f32", new Float32Array(headings)],
      ...(props ? { prop_places: ["f32", props] as ["f32", Float32Array] } : {}),
    },
    alter,
  );
  const truth = (person: number, frame: number) => {
    const { root: hips, q } = exact(person, frame);
    return kinematics(hips, q, bones(person));
  };
  return { bytes, truth, lastFrame: last };
}
