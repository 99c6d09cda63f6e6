"""Motion patches: pieces of one or more people's motion with ports, cut out of takes."""

from crowdquilt._core import Component, Connectivity, GroupLinks, Kind, Link, PatchSet, Role, Steering, connectivity
from crowdquilt._core import cut_patches as cut
from crowdquilt._core import kind_capsules as capsules
from crowdquilt._core import kind_positions as positions

__all__ = [
    "Component",
    "Connectivity",
    "GroupLinks",
    "Kind",
    "Link",
    "PatchSet",
    "Role",
    "Steering",
    "capsules",
    "connectivity",
    "cut",
    "positions",
]
