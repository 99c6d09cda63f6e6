/** Rotations as x, y, z, w in arrays. */

export type Numbers = ArrayLike<number>;
export type Vec = [number, number, number];
export type Quat = [number, number, number, number];

/** The product of two rotations, into `out` from number `at` on. */
export function times(a: Numbers, b: Numbers, out: Float32Array | number[], at: number): void {
  out[at] = a[3] * b[0] + b[3] * a[0] + a[1] * b[2] - a[2] * b[1];
  out[at + 1] = a[3] * b[1] + b[3] * a[1] + a[2] * b[0] - a[0] * b[2];
  out[at + 2] = a[3] * b[2] + b[3] * a[2] + a[0] * b[1] - a[1] * b[0];
  out[at + 3] = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
}

export function product(a: Numbers, b: Numbers): Quat {
  const out: Quat = [0, 0, 0, 0];
  times(a, b, out, 0);
  return out;
}

export function conjugate(q: Numbers): Quat {
  return [-q[0], -q[1], -q[2], q[3]];
}

export function normalized(q: Numbers): Quat {
  const length = Math.hypot(q[0], q[1], q[2], q[3]) || 1;
  return [q[0] / length, q[1] / length, q[2] / length, q[3] / length];
}

export function turned(q: Numbers, v: Numbers): Vec {
  const x = 2 * (q[1] * v[2] - q[2] * v[1]);
  const y = 2 * (q[2] * v[0] - q[0] * v[2]);
  const z = 2 * (q[0] * v[1] - q[1] * v[0]);
  return [
    v[0] + q[3] * x + q[1] * z - q[2] * y,
    v[1] + q[3] * y + q[2] * x - q[0] * z,
    v[2] + q[3] * z + q[0] * y - q[1] * x,
  ];
}

export function added(a: Float32Array, at: number, b: Numbers): Vec {
  return [a[at] + b[0], a[at + 1] + b[1], a[at + 2] + b[2]];
}

export const plus = (a: Numbers, b: Numbers): Vec => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const minus = (a: Numbers, b: Numbers): Vec => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scaled = (a: Numbers, s: number): Vec => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a: Numbers, b: Numbers): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const length = (a: Numbers): number => Math.hypot(a[0], a[1], a[2]);
export const cross = (a: Numbers, b: Numbers): Vec => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

/** As long as one; `or` if it has no direction. */
export function unit(a: Numbers, or: Vec): Vec {
  const l = length(a);
  return l > 1e-12 ? scaled(a, 1 / l) : or;
}

export function about(axis: Vec, angle: number): Quat {
  const [s, c] = [Math.sin(angle / 2), Math.cos(angle / 2)];
  return [axis[0] * s, axis[1] * s, axis[2] * s, c];
}
