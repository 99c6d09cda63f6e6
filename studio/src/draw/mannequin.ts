/**
 * The mannequin: a body lofted around the canonical skeleton's rest pose (T-pose, facing +z, left is +x), with skin
 * weights. Every length is in metres on the canonical 1.75 m body.
 */

import type { Joint, Vec3 } from "../crowd/model";
import { MeshBuilder, type Ring, type Weights } from "./loft";
import { Part } from "./palette";

export interface Mannequin {
  positions: Float32Array;
  normals: Float32Array;
  bones: Uint8Array;
  weights: Float32Array;
  parts: Uint8Array;
  indices: Uint16Array;
}

/** Global rest positions of all joints. */
export function restPositions(joints: readonly Joint[]): Vec3[] {
  const out: Vec3[] = [];
  for (const { parent, offset } of joints) {
    const base = parent < 0 ? [0, 0, 0] : out[parent];
    out.push([base[0] + offset[0], base[1] + offset[1], base[2] + offset[2]]);
  }
  return out;
}

/** Joint names the mannequin is built on; a skeleton without one of them cannot be dressed. */
const NAMES = [
  "hips", "spine", "spine1", "spine2", "neck", "head",
  "left_up_leg", "left_leg", "left_foot", "left_toe", "right_up_leg", "right_leg", "right_foot", "right_toe",
  "left_shoulder", "left_arm", "left_fore_arm", "left_hand",
  "right_shoulder", "right_arm", "right_fore_arm", "right_hand",
] as const; // biome-ignore format: by limb
type Name = (typeof NAMES)[number];
type Ids = Record<Name, number>;

/** The mannequin for a skeleton with the canonical names. `detail` 1 is for close views, 0.6 for big crowds. */
export function buildMannequin(joints: readonly Joint[], detail = 1): Mannequin {
  const ids = Object.fromEntries(NAMES.map((name) => [name, find(joints, name)])) as Ids;
  const mesh = new MeshBuilder(detail);
  torso(mesh, ids);
  head(mesh, ids);
  for (const side of ["left", "right"] as const) {
    leg(mesh, ids, side);
    shoe(mesh, ids, side);
    arm(mesh, ids, side);
    hand(mesh, ids, side);
  }
  mesh.blendNormals(0.05);
  return {
    positions: new Float32Array(mesh.positions),
    normals: new Float32Array(mesh.normals),
    bones: new Uint8Array(mesh.bones),
    weights: new Float32Array(mesh.weights),
    parts: new Uint8Array(mesh.parts),
    indices: new Uint16Array(mesh.indices),
  };
}

function find(joints: readonly Joint[], name: string): number {
  const index = joints.findIndex((j) => j.name === name);
  if (index < 0) throw new Error(`the skeleton has no joint "${name}"`);
  return index;
}

/** Weights along a chain of joints: each takes over from the one before around its place, over +-`width`. */
function chain(at: number, width: number, places: readonly (readonly [joint: number, from: number])[]): Weights {
  const out: [number, number][] = [];
  let left = 1;
  for (let i = places.length - 1; i > 0 && left > 0; i--) {
    const [joint, from] = places[i];
    const x = Math.min(Math.max((at - from + width) / (2 * width), 0), 1);
    const share = x * x * (3 - 2 * x) * left;
    if (share > 0) out.push([joint, share]);
    left -= share;
  }
  if (left > 1e-6) out.push([places[0][0], left]);
  return out.slice(0, 4);
}

/** A level ring: height, half-width, half-depth, middle in depth. */
function level(
  y: number,
  half: number,
  depth: number,
  z: number,
  part: Part,
  weights: Weights,
  power = 2,
  x = 0,
): Ring {
  return { center: [x, y, z], u: [half, 0, 0], v: [0, 0, depth], part, weights, power };
}

