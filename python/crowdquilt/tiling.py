"""Tiling: patches placed, deformed and stitched until a scene has no loose end."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from crowdquilt._core import Checkpoint, CrowdquiltError, Kind, Outcome, PatchSet, Progress, Scene, review, tile

__all__ = ["Checkpoint", "Outcome", "Progress", "Scene", "prefer", "review", "tile"]

Array = np.ndarray
Sigmas = tuple[float, float, float, float]


def prefer(
    scene: Scene,
    patches: PatchSet,
    *,
    position: Callable[[Array], Array] | None = None,
    direction: Callable[[Array, Array], Array] | None = None,
    time: Callable[[Array], Array] | None = None,
    kind: Callable[[list[Kind]], Array] | None = None,
    sigma: Sigmas = (1.0, 1.0, 1.0, 1.0),
    cell: float = 0.25,
    headings: int = 16,
) -> Scene:
    """The scene with wishes of your own: F = exp(-f1/s1) exp(-f2/s2) exp(-f3/s3) exp(-f4/s4), equation 7 of the paper.

    Every f takes arrays and returns one array of numbers from 0 (wanted) on; each is called once, here: f1 with (n, 2)
    places on the ground `cell` metres apart, f2 with such places and (n,) headings in radians, f3 with (n,) times in
    seconds, f4 with the kinds of `patches`. What the scene prefers already stays.

    >>> plaza = prefer(Scene.demo(), patches, position=lambda p: ((p - 6.0) ** 2).sum(axis=1), sigma=(4.0, 1, 1, 1))
    """
    columns, places = scene.nodes(cell)
    if position is not None:
        table = values("position", position(places), len(places))
        scene = scene.with_table(table.reshape(-1, columns), step=cell, sigma=sigma[0])
    if direction is not None:
        angles = np.arange(headings, dtype=np.float32) * np.float32(2 * np.pi / headings)
        everywhere, every = np.tile(places, (headings, 1)), np.repeat(angles, len(places))
        table = values("direction", direction(everywhere, every), len(every))
        scene = scene.with_table(table.reshape(headings, -1, columns), step=cell, sigma=sigma[1])
    if time is not None:
        step = 1 / 30
        secs = np.arange(int(scene.duration_secs / step) + 2, dtype=np.float32) * np.float32(step)
        scene = scene.with_table(values("time", time(secs), len(secs)), step=step, sigma=sigma[2])
    if kind is not None:
        kinds = patches.kinds
        table = values("kind", kind(kinds), len(kinds))
        pairs = [(k.name, float(v)) for k, v in zip(kinds, table, strict=True)]
        scene = scene.with_table(pairs, sigma=sigma[3])
    return scene


def values(name: str, found: Array, count: int) -> Array:
    """What a function answered as so many numbers, or a message that names it."""
    table = np.ascontiguousarray(np.broadcast_to(np.asarray(found, dtype=np.float32), (count,)))
    if not (np.isfinite(table).all() and (table >= 0).all()):
        worst = table[~(np.isfinite(table) & (table >= 0))][0]
        raise CrowdquiltError(f"preference: {name}: expected numbers that are finite and not negative, found {worst}")
    return table
