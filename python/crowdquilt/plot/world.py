"""Worlds of crowd patches: from above with flows and densities; one patch with its patterns unrolled over time."""

from crowdquilt.plot.worlds.patch import patch
from crowdquilt.plot.worlds.plan import plan

__all__ = ["patch", "plan"]