function torso(mesh: MeshBuilder, ids: Ids): void {
  const spine = (y: number) =>
    chain(y, 0.06, [
      [ids.hips, 0],
      [ids.spine, 1.035],
      [ids.spine1, 1.165],
      [ids.spine2, 1.295],
      [ids.neck, 1.462],
    ]);
  // height, half-width, half-depth, middle in depth, boxiness
  const shirt = [
    [0.9, 0.15, 0.1, -0.008, 2.2], [0.897, 0.168, 0.12, -0.008, 2.3], [0.93, 0.167, 0.119, -0.008, 2.3],
    [0.98, 0.157, 0.111, -0.004, 2.3], [1.04, 0.147, 0.102, 0, 2.3], [1.1, 0.145, 0.1, 0.002, 2.3],
    [1.16, 0.15, 0.103, 0.004, 2.3], [1.22, 0.158, 0.109, 0.006, 2.3], [1.28, 0.166, 0.113, 0.005, 2.3],
    [1.325, 0.173, 0.11, 0.001, 2.3], [1.365, 0.175, 0.102, -0.003, 2.3], [1.394, 0.169, 0.094, -0.007, 2.2],
    [1.414, 0.153, 0.085, -0.01, 2.1], [1.43, 0.127, 0.077, -0.012, 2], [1.443, 0.098, 0.07, -0.012, 2],
    [1.456, 0.074, 0.063, -0.009, 2], [1.465, 0.061, 0.059, -0.006, 2], [1.464, 0.052, 0.052, -0.005, 2],
  ]; // biome-ignore format: a table
  mesh.loft(
    shirt.map(([y, w, d, z, p]) => level(y, w, d, z, Part.Shirt, spine(y), p)),
    18,
  );
  const hips: Weights = [[ids.hips, 1]];
  const seat = [
    [0.99, 0.14, 0.095, -0.004], [0.95, 0.15, 0.104, -0.008], [0.91, 0.156, 0.11, -0.01], [0.87, 0.155, 0.111, -0.012],
    [0.835, 0.14, 0.102, -0.012], [0.805, 0.1, 0.08, -0.01], [0.79, 0.05, 0.05, -0.008],
  ]; // biome-ignore format: a table
  mesh.loft(
    seat.map(([y, w, d, z]) => level(y, w, d, z, Part.Trousers, hips, 2.3)),
    16,
  );
}

function leg(mesh: MeshBuilder, ids: Ids, side: "left" | "right"): void {
  const sign = side === "left" ? 1 : -1;
  const [thigh, shin, foot] = [ids[`${side}_up_leg`], ids[`${side}_leg`], ids[`${side}_foot`]];
  const weights = (y: number) =>
    chain(-y, 0.055, [
      [ids.hips, 0],
      [thigh, -0.9],
      [shin, -0.485],
      [foot, -0.07],
    ]);
  // height, half-width, half-depth, shift outwards, middle in depth
  const rows = [
    [0.945, 0.052, 0.07, -0.008, -0.006], [0.905, 0.07, 0.094, -0.008, -0.008], [0.86, 0.08, 0.101, -0.004, -0.01],
    [0.8, 0.081, 0.097, 0, -0.006], [0.73, 0.077, 0.091, 0, 0], [0.65, 0.071, 0.083, 0, 0.003],
    [0.58, 0.065, 0.075, 0, 0.004], [0.535, 0.0625, 0.071, 0, 0.004], [0.485, 0.06, 0.068, 0, 0.004],
    [0.445, 0.058, 0.066, 0, 0], [0.39, 0.058, 0.067, 0, -0.008], [0.32, 0.057, 0.064, 0, -0.009],
    [0.24, 0.054, 0.058, 0, -0.006], [0.17, 0.052, 0.055, 0, -0.002], [0.108, 0.052, 0.056, 0, 0.002],
    [0.1, 0.051, 0.055, 0, 0.003], [0.104, 0.04, 0.043, 0, 0.002],
  ]; // biome-ignore format: a table
  const rings = rows.map(([y, w, d, x, z]) =>
    level(y, w, d, z, y < 0.53 ? Part.Shin : Part.Trousers, weights(Math.max(y, 0.13)), 2.1, sign * (0.09 + x)),
  );
  mesh.loft(rings, 14);
  const ankle = [
    [0.2, 0.034, 0.04],
    [0.12, 0.032, 0.038],
    [0.06, 0.034, 0.042],
  ];
  mesh.loft(
    ankle.map(([y, w, d]) => level(y, w, d, -0.008, Part.Skin, weights(y), 2, sign * 0.09)),
    8,
  );
}

