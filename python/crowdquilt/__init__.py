"""Crowdquilt stitches motion capture into crowds.

The modules are the stages of the pipeline, named like those of the Rust core::

    samples -> motion -> patch -> tiling (refine) -> stage -> check, export
                                  world           -> stage -> check

Metres, seconds, radians; right-handed, y up, the ground is the xz plane. Motion runs at 30 frames per second.
"""

from crowdquilt import check, export, motion, patch, refine, samples, stage, tiling, world
from crowdquilt._core import (
    Clip,
    Crowd,
    CrowdquiltError,
    Fragment,
    Kind,
    Obstacle,
    Outcome,
    PatchSet,
    Prop,
    Report,
    Role,
    Row,
    Scene,
    World,
    WorldScene,
    WorldSite,
    __version__,
)

__all__ = [
    "Clip",
    "Crowd",
    "CrowdquiltError",
    "Fragment",
    "Kind",
    "Obstacle",
    "Outcome",
    "PatchSet",
    "Prop",
    "Report",
    "Role",
    "Row",
    "Scene",
    "World",
    "WorldScene",
    "WorldSite",
    "__version__",
    "check",
    "export",
    "motion",
    "patch",
    "refine",
    "samples",
    "stage",
    "tiling",
    "world",
]
