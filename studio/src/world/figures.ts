/** People of a world: near ones as mannequins with full bodies, far ones as simple figures. One draw call each. */

import {
  BufferAttribute,
  type BufferGeometry,
  Color,
  CylinderGeometry,
  DataTexture,
  FloatType,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  InstancedMesh,
  Matrix4,
  type Mesh,
  MeshStandardMaterial,
  RGBAFormat,
  SphereGeometry,
  SRGBColorSpace,
  UnsignedByteType,
  Vector2,
  Vector3,
} from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";
import type { Joint } from "../crowd/model";
import { bodies } from "../draw/bodies";
import { buildMannequin, restPositions } from "../draw/mannequin";
import { lookOf, looksOf, PART_COUNT, Part } from "../draw/palette";
import { Actor } from "./acts";
import { isWhole } from "./fade";
import type { Acts, Gait } from "./model";
import { Poser } from "./pose";
import type { Walker } from "./sample";

const MOST_NEAR = 192;
const MOST_FAR = 20_000;
const COLUMNS = 16;

/** Who is drawn how. */
export class Figures {
  readonly near: Mesh | null = null;
  readonly far: InstancedMesh;
  private readonly places: Float32Array | null = null;
  private readonly turns: Float32Array | null = null;
  private readonly looks: Uint8Array | null = null;
  private readonly textures: DataTexture[] = [];
  private readonly poser: Poser | null = null;
  private readonly actor: Actor | null = null;
  private readonly joints: readonly Joint[];
  private readonly geometry = new InstancedBufferGeometry();

  constructor(gait: Gait | null, acts: Acts | null) {
    this.joints = gait?.joints ?? acts?.joints ?? [];
    this.far = new InstancedMesh(figure(), new MeshStandardMaterial({ roughness: 0.85 }), MOST_FAR);
    this.far.frustumCulled = false;
    this.far.castShadow = true;
    if (this.joints.length === 0) return;
    const rows = MOST_NEAR / COLUMNS;
    const texels = COLUMNS * this.joints.length * rows * 4;
    this.places = new Float32Array(texels);
    this.turns = new Float32Array(texels);
    this.looks = new Uint8Array(MOST_NEAR * PART_COUNT * 4);
    this.poser = gait ? new Poser(gait) : null;
    this.actor = acts ? new Actor(acts) : null;
    this.near = this.body(rows);
  }

  /** Draws these people: those within `reach` of the eye as mannequins, as many as there may be. */
  show(people: readonly Walker[], eye: Vector3, reach: number): { near: number; far: number } {
    const sorted = people
      .map((walker) => ({ walker, distance: Math.hypot(walker.x - eye.x, walker.z - eye.z) }))
      .sort((a, b) => a.distance - b.distance);
    const [near, rest] = this.chosen(sorted, reach);
    for (const [i, walker] of near.entries()) this.dress(i, walker);
    this.geometry.instanceCount = near.length;
    for (const texture of this.textures) texture.needsUpdate = true;
    const far = Math.min(rest.length, MOST_FAR);
    const [matrix, color] = [new Matrix4(), new Color()];
    for (let i = 0; i < far; i++) {
      const walker = rest[i];
      matrix.makeRotationY(walker.heading).setPosition(walker.x, 0, walker.z);
      this.far.setMatrixAt(i, matrix);
      this.far.setColorAt(i, color.set(lookOf(walker.id % 4096)[Part.Shirt] ?? "#888888"));
    }
    this.far.count = far;
    this.far.instanceMatrix.needsUpdate = true;
    if (this.far.instanceColor) this.far.instanceColor.needsUpdate = true;
    return { near: near.length, far };
  }

  /** Who is drawn as a mannequin, and the others: without a gait only those who do something else than walk have bodies. */
  private chosen(sorted: readonly { walker: Walker; distance: number }[], reach: number): [Walker[], Walker[]] {
    const [near, rest]: [Walker[], Walker[]] = [[], []];
    for (const { walker, distance } of sorted) {
      const shown = this.poser || (this.actor && walker.act && isWhole(walker.act));
      (shown && distance < reach && near.length < MOST_NEAR ? near : rest).push(walker);
    }
    return [near, rest];
  }

  private dress(slot: number, walker: Walker): void {
    if (!this.places || !this.turns || !this.looks) return;
    const at = slot * this.joints.length * 4;
    if (!walker.act || !isWhole(walker.act)) this.poser?.pose(walker, this.places, this.turns, at);
    if (walker.act) this.actor?.pose(walker.act, this.places, this.turns, at);
    this.looks.set(looksOf(walker.id % 4096), slot * PART_COUNT * 4);
  }

  private body(rows: number): Mesh {
    const { geometry, joints } = this;
    const made = buildMannequin(joints, 0.55);
    geometry.setAttribute("position", new BufferAttribute(made.positions, 3));
    geometry.setAttribute("normal", new BufferAttribute(made.normals, 3));
    geometry.setAttribute("bones", new BufferAttribute(made.bones, 4));
    geometry.setAttribute("weights", new BufferAttribute(made.weights, 4));
    geometry.setAttribute("part", new BufferAttribute(made.parts, 1));
    geometry.setAttribute("build", new InstancedBufferAttribute(new Float32Array(MOST_NEAR), 1));
    geometry.setIndex(new BufferAttribute(made.indices, 1));
    const width = COLUMNS * joints.length;
    const floats = (data: Float32Array | null) =>
      this.texture(new DataTexture(data, width, rows, RGBAFormat, FloatType));
    const flesh = new Float32Array(joints.flatMap((j) => [...j.offset, 0, 1, 1, 1, 0]));
    const builds = new DataTexture(flesh, joints.length * 2, 1, RGBAFormat, FloatType);
    builds.needsUpdate = true;
    const looks = new DataTexture(this.looks, MOST_NEAR * PART_COUNT, 1, RGBAFormat, UnsignedByteType);
    looks.colorSpace = SRGBColorSpace;
    const uniforms = {
      posePositions: { value: floats(this.places) },
      poseRotations: { value: floats(this.turns) },
      poseColumns: { value: COLUMNS },
      rest: { value: restPositions(joints).map((p) => new Vector3(...p)) },
      lift: { value: 0 },
      looks: { value: this.texture(looks) },
      builds: { value: builds },
      fragmentColors: { value: builds },
      colorMode: { value: 0 },
      chosen: { value: -1 },
      partCount: { value: PART_COUNT },
      personCount: { value: MOST_NEAR },
      tileOffsets: { value: Array.from({ length: 9 }, () => new Vector2()) },
    };
    return bodies(geometry, uniforms, joints.length);
  }

  private texture(made: DataTexture): DataTexture {
    this.textures.push(made);
    return made;
  }
}

/** Somebody from afar: legs, trunk, arms and head in eight faces each. */
function figure(): BufferGeometry {
  const leg = (x: number) => new CylinderGeometry(0.085, 0.06, 0.86, 6).translate(x, 0.43, 0);
  const arm = (x: number) => new CylinderGeometry(0.05, 0.04, 0.6, 5).rotateZ(Math.sign(x) * 0.1).translate(x, 1.12, 0);
  const trunk = new CylinderGeometry(0.2, 0.15, 0.6, 8).scale(1, 1, 0.62).translate(0, 1.13, 0);
  const head = new SphereGeometry(0.11, 8, 6).scale(0.9, 1.15, 1).translate(0, 1.6, 0.01);
  return mergeGeometries([leg(-0.09), leg(0.09), arm(-0.25), arm(0.25), trunk, head]);
}
