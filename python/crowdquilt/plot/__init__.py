"""Pictures.

Of a crowd: `plan` from above at one moment, `loom` in space and time; of a `capture`; of a patch set: `sheet` with all
its kinds, `groups` with what leads from one pose group to another; of captures that patches were made of: `events`,
what was measured and why something counts as an event.
"""

from crowdquilt.plot.capture import capture
from crowdquilt.plot.events import events
from crowdquilt.plot.groups import groups
from crowdquilt.plot.loom import loom
from crowdquilt.plot.plan import plan
from crowdquilt.plot.sheet import sheet

__all__ = ["capture", "events", "groups", "loom", "plan", "sheet"]
