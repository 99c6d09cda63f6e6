"""What we reach beside the reference, row by row. Every area of the project adds its own function to `AREAS`."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from rich.table import Table

from crowdquilt import check, patch, samples
from crowdquilt._core import PatchSet, Scene, tile

PAPER = "Hyun et al. 2013, figure 7: Static, 907 patches, 2.93 GHz Core i7"
Say = Callable[[str], None]


@dataclass(frozen=True)
class Row:
    """One measured figure beside the published one; `ratio` is ours over the reference, None without one."""

    area: str
    row: str
    ours: float
    unit: str
    reference: float | None
    source: str
    ratio: float | None


def row(area: str, name: str, ours: float, unit: str = "", reference: float | None = None, source: str = "") -> Row:
    """A row with its ratio."""
    ratio = ours / reference if reference else None
    return Row(area, name, ours, unit, reference, source, ratio)


def tiling(seeds: int, say: Say) -> list[Row]:
    """The demo's scene (12 x 12 m, 20 s) beside the densest static scene of the paper; medians over the seeds."""
    with tempfile.TemporaryDirectory() as folder:
        samples.write(Path(folder), 1)
        patches = patch.cut(Path(folder))
    kinds = row("tiling", "kinds to choose from", len(patches), "", 43, PAPER)
    return [
        kinds,
        *tiling_rows(patches, "engine", "", seeds, say),
        *tiling_rows(patches, "paper", "Algorithms 1 and 2 here: ", seeds, say),
    ]


def tiling_rows(patches: PatchSet, method: str, prefix: str, seeds: int, say: Say) -> list[Row]:
    """The rows of one method; its crowds are checked like any other."""
    runs = []
    for seed in range(1, seeds + 1):
        outcome = tile(Scene.demo(), patches, seed=seed, method=method)
        perfect = outcome.status == "perfect" and check.check(outcome.crowd).ok
        runs.append((outcome, check.summary(outcome.crowd), perfect))
        say(f"tiling: {method}, seed {seed} of {seeds}: {outcome.status} in {outcome.solve_secs:.2f} s")

    def add(name: str, ours: float, unit: str = "", reference: float | None = None) -> Row:
        return row("tiling", prefix + name, float(ours), unit, reference, PAPER if reference is not None else "")

    def typical(name: str) -> float:
        return float(median(getattr(summary, name) for _, summary, _ in runs))

    return [
        add("solve time", median(run.solve_secs for run, _, _ in runs), "s", 103 * 60),
        add("slowest solve", max(run.solve_secs for run, _, _ in runs), "s", 103 * 60),
        add("characters", typical("characters"), "", 70),
        add("patches placed", typical("instances"), "", 907),
        add("share of time in patches of two or more", typical("multi_person_share")),
        add("danglings, all runs", sum(summary.danglings for _, summary, _ in runs), "", 0),
        add(f"perfect and checked, of {seeds}", sum(ok for _, _, ok in runs)),
    ]


AREAS: dict[str, Callable[[int, Say], list[Row]]] = {"tiling": tiling}


def table(rows: list[Row]) -> Table:
    """The rows as one reads them."""
    made = Table(box=None, header_style="dim", padding=(0, 2, 0, 0), caption_justify="left", caption_style="dim")
    for title in ("area", "row", "ours", "reference", "unit", "ratio"):
        made.add_column(title, justify="right" if title in ("ours", "reference", "ratio") else "left")
    for r in rows:
        reference = "" if r.reference is None else f"{r.reference:.6g}"
        ratio = "" if r.ratio is None else f"{r.ratio:.3g}"
        made.add_row(r.area, r.row, f"{r.ours:.4g}", reference, r.unit, ratio)
    made.caption = "\n".join(["reference:", *dict.fromkeys(r.source for r in rows if r.source)])
    return made
