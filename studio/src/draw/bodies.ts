/** Skinned and clothed bodies in one draw call, and one more for their shadows. */

import {
  type BufferGeometry,
  DoubleSide,
  Mesh,
  MeshDepthMaterial,
  MeshStandardMaterial,
  RGBADepthPacking,
  type WebGLProgramParametersWithUniforms,
} from "three";
import { CLOTHES, skinning } from "./shaders";

export type Uniforms = Record<string, { value: unknown }>;

/** A soft light along the edge of the body; stronger on the selected person. */
const RIM = /* glsl */ `
float rim = pow(1.0 - saturate(dot(normal, normalize(vViewPosition))), 3.0);
totalEmissiveRadiance += vCloth * rim * 0.10 + vChosen * (vec3(0.95, 0.55, 0.16) * rim * 0.9 + vCloth * 0.10);
`;

/** Bodies of so many joints that cast and receive shadows. */
export function bodies(geometry: BufferGeometry, uniforms: Uniforms, joints: number): Mesh {
  const material = new MeshStandardMaterial({ roughness: 0.82, metalness: 0 });
  material.onBeforeCompile = (shader) => inject(shader, uniforms, joints, true);
  const body = new Mesh(geometry, material);
  const depth = new MeshDepthMaterial({ depthPacking: RGBADepthPacking, side: DoubleSide });
  depth.onBeforeCompile = (shader) => inject(shader, uniforms, joints, false);
  body.customDepthMaterial = depth;
  body.castShadow = body.receiveShadow = true;
  body.frustumCulled = false;
  return body;
}

/** Adds skinning and clothes to one of three's own materials. */
function inject(
  shader: WebGLProgramParametersWithUniforms,
  uniforms: Uniforms,
  joints: number,
  colored: boolean,
): void {
  Object.assign(shader.uniforms, uniforms);
  shader.vertexShader = shader.vertexShader
    .replace("#include <common>", `#include <common>\n${skinning(joints)}\n${CLOTHES}`)
    .replace("#include <beginnormal_vertex>", "skin(position, normal); dress(); vec3 objectNormal = skinnedNormal;")
    .replace(
      "#include <begin_vertex>",
      colored ? "vec3 transformed = skinned;" : "skin(position, vec3(0.0)); dress(); vec3 transformed = skinned;",
    );
  if (!colored) return;
  shader.fragmentShader = shader.fragmentShader
    .replace("#include <common>", "#include <common>\nvarying vec3 vCloth; varying float vChosen;")
    .replace("#include <color_fragment>", "diffuseColor.rgb = vCloth;")
    .replace("#include <emissivemap_fragment>", RIM);
}
