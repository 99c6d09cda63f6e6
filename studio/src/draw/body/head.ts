/** Head, face and hair. */

import type { Vec3 } from "../../crowd/model";
import type { MeshBuilder, Ring, Weights } from "../loft";
import { Part } from "../palette";
import { chain, type Ids, level } from "./rings";

export function head(mesh: MeshBuilder, ids: Ids): void {
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
  const bun = [
    [1.735, 0.01, 0.012, -0.099], [1.725, 0.025, 0.028, -0.102], [1.7, 0.034, 0.038, -0.104], [1.675, 0.026, 0.028, -0.102],
    [1.664, 0.01, 0.012, -0.098],
  ]; // biome-ignore format: a table
  mesh.loft(
    bun.map(([y, w, d, z]) => level(y, w, d, z, Part.Bun, skull)),
    9,
  );
  const visor = [
    [1.704, 0.062, 0.07, 0.1],
    [1.7, 0.072, 0.078, 0.106],
    [1.693, 0.072, 0.078, 0.107],
    [1.69, 0.062, 0.07, 0.1],
  ];
  mesh.loft(
    visor.map(([y, w, d, z]) => level(y, w, d, z, Part.Visor, skull, 2.2)),
    10,
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
