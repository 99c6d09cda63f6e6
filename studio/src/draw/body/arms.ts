/** Arms and hands. */

import type { MeshBuilder, Weights } from "../loft";
import { Part } from "../palette";
import { chain, cuff, type Ids } from "./rings";

export function arm(mesh: MeshBuilder, ids: Ids, side: "left" | "right"): void {
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

export function hand(mesh: MeshBuilder, ids: Ids, side: "left" | "right"): void {
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
