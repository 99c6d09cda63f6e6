"""`plot` and `view`: looking at a crowd, or at the kinds of a patch set."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from crowdquilt._core import Crowd, CrowdquiltError
from crowdquilt.cli.app import app, console, example


class Picture(StrEnum):
    """Which picture."""

    plan = "plan"
    loom = "loom"


@app.command(epilog=example("plot plaza.crowd -o plaza.png --time 8", "plot plaza.crowd --kind loom -o loom.svg"))
def plot(
    crowd: Annotated[Path, typer.Argument(help="Crowd (.crowd).")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Picture to write (.png, .svg, .pdf).")],
    kind: Annotated[Picture, typer.Option(help="From above at one time, or in space and time.")] = Picture.plan,
    time: Annotated[float | None, typer.Option(help="Seconds, for a plan; the liveliest moment if not given.")] = None,
) -> None:
    """Draw a crowd: a plan seen from above, or a loom with time upwards."""
    if out.suffix not in (".png", ".svg", ".pdf"):
        raise CrowdquiltError(f"{out}: expected a picture (.png, .svg, .pdf), found {out.suffix or 'no suffix'}")
    found = Crowd.load(crowd)
    if time is not None and not 0 <= time <= found.seconds:
        raise typer.BadParameter(f"expected 0 to {found.seconds:g} seconds, found {time:g}", param_hint="--time")
    from crowdquilt import plot as pictures  # matplotlib is slow to import

    if kind is Picture.plan:
        pictures.plan(found, out, time)
    else:
        pictures.loom(found, out)
    console.print(f"{out}: written")


@app.command(epilog=example("view out/demo/crowd.crowd", "view out/street.world", "view people.patches"))
def view(
    crowd: Annotated[Path, typer.Argument(help="Crowd (.crowd), world (.world) or patch set (.patches).")] = Path(
        "out/demo/crowd.crowd"
    ),
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port on this machine; a free one if 0.")] = 0,
    no_open: Annotated[bool, typer.Option("--no-open", help="Do not open a browser.")] = False,
) -> None:
    """Watch a crowd, walk through a world, or see the kinds of a patch set in the browser.

    It is served from this machine to this machine only.
    """
    from crowdquilt import server

    server.serve(crowd, port, open_browser=not no_open, say=lambda line: console.print(line, soft_wrap=True))
