"""The rows of `crowdquilt bench tiling`: the paper's scenes, denser and larger ones, its Algorithms 1 and 2."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from crowdquilt import check
from crowdquilt._core import CrowdquiltError, Outcome, PatchSet, Scene, tile
from crowdquilt.bench_row import Row, row

PAPER = "Hyun et al. 2013, table 1 and section 7, 2.93 GHz Core i7"
Say = Callable[[str], None]


@dataclass(frozen=True)
class Static:
    """A scene of 12 x 12 m and 20 s; the paper's patches, characters and seconds where it has such a one."""

    row: str
    characters: int
    interaction: float
    patches: float | None = None
    people: float | None = None
    secs: float | None = None


STATIC = (
    Static("static-173", 18, 0.3, 173, 16, 0.3 * 60),
    Static("static-374", 38, 0.3, 374, 34, 2 * 60),
    Static("static-490", 50, 0.3, 490, 48, 12 * 60),
    Static("static-657", 68, 0.3, 657, 60, 17 * 60),
    Static("static-907", 94, 0.3, 907, 70, 103 * 60),
    Static("density-144", 144, 0.25),
    Static("density-200", 200, 0.08),
    Static("density-max", 200, 0.2),
    Static("density-288", 288, 0.08),
)
PAPER_KINDS = 43
SQUARES = ((8, 0.5), (16, 0.5), (32, 0.5), (120, 0.4862))
"""Sides of the squares over which growth is measured, metres, and people per square metre: the largest holds 7,000."""
THREADED = (40, 0.5)
BASELINE = ("static-173", "static-374", "static-490")
"""Rows at which Algorithms 1 and 2 are measured as well."""


@dataclass(frozen=True)
class Example:
    """A scene of `examples/scenes`; the paper's patches, characters and seconds where it tells them."""

    row: str
    patches: float | None = None
    people: float | None = None
    secs: float | None = None


EXAMPLES = (
    Example("dynamic", 528, 66, 97 * 60),
    Example("sources"),
    Example("hopping", None, 30, 7 * 60),
    Example("boxes", 526, 36, 6.5 * 60),
    Example("keyframing"),
    Example("fountain"),
)
SCENES = Path(__file__).resolve().parents[2] / "examples" / "scenes"
BOX_LABELS = {"carry", "sit"}


@dataclass(frozen=True)
class Run:
    """One crowd, checked."""

    outcome: Outcome
    summary: check.Summary
    ok: bool
    seams: dict[str, float]
    """The worst of the rows of a seam in metres; none if nothing repeats."""


def runs(scene: Scene, patches: PatchSet, seeds: int, method: str = "engine") -> list[Run]:
    """A crowd for each of the seeds from 1 on."""
    found = []
    for seed in range(1, seeds + 1):
        outcome = tile(scene, patches, seed=seed, method=method)
        report = check.check(outcome.crowd)
        ok = outcome.status == "perfect" and report.ok
        found.append(Run(outcome, check.summary(outcome.crowd), ok, seams_of(report)))
    return found


def seams_of(report: check.Report) -> dict[str, float]:
    """By seam the largest value in metres of its rows."""
    worst: dict[str, float] = {}
    for found in report.rows:
        seam = found.row.split(":")[0]
        if seam in ("seam in time", "border") and found.unit == "m":
            worst[seam] = max(worst.get(seam, 0.0), found.value)
    return worst


def static(scene: Static, patches: PatchSet, seeds: int, say: Say, published: bool = False) -> list[Row]:
    """The figures of a static scene: medians over the seeds, and the slowest. `published`: as many people as there."""
    people = int(scene.people) if published and scene.people else scene.characters
    wish = Scene.demo().replace(characters=people, interaction=scene.interaction)
    made = runs(wish, patches, seeds)
    figures = figures_of(scene, made, "")
    if scene.row in BASELINE:
        figures += figures_of(scene, runs(wish, patches, min(seeds, 2), "paper"), "Algorithms 1 and 2 here: ")
    say(spread(scene.row, made))
    return figures


