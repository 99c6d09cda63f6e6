/** The kind that is shown: its people with their ports, and who touches whom when; and marks of that on the timeline. */

import { roleColor } from "../draw/palette";
import { clockText, type Player } from "../play/player";
import { measuresOf } from "../set/measure";
import type { Contact, PatchSet, SetKind } from "../set/model";
import type { Store } from "../store";
import { button, el } from "./dom";

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
      el("p", "quiet", [kind.labels.join(", ")]),
      el(
        "ol",
        "roles",
        kind.roles.map((_, role) => ports(set, kind, role)),
      ),
      facts(set, kind, secs),
      ...(kind.contacts.length > 0
        ? [
            el(
              "ol",
              "touches",
              kind.contacts.map((c) => touch(set, c, player)),
            ),
          ]
        : []),
    );
    marks.replaceChildren(...spans(kind));
  });
}

function ports(set: PatchSet, kind: SetKind, role: number): HTMLElement {
  const { entry, exit, begin, frames } = kind.roles[role];
  const name = (group: number) => set.groups[group].replaceAll("_", " ");
  const time = `${(begin / set.fps).toFixed(1)}–${((begin + frames - 1) / set.fps).toFixed(1)} s`;
  return el("li", "", [
    el("i", "dot", [], { style: `background:${roleColor(role)}` }),
    el("span", "name", [`${name(entry)} → ${name(exit)}`]),
    el("span", "time", [time]),
  ]);
}

function facts(set: PatchSet, kind: SetKind, secs: (frame: number) => string): HTMLElement {
  const { core, mirrored } = kind;
  const rows: [string, string][] = core ? [["Together", `${secs(core[0])}–${secs(core[1])} s`]] : [];
  if (mirrored) rows.push(["Mirrored", "a copy seen in a mirror"]);
  const { speed, fastest, radius, turnDeg, words } = measuresOf(set, kind);
  rows.push(
    ["Measured", words.join(", ")],
    ["Speed", `${speed.toFixed(1)} m/s, at most ${fastest.toFixed(1)}`],
    ["Turn", turned(turnDeg)],
    ["Radius", `${radius.toFixed(1)} m`],
  );
  return el(
    "dl",
    "facts",
    rows.flatMap(([name, value]) => [el("dt", "", [name]), el("dd", "", [value])]),
  );
}

function turned(degrees: number): string {
  const whole = Math.round(degrees);
  return whole === 0 ? "none" : `${Math.abs(whole)}° to the ${whole > 0 ? "left" : "right"}`;
}

function touch(set: PatchSet, { a, b, begin }: Contact, player: Player): HTMLElement {
  const dot = (role: number) => el("i", "dot", [], { style: `background:${roleColor(role)}` });
  const words = (part: string) => part.replace("_", " ");
  const made = button("", "Go there", () => player.seek(begin / set.fps), "touch");
  made.append(
    el("span", "time", [clockText(begin / set.fps)]),
    dot(a.role),
    el("span", "", [words(a.part)]),
    dot(b.role),
    el("span", "", [words(b.part)]),
  );
  return el("li", "", [made]);
}

/** What people do together as a band, contacts as bars. */
function spans({ core, contacts, lastFrame }: SetKind): HTMLElement[] {
  const span = (classes: string, begin: number, end: number) => {
    const share = 100 / Math.max(lastFrame, 1);
    return el("i", classes, [], { style: `left:${begin * share}%;width:${Math.max(end - begin, 1) * share}%` });
  };
  return [...(core ? [span("core", ...core)] : []), ...contacts.map((c) => span("contact", c.begin, c.end))];
}
