/** The camera: orbit, the fixed views, and following a person. */

import { PerspectiveCamera, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { View } from "../store";

/** Where a view looks from, as a direction; top is a hair off the vertical so that "up" stays defined. */
const DIRECTIONS: Record<View, Vector3> = {
  persp: new Vector3(0.62, 0.62, 1).normalize(),
  top: new Vector3(0, 1, 0.0005).normalize(),
  front: new Vector3(0, 0.16, 1).normalize(),
  loom: new Vector3(0.72, 0.34, 1).normalize(),
};

const MOVE_SECS = 0.6;

export class Cameras {
  readonly camera = new PerspectiveCamera(32, 1, 0.05, 2000);
  readonly controls: OrbitControls;
  private move: { from: [Vector3, Vector3]; to: [Vector3, Vector3]; at: number } | null = null;

  constructor(element: HTMLElement, changed: () => void) {
    this.controls = new OrbitControls(this.camera, element);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.12;
    this.controls.maxPolarAngle = Math.PI / 2 - 0.01;
    this.controls.minDistance = 0.8;
    this.controls.addEventListener("change", changed);
    this.controls.addEventListener("start", () => {
      this.move = null;
    });
  }

  /** Aims at a ball around `center`, at once or in a short flight; `turned`: from the side one looks from now. */
  aim(view: View, center: Vector3, radius: number, fly: boolean, turned = false): void {
    const fov = (this.camera.fov * Math.PI) / 360;
    const tight = Math.min(Math.tan(fov), Math.tan(fov) * this.camera.aspect);
    const distance =
      (radius * (view === "top" ? 0.98 : view === "front" ? 0.66 : view === "persp" ? 0.82 : 0.92)) / tight;
    this.controls.maxDistance = Math.max(distance * 4, 30);
    const direction = turned ? this.camera.position.clone().sub(this.controls.target).normalize() : DIRECTIONS[view];
    const position = center.clone().addScaledVector(direction, distance);
    if (fly) {
      this.move = {
        from: [this.camera.position.clone(), this.controls.target.clone()],
        to: [position, center.clone()],
        at: 0,
      };
    } else {
      this.move = null;
      this.camera.position.copy(position);
      this.controls.target.copy(center);
      this.controls.update();
    }
  }

  /** Looks at `target` from its side, `distance` away. */
  close(target: Vector3, distance: number, fly: boolean): void {
    const direction = this.camera.position.clone().sub(this.controls.target).normalize();
    direction.y = Math.min(Math.max(direction.y, 0.22), 0.55);
    const position = target.clone().addScaledVector(direction.normalize(), distance);
    if (fly) {
      this.move = {
        from: [this.camera.position.clone(), this.controls.target.clone()],
        to: [position, target.clone()],
        at: 0,
      };
      return;
    }
    this.move = null;
    this.camera.position.copy(position);
    this.controls.target.copy(target);
    this.controls.update();
  }

  /** Moves camera and target together: the person who is followed stays where it is in the picture. */
  shift(by: Vector3): void {
    this.camera.position.add(by);
    this.controls.target.add(by);
    if (this.move) for (const v of this.move.to) v.add(by);
  }

  /** True while it moves by itself. */
  update(seconds: number): boolean {
    const { move } = this;
    if (move) {
      move.at = Math.min(move.at + seconds / MOVE_SECS, 1);
      const s = 1 - (1 - move.at) ** 3;
      this.camera.position.lerpVectors(move.from[0], move.to[0], s);
      this.controls.target.lerpVectors(move.from[1], move.to[1], s);
      if (move.at >= 1) this.move = null;
    }
    this.controls.update();
    return move !== null;
  }

  resize(aspect: number): void {
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
  }
}
