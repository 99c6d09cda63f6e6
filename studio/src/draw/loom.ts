/**
 * The loom: space and time as one picture, as figure 5 of the tiling paper. Time runs upwards; every person is a
 * thread, coloured by the patch instance it is in; patches of several people are translucent prisms; dots are stitches.
 */

import {
  BufferGeometry,
  Color,
  Float32BufferAttribute,
  Group,
  InstancedMesh,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  ShaderMaterial,
  SphereGeometry,
} from "three";
import { bounds } from "../crowd/hull";
import { type Crowd, duration, type Vec2 } from "../crowd/model";
import type { Hull } from "./outlines";
import { categorical, LIGHT } from "./palette";
import { band, fan } from "./strips";
import { threads } from "./threads";

export class Loom {
  readonly group = new Group();
  /** Metres of height per second. */
  readonly scale: number;
  readonly height: number;
  private readonly plane: Group;
  private readonly material: ShaderMaterial;
  private readonly prisms: ShaderMaterial;

  constructor(crowd: Crowd, hulls: readonly Hull[]) {
    const { low, high } = bounds(crowd.region);
    const size = Math.max(high[0] - low[0], high[1] - low[1]);
    this.height = size * 0.95;
    this.scale = this.height / Math.max(duration(crowd), 1e-3);
    this.material = threadMaterial();
    this.prisms = prismMaterial();
    this.plane = timePlane(crowd.region);
    this.group.add(this.makeThreads(crowd, size), this.makePrisms(crowd, hulls), this.makeStitches(crowd, size));
    this.group.add(this.frame(crowd.region), this.plane);
    this.group.visible = false;
  }

  /** Height of a time above the ground. */
  heightAt(secs: number): number {
    return secs * this.scale;
  }

  update(secs: number, chosen: number): void {
    const now = this.heightAt(secs);
    this.plane.position.y = now;
    this.material.uniforms.now.value = now;
    this.material.uniforms.chosen.value = chosen;
    this.prisms.uniforms.now.value = now;
  }

  private makeThreads(crowd: Crowd, size: number): Mesh {
    // The more people, the thinner the threads: the cloth stays open enough to look into.
    const thin = Math.min(Math.max(Math.sqrt(20 / crowd.characters.length), 0.35), 1);
    const made = threads(crowd, this.scale / crowd.fps, size * 0.0055 * thin);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(made.positions, 3));
    geometry.setAttribute("normal", new Float32BufferAttribute(made.normals, 3));
    geometry.setAttribute("tint", new Float32BufferAttribute(made.colors, 3));
    geometry.setAttribute("person", new Float32BufferAttribute(made.people, 1));
    geometry.setIndex(made.indices);
    const mesh = new Mesh(geometry, this.material);
    mesh.frustumCulled = false;
    return mesh;
  }

  private makePrisms(crowd: Crowd, hulls: readonly Hull[]): Mesh {
    const positions: number[] = [];
    const colors: number[] = [];
    const normals: number[] = [];
    for (const hull of hulls.filter((h) => h.people > 1 && h.end > h.begin)) {
      const [low, high] = [hull.begin, hull.end].map((frame) => this.heightAt(frame / crowd.fps));
      const color = new Color(categorical(hull.instance));
      const start = positions.length;
      walls(hull.outline, low, high, positions, normals);
      for (const y of [low, high]) {
        const lid = fan(hull.outline, y);
        positions.push(...lid);
        for (let i = 0; i < lid.length; i += 3) normals.push(0, y === high ? 1 : -1, 0);
      }
      for (let i = start; i < positions.length; i += 3) colors.push(color.r, color.g, color.b);
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
    geometry.setAttribute("normal", new Float32BufferAttribute(normals, 3));
    geometry.setAttribute("tint", new Float32BufferAttribute(colors, 3));
    const mesh = new Mesh(geometry, this.prisms);
    mesh.renderOrder = 4;
    mesh.frustumCulled = false;
    return mesh;
  }

  /** A dot wherever one fragment ends and the next begins. */
  private makeStitches(crowd: Crowd, size: number): InstancedMesh {
    const places: Matrix4[] = [];
    for (const c of crowd.characters) {
      for (const f of c.fragments.slice(1)) {
        const frame = Math.min(Math.max(f.begin - c.begin, 0), c.frames - 1);
        const at = (c.firstFrame + frame) * 3;
        const y = ((c.begin + frame) / crowd.fps) * this.scale;
        places.push(new Matrix4().makeTranslation(crowd.root[at], y, crowd.root[at + 2]));
      }
    }
    const radius = size * 0.0062 * Math.min(Math.max(Math.sqrt(150 / Math.max(places.length, 1)), 0.35), 1);
    const dot = new SphereGeometry(radius, places.length > 500 ? 6 : 10, places.length > 500 ? 4 : 8);
    const mesh = new InstancedMesh(dot, new MeshBasicMaterial({ color: "#45413a" }), places.length);
    for (const [i, place] of places.entries()) mesh.setMatrixAt(i, place);
    mesh.frustumCulled = false;
    return mesh;
  }

  /** Thin lines: the region at the end of time, and the edges in between. */
  private frame(region: readonly Vec2[]): LineSegments {
    const points: number[] = [];
    for (const [i, [x, z]] of region.entries()) {
      const [nextX, nextZ] = region[(i + 1) % region.length];
      points.push(x, this.height, z, nextX, this.height, nextZ, x, 0, z, x, this.height, z);
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
    return new LineSegments(geometry, new LineBasicMaterial({ color: "#8d877b", transparent: true, opacity: 0.6 }));
  }
}

function walls(outline: readonly Vec2[], low: number, high: number, positions: number[], normals: number[]): void {
  for (let i = 0; i < outline.length; i++) {
    const [a, b] = [outline[i], outline[(i + 1) % outline.length]];
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
    const normal = [(b[1] - a[1]) / length, 0, -(b[0] - a[0]) / length];
    positions.push(
      a[0],
      low,
      a[1],
      b[0],
      low,
      b[1],
      a[0],
      high,
      a[1],
      a[0],
      high,
      a[1],
      b[0],
      low,
      b[1],
      b[0],
      high,
      b[1],
    );
    for (let k = 0; k < 6; k++) normals.push(...normal);
  }
}

function timePlane(region: readonly Vec2[]): Group {
  const group = new Group();
  const part = (triangles: number[], opacity: number, color: string) => {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(triangles, 3));
    const mesh = new Mesh(
      geometry,
      new MeshBasicMaterial({ color, transparent: true, opacity, depthWrite: false, side: 2, toneMapped: false }),
    );
    mesh.renderOrder = 1;
    group.add(mesh);
  };
  part(fan(region, 0), 0.3, "#ffffff");
  part(band(region, 0.05, 0.002), 0.95, "#e2702a");
  return group;
}

