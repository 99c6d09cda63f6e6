/** The report that the `tile` command leaves beside a crowd; all of it optional. */

export interface CheckRow {
  row: string;
  value: number;
  limit: number;
  unit: string;
  ok: boolean;
}

export interface Report {
  characters?: number;
  instances?: number;
  kinds?: number;
  multi_person_share?: number;
  danglings?: number;
  solve_secs?: number;
  seed?: number;
  check: CheckRow[];
}

const NUMBERS = ["characters", "instances", "kinds", "multi_person_share", "danglings", "solve_secs", "seed"] as const;

/** What of `value` is a report; null if it is none. Unknown fields are dropped. */
export function parseReport(value: unknown): Report | null {
  if (typeof value !== "object" || value === null) return null;
  const v = value as Record<string, unknown>;
  const report: Report = { check: Array.isArray(v.check) ? v.check.flatMap(parseRow) : [] };
  for (const key of NUMBERS) {
    const number = v[key];
    if (typeof number === "number") report[key] = number;
  }
  return report;
}

function parseRow(value: unknown): CheckRow[] {
  if (typeof value !== "object" || value === null) return [];
  const v = value as Record<string, unknown>;
  if (typeof v.row !== "string" || typeof v.ok !== "boolean") return [];
  const number = (n: unknown) => (typeof n === "number" ? n : Number.NaN);
  const unit = typeof v.unit === "string" ? v.unit : "";
  return [{ row: v.row, value: number(v.value), limit: number(v.limit), unit, ok: v.ok }];
}

/** A number with at most three significant decimals, for people. */
export function shortNumber(n: number): string {
  if (!Number.isFinite(n)) return "–";
  if (Number.isInteger(n)) return n.toLocaleString("en");
  const digits = Math.abs(n) >= 100 ? 0 : Math.abs(n) >= 10 ? 1 : Math.abs(n) >= 1 ? 2 : 4;
  return n.toFixed(digits).replace(/\.?0+$/, "") || "0";
}
