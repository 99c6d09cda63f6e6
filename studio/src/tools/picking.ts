/** Click a person to select it; click beside to let go; double-click to follow. */

import { Raycaster, Vector2 } from "three";
import { pickPerson } from "../crowd/capsules";
import type { Picture } from "../draw/picture";
import type { Store } from "../store";

/** A press that moves further than this many pixels is a drag. */
const DRAG = 5;

export function installPicking(canvas: HTMLCanvasElement, store: Store, picture: Picture): void {
  let pressed: { x: number; y: number } | null = null;
  canvas.addEventListener("pointerdown", (event) => {
    pressed = { x: event.clientX, y: event.clientY };
  });
  canvas.addEventListener("pointerup", (event) => {
    const moved = pressed ? Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) : DRAG;
    pressed = null;
    if (moved < DRAG && event.button === 0) store.set("person", personAt(event, canvas, store, picture));
  });
  canvas.addEventListener("dblclick", (event) => {
    const person = personAt(event, canvas, store, picture);
    if (person === null) return;
    store.set("person", person);
    store.set("follow", true);
  });
}

function personAt(event: MouseEvent, canvas: HTMLCanvasElement, store: Store, picture: Picture): number | null {
  const crowd = store.get("crowd");
  if (!crowd) return null;
  const box = canvas.getBoundingClientRect();
  const x = ((event.clientX - box.left) / box.width) * 2 - 1;
  const y = 1 - ((event.clientY - box.top) / box.height) * 2;
  const ray = new Raycaster();
  ray.setFromCamera(new Vector2(x, y), picture.cameras.camera);
  const { origin, direction } = ray.ray;
  return pickPerson(crowd, store.get("time"), origin.toArray(), direction.toArray(), picture.lift);
}
