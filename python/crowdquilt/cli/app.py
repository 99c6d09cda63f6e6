"""The app all commands belong to, and what they share."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from crowdquilt._core import CrowdquiltError, __version__

CHECK_FAILED = 1
BAD_INPUT = 2
WISH_UNMET = 3
FAULTY = 4
ENDS = {"perfect": 0, "short": WISH_UNMET, "imperfect": FAULTY}
"""Exit codes of tilings by their status."""
VERDICTS = {
    "perfect": "[green]perfect[/green]",
    "short": "[yellow]clean, but short of what was wished for[/yellow]",
    "imperfect": "[red]not perfect[/red]",
}

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
# What goes to a file or another program has no width to fit into.
console = Console(highlight=False, width=None if sys.stdout.isatty() or "COLUMNS" in os.environ else 160)


def example(*lines: str) -> str:
    """The foot of a command's help: how it is called."""
    return "[bold]Example[/bold]\n\n" + "\n\n".join(f"  [cyan]$ crowdquilt {line}[/cyan]" for line in lines)


PICTURES = (".png", ".svg", ".pdf")


def expect_picture(*files: Path | None) -> None:
    """Refuse files that are no pictures by their names."""
    for file in files:
        if file is not None and file.suffix not in PICTURES:
            suffix = file.suffix or "no suffix"
            raise CrowdquiltError(f"{file}: expected a picture ({', '.join(PICTURES)}), found {suffix}")


def _version(wanted: bool) -> None:
    if wanted:
        print(f"crowdquilt {__version__}")
        raise typer.Exit


@app.callback(epilog=example("demo -o out/demo", "view out/demo/crowd.crowd"))
def crowdquilt(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and end.")
    ] = False,
) -> None:
    """Stitch motion capture into crowds.

    Captures are cut into motion patches, patches are tiled in space and time until no end is loose, and the crowd
    is checked, exported and watched.
    """
