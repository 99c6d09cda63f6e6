/** `window.crowdquilt`: how tests and scripts look inside. */

import type { FrameStats, Picture } from "./draw/picture";
import type { Player } from "./play/player";
import type { State, Store } from "./store";
import type { WorldPage } from "./world/page";

export interface Handle {
  /** Resolves with the first picture of the crowd; rejects with the message shown on the page. */
  ready: Promise<void>;
  state(): Omit<State, "crowd" | "set">;
  seek(secs: number): Promise<void>;
  set<K extends keyof State>(key: K, value: State[K]): Promise<void>;
  frame(): FrameStats & { memory: { geometries: number; textures: number } };
  /** Joint positions (x, y, z, 1 + fragment index or 0 while absent) read back from the GPU, person by person. */
  joints(): number[];
  /** The pixel of a person's hips on the page; null while absent. */
  project(person: number): { x: number; y: number } | null;
  /** Shows or hides the bodies, to see what pixels are theirs. */
  bodies(shown: boolean): Promise<void>;
  /** Mean JavaScript milliseconds per picture over `pictures` pictures at changing times. */
  measure(pictures: number): number;
  /** Puts the camera at a place, looking at another (metres). */
  camera(position: readonly number[], target: readonly number[]): Promise<void>;
}

declare global {
  interface Window {
    crowdquilt: Handle;
    /** The page of a world, if one is shown. */
    crowdquiltWorld?: WorldPage;
  }
}

export function debugHandle(ready: Promise<void>, store: Store, player: Player, picture: Picture): Handle {
  const drawn = async () => {
    picture.invalidate();
    const before = picture.stats.pictures;
    while (picture.stats.pictures === before) await new Promise(requestAnimationFrame);
  };
  return {
    ready,
    state: () => store.snapshot(),
    seek: (secs) => {
      player.seek(secs);
      return drawn();
    },
    set: (key, value) => {
      store.set(key, value);
      return drawn();
    },
    frame: () => {
      const { geometries, textures } = picture.stage.renderer.info.memory;
      return { ...picture.stats, memory: { geometries, textures } };
    },
    joints: () => Array.from(picture.drawn?.textures.readPositions() ?? []),
    project: (person) => {
      const at = picture.placeOf(person)?.project(picture.cameras.camera);
      const box = picture.stage.renderer.domElement.getBoundingClientRect();
      return at ? { x: box.left + ((at.x + 1) / 2) * box.width, y: box.top + ((1 - at.y) / 2) * box.height } : null;
    },
    bodies: (shown) => {
      store.set("bodies", shown);
      return drawn();
    },
    measure: (pictures) => {
      const times = Array.from({ length: pictures }, (_, i) => {
        player.seek((picture.duration * (i + 0.5)) / pictures);
        picture.invalidate();
        picture.frame(0);
        return picture.stats.jsMs;
      });
      // The median: a collection of garbage in one picture says nothing about the others.
      return times.sort((a, b) => a - b)[pictures >> 1];
    },
    camera: (position, target) => {
      picture.cameras.camera.position.fromArray(position as number[]);
      picture.cameras.controls.target.fromArray(target as number[]);
      return drawn();
    },
  };
}