function threadMaterial(): ShaderMaterial {
  return new ShaderMaterial({
    uniforms: { now: { value: 0 }, chosen: { value: -1 }, fog: { value: new Color(LIGHT.background) } },
    vertexShader: /* glsl */ `
attribute vec3 tint; attribute float person; uniform float chosen;
varying vec3 vTint, vNormal; varying float vHeight, vQuiet;
void main() {
  vTint = tint; vNormal = normalize(normalMatrix * normal); vHeight = position.y;
  vQuiet = chosen >= 0.0 && abs(person - chosen) > 0.5 ? 1.0 : 0.0;
  vec3 p = position + (chosen >= 0.0 && vQuiet < 0.5 ? normal * 0.045 : vec3(0.0));
  gl_Position = projectionMatrix * modelViewMatrix * vec4(p, 1.0);
}`,
    fragmentShader: /* glsl */ `
uniform float now; uniform vec3 fog;
varying vec3 vTint, vNormal; varying float vHeight, vQuiet;
void main() {
  vec3 n = normalize(vNormal);
  float light = 0.62 + 0.38 * clamp(dot(n, normalize(vec3(-0.3, 0.7, 0.6))), 0.0, 1.0);
  // What is still to come is paler.
  float pale = (vHeight > now ? 0.34 : 0.0) + vQuiet * 0.55;
  gl_FragColor = vec4(mix(vTint * light, fog, min(pale, 0.8)), 1.0);
  #include <colorspace_fragment>
}`,
  });
}

function prismMaterial(): ShaderMaterial {
  return new ShaderMaterial({
    transparent: true,
    depthWrite: false,
    side: 2,
    uniforms: { now: { value: 0 } },
    vertexShader: /* glsl */ `
attribute vec3 tint; varying vec3 vTint, vNormal, vView; varying float vHeight;
void main() {
  vec4 view = modelViewMatrix * vec4(position, 1.0);
  vTint = tint; vNormal = normalMatrix * normal; vView = -view.xyz; vHeight = position.y;
  gl_Position = projectionMatrix * view;
}`,
    fragmentShader: /* glsl */ `
uniform float now; varying vec3 vTint, vNormal, vView; varying float vHeight;
void main() {
  float edge = 1.0 - abs(dot(normalize(vNormal), normalize(vView)));
  float alpha = (0.17 + 0.3 * edge * edge) * (vHeight > now ? 0.6 : 1.0);
  gl_FragColor = vec4(vTint, alpha);
  #include <colorspace_fragment>
}`,
  });
}
