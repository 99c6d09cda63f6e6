/** Fetches what is to be shown, a crowd, a patch set or a world, and the report of a crowd if there is one. */

import type { Crowd } from "./crowd/model";
import { readCrowd } from "./crowd/reader";
import { parseReport, type Report } from "./report";
import type { PatchSet } from "./set/model";
import { readSet, MAGIC as SET } from "./set/reader";
import type { World } from "./world/model";
import { readWorld, MAGIC as WORLD } from "./world/reader";

export interface Shown {
  crowd?: Crowd;
  set?: PatchSet;
  world?: World;
}

/** The crowd, set or world at `url`, told by its first bytes. Throws an Error that names the address and what is wrong. */
export async function loadShown(url: string): Promise<Shown> {
  const response = await fetch(url).catch(() => null);
  if (!response) throw new Error(`${url}: the server does not answer. Is it still running?`);
  if (!response.ok)
    throw new Error(
      `${url}: expected a crowd, a patch set or a world, the server says ${response.status} ${response.statusText}.`,
    );
  const bytes = await response.arrayBuffer();
  try {
    const magic = new TextDecoder("latin1").decode(bytes.slice(0, SET.length));
    if (magic === WORLD) return { world: readWorld(bytes) };
    return magic === SET ? { set: readSet(bytes) } : { crowd: readCrowd(bytes) };
  } catch (error) {
    throw new Error(`${url}: ${(error as Error).message}.`);
  }
}

/** The report beside the crowd; null if there is none. */
export async function loadReport(url: string): Promise<Report | null> {
  const response = await fetch(url).catch(() => null);
  if (!response?.ok || !response.headers.get("content-type")?.includes("json")) return null;
  return parseReport(await response.json().catch(() => null));
}
