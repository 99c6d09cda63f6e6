"""One look for all pictures: paper, ink, and a colour for everything people do together."""

from __future__ import annotations

from collections import Counter
from itertools import takewhile
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from crowdquilt._core import Crowd, Kind
from crowdquilt.outputs import whole_file

Colour = tuple[float, float, float]

PAPER = "#f7f5f0"
FLOOR = "#fffefb"
INK = "#26282b"
FAINT = "#8b8a85"
HAIR = "#d9d6cd"
ALONE = to_rgb("#a3a6a8")
TEAMS = ("#2456a6", "#d4572a", "#2f8f5b", "#e0b12f", "#8a3fa0", "#1f9aa8")  # as src/export/look.rs
TOGETHER = (
    "#c8443f", "#2d6fa3", "#e0a02c", "#4f8f54", "#8659a3", "#db7336",
    "#2f9c9a", "#b8508c", "#7c6a45", "#5d6fd0", "#91a83a", "#7d3c4a",
)  # fmt: skip

# Fonts that come with matplotlib, so that a picture is the same everywhere.
matplotlib.rcParams["font.family"] = ["DejaVu Sans"]


def mix(colour: Any, other: Any, share: float) -> Colour:
    """`share` of `other` in `colour`."""
    a, b = np.array(to_rgb(colour)), np.array(to_rgb(other))
    red, green, blue = a + (b - a) * share
    return float(red), float(green), float(blue)


# Parts of a kind's name that say how it is done, not what is done.
MANNERS = {"stand", "walk", "passing", "long", "mirror"}


def activity(kind: Kind) -> str:
    """What people do in a kind, in words: its name up to the first part that is a number or says how it is done."""
    words = kind.name.replace("_", "-").split("-")
    what = list(takewhile(lambda word: word not in MANNERS and not any(c.isdigit() for c in word), words))
    return " ".join(what or words)


def colours(crowd: Crowd) -> tuple[list[Colour], dict[str, Colour]]:
    """The colour of every kind, and of every activity of two or more people, the commonest first."""
    kinds = crowd.kinds
    used = Counter(activity(kinds[k]) for k in crowd.instances if kinds[k].people > 1)
    names = [name for name, _ in sorted(used.items(), key=lambda item: (-item[1], item[0]))]
    palette = {name: to_rgb(TOGETHER[i % len(TOGETHER)]) for i, name in enumerate(names)}
    return [palette.get(activity(k), ALONE) if k.people > 1 else ALONE for k in kinds], palette


def team(index: int) -> Colour:
    """The colour of a team."""
    return to_rgb(TEAMS[index % len(TEAMS)])


def swept(points: np.ndarray, radius: float, corners: int = 32) -> np.ndarray:
    """(corners, 2) outline of the convex hull of discs about `points`, by its support in evenly spread directions.

    The corners of two outlines with as many corners correspond, so that outlines can be lofted.
    """
    angles = np.linspace(0, 2 * np.pi, corners, endpoint=False)
    directions = np.stack([np.cos(angles), np.sin(angles)])
    outermost = points[np.argmax(points @ directions, axis=0)]
    return np.asarray(outermost + radius * directions.T)


def metres(crowd: Crowd) -> str:
    """The size of the region in words."""
    width, depth = np.ptp(crowd.region, axis=0)
    return f"{width:.4g} × {depth:.4g} m"


def new_figure(width: float, height: float) -> Figure:
    """An empty sheet of paper, in inches."""
    figure = Figure(figsize=(width, height), facecolor=PAPER)
    FigureCanvasAgg(figure)
    return figure


def heading(figure: Figure, title: str, subtitle: str, left: float = 0.05) -> None:
    """The two lines at the top of the sheet."""
    tall = figure.get_figheight()
    figure.text(left, 1 - 0.44 / tall, title, size=17, weight="bold", color=INK, va="baseline")
    figure.text(left, 1 - 0.72 / tall, subtitle, size=10.5, color=FAINT, va="baseline")


def legend(figure: Figure, entries: list[tuple[str, Colour]], left: float = 0.05, right: float = 0.95) -> None:
    """A line of coloured words (two if need be) at the foot of the sheet."""
    wide, tall = figure.get_size_inches()
    x, y = left * wide, 0.62
    for text, colour in entries:
        label = figure.text((x + 0.17) / wide, y / tall, text, size=10, color=INK, va="center")
        advance = label.get_window_extent().width / figure.dpi + 0.45
        if x + advance > right * wide and x > left * wide:
            x, y = left * wide, y - 0.27
            label.set_position(((x + 0.17) / wide, y / tall))
        figure.text(x / wide, y / tall, "●", size=11, color=colour, va="center")
        x += advance


def save(figure: Figure, path: Path, dpi: int) -> None:
    """Write a picture, whole or not at all; the same crowd gives the same bytes."""
    with whole_file(path) as part:
        # Without a date or version in it, the file depends on the crowd alone.
        figure.savefig(part, dpi=dpi, facecolor=PAPER, metadata={"Software": None} if path.suffix == ".png" else None)
