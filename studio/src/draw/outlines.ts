/** Patch outlines on the ground: the hull of an instance's motion paths, while it is active. One draw call. */

import { BufferGeometry, Color, Float32BufferAttribute, Mesh, ShaderMaterial } from "three";
import { roundedHull } from "../crowd/hull";
import { type Member, membersOf, pathPoints, span } from "../crowd/lookup";
import type { Crowd, Vec2 } from "../crowd/model";
import type { ColorMode, Outlines } from "../store";
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
    const kindColors: number[] = [];
    const instanceColors: number[] = [];
    const spans: number[] = [];
    const add = (hull: Hull, triangles: number[], alpha: number) => {
      const [ofKind, ofInstance] = [hull.kind, hull.instance].map((i) => new Color(categorical(i)));
      positions.push(...triangles);
      for (let i = 0; i < triangles.length; i += 3) {
        kindColors.push(ofKind.r, ofKind.g, ofKind.b, alpha);
        instanceColors.push(ofInstance.r, ofInstance.g, ofInstance.b);
        spans.push(hull.begin / crowd.fps, hull.end / crowd.fps, hull.people);
      }
    };
    for (const hull of all) {
      add(hull, fan(hull.outline, 0), hull.people > 1 ? 0.2 : 0.05);
      add(hull, band(hull.outline, hull.people > 1 ? 0.024 : 0.012, 0), hull.people > 1 ? 0.95 : 0.55);
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
    geometry.setAttribute("kindColor", new Float32BufferAttribute(kindColors, 4));
    geometry.setAttribute("patchColor", new Float32BufferAttribute(instanceColors, 3));
    geometry.setAttribute("span", new Float32BufferAttribute(spans, 3));
    this.material = new ShaderMaterial({
      transparent: true,
      depthWrite: false,
      polygonOffset: true,
      polygonOffsetFactor: -1,
      polygonOffsetUnits: -1,
      uniforms: { time: { value: 0 }, lift: { value: 0 }, least: { value: 2 }, byInstance: { value: 0 } },
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
    });
    this.mesh = new Mesh(geometry, this.material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 1.5;
  }

  /** `color`: in the mode that shows who is together, outlines take their people's colour. */
  update(secs: number, lift: number, show: Outlines, color: ColorMode): void {
    this.material.uniforms.byInstance.value = color === "shared" ? 1 : 0;
    this.mesh.visible = show !== "none";
    this.material.uniforms.time.value = secs;
    this.material.uniforms.lift.value = lift;
    this.material.uniforms.least.value = show === "all" ? 1 : 2;
  }
}

const VERTEX = /* glsl */ `
attribute vec4 kindColor; attribute vec3 patchColor, span;
uniform float time, lift, least, byInstance;
varying vec4 vTint;
void main() {
  float fade = smoothstep(span.x - 0.15, span.x + 0.15, time) * (1.0 - smoothstep(span.y - 0.15, span.y + 0.15, time));
  bool shown = span.z >= least && fade > 0.0;
  vTint = vec4(mix(kindColor.rgb, patchColor, byInstance), kindColor.a * fade);
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
