"""The crowd in space and time, time upwards: everybody's life a thread, patches of several people as volumes.

The picture of the paper's figure 5. Everything is projected here and painted from back to front, because
matplotlib's own 3D axes do not sort the parts of different lines and surfaces.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from crowdquilt._core import Crowd
from crowdquilt.plot import style
from crowdquilt.plot.lives import Lives, lives

STEP = 4  # frames from one slice of a volume, one bead of a thread, to the next
VOLUME_RADIUS = 0.28
THREAD = 0.0036  # scene widths

Rgba = tuple[float, float, float, float]


@dataclass
class Camera:
    """A far eye: `yaw` turns the floor, `pitch` looks down on it, `reach` is the distance in scene widths."""

    centre: np.ndarray
    span: float
    yaw: float = np.radians(-32)
    pitch: float = np.radians(21)
    reach: float = 4.2

    def project(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points (n, 3) as x, height, z: places (n, 2) on the sheet and depths (n,), larger is nearer."""
        x, up, z = ((points - self.centre) / self.span).T
        across = x * np.cos(self.yaw) - z * np.sin(self.yaw)
        near = x * np.sin(self.yaw) + z * np.cos(self.yaw)
        depth = near * np.cos(self.pitch) + up * np.sin(self.pitch)
        above = up * np.cos(self.pitch) - near * np.sin(self.pitch)
        shrink = self.reach / (self.reach - depth)
        return np.stack([across * shrink, above * shrink], axis=1), depth


@dataclass
class Painter:
    """Collects polygons with their depths, then paints them from back to front.

    Lines become thin polygons too: one collection of one sort is painted in one go and in its own order.
    """

    camera: Camera
    shapes: list[tuple[float, np.ndarray, Rgba]] = field(default_factory=list)

    def face(self, corners: np.ndarray, fill: Rgba) -> None:
        """A polygon."""
        flat, depth = self.camera.project(corners)
        self.shapes.append((float(depth.mean()), flat, fill))

    def line(self, points: np.ndarray, colour: Rgba, width: float, nearer: float = 0.0) -> None:
        """A polyline, `width` scene widths thick where the camera looks at."""
        flat, depth = self.camera.project(points)
        half = 0.5 * width * self.camera.reach / (self.camera.reach - depth)
        along = np.gradient(flat, axis=0)
        length = np.maximum(np.linalg.norm(along, axis=1), 1e-9)
        across = np.stack([-along[:, 1], along[:, 0]], axis=1) * (half / length)[:, None]
        outline = np.concatenate([flat + across, (flat - across)[::-1]])
        self.shapes.append((float(depth.mean()) + nearer, outline, colour))

    def paint(self, axes: Axes) -> None:
        """Put everything on the sheet."""
        self.shapes.sort(key=lambda shape: shape[0])
        outlines, fills = [shape[1] for shape in self.shapes], [shape[2] for shape in self.shapes]
        # A hair of the same colour around each polygon closes the seams between neighbours.
        axes.add_collection(PolyCollection(outlines, facecolors=fills, edgecolors=fills, linewidths=0.2, zorder=10))


def loom(crowd: Crowd, path: str | Path | None = None, dpi: int = 160) -> Figure:
    """Draw the whole crowd in space and time.

    Saves to `path` if one is given (`.png`, `.svg`, `.pdf`), and returns the figure.
    """
    who = lives(crowd)
    low, high = crowd.region.min(axis=0), crowd.region.max(axis=0)
    span = float(np.max(high - low))
    rise = 1.25 * span / max(crowd.seconds, 1e-3)  # metres of height per second
    centre = np.array([(low[0] + high[0]) / 2, rise * crowd.seconds / 2, (low[1] + high[1]) / 2])
    camera = Camera(centre, span)
    sheet = style.new_figure(10.0, 12.4)
    axes = sheet.add_axes((0.02, 0.075, 0.96, 0.855))
    axes.axis("off")
    kind_colours, palette = style.colours(crowd)
    frame_back(axes, crowd, camera, rise)
    painter = Painter(camera)
    obstacles(painter, crowd, rise)
    volumes(painter, crowd, who, kind_colours, rise)
    threads(painter, crowd, who, kind_colours, rise)
    painter.paint(axes)
    frame_front(axes, crowd, camera, rise)
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for z in (low[1], high[1]) for y in (0, 2 * centre[1])])
    flat, _ = camera.project(corners)
    (left, bottom), (right, top) = flat.min(axis=0) - [0.10, 0.09], flat.max(axis=0) + [0.03, 0.02]
    axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
    captions(sheet, crowd, palette)
    if path is not None:
        style.save(sheet, Path(path), dpi)
    return sheet


