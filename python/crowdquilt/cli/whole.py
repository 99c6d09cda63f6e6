"""`demo` and `bench`: the whole pipeline, shown and measured."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from crowdquilt import bench as benches
from crowdquilt import demo as demos
from crowdquilt._core import CrowdquiltError, Outcome, PatchSet, Scene
from crowdquilt.cli.app import CHECK_FAILED, ENDS, app, console, example
from crowdquilt.cli.progress import solve


@app.command(epilog=example("demo -o out/demo"))
def demo(
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder to write to.")],
    scene: Annotated[Path | None, typer.Option(help="Scene (.toml); 12 x 12 m for 20 s if not given.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Same seed, same crowd.")] = 1,
    time: Annotated[float, typer.Option(help="Longest time for search and bodies, in seconds.")] = 60.0,
    threads: Annotated[int | None, typer.Option(min=1, help="Threads; all cores if not given.")] = None,
    show: Annotated[bool, typer.Option("--show", help="Only tell what the folder holds already.")] = False,
) -> None:
    """Generate captures, cut patches, tile a scene, check it, export it and draw it."""
    if show:
        tell(out)
        return

    def tile(where: Scene, patches: PatchSet) -> Outcome:
        return solve(where, patches, seed=seed, time=time, threads=threads)

    def say(step: str, made: str) -> None:
        console.print(f"[dim]{step:>9}[/dim]  {made}", soft_wrap=True)

    where = Scene.load(scene) if scene else Scene.demo()
    demos.make(out, where, tile, say, seed)
    tell(out)


def tell(out: Path) -> None:
    """The last lines of a demo, and the exit code its result deserves."""
    data, lines = demos.summary(out)
    console.print()
    for line in lines:
        console.print(line, soft_wrap=True, markup=False)
    view = "make view" if out == Path("out/demo") else f"crowdquilt view {out / 'crowd.crowd'}"
    console.print(f"Watch it: [bold]{view}[/bold]   Look at it: {out / 'plan.png'}, {out / 'loom.png'}", soft_wrap=True)
    if code := ENDS[data["status"]] or (0 if data["ok"] else CHECK_FAILED):
        raise typer.Exit(code)


@app.command(epilog=example("bench", "bench tiling --json"))
def bench(
    area: Annotated[str | None, typer.Argument(help=f"One of: {', '.join(benches.AREAS)}. All if not given.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the rows as JSON.")] = False,
    seeds: Annotated[int, typer.Option(min=1, help="Runs per row: perfect k of so many, least, median, most.")] = 5,
    patches: Annotated[Path | None, typer.Option(help="Tile with this patch set instead of the samples' one.")] = None,
) -> None:
    """Measure what we reach beside the reference."""
    if area is not None and area not in benches.AREAS:
        raise CrowdquiltError(f"bench: expected one of {', '.join(benches.AREAS)}, found {area!r}")
    if patches is not None and area != "tiling":
        raise CrowdquiltError("bench: --patches goes with `bench tiling`")

    def say(line: str) -> None:
        print(line, file=sys.stderr)

    rows = []
    for name in [area] if area else list(benches.AREAS):
        own = [PatchSet.load(patches)] if patches is not None else []
        rows += benches.AREAS[name](seeds, say, *own)
    if as_json:
        print(json.dumps([asdict(row) for row in rows], indent=2))
    else:
        console.print(benches.table(rows))
