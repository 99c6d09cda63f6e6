"""One card of the contact sheet: key poses, paths from above, ports and labels.

A card's map is seen from above by the eye that sees its people: what is lower on the map is nearer.
"""

from __future__ import annotations

import textwrap
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.patches import FancyBboxPatch, Polygon

from crowdquilt.plot import style
from crowdquilt.plot.cards import Card
from crowdquilt.plot.figures import View, draw_people, extent

FPS = 30.0
ROLES = [to_rgb(c) for c in ("#2d6fa3", "#d2603a", "#e0a02c", "#4f8f54", "#8659a3", "#b8508c", "#2f9c9a", "#7c6a45")]
FAULT = "#c8443f"
WIDE, TALL = 3.5, 2.56  # inches, like all that follows
STRIP = (0.14, 0.42, 3.22, 0.98)  # of the card: left, top, width, height
MAP = (0.14, 1.50, 1.62, 0.92)
SCALE, LEAST_SCALE, MAP_SCALE = 0.46, 0.33, 0.42  # per metre at most; of poses at least
TALLEST = 0.88  # moment
BETWEEN = 0.22  # metres between two moments
MOST_LINES = 3  # of ports; more people than that share lines


def draw(axes: Axes, card: Card, corner: np.ndarray) -> None:
    """One card."""
    edge = FAULT if card.fault else style.HAIR
    rounded(axes, corner, (WIDE, TALL), 0.09, style.FLOOR, edge, 1)
    people = "alone" if card.kind.people == 1 else f"{card.kind.people} people"
    figures = f"{people} · {card.kind.seconds:.1f} s"
    right = axes.text(
        corner[0] + WIDE - 0.14,
        corner[1] + 0.25,
        figures,
        size=8.5,
        color=style.FAINT,
        ha="right",
        va="baseline",
        zorder=6,
    )
    room = WIDE - 0.42 - right.get_window_extent().width / axes.figure.dpi
    fitted(axes, corner + [0.14, 0.25], card.kind.name, room, size=9.5, weight="bold", color=style.INK)
    strip(axes, card, corner + STRIP[:2])
    ground(axes, card, corner + MAP[:2])
    words(axes, card, corner)


def rounded(
    axes: Axes, corner: np.ndarray, size: tuple[float, float], radius: float, fill: str, edge: str, zorder: float
) -> FancyBboxPatch:
    """A box with rounded corners whose upper left corner is given."""
    shape = f"round,pad=0,rounding_size={radius}"
    place = (float(corner[0]), float(corner[1]))
    box = FancyBboxPatch(place, *size, boxstyle=shape, facecolor=fill, edgecolor=edge, linewidth=1.0, zorder=zorder)
    axes.add_patch(box)
    return box


def fitted(axes: Axes, place: np.ndarray, text: str, room: float, size: float, **looks: Any) -> None:
    """A line of text; one wider than `room` inches is made smaller, and if need be shortened in its middle."""
    label = axes.text(place[0], place[1], text, va="baseline", zorder=6, size=size, **looks)
    share = room / max(label.get_window_extent().width / axes.figure.dpi, 1e-6)
    label.set_fontsize(size * min(max(share, 0.68), 1.0))
    letters = int(len(text) * share / 0.68)
    if letters < len(text):
        keep = max(letters - 2, 2)
        label.set_text(f"{text[: keep - keep // 2]}…{text[len(text) - keep // 2 :]}")


