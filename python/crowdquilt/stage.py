"""The finished crowd, played at any time from its file alone."""

from crowdquilt._core import Crowd, Fragment, Prop

__all__ = ["Crowd", "Fragment", "Prop"]
