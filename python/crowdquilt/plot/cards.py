"""The kinds of a patch set as the contact sheet shows them: from which side, and at which moments."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from crowdquilt._core import Connectivity, Kind, PatchSet, kind_boxes
from crowdquilt.plot.figures import View, bodies_of


@dataclass
class Card:
    """One kind of a set, with its people's bodies (frames, capsules, 7), paths and headings."""

    patches: PatchSet
    index: int
    kind: Kind
    fault: str

    @cached_property
    def bodies(self) -> list[np.ndarray]:
        """Of every role: (frames, capsules, 7)."""
        return [bodies_of(self.patches, self.index, role) for role in range(self.kind.people)]

    @cached_property
    def paths(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Of every role: ground points and headings."""
        return [self.patches.path(self.index, role) for role in range(self.kind.people)]

    def at(self, frame: int) -> list[tuple[int, np.ndarray]]:
        """Who is there at a frame of the kind's clock: roles and bodies."""
        own = [(role, frame - r.begin) for role, r in enumerate(self.kind.roles)]
        return [(role, self.bodies[role][f]) for role, f in own if 0 <= f < self.kind.roles[role].frames]

    @cached_property
    def boxes(self) -> list[tuple[np.ndarray, int, np.ndarray]]:
        """Of every box: size, first frame, places (frames, 4)."""
        return [(np.array(size), begin, places) for size, begin, places in kind_boxes(self.patches, self.index)]

    def moment(self, frame: int) -> tuple[list[tuple[int, np.ndarray]], list[tuple[np.ndarray, np.ndarray]]]:
        """The same and the boxes (sizes and places), with the middle of the people at the origin."""
        people = self.at(frame)
        middle = np.mean([body[0, [0, 2]] for _, body in people], axis=0)
        shift = np.array([middle[0], 0, middle[1]] * 2 + [0])
        there = [
            (size, places[frame - begin]) for size, begin, places in self.boxes if 0 <= frame - begin < len(places)
        ]
        aside = np.array([middle[0], 0, middle[1], 0])
        return [(role, body - shift) for role, body in people], [(size, place - aside) for size, place in there]

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
    """All kinds but mirrored copies: people alone first, then by number of people, then by their first label."""
    no_way_in, no_way_out = set(found.not_entered), set(found.not_left)

    def fault(name: str) -> str:
        ways = [("nobody comes here", name in no_way_in), ("nobody goes on", name in no_way_out)]
        return ", ".join(text for text, wrong in ways if wrong)

    made = [Card(patches, i, kind, fault(kind.name)) for i, kind in enumerate(patches.kinds) if not kind.mirrored]
    return sorted(made, key=lambda card: (card.kind.people, card.kind.labels[:1]))
