/** The selected person: what it does now and with whom, and its whole chain of patches. */

import { fragmentAt, kindOf, type Member, membersOf } from "../crowd/lookup";
import type { Character, Crowd, Fragment } from "../crowd/model";
import { bytes, categorical, looksOf } from "../draw/palette";
import { clockText, type Player } from "../play/player";
import type { Store } from "../store";
import { button, el, pairs } from "./dom";

export function installInspector(parent: HTMLElement, store: Store, player: Player): void {
  const panel = el("section", "inspector panel");
  panel.hidden = true;
  parent.append(panel);
  let members: Member[][] = [];
  let shown = { person: -1, fragment: -1, absent: false };
  let entries: HTMLElement[] = [];
  const needle = el("div", "needle");

  const show = () => {
    const crowd = store.get("crowd");
    const person = store.get("person");
    panel.hidden = !crowd || person === null;
    if (!crowd || person === null) return;
    const c = crowd.characters[person];
    const frame = store.get("time") * crowd.fps;
    const fragment = fragmentAt(c, frame);
    const absent = frame < c.begin || frame > c.begin + c.frames - 1;
    needle.style.left = `${(100 * frame) / Math.max(crowd.lastFrame, 1)}%`;
    if (shown.person === person && shown.fragment === fragment && shown.absent === absent) return;
    if (shown.person !== person) entries = chain(crowd, c, player);
    shown = { person, fragment, absent };
    for (const [i, entry] of entries.entries()) entry.classList.toggle("current", i === fragment && !absent);
    const scroll = panel.querySelector(".chain")?.scrollTop ?? 0;
    panel.replaceChildren(
      title(store, crowd, person),
      ...(absent || fragment < 0
        ? [el("p", "quiet", ["Not here at this time."])]
        : now(crowd, c.fragments[fragment], members, store, person)),
      bar(crowd, c, needle, player),
      el("ol", "chain", entries),
    );
    const list = panel.querySelector(".chain");
    if (list) list.scrollTop = scroll;
    entries[fragment]?.scrollIntoView({ block: "nearest" });
  };
  store.bus.on("crowd", (crowd) => {
    members = crowd ? membersOf(crowd) : [];
    shown = { person: -1, fragment: -1, absent: false };
    show();
  });
  store.bus.on("person", () => {
    shown.person = -1;
    show();
  });
  store.bus.on("time", show);
  store.bus.on("follow", () => {
    shown.person = -1;
    show();
  });
}

function title(store: Store, crowd: Crowd, person: number): HTMLElement {
  const { team } = crowd.characters[person];
  const looks = looksOf(person, team);
  const shirt = `rgb(${looks.slice(8, 11).join()})`;
  const following = store.get("follow");
  const follow = button(
    following ? "Following" : "Follow",
    "Follow with the camera (F)",
    () => store.set("follow", !store.get("follow")),
    "small",
  );
  follow.setAttribute("aria-pressed", String(following));
  const close = button(
    "×",
    "Let go (Esc)",
    () => {
      store.set("follow", false);
      store.set("person", null);
    },
    "round small",
  );
  return el("header", "", [
    el("span", "swatch", [], { style: `background:${shirt}` }),
    el("h2", "", [team === null ? `Person ${person}` : `Person ${person}, ${crowd.teams[team]}`]),
    follow,
    close,
  ]);
}

function now(crowd: Crowd, f: Fragment, members: Member[][], store: Store, person: number): HTMLElement[] {
  const kind = kindOf(crowd, f);
  const partners = [...new Set(members[f.instance].map((m) => m.person))].filter((p) => p !== person);
  const withWhom = partners.map((p) =>
    button(`Person ${p}`, `Select person ${p}`, () => store.set("person", p), "link"),
  );
  const rows: [string, (Node | string)[]][] = [
    ["Patch", [`${kind.name} · no. ${f.instance}`]],
    ["Role", [kind.people > 1 ? `${f.role + 1} of ${kind.people}` : "alone"]],
    ...(withWhom.length > 0 ? ([["With", withWhom]] as [string, Node[]][]) : []),
    ["From", [`${seconds(crowd, f.begin)} to ${seconds(crowd, f.end)}`]],
  ];
  if (kind.labels.length > 0) rows.push(["Labels", [kind.labels.join(", ")]]);
  return [pairs("facts", rows)];
}

/** The whole life as one bar; click to go there. */
function bar(crowd: Crowd, c: Character, needle: HTMLElement, player: Player): HTMLElement {
  const end = Math.max(crowd.lastFrame, 1);
  const parts = c.fragments.map((f) => {
    const begin = Math.max(f.begin, 0);
    const width = Math.max(Math.min(f.end, crowd.lastFrame) - begin, 0);
    const shared = kindOf(crowd, f).people > 1;
    const style = `left:${(100 * begin) / end}%;width:${(100 * width) / end}%;background:${tint(crowd, f)}`;
    return el("i", shared ? "shared" : "", [], { style });
  });
  const made = el("div", "bar", [...parts, needle]);
  made.addEventListener("click", (event) => {
    const box = made.getBoundingClientRect();
    player.seek((((event.clientX - box.left) / box.width) * crowd.lastFrame) / crowd.fps);
  });
  return made;
}

function chain(crowd: Crowd, c: Character, player: Player): HTMLElement[] {
  return c.fragments.map((f) => {
    const kind = kindOf(crowd, f);
    const people = kind.people > 1 ? el("span", "people", [`${kind.people} people`]) : null;
    const entry = el(
      "button",
      "",
      [
        el("span", "dot", [], { style: `background:${tint(crowd, f)}` }),
        el("span", "time", [seconds(crowd, f.begin)]),
        el("span", "name", [kind.name]),
        people,
      ],
      { type: "button" },
    );
    entry.addEventListener("click", () => player.seek((Math.max(f.begin, c.begin) + 0.01) / crowd.fps));
    return el("li", "", [entry]);
  });
}

function tint(crowd: Crowd, f: Fragment): string {
  return `rgb(${bytes(categorical(crowd.instances[f.instance])).join()})`;
}

function seconds(crowd: Crowd, frame: number): string {
  return clockText(Math.min(Math.max(frame, 0), crowd.lastFrame) / crowd.fps);
}
