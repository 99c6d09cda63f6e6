/** The kind that is shown: its people with their ports, and who touches whom when; and marks of that on the timeline. */

import { roleColor } from "../draw/palette";
import { clockText, type Player } from "../play/player";
import { measuresOf } from "../set/measure";
import { labelsOf, type PatchSet, type SetKind, words } from "../set/model";
import type { Store } from "../store";
import { button, el, pairs } from "./dom";

export function installKind(
  parent: HTMLElement,
  track: HTMLElement,
  store: Store,
  player: Player,
  set: PatchSet,
): void {
  const panel = el("section", "kind panel");
  const marks = el("div", "marks");
  parent.append(panel);
  track.append(marks);
  store.bus.on("kind", (index) => {
    if (index === null) return;
    const kind = set.kinds[index];
    const secs = (frame: number) => (frame / set.fps).toFixed(1);
    panel.replaceChildren(
      el("h2", "", [kind.name]),
      el("p", "quiet", [labelsOf(kind)]),
      el(
        "ol",
        "roles",
        kind.roles.map((_, role) => ports(set, kind, role)),
      ),
      facts(set, kind, secs),
      deeds(set, kind, player),
    );
    marks.replaceChildren(...spans(kind));
  });
}

function ports(set: PatchSet, kind: SetKind, role: number): HTMLElement {
  const { entry, exit, begin, frames } = kind.roles[role];
  const name = (group: number) => words(set.groups[group]);
  const time = `${(begin / set.fps).toFixed(1)}–${((begin + frames - 1) / set.fps).toFixed(1)} s`;
  return el("li", "", [dot(role), el("span", "name", [`${name(entry)} → ${name(exit)}`]), el("span", "time", [time])]);
}

function facts(set: PatchSet, kind: SetKind, secs: (frame: number) => string): HTMLElement {
  const { core, mirrored } = kind;
  const rows: [string, string][] = core ? [["Together", `${[...new Set(core.map(secs))].join("–")} s`]] : [];
  if (mirrored) rows.push(["Mirrored", "a copy seen in a mirror"]);
  const { speed, fastest, radius, turnDeg, words } = measuresOf(set, kind);
  rows.push(
    ["Measured", words.join(", ")],
    ["Speed", `${speed.toFixed(1)} m/s, at most ${fastest.toFixed(1)}`],
    ["Turn", turned(turnDeg)],
    ["Radius", `${radius.toFixed(1)} m`],
  );
  return pairs("facts", rows);
}

function turned(degrees: number): string {
  const whole = Math.round(degrees);
  return whole === 0 ? "none" : `${Math.abs(whole)}° to the ${whole > 0 ? "left" : "right"}`;
}

/** Who touches whom, holds what and sits where, in the order of time; to go there. Nothing if nobody does. */
function deeds(set: PatchSet, { contacts, props }: SetKind, player: Player): HTMLElement | string {
  const found: Deed[] = [
    ...contacts.map(({ a, b, begin }): Deed => [begin, [dot(a.role), words(a.part), dot(b.role), words(b.part)]]),
    ...props.flatMap(({ name, holds, sat }) => [
      ...holds.map(({ role, begin }): Deed => [begin, [dot(role), `holds ${words(name)}`]]),
      ...sat.map(({ role, begin }): Deed => [begin, [dot(role), `sits on ${words(name)}`]]),
    ]),
  ];
  if (found.length === 0) return "";
  found.sort(([a], [b]) => a - b);
  return el(
    "ol",
    "touches",
    found.map(([begin, said]) => deed(begin / set.fps, said, player)),
  );
}

type Deed = [begin: number, said: (Node | string)[]];

function deed(secs: number, said: Deed[1], player: Player): HTMLElement {
  const made = button("", "Go there", () => player.seek(secs), "touch");
  made.append(
    el("span", "time", [clockText(secs)]),
    ...said.map((w) => (typeof w === "string" ? el("span", "", [w]) : w)),
  );
  return el("li", "", [made]);
}

function dot(role: number): HTMLElement {
  return el("i", "dot", [], { style: `background:${roleColor(role)}` });
}

/** What people do together as a band, contacts as bars. */
function spans({ core, contacts, lastFrame }: SetKind): HTMLElement[] {
  const span = (classes: string, begin: number, end: number) => {
    const share = 100 / Math.max(lastFrame, 1);
    return el("i", classes, [], { style: `left:${begin * share}%;width:${Math.max(end - begin, 1) * share}%` });
  };
  return [...(core ? [span("core", ...core)] : []), ...contacts.map((c) => span("contact", c.begin, c.end))];
}
