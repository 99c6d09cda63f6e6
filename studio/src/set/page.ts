/** The page of a patch set: its kinds in a list, the chosen one played. */

import { Marks } from "../draw/marks";
import type { Picture } from "../draw/picture";
import { installKind } from "../panels/kind";
import { installKinds } from "../panels/kinds";
import type { Player } from "../play/player";
import type { Store } from "../store";
import { crowdOf } from "./crowd";
import { listed } from "./list";
import type { PatchSet } from "./model";

/** Shows a set, beginning with the kind of this name or else the first. Throws an Error if it has none. */
export function openSet(
  set: PatchSet,
  name: string | null,
  page: { parent: HTMLElement; track: HTMLElement },
  store: Store,
  player: Player,
  picture: Picture,
): void {
  if (set.kinds.length === 0) throw new Error("this patch set has no kinds");
  document.body.classList.add("of-set");
  store.set("outlines", "none");
  store.set("set", set);
  installKinds(page.parent, store, set);
  installKind(page.parent, page.track, store, player, set);
  store.bus.on("kind", (index) => {
    if (index === null) return;
    store.set("follow", false);
    store.set("person", null);
    const crowd = crowdOf(set, set.kinds[index]);
    picture.show(crowd, new Marks(set, set.kinds[index], crowd));
    store.set("crowd", crowd);
    player.seek(0);
  });
  const named = set.kinds.findIndex((kind) => kind.name === name);
  if (named >= 0 && set.kinds[named].mirrored) store.set("filter", { ...store.get("filter"), mirrored: true });
  store.set("kind", named >= 0 ? named : (listed(set, store.get("filter"))[0] ?? 0));
}
