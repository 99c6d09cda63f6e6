"""The kinds of a patch set as the contact sheet shows them: from which side, and at which moments."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from crowdquilt._core import Connectivity, Kind, PatchSet, kind_boxes
from crowdquilt.plot.figures import View, bodies_of

UNLIKE = 0.2  # metres, mean over the body: more than one step is from the next


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
        """Three to seven frames that tell what happens."""
        last = self.kind.frames - 1
        if self.kind.people == 1:
            wanted = np.linspace(0, last, int(np.clip(2 + round(last / 12), 3, 5))).round().astype(int).tolist()
        else:
            begin, end = self.core
            wanted = self.with_unlike([0, begin, (begin + end) // 2, end, last])
        chosen: list[int] = []
        for frame in wanted:
            if (not chosen or frame - chosen[-1] >= 4) and self.at(frame):
                chosen.append(frame)
        return chosen

    def with_unlike(self, chosen: list[int]) -> list[int]:
        """The chosen frames, and up to two of poses that none of them shows: somebody sits, or bends down."""
        away = np.min([self.poses_away(frame) for frame in chosen], axis=0)
        found = set(chosen)
        for _ in range(2):
            frame = int(away.argmax())
            if away[frame] > UNLIKE:
                found.add(frame)
                away = np.minimum(away, self.poses_away(frame))
        return sorted(found)

    def telling(self, frames: list[int]) -> list[float]:
        """How far the poses at every frame are from those at the most alike of the others, metres; of one alone, 1."""
        away = np.array([np.minimum(self.poses_away(frame)[frames], 1.0) for frame in frames])
        return [float(np.delete(row, k).min(initial=1.0)) for k, row in enumerate(away)]

    def poses_away(self, frame: int) -> np.ndarray:
        """(frames,) how far the poses at all frames are from those at one, metres; of who is there and differs most."""
        away = np.full(self.kind.frames, -np.inf)
        for role, own in enumerate(self.kind.roles):
            poses, here = self.poses[role], frame - own.begin
            if 0 <= here < own.frames:
                apart = np.linalg.norm(poses - poses[here], axis=-1).mean(axis=1)
                span = slice(own.begin, own.begin + own.frames)
                away[span] = np.maximum(away[span], apart)
        return np.where(np.isfinite(away), away, np.inf)

    @cached_property
    def poses(self) -> list[np.ndarray]:
        """Of every role: (frames, points, 3) the body seen from its place on the ground."""
        return [seen_from(body, *path) for body, path in zip(self.bodies, self.paths, strict=True)]


def seen_from(bodies: np.ndarray, points: np.ndarray, headings: np.ndarray) -> np.ndarray:
    """The ends of capsules (frames, capsules, 7) as their paths' frames see them: left, up, ahead."""
    ends = bodies[:, :, :6].reshape(len(bodies), -1, 3)
    x, z = ends[..., 0] - points[:, None, 0], ends[..., 2] - points[:, None, 1]
    sin, cos = np.sin(headings)[:, None], np.cos(headings)[:, None]
    return np.stack([x * cos - z * sin, ends[..., 1], x * sin + z * cos], axis=-1)


def cards(patches: PatchSet, found: Connectivity) -> list[Card]:
    """All kinds but mirrored copies: people alone first, then by number of people, then by their first label."""
    no_way_in, no_way_out = set(found.not_entered), set(found.not_left)

    def fault(name: str) -> str:
        ways = [("nobody comes here", name in no_way_in), ("nobody goes on", name in no_way_out)]
        return ", ".join(text for text, wrong in ways if wrong)

    made = [Card(patches, i, kind, fault(kind.name)) for i, kind in enumerate(patches.kinds) if not kind.mirrored]
    return sorted(made, key=lambda card: (card.kind.people, card.kind.labels[:1]))