def example(scene: Example, patches: PatchSet, seeds: int, say: Say) -> list[Row]:
    """The figures of an example scene; none where its file is not at hand or the set cannot play it."""
    file = SCENES / f"{scene.row}.toml"
    if not file.exists():
        say(f"tiling: {scene.row}: skipped, {file} is not there")
        return []
    try:
        made = runs(Scene.load(file), patches, seeds)
    except CrowdquiltError as problem:
        say(f"tiling: {scene.row}: skipped, {problem}")
        return []
    figures = figures_of(scene, made, "")
    if scene.row == "hopping":
        figures.append(figure(scene.row, "bumps, fewest", min(instances_with(r.outcome, {"bump"}) for r in made)))
    if scene.row == "boxes":
        figures.append(figure(scene.row, "boxes, fewest", min(r.summary.props for r in made)))
        kinds = (len(kinds_of(r.outcome, BOX_LABELS)) for r in made)
        figures.append(figure(scene.row, "kinds with boxes, fewest", min(kinds), "", 16))
    say(spread(scene.row, made))
    return figures


def instances_with(outcome: Outcome, labels: set[str]) -> int:
    """How many placed patches have one of some labels."""
    kinds = outcome.crowd.kinds
    return sum(bool(labels & set(kinds[kind].labels)) for kind in outcome.crowd.instances)


def kinds_of(outcome: Outcome, labels: set[str] | None = None) -> set[str]:
    """The kinds in use, or those that have one of some labels; mirror images count once."""
    used = (outcome.crowd.kinds[kind] for kind in set(outcome.crowd.instances.tolist()))
    return {kind.name.removesuffix("-mirror") for kind in used if labels is None or labels & set(kind.labels)}


def figures_of(scene: Static | Example, made: list[Run], prefix: str) -> list[Row]:
    """What is told of a scene's runs."""

    def figures(name: str, values: list[float], unit: str = "", reference: float | None = None) -> list[Row]:
        told = {"least": min(values), "median": median(values), "most": max(values)}
        return [figure(scene.row, f"{prefix}{name}, {which}", value, unit, reference) for which, value in told.items()]

    summaries = [r.summary for r in made]
    kinds = PAPER_KINDS if scene.row == "static-907" else None
    return [
        figure(scene.row, f"{prefix}perfect and checked, of {len(made)} seeds", sum(r.ok for r in made)),
        *figures("seconds", [r.outcome.solve_secs for r in made], "s", scene.secs),
        *figures("characters", [s.characters for s in summaries], "", scene.people),
        *figures("patches placed", [s.instances for s in summaries], "", scene.patches),
        *figures("kinds, mirror images not counted", [len(kinds_of(r.outcome)) for r in made], "", kinds),
        *figures("share of time in patches of two or more", [s.multi_person_share for s in summaries]),
        figure(scene.row, f"{prefix}danglings, all runs", sum(s.danglings for s in summaries), "", 0.0),
    ]


def figure(name: str, what: str, value: float, unit: str = "", reference: float | None = None) -> Row:
    """One measured figure of a row."""
    return row("tiling", f"{name}: {what}", float(value), unit, reference, "" if reference is None else PAPER)


def spread(name: str, made: list[Run]) -> str:
    """One line on the runs of a row: how many are perfect, and least, median and most of what they reached."""

    def three(values: list[float], form: str) -> str:
        return "/".join(format(value, form) for value in (min(values), median(values), max(values)))

    secs = three([r.outcome.solve_secs for r in made], ".2f")
    people = three([r.summary.characters for r in made], ".0f")
    share = three([100 * r.summary.multi_person_share for r in made], ".1f")
    good = sum(r.ok for r in made)
    return f"tiling: {name}: perfect {good}/{len(made)}, {secs} s, {people} people, {share} % together"


ALONE = """
import json, resource, sys
from pathlib import Path
from crowdquilt import check
from crowdquilt._core import PatchSet, Scene, tile
outcome = tile(Scene.from_toml(sys.argv[2]), PatchSet.load(sys.argv[1]), seed=1, time=120.0)
ok = outcome.status == "perfect" and check.check(outcome.crowd).ok
# What `getrusage` tells counts in the process that this one was made from.
status = Path("/proc/self/status")
lines = status.read_text().splitlines() if status.exists() else []
own = [int(line.split()[1]) for line in lines if line.startswith("VmHWM")]
peak = own[0] if own else resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
people = check.summary(outcome.crowd).characters
print(json.dumps({"secs": outcome.solve_secs, "people": people, "ok": ok, "peak": peak}))
"""


def alone(patches: PatchSet, scene: str, threads: int | None = None) -> dict[str, float]:
    """One run of a scene in a process of its own, with so many threads."""
    env = os.environ | ({"RAYON_NUM_THREADS": str(threads)} if threads else {})
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "set.patches"
        patches.save(file)
        command = [sys.executable, "-c", ALONE, str(file), scene]
        done = subprocess.run(command, env=env, capture_output=True, text=True, check=True)
    told: dict[str, float] = json.loads(done.stdout)
    return told


