"""What `inspect` finds wrong with captures: one fault per test on a capture that has none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import crowdquilt as cq
from crowdquilt.inspection import FEET, Repairs, foot_slide, inspect

METRES = Repairs(metres_per_unit=1.0)


@pytest.fixture
def text(captures: Path) -> str:
    """A generated capture without a fault."""
    return sorted(captures.glob("*.bvh"))[0].read_text()


def found(tmp_path: Path, text: str, repairs: Repairs = METRES) -> str:
    path = tmp_path / "clip.bvh"
    path.write_text(text)
    return "\n".join(inspect(path, repairs)["warnings"])


def with_frame(text: str, number: int, shift: float) -> str:
    """The capture with everything moved by `shift` metres in one frame."""
    lines = text.rstrip().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("Frame Time")) + 1
    values = lines[first + number].split()
    values[0] = str(float(values[0]) + shift)
    lines[first + number] = " ".join(values)
    return "\n".join(lines) + "\n"


def test_a_good_capture_has_no_warning(tmp_path: Path, text: str) -> None:
    assert found(tmp_path, text) == ""


def test_a_guessed_unit_is_said(tmp_path: Path, text: str) -> None:
    assert "--metres-per-unit" in found(tmp_path, text, Repairs())


def test_a_wrong_unit_is_suspected(tmp_path: Path, text: str) -> None:
    assert "tall" in found(tmp_path, text, Repairs(metres_per_unit=0.01))


def test_a_pose_in_front_is_found_and_its_repair_helps(tmp_path: Path, text: str) -> None:
    broken = with_frame(text, 0, 0.5)
    assert "--drop-first 1" in found(tmp_path, broken)
    assert found(tmp_path, broken, Repairs(metres_per_unit=1.0, drop_first_frames=1)) == ""


def test_a_jump_later_on_is_found(tmp_path: Path, text: str) -> None:
    assert "jumps at 2 frames, first after frame 19" in found(tmp_path, with_frame(text, 20, 0.5))


def test_a_lost_thorax_is_found(tmp_path: Path) -> None:
    joints = "\tJOINT Neck\n\t{\n\t\tOFFSET 0 0 0\n\t\tCHANNELS 3 Zrotation Xrotation Yrotation\n"
    six = "Xposition Yposition Zposition Zrotation Xrotation Yrotation"
    head = f"HIERARCHY\nROOT Hips\n{{\n\tOFFSET 0 0 0\n\tCHANNELS 6 {six}\n"
    tail = "\t\tEnd Site\n\t\t{\n\t\t\tOFFSET 0 1.7 0\n\t\t}\n\t}\n}\n"
    motion = "MOTION\nFrames: 2\nFrame Time: 0.033333\n" + "0 0 0 0 0 0 0 0 0\n" * 2
    told = found(tmp_path, head + joints + tail + motion)
    assert "--restore-thorax" in told
    assert "cannot be put on the canonical skeleton" in told, "a rig of no family"


def test_a_foot_that_slides_is_measured(tmp_path: Path, text: str) -> None:
    path = tmp_path / "clip.bvh"
    path.write_text(text)
    clip = cq.motion.load(path, metres_per_unit=1.0)
    joint = clip.joints.index(next(name for name in FEET["left"] if name in clip.joints))
    way = clip.positions()[:31, joint][:, [0, 2]]
    expected = np.linalg.norm(way - np.median(way, axis=0), axis=1).max()
    assert foot_slide(clip, [("left", 0.0, 30 / clip.fps)]) == pytest.approx(expected)
    assert foot_slide(clip, []) is None


def test_crowds_and_sets_are_told_apart_by_content(tmp_path: Path, walkers: Path, patches: Path) -> None:
    renamed = tmp_path / "crowd.bvh"
    renamed.write_bytes(walkers.read_bytes())
    assert inspect(renamed)["characters"] == 3
    told = inspect(patches)
    assert told["kinds"] == len(cq.PatchSet.load(patches)) == told["alone"] + told["together"]
