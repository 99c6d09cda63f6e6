/** Fetches the crowd and, if there is one, its report. */

import type { Crowd } from "./crowd/model";
import { readCrowd } from "./crowd/reader";
import { parseReport, type Report } from "./report";

/** The crowd at `url`. Throws an Error whose message names the address and what is wrong. */
export async function loadCrowd(url: string): Promise<Crowd> {
  const response = await fetch(url).catch(() => null);
  if (!response) throw new Error(`${url}: the server does not answer. Is it still running?`);
  if (!response.ok)
    throw new Error(`${url}: expected a crowd file, the server says ${response.status} ${response.statusText}.`);
  const bytes = await response.arrayBuffer();
  try {
    return readCrowd(bytes);
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