def square(side: int, density: float) -> str:
    """A square scene of 20 s, as a file."""
    corners = f"[[0, 0], [{side}, 0], [{side}, {side}], [0, {side}]]"
    return f"region = {corners}\nduration_secs = 20\ndensity = {density}\ninteraction = 0.26\n"


def growth(patches: PatchSet, say: Say) -> list[Row]:
    """Time per character as the square grows, about half a person per square metre; and what a second thread gains."""
    figures = []
    for side, density in SQUARES:
        run = alone(patches, square(side, density))
        name, people = f"{side} x {side} m", int(run["people"])
        figures += [
            figure("area-growth", f"{name}, {people} people", run["secs"], "s"),
            figure("area-growth", f"{name}, per character", 1000 * run["secs"] / people, "ms"),
            figure("area-growth", f"{name}, peak memory of the process", run["peak"] / 2**20, "GiB"),
            figure("area-growth", f"{name}, perfect and checked", float(run["ok"])),
        ]
        say(f"tiling: area-growth: {people} people in {run['secs']:.2f} s")
    one, two = (alone(patches, square(*THREADED), threads)["secs"] for threads in (1, 2))
    figures.append(figure("area-growth", f"{THREADED[0]} x {THREADED[0]} m, one thread / two", one / two))
    return figures


@dataclass(frozen=True)
class Repeating:
    """A tile of 10 x 10 m that repeats in some directions."""

    axes: tuple[str, ...]
    characters: int
    duration_secs: float


REPEATING = (
    Repeating(("x", "z"), 55, 27.0),
    Repeating(("t",), 48, 20.0),
    Repeating(("x", "z", "t"), 40, 20.0),
)
PAPER_REPEATING = Static("repeating", 55, 0.3, 813, 55, (83 + 43) * 60)


def repeating(patches: PatchSet, seeds: int, say: Say) -> list[Row]:
    """Tiles that repeat, checked as 3 x 3 tiles and three laps."""
    figures = []
    for tile_of in REPEATING:
        name = ", ".join(tile_of.axes)
        text = (
            f"region = [[0, 0], [10, 0], [10, 10], [0, 10]]\nduration_secs = {tile_of.duration_secs}\n"
            f"characters = {tile_of.characters}\ninteraction = 0.3\nperiodic = {list(tile_of.axes)}\n"
        )
        made = runs(Scene.from_toml(text), patches, seeds)
        published = tile_of.axes == ("x", "z")
        figures += figures_of(PAPER_REPEATING if published else Static("repeating", 0, 0.3), made, f"{name}: ")
        for seam in ("seam in time", "border"):
            worst = [run.seams[seam] for run in made if seam in run.seams]
            if worst:
                figures.append(figure("repeating", f"{name}: {seam}, worst gap or overlap", max(worst), "m"))
        say(spread(f"repeating {name}", made))
    return figures


PLANES = (3, 6, 10)
"""Sides of planes of tiles of 10 x 10 m, in tiles."""


def planes(patches: PatchSet, say: Say, characters: int = 40) -> list[Row]:
    """Wang tiles: what a plane costs as it grows; no tile is worked out twice, all others cost only their bodies."""
    figures = []
    for tiles in PLANES:
        side = 10 * tiles
        text = (
            f"region = [[0, 0], [{side}, 0], [{side}, {side}], [0, {side}]]\nduration_secs = 20\n"
            f"characters = {characters * tiles**2}\ninteraction = 0.3\n[wang]\ntile = 10\n"
        )
        outcome = tile(Scene.from_toml(text), patches, seed=1, time=3600.0)
        ok = outcome.status == "perfect" and check.check(outcome.crowd).ok
        name = f"{side} x {side} m"
        share = check.summary(outcome.crowd).multi_person_share
        figures += [
            figure("wang", f"{name}: characters", len(outcome.crowd)),
            figure("wang", f"{name}: seconds", outcome.solve_secs, "s"),
            figure("wang", f"{name}: per tile", outcome.solve_secs / tiles**2, "s"),
            figure("wang", f"{name}: share of time in patches of two or more", share),
            figure("wang", f"{name}: perfect and checked", float(ok)),
        ]
        verdict = "perfect and checked" if ok else outcome.reason
        say(f"tiling: wang {name}: {outcome.solve_secs:.1f} s, {100 * share:.1f} % together, {verdict}")
    return figures
