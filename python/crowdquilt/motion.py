"""Captures: files read, repaired and measured."""

from crowdquilt._core import Clip, check_take, take_distances
from crowdquilt._core import import_presets as presets
from crowdquilt._core import load_clip as load

__all__ = ["Clip", "check_take", "load", "presets", "take_distances"]