def lift(ground: np.ndarray, frames: np.ndarray, fps: float, rise: float) -> np.ndarray:
    """Ground points (n, 2) at `frames` as points of space-time (n, 3)."""
    return np.stack([ground[:, 0], frames / fps * rise, ground[:, 1]], axis=1)


def volumes(painter: Painter, crowd: Crowd, who: Lives, colours: list[style.Colour], rise: float) -> None:
    """Patches of two or more people: the hull of the people, lofted through time."""
    kinds, instances = crowd.kinds, crowd.instances
    light = np.array([-0.45, 0.35, 0.82])
    for instance, stretches in sorted(who.by_instance.items()):
        kind = instances[instance]
        if kinds[kind].people < 2 or len(stretches) < 2:
            continue
        begin, end = min(s.begin for s in stretches), max(s.end for s in stretches)
        frames = np.unique(np.append(np.arange(begin, end, STEP), end))
        slices: list[np.ndarray] = []
        for frame in frames:
            here = np.array([s.at(frame) for s in stretches if s.begin <= frame <= s.end])
            ground = style.swept(here, VOLUME_RADIUS, 24) if len(here) else slices[-1][:, [0, 2]]
            slices.append(lift(ground, np.full(len(ground), frame), crowd.fps, rise))
        colour = colours[kind]
        for lower, upper in pairwise(slices):
            loft(painter, lower, upper, colour, light)
        painter.face(slices[-1], (*style.mix(colour, "white", 0.35), 0.85))


def loft(painter: Painter, lower: np.ndarray, upper: np.ndarray, colour: style.Colour, light: np.ndarray) -> None:
    """The faces between two slices of a volume that look at the camera, shaded."""
    count = len(lower)
    for i in range(count):
        j = (i + 1) % count
        quad = np.array([lower[i], lower[j], upper[j], upper[i]])
        flat, _ = painter.camera.project(quad)
        turn = np.cross(flat[2] - flat[0], flat[3] - flat[1])
        if turn > 0:
            continue
        normal = np.cross(quad[3] - quad[1], quad[2] - quad[0])
        length = float(np.linalg.norm(normal))
        lit = float(normal @ light) / length if length > 0 else 0.0
        shade = style.mix(colour, "white", 0.38 * lit) if lit > 0 else style.mix(colour, style.INK, -0.45 * lit)
        painter.face(quad, (*shade, 0.80))


def threads(painter: Painter, crowd: Crowd, who: Lives, colours: list[style.Colour], rise: float) -> None:
    """Everybody's life as a thread with a pale border, coloured by the patch it runs through."""
    kinds, instances = crowd.kinds, crowd.instances
    # Lone threads differ a little in tone, so that the eye can follow one among many.
    tones = np.random.default_rng(1).uniform(-0.25, 0.25, len(crowd))
    for person, stretches in enumerate(who.by_person):
        for s in stretches:
            kind = instances[s.instance]
            company = kinds[kind].people > 1
            tone = tones[person]
            colour = style.mix(colours[kind], style.INK if tone > 0 else "white", abs(tone))
            if company:
                colour = style.mix(colours[kind], style.INK, 0.35)
            frames = np.arange(s.begin, s.end + 1)
            points = lift(s.ground, frames, crowd.fps, rise)
            for i in range(0, len(points) - 1, STEP):
                bead = points[i : i + STEP + 1]
                painter.line(bead, (1.0, 1.0, 1.0, 0.85), 2.2 * THREAD)
                painter.line(bead, (*colour, 1.0), THREAD, nearer=1e-4)


def obstacles(painter: Painter, crowd: Crowd, rise: float) -> None:
    """Obstacles over the whole time: what moves leans in the direction of its way."""
    layers = 20
    for obstacle in crowd.obstacles:
        outlines = [obstacle.at(crowd.seconds * k / layers) for k in range(layers + 1)]
        for k, (lower, upper) in enumerate(pairwise(outlines)):
            low, high = (rise * crowd.seconds * j / layers for j in (k, k + 1))
            edges = zip(lower, np.roll(lower, -1, axis=0), np.roll(upper, -1, axis=0), upper, strict=True)
            for a, b, c, d in edges:
                quad = np.array([[a[0], low, a[1]], [b[0], low, b[1]], [c[0], high, c[1]], [d[0], high, d[1]]])
                painter.face(quad, (0.74, 0.72, 0.67, 0.22))
        floor = np.insert(outlines[0], 1, 0.0, axis=1)
        painter.face(floor, (0.74, 0.72, 0.67, 0.9))


