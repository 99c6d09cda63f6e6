"""`samples`, `inspect`, `patches`: from captures to a patch set."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from crowdquilt import inspection, patch, samples
from crowdquilt.cli.app import app, console, example
from crowdquilt.cli.tables import facts, kind_table
from crowdquilt.outputs import whole_folder


@app.command("samples", epilog=example("samples -o out/samples"))
def write_samples(
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder to write to.")],
    seed: Annotated[int, typer.Option(min=0, help="Same seed, same files.")] = 1,
) -> None:
    """Write generated captures: people who walk, turn, sit, meet and touch.

    A BVH file for every person and a `.take.json` for every take, which says who touches whom, when feet are
    planted, and which patches to cut.
    """
    with whole_folder(out) as part:
        written = samples.write(part, seed)
    takes = sum(str(file).endswith(".take.json") for file in written)
    console.print(f"{out}: {takes} takes, {len(written) - takes} captures")


@app.command(
    "inspect",
    epilog=example("inspect walk.bvh --metres-per-unit 0.01", "inspect out/demo/crowd.crowd --json"),
)
def inspect_file(
    file: Annotated[Path, typer.Argument(help="A capture (.bvh), patch set (.patches) or crowd (.crowd).")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    metres_per_unit: Annotated[float | None, typer.Option(help="Unit of a capture; guessed if not given.")] = None,
    fps: Annotated[float | None, typer.Option(help="True frames per second, where the header is wrong.")] = None,
    drop_first: Annotated[int, typer.Option(min=0, help="Leading frames (T-poses) to drop.")] = 0,
    restore_thorax: Annotated[bool, typer.Option(help="Put back the bone that cgspeed's CMU files lost.")] = False,
) -> None:
    """Tell what a file holds and what looks wrong with it."""
    repairs = inspection.Repairs(metres_per_unit, fps, drop_first, restore_thorax)
    found = inspection.inspect(file, repairs)
    if as_json:
        print(json.dumps(found, indent=2))
        return
    warnings = found.pop("warnings", [])
    console.print(facts(found))
    for warning in warnings:
        console.print(f"[yellow]warning[/yellow] {warning}", soft_wrap=True)


@app.command(
    epilog=example("patches out/samples -o samples.patches", "patches takes --captures cmu/bvh -o cmu.patches")
)
def patches(
    folder: Annotated[Path, typer.Argument(help="Folder with take files (*.take.json).")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Patch set to write (.patches).")],
    captures: Annotated[Path | None, typer.Option(help="Folder of the captures, if not beside the take files.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Do not list the kinds.")] = False,
) -> None:
    """Cut motion patches out of takes, and their mirrored copies."""
    made = patch.cut(folder, captures)
    out.parent.mkdir(parents=True, exist_ok=True)
    made.save(out)
    if not quiet:
        console.print(kind_table(made))
    alone = sum(kind.people == 1 for kind in made.kinds)
    console.print(f"{out}: {len(made)} kinds, {alone} of one person, {len(made.groups)} pose groups")
