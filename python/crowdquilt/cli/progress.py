"""A solve as it is seen on the terminal, and how Ctrl-C and SIGTERM end it."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

from rich.progress import BarColumn, SpinnerColumn, TextColumn
from rich.progress import Progress as Bar

from crowdquilt import patch
from crowdquilt._core import Made, Outcome, PatchSet, Scene, tile
from crowdquilt._core import Progress as Report
from crowdquilt.cli.app import console

PHASES = {
    "seed": "adding people",
    "enrich": "bringing them together",
    "close": "closing ends",
    "mend": "mending bodies",
}


@contextmanager
def interruptible() -> Iterator[list[bool]]:
    """Yield a list that Ctrl-C and SIGTERM put a True into; a second one ends the program at once."""
    asked: list[bool] = []
    signals = (signal.SIGINT, signal.SIGTERM)

    def stop(_signal: int, _frame: FrameType | None) -> None:
        asked.append(True)
        for each in signals:
            signal.signal(each, signal.SIG_DFL)

    before = {each: signal.signal(each, stop) for each in signals}
    try:
        yield asked
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)


def solve(
    scene: Scene,
    patches: PatchSet,
    *,
    seed: int,
    method: str = "engine",
    time: float = 60.0,
    threads: int | None = None,
    **kept: Any,
) -> Outcome:
    """Tile with a progress bar; Ctrl-C keeps the best tiling so far. `kept` is what `tile` is told of checkpoints."""
    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}", justify="left"),
        BarColumn(bar_width=24),
        TextColumn(
            "{task.fields[patches]} patches  {task.fields[characters]} people  {task.fields[danglings]} danglings  "
            "{task.fields[share]:.0%} together  energy {task.fields[energy]:.1f}  {task.fields[secs]:.1f} s"
        ),
    )
    with (
        interruptible() as asked,
        Bar(*columns, console=console, transient=True, disable=not console.is_terminal) as bar,
    ):
        task = bar.add_task(
            "starting",
            total=scene.characters,
            patches=0,
            characters=0,
            danglings=0,
            share=0.0,
            energy=0.0,
            secs=0.0,
        )

        def show(p: Report) -> bool:
            bar.update(
                task,
                description="stopping" if asked else PHASES[p.phase],
                completed=p.characters,
                patches=p.patches,
                characters=p.characters,
                danglings=p.danglings,
                share=p.multi_person_share,
                energy=p.energy,
                secs=p.secs,
            )
            return not asked

        return tile(scene, patches, seed=seed, method=method, time=time, threads=threads, progress=show, **kept)


def make_set(sources: list[Path], captures: Path | None, **options: Any) -> Made:
    """Make a patch set with a progress bar; Ctrl-C stops it."""
    columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(bar_width=24))
    with Bar(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("starting", total=1.0)

        def show(step: tuple[str, float]) -> None:
            bar.update(task, description=step[0], completed=step[1])

        return patch.make(sources, captures, progress=show, **options)
