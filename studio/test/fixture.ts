/** Writes small synthetic crowds in the real file format: people walk in arcs, meet, talk, and part. */

export interface FixtureOptions {
  people?: number;
  secs?: number;
  /** Changes the JSON header before it is written: for faults. */
  alter?: (header: Record<string, unknown>) => void;
  version?: number;
}

const FPS = 30;
type V3 = [number, number, number];
type Q = [number, number, number, number];

/** The canonical skeleton of src/motion/skeleton.rs. */
export const SKELETON: readonly (readonly [name: string, parent: number, offset: V3])[] = [
  ["hips", -1, [0, 0.935, 0]],
  ["left_up_leg", 0, [0.09, -0.03, 0]],
  ["left_leg", 1, [0, -0.42, 0]],
  ["left_foot", 2, [0, -0.41, 0]],
  ["left_toe", 3, [0, -0.055, 0.125]],
  ["right_up_leg", 0, [-0.09, -0.03, 0]],
  ["right_leg", 5, [0, -0.42, 0]],
  ["right_foot", 6, [0, -0.41, 0]],
  ["right_toe", 7, [0, -0.055, 0.125]],
  ["spine", 0, [0, 0.1, 0]],
  ["spine1", 9, [0, 0.13, 0]],
  ["spine2", 10, [0, 0.13, 0]],
  ["neck", 11, [0, 0.16, 0]],
  ["head", 12, [0, 0.1, 0.015]],
  ["left_shoulder", 11, [0.03, 0.1, 0]],
  ["left_arm", 14, [0.145, 0, 0]],
  ["left_fore_arm", 15, [0.28, 0, 0]],
  ["left_hand", 16, [0.25, 0, 0]],
  ["right_shoulder", 11, [-0.03, 0.1, 0]],
  ["right_arm", 18, [-0.145, 0, 0]],
  ["right_fore_arm", 19, [-0.28, 0, 0]],
  ["right_hand", 20, [-0.25, 0, 0]],
];
const at = (name: string) => SKELETON.findIndex(([n]) => n === name);

function about(axis: 0 | 1 | 2, angle: number): Q {
  const q: Q = [0, 0, 0, Math.cos(angle / 2)];
  q[axis] = Math.sin(angle / 2);
  return q;
}

function times(a: Q, b: Q): Q {
  return [
    a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
    a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
    a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
    a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
  ];
}

interface Ground {
  x: number;
  z: number;
  heading: number;
  /** Metres walked, for the phase of the gait. */
  walked: number;
  /** 0 walking, 1 standing and talking. */
  still: number;
}

const smooth = (x: number) => {
  const c = Math.min(Math.max(x, 0), 1);
  return c * c * (3 - 2 * c);
};

/** Where a walker is at every frame from -60 to last + 60: arcs towards a meeting, a stand, and away. */
function walk(
  meet: { x: number; z: number; heading: number },
  from: number,
  to: number,
  last: number,
  bend: number,
): Ground[] {
  const still = (f: number) => smooth((f - from + 20) / 20) * (1 - smooth((f - to) / 20));
  const heading = (f: number) => {
    const before = Math.min(f - from, 0) / FPS;
    const after = Math.max(f - to, 0) / FPS;
    return meet.heading + before * bend + smooth(after / 1.6) * 1.9 + after * bend;
  };
  const states = new Map<number, Ground>();
  const speed = (f: number) => (1 - still(f)) * 1.25;
  const go = (sign: 1 | -1, end: number) => {
    let [x, z, walked] = [meet.x, meet.z, 0];
    for (let f = from; sign * f <= sign * end; f += sign) {
      states.set(f, { x, z, heading: heading(f), walked, still: still(f) });
      const v = (speed(f) * sign) / FPS;
      x += Math.sin(heading(f)) * v;
      z += Math.cos(heading(f)) * v;
      walked += v;
    }
  };
  go(-1, -60);
  go(1, last + 60);
  return Array.from({ length: last + 121 }, (_, i) => states.get(i - 60) as Ground);
}

