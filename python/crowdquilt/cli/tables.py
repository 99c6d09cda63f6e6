"""What commands print: tables of facts, kinds, rows of a check."""

from __future__ import annotations

from typing import Any

from rich.markup import escape
from rich.table import Table

from crowdquilt import patch
from crowdquilt._core import PatchSet, Report, Take


def number(value: float) -> str:
    """A figure with as many digits as one reads."""
    if value == round(value) and abs(value) < 1e6:
        return f"{value:.0f}"
    return f"{value:.1e}" if abs(value) >= 1e6 else f"{value:.4f}"


def facts(values: dict[str, Any]) -> Table:
    """Names on the left, values on the right."""
    table = Table.grid(padding=(0, 2))
    for name, value in values.items():
        text = number(value) if isinstance(value, float) else value
        text = ", ".join(str(v) for v in text) if isinstance(text, list) else text
        table.add_row(f"[dim]{name.replace('_', ' ')}[/dim]", escape(str(text)))
    return table


def kind_table(patches: PatchSet) -> Table:
    """The kinds of a set with what is measured of them, without mirrored copies."""
    table = Table(box=None, header_style="dim", padding=(0, 2, 0, 0))
    for title in ("kind", "people", "seconds", "m/s", "turn", "radius", "measured", "ports"):
        words = title in ("kind", "measured", "ports")
        table.add_column(title, justify="left" if words else "right", no_wrap=title != "measured", overflow="fold")
    for kind, found in zip(patches.kinds, patch.measures(patches), strict=True):
        if not kind.mirrored:
            ports = "\n".join(f"{role.entry} → {role.exit}" for role in kind.roles)
            speed, turn = f"{found.speed:.1f}", f"{found.turn_deg:+.0f}°"
            sizes = (str(kind.people), f"{found.seconds:.2f}", speed, turn, f"{found.radius:.1f} m")
            table.add_row(escape(kind.name), *sizes, " ".join(found.words), ports)
    return table


def take_table(takes: list[Take]) -> Table:
    """What was found in every take."""
    table = Table(box=None, header_style="dim", padding=(0, 2, 0, 0))
    for title in ("take", "people", "events", "patches", "together"):
        table.add_column(title, justify="left" if title == "take" else "right")
    for take in takes:
        events = "annotated" if take.annotated else str(len(take.events))
        together = f"{take.together:.0%}" if take.together else ""
        table.add_row(escape(take.name), str(take.people), events, str(len(take.patches)), together)
    return table


def check_table(report: Report) -> Table:
    """The contract, row by row."""
    table = Table(box=None, header_style="dim", padding=(0, 2, 0, 0))
    for title in ("", "contract", "found", "limit", "", "worst at"):
        table.add_column(title, justify="right" if title in ("found", "limit") else "left", overflow="fold")
    for row in report.rows:
        mark = "[green]✓[/green]" if row.ok else "[bold red]✗[/bold red]"
        place = f"[dim]{escape(row.place)}[/dim]"
        table.add_row(mark, escape(row.row), number(row.value), number(row.limit), row.unit, place)
    return table
