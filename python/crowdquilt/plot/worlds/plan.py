"""A world from above: on the left where people go, on the right how dense they walk.

x points right and z points down the sheet: drawn with z upwards, everybody would be left-handed.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crowdquilt._core import World
from crowdquilt.plot import style
from crowdquilt.plot.worlds import ground


def plan(world: World, path: str | Path | None = None, time: float = 0.0, dpi: int = 170) -> Figure:
    """Draw a world from above at `time` seconds: everybody, all ways by direction, and densities over the period.

    Saves to `path` if one is given (`.png`, `.svg`, `.pdf`), and returns the figure.
    """
    low, high = extent(world)
    width, depth = high - low
    beside = width < 2.2 * depth
    inches = 8.2 if beside else 13.0
    tall = inches * depth / width
    sheet = style.new_figure(
        (2 * inches + 1.35) if beside else inches + 1.0, (tall if beside else 2 * tall + 0.5) + 2.15
    )
    wide, high_sheet = sheet.get_size_inches()
    places = [(0.5, 1.15), (0.85 + inches, 1.15)] if beside else [(0.5, 1.65 + tall), (0.5, 1.15)]
    flows, dense = (sheet.add_axes((x / wide, z / high_sheet, inches / wide, tall / high_sheet)) for x, z in places)
    unit = min(1.0, 60 / max(width, depth))  # people stay visible on large maps
    for axes in (flows, dense):
        axes.set(xlim=(low[0], high[0]), ylim=(high[1], low[1]), aspect="equal")
        axes.axis("off")
        ground.floors(axes, world)
        ground.objects(axes, world, 0.12)
    ground.ways(flows, world, 0.75 + 0.5 * unit, 0.62)
    walking = ground.walkers(flows, world, time, 0.27 / unit**0.3)
    staying = ground.stayers(flows, world, 0.24 / unit**0.3)
    most = densities(dense, world, low, high)
    captions(sheet, world, walking, staying, most)
    compass(sheet)
    scale_bar(dense, low, high)
    if path is not None:
        style.save(sheet, Path(path), dpi)
    return sheet


def extent(world: World) -> tuple[np.ndarray, np.ndarray]:
    """The corners of the ground that its patches cover."""
    points = [
        ground.turned(world.outline(kind), place)
        for kind, place in zip(world.instances, world.places, strict=True)
        if len(world.outline(kind))
    ]
    if not points:
        return np.zeros(2), np.ones(2)
    everything = np.concatenate(points)
    return everything.min(axis=0), everything.max(axis=0)


def densities(axes: Axes, world: World, low: np.ndarray, high: np.ndarray) -> float:
    """People per square metre as warm light on the ground; returns what the darkest colour stands for."""
    cell = max(0.25, float(np.max(high - low)) / 1400)
    values = ground.density(world, low, high, cell)
    used = values[values > 0.01]
    most = float(np.quantile(used, 0.995)) if len(used) else 1.0
    axes.imshow(
        values, extent=(low[0], high[0], high[1], low[1]), origin="upper", cmap=ground.DENSITY, vmin=0, vmax=most,
        interpolation="bilinear", zorder=4, aspect="equal",
    )  # fmt: skip
    return most


def captions(sheet: Figure, world: World, walking: int, staying: int, most: float) -> None:
    """Title, subtitle, and what the colours mean."""
    left = 0.5 / sheet.get_figwidth()
    size = " × ".join(f"{side:.0f}" for side in np.subtract(*reversed(extent(world))))
    more = ", repeating for ever" if world.repeat else ""
    people = f"{walking + staying:,}".replace(",", "\u2009")
    title = f"{(world.name or 'world').capitalize()}: {people} people on {size} m{more}"
    parts = (
        f"{len(world)} patches of {world.kinds} kinds with {world.patterns} patterns, period {world.period_secs:g} s"
    )
    style.heading(sheet, title, f"{walking} walk, {staying} stay   ·   {parts}", left)
    used = {world.template(int(kind)) for kind in set(world.instances)}
    entries = [(world.templates[t][0], ground.colour_of(world.templates[t][1])) for t in sorted(used)]
    entries = [(name, style.mix(colour, style.INK, 0.12)) for name, colour in entries]
    style.legend(sheet, [*entries, ("who stays", style.mix(ground.STAY, "white", 0.0))], left, 0.5)
    ramp(sheet, most)


def ramp(sheet: Figure, most: float) -> None:
    """The scale of densities, at the lower right."""
    wide, tall = sheet.get_size_inches()
    axes = sheet.add_axes((1 - 4.3 / wide, 0.56 / tall, 2.2 / wide, 0.12 / tall))
    axes.imshow(np.linspace(0, 1, 200)[None, :], aspect="auto", cmap=ground.DENSITY, extent=(0, most, 0, 1))
    axes.set(yticks=[], xticks=np.linspace(0, most, 3))
    axes.set_xticklabels([f"{v:.2g}" for v in np.linspace(0, most, 3)], fontsize=8.5, color=style.INK)
    axes.tick_params(length=0, pad=3)
    for spine in axes.spines.values():
        spine.set_visible(False)
    sheet.text(1 - 0.5 / wide, 0.60 / tall, "people / m²", size=9.5, color=style.INK, va="center", ha="right")


def compass(sheet: Figure) -> None:
    """Which colour leads which way, beside the scale of densities."""
    wide, tall = sheet.get_size_inches()
    side = 0.62
    axes = sheet.add_axes((1 - 5.3 / wide, 0.30 / tall, side / wide, side / tall))
    angles = np.linspace(0, 2 * np.pi, 73)
    for a, b in pairwise(angles):
        ring = np.array([[r * np.cos(t), r * np.sin(t)] for r, t in ((0.55, a), (1, a), (1, b), (0.55, b))])
        axes.fill(ring[:, 0], ring[:, 1], color=ground.DIRECTIONS((a + b) / 4 / np.pi), linewidth=0.3)
    axes.text(0, 0, "way", size=7.5, color=style.INK, ha="center", va="center")
    # z points down the sheet, as on the map.
    axes.set(xlim=(-1.05, 1.05), ylim=(1.05, -1.05), aspect="equal")
    axes.axis("off")


def scale_bar(axes: Axes, low: np.ndarray, high: np.ndarray) -> None:
    """A round length, under the lower right corner."""
    wanted = float(high[0] - low[0]) / 6
    metres = max(m for m in (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 1) if m <= max(wanted, 1))
    below = high[1] + 0.014 * np.ptp(axes.get_xlim())
    axes.plot([high[0] - metres, high[0]], [below, below], color=style.INK, linewidth=1.6, clip_on=False, zorder=10)
    axes.annotate(
        f"{metres} m", (high[0] - metres / 2, below), xytext=(0, -5), textcoords="offset points", size=9.5,
        color=style.INK, ha="center", va="top", annotation_clip=False,
    )  # fmt: skip
