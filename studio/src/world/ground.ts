/** The ground of a world and what stands on it: floors by template, houses where nobody walks, lamps, trees, benches. */

import {
  BoxGeometry,
  type BufferGeometry,
  Color,
  CylinderGeometry,
  ExtrudeGeometry,
  Float32BufferAttribute,
  Group,
  Mesh,
  MeshStandardMaterial,
  Shape,
  SphereGeometry,
  Vector2,
} from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";
import { acts } from "./acts";
import type { Kind, Place, Thing, World } from "./model";

const GROUNDS: Record<string, string> = {
  cobblestones: "#d9d1c1",
  asphalt: "#b9bbbd",
  grass: "#a9bf86",
  floor: "#d8c3b3",
  roof: "#8d8f94",
  water: "#9dc0d0",
};
/** Height of what is open below a house, metres. */
const ARCADE = 3.3;
const STAYER = "#8a5a44";

/** A patch as geometry in the world's frame, with a colour at every vertex. */
export function patchMesh(world: World, place: Place): Group {
  const kind = world.kinds[place.kind];
  const ground = world.templates[kind.template].ground;
  const color = GROUNDS[ground] ?? "#cfcabd";
  const parts = [floor(kind, color)];
  if (ground === "roof" || ground === "floor") parts.push(...house(kind, place));
  for (const thing of kind.things) parts.push(...standing(thing));
  for (const [index, { x, z, heading }] of kind.stayers.entries()) {
    // Who does something is drawn as those who walk are.
    if (acts(world, place, index) !== null) continue;
    const person = new CylinderGeometry(0.16, 0.2, 1.45, 8).translate(0, 0.72, 0);
    const head = new SphereGeometry(0.125, 8, 6).translate(0, 1.6, 0.03);
    for (const part of [person, head]) parts.push(painted(part.rotateY(heading).translate(x, 0, z), STAYER));
  }
  const group = new Group();
  const merged = mergeGeometries(parts.map(plain));
  const mesh = new Mesh(merged, new MeshStandardMaterial({ vertexColors: true, roughness: 0.92 }));
  mesh.castShadow = mesh.receiveShadow = true;
  group.add(mesh);
  // The kind's x axis points along (cos, sin) in (x, z): a turn about y the other way round.
  group.rotation.y = -place.turn;
  return group;
}

function painted(geometry: BufferGeometry, color: string): BufferGeometry {
  const { r, g, b } = new Color(color);
  const n = geometry.getAttribute("position").count;
  geometry.setAttribute(
    "color",
    new Float32BufferAttribute(
      new Float32Array(n * 3).map((_, i) => [r, g, b][i % 3]),
      3,
    ),
  );
  return geometry;
}

/** Only what all parts have. */
function plain(geometry: BufferGeometry): BufferGeometry {
  const loose = geometry.index ? geometry.toNonIndexed() : geometry;
  for (const name of Object.keys(loose.attributes)) {
    if (!["position", "normal", "color"].includes(name)) loose.deleteAttribute(name);
  }
  return loose;
}

function outline(points: Float32Array, grow = 1): Shape {
  const corners = Array.from({ length: points.length / 2 }, (_, i) => new Vector2(points[2 * i], -points[2 * i + 1]));
  return new Shape(corners.map((p) => p.multiplyScalar(grow)));
}

/** Shapes lie in x, y and grow along z: turned so that their y is the ground's -z. */
function raised(shape: Shape, height: number): BufferGeometry {
  return new ExtrudeGeometry(shape, { depth: height, bevelEnabled: false }).rotateX(-Math.PI / 2);
}

function floor(kind: Kind, color: string): BufferGeometry {
  return painted(raised(outline(kind.outline), 0.02).translate(0, -0.02, 0), color);
}

/** Where people walk below, a house stands on pillars. */
function house(kind: Kind, place: Place): BufferGeometry[] {
  // The same house whenever it is looked at.
  const chance = Math.abs(Math.sin(place.x * 12.9898 + place.z * 78.233) * 43758.5453) % 1;
  const tint = ["#c9b8a3", "#b79f8b", "#d5cabb", "#a8a39a", "#bf8f78"][Math.floor(chance * 5)];
  const open = kind.walkers > 0 ? ARCADE : 0;
  const walls = painted(raised(outline(kind.outline, 0.985), 5 + 7 * chance).translate(0, open, 0), tint);
  if (open === 0) return [walls];
  const pillars = Array.from({ length: kind.outline.length / 2 }, (_, i) => {
    const [x, z] = [kind.outline[2 * i] * 0.94, kind.outline[2 * i + 1] * 0.94];
    return painted(new BoxGeometry(0.36, open, 0.36).translate(x, open / 2, z), tint);
  });
  return [walls, ...pillars];
}

/** What a static object looks like, by its name; unknown ones are plain columns and boxes. */
function standing(thing: Thing): BufferGeometry[] {
  const [x, z] = thing.points;
  const column = (low: number, high: number, from: number, to: number, color: string) =>
    painted(new CylinderGeometry(high, low, to - from, 12).translate(x, (from + to) / 2, z), color);
  if (thing.radius === 0) {
    const bench = thing.name === "bench" || thing.name === "seat";
    return [painted(raised(outline(thing.points), bench ? 0.45 : 2.1), bench ? "#94714f" : "#b5654a")];
  }
  switch (thing.name) {
    case "lamp":
      return [
        column(0.07, 0.05, 0, 3.6, "#3b4046"),
        painted(new SphereGeometry(0.2, 10, 8).translate(x, 3.7, z), "#fff2cf"),
      ];
    case "tree": {
      const crown = new SphereGeometry(1.25, 10, 8).scale(1, 1.15, 1).translate(x, 3.6, z);
      return [column(0.2, 0.14, 0, 2.8, "#6b5340"), painted(crown, "#6f9152")];
    }
    case "fountain": {
      const basin = new CylinderGeometry(thing.radius, thing.radius, 0.5, 24).translate(x, 0.25, z);
      return [painted(basin, "#aeb4b6"), column(0.12, 0.08, 0.5, 1.5, "#8fb3c4")];
    }
    case "flower pot": {
      const flowers = new SphereGeometry(thing.radius * 0.9, 10, 8).translate(x, 0.65, z);
      return [column(thing.radius * 0.7, thing.radius, 0, 0.5, "#b5654a"), painted(flowers, "#8c9f56")];
    }
    default:
      return [column(thing.radius, thing.radius, 0, 0.9, "#6d7478")];
  }
}

/** A box for the horizon: the ground beyond all patches. */
export function beyond(color: string): Mesh {
  const geometry = painted(new BoxGeometry(4000, 0.1, 4000).translate(0, -0.12, 0), color);
  return new Mesh(geometry, new MeshStandardMaterial({ vertexColors: true, roughness: 1 }));
}
