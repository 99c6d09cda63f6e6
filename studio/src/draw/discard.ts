/** Frees what lies on the graphics card. */

import { type BufferGeometry, InstancedMesh, type Material, type Object3D, Sprite } from "three";

/** Takes an object out of the scene and frees the geometry, materials and pictures of all its parts. */
export function discard(object: Object3D): void {
  object.removeFromParent();
  object.traverse((part) => {
    const drawn = part as Partial<{ geometry: BufferGeometry; material: Material | Material[] }> & Object3D;
    // All sprites share one geometry, which stays.
    if (part instanceof Sprite) part.material.map?.dispose();
    else drawn.geometry?.dispose();
    if (part instanceof InstancedMesh) part.dispose();
    for (const material of [drawn.material, part.customDepthMaterial].flat()) material?.dispose();
  });
}
