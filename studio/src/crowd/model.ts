/** The finished crowd as the studio sees it. Names and units as in src/stage/crowd.rs: metres, seconds, radians. */

export type Vec2 = readonly [x: number, z: number];
export type Vec3 = readonly [x: number, y: number, z: number];

export interface Joint {
  name: string;
  /** Index of the parent; -1 for the root. */
  parent: number;
  offset: Vec3;
}

export interface Kind {
  name: string;
  labels: string[];
  /** Number of people. */
  people: number;
}

/** One fragment of an instance in the life of a character. Frames; `begin` is negative where time crops it. */
export interface Fragment {
  instance: number;
  role: number;
  begin: number;
  end: number;
  /** The deformed path's samples in `pathPoints`. */
  firstSample: number;
  samples: number;
}

/** A person's bones and girth; as src/motion/build.rs. */
export interface Build {
  name: string;
  /** Offset of every joint from its parent, in place of the skeleton's. */
  offsets: readonly Vec3[];
  /** How the flesh around every joint differs from the canonical body's: scale x, y, z about it, shift forward. */
  flesh: readonly Flesh[];
}
export type Flesh = readonly [x: number, y: number, z: number, forward: number];

export interface Character {
  /** First frame of the final motion on the crowd's clock. */
  begin: number;
  frames: number;
  /** Place of that frame in `root` and `rotations`. */
  firstFrame: number;
  /** Index of the build. */
  build: number;
  /** Index of the team; null of who is of none. */
  team: number | null;
  fragments: Fragment[];
}

/** A box that people hold in both hands; it stays level. */
export interface Prop {
  name: string;
  /** Full extents: width between the hands, height, depth. */
  size: Vec3;
  /** First frame on the crowd's clock. */
  begin: number;
  frames: number;
  /** Place of that frame in `propPlaces`. */
  firstFrame: number;
  /** Who has it in the hands, first and last frame; otherwise it rests. */
  holds: { character: number; begin: number; end: number }[];
}

export interface Waypoint {
  secs: number;
  position: Vec2;
  /** Radians about +y. */
  heading: number;
}

export interface Obstacle {
  /** On the ground of the scene, or about its way-points if there are some. */
  points: Vec2[];
  /** Metres; null is over all heads. */
  height: number | null;
  /** In order of time; empty if it stands. */
  path: Waypoint[];
}

export interface Crowd {
  fps: number;
  /** As text: 64 bits do not fit a number. */
  seed: string;
  joints: Joint[];
  /** At least one. */
  builds: Build[];
  region: Vec2[];
  obstacles: Obstacle[];
  lastFrame: number;
  /** Where the crowd repeats: along x and z with the region, in time with the last frame, which is the first again. */
  periodic: { x: boolean; z: boolean; t: boolean };
  /** Names of the teams. */
  teams: string[];
  kinds: Kind[];
  /** Kind of every instance. */
  instances: number[];
  characters: Character[];
  /** x, y, z per frame. */
  root: Float32Array;
  /** x, y, z, w per frame and joint, times 32767; hips global, others local. */
  rotations: Int16Array;
  /** x, z per path sample. */
  pathPoints: Float32Array;
  props: Prop[];
  /** x, y, z of the middle and the heading (radians about +y) per frame of a prop. */
  propPlaces: Float32Array;
}

/** Length of the crowd's life in seconds. */
export function duration(crowd: Crowd): number {
  return crowd.lastFrame / crowd.fps;
}
