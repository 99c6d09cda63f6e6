/** Views, colours and outlines, at the top right. */

import { repeatsInSpace } from "../crowd/tiles";
import { type ColorMode, type Outlines, type Store, VIEWS, type View } from "../store";
import { changeView, HELP } from "../tools/keys";
import { button, choice, el, pairs } from "./dom";

const VIEW_TEXT: Record<View, [string, string]> = {
  persp: ["Perspective", "Perspective (1)"],
  top: ["Top", "From above (2)"],
  front: ["Front", "From the front (3)"],
  loom: ["Loom", "Space and time (L)"],
};

export function installToolbar(parent: HTMLElement, store: Store): void {
  const views = choice<View>(
    "View",
    VIEWS.map((v) => [v, ...VIEW_TEXT[v]] as const),
    (v) => changeView(store, v),
  );
  const colors = choice<ColorMode>(
    "Colours",
    [
      ["character", "People", "Clothes of every person (C)"],
      ["kind", "Kinds", "By patch kind (C)"],
      ["shared", "Together", "Who is in a patch of several people (C)"],
    ],
    (color) => store.set("color", color),
  );
  const outlines = choice<Outlines>(
    "Patch outlines",
    [
      ["none", "None", "No patch outlines (O)"],
      ["shared", "Shared", "Outlines of patches of several people (O)"],
      ["all", "All", "Outlines of all patches (O)"],
    ],
    (value) => store.set("outlines", value),
  );
  const tiles = choice<"one" | "all">(
    "Tiles",
    [
      ["one", "One", "The region alone (T)"],
      ["all", "3 x 3", "The tiles around it as well (T)"],
    ],
    (value) => store.set("tiles", value === "all"),
  );
  const help = pairs("help panel", HELP);
  help.hidden = true;
  const helpButton = button(
    "?",
    "Keys",
    () => {
      help.hidden = !help.hidden;
    },
    "round",
  );
  const field = (label: string, control: HTMLElement, classes = "") =>
    el("div", `field ${classes}`, [el("span", "label", [label]), control]);
  const tilesField = field("Tiles", tiles.element, "of-crowd");
  tilesField.hidden = true;
  parent.append(
    el("div", "toolbar", [
      field("View", views.element),
      field("Colour", colors.element, "of-crowd"),
      field("Outlines", outlines.element, "of-crowd"),
      tilesField,
      helpButton,
    ]),
    help,
  );
  store.bus.on("view", views.mark);
  store.bus.on("color", colors.mark);
  store.bus.on("outlines", outlines.mark);
  store.bus.on("tiles", (all) => tiles.mark(all ? "all" : "one"));
  store.bus.on("crowd", (crowd) => {
    tilesField.hidden = !repeatsInSpace(crowd);
  });
  tiles.mark(store.get("tiles") ? "all" : "one");
  views.mark(store.get("view"));
  colors.mark(store.get("color"));
  outlines.mark(store.get("outlines"));
}
