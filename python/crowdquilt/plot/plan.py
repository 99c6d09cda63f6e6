"""The crowd from above at one moment: bodies, where they come from, and the patches they are in.

Seen from above, x points right and z points down the sheet: drawn with z upwards, everybody would be left-handed.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from crowdquilt._core import Crowd, Obstacle
from crowdquilt.plot import style
from crowdquilt.plot.lives import Lives, busiest, lives, together

TRAIL_SECS = 2.0
HULL_RADIUS = 0.34
HEAD = 3  # the head's place among the body's capsules


def plan(
    crowd: Crowd, path: str | Path | None = None, time: float | None = None, dpi: int = 160, tiles: int = 3
) -> Figure:
    """Draw the crowd from above at `time` seconds, by default when most people are together.

    A crowd whose ground repeats is drawn as a block of `tiles` by `tiles` tiles. Saves to `path` if one is given
    (`.png`, `.svg`, `.pdf`), and returns the figure.
    """
    who = lives(crowd)
    secs = busiest(crowd, who) if time is None else min(max(time, 0.0), crowd.seconds)
    told, seams = (crowd, who), np.zeros(2)
    low, high = crowd.region.min(axis=0), crowd.region.max(axis=0)
    repeats = np.array([axis in crowd.periodic for axis in "xz"])
    if tiles > 1 and repeats.any():
        seams, high = np.where(repeats, high - low, 0.0), high + np.where(repeats, (tiles - 1) * (high - low), 0.0)
        crowd = crowd.unrolled(tiles, tiles, 1)
        who = lives(crowd)
    width, depth = high - low
    inches = 9.0
    sheet = style.new_figure(inches + 1.0, inches * depth / width + 2.2)
    wide, tall = sheet.get_size_inches()
    axes = sheet.add_axes((0.5 / wide, 1.15 / tall, inches / wide, inches * depth / width / tall))
    margin = 0.002 * max(width, depth)  # half the wall's line
    axes.set(xlim=(low[0] - margin, high[0] + margin), ylim=(high[1] + margin, low[1] - margin), aspect="equal")
    axes.axis("off")
    ground(axes, crowd, secs)
    borders(axes, low, high, seams)
    kind_colours, palette = style.colours(crowd)
    hulls(axes, crowd, who, secs, kind_colours)
    now = person_colours(crowd, who, secs, kind_colours) | team_colours(crowd)
    trails(axes, crowd, secs, now)
    bodies(axes, crowd, secs, now)
    boxes(axes, crowd, secs)
    captions(sheet, *told, secs, palette)
    scale_bar(axes, high)
    if path is not None:
        style.save(sheet, Path(path), dpi)
    return sheet


def borders(axes: Axes, low: np.ndarray, high: np.ndarray, period: np.ndarray) -> None:
    """Lines where one tile goes on into the next."""
    dashed: dict[str, Any] = {"color": style.INK, "linewidth": 0.9, "linestyle": (0, (5, 4)), "zorder": 1.5}
    if period[0] > 0:
        for x in np.arange(low[0], high[0] + 0.5 * period[0], period[0]):
            axes.plot([x, x], [low[1], high[1]], **dashed)
    if period[1] > 0:
        for z in np.arange(low[1], high[1] + 0.5 * period[1], period[1]):
            axes.plot([low[0], high[0]], [z, z], **dashed)


def ground(axes: Axes, crowd: Crowd, secs: float) -> None:
    """Floor, metre grid, walls and obstacles."""
    region = Polygon(crowd.region, closed=True, facecolor=style.FLOOR, edgecolor="none", zorder=0)
    axes.add_patch(region)
    low, high = np.floor(crowd.region.min(axis=0)), np.ceil(crowd.region.max(axis=0))
    lines = [[(x, low[1]), (x, high[1])] for x in np.arange(low[0], high[0] + 1)]
    lines += [[(low[0], z), (high[0], z)] for z in np.arange(low[1], high[1] + 1)]
    grid = LineCollection(lines, colors=style.HAIR, linewidths=0.45, zorder=1)
    axes.add_collection(grid)
    grid.set_clip_path(region)
    axes.add_patch(Polygon(crowd.region, closed=True, fill=False, edgecolor=style.INK, linewidth=2.2, zorder=9))
    for obstacle in crowd.obstacles:
        outline, low_one = obstacle.at(secs), obstacle.height is not None
        floor = "#ece8dd" if low_one else "#d7d3c8"
        solid = Polygon(outline, closed=True, facecolor=floor, edgecolor=style.INK, linewidth=1.4, zorder=2)
        hatch = Polygon(
            outline, closed=True, fill=False, edgecolor="#b3aea0", linewidth=0, hatch=".." if low_one else "////",
            zorder=2.1,
        )  # fmt: skip
        axes.add_patch(solid)
        axes.add_patch(hatch)
        if obstacle.moves:
            course(axes, obstacle, secs)


def course(axes: Axes, obstacle: Obstacle, secs: float) -> None:
    """Where a moving obstacle comes from, and where it is in a second."""
    middles = np.array([obstacle.at(s).mean(axis=0) for s in np.linspace(max(secs - TRAIL_SECS, 0.0), secs, 20)])
    axes.plot(*middles.T, color=style.INK, linewidth=1.0, linestyle=(0, (2, 2)), zorder=2.2)
    ahead = obstacle.at(secs + 1.0).mean(axis=0)
    if np.hypot(*(ahead - middles[-1])) > 0.1:
        arrow = {"arrowstyle": "-|>", "color": style.INK, "linewidth": 1.2}
        axes.annotate("", ahead, middles[-1], arrowprops=arrow, zorder=2.3)


def hulls(axes: Axes, crowd: Crowd, who: Lives, secs: float, kind_colours: list[style.Colour]) -> None:
    """The ground that each patch of this moment covers over its whole time."""
    frame, kinds, instances = secs * crowd.fps, crowd.kinds, crowd.instances
    for instance, stretches in sorted(who.by_instance.items()):
        if not any(s.begin <= frame <= s.end for s in stretches):
            continue
        kind = instances[instance]
        outline = style.swept(np.concatenate([s.ground for s in stretches]), HULL_RADIUS)
        colour, company = kind_colours[kind], kinds[kind].people > 1
        hull = Polygon(
            outline,
            closed=True,
            facecolor=(*colour, 0.17 if company else 0.055),
            edgecolor=(*colour, 0.65 if company else 0.16),
            linewidth=1.0 if company else 0.6,
            zorder=3.5 if company else 3,
        )
        axes.add_patch(hull)


def person_colours(crowd: Crowd, who: Lives, secs: float, kind_colours: list[style.Colour]) -> dict[int, style.Colour]:
    """Everybody's colour at one moment: that of the patch they are in."""
    found = {}
    for person in range(len(crowd)):
        instance = who.instance_of(person, secs * crowd.fps)
        found[person] = style.ALONE if instance is None else kind_colours[crowd.instances[instance]]
    return found


