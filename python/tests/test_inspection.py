"""What `inspect` finds wrong with captures: one fault per test on a capture that has none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import crowdquilt as cq
from crowdquilt import plot
from crowdquilt.inspection import Repairs, inspect, inspect_take

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
    def joint(name: str, inside: str, offset: str = "0 0 0") -> str:
        return f"JOINT {name}\n{{\nOFFSET {offset}\nCHANNELS 3 Zrotation Xrotation Yrotation\n{inside}}}\n"

    end = "End Site\n{\nOFFSET 0 0.3 0\n}\n"
    chest = joint("Chest", "".join(joint(name, end) for name in ("Neck", "LeftArm", "RightArm")), "0 1.4 0")
    six = "Xposition Yposition Zposition Zrotation Xrotation Yrotation"
    head = f"HIERARCHY\nROOT Hips\n{{\nOFFSET 0 0 0\nCHANNELS 6 {six}\n{chest}}}\n"
    motion = "MOTION\nFrames: 2\nFrame Time: 0.033333\n" + "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n" * 2
    told = found(tmp_path, head + motion)
    assert "--restore-thorax" in told
    assert "cannot be put on the canonical skeleton" in told, "no rig of a person"


def test_figures_of_a_good_capture(tmp_path: Path, text: str) -> None:
    path = tmp_path / "clip.bvh"
    path.write_text(text)
    told = inspect(path, METRES)
    assert told["rig"] == "canonical" and told["foot_plants"] > 0
    assert told["foot_slide_median"] <= told["foot_slide"] < 0.05
    assert told["pops_secs"] == [] and told["below_floor_m"] < 0.03
    assert told["joint_excess_deg"][0] < 1 and told["joint_excess_share"] == 0
    assert {"joints", "frames", "fps", "seconds", "height_m", "foot_slide", "warnings"} <= told.keys()


def test_a_rig_file_names_joints(tmp_path: Path, text: str) -> None:
    path = tmp_path / "clip.bvh"
    path.write_text(text.replace("left_hand", "Thing"))
    assert "left_hand" in "".join(inspect(path, METRES)["warnings"])
    (tmp_path / "rig.toml").write_text('left_hand = "Thing"\n')
    assert inspect(path, Repairs(metres_per_unit=1.0, rig="rig.toml"))["warnings"] == []


def test_a_preset_repairs(tmp_path: Path, text: str) -> None:
    path = tmp_path / "clip.bvh"
    path.write_text(text)
    whole, cut = inspect(path, METRES), inspect(path, Repairs(preset="cmu-daz", metres_per_unit=1.0))
    assert cut["frames"] == whole["frames"] - 8
    with pytest.raises(cq.CrowdquiltError, match="cmu-daz-128"):
        inspect(path, Repairs(preset="nonsense"))


def test_people_of_a_take_are_checked(captures: Path, tmp_path: Path, text: str) -> None:
    together = next(
        path for path in sorted(captures.glob("*-a.bvh")) if path.with_name(path.name[:-5] + "b.bvh").exists()
    )
    pair = [together, together.with_name(together.name[:-5] + "b.bvh")]
    told = inspect_take(pair, METRES)
    assert len(told["people"]) == 2 and told["warnings"] == []
    assert 0.1 < told["distances"][0]["nearest_m"] < told["distances"][0]["farthest_m"] < 20
    twice = inspect_take([together, together], METRES)
    assert "inside each other" in "".join(twice["warnings"])


def test_a_capture_is_drawn(tmp_path: Path, text: str) -> None:
    path = tmp_path / "clip.bvh"
    path.write_text(text)
    clip = cq.motion.load(path, metres_per_unit=1.0)
    figure = plot.capture([clip], tmp_path / "clip.png")
    assert (tmp_path / "clip.png").stat().st_size > 5000
    bars = figure.axes[1].collections
    drawn = sum(len(bar.get_paths()) for bar in bars)
    assert drawn == len(clip.plants()), "a bar for every foot plant"
    np.testing.assert_allclose(figure.axes[2].lines[0].get_ydata(), clip.variation(0.5))


def test_crowds_and_sets_are_told_apart_by_content(tmp_path: Path, walkers: Path, patches: Path) -> None:
    renamed = tmp_path / "crowd.bvh"
    renamed.write_bytes(walkers.read_bytes())
    assert inspect(renamed)["characters"] == 3
    told = inspect(patches)
    assert told["kinds"] == len(cq.PatchSet.load(patches)) == told["alone"] + told["together"]
