/** A spectator who walks: arrow keys or WASD, drag to look around, wheel to rise. */

import { PerspectiveCamera, Vector3 } from "three";

const SPEED = 1.8;
const FAST = 8;

export class Walk {
  readonly camera = new PerspectiveCamera(58, 1, 0.08, 900);
  /** Radians; 0 looks along -z. */
  yaw = 0;
  pitch = -0.06;
  private readonly down = new Set<string>();

  constructor(element: HTMLElement, changed: () => void) {
    this.camera.position.set(0, 1.7, 0);
    element.addEventListener("pointerdown", (event) => element.setPointerCapture(event.pointerId));
    element.addEventListener("pointermove", (event) => {
      if (!element.hasPointerCapture(event.pointerId)) return;
      this.yaw += event.movementX * 0.0035;
      this.pitch = clamp(this.pitch + event.movementY * 0.0035, -1.5, 1.2);
      changed();
    });
    element.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.camera.position.y = clamp(this.camera.position.y * 1.0015 ** event.deltaY, 1.2, 160);
        changed();
      },
      { passive: false },
    );
    addEventListener("keydown", (event) => this.down.add(event.key.toLowerCase()));
    addEventListener("keyup", (event) => this.down.delete(event.key.toLowerCase()));
    addEventListener("blur", () => this.down.clear());
  }

  /** Moves on by what is pressed. */
  update(seconds: number): void {
    const pressed = (...names: string[]) => Number(names.some((name) => this.down.has(name)));
    const ahead = pressed("w", "arrowup") - pressed("s", "arrowdown");
    const aside = pressed("d") - pressed("a");
    this.yaw += (pressed("arrowleft") - pressed("arrowright")) * 1.4 * seconds;
    const speed = (this.down.has("shift") ? FAST : SPEED) * Math.max(1, this.camera.position.y / 4);
    const [sin, cos] = [Math.sin(this.yaw), Math.cos(this.yaw)];
    this.camera.position.x += (-sin * ahead + cos * aside) * speed * seconds;
    this.camera.position.z += (-cos * ahead - sin * aside) * speed * seconds;
    this.camera.rotation.set(this.pitch, this.yaw, 0, "YXZ");
    this.camera.updateMatrixWorld();
  }

  /** Looks from a place to another. */
  look(from: readonly number[], to: readonly number[]): void {
    this.camera.position.fromArray(from as number[]);
    const d = new Vector3()
      .fromArray(to as number[])
      .sub(this.camera.position)
      .normalize();
    this.yaw = Math.atan2(-d.x, -d.z);
    this.pitch = Math.asin(clamp(d.y, -1, 1));
  }
}

function clamp(value: number, low: number, high: number): number {
  return Math.min(Math.max(value, low), high);
}