def team_colours(crowd: Crowd) -> dict[int, style.Colour]:
    """The colours of those who are of a team: it tells more than the patch, which its hull shows anyway."""
    return {person: style.team(team) for person, team in enumerate(crowd.team_of) if team is not None}


def trails(axes: Axes, crowd: Crowd, secs: float, colours: dict[int, style.Colour]) -> None:
    """Where everybody came from, fading into the past."""
    segments, tints, widths = [], [], []
    now = int(secs * crowd.fps)
    for person, colour in colours.items():
        first, last = crowd.span(person)
        if not first <= now <= last:
            continue
        ground = crowd.roots(person)[:, [0, 2]][max(0, now - first - int(TRAIL_SECS * crowd.fps)) : now - first + 1]
        for i in range(len(ground) - 1):
            age = (len(ground) - 1 - i) / (TRAIL_SECS * crowd.fps)
            segments.append(ground[i : i + 2])
            tints.append((*style.mix(colour, style.INK, 0.15), 0.55 * (1 - age) ** 1.5))
            widths.append(0.6 + 1.9 * (1 - age))
    axes.add_collection(LineCollection(segments, colors=tints, linewidths=widths, capstyle="butt", zorder=4))


def bodies(axes: Axes, crowd: Crowd, secs: float, colours: dict[int, style.Colour]) -> None:
    """Everybody's body as its capsules seen from above, with a soft shadow and an outline."""
    people, capsules = crowd.capsules(secs)
    shapes, fills, shadows = [], [], []
    for person, body in zip(people, capsules, strict=True):
        colour = colours[int(person)]
        order = np.argsort(body[:, 1] + body[:, 4])
        shadows += [stadium(body[i], 0.05) + [0.035, 0.045] for i in order]
        shapes += [stadium(body[i], 0.022) for i in order]
        fills += [style.mix(colour, style.INK, 0.72)] * len(order)
        for i in order:
            height = np.clip((body[i, 1] + body[i, 4]) / 2 / 1.5, 0, 1)
            shapes.append(stadium(body[i], 0.0))
            dark = 0.52 if i == HEAD else 0.34 * (1 - height)
            fills.append(style.mix(colour, style.INK, float(dark)))
    axes.add_collection(PolyCollection(shadows, facecolors=(0.15, 0.14, 0.12, 0.045), edgecolors="none", zorder=5))
    axes.add_collection(PolyCollection(shapes, facecolors=fills, edgecolors="none", zorder=6))


