/** Shirt and seat. */

import type { Vec3 } from "../../crowd/model";
import type { MeshBuilder, Weights } from "../loft";
import { Part } from "../palette";
import { chain, type Ids, level } from "./rings";

export function torso(mesh: MeshBuilder, ids: Ids): void {
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
    seat.map(([y, w, d, z]) => level(y, w, d, z, Part.Seat, hips, 2.3)),
    16,
  );
  skirt(mesh, ids);
}

/** A skirt hangs from the hips and is carried by both thighs, each on its own side. */
function skirt(mesh: MeshBuilder, ids: Ids): void {
  const step = (v: number, from: number, to: number) => {
    const t = Math.min(Math.max((v - from) / (to - from), 0), 1);
    return t * t * (3 - 2 * t);
  };
  const weights = ([x, y]: Vec3): Weights => {
    const [legs, left] = [step(-y, -0.95, -0.78), step(x, -0.11, 0.11)];
    const all: [number, number][] = [
      [ids.hips, 1 - legs],
      [ids.left_up_leg, legs * left],
      [ids.right_up_leg, legs * (1 - left)],
    ];
    return all.filter(([, weight]) => weight > 0);
  };
  // height, half-width, half-depth, middle in depth
  const rows = [
    [0.985, 0.135, 0.09, -0.006], [0.94, 0.15, 0.104, -0.008], [0.905, 0.16, 0.112, -0.008], [0.888, 0.176, 0.126, -0.01],
    [0.84, 0.186, 0.132, -0.012], [0.74, 0.193, 0.142, -0.009], [0.63, 0.199, 0.15, -0.006], [0.51, 0.206, 0.16, -0.003],
    [0.505, 0.184, 0.138, -0.003], [0.56, 0.165, 0.12, -0.004],
  ]; // biome-ignore format: a table
  mesh.loft(
    rows.map(([y, w, d, z]) => ({ ...level(y, w, d, z, Part.Skirt, [], 2.2), weights })),
    16,
  );
}
