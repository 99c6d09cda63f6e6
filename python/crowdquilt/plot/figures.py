"""People as small figures seen from the side: bodies as capsules, limb by limb from back to front."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb

from crowdquilt._core import PatchSet, kind_capsules, kind_positions
from crowdquilt.plot.style import INK, Colour, mix

# The capsules of a body by limb: neck, trunk and head, then legs, then arms. The neck is added here.
LIMBS = ([16, 0, 1, 2, 3], [4, 6, 8], [5, 7, 9], [10, 12, 14], [11, 13, 15])
HEAD = 3
SHOULDERS = 2
HEAD_JOINT = 13
NECK_RADIUS = 0.052
BOARD = to_rgb("#b68a5a")
OUTLINE = 0.022
PITCH = np.radians(7)
TURNED = np.radians(24)  # away from straight from the side


@dataclass(frozen=True)
class View:
    """A far eye, a little above the people. `across` is the ground direction (x, z) that points right on the sheet."""

    across: np.ndarray

    @staticmethod
    def beside(heading: float) -> View:
        """Somebody of this heading goes to the right on the sheet, and a little towards the eye."""
        return View.along(np.array([np.sin(heading), np.cos(heading)]))

    @staticmethod
    def along(line: np.ndarray) -> View:
        """The line goes to the right on the sheet, and a little towards the eye."""
        x, z = line / max(float(np.hypot(*line)), 1e-9)
        return View(np.array([x * np.cos(TURNED) + z * np.sin(TURNED), z * np.cos(TURNED) - x * np.sin(TURNED)]))

    @property
    def near(self) -> np.ndarray:
        """The ground direction towards the eye."""
        x, z = self.across
        return np.array([-z, x])

    def from_above(self, ground: np.ndarray) -> np.ndarray:
        """(n, 2) ground points on a map whose lower edge is where the eye is; the second figure grows upwards."""
        return np.stack([ground @ self.across, -(ground @ self.near)], axis=-1)

    def project(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points (..., 3) as places (..., 2) on the sheet, metres, and depths (...,), larger is nearer."""
        ground, up = points[..., [0, 2]], points[..., 1]
        near = ground @ self.near
        places = np.stack([ground @ self.across, up * np.cos(PITCH) - near * np.sin(PITCH)], axis=-1)
        return places, near * np.cos(PITCH) + up * np.sin(PITCH)


@dataclass(frozen=True)
class Painted:
    """Polygons on the sheet with their fills, in order; and how near they are."""

    near: float
    polygons: list[np.ndarray]
    fills: list[Colour]


def bodies_of(patches: PatchSet, kind: int, role: int) -> np.ndarray:
    """(frames, capsules, 7) the capsules of a role's body, a neck included."""
    capsules = kind_capsules(patches, kind, role)
    joints = kind_positions(patches, kind, role)
    chest = (capsules[:, SHOULDERS, :3] + capsules[:, SHOULDERS, 3:6]) / 2
    neck = np.concatenate([chest, joints[:, HEAD_JOINT], np.full((len(joints), 1), NECK_RADIUS)], axis=1)
    return np.concatenate([capsules, neck[:, None]], axis=1)


def stadiums(ends: np.ndarray, radii: np.ndarray, corners: int = 9) -> np.ndarray:
    """(n, 2 corners, 2) outlines of capsules whose ends (n, 2, 2) are on the sheet."""
    a, b = ends[:, 0], ends[:, 1]
    along = np.arctan2(*(b - a).T[::-1])
    half = along[:, None] + np.pi / 2 + np.linspace(0, np.pi, corners)
    cap = radii[:, None, None] * np.stack([np.cos(half), np.sin(half)], axis=-1)
    return np.concatenate([a[:, None] + cap, b[:, None] - cap], axis=1)


def limbs(body: np.ndarray, view: View, colour: Colour) -> list[Painted]:
    """What to fill, limb by limb, to paint one body (capsules, 7), in metres on the sheet."""
    ends, depths = view.project(body[:, :6].reshape(-1, 2, 3))
    edge = mix(colour, INK, 0.8)
    outlines, bodies = (stadiums(ends, body[:, 6] + grow) for grow in (OUTLINE, 0.0))
    near = depths.mean(axis=1)
    painted = []
    for limb in LIMBS:
        depth = float(near[limb].mean())
        # What is behind the middle of the body is in its shade.
        shade = 0.30 * float(np.clip((near.mean() - depth) / 0.25, 0, 1))
        tones = [mix(colour, "white", 0.32 if i in (HEAD, len(body) - 1) else 0.0) for i in limb]
        fills = [edge] * len(limb) + [mix(tone, INK, shade) for tone in tones]
        painted.append(Painted(depth, [*outlines[limb], *bodies[limb]], fills))
    return painted


