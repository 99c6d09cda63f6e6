"""Pictures: of a crowd, `plan` from above at one moment and `loom` in space and time; of a `capture`."""

from crowdquilt.plot.capture import capture
from crowdquilt.plot.loom import loom
from crowdquilt.plot.plan import plan

__all__ = ["capture", "loom", "plan"]
