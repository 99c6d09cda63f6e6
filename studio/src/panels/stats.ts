/** What the crowd is, and how its check went, at the top left. */

import { multiPersonShare } from "../crowd/lookup";
import { type Crowd, duration } from "../crowd/model";
import { type CheckRow, type Report, shortNumber } from "../report";
import type { Store } from "../store";
import { el, headed, pairRows } from "./dom";

export function installStats(parent: HTMLElement, store: Store): void {
  const numbers = el("dl", "numbers");
  const checks = el("div", "checks");
  parent.append(headed("stats", "a crowd of motion patches", [numbers, checks]));
  const show = () => {
    const crowd = store.get("crowd");
    if (!crowd) return;
    numbers.replaceChildren(...numberRows(crowd, store.get("report")));
    checks.replaceChildren(...checkRows(store.get("report")));
  };
  store.bus.on("crowd", show);
  store.bus.on("report", show);
}

function numberRows(crowd: Crowd, report: Report | null): HTMLElement[] {
  const used = new Set(crowd.instances).size;
  const rows: [string, string][] = [
    ["People", shortNumber(crowd.characters.length)],
    ["Patches", shortNumber(crowd.instances.length)],
    ["Kinds used", `${used} of ${crowd.kinds.length}`],
    ["Time together", `${Math.round(multiPersonShare(crowd) * 100)} %`],
    ["Length", `${shortNumber(duration(crowd))} s`],
  ];
  if (report?.danglings !== undefined) rows.push(["Loose ends", shortNumber(report.danglings)]);
  if (report?.solve_secs !== undefined) rows.push(["Woven in", `${shortNumber(report.solve_secs)} s`]);
  rows.push(["Seed", crowd.seed]);
  return pairRows(rows);
}

function checkRows(report: Report | null): HTMLElement[] {
  if (!report || report.check.length === 0) return [];
  const failed = report.check.filter((row) => !row.ok).length;
  const head =
    failed === 0 ? `All ${report.check.length} checks hold` : `${failed} of ${report.check.length} checks fail`;
  const details = el("details", "", [
    el("summary", failed === 0 ? "good" : "bad", [head]),
    el("ul", "", report.check.map(checkRow)),
  ]);
  details.open = failed > 0;
  return [details];
}

function checkRow({ row, value, limit, unit, ok }: CheckRow): HTMLElement {
  const found = el("span", "value", [`${shortNumber(value)} ${unit}`.trim()]);
  const title = `found ${value} ${unit}, limit ${limit} ${unit}`;
  return el("li", ok ? "good" : "bad", [el("span", "name", [row.replaceAll("_", " ")]), found], { title });
}
