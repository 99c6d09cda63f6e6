/** Legs and shoes. */

import type { MeshBuilder, Ring } from "../loft";
import { Part } from "../palette";
import { chain, type Ids, level } from "./rings";

export function leg(mesh: MeshBuilder, ids: Ids, side: "left" | "right"): void {
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

export function shoe(mesh: MeshBuilder, ids: Ids, side: "left" | "right"): void {
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
