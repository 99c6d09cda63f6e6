/** Everybody, in one draw call (and one for the shadows, one for the soft spots under the feet). */

import {
  BufferAttribute,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  Mesh,
  PlaneGeometry,
  ShaderMaterial,
  Vector2,
  Vector3,
} from "three";
import type { Crowd, Vec2 } from "../crowd/model";
import { tileOf, tileOffsets } from "../crowd/tiles";
import { bodies, type Uniforms } from "./bodies";
import { buildMannequin, restPositions } from "./mannequin";
import { PART_COUNT } from "./palette";
import { poseLookup } from "./shaders";
import type { CrowdTextures } from "./textures";

export class People {
  readonly body: Mesh;
  readonly spots: Mesh;
  readonly uniforms: Uniforms;
  private readonly people: number;
  /** All tiles that can be shown; the crowd's own comes first. */
  private readonly tiles: Vec2[];

  constructor(
    crowd: Crowd,
    private readonly textures: CrowdTextures,
  ) {
    const people = crowd.characters.length;
    this.people = people;
    this.tiles = tileOffsets(tileOf(crowd));
    this.uniforms = {
      posePositions: { value: textures.poses.textures[0] },
      poseRotations: { value: textures.poses.textures[1] },
      poseColumns: { value: textures.columns },
      rest: { value: restPositions(crowd.joints).map((p) => new Vector3(...p)) },
      lift: { value: 0 },
      looks: { value: textures.looks },
      builds: { value: textures.builds },
      fragmentColors: { value: textures.fragmentColors },
      colorMode: { value: 0 },
      chosen: { value: -1 },
      partCount: { value: PART_COUNT },
      personCount: { value: Math.max(people, 1) },
      tileOffsets: { value: Array.from({ length: 9 }, (_, i) => new Vector2(...(this.tiles[i] ?? [0, 0]))) },
    };
    const detail = people > 1500 ? 0.45 : people > 300 ? 0.6 : 1;
    this.body = this.makeBody(crowd, detail);
    this.spots = this.makeSpots(crowd);
  }

  /** Shows all tiles around the crowd's own, or that one alone. Images are drawn in the same calls. */
  repeat(all: boolean): void {
    const instances = this.people * (all ? this.tiles.length : 1);
    (this.body.geometry as InstancedBufferGeometry).instanceCount = instances;
    (this.spots.geometry as InstancedBufferGeometry).instanceCount = instances * 3;
  }

  /** Brings the joint transforms to `secs` and raises everybody by `lift`. Its cost does not depend on the people. */
  update(secs: number, lift: number): void {
    this.textures.pose(secs);
    this.uniforms.lift.value = lift;
  }

  private makeBody(crowd: Crowd, detail: number): Mesh {
    const made = buildMannequin(crowd.joints, detail);
    const geometry = new InstancedBufferGeometry();
    geometry.instanceCount = crowd.characters.length;
    geometry.setAttribute("position", new BufferAttribute(made.positions, 3));
    geometry.setAttribute("normal", new BufferAttribute(made.normals, 3));
    geometry.setAttribute("bones", new BufferAttribute(made.bones, 4));
    geometry.setAttribute("weights", new BufferAttribute(made.weights, 4));
    geometry.setAttribute("part", new BufferAttribute(made.parts, 1));
    const builds = new Float32Array(this.tiles.flatMap(() => crowd.characters.map((c) => c.build)));
    geometry.setAttribute("build", new InstancedBufferAttribute(builds, 1));
    geometry.setIndex(new BufferAttribute(made.indices, 1));
    return bodies(geometry, this.uniforms, crowd.joints.length);
  }

  private makeSpots(crowd: Crowd): Mesh {
    const quad = new PlaneGeometry(1, 1).rotateX(-Math.PI / 2);
    const geometry = new InstancedBufferGeometry();
    geometry.setAttribute("position", quad.getAttribute("position"));
    geometry.setAttribute("uv", quad.getAttribute("uv"));
    geometry.setIndex(quad.getIndex());
    geometry.instanceCount = crowd.characters.length * 3;
    const joint = (name: string) => crowd.joints.findIndex((j) => j.name === name);
    const material = new ShaderMaterial({
      transparent: true,
      depthWrite: false,
      polygonOffset: true,
      polygonOffsetFactor: -2,
      polygonOffsetUnits: -2,
      uniforms: { ...this.uniforms, feet: { value: [joint("hips"), joint("left_toe"), joint("right_toe")] } },
      vertexShader: `${poseLookup(crowd.joints.length)}\n${SPOT_VERTEX}`,
      fragmentShader: SPOT_FRAGMENT,
    });
    const spots = new Mesh(geometry, material);
    spots.frustumCulled = false;
    spots.renderOrder = 2;
    return spots;
  }
}

/** Three soft dark spots per person: under the hips and under the balls of the feet. */
const SPOT_VERTEX = /* glsl */ `
uniform float lift; uniform int feet[3]; uniform int chosen;
varying vec2 vAt; varying float vDark; varying float vRing;
void main() {
  int person = personOf(gl_InstanceID / 3), which = gl_InstanceID % 3;
  vec4 hips = texelFetch(posePositions, poseTexel(person, 0), 0);
  ivec2 joint = poseTexel(person, feet[which]);
  vec4 at = texelFetch(posePositions, joint, 0);
  vec2 forward = turn(texelFetch(poseRotations, joint, 0), vec3(0.0, 0.0, 1.0)).xz;
  forward = length(forward) > 0.05 ? normalize(forward) : vec2(0.0, 1.0);
  bool foot = which > 0;
  vRing = !foot && person == chosen ? 1.0 : 0.0;
  vec2 size = foot ? vec2(0.20, 0.42) : vRing > 0.5 ? vec2(1.1) : vec2(0.95);
  if (foot) at.xz -= forward * 0.05;
  vec2 p = position.xz * size;
  vec2 placed = at.xz + forward * p.y + vec2(forward.y, -forward.x) * p.x;
  vAt = uv * 2.0 - 1.0;
  vDark = foot ? 0.42 * clamp(1.0 - (at.y - 0.02) * 6.0, 0.0, 1.0) : 0.26;
  placed += tileOffsetOf(gl_InstanceID / 3);
  if (hips.w < 0.5) placed = vec2(0.0);
  vec4 world = vec4(placed.x, lift + 0.006 + 0.001 * float(which), placed.y, 1.0);
  gl_Position = hips.w < 0.5 ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * viewMatrix * world;
}
`;

const SPOT_FRAGMENT = /* glsl */ `
varying vec2 vAt; varying float vDark; varying float vRing;
void main() {
  float r = length(vAt);
  float soft = 1.0 - smoothstep(0.0, 1.0, r);
  vec4 shade = vec4(vec3(0.06, 0.055, 0.07), vDark * soft * soft);
  float width = fwidth(r);
  float ring = smoothstep(0.84 - width, 0.84, r) * (1.0 - smoothstep(0.90, 0.90 + width, r));
  gl_FragColor = mix(shade, vec4(0.80, 0.19, 0.03, 1.0), ring * vRing);
  #include <colorspace_fragment>
}
`;
