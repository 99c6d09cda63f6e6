"""Checkpoints as the command line knows them: where they are, what they hold, when they go."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import typer

from crowdquilt._core import Checkpoint, CrowdquiltError, Outcome, PatchSet, Scene, review
from crowdquilt.cli.app import ENDS, VERDICTS, console

SUFFIX = ".tiling"


@dataclass(frozen=True)
class Plan:
    """Where checkpoints of a run are written, and whether the last one stays when the crowd is perfect."""

    file: Path | None
    stays: bool

    def finish(self, outcome: Outcome) -> None:
        """Remove the checkpoint of a perfect crowd, or tell how to go on."""
        if self.file is None:
            return
        if outcome.unkept:
            console.print(f"[yellow]no checkpoint[/yellow]: {outcome.unkept}", soft_wrap=True)
        elif outcome.status == "perfect" and not self.stays:
            self.file.unlink(missing_ok=True)
        elif outcome.status == "perfect":
            console.print(f"{self.file}: written")
        else:
            console.print(f"{self.file}: go on with [bold]crowdquilt tile --resume {self.file}[/bold]", soft_wrap=True)


def plan(crowd: Path, wanted: Path | None, unwanted: bool) -> Plan:
    """Checkpoints go where they are wanted, else beside the crowd."""
    if unwanted and wanted:
        raise typer.BadParameter("expected no file: no checkpoints are written", param_hint="--checkpoint")
    file = None if unwanted else wanted or crowd.with_suffix(SUFFIX)
    if file:
        file.parent.mkdir(parents=True, exist_ok=True)
    return Plan(file, stays=wanted is not None)


def crowd_file(out: Path | None, resume: Path | None) -> Path:
    """The crowd to write: beside the checkpoint that a run goes on from, if none is given."""
    if out is not None:
        return out
    if resume is None:
        raise typer.BadParameter("expected a crowd to write", param_hint="--out")
    return resume.with_suffix(".crowd")


def set_file(patches: Path | None, kept: Checkpoint | None, resume: Path | None) -> Path:
    """The patch set: of a resumed run the one that the checkpoint names, where it was or beside the checkpoint."""
    if patches is not None:
        return patches
    if kept is None or resume is None:
        raise typer.BadParameter("expected a patch set", param_hint="PATCHES")
    if kept.patches is None:
        raise CrowdquiltError(f"{resume}: it does not name its patch set: expected it as an argument")
    named = Path(kept.patches)
    places = [named, resume.parent / named.name]
    found = next((place for place in places if place.exists() or str(place) == "samples"), None)
    if found is None:
        raise CrowdquiltError(f"{resume}: its patch set {named} is not there: expected another one as an argument")
    return found


def report(kept: Checkpoint, scene: Scene, patches: PatchSet) -> int:
    """Tell what a checkpoint holds; the exit code that it deserves."""
    status, reason, faults = review(kept, scene, patches)
    console.print(
        f"{VERDICTS[status]}: {kept.characters} people, {kept.instances} patches, "
        f"{kept.multi_person_share:.1%} of the time together, {faults} faults after {kept.solve_secs:.2f} s"
        f"{'; ' if reason else ''}{reason}",
        soft_wrap=True,
    )
    console.print(f"wished for: {scene.people} people, {scene.interaction:.1%} of the time together")
    return ENDS[status]
