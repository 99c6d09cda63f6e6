"""`world`: from a scene of templates and a map to a populated world."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, SpinnerColumn, TextColumn
from rich.progress import Progress as Bar

from crowdquilt import world as worlds
from crowdquilt._core import CrowdquiltError, PatchSet, World, WorldScene
from crowdquilt.cli.app import CHECK_FAILED, app, console, example, expect_picture
from crowdquilt.cli.tables import check_table, facts
from crowdquilt.report import row_dict


@app.command(
    "world",
    epilog=example(
        "world examples/worlds/street.toml -o out/street.world",
        "world examples/worlds/city.toml -o out/city.world --plot out/city.png --patch out/patch.png",
        "world examples/worlds/city.toml -o out/city.world --shards out/city.shards --dask local",
    ),
)
def make_world(
    scene: Annotated[Path, typer.Argument(help="Scene of a world (.toml): templates, and where which is.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="World to write (.world).")],
    seed: Annotated[int | None, typer.Option(min=0, help="Same seed, same world; the scene's if not given.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw it from above: flows and densities.")] = None,
    patch: Annotated[Path | None, typer.Option(help="Draw its busiest patch, its patterns unrolled over time.")] = None,
    patches: Annotated[
        Path | None, typer.Option(help="Walk and act as its people (.patches); generated ones if not given.")
    ] = None,
    bodies: Annotated[bool, typer.Option(help="Give everybody a full body; without, the file is smaller.")] = True,
    shards: Annotated[
        Path | None,
        typer.Option(help="Keep solved cells in this folder: a build that was killed goes on where it was."),
    ] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes that solve (with --shards).")] = None,
    dask: Annotated[
        str | None, typer.Option(help="Address of a Dask scheduler whose workers solve, or local (with --shards).")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print what was made as JSON.")] = False,
) -> None:
    """Build a populated world from crowd patches: people walk in it for ever, and never touch anybody or anything."""
    expect_picture(plot, patch)
    begin = time.perf_counter()
    try:
        wanted = WorldScene.load(scene).replace(seed=seed)
        walks = (PatchSet.load(patches) if patches else worlds.sample_walks()) if bodies else None
        wanted, missing = wanted.with_acts(walks) if walks else (wanted, [])
        made, notes = build(wanted, shards, crew(shards, workers, dask))
        notes = missing + notes
    except CrowdquiltError as error:
        # The core speaks of "map" and "patch"; the user knows them by their file.
        message = str(error)
        raise CrowdquiltError(message if message.startswith(str(scene)) else f"{scene}: {message}") from None
    secs = time.perf_counter() - begin
    if walks:
        made = made.with_bodies(walks)
    worlds.save(made, out)
    draw(made, plot, patch)
    found = worlds.facts(made) | {"seconds": round(secs, 3), "notes": notes}
    if as_json:
        print(json.dumps(found, indent=2))
        return
    console.print(facts({name: value for name, value in found.items() if name != "notes"}))
    for note in notes:
        console.print(f"[yellow]note[/yellow]: {escape(note)}", soft_wrap=True)
    written = [str(file) for file in (out, plot, patch) if file]
    console.print(f"{', '.join(written)}: written", soft_wrap=True)


def crew(shards: Path | None, workers: int | None, dask: str | None) -> worlds.Crew:
    """Who solves the cells."""
    if shards is None and (workers or dask):
        raise typer.BadParameter("--workers and --dask need a folder for what they send", param_hint="--shards")
    if dask:
        return worlds.dask(dask, workers)
    return worlds.processes(workers) if workers else worlds.threads


def build(scene: WorldScene, shards: Path | None, crew: worlds.Crew) -> tuple[World, list[str]]:
    """Build with a progress bar; Ctrl-C stops it."""
    columns = (SpinnerColumn(), TextColumn("solving patches"), BarColumn(bar_width=24), MofNCompleteColumn())
    with Bar(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("solving patches", total=None)

        def progress(step: tuple[int, int]) -> None:
            bar.update(task, completed=step[0], total=step[1])

        if shards is None:
            return worlds.build(scene, progress=progress)
        return worlds.build_sharded(scene, shards, crew=crew, progress=progress)


def draw(made: World, plan: Path | None, patch: Path | None) -> None:
    """The pictures that were asked for."""
    if not plan and not patch:
        return
    from crowdquilt.plot import world as pictures  # matplotlib is slow to import

    if plan:
        pictures.plan(made, plan)
    if patch:
        pictures.patch(made, path=patch)


def check_world(file: Path, as_json: bool) -> None:
    """Verify a world from its file alone, and end with the exit code it deserves."""
    found = World.load(file)
    result = worlds.check(found)
    if as_json:
        held = {"ok": result.ok, "check": [row_dict(row) for row in result.rows]}
        print(json.dumps(worlds.facts(found) | held, indent=2))
    else:
        console.print(check_table(result))
        failed = len(result.failures)
        verdict = f"[red]{failed} of {len(result.rows)} rows fail[/red]" if failed else "[green]every row holds[/green]"
        console.print(verdict)
    if not result.ok:
        raise typer.Exit(CHECK_FAILED)
