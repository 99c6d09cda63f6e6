/** The crowd's textures on the GPU, and the pass that turns them into global joint transforms at a time. */

import {
  BufferAttribute,
  BufferGeometry,
  type DataTexture,
  FloatType,
  GLSL3,
  IntType,
  Mesh,
  NearestFilter,
  OrthographicCamera,
  RawShaderMaterial,
  RGBAFormat,
  RGBAIntegerFormat,
  Scene,
  ShortType,
  SRGBColorSpace,
  DataTexture as Texture,
  UnsignedByteType,
  Vector4,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import type { Crowd } from "../crowd/model";
import { tileOf } from "../crowd/tiles";
import { type Packed, packBuilds, packFragmentColors, packPeople, packRoots, packRotations } from "./packing";
import { bytes, categorical, looksOf, PART_COUNT } from "./palette";
import { POSE_VERTEX, poseFragment } from "./shaders";

/** People per row of the pose textures. */
const COLUMNS = 64;

export class CrowdTextures {
  readonly looks: DataTexture;
  readonly fragmentColors: DataTexture;
  readonly builds: DataTexture;
  readonly poses: WebGLRenderTarget;
  readonly columns = COLUMNS;
  private readonly material: RawShaderMaterial;
  private readonly triangle: BufferGeometry;
  private readonly scene = new Scene();
  private readonly camera = new OrthographicCamera();
  private drawnFrame = Number.NaN;

  constructor(
    private readonly renderer: WebGLRenderer,
    readonly crowd: Crowd,
  ) {
    const limit = renderer.capabilities.maxTextureSize;
    const width = Math.min(limit, 4096);
    const joints = crowd.joints.length;
    const texels = crowd.rotations.length / 4;
    if (texels > width * limit) {
      throw new Error(
        `this crowd has ${texels / joints} poses; this graphics card takes ${Math.floor((width * limit) / joints)}`,
      );
    }
    const people = crowd.characters.length;
    const rows = Math.max(1, Math.ceil(people / COLUMNS));
    this.poses = new WebGLRenderTarget(COLUMNS * joints, rows, { count: 2, type: FloatType, depthBuffer: false });
    for (const texture of this.poses.textures) {
      texture.minFilter = texture.magFilter = NearestFilter;
      texture.generateMipmaps = false;
    }
    this.looks = colorTexture(packLooks(crowd, width));
    const kindColor = (kind: number) => bytes(categorical(kind));
    const instanceColor = (instance: number) => bytes(categorical(instance));
    this.fragmentColors = colorTexture(packFragmentColors(crowd, width, kindColor, instanceColor));
    this.builds = numberTexture(packBuilds(crowd, Math.min(width, 1024)), FloatType);
    this.material = poseMaterial(crowd, width, limit, this.builds);
    const triangle = new BufferGeometry();
    triangle.setAttribute("position", new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    this.triangle = triangle;
    const mesh = new Mesh(triangle, this.material);
    mesh.frustumCulled = false;
    this.scene.add(mesh);
  }

  /** Computes all joint transforms at `secs`; nothing to do if they are there already. */
  pose(secs: number): void {
    const frame = secs * this.crowd.fps;
    if (frame === this.drawnFrame) return;
    this.drawnFrame = frame;
    this.material.uniforms.frame.value = frame;
    const before = this.renderer.getRenderTarget();
    this.renderer.setRenderTarget(this.poses);
    this.renderer.render(this.scene, this.camera);
    this.renderer.setRenderTarget(before);
  }

  /** Frees everything. */
  dispose(): void {
    const { rotations, roots, people } = this.material.uniforms;
    for (const { value } of [rotations, roots, people]) (value as DataTexture).dispose();
    for (const texture of [this.looks, this.fragmentColors, this.builds]) texture.dispose();
    this.poses.dispose();
    this.triangle.dispose();
    this.material.dispose();
  }

  /** The joint positions (x, y, z, presence) as the GPU has them, person by person. Slow: for tests. */
  readPositions(): Float32Array {
    const { width, height } = this.poses;
    const rows = new Float32Array(width * height * 4);
    this.renderer.readRenderTargetPixels(this.poses, 0, 0, width, height, rows);
    // Rows hold whole people, so the rows after each other are the people after each other.
    return rows.subarray(0, this.crowd.characters.length * this.crowd.joints.length * 4);
  }
}

function packLooks(crowd: Crowd, width: number): Packed<Uint8Array> {
  const height = Math.max(1, Math.ceil((crowd.characters.length * PART_COUNT) / width));
  const data = new Uint8Array(width * height * 4);
  for (const [person, { team }] of crowd.characters.entries()) data.set(looksOf(person, team), person * PART_COUNT * 4);
  return { data, width, height };
}

function colorTexture({ data, width, height }: Packed<Uint8Array>): DataTexture {
  const texture = new Texture(data as Uint8Array<ArrayBuffer>, width, height, RGBAFormat, UnsignedByteType);
  texture.colorSpace = SRGBColorSpace;
  texture.needsUpdate = true;
  return texture;
}

function numberTexture(
  packed: Packed<Int16Array | Float32Array | Int32Array>,
  type: typeof FloatType | typeof ShortType | typeof IntType,
): DataTexture {
  const format = type === FloatType ? RGBAFormat : RGBAIntegerFormat;
  const made = new Texture(packed.data as Float32Array<ArrayBuffer>, packed.width, packed.height, format, type);
  made.internalFormat = type === FloatType ? "RGBA32F" : type === ShortType ? "RGBA16I" : "RGBA32I";
  made.needsUpdate = true;
  return made;
}

function poseMaterial(crowd: Crowd, width: number, limit: number, builds: DataTexture): RawShaderMaterial {
  const rotations = packRotations(crowd, width);
  const roots = packRoots(crowd, width);
  const people = packPeople(crowd, Math.min(width, limit));
  const tile = tileOf(crowd);
  return new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader: POSE_VERTEX,
    fragmentShader: poseFragment(crowd.joints.length),
    depthTest: false,
    depthWrite: false,
    uniforms: {
      rotations: { value: numberTexture(rotations, ShortType) },
      roots: { value: numberTexture(roots, FloatType) },
      people: { value: numberTexture(people, IntType) },
      builds: { value: builds },
      frame: { value: 0 },
      personCount: { value: crowd.characters.length },
      columns: { value: COLUMNS },
      tile: { value: new Vector4(...tile.middle, ...tile.period) },
      parents: { value: crowd.joints.map((j) => j.parent) },
    },
  });
}
