"""Why something is an event: what was measured in captures, the thresholds, and what was found."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crowdquilt._core import Made, TakeSignals
from crowdquilt.plot import style

FPS = 30.0
FAR = 0.3  # metres beyond which gaps are not told apart
KINDS = {"contact": style.TOGETHER[0], "proximity": style.TOGETHER[2], "synchronicity": style.TOGETHER[1]}
QUIET = "#b9bbb8"
ROW = 0.17  # inches
LEAST = 1e-3  # variations and ratios below are drawn here
ROWS = 40  # takes that are listed at most


def events(made: Made, path: str | Path | None = None, dpi: int = 150) -> Figure:
    """Draw how events were told in the takes that nobody had annotated.

    Above, the distributions of what is measured at every frame, with the thresholds that were chosen and the frames
    that lie within something found; below, when what was found. Saves to `path` if one is given, and returns the
    figure.
    """
    takes = made.signals()
    shared = [take for take in takes if take.pairs]
    rows = min(len(shared), ROWS)
    foot = 0.7 + ROW * max(rows, 2)
    page = style.new_figure(11.0, 6.35 + foot)
    tall = page.get_figheight()
    counts = {kind: sum(sign[0] == kind for take in takes for sign in take.signs) for kind in KINDS}
    told = ", ".join(f"{count} × {kind}" for kind, count in counts.items())
    looked = f"{len(takes)} takes nobody annotated, {len(shared)} of several people: {told}"
    style.heading(page, "What makes an event", looked)

    def place(column: int, row: int) -> Axes:
        axes = page.add_axes((0.07 + 0.49 * column, (foot + 0.5 + 2.6 * (1 - row)) / tall, 0.42, 2.0 / tall))
        dress(axes)
        return axes

    limits = made.thresholds
    draw_gaps(place(0, 0), shared, limits.get("touch_gap", 0.0))
    draw_variation(place(1, 0), takes, limits)
    draw_proximity(place(0, 1), shared, limits.get("near", 0.0))
    draw_synchronicity(place(1, 1), shared)
    draw_times(page.add_axes((0.16, 0.35 / tall, 0.82, ROW * max(rows, 2) / tall)), shared[:ROWS], len(shared))
    if path is not None:
        style.save(page, Path(path), dpi)
    return page


def within(take: TakeSignals, pair: tuple[int, int], kind: str, frames: int) -> np.ndarray:
    """(frames,) whether a sign of a kind between two people holds."""
    held = np.zeros(frames, dtype=bool)
    for of, people, begin, end in take.signs:
        if of == kind and tuple(people) == tuple(pair):
            held[begin : end + 1] = True
    return held


def gathered(takes: list[TakeSignals], name: str, kind: str) -> tuple[np.ndarray, np.ndarray]:
    """A signal of all pairs at all frames, and whether a sign of a kind holds there."""
    values = [np.asarray(getattr(pair, name)) for take in takes for pair in take.pairs]
    held = [within(take, pair.people, kind, len(pair.gap)) for take in takes for pair in take.pairs]
    return np.concatenate([*values, np.empty(0)]), np.concatenate([*held, np.empty(0, dtype=bool)])


def draw_gaps(axes: Axes, takes: list[TakeSignals], limit: float) -> None:
    """How near bodies are to each other: below the threshold they touch."""
    gaps, held = gathered(takes, "gap", "contact")
    title(axes, "Contact: gap between two bodies' surfaces, cm; grey below: they slide past")
    near = gaps < FAR - 1e-6
    if not near.any():
        return nothing(axes, "nobody comes within 30 cm of anybody")
    bins = np.linspace(min(-10, 100 * gaps[near].min()), 100 * FAR, 56).tolist()
    axes.hist([100 * gaps[near & held], 100 * gaps[near & ~held]], bins, stacked=True, color=[KINDS["contact"], QUIET])
    mark(axes, 100 * limit, f"touch below {100 * limit:.0f} cm")
    axes.set_ylabel("frames", size=8.5, color=style.FAINT)
    return None


def draw_variation(axes: Axes, takes: list[TakeSignals], limits: dict[str, float]) -> None:
    """How much people move within half a second: those who stay in place, and those who travel."""
    title(axes, "Acting: variation of a person's pose within half a second (eq. 4), m²")
    variation = np.concatenate([*(v for take in takes for v in take.variation), np.empty(0)])
    travels = np.concatenate([*(t for take in takes for t in take.travels), np.empty(0, dtype=bool)])
    if not len(variation):
        return nothing(axes, "no take was looked at")
    shown = np.maximum(variation, LEAST)
    bins = np.geomspace(LEAST, max(shown.max(), 10.0) * 1.01, 64)
    sides = (("in_place", ~travels, "#8659a3", "in place"), ("travelling", travels, "#4f8f54", "travelling"))
    for row, (name, chosen, colour, words) in enumerate(sides):
        if not chosen.any():
            continue
        limit = limits[name]
        counts, _ = np.histogram(shown[chosen], bins)
        shares = counts / counts.max()
        axes.stairs(shares, bins, fill=True, color=style.mix(colour, style.FLOOR, 0.72), alpha=0.8)
        axes.stairs(np.where(bins[1:] > limit, shares, np.nan), bins, fill=True, color=colour, alpha=0.75)
        axes.set_xscale("log")
        axes.set_xlim(bins[0], bins[-1])
        mark(axes, limit, f"{words}: acts above {limit:.2g}", colour, 0.96 - 0.1 * row)
    axes.set_ylim(0, 1.35)
    axes.set_yticks([])
    axes.set_ylabel("share of frames", size=8.5, color=style.FAINT)
    return None


def draw_proximity(axes: Axes, takes: list[TakeSignals], near: float) -> None:
    """How far people are apart, and how strongly the one acts who acts more."""
    apart, held = gathered(takes, "apart", "proximity")
    reaction, _ = gathered(takes, "reaction", "proximity")
    title(axes, "Proximity: distance of the hips, m, and reaction, × threshold of acting")
    if not len(apart):
        return nothing(axes, "no take of two people")
    far = max(4.0, 2.5 * near)
    # Who is even farther apart tells nothing; many dots are thinned alike.
    chosen = np.flatnonzero(apart < far)
    chosen = chosen[:: max(1, len(chosen) // 9000)]
    strength = np.maximum(reaction, LEAST)
    for of, colour, order in ((~held, QUIET, 2), (held, KINDS["proximity"], 3)):
        dots = chosen[of[chosen]]
        axes.scatter(apart[dots], strength[dots], s=3, color=colour, linewidths=0, zorder=order, rasterized=True)
    axes.set_yscale("log")
    axes.set_xlim(0, far)
    axes.axhline(1.0, color=style.INK, lw=1.1, zorder=4)
    mark(axes, near, f"near below {near:.2g} m")
    axes.set_ylabel("reaction", size=8.5, color=style.FAINT)
    return None


def draw_synchronicity(axes: Axes, takes: list[TakeSignals]) -> None:
    """How much two people act at once, in view of each other."""
    values, held = gathered(takes, "synchronicity", "synchronicity")
    title(axes, "Synchronicity with gaze (eq. 5), × threshold")
    acting = values > 0
    if not acting.any():
        return nothing(axes, "never do two people act at once in sight of each other")
    shown = np.maximum(values, LEAST)
    bins = np.geomspace(LEAST, max(shown.max(), 10.0) * 1.01, 56).tolist()
    colours = [KINDS["synchronicity"], QUIET]
    axes.hist([shown[acting & held], shown[acting & ~held]], bins, stacked=True, color=colours)
    axes.set_xscale("log")
    mark(axes, 1.0, "together above 1")
    rest = f"at {np.mean(~acting):.0%} of {len(values)} frames\nnot both act"
    axes.text(0.02, 0.93, rest, size=8, color=style.FAINT, transform=axes.transAxes, va="top")
    axes.set_ylabel("frames", size=8.5, color=style.FAINT)
    return None


def draw_times(axes: Axes, takes: list[TakeSignals], count: int) -> None:
    """A line for every take of several people: when what was found."""
    dress(axes)
    if not takes:
        return nothing(axes, "no take of several people")
    for row, take in enumerate(takes):
        last = max((len(v) for v in take.variation), default=0) / FPS
        axes.plot([0, last], [row, row], color=style.HAIR, lw=1.0, zorder=1)
        for rank, kind in enumerate(KINDS):
            spans = [(b / FPS, (e - b + 1) / FPS) for of, _, b, e in take.signs if of == kind]
            axes.broken_barh(spans, (row - 0.36 + 0.24 * rank, 0.24), color=KINDS[kind], zorder=2)
    axes.set_yticks(range(len(takes)), [take.name for take in takes])
    axes.set_ylim(len(takes) - 0.4, -0.6)
    axes.set_xlim(left=0)
    axes.grid(axis="y", visible=False)
    more = f"; {count - len(takes)} more takes are not shown" if count > len(takes) else ""
    axes.set_title(f"What was found, seconds{more}", loc="left", size=9.5, color=style.INK)
    for x, (kind, colour) in zip((0.76, 0.87, 1.0), KINDS.items(), strict=True):
        axes.annotate(kind, (x, 1), xytext=(0, 5), xycoords="axes fraction", textcoords="offset points",
                      ha="right", size=9, color=colour, weight="bold")  # fmt: skip
    return None


def mark(axes: Axes, limit: float, words: str, colour: str = style.INK, height: float = 0.94) -> None:
    """A threshold: a line, and what it says beside it."""
    axes.axvline(limit, color=colour, lw=1.1, zorder=4)
    right = axes.transLimits.transform(axes.transScale.transform((limit, 1.0)))[0] < 0.6
    axes.annotate(words, (limit, height), xycoords=("data", "axes fraction"), xytext=(4 if right else -4, 0),
                  textcoords="offset points", size=8.5, color=colour, va="top", ha="left" if right else "right",
                  zorder=5)  # fmt: skip


def nothing(axes: Axes, why: str) -> None:
    """Why there is nothing to draw."""
    axes.text(0.5, 0.5, why, size=10, color=style.FAINT, ha="center", va="center", transform=axes.transAxes)
    axes.set_xticks([])
    axes.set_yticks([])


def title(axes: Axes, text: str) -> None:
    """The line above a panel."""
    axes.set_title(text, loc="left", size=9.5, color=style.INK)


def dress(axes: Axes) -> None:
    """The look of the axes."""
    axes.set_facecolor(style.FLOOR)
    axes.grid(color=style.HAIR, lw=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(colors=style.FAINT, labelsize=8.5, length=0)
    for side in axes.spines.values():
        side.set_color(style.HAIR)