def frame_back(axes: Axes, crowd: Crowd, camera: Camera, rise: float) -> None:
    """Floor with its metre grid, the two far walls with the seconds, and the axis of time."""
    low, high = crowd.region.min(axis=0), crowd.region.max(axis=0)
    top = rise * crowd.seconds

    def flat(*points: tuple[float, float, float]) -> np.ndarray:
        return camera.project(np.array(points, dtype=float))[0]

    floor = np.insert(crowd.region, 1, 0.0, axis=1)
    axes.add_collection(
        PolyCollection(
            [camera.project(floor)[0]], facecolors=style.FLOOR, edgecolors=style.INK, linewidths=1.3, zorder=1
        )
    )
    lines = [flat((x, 0, low[1]), (x, 0, high[1])) for x in np.arange(np.ceil(low[0]), high[0])]
    lines += [flat((low[0], 0, z), (high[0], 0, z)) for z in np.arange(np.ceil(low[1]), high[1])]
    # The far walls are those the camera does not look through: low x is left of the corner, low z behind.
    far_x = low[0] if np.sin(camera.yaw) > 0 else high[0]
    walls = [
        flat((low[0], 0, low[1]), (high[0], 0, low[1]), (high[0], top, low[1]), (low[0], top, low[1])),
        flat((far_x, 0, low[1]), (far_x, 0, high[1]), (far_x, top, high[1]), (far_x, top, low[1])),
    ]
    axes.add_collection(PolyCollection(walls, facecolors="#fbfaf6", edgecolors=style.HAIR, linewidths=0.8, zorder=0.5))
    ticks = second_ticks(crowd.seconds)
    for secs in ticks:
        y = rise * secs
        lines.append(flat((low[0], y, low[1]), (high[0], y, low[1])))
        lines.append(flat((far_x, y, low[1]), (far_x, y, high[1])))
    axes.add_collection(LineCollection(lines, colors=style.HAIR, linewidths=0.6, zorder=2))
    near_x = high[0] if far_x == low[0] else low[0]
    edge = [flat((near_x, 0, low[1]), (near_x, top, low[1]))]
    axes.add_collection(LineCollection(edge, colors=style.INK, linewidths=1.1, zorder=2))
    for secs in ticks:
        at = flat((near_x, rise * secs, low[1]))[0]
        text = f"{secs:g} s" if secs in (ticks[0], ticks[-1]) else f"{secs:g}"
        axes.annotate(
            text,
            at,
            xytext=(-8, 0),
            textcoords="offset points",
            size=9.5,
            color=style.INK,
            ha="right",
            va="center",
        )


def second_ticks(seconds: float) -> list[float]:
    """Round numbers of seconds from the beginning to the end, at most about ten."""
    step = next(s for s in (0.5, 1, 2, 5, 10, 20, 60, 300, 1e9) if seconds / s <= 10)
    return [float(s) for s in np.arange(0, seconds + 1e-6, step)]


def frame_front(axes: Axes, crowd: Crowd, camera: Camera, rise: float) -> None:
    """The near edges of the floor again, above what stands behind them, and the length of its sides."""
    low, high = crowd.region.min(axis=0), crowd.region.max(axis=0)
    side = low[0] if np.sin(camera.yaw) < 0 else high[0]
    edges = [
        np.array([[low[0], 0, high[1]], [high[0], 0, high[1]]]),
        np.array([[side, 0, low[1]], [side, 0, high[1]]]),
    ]
    for edge, metres in zip(edges, high - low, strict=True):
        ends = camera.project(edge)[0]
        middle = ends.mean(axis=0)
        slope = np.degrees(np.arctan2(*(ends[1] - ends[0])[::-1]))
        slope = (slope + 90) % 180 - 90
        axes.annotate(
            f"{metres:.4g} m", middle, xytext=(0, -14), textcoords="offset points", size=9.5, color=style.INK,
            ha="center", va="center", rotation=slope,
        )  # fmt: skip


def captions(sheet: Figure, crowd: Crowd, palette: dict[str, style.Colour]) -> None:
    """Title, subtitle and legend."""
    kinds = crowd.kinds
    company = sum(1 for k in crowd.instances if kinds[k].people > 1)
    subtitle = (
        f"{len(crowd)} lives through {len(crowd.instances)} patches, {company} of them shared;  "
        f"time runs upwards, {crowd.seconds:.0f} s"
    )
    style.heading(sheet, f"{style.metres(crowd)} in space and time", subtitle)
    counts = {
        name: sum(1 for k in crowd.instances if kinds[k].people > 1 and style.activity(kinds[k]) == name)
        for name in palette
    }
    entries = [(f"{name} {counts[name]}", colour) for name, colour in palette.items()]
    style.legend(sheet, [*entries, ("alone", style.ALONE)])
