"""What a file holds and what looks wrong with it, as plain data."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from crowdquilt import check, motion
from crowdquilt._core import Clip, Crowd, CrowdquiltError, PatchSet

JUMP = 8.0  # metres per second from one frame to the next that no hips reach
SLIDE = 0.10  # metres that a planted foot may move in a good capture
FEET = {
    "left": ("LeftToeBase", "LeftToe", "left_toe", "lFoot"),
    "right": ("RightToeBase", "RightToe", "right_toe", "rFoot"),
}


@dataclass(frozen=True)
class Repairs:
    """What to repair of a capture before it is measured."""

    metres_per_unit: float | None = None
    fps: float | None = None
    drop_first_frames: int = 0
    restore_thorax: bool = False


def inspect(path: Path, repairs: Repairs | None = None) -> dict[str, Any]:
    """Look into a crowd, a patch set or a capture, told apart by their first bytes."""
    with path.open("rb") as file:
        magic = file.read(8)
    if magic.startswith(b"CQCROWD"):
        return inspect_crowd(Crowd.load(path))
    if magic.startswith(b"CQPATCH"):
        return inspect_set(PatchSet.load(path))
    repairs = repairs or Repairs()
    clip = motion.load(path, **vars(repairs))
    return inspect_clip(clip, repairs)


def inspect_crowd(crowd: Crowd) -> dict[str, Any]:
    """The figures of a crowd."""
    summary = check.summary(crowd)
    width, depth = (float(v) for v in np.ptp(crowd.region, axis=0))
    return {
        "file": "crowd",
        "characters": summary.characters,
        "instances": summary.instances,
        "kinds": summary.kinds,
        "multi_person_share": summary.multi_person_share,
        "danglings": summary.danglings,
        "seconds": crowd.seconds,
        "fps": crowd.fps,
        "size_m": [width, depth],
        "obstacles": len(crowd.obstacles),
        "seed": crowd.seed,
    }


def inspect_set(patches: PatchSet) -> dict[str, Any]:
    """The figures of a patch set."""
    kinds = patches.kinds
    return {
        "file": "patch set",
        "kinds": len(kinds),
        "mirrored": sum(kind.mirrored for kind in kinds),
        "alone": sum(kind.people == 1 for kind in kinds),
        "together": sum(kind.people > 1 for kind in kinds),
        "contacts": sum(kind.contacts for kind in kinds),
        "longest_secs": max((kind.seconds for kind in kinds), default=0.0),
        "groups": patches.groups,
        "warnings": patches.validate(),
    }


def inspect_clip(clip: Clip, repairs: Repairs) -> dict[str, Any]:
    """The figures of a capture."""
    warnings = clip_warnings(clip, repairs)
    slide: float | None = None
    plants = 0
    try:
        found = clip.plants()
        plants, slide = len(found), foot_slide(clip, found)
        if slide is not None and slide > SLIDE:
            warnings.append(f"a planted foot slides {slide:.2f} m over the ground")
    except CrowdquiltError as error:
        warnings.append(f"cannot be put on the canonical skeleton: {error}")
    return {
        "file": "capture",
        "name": clip.name,
        "joints": len(clip.joints),
        "frames": clip.frames,
        "fps": clip.fps,
        "seconds": clip.seconds,
        "height_m": clip.height_m,
        "path_m": float(np.linalg.norm(np.diff(clip.root[:, [0, 2]], axis=0), axis=1).sum()),
        "foot_plants": plants,
        "foot_slide": slide,
        "warnings": warnings,
    }


def foot_slide(clip: Clip, plants: list[tuple[Literal["left", "right"], float, float]]) -> float | None:
    """The farthest a planted foot gets from its middle place over the ground, metres; None without plants."""
    positions, worst = clip.positions(), None
    for foot, begin, end in plants:
        joint = next((clip.joints.index(name) for name in FEET[foot] if name in clip.joints), None)
        if joint is not None:
            way = positions[int(begin * clip.fps) : int(end * clip.fps) + 1, joint][:, [0, 2]]
            slide = float(np.linalg.norm(way - np.median(way, axis=0), axis=1).max())
            worst = slide if worst is None else max(worst, slide)
    return worst


def clip_warnings(clip: Clip, repairs: Repairs) -> list[str]:
    """What looks wrong with a capture, each with the option that may mend it."""
    warnings = []
    if repairs.metres_per_unit is None:
        warnings.append("the unit is guessed from the standing height; say it with --metres-per-unit")
    if not 1.3 <= clip.height_m <= 2.2:
        warnings.append(f"the person is {clip.height_m:.2f} m tall: is --metres-per-unit right?")
    # From one frame to the next every joint moves a little; a T-pose put in front makes all of them jump.
    steps = np.linalg.norm(np.diff(clip.positions(), axis=0), axis=2).max(axis=1) * clip.fps
    first = int(np.argmax(steps > JUMP)) if (steps > JUMP).any() else None
    if first is not None and first < 8 and not repairs.drop_first_frames:
        warnings.append(f"the pose jumps after frame {first}, like a T-pose put in front: try --drop-first {first + 1}")
    elif first is not None:
        count = int((steps > JUMP).sum())
        warnings.append(f"the pose jumps at {count} frames, first after frame {first} ({steps[first]:.0f} m/s)")
    neck = next((i for i, name in enumerate(clip.joints) if name == "Neck"), None)
    if neck is not None and not clip.offsets[neck].any():
        warnings.append("the neck has no bone below it, as in cgspeed's CMU files: try --restore-thorax")
    return warnings