def strip(axes: Axes, card: Card, corner: np.ndarray) -> None:
    """The key poses side by side, each with its second below."""
    moments = [(frame, *card.moment(frame)) for frame in card.moments]
    reach = {frame: extent([body for _, body in people], card.view, boxes) for frame, people, boxes in moments}

    def wanted() -> float:
        return sum(width(frame) for frame, *_ in moments) + BETWEEN * (len(moments) - 1)

    def width(frame: int) -> float:
        return float(reach[frame][1][0] - reach[frame][0][0])

    # People far apart would make everybody small: what is wide and shows little that others do not has to go.
    while STRIP[2] / wanted() < LEAST_SCALE and len(moments) > 1:
        tells = dict(zip((frame for frame, *_ in moments), card.telling([m[0] for m in moments]), strict=True))
        moments.remove(max(moments, key=lambda moment: width(moment[0]) / max(tells[moment[0]], 1e-3)))
    tallest = max(reach[frame][1][1] - reach[frame][0][1] for frame, *_ in moments)
    scale = min(SCALE, STRIP[2] / wanted(), TALLEST / tallest)
    spare = (STRIP[2] - scale * wanted()) / len(moments)
    floor = corner[1] + STRIP[3] - 0.16
    x = corner[0] + spare / 2
    for frame, people, boxes in moments:
        (left, bottom), (right, _) = reach[frame]
        raised = scale * min(float(bottom), 0.0)
        bodies = [(body, ROLES[role % len(ROLES)]) for role, body in people]
        draw_people(axes, bodies, card.view, (x - scale * left, floor + raised), (scale, -scale), boxes=boxes)
        ends = [x - 0.04, x + scale * (right - left) + 0.04]
        axes.plot(ends, [floor] * 2, color="#cbc6ba", linewidth=1.0, solid_capstyle="round", zorder=2)
        axes.text(
            sum(ends) / 2,
            floor + 0.13,
            f"{frame / FPS:.1f}",
            size=6.5,
            color=style.FAINT,
            ha="center",
            va="center",
            zorder=6,
        )
        x += scale * (right - left + BETWEEN) + spare


def ground(axes: Axes, card: Card, corner: np.ndarray) -> None:
    """The paths from above, in the box whose upper left corner is given."""
    ways = [card.view.from_above(points) * [1, -1] for points, _ in card.paths]
    low, high = np.min([w.min(axis=0) for w in ways], axis=0), np.max([w.max(axis=0) for w in ways], axis=0)
    room = np.array(MAP[2:]) - 0.24
    scale = min(MAP_SCALE, *(room / np.maximum(high - low, 0.1)))
    origin = corner + np.array(MAP[2:]) / 2 - scale * (low + high) / 2
    box = rounded(axes, corner, MAP[2:], 0.05, "#f3f0e8", "none", 1.5)
    squares(axes, corner, origin, scale, box)
    for role, way in reversed(list(enumerate(ways))):
        path(axes, card, role, origin + scale * way)


def squares(axes: Axes, corner: np.ndarray, origin: np.ndarray, scale: float, box: FancyBboxPatch) -> None:
    """A grid of metres over the map."""
    low, high = (corner - origin) / scale, (corner + MAP[2:] - origin) / scale
    lines = [[(x, low[1]), (x, high[1])] for x in np.arange(np.ceil(low[0]), high[0])]
    lines += [[(low[0], y), (high[0], y)] for y in np.arange(np.ceil(low[1]), high[1])]
    placed = [origin + scale * np.array(line) for line in lines]
    grid = LineCollection(placed, colors="#e3dfd4", linewidths=0.7, zorder=1.6)
    axes.add_collection(grid)
    grid.set_clip_path(box)


