/** Obstacles as blocks: walls as high as a hip, others as high as they are, and where they are at a moment. */

import { ExtrudeGeometry, Group, Mesh, MeshStandardMaterial, Shape, Vector2 } from "three";
import type { Crowd, Obstacle, Vec2 } from "../crowd/model";
import { placeOf } from "../crowd/obstacle";

/** Walls are drawn lower than they are, so that one sees over them; what moves is drawn as high as a person. */
const WALL = 1.1;
const MOVING = 1.9;
const BEVEL = 0.025;

export class Obstacles {
  readonly group = new Group();
  private readonly moving: [Obstacle, Mesh][] = [];

  constructor(crowd: Crowd, color: string) {
    for (const obstacle of crowd.obstacles) {
      const still = obstacle.path.length === 0;
      const mesh = block(obstacle.points, obstacle.height ?? (still ? WALL : MOVING), color);
      this.group.add(mesh);
      if (!still) this.moving.push([obstacle, mesh]);
    }
    this.update(0);
  }

  /** Brings what moves to `secs`. */
  update(secs: number): void {
    for (const [obstacle, mesh] of this.moving) {
      const { position, heading } = placeOf(obstacle, secs);
      mesh.position.set(position[0], 0, position[1]);
      mesh.rotation.y = heading;
    }
  }
}

function block(corners: readonly Vec2[], height: number, color: string): Mesh {
  // A shape lies in x, y and grows along z: turned so that its y becomes the ground's -z, hence the sign.
  const shape = new Shape(corners.map(([x, z]) => new Vector2(x, -z)));
  const bevel = Math.min(BEVEL, height / 4);
  const geometry = new ExtrudeGeometry(shape, {
    depth: height - bevel,
    bevelEnabled: true,
    bevelSize: bevel,
    bevelOffset: -bevel,
    bevelThickness: bevel,
    bevelSegments: 3,
  });
  geometry.rotateX(-Math.PI / 2);
  const mesh = new Mesh(geometry, new MeshStandardMaterial({ color, roughness: 0.9 }));
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}
