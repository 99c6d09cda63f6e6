"""Pictures of a crowd: `plan` from above at one moment, `loom` in space and time with time upwards."""

from crowdquilt.plot.loom import loom
from crowdquilt.plot.plan import plan

__all__ = ["loom", "plan"]
