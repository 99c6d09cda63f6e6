/** The scene: renderer, lights, ground, region and obstacles. */

import {
  BufferGeometry,
  Color,
  DirectionalLight,
  Float32BufferAttribute,
  Group,
  HemisphereLight,
  LinearToneMapping,
  Mesh,
  PCFShadowMap,
  PlaneGeometry,
  Scene,
  ShaderMaterial,
  ShadowMaterial,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { bounds } from "../crowd/hull";
import type { Crowd, Vec2 } from "../crowd/model";
import { type Tile, tileOf, tileOffsets } from "../crowd/tiles";
import { discard } from "./discard";
import { Obstacles } from "./obstacles";
import { LIGHT, type Theme } from "./palette";
import { band } from "./strips";

export class Stage {
  readonly renderer: WebGLRenderer;
  readonly scene = new Scene();
  readonly sun: DirectionalLight;
  /** Middle of the region on the ground. */
  readonly center = new Vector3();
  /** Half the diagonal of the region's box. */
  radius = 10;
  private readonly hemisphere: HemisphereLight;
  private readonly ground = new Group();
  /** Those of the crowd's own tile, which come first, and of all other tiles. */
  private obstacles: Obstacles[] = [];
  /** What is to be seen of the other tiles of a crowd that repeats. */
  private readonly images = new Group();
  private floor: ShaderMaterial | null = null;

  constructor(
    canvas: HTMLCanvasElement,
    private theme: Theme = LIGHT,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
    this.renderer.toneMapping = LinearToneMapping;
    this.renderer.toneMappingExposure = 1;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.info.autoReset = false;
    this.hemisphere = new HemisphereLight(theme.sky, theme.bounce, theme.skyStrength);
    this.sun = new DirectionalLight(theme.sun, theme.sunStrength);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    this.sun.shadow.radius = 5;
    this.sun.shadow.bias = -0.0004;
    this.sun.shadow.normalBias = 0.02;
    this.scene.add(this.hemisphere, this.sun, this.sun.target, this.ground);
    this.scene.background = new Color(theme.background);
  }

  /** Lays the ground of a crowd. */
  build(crowd: Crowd): void {
    const { low, high } = bounds(crowd.region);
    this.center.set((low[0] + high[0]) / 2, 0, (low[1] + high[1]) / 2);
    this.radius = Math.hypot(high[0] - low[0], high[1] - low[1]) / 2;
    for (const old of [...this.ground.children]) discard(old);
    for (const old of [...this.images.children]) discard(old);
    const tile = tileOf(crowd);
    this.ground.add(this.plane(crowd.region, tile), this.shadows(), this.border(crowd.region), this.images);
    this.obstacles = tileOffsets(tile).map(() => new Obstacles(crowd, this.theme.obstacle));
    this.ground.add(this.obstacles[0].group);
    for (const [i, [x, z]] of tileOffsets(tile).entries()) {
      if (i === 0) continue;
      const image = new Group().add(this.border(crowd.region), this.obstacles[i].group);
      image.position.set(x, 0, z);
      this.images.add(image);
    }
    this.repeat(false);
  }

  /** Shows the ground of all tiles around the crowd's own, or of that one alone. */
  repeat(all: boolean): void {
    const shown = all && this.images.children.length > 0;
    this.images.visible = shown;
    if (!this.floor) return;
    this.floor.uniforms.reach.value = shown ? 1 : 0;
    this.floor.uniforms.radius.value = shown ? 3 * this.radius : this.radius;
  }

  /** Brings obstacles that move to `secs`. */
  update(secs: number): void {
    for (const obstacles of this.obstacles) obstacles.update(secs);
  }

  /** Puts the shadows' box around `focus`: sharp where one looks, whatever the size of the crowd. */
  light(focus: Vector3, reach: number): void {
    const half = Math.min(Math.max(reach, 4), this.radius + 2);
    const camera = this.sun.shadow.camera;
    this.sun.target.position.set(focus.x, 0, focus.z);
    this.sun.position.set(focus.x - 0.55 * 30, 30, focus.z + 0.42 * 30);
    if (Math.abs(camera.right - half) > half * 0.1) {
      camera.left = camera.bottom = -half;
      camera.right = camera.top = half;
      camera.near = 1;
      camera.far = 40 + half;
      camera.updateProjectionMatrix();
    }
  }

  resize(width: number, height: number, ratio: number): void {
    this.renderer.setPixelRatio(Math.min(ratio, 2));
    this.renderer.setSize(width, height, false);
  }

  private plane(region: readonly Vec2[], tile: Tile): Mesh {
    const corners = region.slice(0, 32).map(([x, z]) => new Vector2(x, z));
    const { theme } = this;
    const colors = { ground: theme.ground, region: theme.region, line: theme.line, background: theme.background };
    const material = new ShaderMaterial({
      uniforms: {
        center: { value: this.center },
        radius: { value: this.radius },
        ...Object.fromEntries(Object.entries(colors).map(([k, c]) => [`${k}Color`, { value: new Color(c) }])),
        corners: { value: corners },
        middle: { value: new Vector2(...tile.middle) },
        period: { value: new Vector2(...tile.period) },
        reach: { value: 0 },
      },
      vertexShader: GROUND_VERTEX,
      fragmentShader: `#define CORNERS ${corners.length}\n${GROUND_FRAGMENT}`,
      polygonOffset: true,
      polygonOffsetFactor: 2,
      polygonOffsetUnits: 2,
    });
    this.floor = material;
    const size = Math.max(this.radius * 12, 80);
    const mesh = new Mesh(new PlaneGeometry(size, size).rotateX(-Math.PI / 2), material);
    mesh.position.copy(this.center);
    return mesh;
  }

  private shadows(): Mesh {
    const material = new ShadowMaterial({ opacity: 0.3, color: 0x1d1a22 });
    const mesh = new Mesh(new PlaneGeometry(this.radius * 6, this.radius * 6).rotateX(-Math.PI / 2), material);
    mesh.position.copy(this.center).setY(0.002);
    mesh.receiveShadow = true;
    mesh.renderOrder = 1;
    return mesh;
  }

  private border(region: readonly Vec2[]): Mesh {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(band(region, 0.035, 0.004), 3));
    geometry.computeVertexNormals();
    const material = new ShaderMaterial({
      uniforms: { color: { value: new Color(this.theme.border) } },
      vertexShader: "void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
      fragmentShader:
        "uniform vec3 color; void main() { gl_FragColor = vec4(color, 1.0);\n#include <colorspace_fragment>\n}",
    });
    const mesh = new Mesh(geometry, material);
    mesh.renderOrder = 1;
    return mesh;
  }
}

