"""The graph of a patch set's pose groups: where people pass from patch to patch, and where they cannot."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from itertools import permutations
from pathlib import Path as FilePath

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch
from matplotlib.path import Path

from crowdquilt._core import Connectivity, PatchSet, connectivity
from crowdquilt.plot import style
from crowdquilt.plot.figures import View, draw_people
from crowdquilt.plot.ports import typical

ALONE, TOGETHER, FAULT = style.INK, "#2d6fa3", "#c8443f"
ARROW = "#77736b"
BODY = to_rgb("#8d9aa6")
NODE = 0.74  # inches
APART = 3.1  # inches between neighbours
FIGURE = 0.50  # inches per metre
ORDERED = 7  # at most so many groups are put in the best order, by trying all


def groups(patches: PatchSet, path: str | FilePath | None = None, dpi: int = 150) -> Figure:
    """Draw the pose groups of a set and the kinds that lead from one to another; what is wrong is red.

    Saves to `path` if one is given (`.png`, `.svg`, `.pdf`), and returns the figure.
    """
    found = connectivity(patches)
    names = ordered([g for component in found.components for g in component.groups], found)
    places = around(len(names))
    if len(names):
        places = places - (places.max(axis=0) + places.min(axis=0)) / 2
    half = np.abs(places).max(axis=0, initial=0.0) + NODE + 0.85
    notes = notes_of(found)
    wide = max(2 * half[0], 8.2)
    rows = len(names) + 1
    foot = 0.4 + 0.26 * rows + 0.24 * len(notes) + 0.1
    tall = 1.0 + 2 * half[1] + foot
    page = style.new_figure(wide, tall)
    axes = page.add_axes((0, foot / tall, 1, 2 * half[1] / tall))
    axes.set(xlim=(-wide / 2, wide / 2), ylim=(-half[1], half[1]))
    axes.axis("off")
    where = dict(zip(names, places, strict=True))
    faulty = {g for c in found.components if not c.main for g in c.groups}
    links(axes, found, where, faulty)
    for name, place in where.items():
        node(axes, patches, name, place, name in faulty)
    headline(page, found)
    table(page, found, names, faulty, foot, notes)
    if path is not None:
        style.save(page, FilePath(path), dpi)
    return page


def headline(page: Figure, found: Connectivity) -> None:
    """Title, and what the arrows are."""
    state = "closed: everybody can go on from everywhere" if found.closed else "not closed"
    left = 0.45 / page.get_figwidth()
    style.heading(page, "Pose groups", f"This set is {state}", left)
    tall = page.get_figheight()
    right = 1 - left
    lines = (("kinds of one person, mirrored ones too", ALONE), ("+ roles among several people", TOGETHER))
    for row, (text, colour) in enumerate(lines):
        page.text(right, 1 - (0.44 + 0.22 * row) / tall, text, size=9.5, color=colour, ha="right", va="baseline")


def ordered(names: Sequence[str], found: Connectivity) -> list[str]:
    """The order around the circle in which arrows are short: groups with much to do with each other side by side."""
    if not 3 < len(names) <= ORDERED:
        return list(names)
    weights: dict[frozenset[str], int] = {}
    for link in found.links:
        pair = frozenset((link.entry, link.exit))
        weights[pair] = weights.get(pair, 0) + link.alone + link.together

    def length(order: Sequence[str]) -> float:
        at = {name: 2 * np.pi * i / len(order) for i, name in enumerate(order)}
        ends = [(sorted(pair), weight) for pair, weight in weights.items() if len(pair) == 2]
        return float(sum(weight * abs(np.sin((at[a] - at[b]) / 2)) for (a, b), weight in ends))

    first, *others = names
    orders = [[first, *order] for order in permutations(others)]
    return min(orders, key=length)


def around(count: int) -> np.ndarray:
    """(count, 2) places on a circle, the first at the top, clockwise; two lie side by side."""
    if count < 3:
        return np.array([[APART * (i - (count - 1) / 2), 0.0] for i in range(count)]).reshape(-1, 2)
    angles = np.pi / 2 - 2 * np.pi * np.arange(count) / count
    radius = APART / (2 * np.sin(np.pi / count))
    return np.asarray(radius * np.stack([np.cos(angles), np.sin(angles)], axis=1))


def node(axes: Axes, patches: PatchSet, name: str, place: np.ndarray, fault: bool) -> None:
    """A group: somebody in its pose, and its name."""
    edge = FAULT if fault else style.INK
    axes.add_patch(Circle((place[0], place[1]), NODE, facecolor=style.FLOOR, edgecolor=edge, linewidth=1.8, zorder=4))
    lines = textwrap.wrap(name.replace("_", " "), 11)[:2]
    found = typical(patches, name)
    if found is not None:
        feet = place + [0, -0.34 + 0.08 * (len(lines) - 1)]
        body, boxes = found
        draw_people(axes, [(body, BODY)], View.beside(np.radians(30)), feet, (FIGURE, FIGURE), zorder=6, boxes=boxes)
    for line, text in enumerate(lines):
        y = place[1] - 0.52 + 0.08 * (len(lines) - 1) - 0.135 * line
        axes.text(place[0], y, text, size=9.5, weight="bold", color=edge, ha="center", va="center", zorder=7)


def links(axes: Axes, found: Connectivity, where: dict[str, np.ndarray], faulty: set[str]) -> None:
    """All arrows; those into and out of traps are red, those that are missing are dashed."""
    for link in found.links:
        trap = link.entry != link.exit and bool({link.entry, link.exit} & faulty)
        colour = FAULT if trap else ARROW if link.alone else TOGETHER
        counts = [(str(link.alone), ALONE)] if link.alone else []
        counts += [(f"+{link.together}", TOGETHER)] if link.together else []
        width = 0.8 + 0.4 * float(np.log2(1 + link.alone + link.together))
        arrow(axes, where[link.entry], where[link.exit], colour, width, counts, dashed=not link.alone)
    for entry, exit_ in found.missing:
        arrow(axes, where[entry], where[exit_], FAULT, 1.6, [("missing", FAULT)], dashed=True, bend=0.3)


def arrow(
    axes: Axes,
    a: np.ndarray,
    b: np.ndarray,
    colour: str,
    width: float,
    counts: list[tuple[str, str]],
    dashed: bool,
    bend: float = 0.07,
) -> None:
    """An arrow from group to group, bent to its left so that both ways are seen, or a loop; counts in its middle."""
    if np.allclose(a, b):
        path, middle = loop(a)
    else:
        path, middle = bow(a, b, bend)
    axes.add_patch(
        FancyArrowPatch(
            path=path,
            arrowstyle=f"-|>,head_length={4 + width},head_width={2 + 0.6 * width}",
            color=colour,
            linewidth=width,
            linestyle=(0, (4, 2.4)) if dashed else "solid",
            capstyle="butt",
            joinstyle="miter",
            zorder=3,
        )
    )
    label(axes, middle, counts)


def bow(a: np.ndarray, b: np.ndarray, bend: float) -> tuple[Path, np.ndarray]:
    """A bent way from the edge of one node to that of another, and its middle."""
    way = b - a
    aside = np.array([way[1], -way[0]]) * bend
    control = (a + b) / 2 + 2 * aside
    towards = [(control - end) / np.linalg.norm(control - end) for end in (a, b)]
    ends = a + towards[0] * (NODE + 0.05), b + towards[1] * (NODE + 0.09)
    middle = 0.25 * ends[0] + 0.5 * control + 0.25 * ends[1]
    return Path([ends[0], control, ends[1]], [Path.MOVETO, Path.CURVE3, Path.CURVE3]), middle


def loop(at: np.ndarray) -> tuple[Path, np.ndarray]:
    """A loop on the side of a node that is away from the middle of the picture, and its far end."""
    distance = float(np.linalg.norm(at))
    out = at / distance if distance > 0.1 else np.array([0.0, 1.0])
    aside = np.array([-out[1], out[0]])
    sides = [np.cos(0.42) * out + sign * np.sin(0.42) * aside for sign in (1, -1)]
    ends = at + sides[0] * (NODE + 0.03), at + sides[1] * (NODE + 0.08)
    controls = [at + 1.95 * NODE * out + sign * 0.72 * NODE * aside for sign in (1, -1)]
    middle = (ends[0] + 3 * controls[0] + 3 * controls[1] + ends[1]) / 8
    return Path([ends[0], *controls, ends[1]], [Path.MOVETO, *[Path.CURVE4] * 3]), middle


def label(axes: Axes, place: np.ndarray, words: list[tuple[str, str]]) -> None:
    """Coloured words side by side, their middle at `place`, on a patch of paper."""
    texts = [
        axes.text(0, place[1], text, size=9.5, weight="bold", color=colour, va="center_baseline", zorder=5.2)
        for text, colour in words
    ]
    widths = [t.get_window_extent().width / axes.figure.dpi for t in texts]
    total = sum(widths) + 0.05 * (len(widths) - 1)
    x = place[0] - total / 2
    axes.plot(
        [x + 0.04, x + total - 0.04], [place[1]] * 2, color=style.PAPER, linewidth=15, solid_capstyle="round", zorder=5
    )
    for text, width in zip(texts, widths, strict=True):
        text.set_x(x)
        x += width + 0.05


def notes_of(found: Connectivity) -> list[str]:
    """The advice, in lines that fit the sheet."""
    lines = []
    for advice in found.advice:
        words = advice.split()
        line = "•"
        for word in words:
            if len(line) + len(word) > 100:
                lines.append(line)
                line = "  "
            line += f" {word}"
        lines.append(line)
    return lines


def figure(value: float, digits: int) -> str:
    """A rounded number; what is rounded to zero has no sign."""
    return f"{round(value, digits) + 0.0:.{digits}f}"


COLUMNS = {"alone from": 0.0, "turn": 1.75, "speed, m/s": 3.15, "time, s": 4.4, "ahead, m": 5.35, "left, m": 6.35}


def table(page: Figure, found: Connectivity, names: list[str], faulty: set[str], top: float, notes: list[str]) -> None:
    """Where one can go alone from each group, and below what to do about faults."""
    wide, tall = page.get_size_inches()
    left = max(0.45, (wide - 7.3) / 2)

    def put(column: int, y: float, text: str, colour: str) -> None:
        page.text((left + list(COLUMNS.values())[column]) / wide, y / tall, text, size=9, color=colour, va="center")

    y = top - 0.12
    for column, title in enumerate(COLUMNS):
        put(column, y, title, style.FAINT)
    by_name = {g.name: g for g in found.groups}
    for name in names:
        y -= 0.26
        colour = FAULT if name in faulty else style.INK
        put(0, y, name.replace("_", " "), colour)
        steering = by_name[name].steering
        if steering is None:
            put(1, y, "nowhere", FAULT)
            continue
        ranges = (steering.turn_deg, steering.speed, steering.secs, steering.ahead, steering.left)
        for column, (low, high) in enumerate(ranges):
            digits, unit = (0, "°") if column == 0 else (1, "")
            put(column + 1, y, f"{figure(low, digits)}{unit} to {figure(high, digits)}{unit}", colour)
    y -= 0.12
    for line in notes:
        y -= 0.24
        page.text(left / wide, y / tall, line, size=9, color=FAULT, va="center")