def boxes(axes: Axes, crowd: Crowd, secs: float) -> None:
    """The boxes that people carry or that lie there, with their tape; those on the ground are under people."""
    props = crowd.props
    for number, (x, y, z, heading) in zip(*crowd.props_at(secs), strict=True):
        width, height, depth = props[int(number)].size
        left, ahead = np.array([np.cos(heading), -np.sin(heading)]), np.array([np.sin(heading), np.cos(heading)])
        layer = 5.5 if y < height else 6.5

        def corner(u: float, v: float) -> np.ndarray:
            place: np.ndarray = np.array([x, z]) + u * width / 2 * left + v * depth / 2 * ahead  # noqa: B023
            return place

        for across, colour in ((1.0, "#b68a5a"), (0.16, "#d9c7a3")):
            outline = [corner(1, across), corner(1, -across), corner(-1, -across), corner(-1, across)]
            edge = style.INK if across == 1.0 else "none"
            axes.add_patch(Polygon(outline, closed=True, facecolor=colour, edgecolor=edge, linewidth=0.7, zorder=layer))


def stadium(capsule: np.ndarray, grow: float, corners: int = 10) -> np.ndarray:
    """(2 corners, 2) outline of a capsule seen from above, its radius grown by `grow` metres."""
    a, b, radius = capsule[[0, 2]], capsule[[3, 5]], capsule[6] + grow
    along = np.arctan2(b[1] - a[1], b[0] - a[0])
    half = along + np.pi / 2 + np.linspace(0, np.pi, corners)
    cap = radius * np.stack([np.cos(half), np.sin(half)], axis=1)
    return np.concatenate([a + cap, b - cap])


def captions(sheet: Figure, crowd: Crowd, who: Lives, secs: float, palette: dict[str, style.Colour]) -> None:
    """Title, subtitle and legend."""
    frame, kinds = secs * crowd.fps, crowd.kinds
    people, _ = crowd.at(secs)
    company = together(crowd, who, frame)
    counts: dict[str, int] = dict.fromkeys(palette, 0)
    for person in people:
        instance = who.instance_of(int(person), frame)
        if instance is not None and kinds[crowd.instances[instance]].people > 1:
            counts[style.activity(kinds[crowd.instances[instance]])] += 1
    left = 0.5 / sheet.get_figwidth()
    subtitle = f"Seen from above at {secs:.1f} s of {crowd.seconds:.0f} s   ·   {company} of them in company"
    style.heading(sheet, f"{len(people)} people on {style.metres(crowd)}", subtitle, left)
    entries = [(f"{name} {counts[name]}", colour) for name, colour in palette.items() if counts[name]]
    alone = (f"alone {len(people) - company}", style.ALONE)
    style.legend(sheet, [*team_entries(crowd, people), *entries, alone], left, 1 - left)


def team_entries(crowd: Crowd, people: np.ndarray) -> list[tuple[str, style.Colour]]:
    """How many of each team are there."""
    team_of = crowd.team_of
    teams = [team_of[int(person)] for person in people]
    return [(f"{name} {teams.count(i)}", style.team(i)) for i, name in enumerate(crowd.teams)]


def scale_bar(axes: Axes, corner: np.ndarray) -> None:
    """One metre, under the lower right corner of the floor."""
    x, z = corner
    below = z + 0.016 * np.ptp(axes.get_xlim())
    axes.plot([x - 1, x], [below, below], color=style.INK, linewidth=1.6, clip_on=False, zorder=10)
    axes.annotate(
        "1 m", (x - 0.5, below), xytext=(0, -5), textcoords="offset points", size=9.5, color=style.INK,
        ha="center", va="top", annotation_clip=False,
    )  # fmt: skip