/** Local rotations of a walking or talking body. */
function pose(g: Ground, person: number, secs: number): Q[] {
  const q: Q[] = SKELETON.map(() => [0, 0, 0, 1]);
  const phase = (g.walked / 0.72) * Math.PI + person;
  const swing = (1 - g.still) * 0.42;
  const talk = g.still * (0.55 + 0.35 * Math.sin(secs * 3.1 + person));
  for (const [side, sign] of [
    ["left", 1],
    ["right", -1],
  ] as const) {
    const s = Math.sin(phase) * sign;
    const lifting = Math.max(Math.cos(phase) * sign, 0);
    q[at(`${side}_up_leg`)] = about(0, -swing * s - 0.1 * (1 - g.still) * lifting);
    q[at(`${side}_leg`)] = about(0, 0.06 + (1 - g.still) * (0.1 + 0.85 * lifting));
    q[at(`${side}_foot`)] = about(0, (1 - g.still) * (-0.12 * s + 0.25 * Math.max(-s, 0)) - 0.05);
    const raise = side === "right" ? talk * 0.55 : talk * 0.15;
    q[at(`${side}_arm`)] = times(about(0, swing * 0.9 * s - raise), about(2, -sign * 1.36));
    q[at(`${side}_fore_arm`)] = about(
      1,
      -sign * (0.25 + 0.25 * (1 - g.still) * Math.max(-s, 0) + talk * (side === "right" ? 1.3 : 0.5)),
    );
  }
  q[at("spine1")] = about(1, 0.07 * Math.sin(phase) * (1 - g.still));
  q[at("head")] = about(0, 0.1 * g.still * Math.sin(secs * 2.3 + person * 2));
  q[0] = about(1, g.heading);
  return q;
}

function turn(q: Q, [x, y, z]: V3): V3 {
  const [a, b, c] = [2 * (q[1] * z - q[2] * y), 2 * (q[2] * x - q[0] * z), 2 * (q[0] * y - q[1] * x)];
  return [x + q[3] * a + q[1] * c - q[2] * b, y + q[3] * b + q[2] * a - q[0] * c, z + q[3] * c + q[0] * b - q[1] * a];
}

/** Global positions of all joints: an own forward kinematics, so that tests have something to compare with. */
export function kinematics(root: V3, rotations: readonly Q[]): V3[] {
  const globals: { p: V3; q: Q }[] = [];
  for (const [i, [, parent, offset]] of SKELETON.entries()) {
    if (parent < 0) globals.push({ p: root, q: rotations[0] });
    else {
      const up = globals[parent];
      const o = turn(up.q, offset);
      globals.push({ p: [up.p[0] + o[0], up.p[1] + o[1], up.p[2] + o[2]], q: times(up.q, rotations[i]) });
    }
  }
  return globals.map((g) => g.p);
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

export function fixtureCrowd({ people = 12, secs = 10, alter, version = 1 }: FixtureOptions = {}): Fixture {
  const last = Math.round(secs * FPS);
  const { plans, instances, reach } = plan(people, last);
  const root: number[] = [];
  const rotations: number[] = [];
  const points: number[] = [];
  const headings: number[] = [];
  const exact = (person: number, frame: number): { root: V3; q: Q[] } => {
    const g = plans[person].states[frame + 60];
    const q = pose(g, person, frame / FPS);
    const lowest = Math.min(...["left_toe", "right_toe"].map((name) => kinematics([0, 0, 0], q)[at(name)][1]));
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
    characters: plans.map((p) => ({
      begin: 0,
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
    },
    alter,
  );
  const truth = (person: number, frame: number) => {
    const { root: hips, q } = exact(person, frame);
    return kinematics(hips, q);
  };
  return { bytes, truth, lastFrame: last };
}

type Arrays = Record<string, [type: string, values: Float32Array | Int16Array]>;

function container(
  header: Record<string, unknown>,
  version: number,
  arrays: Arrays,
  alter?: FixtureOptions["alter"],
): ArrayBuffer {
  const table: Record<string, unknown> = {};
  let length = 0;
  for (const [name, [type, values]] of Object.entries(arrays)) {
    length = Math.ceil(length / 8) * 8;
    table[name] = { type, offset: length, count: values.length };
    length += values.byteLength;
  }
  const whole = { ...header, arrays: table };
  alter?.(whole);
  let json = JSON.stringify(whole);
  json = json.padEnd(Math.ceil(json.length / 8) * 8, " ");
  const text = new TextEncoder().encode(json);
  const out = new Uint8Array(24 + text.length + length);
  const view = new DataView(out.buffer);
  out.set(new TextEncoder().encode("CQCROWD\0"));
  view.setUint32(8, version, true);
  view.setUint32(12, text.length, true);
  view.setBigUint64(16, BigInt(length), true);
  out.set(text, 24);
  let offset = 0;
  for (const [, values] of Object.values(arrays)) {
    offset = Math.ceil(offset / 8) * 8;
    out.set(new Uint8Array(values.buffer, values.byteOffset, values.byteLength), 24 + text.length + offset);
    offset += values.byteLength;
  }
  return out.buffer;
}
