"""A crowd as files other programs read: glTF (`.glb`) and BVH, one per person."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from crowdquilt._core import Crowd
from crowdquilt._core import export_bvh as bvh
from crowdquilt._core import export_glb as glb
from crowdquilt.outputs import whole_file, whole_folder

__all__ = ["bvh", "glb", "save_bvh", "save_glb", "save_person"]


def save_glb(crowd: Crowd, path: Path, characters: Sequence[Path] = ()) -> Path:
    """Write every person as a skinned, animated mesh into one binary glTF file.

    `characters` are `.glb` files of skinned humanoids (Mixamo, VRM, Unreal, Unity, Rigify, ... joint names), in any
    upright rest pose and of any size; they are dealt out to the people in place of the mannequin.
    """
    written = glb(crowd, list(characters))
    with whole_file(path) as part:
        part.write_bytes(written)
    return path


def save_person(crowd: Crowd, person: int, path: Path) -> Path:
    """Write one person's motion as a BVH file."""
    with whole_file(path) as part:
        part.write_text(bvh(crowd, person), encoding="ascii", newline="\n")
    return path


def save_bvh(crowd: Crowd, folder: Path) -> list[Path]:
    """Write `person_000.bvh`, `person_001.bvh`, ... into `folder`; those of an earlier, larger crowd go away."""
    names = [f"person_{person:03}.bvh" for person in range(len(crowd))]
    with whole_folder(folder, stale="person_*.bvh") as part:
        for person, name in enumerate(names):
            save_person(crowd, person, part / name)
    return [folder / name for name in names]