def box_faces(size: np.ndarray, place: np.ndarray, view: View) -> Painted:
    """The faces of a level box that are seen; `place` is its middle x, y, z and its heading."""
    sin, cos = np.sin(place[3]), np.cos(place[3])
    # To its left, up, and ahead.
    axes = np.array([[cos, 0, -sin], [0, 1, 0], [sin, 0, cos]]) * size[:, None] / 2
    found = []
    for k in range(3):
        out, a, b = axes[k], axes[(k + 1) % 3], axes[(k + 2) % 3]
        for sign in (1.0, -1.0):
            corners = place[:3] + sign * out + np.array([a + b, a - b, -a - b, -a + b])
            places, depths = view.project(corners)
            if view.project(sign * out)[1] > 0:
                found.append((float(depths.mean()), places, mix(BOARD, INK, 0.0 if k == 1 else 0.18)))
    found.sort(key=lambda face: face[0])
    middle = float(view.project(place[:3])[1])
    outline = [places + OUTLINE * np.sign(places - places.mean(axis=0)) for _, places, _ in found]
    edges = [mix(BOARD, INK, 0.8)] * len(found)
    return Painted(middle, [*outline, *(face[1] for face in found)], [*edges, *(face[2] for face in found)])


def draw_people(
    axes: Axes,
    bodies: list[tuple[np.ndarray, Colour]],
    view: View,
    place: Any,
    scale: Any,
    zorder: float = 5,
    boxes: Sequence[tuple[np.ndarray, np.ndarray]] = (),
) -> None:
    """Paint bodies and their shadows, and boxes (sizes and places), the farthest first.

    `place` is where the origin is, `scale` how many of the axes' units are a metre to the right and upwards.
    """
    place, scale = np.asarray(place), np.asarray(scale)
    painted = [limb for body, colour in bodies for limb in limbs(body, view, colour)]
    painted += [box_faces(size, at, view) for size, at in boxes]
    painted.sort(key=lambda p: p.near)
    shade = (0.15, 0.14, 0.12, 0.13)
    shadows = [place + scale * spot(body, view) for body, _ in bodies]
    axes.add_collection(PolyCollection(shadows, facecolors=shade, edgecolors="none", zorder=zorder - 1))
    polygons = [place + scale * polygon for p in painted for polygon in p.polygons]
    fills = [fill for p in painted for fill in p.fills]
    axes.add_collection(PolyCollection(polygons, facecolors=fills, edgecolors="none", zorder=zorder))


def spot(body: np.ndarray, view: View) -> np.ndarray:
    """The outline of the shadow under a body: a flat ellipse about what is lowest."""
    ends = body[:, :6].reshape(-1, 3)
    lowest = ends[ends[:, 1] < ends[:, 1].min() + 0.25]
    middle = lowest.mean(axis=0) * [1, 0, 1]
    wide = 0.2 + 0.5 * float(np.ptp(lowest[:, [0, 2]] @ view.across))
    turn = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    ellipse = np.stack([wide * np.cos(turn), 0.07 * np.sin(turn)], axis=-1)
    return np.asarray(view.project(middle)[0] + ellipse)


def extent(
    bodies: list[np.ndarray], view: View, boxes: Sequence[tuple[np.ndarray, np.ndarray]] = ()
) -> tuple[np.ndarray, np.ndarray]:
    """The lower left and the upper right corner of some bodies and boxes on the sheet, metres."""
    all_of = np.concatenate(bodies)
    ends, _ = view.project(all_of[:, :6].reshape(-1, 2, 3))
    reach = (all_of[:, 6] + OUTLINE)[:, None, None]
    corners = [(ends - reach).reshape(-1, 2), (ends + reach).reshape(-1, 2)]
    corners += [polygon for size, place in boxes for polygon in box_faces(size, place, view).polygons]
    points = np.concatenate(corners)
    return points.min(axis=0), points.max(axis=0)
