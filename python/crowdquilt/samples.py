"""Generated captures of people who walk, turn, sit, meet and touch: the default material to cut patches from."""

from crowdquilt._core import write_samples as write

__all__ = ["write"]