def path(axes: Axes, card: Card, role: int, way: np.ndarray) -> None:
    """One person's path: thick over the core, a dot at every second, a ring at the entry, an arrowhead at the exit."""
    colour, own = ROLES[role % len(ROLES)], card.kind.roles[role]
    axes.plot(*way.T, color=colour, linewidth=1.2, solid_capstyle="round", zorder=4)
    if card.kind.core:
        begin, end = (int(np.clip(f - own.begin, 0, own.frames - 1)) for f in card.kind.core)
        axes.plot(*way[begin : end + 1].T, color=colour, linewidth=3.0, solid_capstyle="round", zorder=4)
    seconds = np.arange(-(-own.begin // FPS) * FPS, own.begin + own.frames, FPS).astype(int) - own.begin
    axes.scatter(
        way[seconds, 0],
        way[seconds, 1],
        s=5,
        color=style.FLOOR,
        edgecolor=style.mix(colour, style.INK, 0.4),
        linewidth=0.6,
        zorder=4.2,
    )
    headings = card.paths[role][1]
    axes.add_patch(
        Polygon(
            way[0] + tick(card.view, headings[0]), closed=False, fill=False, edgecolor=colour, linewidth=1.1, zorder=4.3
        )
    )
    # Somebody who ends where the way began has the ring around the arrowhead.
    size, zorder = (16, 4.4) if np.hypot(*(way[-1] - way[0])) > 0.16 else (190, 3.9)
    axes.scatter(way[0, 0], way[0, 1], s=size, facecolor=style.FLOOR, edgecolor=colour, linewidth=1.1, zorder=zorder)
    axes.add_patch(
        Polygon(
            way[-1] + arrowhead(card.view, headings[-1]),
            facecolor=colour,
            edgecolor=style.FLOOR,
            linewidth=0.5,
            zorder=4.5,
        )
    )


def facing(view: View, heading: float) -> np.ndarray:
    """A heading on a map whose second figure grows downwards."""
    return np.asarray(view.from_above(np.array([np.sin(heading), np.cos(heading)])) * [1, -1])


def tick(view: View, heading: float) -> np.ndarray:
    """A short line that says where somebody faces, inches."""
    return np.asarray(np.array([0.0, 0.11])[:, None] * facing(view, heading))


def arrowhead(view: View, heading: float) -> np.ndarray:
    """An arrowhead that says where somebody faces, inches."""
    ahead = facing(view, heading)
    aside = np.array([-ahead[1], ahead[0]])
    return np.array([0.10 * ahead, -0.05 * ahead + 0.062 * aside, -0.02 * ahead, -0.05 * ahead - 0.062 * aside])


def ports(axes: Axes, card: Card, corner: np.ndarray, room: float) -> float:
    """Where everybody comes from and goes to, those who do alike on one line; returns where the next line may be."""
    alike: dict[str, list[int]] = {}
    for role, own in enumerate(card.kind.roles):
        way = f"{own.entry} → {own.exit}".replace("_", " ")
        alike.setdefault(way if card.kind.people > MOST_LINES else f"{role} {way}", []).append(role)
    left, y = corner
    for way, roles in alike.items():
        # Of a crowd not more dots than there is room for.
        shown = roles[:MOST_LINES]
        axes.scatter(left + 0.04 + 0.1 * np.arange(len(shown)), [y] * len(shown), s=20,
                     c=[ROLES[role % len(ROLES)] for role in shown], zorder=6)  # fmt: skip
        begin = 0.04 + 0.1 * len(shown)
        text = f"{len(roles)} × {way}" if len(roles) > 1 else way.lstrip("0123456789 ")
        fitted(axes, np.array([left + begin, y + 0.035]), text, room - begin, size=8, color=style.INK)
        y += 0.18
    return float(y)


def words(axes: Axes, card: Card, corner: np.ndarray) -> None:
    """Ports, labels and faults, beside the map."""
    left, top = corner[0] + MAP[0] + MAP[2] + 0.14, corner[1] + MAP[1] + 0.07
    room = corner[0] + WIDE - 0.12 - left
    y = ports(axes, card, np.array([left, top]), room) + 0.10
    lines = [(", ".join(card.kind.labels).replace("_", " "), style.FAINT)]
    if card.kind.contacts:
        touches = "1 touch" if card.kind.contacts == 1 else f"{card.kind.contacts} touches"
        lines.insert(0, (touches, style.FAINT))
    if card.fault:
        lines.append((card.fault, FAULT))
    for text, colour in lines:
        for line in textwrap.wrap(text, 28)[:3]:
            axes.text(left, y, line, size=7, color=colour, va="center", zorder=6)
            y += 0.135
