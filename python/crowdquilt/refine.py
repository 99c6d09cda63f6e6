"""Full bodies: carried along deformed paths, blended at stitches, feet planted, hands joined."""

from crowdquilt._core import refine_crowd

__all__ = ["refine_crowd"]
