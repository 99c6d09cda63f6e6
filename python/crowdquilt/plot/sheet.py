"""The contact sheet of a patch set: every kind a card, people alone first; mirrored copies are left out."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crowdquilt._core import PatchSet, connectivity
from crowdquilt.plot import style
from crowdquilt.plot.card import TALL, WIDE, draw
from crowdquilt.plot.cards import Card, cards

COLUMNS = 5
GAP, MARGIN = 0.16, 0.45  # inches


def sheet(patches: PatchSet, path: str | Path | None = None, dpi: int = 110) -> Figure:
    """Draw every kind of a set on one sheet of paper.

    Saves to `path` if one is given (`.png`, `.svg`, `.pdf`), and returns the figure.
    """
    shown = cards(patches, connectivity(patches))
    sections = [(people, list(of)) for people, of in groupby(shown, key=lambda card: card.kind.people)]
    columns = min(COLUMNS, max([3, *(len(of) for _, of in sections)]))
    wide = 2 * MARGIN + columns * (WIDE + GAP) - GAP
    top, section_room = 1.0, 0.52
    places: list[tuple[float, int, list[Card]]] = []
    for people, of in sections:
        places.append((top, people, of))
        top += section_room + -(-len(of) // columns) * (TALL + GAP)
    tall = top + 0.55
    page = style.new_figure(wide, tall)
    axes = page.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, wide), ylim=(tall, 0))
    axes.axis("off")
    headline(page, axes, patches, shown, tall)
    for section_top, people, of in places:
        section(axes, section_top, people, len(of), wide)
        for i, card in enumerate(of):
            row, column = divmod(i, columns)
            left = MARGIN + column * (WIDE + GAP)
            draw(axes, card, np.array([left, section_top + section_room + row * (TALL + GAP)]))
    if path is not None:
        style.save(page, Path(path), dpi)
    return page


def headline(page: Figure, axes: Axes, patches: PatchSet, shown: Sequence[Card], tall: float) -> None:
    """Title, what the set holds, and how to read a card."""
    mirrored = len(patches) - len(shown)
    note = f";  {mirrored} mirrored copies are not shown" if mirrored else ""
    title = f"{len(shown)} kinds of motion patches"
    seconds = sum(card.kind.seconds for card in shown)
    style.heading(
        page,
        title,
        f"{seconds:.0f} s of motion between {len(patches.groups)} pose groups{note}",
        MARGIN / page.get_figwidth(),
    )
    how = (
        "○ entry   ▶ exit   • every second   ━ while they act together   squares of 1 m;   "
        "maps from above, their lower edge is nearest to the eye"
    )
    axes.text(MARGIN, tall - 0.3, how, size=9, color=style.FAINT, va="center")


def section(axes: Axes, top: float, people: int, count: int, wide: float) -> None:
    """A line above the kinds of one number of people."""
    name = "One person" if people == 1 else f"{people} people"
    label = axes.text(MARGIN, top + 0.30, name, size=13, weight="bold", color=style.INK, va="baseline")
    reach = MARGIN + label.get_window_extent().width / axes.figure.dpi + 0.14
    axes.text(
        reach, top + 0.30, f"{count} kinds" if count > 1 else "1 kind", size=10.5, color=style.FAINT, va="baseline"
    )
    axes.plot([MARGIN, wide - MARGIN], [top + 0.40] * 2, color=style.HAIR, linewidth=1.0, zorder=1)
