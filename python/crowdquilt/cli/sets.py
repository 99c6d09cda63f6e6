"""`kinds`: what a patch set holds, whether it can go on for ever, and pictures of it."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape
from rich.table import Table

from crowdquilt import patch
from crowdquilt._core import Connectivity, Measures, PatchSet
from crowdquilt.cli.app import app, console, example, expect_picture
from crowdquilt.cli.tables import kind_table


@app.command(epilog=example("kinds people.patches", "kinds people.patches --sheet sheet.png --groups groups.png"))
def kinds(
    patches: Annotated[Path, typer.Argument(help="Patch set (.patches).")],
    sheet: Annotated[Path | None, typer.Option(help="Draw every kind: a contact sheet (.png, .svg, .pdf).")] = None,
    groups: Annotated[Path | None, typer.Option(help="Draw the pose groups and what leads to what.")] = None,
    each: Annotated[bool, typer.Option("--each", help="List every kind, mirrored copies left out.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Tell what kinds a patch set holds, how they follow each other, and what it lacks.

    A set is closed if people can go on from everywhere for ever; what would close it is said where it is not.
    """
    expect_picture(sheet, groups)
    made = PatchSet.load(patches)
    found = patch.connectivity(made)
    if as_json:
        print(json.dumps(summary(made, found), indent=2))
    else:
        if each:
            console.print(kind_table(made))
            console.print()
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


def by_label(patches: PatchSet) -> dict[str, list[Measures]]:
    """What is measured of the kinds of each first label, the commonest label first; mirrored copies are counted."""
    measured: dict[str, list[Measures]] = {}
    for kind, found in zip(patches.kinds, patch.measures(patches), strict=True):
        measured.setdefault(kind.labels[0] if kind.labels else "no label", []).append(found)
    return dict(sorted(measured.items(), key=lambda item: (-len(item[1]), item[0])))


def label_table(patches: PatchSet) -> Table:
    """Kinds by their first label: how many of each number of people, and what is measured of them."""
    people = sorted({kind.people for kind in patches.kinds})
    table = Table(box=None, header_style="dim", padding=(0, 2, 0, 0), show_footer=True, footer_style="dim")
    table.add_column("label", footer=f"{len(patches)} kinds", no_wrap=True)
    for n in people:
        total = sum(kind.people == n for kind in patches.kinds)
        table.add_column("alone" if n == 1 else f"{n} people", justify="right", footer=str(total))
    for title in ("seconds", "m/s", "turn", "radius"):
        table.add_column(title, justify="right", no_wrap=True)
    table.add_column("measured")
    for label, found in by_label(patches).items():
        counts = (sum(m.people == n for m in found) for n in people)
        turn = f"{max(abs(m.turn_deg) for m in found):.0f}°"
        ranges = (both_ends(m.seconds for m in found), both_ends(m.speed for m in found), turn)
        radius = both_ends(m.radius for m in found)
        table.add_row(escape(label), *(str(n or "") for n in counts), *ranges, radius, " ".join(common_words(found)))
    return table


def common_words(found: list[Measures]) -> list[str]:
    """The words that hold for at least half of the kinds, the commonest first."""
    counts = Counter(word for m in found for word in m.words)
    return [word for word, count in counts.most_common() if 2 * count >= len(found)]


def both_ends(values: Iterable[float]) -> str:
    """The least and the most of values, or the one that all are."""
    found = list(values)
    least, most = f"{min(found):.1f}", f"{max(found):.1f}"
    return least if least == most else f"{least}-{most}"


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
            "contacts": k.contacts, "mirrored": k.mirrored, "measures": measures_of(m),
            "ports": [{"entry": role.entry, "exit": role.exit} for role in k.roles],
        }
        for k, m in zip(patches.kinds, patch.measures(patches), strict=True)
    ]  # fmt: skip
    return {"file": "patch set", "kinds": kinds, "connectivity": connectivity_of(found)}


def measures_of(measured: Measures) -> dict[str, Any]:
    """What is measured of a kind as plain data: metres, seconds, degrees."""
    figures = ("seconds", "speed", "fastest", "radius", "turn_deg")
    rounded_figures = {name: round(getattr(measured, name), 3) for name in figures}
    return {"people": measured.people, **rounded_figures, "props": measured.props, "words": measured.words}


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
