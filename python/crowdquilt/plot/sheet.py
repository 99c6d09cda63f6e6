"""The contact sheet of a patch set: every kind a card with its key poses, its paths from above and its ports.

A card's map is seen from above by the eye that sees its people: what is lower on the map is nearer.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, Polygon

from crowdquilt._core import Connectivity, Kind, PatchSet, connectivity, kind_capsules
from crowdquilt.plot import style
from crowdquilt.plot.figures import View, draw_people, extent

FPS = 30.0
ROLES = [to_rgb(c) for c in ("#2d6fa3", "#d2603a", "#e0a02c", "#4f8f54", "#8659a3", "#b8508c", "#2f9c9a", "#7c6a45")]
FAULT = "#c8443f"
COLUMNS = 5
CARD, GAP, MARGIN = (3.5, 2.72), 0.16, 0.45  # inches
STRIP = (0.14, 0.42, 3.22, 0.98)  # of the card: left, top, width, height
MAP = (0.14, 1.56, 1.46, 1.02)
SCALE, MAP_SCALE = 0.46, 0.42  # inches per metre at most
NECK = 0.10  # metres between two moments


@dataclass
class Card:
    """One kind of a set, with its people's bodies (frames, capsules, 7), paths and headings."""

    patches: PatchSet
    index: int
    kind: Kind
    fault: str

    @cached_property
    def bodies(self) -> list[np.ndarray]:
        return [kind_capsules(self.patches, self.index, role) for role in range(self.kind.people)]

    @cached_property
    def paths(self) -> list[tuple[np.ndarray, np.ndarray]]:
        return [self.patches.path(self.index, role) for role in range(self.kind.people)]

    def at(self, frame: int) -> list[tuple[int, np.ndarray]]:
        """Who is there at a frame of the kind's clock: roles and bodies."""
        own = [(role, frame - r.begin) for role, r in enumerate(self.kind.roles)]
        return [(role, self.bodies[role][f]) for role, f in own if 0 <= f < self.kind.roles[role].frames]

    def moment(self, frame: int) -> list[tuple[int, np.ndarray]]:
        """The same with the middle of the people at the origin."""
        people = self.at(frame)
        middle = np.mean([body[0, [0, 2]] for _, body in people], axis=0)
        shift = np.array([middle[0], 0, middle[1]] * 2 + [0])
        return [(role, body - shift) for role, body in people]

    @cached_property
    def view(self) -> View:
        """Beside somebody alone; across several people where they act."""
        if self.kind.people == 1:
            return View.beside(float(self.paths[0][1][0]))
        frame = sum(self.core) // 2
        here = np.array([self.paths[role][0][frame - self.kind.roles[role].begin] for role, _ in self.at(frame)])
        if len(here) < 2 or np.ptp(here, axis=0).max() < 0.05:
            return View.beside(float(self.paths[0][1][0]))
        centred = here - here.mean(axis=0)
        line = np.linalg.svd(centred)[2][0]
        # The first role on the left, as in the list of ports.
        return View.along(line if centred[0] @ line <= 0 else -line)

    @cached_property
    def core(self) -> tuple[int, int]:
        """The frames over which people act together; of somebody alone, all."""
        return self.kind.core or (0, self.kind.frames - 1)

    @cached_property
    def moments(self) -> list[int]:
        """Three to five frames that tell what happens."""
        last = self.kind.frames - 1
        if self.kind.people == 1:
            wanted = np.linspace(0, last, int(np.clip(2 + round(last / 12), 3, 5))).round().astype(int).tolist()
        else:
            begin, end = self.core
            wanted = [0, begin, (begin + end) // 2, end, last]
        chosen: list[int] = []
        for frame in wanted:
            if (not chosen or frame - chosen[-1] >= 4) and self.at(frame):
                chosen.append(frame)
        return chosen


def cards(patches: PatchSet, found: Connectivity) -> list[Card]:
    """All kinds but mirrored copies: people alone first, then by number of people, as they stand in the set."""
    no_way_in, no_way_out = set(found.not_entered), set(found.not_left)

    def fault(name: str) -> str:
        ways = [("nobody comes here", name in no_way_in), ("nobody goes on", name in no_way_out)]
        return ", ".join(text for text, wrong in ways if wrong)

    made = [Card(patches, i, kind, fault(kind.name)) for i, kind in enumerate(patches.kinds) if not kind.mirrored]
    return sorted(made, key=lambda card: card.kind.people)


def sheet(patches: PatchSet, path: str | Path | None = None, dpi: int = 110) -> Figure:
    """Draw every kind of a set on one sheet of paper.

    Saves to `path` if one is given (`.png`, `.svg`, `.pdf`), and returns the figure.
    """
    shown = cards(patches, connectivity(patches))
    sections = [(people, list(of)) for people, of in groupby(shown, key=lambda card: card.kind.people)]
    columns = min(COLUMNS, max([3, *(len(of) for _, of in sections)]))
    wide = 2 * MARGIN + columns * (CARD[0] + GAP) - GAP
    top, title_room, section_room = 0.0, 1.15, 0.52
    places: list[tuple[float, int, list[Card]]] = []
    top = title_room
    for people, of in sections:
        places.append((top, people, of))
        top += section_room + -(-len(of) // columns) * (CARD[1] + GAP)
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
            left = MARGIN + column * (CARD[0] + GAP)
            draw(axes, card, np.array([left, section_top + section_room + row * (CARD[1] + GAP)]))
    if path is not None:
        style.save(page, Path(path), dpi)
    return page


def headline(page: Figure, axes: Axes, patches: PatchSet, shown: Sequence[Card], tall: float) -> None:
    """Title, what the set holds, and how to read a card."""
    mirrored = len(patches) - len(shown)
    note = f";  {mirrored} mirrored copies are not shown" if mirrored else ""
    title = f"{len(shown)} kinds of motion patches"
    seconds = sum(card.kind.seconds for card in shown)
    style.heading(page, title, f"{seconds:.0f} s of motion between {len(patches.groups)} pose groups{note}",
                  MARGIN / page.get_figwidth())  # fmt: skip
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
    axes.text(reach, top + 0.30, f"{count} kinds" if count > 1 else "1 kind", size=10.5, color=style.FAINT,
              va="baseline")  # fmt: skip
    axes.plot([MARGIN, wide - MARGIN], [top + 0.40] * 2, color=style.HAIR, linewidth=1.0, zorder=1)


def draw(axes: Axes, card: Card, corner: np.ndarray) -> None:
    """One card."""
    edge = FAULT if card.fault else style.HAIR
    axes.add_patch(
        FancyBboxPatch(
            tuple(corner), *CARD, boxstyle="round,pad=0,rounding_size=0.09", facecolor=style.FLOOR, edgecolor=edge,
            linewidth=1.0, zorder=1,
        )  # fmt: skip
    )
    people = "alone" if card.kind.people == 1 else f"{card.kind.people} people"
    figures = f"{people} · {card.kind.seconds:.1f} s"
    right = axes.text(corner[0] + CARD[0] - 0.14, corner[1] + 0.25, figures, size=8.5, color=style.FAINT, ha="right",
                      va="baseline", zorder=6)  # fmt: skip
    room = CARD[0] - 0.42 - right.get_window_extent().width / axes.figure.dpi
    fitted(axes, corner + [0.14, 0.25], card.kind.name, room, size=9.5, weight="bold", color=style.INK)
    strip(axes, card, corner + STRIP[:2])
    ground(axes, card, corner + MAP[:2])
    words(axes, card, corner)


def fitted(axes: Axes, place: np.ndarray, text: str, room: float, **looks: Any) -> None:
    """A line of text, shortened in its middle where it is wider than `room` inches."""
    label = axes.text(*place, text, va="baseline", zorder=6, **looks)
    width = label.get_window_extent().width / axes.figure.dpi
    letters = int(len(text) * room / max(width, 1e-6))
    if letters < len(text):
        keep = max(letters - 2, 2)
        label.set_text(f"{text[: keep - keep // 2]}…{text[len(text) - keep // 2 :]}")


def strip(axes: Axes, card: Card, corner: np.ndarray) -> None:
    """The key poses side by side, each with its second below."""
    moments = [card.moment(frame) for frame in card.moments]
    reach = [extent([body for _, body in people], card.view) for people in moments]
    widths = [right - left for left, right in reach]
    total = sum(widths) + NECK * (len(widths) - 1)
    scale = min(SCALE, STRIP[2] / total)
    spare = (STRIP[2] - scale * total) / len(widths)
    floor = corner[1] + STRIP[3] - 0.16
    axes.plot([corner[0], corner[0] + STRIP[2]], [floor] * 2, color=style.HAIR, linewidth=0.8, zorder=2)
    x = corner[0] + spare / 2
    for frame, people, (left, right) in zip(card.moments, moments, reach, strict=True):
        bodies = [(body, ROLES[role % len(ROLES)]) for role, body in people]
        draw_people(axes, bodies, card.view, (x - scale * left, floor), (scale, -scale))
        middle = x + scale * (right - left) / 2
        axes.text(middle, floor + 0.13, f"{frame / FPS:.1f}", size=6.5, color=style.FAINT, ha="center", va="center",
                  zorder=6)  # fmt: skip
        x += scale * (right - left + NECK) + spare


def ground(axes: Axes, card: Card, corner: np.ndarray) -> None:
    """The paths from above, in the box whose upper left corner is given."""
    ways = [card.view.from_above(points) * [1, -1] for points, _ in card.paths]
    low, high = np.min([w.min(axis=0) for w in ways], axis=0), np.max([w.max(axis=0) for w in ways], axis=0)
    room = np.array(MAP[2:]) - 0.24
    scale = min(MAP_SCALE, *(room / np.maximum(high - low, 0.1)))
    origin = corner + np.array(MAP[2:]) / 2 - scale * (low + high) / 2
    box = FancyBboxPatch(
        tuple(corner), *MAP[2:], boxstyle="round,pad=0,rounding_size=0.05", facecolor="#f3f0e8", edgecolor="none",
        zorder=1.5,
    )  # fmt: skip
    axes.add_patch(box)
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
    axes.scatter(*way[seconds].T, s=5, color=style.FLOOR, edgecolor=style.mix(colour, style.INK, 0.4), linewidth=0.6,
                 zorder=4.2)  # fmt: skip
    headings = card.paths[role][1]
    axes.add_patch(Polygon(way[0] + tick(card.view, headings[0]), closed=False, fill=False, edgecolor=colour,
                           linewidth=1.1, zorder=4.3))  # fmt: skip
    axes.scatter(*way[0], s=16, facecolor=style.FLOOR, edgecolor=colour, linewidth=1.1, zorder=4.4)
    axes.add_patch(Polygon(way[-1] + arrowhead(card.view, headings[-1]), facecolor=colour,
                           edgecolor=style.FLOOR, linewidth=0.5, zorder=4.5))  # fmt: skip


def facing(view: View, heading: float) -> np.ndarray:
    """A heading on a map whose second figure grows downwards."""
    return np.asarray(view.from_above(np.array([np.sin(heading), np.cos(heading)])) * [1, -1])


def tick(view: View, heading: float) -> np.ndarray:
    """A short line that says where somebody faces, inches."""
    return np.array([0.0, 0.11])[:, None] * facing(view, heading)


def arrowhead(view: View, heading: float) -> np.ndarray:
    """An arrowhead that says where somebody faces, inches."""
    ahead = facing(view, heading)
    aside = np.array([-ahead[1], ahead[0]])
    return np.array([0.10 * ahead, -0.05 * ahead + 0.062 * aside, -0.02 * ahead, -0.05 * ahead - 0.062 * aside])


def words(axes: Axes, card: Card, corner: np.ndarray) -> None:
    """Ports, labels and faults, beside the map."""
    left, top = corner[0] + MAP[0] + MAP[2] + 0.14, corner[1] + MAP[1] + 0.07
    room = corner[0] + CARD[0] - 0.12 - left
    step = min(0.18, 0.62 / card.kind.people)
    for role, own in enumerate(card.kind.roles):
        y = top + role * step
        axes.scatter(left + 0.04, y, s=20, color=ROLES[role % len(ROLES)], zorder=6)
        fitted(axes, np.array([left + 0.14, y + 0.035]), f"{own.entry} → {own.exit}", room - 0.14, size=8,
               color=style.INK)  # fmt: skip
    lines = [(", ".join(card.kind.labels), style.FAINT)]
    if card.kind.contacts:
        touches = "1 touch" if card.kind.contacts == 1 else f"{card.kind.contacts} touches"
        lines.insert(0, (touches, style.FAINT))
    if card.fault:
        lines.append((card.fault, FAULT))
    y = top + step * card.kind.people + 0.10
    for text, colour in lines:
        for line in textwrap.wrap(text, 28)[:3]:
            axes.text(left, y, line, size=7, color=colour, va="center", zorder=6)
            y += 0.135
