"""Who stands at the ports of a pose group: the body, and what is in its hands."""

from __future__ import annotations

import numpy as np

from crowdquilt._core import PatchSet, kind_boxes
from crowdquilt.plot.figures import bodies_of

PORTS = 40  # that are looked at for a typical pose
HANDS = [14, 15]  # capsules of a body
IN_HANDS = 0.35  # metres from the middle of both hands to the middle of a box
# A body, and the sizes and places of boxes.
Posed = tuple[np.ndarray, list[tuple[np.ndarray, np.ndarray]]]


def typical(patches: PatchSet, group: str) -> Posed | None:
    """The body of a group's most typical port and what it holds, standing at the origin and heading along z; where
    there are kinds of one person, of one of them. O(ports x capsules)."""
    ports = [
        (kind.people > 1, index, number, frame)
        for index, kind in enumerate(patches.kinds)
        for number, role in enumerate(kind.roles)
        for frame, at in ((0, role.entry), (-1, role.exit))
        if at == group and not kind.mirrored
    ]
    if not ports:
        return None
    fewest = min(port[0] for port in ports)
    found = [posed(patches, *port[1:]) for port in ports if port[0] == fewest][:PORTS]
    bodies = np.array([body for body, _ in found])
    apart = np.linalg.norm(bodies - np.median(bodies, axis=0), axis=(1, 2))
    return found[int(np.argmin(apart))]


def posed(patches: PatchSet, kind: int, role: int, frame: int) -> Posed:
    """A body moved to the origin and turned to head along z, and the boxes between its hands."""
    body = bodies_of(patches, kind, role)[frame].astype(float)
    heading = float(patches.path(kind, role)[1][frame])
    hips = body[0, [0, 2]].copy()

    def home(places: np.ndarray) -> np.ndarray:
        """Ground points seen from the body."""
        aside, ahead = (places - hips).T
        sin, cos = np.sin(heading), np.cos(heading)
        return np.stack([aside * cos - ahead * sin, aside * sin + ahead * cos], axis=-1)

    own = patches.kinds[kind].roles[role]
    clock = own.begin + (frame if frame >= 0 else own.frames + frame)
    held = []
    for size, begin, places in kind_boxes(patches, kind):
        if 0 <= clock - begin < len(places) and between_hands(body, places[clock - begin][:3]):
            x, y, z, turn = places[clock - begin].astype(float)
            (x, z), turn = home(np.array([[x, z]]))[0], turn - heading
            held.append((np.array(size), np.array([x, y, z, turn])))
    for ends in ([0, 2], [3, 5]):
        body[:, ends] = home(body[:, ends])
    return body, held


def between_hands(body: np.ndarray, place: np.ndarray) -> bool:
    """Whether the middle of a box is where both hands are."""
    hands = body[HANDS, 3:6].mean(axis=0)
    return bool(np.linalg.norm(place - hands) < IN_HANDS)
