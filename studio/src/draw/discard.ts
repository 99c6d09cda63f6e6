/** Frees what lies on the graphics card. */

import { type Material, Mesh, type Object3D, Sprite } from "three";

/** Takes an object out of the scene and frees the geometry, materials and pictures of all its parts. */
export function discard(object: Object3D): void {
  object.removeFromParent();
  object.traverse((part) => {
    if (!(part instanceof Mesh || part instanceof Sprite)) return;
    // All sprites share one geometry, which stays.
    if (part instanceof Mesh) part.geometry.dispose();
    else part.material.map?.dispose();
    for (const material of [part.material, part.customDepthMaterial].flat() as (Material | undefined)[]) {
      material?.dispose();
    }
  });
}
