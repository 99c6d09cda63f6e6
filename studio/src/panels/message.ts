/** The one clear message when something is wrong, and the sign while loading. */

import type { Store } from "../store";
import { el } from "./dom";

export function installMessage(parent: HTMLElement, store: Store): void {
  const loading = el("div", "loading", [el("span", "", ["Loading"])]);
  parent.append(loading);
  store.bus.on("crowd", () => loading.remove());
  store.bus.on("problem", (problem) => {
    if (!problem) return;
    loading.remove();
    parent.append(
      el(
        "div",
        "problem",
        [el("div", "panel", [el("h2", "", ["This file cannot be shown"]), el("p", "", [problem])])],
        { role: "alert" },
      ),
    );
  });
}
