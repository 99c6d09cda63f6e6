"""Motion patches: pieces of one or more people's motion with ports, cut out of takes."""

from crowdquilt._core import Kind, PatchSet, Role
from crowdquilt._core import cut_patches as cut

__all__ = ["Kind", "PatchSet", "Role", "cut"]
