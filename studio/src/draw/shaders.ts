/** GLSL shared by everything that draws people. */

/** Reads value `i` of a list that lies in a texture row by row. */
const TEXEL = /* glsl */ `
ivec2 texelOf(int i, int width) { return ivec2(i % width, i / width); }
vec3 turn(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
`;

export const POSE_VERTEX = /* glsl */ `
in vec3 position;
void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }
`;

/**
 * One fragment per person and joint: the joint's global position (w: 1 + the current fragment's index, or 0 while the
 * person is absent) and rotation at the current time. Walking the chain here, once per joint, instead of in the body's
 * vertex shader, once per vertex, costs a hundredth, and the result can be read back and tested.
 */
export const poseFragment = (joints: number): string => /* glsl */ `
precision highp float; precision highp int; precision highp sampler2D;
precision highp isampler2D;
uniform isampler2D rotations; uniform sampler2D roots; uniform isampler2D people;
uniform float frame; uniform int personCount; uniform int columns;
uniform int parents[${joints}]; uniform sampler2D builds; uniform vec4 tile;
layout(location = 0) out vec4 outPosition;
layout(location = 1) out vec4 outRotation;
${TEXEL}
vec4 times(vec4 a, vec4 b) { return vec4(a.w * b.xyz + b.w * a.xyz + cross(a.xyz, b.xyz), a.w * b.w - dot(a.xyz, b.xyz)); }
vec4 unpacked(int at) { return normalize(vec4(texelFetch(rotations, texelOf(at, textureSize(rotations, 0).x), 0))); }
vec4 blended(int a, int b, float t, int joint) {
  vec4 p = unpacked(a * ${joints} + joint), q = unpacked(b * ${joints} + joint);
  return normalize(mix(p, dot(p, q) < 0.0 ? -q : q, t));
}
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  int joint = at.x % ${joints}, person = at.y * columns + at.x / ${joints};
  outPosition = vec4(0.0); outRotation = vec4(0.0, 0.0, 0.0, 1.0);
  if (person >= personCount) return;
  ivec4 who = texelFetch(people, texelOf(person, textureSize(people, 0).x), 0);
  float own = frame - float(who.y);
  if (who.z < 1 || own < 0.0 || own > float(who.z - 1)) return;
  int i = min(int(own), max(who.z - 2, 0)), j = min(i + 1, who.z - 1);
  float t = own - float(i);
  vec3 p = vec3(0.0); vec4 q = vec4(0.0, 0.0, 0.0, 1.0);
  for (int k = joint; k >= 0; k = parents[k]) {
    vec4 r = blended(who.x + i, who.x + j, t, k);
    p = turn(r, p); q = times(r, q);
    int bone = (who.w * ${joints} + k) * 2;
    if (parents[k] >= 0) p += texelFetch(builds, texelOf(bone, textureSize(builds, 0).x), 0).xyz;
  }
  int width = textureSize(roots, 0).x;
  vec4 rootA = texelFetch(roots, texelOf(who.x + i, width), 0), rootB = texelFetch(roots, texelOf(who.x + j, width), 0);
  vec3 root = mix(rootA.xyz, rootB.xyz, t);
  // Inside the region where the ground repeats.
  if (tile.z > 0.0) root.x -= tile.z * round((root.x - tile.x) / tile.z);
  if (tile.w > 0.0) root.z -= tile.w * round((root.z - tile.y) / tile.w);
  outPosition = vec4(p + root, 1.0 + (t < 1.0 ? rootA.w : rootB.w));
  outRotation = q;
}
`;

/** Reads the result of the pose pass in a vertex shader. */
export const poseLookup = (joints: number): string => /* glsl */ `
precision highp sampler2D;
uniform sampler2D posePositions, poseRotations; uniform int poseColumns, personCount; uniform vec2 tileOffsets[9];
${TEXEL}
ivec2 poseTexel(int person, int joint) {
  return ivec2((person % poseColumns) * ${joints} + joint, person / poseColumns);
}
/** Instances are all people of the first tile, then all people of the next. */
int personOf(int instance) { return instance % personCount; }
vec2 tileOffsetOf(int instance) { return tileOffsets[instance / personCount]; }
`;

/** Skins \`position\` and \`normal\` into \`skinned\` and \`skinnedNormal\`; people who are absent vanish. */
export const skinning = (joints: number): string => /* glsl */ `
${poseLookup(joints)}
uniform vec3 rest[${joints}]; uniform float lift; uniform sampler2D builds;
attribute float build; attribute vec4 bones; attribute vec4 weights; attribute float part;
vec3 skinned, skinnedNormal;
void skin(vec3 point, vec3 direction) {
  int person = personOf(gl_InstanceID);
  skinned = vec3(0.0); skinnedNormal = vec3(0.0);
  if (texelFetch(posePositions, poseTexel(person, 0), 0).w < 0.5) { skinned = vec3(0.0, -1e4, 0.0); return; }
  for (int n = 0; n < 4; n++) {
    if (weights[n] <= 0.0) continue;
    int joint = int(bones[n] + 0.5);
    ivec2 at = poseTexel(person, joint);
    vec4 q = texelFetch(poseRotations, at, 0);
    int row = (int(build + 0.5) * ${joints} + joint) * 2 + 1;
    vec4 flesh = texelFetch(builds, texelOf(row, textureSize(builds, 0).x), 0);
    vec3 grown = (point - rest[joint]) * flesh.xyz + vec3(0.0, 0.0, flesh.w);
    skinned += weights[n] * (texelFetch(posePositions, at, 0).xyz + turn(q, grown));
    skinnedNormal += weights[n] * turn(q, direction / flesh.xyz);
  }
  vec2 beside = tileOffsetOf(gl_InstanceID);
  skinned += vec3(beside.x, lift, beside.y);
}
`;

/** The colour of a vertex by its part of the clothes, the colour mode and the current fragment. */
export const CLOTHES = /* glsl */ `
uniform sampler2D looks, fragmentColors; uniform int colorMode, chosen, partCount;
varying vec3 vCloth; varying float vChosen;
vec4 look(int part) {
  return texelFetch(looks, texelOf(personOf(gl_InstanceID) * partCount + part, textureSize(looks, 0).x), 0);
}
void dress() {
  int id = int(part + 0.5);
  vec4 own = look(id);
  vCloth = own.rgb;
  vChosen = personOf(gl_InstanceID) == chosen ? 1.0 : 0.0;
  if (own.a < 0.5) skinned = vec3(0.0, -1e4, 0.0);
  if (colorMode == 0) return;
  int current = int(texelFetch(posePositions, poseTexel(personOf(gl_InstanceID), 0), 0).w + 0.5) - 1;
  vec4 color = vec4(0.6, 0.6, 0.6, 0.0);
  int width = textureSize(fragmentColors, 0).x;
  if (current >= 0) color = texelFetch(fragmentColors, texelOf(current * 2 + colorMode - 1, width), 0);
  // Bodies turn into coloured figures: the shirt takes the colour, the rest a darker or lighter shade of it.
  bool hair = id == 1 || (id >= 8 && id <= 10), shoe = id == 6 || id == 7, below = id == 4 || id == 5 || id >= 11;
  float shade = id == 0 ? 1.12 : hair ? 0.42 : below ? 0.66 : shoe ? 0.34 : 1.0;
  vec3 quiet = vec3(0.60, 0.60, 0.58);
  vCloth = mix(colorMode == 2 && color.a < 0.5 ? quiet : color.rgb, vec3(1.0), id == 0 ? 0.35 : 0.0) * shade;
}
`;
