"""Captures: BVH files read, repaired and measured."""

from crowdquilt._core import Clip
from crowdquilt._core import load_clip as load

__all__ = ["Clip", "load"]
