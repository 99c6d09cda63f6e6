"""What commands print: tables of facts, kinds, rows of a check."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from typing import Any

from rich.cells import cell_len
from rich.markup import escape
from rich.table import Table

from crowdquilt import patch
from crowdquilt._core import Kind, PatchSet, Report, Take


def number(value: float) -> str:
    """A figure with as many digits as one reads."""
    if value == round(value) and abs(value) < 1e6:
        return f"{value:.0f}"
    return f"{value:.1e}" if abs(value) >= 1e6 else f"{value:.4f}"


def signed(degrees: float) -> str:
    """A turn with its direction, in whole degrees."""
    whole = round(degrees)
    return f"{whole:+d}°" if whole else "0°"


def facts(values: dict[str, Any]) -> Table:
    """Names on the left, values on the right."""
    table = Table.grid(padding=(0, 2))
    for name, value in values.items():
        text = number(value) if isinstance(value, float) else value
        text = ", ".join(str(v) for v in text) if isinstance(text, list) else text
        table.add_row(f"[dim]{name.replace('_', ' ')}[/dim]", escape(str(text)))
    return table


WRAPPED = 20  # letters in a line of a column that wraps, at least


@dataclass
class Column:
    """A column of a table: its cells from above, right of each other or words; `wraps` where there is no room."""

    title: str
    cells: list[str]
    words: bool = False
    wraps: bool = False
    footer: str = ""

    @property
    def least(self) -> int:
        """The letters it cannot do without; what wraps is legible from some width on."""
        lines = [line for text in (self.title, self.footer, *self.cells) for line in text.splitlines()]
        longest = max(map(cell_len, lines), default=0)
        return min(longest, WRAPPED) if self.wraps else longest


def fitted(columns: list[Column], spare: tuple[str, ...], width: int) -> Table:
    """A table; where there is no room for all columns those in `spare` are left out, the first of them first."""
    shown, missing = list(columns), list[str]()
    for title in spare:
        if sum(column.least + 2 for column in shown) <= width:
            break
        shown = [column for column in shown if column.title != title]
        missing.append(title)
    table = Table(box=None, header_style="dim", padding=(0, 2, 0, 0), footer_style="dim",
                  show_footer=any(column.footer for column in shown), caption_justify="left")  # fmt: skip
    if missing:
        table.caption = f"a wider terminal shows {', '.join(missing)}"
    for c in shown:
        table.add_column(c.title, justify="left" if c.words else "right", no_wrap=not c.wraps, footer=c.footer)
    for row in zip(*(column.cells for column in shown), strict=True):
        table.add_row(*map(escape, row))
    return table


def kind_table(patches: PatchSet, width: int) -> Table:
    """The kinds of a set with what is measured of them, without mirrored copies."""
    measured = zip(patches.kinds, patch.measures(patches), strict=True)
    own = [(kind, found) for kind, found in measured if not kind.mirrored]
    columns = [
        Column("kind", [kind.name for kind, _ in own], words=True),
        Column("people", [str(kind.people) for kind, _ in own]),
        Column("seconds", [f"{found.seconds:.2f}" for _, found in own]),
        Column("m/s", [f"{found.speed:.1f}" for _, found in own]),
        Column("turn", [signed(found.turn_deg) for _, found in own]),
        Column("radius", [f"{found.radius:.1f} m" for _, found in own]),
        Column("measured", [" ".join(found.words) for _, found in own], words=True, wraps=True),
        Column("ports", [ports_of(kind) for kind, _ in own], words=True),
    ]
    return fitted(columns, ("radius", "turn", "m/s", "ports", "seconds"), width)


def ports_of(kind: Kind) -> str:
    """Where people come from and go to, a line for all who do alike."""
    ways = Counter(f"{role.entry} → {role.exit}" for role in kind.roles)
    return "\n".join(f"{count} × {way}" if count > 1 else way for way, count in ways.items())


def take_table(takes: list[Take]) -> Table:
    """What was found in every take."""
    table = Table(box=None, header_style="dim", padding=(0, 2, 0, 0))
    several = any(take.together for take in takes)
    for title in ("take", "people", "events", "patches", *(["together"] if several else [])):
        table.add_column(title, justify="left" if title == "take" else "right")
    for take in takes:
        events = "annotated" if take.annotated else str(len(take.events))
        together = [f"{take.together:.0%}" if take.together else ""] if several else []
        table.add_row(escape(take.name), str(take.people), events, str(len(take.patches)), *together)
    return table


def notes_of(takes: list[Take]) -> list[tuple[str, str]]:
    """What is to be said of takes, the same of many only once: names and words."""
    said: dict[str, list[str]] = {}
    for take in takes:
        for note in take.notes:
            # Of takes in which nothing was found the number of frames does not matter.
            said.setdefault(re.sub(r"(, found 0) in \d+ frames$", r"\1", note), []).append(take.name)
    return [(", ".join(names), note) for note, names in said.items()]


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
