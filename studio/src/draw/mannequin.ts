/**
 * The mannequin: a body lofted around the canonical skeleton's rest pose (T-pose, facing +z, left is +x), with skin
 * weights. Every length is in metres on the canonical 1.75 m body.
 */

import type { Joint, Vec3 } from "../crowd/model";
import { arm, hand } from "./body/arms";
import { head } from "./body/head";
import { leg, shoe } from "./body/legs";
import { type Ids, NAMES } from "./body/rings";
import { torso } from "./body/torso";
import { MeshBuilder } from "./loft";

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
