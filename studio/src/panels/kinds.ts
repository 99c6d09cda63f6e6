/** The kinds of a patch set, at the left: a list to choose from, with a filter. */

import { roleColor } from "../draw/palette";
import { listed } from "../set/list";
import { type PatchSet, seconds } from "../set/model";
import { MANY, type Store } from "../store";
import { button, choice, el } from "./dom";

export function installKinds(parent: HTMLElement, store: Store, set: PatchSet): void {
  const search = el("input", "search", [], { type: "search", placeholder: "Name, label, pose group, activity" });
  search.addEventListener("input", () => store.set("filter", { ...store.get("filter"), words: search.value }));
  const people = choice<string>(
    "People",
    [
      ["0", "All", "Any number of people"],
      ["1", "1", "One person"],
      ["2", "2", "Two people"],
      [String(MANY), `${MANY}+`, "Three people or more"],
    ],
    (value) => store.set("filter", { ...store.get("filter"), people: Number(value) }),
  );
  const mirrored = button("Mirrored", "List mirrored copies too", () => {
    const filter = store.get("filter");
    store.set("filter", { ...filter, mirrored: !filter.mirrored });
  });
  const found = el("p", "found quiet");
  const list = el("ol", "kinds");
  parent.append(
    el("section", "set panel", [
      el("h1", "", ["Crowdquilt"]),
      el("p", "tagline", ["kinds of motion patches"]),
      search,
      el("div", "row", [people.element, el("div", "choice", [mirrored])]),
      found,
      list,
    ]),
  );
  const entries = set.kinds.map((_, index) => entry(set, index, () => store.set("kind", index)));

  const show = () => {
    const filter = store.get("filter");
    const shown = listed(set, filter);
    list.replaceChildren(...shown.map((index) => entries[index]));
    found.textContent = `${shown.length} of ${set.kinds.length} kinds`;
    people.mark(String(filter.people));
    mirrored.setAttribute("aria-pressed", String(filter.mirrored));
  };
  const mark = (kind: number | null) => {
    for (const [index, e] of entries.entries()) e.classList.toggle("current", index === kind);
    if (kind !== null) entries[kind].scrollIntoView({ block: "nearest" });
  };
  store.bus.on("filter", show);
  store.bus.on("kind", mark);
  show();
}

function entry(set: PatchSet, index: number, press: () => void): HTMLElement {
  const kind = set.kinds[index];
  const dots = kind.roles.map((_, role) => el("i", "dot", [], { style: `background:${roleColor(role)}` }));
  const made = el(
    "button",
    "entry",
    [
      el("span", "name", [kind.name]),
      el("span", "time", [`${seconds(set, kind).toFixed(1)} s`]),
      el("span", "dots", dots),
      el("span", "labels", [kind.labels.join(", ")]),
    ],
    { type: "button", title: kind.name },
  );
  made.addEventListener("click", press);
  return el("li", "", [made]);
}
