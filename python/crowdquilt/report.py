"""`report.json`: what a crowd holds and how good it is."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from crowdquilt import check
from crowdquilt._core import Crowd, Outcome, Report
from crowdquilt.outputs import whole_file


def build(crowd: Crowd, report: Report, outcome: Outcome | None = None) -> dict[str, Any]:
    """Everything `report.json` says about `crowd`; without the `outcome` of its solve, its time and end are None."""
    summary = check.summary(crowd)
    return {
        "characters": summary.characters,
        "instances": summary.instances,
        "kinds": summary.kinds,
        "multi_person_share": round(summary.multi_person_share, 4),
        "props": summary.props,
        "danglings": summary.danglings,
        "solve_secs": round(outcome.solve_secs, 3) if outcome else None,
        "status": outcome.status if outcome else None,
        "reason": outcome.reason if outcome else None,
        "seed": crowd.seed,
        "seconds": round(crowd.seconds, 4),
        "ok": report.ok,
        "check": [row_dict(row) for row in report.rows],
    }


def row_dict(row: check.Row) -> dict[str, Any]:
    """One row of the check as plain data."""
    return {
        "row": row.row,
        "value": row.value,
        "limit": row.limit,
        "unit": row.unit,
        "ok": row.ok,
        "place": row.place,
    }


def save(data: dict[str, Any], path: Path) -> None:
    """Write the report, whole or not at all."""
    with whole_file(path) as part:
        part.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")
