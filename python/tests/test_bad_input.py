"""Bad input: one message that names file and place, exit code 2, no traceback, nothing half-made left behind."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import crowdfile
import crowdquilt as cq
from conftest import SCENE, crowdquilt

BVH = """HIERARCHY
ROOT Hips
{
\tOFFSET 0 0 0
\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
\tJOINT Head
\t{
\t\tOFFSET 0 1.7 0
\t\tCHANNELS 3 Zrotation Xrotation Yrotation
\t\tEnd Site
\t\t{
\t\t\tOFFSET 0 0.1 0
\t\t}
\t}
}
MOTION
Frames: 2
Frame Time: 0.033333
0 0 0 0 0 0 0 0 0
0 0 0.01 0 0 0 0 0 0
"""
FAULTS = {
    "empty": b"",
    "binary": bytes(range(256)) * 8,
    "truncated in the hierarchy": BVH[:120].encode(),
    "truncated in the motion": BVH[:-20].encode(),
    "not a number": BVH.replace("0.01", "nan").encode(),
    "zero frames": BVH.replace("Frames: 2", "Frames: 0").encode(),
    "negative frame time": BVH.replace("0.033333", "-0.03").encode(),
    "a billion frames": BVH.replace("Frames: 2", "Frames: 1000000000").encode(),
    "a million joints": b"HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation "
    b"Xrotation Yrotation\n" + b"JOINT j\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n" * 1_000_000,
    "no root channels": BVH.replace("CHANNELS 6 Xposition Yposition Zposition", "CHANNELS 3").encode(),
}


def refused(done: object, name: str) -> str:
    """Assert that a run was refused properly; its message."""
    message = done.stderr.strip()
    assert done.returncode == 2, (done.returncode, done.stdout, message)
    assert "Traceback" not in message and "panicked" not in message
    assert len(message.splitlines()) == 1, message
    assert name in message, message
    return message


def test_the_faultless_bvh_is_accepted(tmp_path: Path) -> None:
    path = tmp_path / "fine.bvh"
    path.write_text(BVH)
    done = crowdquilt("inspect", path, "--metres-per-unit", 1)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("fault", FAULTS)
def test_bad_bvh(tmp_path: Path, fault: str) -> None:
    path = tmp_path / "bad.bvh"
    path.write_bytes(FAULTS[fault])
    refused(crowdquilt("inspect", path, "--metres-per-unit", 1, timeout=60), "bad.bvh")


@pytest.mark.parametrize("fault", ["empty", "truncated in the motion"])
def test_bad_bvh_in_a_take_leaves_no_patch_set(tmp_path: Path, fault: str) -> None:
    take = {"format": "crowdquilt-take", "version": 1, "name": "one", "people": [{"file": "bad.bvh"}]}
    (tmp_path / "one.take.json").write_text(json.dumps(take))
    (tmp_path / "bad.bvh").write_bytes(FAULTS[fault])
    out = tmp_path / "out.patches"
    refused(crowdquilt("patches", tmp_path, "-o", out), "bad.bvh")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bad.bvh", "one.take.json"]


SCENES = {
    "self-intersecting": (SCENE.replace("[7, 7], [0, 7]", "[0, 7], [7, 7]"), "line 1"),
    "filled by its obstacle": (SCENE + "obstacles = [[[-1, -1], [8, -1], [8, 8], [-1, 8]]]\n", ""),
    "no length": (SCENE.replace("5.0", "0.0"), "line 2"),
    "not TOML": ("region = [[", "line 1"),
    "an unknown field": (SCENE + "weather = 'rain'\n", "line 5"),
    "nobody": (SCENE.replace("characters = 8", "characters = 0"), "line 3"),
}


@pytest.mark.parametrize("fault", SCENES)
def test_bad_scene(tmp_path: Path, patches: Path, fault: str) -> None:
    text, place = SCENES[fault]
    scene, out = tmp_path / "bad.toml", tmp_path / "out.crowd"
    scene.write_text(text)
    message = refused(crowdquilt("tile", patches, "--scene", scene, "-o", out), "bad.toml")
    assert place in message
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bad.toml"]


def test_a_patch_set_in_which_an_exit_never_matches_an_entry(tmp_path: Path) -> None:
    stuck = crowdfile.Kind("stuck", [crowdfile.Fragment(31, 1.2, exit=1)])
    (tmp_path / "stuck.patches").write_bytes(crowdfile.patch_set([crowdfile.WALK, stuck]))
    done = crowdquilt("tile", tmp_path / "stuck.patches", "-o", tmp_path / "out.crowd")
    message = refused(done, "stuck.patches")
    assert "kind stuck" in message and '"never"' in message
    assert not (tmp_path / "out.crowd").exists()


@pytest.mark.parametrize("command", ["check", "inspect", "export", "plot", "view"])
def test_a_cut_crowd(tmp_path: Path, walkers: Path, command: str) -> None:
    path = tmp_path / "cut.crowd"
    path.write_bytes(walkers.read_bytes()[:-100])
    more = ["-o", tmp_path / "out.png"] if command in ("export", "plot") else []
    refused(crowdquilt(command, path, *more, *(["--no-open"] if command == "view" else [])), "cut.crowd")
    assert not (tmp_path / "out.png").exists()


@pytest.mark.parametrize("command", ["check", "inspect", "export", "plot", "view", "tile", "patches"])
def test_a_missing_file(tmp_path: Path, command: str) -> None:
    more = ["-o", tmp_path / "out.glb"] if command in ("export", "plot", "tile", "patches") else []
    message = refused(crowdquilt(command, tmp_path / "missing", *more), "missing")
    assert "No such file" in message or "expected a picture" in message
    assert list(tmp_path.iterdir()) == []


def test_values_out_of_range_name_their_option(tmp_path: Path, patches: Path, walkers: Path) -> None:
    for args, named in [
        (("tile", patches, "-o", tmp_path / "x.crowd", "--interaction", 2), "interaction"),
        (("tile", patches, "-o", tmp_path / "x.crowd", "--characters", 0), "characters"),
        (("tile", patches, "-o", tmp_path / "x.crowd", "--time", "-1"), "--time"),
        (("tile", patches, "-o", tmp_path / "x.crowd", "--method", "magic"), "--method"),
        (("export", walkers, "-o", tmp_path / "x.bvh", "--person", 99), "--person"),
        (("export", walkers, "-o", tmp_path / "x.fbx"), "x.fbx"),
        (("plot", walkers, "-o", tmp_path / "x.png", "--time", 99), "--time"),
        (("bench", "nothing"), "nothing"),
    ]:
        done = crowdquilt(*args)
        assert done.returncode == 2 and named in done.stderr and "Traceback" not in done.stderr, (args, done.stderr)
    assert not list(tmp_path.glob("x.*"))


def test_python_raises_what_it_says(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError) as missing:
        cq.Crowd.load(tmp_path / "missing.crowd")
    assert missing.value.filename == str(tmp_path / "missing.crowd")
    with pytest.raises(cq.CrowdquiltError, match="byte 0"):
        cq.PatchSet.from_bytes(b"no")
    with pytest.raises(cq.CrowdquiltError, match="interaction"):
        cq.Scene.demo().replace(interaction=1.5)
    assert cq.CrowdquiltError.__bases__ == (Exception,)


def test_a_character_that_is_none_is_refused(tmp_path: Path, walkers: Path) -> None:
    out, whole = tmp_path / "x.glb", tmp_path / "crowd.glb"
    assert crowdquilt("export", walkers, "-o", whole).returncode == 0
    text = tmp_path / "text.glb"
    text.write_text("not a character")
    assert "byte 0" in refused(crowdquilt("export", walkers, "-o", out, "--character", text), "text.glb")
    cut = tmp_path / "cut.glb"
    cut.write_bytes(whole.read_bytes()[:-100])
    refused(crowdquilt("export", walkers, "-o", out, "--character", cut), "cut.glb")
    refused(crowdquilt("export", walkers, "-o", out, "--character", tmp_path / "none.glb"), "none.glb")
    done = crowdquilt("export", walkers, "-o", tmp_path / "bvh", "--character", whole)
    assert done.returncode == 2 and "--character" in done.stderr
    assert not out.exists()
