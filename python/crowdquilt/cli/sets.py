"""`kinds`: what a patch set holds, whether it can go on for ever, and pictures of it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape
from rich.table import Table

from crowdquilt import patch
from crowdquilt._core import Connectivity, CrowdquiltError, PatchSet
from crowdquilt.cli.app import app, console, example

PICTURES = (".png", ".svg", ".pdf")


@app.command(epilog=example("kinds people.patches", "kinds people.patches --sheet sheet.png --groups groups.png"))
def kinds(
    patches: Annotated[Path, typer.Argument(help="Patch set (.patches).")],
    sheet: Annotated[Path | None, typer.Option(help="Draw every kind: a contact sheet (.png, .svg, .pdf).")] = None,
    groups: Annotated[Path | None, typer.Option(help="Draw the pose groups and what leads to what.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Tell what kinds a patch set holds, how they follow each other, and what it lacks.

    A set is closed if people can go on from everywhere for ever; what would close it is said where it is not.
    """
    for picture in (sheet, groups):
        if picture is not None and picture.suffix not in PICTURES:
            suffix = picture.suffix or "no suffix"
            raise CrowdquiltError(f"{picture}: expected a picture ({', '.join(PICTURES)}), found {suffix}")
    made = PatchSet.load(patches)
    found = patch.connectivity(made)
    if as_json:
        print(json.dumps(summary(made, found), indent=2))
    else:
        tell(made, found)
    if sheet is None and groups is None:
        return
    from crowdquilt import plot  # matplotlib is slow to import

    for picture, draw in ((sheet, plot.sheet), (groups, plot.groups)):
        if picture is not None:
            draw(made, picture)
            if not as_json:
                console.print(f"{picture}: written")


def tell(patches: PatchSet, found: Connectivity) -> None:
    """Print kinds by label, groups with what leads in and out, and the advice."""
    console.print(label_table(patches))
    console.print()
    console.print(group_table(found))
    console.print()
    if found.closed:
        console.print("[green]✓[/green] closed: everybody can go on from everywhere")
    else:
        console.print("[bold red]✗[/bold red] not closed")
    for advice in found.advice:
        console.print(f"[yellow]advice[/yellow] {escape(advice)}", soft_wrap=True)


def by_label(patches: PatchSet) -> dict[str, dict[int, int]]:
    """How many kinds of each number of people have each kind's first label; mirrored copies are counted."""
    counts: dict[str, dict[int, int]] = {}
    for kind in patches.kinds:
        label = kind.labels[0] if kind.labels else "no label"
        of_label = counts.setdefault(label, {})
        of_label[kind.people] = of_label.get(kind.people, 0) + 1
    return dict(sorted(counts.items(), key=lambda item: (-sum(item[1].values()), item[0])))


def label_table(patches: PatchSet) -> Table:
    """Kinds by their first label and number of people."""
    counts = by_label(patches)
    people = sorted({kind.people for kind in patches.kinds})
    table = Table(box=None, header_style="dim", padding=(0, 2, 0, 0), show_footer=True, footer_style="dim")
    table.add_column("label", footer=f"{len(patches)} kinds")
    for n in people:
        total = sum(kind.people == n for kind in patches.kinds)
        table.add_column("alone" if n == 1 else f"{n} people", justify="right", footer=str(total))
    for label, of_label in counts.items():
        table.add_row(escape(label), *(str(of_label.get(n, "")) for n in people))
    return table


def group_table(found: Connectivity) -> Table:
    """Pose groups: how many kinds of one person and of several lead in and out, and where one can go alone."""
    table = Table(box=None, header_style="dim", padding=(0, 2, 0, 0))
    for title in ("pose group", "in", "out", "turn alone", "m/s", "seconds"):
        table.add_column(title, justify="left" if title == "pose group" else "right", no_wrap=True)
    traps = {name for component in found.components if not component.main for name in component.groups}
    for group in found.groups:
        name = f"[red]{escape(group.name)}[/red]" if group.name in traps else escape(group.name)
        ways = (both(group.in_alone, group.in_together), both(group.out_alone, group.out_together))
        s = group.steering
        ranges = ("", "", "")
        if s is not None:
            ranges = (f"{s.turn_deg[0]:+.0f}° {s.turn_deg[1]:+.0f}°", span(s.speed), span(s.secs))
        table.add_row(name, *ways, *ranges)
    return table


def both(alone: int, together: int) -> str:
    """Kinds of one person, and of several."""
    return f"{alone} +{together}" if together else str(alone)


def span(ends: tuple[float, float]) -> str:
    """From the least to the most."""
    return f"{ends[0]:.1f}-{ends[1]:.1f}"


def summary(patches: PatchSet, found: Connectivity) -> dict[str, Any]:
    """All of it as plain data."""
    kinds = [
        {
            "name": k.name, "people": k.people, "seconds": round(k.seconds, 3), "labels": k.labels,
            "contacts": k.contacts, "mirrored": k.mirrored,
            "ports": [{"entry": role.entry, "exit": role.exit} for role in k.roles],
        }
        for k in patches.kinds
    ]  # fmt: skip
    return {"file": "patch set", "kinds": kinds, "connectivity": connectivity_of(found)}


def connectivity_of(found: Connectivity) -> dict[str, Any]:
    """The connectivity as plain data."""
    ranges = ("turn_deg", "speed", "secs", "left", "ahead")
    counts = ("name", "in_alone", "in_together", "out_alone", "out_together")
    groups = [
        {key: getattr(g, key) for key in counts}
        | {"steering": g.steering and {key: rounded(getattr(g.steering, key)) for key in ranges}}
        for g in found.groups
    ]
    return {
        "closed": found.closed,
        "groups": groups,
        "links": [{"entry": x.entry, "exit": x.exit, "alone": x.alone, "together": x.together} for x in found.links],
        "components": [
            {key: getattr(c, key) for key in ("groups", "lasting", "entered", "left", "main")} for c in found.components
        ],
        "not_entered": found.not_entered,
        "not_left": found.not_left,
        "missing": found.missing,
        "advice": found.advice,
    }


def rounded(ends: tuple[float, float]) -> list[float]:
    """Both ends to the thousandth."""
    return [round(end, 3) for end in ends]