function shoe(mesh: MeshBuilder, ids: Ids, side: "left" | "right"): void {
  const sign = side === "left" ? 1 : -1;
  const [foot, toe] = [ids[`${side}_foot`], ids[`${side}_toe`]];
  const weights = (z: number) =>
    chain(z, 0.03, [
      [foot, 0],
      [toe, 0.118],
    ]);
  const across = (z: number, half: number, low: number, high: number, part: Part, shift: number): Ring => ({
    center: [sign * (0.09 + shift), (low + high) / 2, z],
    u: [half, 0, 0],
    v: [0, (high - low) / 2, 0],
    power: 2.7,
    part,
    weights: weights(z),
  });
  // place along the foot, half-width, top, shift outwards
  const upper = [
    [-0.083, 0.012, 0.05, 0], [-0.079, 0.027, 0.074, 0], [-0.062, 0.036, 0.096, 0], [-0.03, 0.04, 0.111, 0],
    [0.01, 0.041, 0.113, 0], [0.045, 0.042, 0.097, 0.001], [0.085, 0.045, 0.078, 0.003], [0.12, 0.048, 0.066, 0.004],
    [0.155, 0.047, 0.058, 0.003], [0.183, 0.04, 0.049, 0], [0.2, 0.027, 0.038, -0.003], [0.206, 0.012, 0.028, -0.004],
  ]; // biome-ignore format: a table
  mesh.loft(
    upper.map(([z, w, h, x]) => across(z, w, 0.006, h, Part.Shoe, x)),
    12,
  );
  const sole = [
    [-0.088, 0.014, 0], [-0.084, 0.03, 0], [-0.064, 0.041, 0], [-0.02, 0.043, 0], [0.04, 0.044, 0.001],
    [0.09, 0.049, 0.003], [0.13, 0.052, 0.004], [0.165, 0.049, 0.002], [0.192, 0.039, -0.001], [0.208, 0.022, -0.003],
    [0.212, 0.01, -0.004],
  ]; // biome-ignore format: a table
  mesh.loft(
    sole.map(([z, w, x]) => ({ ...across(z, w, 0, 0.021, Part.Sole, x), power: 5 })),
    12,
  );
}

/** A ring across an arm, which runs along x. */
function cuff(
  x: number,
  y: number,
  z: number,
  high: number,
  deep: number,
  part: Part,
  weights: Weights,
  power = 2,
): Ring {
  return { center: [x, y, z], u: [0, high, 0], v: [0, 0, deep], part, weights, power };
}

function arm(mesh: MeshBuilder, ids: Ids, side: "left" | "right"): void {
  const sign = side === "left" ? 1 : -1;
  const [collar, upper, lower, palm] = [
    ids[`${side}_shoulder`],
    ids[`${side}_arm`],
    ids[`${side}_fore_arm`],
    ids[`${side}_hand`],
  ];
  const weights = (x: number) =>
    chain(x, x < 0.3 ? 0.065 : 0.05, [
      [collar, 0],
      [upper, 0.168],
      [lower, 0.455],
      [palm, 0.715],
    ]);
  // place along the arm, height, half-height, half-depth
  const rows = [
    [0.09, 1.362, 0.026, 0.046], [0.118, 1.371, 0.038, 0.056], [0.146, 1.376, 0.046, 0.062], [0.172, 1.379, 0.05, 0.063],
    [0.2, 1.383, 0.052, 0.061], [0.235, 1.388, 0.052, 0.057], [0.28, 1.391, 0.0495, 0.052], [0.335, 1.393, 0.0465, 0.049],
    [0.39, 1.394, 0.0445, 0.0465], [0.404, 1.394, 0.0445, 0.0465], [0.404, 1.394, 0.0425, 0.0445], [0.43, 1.395, 0.042, 0.0435],
    [0.46, 1.395, 0.042, 0.0425], [0.5, 1.395, 0.0425, 0.0435], [0.55, 1.395, 0.04, 0.0415], [0.61, 1.395, 0.0345, 0.0375],
    [0.66, 1.395, 0.029, 0.0335], [0.696, 1.395, 0.026, 0.0305],
  ]; // biome-ignore format: a table
  const rings = rows.map(([x, y, h, d], i) =>
    cuff(sign * x, y, -0.004, h, d, i < 10 ? Part.Shirt : Part.Sleeve, weights(Math.min(x, 0.66))),
  );
  mesh.loft(rings, 12);
  const wrist = [
    [0.66, 0.02, 0.025],
    [0.7, 0.0215, 0.0265],
    [0.725, 0.021, 0.03],
  ];
  mesh.loft(
    wrist.map(([x, h, d]) => cuff(sign * x, 1.395, -0.002, h, d, Part.Skin, weights(x))),
    8,
  );
}

function hand(mesh: MeshBuilder, ids: Ids, side: "left" | "right"): void {
  const sign = side === "left" ? 1 : -1;
  const only: Weights = [[ids[`${side}_hand`], 1]];
  // A relaxed hand: the fingers curl towards the palm (down in the T-pose). Place, height, half-height, half-depth, depth.
  const palm = [
    [0.7, 1.395, 0.02, 0.026, 0], [0.728, 1.395, 0.021, 0.036, 0.002], [0.76, 1.394, 0.02, 0.042, 0.003],
    [0.79, 1.391, 0.018, 0.042, 0.002], [0.815, 1.385, 0.016, 0.039, 0], [0.842, 1.374, 0.0145, 0.035, -0.001],
    [0.862, 1.36, 0.013, 0.03, -0.002], [0.872, 1.348, 0.01, 0.022, -0.002],
  ]; // biome-ignore format: a table
  mesh.loft(
    palm.map(([x, y, h, d, z]) => cuff(sign * x, y, z, h, d, Part.Skin, only, 2.4)),
    10,
  );
  const thumb = [[0.722, 1.388, 0.012, 0.014, 0.022], [0.748, 1.382, 0.013, 0.014, 0.044], [0.776, 1.376, 0.012, 0.0125, 0.056],
    [0.8, 1.371, 0.01, 0.0105, 0.06], [0.81, 1.368, 0.006, 0.006, 0.06]]; // biome-ignore format: a table
  mesh.loft(
    thumb.map(([x, y, h, d, z]) => cuff(sign * x, y, z, h, d, Part.Skin, only)),
    7,
  );
}

