/** A synthetic walk on the canonical skeleton: arcs towards a meeting, a talk, and away. */

export const FPS = 30;
export type V3 = [number, number, number];
export type Q = [number, number, number, number];

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
/** The canonical bones, and those of someone with longer legs and shorter arms. */
export const CANONICAL: readonly V3[] = SKELETON.map(([, , offset]) => offset);
export const LANKY: readonly V3[] = SKELETON.map(([name, , [x, y, z]]) => {
  const factor = /leg|left_foot|right_foot/.test(name) ? 1.08 : /arm|hand/.test(name) ? 0.94 : 1;
  return [x * factor, y * factor, z];
});
export const at = (name: string) => SKELETON.findIndex(([n]) => n === name);

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

export interface Ground {
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
export function walk(
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
export function pose(g: Ground, person: number, secs: number): Q[] {
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
export function kinematics(root: V3, rotations: readonly Q[], offsets: readonly V3[] = CANONICAL): V3[] {
  const globals: { p: V3; q: Q }[] = [];
  for (const [i, [, parent]] of SKELETON.entries()) {
    if (parent < 0) globals.push({ p: root, q: rotations[0] });
    else {
      const up = globals[parent];
      const o = turn(up.q, offsets[i]);
      globals.push({ p: [up.p[0] + o[0], up.p[1] + o[1], up.p[2] + o[2]], q: times(up.q, rotations[i]) });
    }
  }
  return globals.map((g) => g.p);
}
