"""What lies on the ground of a world: templates' floors, objects, who stays, who walks, and which way."""

from __future__ import annotations

from colorsys import hls_to_rgb
from zlib import crc32

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap

from crowdquilt._core import World
from crowdquilt.plot import style

# Ground by its name; others get a quiet colour of their own.
GROUNDS = {
    "cobblestones": "#efe9dc",
    "asphalt": "#e3e3e1",
    "grass": "#d5e0c1",
    "floor": "#ead9cc",
    "roof": "#5b6068",
    "water": "#c3dbe6",
}
STAY = "#b3541e"
# A cycle of colours of like weight: right, up, left, down on the sheet.
DIRECTIONS = LinearSegmentedColormap.from_list(
    "directions", ["#2d6fa3", "#3f9a86", "#5f9a3f", "#c79a22", "#d0603a", "#b8477e", "#7657b0", "#2d6fa3"]
)
DENSITY = LinearSegmentedColormap.from_list(
    "density", [(0.98, 0.97, 0.94, 0.0), (0.97, 0.80, 0.45, 0.55), (0.86, 0.36, 0.22, 0.8), (0.38, 0.07, 0.20, 0.92)]
)


def colour_of(ground: str) -> style.Colour:
    """The colour of a kind of ground."""
    if ground in GROUNDS:
        return style.mix(GROUNDS[ground], "white", 0.0)
    hue = (crc32(ground.encode()) % 360) / 360
    return hls_to_rgb(hue, 0.86, 0.25)


def turned(points: np.ndarray, place: np.ndarray) -> np.ndarray:
    """(n, 2) points of a kind's frame in the world; `place` is x, z and turn."""
    cos, sin = np.cos(place[2]), np.sin(place[2])
    return np.asarray(points @ np.array([[cos, sin], [-sin, cos]]) + place[:2])


def floors(axes: Axes, world: World) -> None:
    """Every patch in the colour of its ground."""
    outlines = [world.outline(kind) for kind in range(world.kinds)]
    colours = [colour_of(ground) for _, ground in world.templates]
    templates = [world.template(kind) for kind in range(world.kinds)]
    shapes, fills = [], []
    for kind, place in zip(world.instances, world.places, strict=True):
        if len(outlines[kind]):
            shapes.append(turned(outlines[kind], place))
            fills.append(colours[templates[kind]])
    # A line in the same colour closes the hair between neighbours.
    axes.add_collection(PolyCollection(shapes, facecolors=fills, edgecolors=fills, linewidths=0.4, zorder=1))


def objects(axes: Axes, world: World, shade: float) -> None:
    """Static objects, with a shadow `shade` metres long."""
    around = np.linspace(0, 2 * np.pi, 20, endpoint=False)
    circle = np.stack([np.cos(around), np.sin(around)], axis=1)
    own = [[pts if r == 0 else pts + r * circle for _, pts, r in world.objects(k)] for k in range(world.kinds)]
    placed = [turned(shape, p) for k, p in zip(world.instances, world.places, strict=True) for shape in own[k]]
    shadows = [shape + shade for shape in placed]
    axes.add_collection(PolyCollection(shadows, facecolors=(0.15, 0.14, 0.12, 0.12), edgecolors="none", zorder=4.5))
    axes.add_collection(PolyCollection(placed, facecolors="#a9a294", edgecolors=style.INK, linewidths=0.35, zorder=5))


def ways(axes: Axes, world: World, width: float, alpha: float) -> None:
    """Every way of every patch as a thin line, coloured by where it leads."""
    own = [
        [np.concatenate([points[:-1:5], points[-1:]]) for _, points in world.ways(kind)] for kind in range(world.kinds)
    ]
    segments, angles = [], []
    for kind, place in zip(world.instances, world.places, strict=True):
        for way in own[kind]:
            points = turned(way, place)
            segments.append(np.stack([points[:-1], points[1:]], axis=1))
            step = np.diff(points, axis=0)
            angles.append(np.arctan2(step[:, 1], step[:, 0]))
    if not segments:
        return
    lines = np.concatenate(segments)
    colours = DIRECTIONS((np.concatenate(angles) / (2 * np.pi)) % 1)
    colours[:, 3] = alpha
    axes.add_collection(LineCollection(list(lines), colors=colours, linewidths=width, capstyle="butt", zorder=3))


def stayers(axes: Axes, world: World, size: float) -> int:
    """Everybody who stays, as a disc that looks somewhere; how many."""
    places, looks = [], []
    for kind, place in zip(world.instances, world.places, strict=True):
        numbers, _ = world.stays(kind)
        if len(numbers):
            places.append(turned(numbers[:, :2], place))
            heading = numbers[:, 2] - place[2]
            looks.append(np.stack([np.sin(heading), np.cos(heading)], axis=1))
    if not places:
        return 0
    at, look = np.concatenate(places), np.concatenate(looks)
    around = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    circle = size * np.stack([np.cos(around), np.sin(around)], axis=1)
    axes.add_collection(
        PolyCollection(list(at[:, None] + circle), facecolors=STAY, edgecolors="white", linewidths=0.4, zorder=7)
    )
    noses = np.stack([at, at + look * size * 1.7], axis=1)
    axes.add_collection(LineCollection(list(noses), colors=STAY, linewidths=0.9, zorder=6.9))
    return len(at)


def walkers(axes: Axes, world: World, secs: float, size: float) -> int:
    """Everybody who walks at a moment, as a drop that points ahead; how many."""
    _, places, velocities = world.at(secs)
    angles = np.arctan2(velocities[:, 1], velocities[:, 0])
    around = np.linspace(0, 2 * np.pi, 18, endpoint=False)
    # A disc with a tip.
    reach = size * (1 + 0.9 * np.maximum(0, np.cos(around)) ** 6)
    drop = np.stack([reach * np.cos(around), reach * np.sin(around)], axis=1)
    cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]
    shape = np.stack([drop[:, 0] * cos - drop[:, 1] * sin, drop[:, 0] * sin + drop[:, 1] * cos], axis=2)
    fills = DIRECTIONS((angles / (2 * np.pi)) % 1)
    fills[:, :3] *= 0.82
    axes.add_collection(
        PolyCollection(list(places[:, None] + shape), facecolors=fills, edgecolors="white", linewidths=0.35, zorder=7)
    )
    return len(places)


def density(world: World, low: np.ndarray, high: np.ndarray, cell: float) -> np.ndarray:
    """(rows, columns) people per square metre over a period, smoothed over about a metre."""
    shape = np.maximum(1, np.ceil((high - low) / cell).astype(int))
    counts = np.zeros(shape)
    times = np.linspace(0, world.period_secs, 80, endpoint=False)
    for secs in times:
        _, places, _ = world.at(float(secs))
        at = np.floor((places - low) / cell).astype(int)
        inside = np.all((at >= 0) & (at < shape), axis=1)
        np.add.at(counts, tuple(at[inside].T), 1)
    counts /= len(times) * cell * cell
    for axis in (0, 1):
        counts = smooth(counts, 0.8 / cell, axis)
    return counts.T


def smooth(values: np.ndarray, sigma: float, axis: int) -> np.ndarray:
    """Along one axis, by a bell."""
    reach = max(1, int(3 * sigma))
    bell = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    return np.apply_along_axis(lambda line: np.convolve(line, bell / bell.sum(), mode="same"), axis, values)
