"""Tiling: patches placed, deformed and stitched until a scene has no loose end."""

from crowdquilt._core import Outcome, Progress, Scene, tile

__all__ = ["Outcome", "Progress", "Scene", "tile"]
