/** Which kinds are listed, and which comes next. */

import { type Filter, MANY, type Store } from "../store";
import { measuresOf } from "./measure";
import type { PatchSet } from "./model";

/** Indices of the kinds that a filter lets through: people alone first, then by their number, as in the set. */
export function listed(set: PatchSet, { words, people, mirrored }: Filter): number[] {
  const wanted = words.toLowerCase().split(/\s+/).filter(Boolean);
  const fits = (index: number) => {
    const kind = set.kinds[index];
    const count = kind.roles.length;
    if (kind.mirrored && !mirrored) return false;
    if (people > 0 && (people === MANY ? count < MANY : count !== people)) return false;
    const groups = kind.roles.flatMap((r) => [set.groups[r.entry], set.groups[r.exit]]);
    const text = [kind.name, ...kind.labels, ...groups].join(" ").toLowerCase();
    const does = (word: string) => measuresOf(set, kind).words.includes(word);
    return wanted.every((word) => text.includes(word) || does(word));
  };
  const all = set.kinds.map((_, index) => index).filter(fits);
  return all.sort((a, b) => set.kinds[a].roles.length - set.kinds[b].roles.length || a - b);
}

/** Goes to the next listed kind, or the one before; round and round. */
export function stepKind(store: Store, step: 1 | -1): void {
  const set = store.get("set");
  if (!set) return;
  const list = listed(set, store.get("filter"));
  if (list.length === 0) return;
  const at = list.indexOf(store.get("kind") ?? -1);
  const next = at < 0 ? (step > 0 ? 0 : list.length - 1) : (at + step + list.length) % list.length;
  store.set("kind", list[next]);
}
