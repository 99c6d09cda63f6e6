/** The keyboard. */

import type { Player } from "../play/player";
import type { Store, View } from "../store";

const VIEW_KEYS: Record<string, View> = { "1": "persp", "2": "top", "3": "front", "4": "loom" };

export const HELP: readonly (readonly [string, string])[] = [
  ["Space", "play, pause"],
  ["← →", "one frame; with Shift ten"],
  ["↑ ↓", "previous, next kind of a patch set"],
  ["Home End", "begin, end"],
  ["− +", "slower, faster"],
  ["1 2 3", "perspective, top, front"],
  ["L", "loom"],
  ["C", "next colours"],
  ["O", "next outlines"],
  ["T", "the tiles around a crowd that repeats"],
  ["F", "follow the selected person"],
  ["Esc", "let go"],
];

/** What comes next in a list that others know. */
export interface Next {
  color: () => void;
  outlines: () => void;
  kind: (step: 1 | -1) => void;
  tiles: () => void;
}

export function installKeys(store: Store, player: Player, next: Next): void {
  const actions: Record<string, (event: KeyboardEvent) => void> = {
    " ": () => player.toggle(),
    ArrowLeft: (e) => player.step(e.shiftKey ? -10 : -1),
    ArrowRight: (e) => player.step(e.shiftKey ? 10 : 1),
    ArrowUp: () => next.kind(-1),
    ArrowDown: () => next.kind(1),
    Home: () => player.seek(0),
    End: () => player.seek(Number.MAX_VALUE),
    "-": () => player.faster(-1),
    "+": () => player.faster(1),
    "=": () => player.faster(1),
    l: () => store.set("view", store.get("view") === "loom" ? "persp" : "loom"),
    c: next.color,
    o: next.outlines,
    t: next.tiles,
    f: () => store.set("follow", store.get("person") !== null && !store.get("follow")),
    Escape: () => {
      store.set("follow", false);
      store.set("person", null);
    },
  };
  window.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target instanceof HTMLInputElement && !["ArrowUp", "ArrowDown", "Escape"].includes(event.key)) return;
    if (event.target instanceof HTMLInputElement && event.key === "Escape") event.target.blur();
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const view = VIEW_KEYS[key];
    const action = actions[key];
    if (!view && !action) return;
    // Buttons keep the focus after a click; the space bar must not press them again.
    event.preventDefault();
    if (view) changeView(store, view);
    else action(event);
  });
}

/** Goes to a view; once more to the same view puts the camera back. */
export function changeView(store: Store, view: View): void {
  if (store.get("view") === view) store.bus.emit("aim", view);
  else store.set("view", view);
}
