"""One patch: its ways in space and time, and its patterns unrolled: place along each edge, time upwards."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from crowdquilt._core import Pattern, World
from crowdquilt.plot import style
from crowdquilt.plot.worlds import ground

TIME = 0.78  # metres on the sheet for a second
TILT = np.radians(31)  # how steeply one looks down
TURN = np.radians(-34)


def patch(world: World, kind: int | None = None, path: str | Path | None = None, dpi: int = 170) -> Figure:
    """Draw a patch kind, by default the one with most walkers: ways in space and time, and the pattern of every edge.

    Saves to `path` if one is given (`.png`, `.svg`, `.pdf`), and returns the figure.
    """
    if kind is None:
        used = sorted({int(k) for k in world.instances})
        kind = max(used, key=lambda k: (len(world.ways(k)), len(world.objects(k))))
    sheet = style.new_figure(13.6, 9.2)
    wide, tall = sheet.get_size_inches()
    prism = sheet.add_axes((0.2 / wide, 0.62 / tall, 7.3 / wide, 7.7 / tall))
    draw_prism(prism, world, kind)
    edges = world.patterns_of(kind)
    room = 7.4 / max(len(edges), 1)
    for edge, pattern in enumerate(edges):
        bottom = 0.95 + room * (len(edges) - 1 - edge)
        strip = sheet.add_axes((8.1 / wide, bottom / tall, 5.0 / wide, (room - 0.62) / tall))
        draw_strip(strip, world, pattern, edge)
    captions(sheet, world, kind)
    if path is not None:
        style.save(sheet, Path(path), dpi)
    return sheet


def project(points: np.ndarray, secs: np.ndarray | float) -> np.ndarray:
    """Ground points (..., 2) at some times, on the sheet."""
    x, z = points[..., 0], points[..., 1]
    right = x * np.cos(TURN) - z * np.sin(TURN)
    away = -(x * np.sin(TURN) + z * np.cos(TURN))
    return np.stack([right, away * np.sin(TILT) + np.asarray(secs) * TIME * np.cos(TILT)], axis=-1)


def distance(points: np.ndarray) -> np.ndarray:
    """How far away ground points are from the eye; larger is farther."""
    return np.asarray(-(points[..., 0] * np.sin(TURN) + points[..., 1] * np.cos(TURN)))


def draw_prism(axes: Axes, world: World, kind: int) -> None:
    """The patch as a column: the ground below, time upwards, the borders as walls."""
    outline, period = world.outline(kind), world.period_secs
    axes.set_aspect("equal")
    axes.axis("off")
    floor(axes, world, kind, outline)
    walls(axes, outline, period)
    worms(axes, world, kind, period)
    gates(axes, world, kind, outline)
    corners = np.concatenate([project(outline, 0.0), project(outline, period)])
    low, high = corners.min(axis=0), corners.max(axis=0)
    axes.set(xlim=(low[0] - 0.9, high[0] + 0.6), ylim=(low[1] - 0.6, high[1] + 0.6))
    clock(axes, outline, period)


def floor(axes: Axes, world: World, kind: int, outline: np.ndarray) -> None:
    """The ground with objects, who stays, and the ways as seen from above."""
    colour = ground.colour_of(world.templates[world.template(kind)][1])
    axes.add_collection(PolyCollection([project(outline, 0.0)], facecolors=[colour], edgecolors="none", zorder=1))
    around = np.linspace(0, 2 * np.pi, 28, endpoint=False)
    circle = np.stack([np.cos(around), np.sin(around)], axis=1)
    shapes = [project(pts if r == 0 else pts + r * circle, 0.0) for _, pts, r in world.objects(kind)]
    axes.add_collection(PolyCollection(shapes, facecolors="#a9a294", edgecolors=style.INK, linewidths=0.6, zorder=3))
    stays, _ = world.stays(kind)
    people = [project(s[:2] + 0.25 * circle, 0.0) for s in stays]
    axes.add_collection(PolyCollection(people, facecolors=ground.STAY, edgecolors="white", linewidths=0.5, zorder=3))
    shadows = [project(points, 0.0) for _, points in world.ways(kind)]
    axes.add_collection(LineCollection(shadows, colors=(0.2, 0.19, 0.17, 0.22), linewidths=1.6, zorder=2))


def walls(axes: Axes, outline: np.ndarray, period: float) -> None:
    """The borders, with a line every second; what is near is only an outline."""
    ends = np.roll(outline, -1, axis=0)
    middle = distance(outline).mean()
    for a, b in zip(outline, ends, strict=True):
        back = distance((a + b) / 2) > middle
        lines = [project(np.stack([a, b]), float(t)) for t in range(int(period) + 1)]
        if back:
            corners = project(np.stack([a, b, b, a]), np.array([0, 0, period, period]))
            axes.add_collection(PolyCollection([corners], facecolors=(1, 1, 1, 0.5), edgecolors="none", zorder=0.5))
            axes.add_collection(LineCollection(lines, colors=style.HAIR, linewidths=0.6, zorder=0.6))
        shown = lines if back else [lines[0], lines[-1]]
        axes.add_collection(
            LineCollection([shown[0], shown[-1]], colors=style.FAINT, linewidths=0.8, zorder=0.7 if back else 20)
        )
    posts = [project(np.stack([p, p]), np.array([0.0, period])) for p in outline]
    axes.add_collection(LineCollection(posts, colors=style.FAINT, linewidths=0.8, zorder=0.7))


def worms(axes: Axes, world: World, kind: int, period: float) -> None:
    """Everybody's way through space and time, cut at the end of the period and going on at its begin."""
    pieces = []
    for index, (begin, points) in enumerate(world.ways(kind, step=0.02)):
        times = begin + 0.02 * np.arange(len(points))
        colour = style.mix(style.TOGETHER[index % len(style.TOGETHER)], style.INK, 0.05)
        for lap in range(int(times[-1] // period) + 1 if len(times) else 0):
            own = (times >= lap * period) & (times <= (lap + 1) * period)
            if own.sum() > 1:
                pieces.append((points[own], times[own] - lap * period, colour))
    pieces.sort(key=lambda piece: -float(distance(piece[0]).mean()))
    for depth, (points, times, colour) in enumerate(pieces):
        line, z = project(points, times), 5 + depth / len(pieces)
        axes.plot(*line.T, color=style.FLOOR, linewidth=5.2, solid_capstyle="round", zorder=z)
        axes.plot(*line.T, color=colour, linewidth=3.4, solid_capstyle="round", zorder=z + 1e-4)
        light = line + [-0.016, 0.016]
        axes.plot(*light.T, color=style.mix(colour, "white", 0.45), linewidth=0.9, zorder=z + 2e-4)


def gates(axes: Axes, world: World, kind: int, outline: np.ndarray) -> None:
    """Where in space and time people cross the borders."""
    ends = np.roll(outline, -1, axis=0)
    for a, b, pattern in zip(outline, ends, world.patterns_of(kind), strict=True):
        along = (b - a) / max(float(np.hypot(*(b - a))), 1e-9)
        for crossings, colour, marker in ((pattern.inputs, 1, "^"), (pattern.outputs, 0, "v")):
            points = project(a + crossings[:, :1] * along, crossings[:, 1])
            right, up = points.T
            tint = style.TOGETHER[colour]
            axes.scatter(right, up, s=52, color=tint, marker=marker, zorder=21, edgecolors="white", linewidths=0.9)


def clock(axes: Axes, outline: np.ndarray, period: float) -> None:
    """Seconds along the leftmost post."""
    post = outline[np.argmin(project(outline, 0.0)[:, 0])]
    for t in range(0, int(period) + 1, 2 if period <= 20 else 10):
        x, y = project(post, float(t))
        axes.text(x - 0.16, y, f"{t} s", size=9, color=style.FAINT, ha="right", va="center")


def draw_strip(axes: Axes, world: World, pattern: Pattern, edge: int) -> None:
    """One border: place along it to the right, time upwards; who comes in and who goes out."""
    length, period = pattern.length, world.period_secs
    axes.set(xlim=(0, length), ylim=(0, period), facecolor=style.FLOOR)
    axes.grid(color=style.HAIR, linewidth=0.5)
    axes.set_axisbelow(True)
    axes.tick_params(length=0, labelsize=8.5, labelcolor=style.FAINT)
    axes.set_xticks(np.arange(0, length + 0.01, 1 if length < 12 else 5))
    axes.set_yticks(np.arange(0, period + 0.01, period / 5))
    for spine in axes.spines.values():
        spine.set_color(style.FAINT)
        spine.set_linewidth(0.7)
    bodies(axes, pattern.inputs, style.TOGETHER[1], "^", period)
    bodies(axes, pattern.outputs, style.TOGETHER[0], "v", period)
    count = (len(pattern.inputs), len(pattern.outputs))
    axes.set_ylabel("s", size=8.5, color=style.FAINT, rotation=0, labelpad=6)
    words = f"{count[0]} in, {count[1]} out" if sum(count) else "nobody crosses"
    axes.set_title(f"edge {edge + 1}   ", loc="left", size=10, color=style.INK, weight="bold", pad=4)
    axes.set_title(words, loc="right", size=9.5, color=style.FAINT, pad=4)


def bodies(axes: Axes, crossings: np.ndarray, colour: str, marker: str, period: float) -> None:
    """Crossings with the room that their bodies take in place and time."""
    for place, time, across, along in crossings:
        reach = 0.25 / across
        around = np.linspace(0, 2 * np.pi, 40)
        for lap in (-1, 0, 1):
            at = time + lap * period + reach * np.sin(around)
            axes.fill(place + along * reach * np.sin(around) + 0.25 * np.cos(around), at, color=colour, alpha=0.18)
    if len(crossings):
        axes.scatter(crossings[:, 0], crossings[:, 1], s=34, color=colour, marker=marker, zorder=4, edgecolors="white",
                     linewidths=0.6)  # fmt: skip


def captions(sheet: Figure, world: World, kind: int) -> None:
    """Title, and how to read it."""
    name = world.templates[world.template(kind)][0]
    ways, objects = len(world.ways(kind)), len(world.objects(kind))
    stays = len(world.stays(kind)[0])
    left = 0.5 / sheet.get_figwidth()
    parts = [f"{ways} people cross it every {world.period_secs:g} s", f"{stays} stay", f"{objects} objects"]
    style.heading(sheet, f"A patch of {world.name}: {name}", "   ·   ".join(parts), left)
    what = "Everybody's way, time upwards; who reaches the top goes on at the bottom. Right: the borders unrolled."
    wide, tall = sheet.get_size_inches()
    sheet.text(left, 0.4 / tall, what, size=9.5, color=style.FAINT, va="center")
    style.legend(sheet, [("comes in", style.mix(style.TOGETHER[1], "white", 0)),
                         ("goes out", style.mix(style.TOGETHER[0], "white", 0))], 8.1 / wide, 1)  # fmt: skip
