/** Patch outlines on the ground: the hull of an instance's motion paths, while it is active. One draw call. */

import { BufferGeometry, Color, Float32BufferAttribute, Mesh, ShaderMaterial } from "three";
import { roundedHull } from "../crowd/hull";
import { type Member, membersOf, pathPoints, span } from "../crowd/lookup";
import type { Crowd, Vec2 } from "../crowd/model";
import type { Outlines } from "../store";
import { categorical } from "./palette";
import { band, fan } from "./strips";

/** Half a person's width: outlines keep that clear of the paths. */
const CLEARANCE = 0.34;

export interface Hull {
  instance: number;
  kind: number;
  people: number;
  outline: Vec2[];
  /** Frames. */
  begin: number;
  end: number;
}

/** The hulls of all instances that take place within the crowd's life. */
export function hulls(crowd: Crowd): Hull[] {
  return membersOf(crowd).flatMap((members: Member[], instance): Hull[] => {
    const points = members.flatMap((m) => pathPoints(crowd, m));
    if (points.length === 0) return [];
    const [begin, end] = span(crowd, members);
    const kind = crowd.instances[instance];
    const outline = roundedHull(points, CLEARANCE);
    return [{ instance, kind, people: crowd.kinds[kind].people, outline, begin, end }];
  });
}

export class PatchOutlines {
  readonly mesh: Mesh;
  private readonly material: ShaderMaterial;

  constructor(crowd: Crowd, all: readonly Hull[]) {
    const positions: number[] = [];
    const colors: number[] = [];
    const spans: number[] = [];
    const add = (hull: Hull, triangles: number[], alpha: number) => {
      const color = new Color(categorical(hull.kind));
      positions.push(...triangles);
      for (let i = 0; i < triangles.length; i += 3) {
        colors.push(color.r, color.g, color.b, alpha);
        spans.push(hull.begin / crowd.fps, hull.end / crowd.fps, hull.people);
      }
    };
    for (const hull of all) {
      add(hull, fan(hull.outline, 0), hull.people > 1 ? 0.2 : 0.05);
      add(hull, band(hull.outline, hull.people > 1 ? 0.024 : 0.012, 0), hull.people > 1 ? 0.95 : 0.55);
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
    geometry.setAttribute("tint", new Float32BufferAttribute(colors, 4));
    geometry.setAttribute("span", new Float32BufferAttribute(spans, 3));
    this.material = new ShaderMaterial({
      transparent: true,
      depthWrite: false,
      polygonOffset: true,
      polygonOffsetFactor: -1,
      polygonOffsetUnits: -1,
      uniforms: { time: { value: 0 }, lift: { value: 0 }, least: { value: 2 } },
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
    });
    this.mesh = new Mesh(geometry, this.material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 1.5;
  }

  update(secs: number, lift: number, show: Outlines): void {
    this.mesh.visible = show !== "none";
    this.material.uniforms.time.value = secs;
    this.material.uniforms.lift.value = lift;
    this.material.uniforms.least.value = show === "all" ? 1 : 2;
  }
}

const VERTEX = /* glsl */ `
attribute vec4 tint; attribute vec3 span;
uniform float time, lift, least;
varying vec4 vTint;
void main() {
  float fade = smoothstep(span.x - 0.15, span.x + 0.15, time) * (1.0 - smoothstep(span.y - 0.15, span.y + 0.15, time));
  bool shown = span.z >= least && fade > 0.0;
  vTint = vec4(tint.rgb, tint.a * fade);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position + vec3(0.0, lift + 0.004, 0.0), 1.0);
  if (!shown) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}
`;

const FRAGMENT = /* glsl */ `
varying vec4 vTint;
void main() {
  gl_FragColor = vTint;
  #include <colorspace_fragment>
}
`;
