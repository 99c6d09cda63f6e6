"""Motion patches: pieces of one or more people's motion with ports, cut out of captures."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike

from crowdquilt._core import (
    Component,
    Connectivity,
    GroupLinks,
    Kind,
    Link,
    Made,
    Measures,
    PatchSet,
    Role,
    Steering,
    Take,
    connectivity,
)
from crowdquilt._core import kind_boxes as boxes
from crowdquilt._core import kind_capsules as capsules
from crowdquilt._core import kind_measures as measures
from crowdquilt._core import kind_positions as positions
from crowdquilt._core import make_patches as make

__all__ = [
    "Component",
    "Connectivity",
    "GroupLinks",
    "Kind",
    "Link",
    "Made",
    "Measures",
    "PatchSet",
    "Role",
    "Steering",
    "Take",
    "boxes",
    "capsules",
    "connectivity",
    "cut",
    "make",
    "measures",
    "positions",
]


AnyPath = str | PathLike[str]


def cut(source: AnyPath | Sequence[AnyPath], captures: AnyPath | None = None, *, study: bool = True) -> PatchSet:
    """Make the patch set of captures; see `make`, which also tells how it came about."""
    return make(source, captures, study=study).set
