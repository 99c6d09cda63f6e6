"""Who is in which patch when: the fragments of a crowd, looked up by person and by instance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crowdquilt._core import Crowd


@dataclass(frozen=True)
class Stretch:
    """A person's way through one instance: (n, 2) ground points, one per frame from `begin` to `end`."""

    person: int
    instance: int
    begin: int
    end: int
    ground: np.ndarray

    def at(self, frame: float) -> np.ndarray:
        """The ground point at a frame, held at the ends."""
        index = int(np.clip(round(frame) - self.begin, 0, len(self.ground) - 1))
        return np.asarray(self.ground[index])


@dataclass(frozen=True)
class Lives:
    """All stretches of a crowd, within the time the crowd lives."""

    by_person: list[list[Stretch]]
    by_instance: dict[int, list[Stretch]]

    def instance_of(self, person: int, frame: float) -> int | None:
        """The instance a person is in at a frame."""
        for stretch in self.by_person[person]:
            if stretch.begin <= frame <= stretch.end:
                return stretch.instance
        return None


def lives(crowd: Crowd) -> Lives:
    """Follow everybody through the instances."""
    by_person: list[list[Stretch]] = []
    by_instance: dict[int, list[Stretch]] = {}
    for person in range(len(crowd)):
        first, last = crowd.span(person)
        ground = crowd.roots(person)[:, [0, 2]]
        mine = []
        for fragment in crowd.fragments(person):
            begin, end = max(fragment.begin, first), min(fragment.end, last)
            if end > begin:
                way = ground[begin - first : end - first + 1]
                mine.append(Stretch(person, fragment.instance, begin, end, way))
        by_person.append(mine)
        for stretch in mine:
            by_instance.setdefault(stretch.instance, []).append(stretch)
    return Lives(by_person, by_instance)


def together(crowd: Crowd, who: Lives, frame: float) -> int:
    """How many people are in patches of two or more at a frame."""
    kinds, instances = crowd.kinds, crowd.instances
    now = (who.instance_of(person, frame) for person in range(len(crowd)))
    return sum(1 for instance in now if instance is not None and kinds[instances[instance]].people > 1)


def busiest(crowd: Crowd, who: Lives) -> float:
    """The moment, in seconds, at which the most people are together; whole half seconds, off the ends."""
    times = np.arange(1.0, max(crowd.seconds - 1.0, 1.25), 0.5)
    return float(max(times, key=lambda secs: together(crowd, who, secs * crowd.fps)))
