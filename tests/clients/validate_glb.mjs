// Asks Khronos' glTF validator, and three.js, what they think of a GLB file:
//   node validate_glb.mjs crowd.glb
// Prints one JSON object; exits with 1 if the file has an error or a warning, or does not load.
import { readFileSync } from "node:fs";
import validator from "gltf-validator";

// GLTFLoader was written for browsers; this is all it misses here.
globalThis.self = globalThis;
globalThis.ProgressEvent ??= class extends Event {};
const { GLTFLoader } = await import("three/examples/jsm/loaders/GLTFLoader.js");

async function validate(bytes) {
  const report = await validator.validateBytes(bytes, { maxIssues: 100 });
  // On truncated files the validator leaves these out.
  const { numErrors = 1, numWarnings = 0, numInfos = 0, messages = [] } = report.issues ?? {};
  const serious = messages.filter((m) => m.severity <= 1);
  return { errors: numErrors, warnings: numWarnings, infos: numInfos, messages: serious, info: report.info };
}

async function load(bytes) {
  const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  const gltf = await new GLTFLoader().parseAsync(buffer, "");
  let skinned = 0;
  gltf.scene.traverse((node) => (skinned += node.isSkinnedMesh ? 1 : 0));
  const tracks = gltf.animations.reduce((n, a) => n + a.tracks.length, 0);
  return { skinned_meshes: skinned, tracks, duration: gltf.animations[0]?.duration ?? 0 };
}

const bytes = new Uint8Array(readFileSync(process.argv[2]));
const result = await validate(bytes);
try {
  result.three = await load(bytes);
} catch (error) {
  result.three = { error: String(error) };
}
console.log(JSON.stringify(result, null, 1));
process.exit(result.errors + result.warnings === 0 && !result.three.error ? 0 : 1);
