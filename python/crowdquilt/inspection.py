"""What a file holds and what looks wrong with it, as plain data."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from crowdquilt import check, motion
from crowdquilt._core import Clip, Crowd, CrowdquiltError, PatchSet

SLIDE = 0.10  # metres that a planted foot may move in a good capture
BELOW = 0.05  # metres that a foot may be below the floor at one frame in a hundred
TURNED = 60  # degrees that a joint may be beyond what people can do: captures of skin and cloth exaggerate


@dataclass(frozen=True)
class Repairs:
    """What to repair of a capture before it is measured; what is None is left to the preset or the file."""

    preset: str | None = None
    metres_per_unit: float | None = None
    fps: float | None = None
    drop_first_frames: int | None = None
    restore_thorax: bool | None = None
    rig: str | None = None
    character: str | int | None = None


def inspect(path: Path, repairs: Repairs | None = None) -> dict[str, Any]:
    """Look into a crowd, a patch set or a capture, told apart by their first bytes."""
    with path.open("rb") as file:
        magic = file.read(8)
    if magic.startswith(b"CQCROWD"):
        return inspect_crowd(Crowd.load(path))
    if magic.startswith(b"CQPATCH"):
        return inspect_set(PatchSet.load(path))
    return inspect_clip(motion.load(path, **vars(repairs or Repairs())))


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
        "props": summary.props,
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


def inspect_clip(clip: Clip) -> dict[str, Any]:
    """The figures of a capture."""
    warnings = [message for _, message, _ in clip.symptoms()]
    told: dict[str, Any] = {
        "file": "capture",
        "name": clip.name,
        "joints": len(clip.joints),
        "frames": clip.frames,
        "fps": clip.fps,
        "seconds": clip.seconds,
        "height_m": clip.height_m,
        "path_m": float(np.linalg.norm(np.diff(clip.root[:, [0, 2]], axis=0), axis=1).sum()),
    }
    try:
        quality = clip.quality()
        told |= {"rig": clip.rig()[0]} | quality
        warnings += quality_warnings(quality)
    except CrowdquiltError as error:
        told |= {"rig": None, "foot_plants": 0, "foot_slide": None}
        warnings.append(f"cannot be put on the canonical skeleton: {error}")
    return told | {"warnings": warnings}


def quality_warnings(quality: dict[str, Any]) -> list[str]:
    """What is bad about a motion's figures."""
    warnings = []
    slide = quality["foot_slide"]
    if slide is not None and slide > SLIDE:
        warnings.append(f"a planted foot slides {slide:.2f} m over the ground")
    if quality["below_floor_p99_m"] > BELOW:
        warnings.append(f"feet are {quality['below_floor_p99_m']:.2f} m below the floor that they stand on")
    beyond, joint, time = quality["joint_excess_deg"]
    if beyond > TURNED:
        warnings.append(f"{joint} turns {beyond:.0f} degrees further than people can, at {time:.2f} s")
    return warnings


def inspect_take(paths: list[Path], repairs: Repairs | None = None) -> dict[str, Any]:
    """Several captures as one take: each one's figures, how near people come, and what speaks against it."""
    repairs = repairs or Repairs()
    clips = [motion.load(path, **vars(repairs)) for path in paths]
    people = [inspect_clip(clip) for clip in clips]
    distances = [
        {"people": [clips[a].name, clips[b].name], "nearest_m": nearest, "farthest_m": farthest}
        for a, b, nearest, farthest in motion.take_distances(clips)
    ]
    warnings = [message for message, _ in motion.check_take(clips)]
    return {"file": "take", "people": people, "distances": distances, "warnings": warnings}
