"""Motion patches: pieces of one or more people's motion with ports, cut out of captures."""

from __future__ import annotations

from os import PathLike

from crowdquilt._core import Kind, Made, PatchSet, Role, Take
from crowdquilt._core import make_patches as make

__all__ = ["Kind", "Made", "PatchSet", "Role", "Take", "cut", "make"]


def cut(source: str | PathLike[str], captures: str | PathLike[str] | None = None) -> PatchSet:
    """Make the patch set of captures; see `make`, which also tells how it came about."""
    return make(source, captures).set
