"""A capture on one sheet: ways over the ground, foot plants over time, how much the pose changes over time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crowdquilt._core import Clip
from crowdquilt.plot.style import FAINT, FLOOR, HAIR, INK, TOGETHER, heading, new_figure, save

FPS = 30.0  # of motion on the canonical body


def capture(clips: list[Clip], path: Path, dpi: int = 150) -> Figure:
    """Draw captures of one take (or one alone) into a picture file."""
    figure = new_figure(9.0, 5.4 + 0.3 * len(clips))
    names = " and ".join(clip.name for clip in clips)
    rates = ", ".join(f"{clip.seconds:.1f} s at {clip.fps:.4g} frames per second" for clip in clips[:2])
    heading(figure, names, rates)
    ground = figure.add_axes((0.06, 0.10, 0.34, 0.70))
    feet = figure.add_axes((0.50, 0.56, 0.46, 0.24))
    change = figure.add_axes((0.50, 0.10, 0.46, 0.36), sharex=feet)
    draw_ground(ground, clips)
    draw_plants(feet, clips)
    draw_variation(change, clips)
    for axes in (ground, feet, change):
        dress(axes)
    save(figure, path, dpi)
    return figure


def draw_ground(axes: Axes, clips: list[Clip]) -> None:
    """The ways from above, x to the right and z down, with a dot at every second and an arrow's head at the end."""
    for clip, colour in zip(clips, TOGETHER, strict=False):
        way = clip.path()
        axes.plot(way[:, 0], way[:, 1], color=colour, lw=1.6, solid_capstyle="round")
        seconds = way[:: int(FPS)]
        axes.scatter(seconds[:, 0], seconds[:, 1], s=9, color=colour, zorder=3)
        axes.scatter(way[0, 0], way[0, 1], s=46, facecolor=FLOOR, edgecolor=colour, zorder=4)
        axes.scatter(way[-1, 0], way[-1, 1], s=46, color=colour, zorder=4)
    axes.set_aspect("equal", adjustable="datalim")
    axes.invert_yaxis()
    axes.set_title("way over the ground, m; dots are seconds", loc="left", size=9.5, color=INK)


def draw_plants(axes: Axes, clips: list[Clip]) -> None:
    """A bar for every foot plant; a row for every foot."""
    rows: list[str] = []
    for clip, colour in zip(clips, TOGETHER, strict=False):
        for foot in ("left", "right"):
            spans = [(begin, end - begin) for side, begin, end in clip.plants() if side == foot]
            axes.broken_barh(spans, (len(rows) - 0.32, 0.64), color=colour, alpha=0.85)
            rows.append(foot if len(clips) == 1 else f"{clip.name} {foot}")
    axes.set_yticks(range(len(rows)), rows)
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.tick_params(labelbottom=False)
    axes.set_title("feet on the floor", loc="left", size=9.5, color=INK)


def draw_variation(axes: Axes, clips: list[Clip]) -> None:
    """The curve of how far the pose is from that half a second before."""
    longest = 0.0
    for clip, colour in zip(clips, TOGETHER, strict=False):
        curve = clip.variation(0.5)
        times = np.arange(len(curve)) / FPS
        axes.plot(times, curve, color=colour, lw=1.4)
        axes.fill_between(times, curve, color=colour, alpha=0.12, lw=0)
        longest = max(longest, float(times[-1]))
    axes.set_xlim(0, longest)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("seconds", size=9, color=FAINT)
    axes.set_title("change of the pose within half a second, m", loc="left", size=9.5, color=INK)


def dress(axes: Axes) -> None:
    """The look of the axes."""
    axes.set_facecolor(FLOOR)
    axes.grid(color=HAIR, lw=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(colors=FAINT, labelsize=8.5, length=0)
    for side in axes.spines.values():
        side.set_color(HAIR)
