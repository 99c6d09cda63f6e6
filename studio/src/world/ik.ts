/** Two-bone inverse kinematics: the same as src/motion/ik.rs. */

import {
  conjugate,
  cross,
  dot,
  length,
  minus,
  normalized,
  plus,
  product,
  type Quat,
  scaled,
  turned,
  unit,
  type Vec,
} from "./quaternion";

const POLE_PULL = 0.04;

/** Rotations to apply to the upper bone and all below it, then to the lower one, so that the end reaches its target. */
export function twoBone(hip: Vec, knee: Vec, end: Vec, target: Vec, pole: Vec, stretch: number): [Quat, Quat] {
  const [thigh, shin, way] = [minus(knee, hip), minus(end, knee), minus(target, hip)];
  const [upper, lower] = [length(thigh), length(shin)];
  const reach = Math.min(Math.max(length(way), Math.abs(upper - lower) + 1e-4), (upper + lower) * stretch);
  const along = unit(minus(end, hip), [0, -1, 0]);
  const toward = unit(way, along);
  const bulge = rejected(thigh, along);
  const pulled = plus(bulge, scaled(rejected(pole, along), POLE_PULL));
  const side = unit(rejected(turned(arc(along, toward), pulled), toward), aside(toward));
  const foot = (upper * upper - lower * lower + reach * reach) / (2 * reach);
  const bent = plus(scaled(toward, foot), scaled(side, Math.sqrt(Math.max(upper * upper - foot * foot, 0))));
  const below = minus(scaled(toward, reach), bent);
  const lead = arc(unit(thigh, along), unit(bent, along));
  const hinge = turned(lead, cross(thigh, shin));
  const swing = product(
    twist(scaled(bent, 1 / Math.max(upper, 1e-6)), hinge, cross(bent, below), dot(bulge, bulge)),
    lead,
  );
  const turn = arc(unit(turned(swing, shin), along), unit(below, along));
  return [swing, product(product(conjugate(swing), turn), swing)];
}

/** The turn about the upper bone that brings its hinge from one axis to another; less of it, the straighter the limb was. */
function twist(bone: Vec, from: Vec, to: Vec, off: number): Quat {
  const cosine = dot(from, to) + Math.sqrt(dot(from, from) * dot(to, to));
  const sine = dot(cross(from, to), bone);
  const whole = Math.hypot(sine, cosine);
  if (whole < 1e-10) return [0, 0, 0, 1];
  const forwards = Math.min((2 * cosine * cosine) / (whole * whole), 1);
  const weight = (forwards * off) / (off + POLE_PULL * POLE_PULL);
  return normalized([...scaled(bone, sine * weight), whole + (cosine - whole) * weight]);
}

const rejected = (v: Vec, axis: Vec): Vec => minus(v, scaled(axis, dot(v, axis)));

/** Some direction at right angles. */
function aside(v: Vec): Vec {
  return unit(cross(v, Math.abs(v[0]) < 0.8 ? [1, 0, 0] : [0, 1, 0]), [0, 0, 1]);
}

/** The shortest turn from one direction to another. */
function arc(from: Vec, to: Vec): Quat {
  const cosine = dot(from, to);
  return cosine < -0.999999 ? [...aside(from), 0] : normalized([...cross(from, to), 1 + cosine]);
}