function head(mesh: MeshBuilder, ids: Ids): void {
  const weights = (y: number) =>
    chain(y, 0.035, [
      [ids.spine2, 0],
      [ids.neck, 1.452],
      [ids.head, 1.535],
    ]);
  const skull: Weights = [[ids.head, 1]];
  // height, half-width, front, back
  const rows = [
    [1.41, 0.058, 0.045, -0.06], [1.45, 0.054, 0.045, -0.06], [1.49, 0.051, 0.047, -0.058], [1.522, 0.0505, 0.052, -0.058],
    [1.538, 0.05, 0.074, -0.06], [1.545, 0.05, 0.096, -0.062], [1.556, 0.053, 0.107, -0.066], [1.578, 0.06, 0.109, -0.075],
    [1.606, 0.067, 0.108, -0.084], [1.636, 0.072, 0.107, -0.089], [1.668, 0.0745, 0.107, -0.09], [1.7, 0.071, 0.099, -0.086],
    [1.725, 0.059, 0.08, -0.071], [1.741, 0.041, 0.054, -0.049], [1.749, 0.02, 0.027, -0.025],
  ]; // biome-ignore format: a table
  const rings = rows.map(([y, w, front, back]) =>
    level(y, w, (front - back) / 2, (front + back) / 2, Part.Skin, weights(y), y > 1.53 && y < 1.6 ? 2 : 2.15),
  );
  mesh.loft(rings, 16);
  const nose = [
    [1.664, 0.006, 0.1, 0.01],
    [1.645, 0.008, 0.105, 0.012],
    [1.622, 0.012, 0.11, 0.018],
    [1.612, 0.0135, 0.111, 0.018],
    [1.604, 0.01, 0.107, 0.012],
  ];
  mesh.loft(
    nose.map(([y, w, z, d]) => level(y, w, d, z, Part.Skin, skull)),
    7,
  );
  for (const sign of [1, -1]) {
    const ear = [
      [1.603, 0.005, 0.008],
      [1.615, 0.009, 0.014],
      [1.64, 0.011, 0.02],
      [1.657, 0.009, 0.017],
      [1.664, 0.004, 0.008],
    ];
    mesh.loft(
      ear.map(([y, w, d]) => level(y, w, d, -0.004 - (1.66 - y) * 0.1, Part.Skin, skull, 2, sign * 0.074)),
      6,
    );
  }
  hair(mesh, skull);
  const long = [
    [1.69, 0.045, 0.02, -0.06], [1.665, 0.062, 0.03, -0.062], [1.635, 0.075, 0.043, -0.066], [1.59, 0.079, 0.045, -0.067],
    [1.54, 0.077, 0.041, -0.07], [1.5, 0.072, 0.037, -0.074], [1.465, 0.06, 0.03, -0.08], [1.442, 0.042, 0.021, -0.084],
    [1.433, 0.018, 0.01, -0.086],
  ]; // biome-ignore format: a table
  mesh.loft(
    long.map(([y, w, d, z]) => level(y, w, d, z, Part.LongHair, skull)),
    16,
  );
}

/** A cap around the skull whose rim runs from the high forehead to the low neck. */
function hair(mesh: MeshBuilder, skull: Weights): void {
  const center: Vec3 = [0, 1.655, 0.006];
  const radii: Vec3 = [0.0835, 0.108, 0.112];
  const tilt = 0.62;
  const rows = [5, 16, 30, 45, 60, 75, 90, 103, 106];
  const rings = rows.map((degrees, i): Ring => {
    const polar = (degrees * Math.PI) / 180;
    // The last ring turns inwards, so that the rim has a thickness.
    const size = i === rows.length - 1 ? 0.86 : 1;
    const [up, out] = [Math.cos(polar) * size, Math.sin(polar) * size];
    return {
      center: [0, center[1] + radii[1] * up * Math.cos(tilt), center[2] - radii[2] * up * Math.sin(tilt)],
      u: [radii[0] * out, 0, 0],
      v: [0, radii[1] * out * Math.sin(tilt), radii[2] * out * Math.cos(tilt)],
      part: Part.Hair,
      weights: skull,
    };
  });
  mesh.loft(rings, 20);
}
