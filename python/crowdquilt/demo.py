"""The main job from end to end: captures in, a perfect crowd out, and everything one wants to see of it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

from crowdquilt import check, export, patch, report, samples
from crowdquilt._core import Crowd, Outcome, PatchSet, Scene
from crowdquilt.outputs import whole_folder

Solve = Callable[[Scene, PatchSet], Outcome]
Say = Callable[[str, str], None]


def make(out: Path, scene: Scene, solve: Solve, say: Say, seed: int = 1) -> None:
    """Fill `out` with captures, patches, the crowd, its exports, pictures and report; all of it or nothing.

    `say(step, result)` is told what each step made.
    """
    from crowdquilt import plot  # slow to import, and only needed here

    with whole_folder(out) as part:
        step = Steps(say)
        files = samples.write(part / "captures", seed)
        step.done("captures", f"{sum(str(f).endswith('.bvh') for f in files)} BVH files with their ground truth")
        patches = patch.cut(part / "captures")
        patches.save(part / "demo.patches")
        together = sum(kind.people > 1 for kind in patches.kinds)
        step.done("patches", f"{len(patches)} kinds, {together} of two or more people")
        outcome = solve(scene, patches)
        outcome.crowd.save(part / "crowd.crowd")
        # All that follows is about the file, whose numbers are rounded.
        crowd = Crowd.load(part / "crowd.crowd")
        step.done("crowd", f"{len(crowd)} people through {len(crowd.instances)} patches")
        result = check.check(crowd)
        report.save(report.build(crowd, result, outcome), part / "report.json")
        step.done("check", f"{sum(row.ok for row in result.rows)} of {len(result.rows)} rows hold")
        export.save_glb(crowd, part / "crowd.glb")
        export.save_bvh(crowd, part / "bvh")
        step.done("exports", f"crowd.glb, {len(crowd)} BVH files")
        plot.plan(crowd, part / "plan.png")
        plot.loom(crowd, part / "loom.png")
        step.done("pictures", "plan.png from above, loom.png in space and time")


class Steps:
    """Tells what each step made and how long it took."""

    def __init__(self, say: Say) -> None:
        """Start the clock."""
        self.say = say
        self.since = perf_counter()

    def done(self, step: str, made: str) -> None:
        """A step is done."""
        now = perf_counter()
        self.say(step, f"{made} ({now - self.since:.1f} s)")
        self.since = now


def summary(out: Path) -> tuple[dict[str, Any], list[str]]:
    """The report of an earlier run and the lines that say what it made, how good it is, and how to watch it."""
    data = json.loads((out / "report.json").read_text(encoding="utf-8"))
    held = sum(row["ok"] for row in data["check"])
    ends = "no loose end" if data["danglings"] == 0 else f"{data['danglings']} loose ends"
    count = data["props"]
    boxes = f", {count} {'box' if count == 1 else 'boxes'}" if count else ""
    lines = [
        f"{out} holds {data['characters']} people{boxes} for {data['seconds']:.0f} s: {data['instances']} patches of "
        f"{data['kinds']} kinds, {data['multi_person_share']:.0%} of the time together, {ends}.",
        f"Solved in {data['solve_secs']:.1f} s (seed {data['seed']}); "
        f"{held} of {len(data['check'])} rows of the check hold.",
    ]
    if data["status"] != "perfect":
        lines.append(f"The tiling is {data['status']}: {data['reason']}.")
    lines += [
        f"  fails: {row['row']}: {row['value']:.4g} {row['unit']}, limit {row['limit']:.4g}, at {row['place']}"
        for row in data["check"]
        if not row["ok"]
    ]
    return data, lines