const GROUND_VERTEX = /* glsl */ `
varying vec2 vGround;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  vGround = world.xz;
  gl_Position = projectionMatrix * viewMatrix * world;
}
`;

/** A grid of 1 m, fainter with distance; the region is lighter; far away the ground becomes the background. */
const GROUND_FRAGMENT = /* glsl */ `
uniform vec3 groundColor, regionColor, lineColor, backgroundColor, center; uniform float radius;
uniform vec2 corners[CORNERS], middle, period; uniform float reach;
varying vec2 vGround;
float grid(vec2 p, float spacing, float width) {
  vec2 q = p / spacing, w = fwidth(q);
  vec2 d = abs(fract(q - 0.5) - 0.5);
  vec2 line = 1.0 - smoothstep(vec2(width / spacing), vec2(width / spacing) + w * 1.2, d);
  return max(line.x, line.y) * clamp(1.0 - 1.5 * max(w.x, w.y), 0.0, 1.0);
}
bool inside(vec2 p) {
  bool odd = false;
  for (int i = 0, j = CORNERS - 1; i < CORNERS; j = i++) {
    vec2 a = corners[i], b = corners[j];
    if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x) odd = !odd;
  }
  return odd;
}
void main() {
  // Where the ground repeats, a place in a tile nearby is the same place in the crowd's own.
  vec2 tile = clamp(floor((vGround - middle) / max(period, vec2(1e-6)) + 0.5), vec2(-reach), vec2(reach));
  bool in_region = inside(vGround - tile * period);
  vec3 color = in_region ? regionColor : groundColor;
  float lines = max(grid(vGround, 1.0, 0.002) * 0.42, grid(vGround, 5.0, 0.005) * 0.7);
  color = mix(color, lineColor, lines * (in_region ? 0.75 : 0.3));
  float far = smoothstep(radius * 1.1, radius * 3.2, length(vGround - center.xz));
  gl_FragColor = vec4(mix(color, backgroundColor, far), 1.0);
  #include <colorspace_fragment>
}
`;
