"""Worlds of crowd patches: command line, playback, pictures, the documented file."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crowdquilt as cq
from crowdquilt import bench

ROOT = Path(__file__).parents[2]
SCENES = ROOT / "examples" / "worlds"


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "crowdquilt", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


@pytest.fixture(scope="module")
def street(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("world") / "street.world"
    made = run("world", SCENES / "street.toml", "-o", out, "--plot", out.with_suffix(".png"), "--json")
    assert made.returncode == 0, made.stderr
    told = json.loads(made.stdout)
    assert told["walkers"] > 300 and told["stayers"] > 10 and told["patterns"] == 9
    assert out.with_suffix(".png").read_bytes()[:4] == b"\x89PNG"
    return out


def test_a_world_is_checked_from_its_file(street: Path) -> None:
    checked = run("check", street, "--json")
    told = json.loads(checked.stdout)
    assert checked.returncode == 0 and told["ok"] and len(told["check"]) == 18


def test_seeds_make_worlds(street: Path, tmp_path: Path) -> None:
    def made(seed: int) -> bytes:
        file = tmp_path / f"{seed}.world"
        assert run("world", SCENES / "street.toml", "-o", file, "--seed", seed).returncode == 0
        return file.read_bytes()

    assert made(3) == street.read_bytes()
    assert made(4) != street.read_bytes()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("map = 3", "line 1"),
        ("templates = []\nmap = 'x'", "at least one template"),
        ("map = 'xs'\n[[templates]]\nname = 'a'\nkey = 's'", "row 1, column 1"),
    ],
)
def test_bad_scenes_end_in_one_message(tmp_path: Path, text: str, expected: str) -> None:
    scene = tmp_path / "bad.toml"
    scene.write_text(text)
    found = run("world", scene, "-o", tmp_path / "bad.world")
    assert found.returncode == 2 and expected in found.stderr and str(scene) in found.stderr
    assert "Traceback" not in found.stderr and not (tmp_path / "bad.world").exists()


def test_bad_files_end_in_one_message(street: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.world"
    cut.write_bytes(street.read_bytes()[:-7])
    found = run("check", cut)
    assert found.returncode == 2 and str(cut) in found.stderr and "Traceback" not in found.stderr
    assert run("check", tmp_path / "none.world").returncode == 2


def test_state_is_a_function_of_time(street: Path) -> None:
    world = cq.World.load(street)
    ids, places, velocities = world.at(3600.25)
    assert len(set(ids)) == len(ids) == len(places) and np.isfinite(places).all()
    later_ids, later, _ = world.at(3600.3)
    order = {int(i): k for k, i in enumerate(later_ids)}
    both = [(k, order[int(i)]) for k, i in enumerate(ids) if int(i) in order]
    assert len(both) > 0.95 * len(ids)
    moved = np.array([later[b] - places[a] for a, b in both])
    speeds = np.hypot(*moved.T) / 0.05
    assert speeds.max() < 2.1
    expected = np.array([velocities[a] for a, _ in both])
    assert np.median(np.hypot(*(moved / 0.05 - expected).T)) < 0.05


def test_bodies_walk_where_roots_are(street: Path) -> None:
    world = cq.World.load(street)
    assert world.has_bodies
    middle = (64.0, 16.0)
    ids, joints = world.joints_near(7.0, (*middle, 10.0))
    root_ids, places, _ = world.at(7.0, origin=middle, near=(*middle, 10.0))
    assert (ids == root_ids).all() and joints.shape[1:] == (22, 3)
    assert np.abs(joints[:, 0, [0, 2]] - places).max() < 0.15
    assert joints[:, :, 1].min() > -0.1 and (joints[:, :, 1].max(axis=1) > 1.4).all()


def test_an_area_says_what_was_left_out() -> None:
    world, notes = cq.world.build(cq.WorldScene.load(SCENES / "square.toml"))
    assert world.walkers > 200 and all(isinstance(note, str) for note in notes)
    assert cq.world.check(world).ok


def test_pictures_show_any_patch(street: Path, tmp_path: Path) -> None:
    from crowdquilt.plot import world as pictures

    world = cq.World.load(street)
    pictures.patch(world, kind=0, path=tmp_path / "patch.svg")
    assert "<svg" in (tmp_path / "patch.svg").read_text()


def test_bench_rows_of_worlds() -> None:
    lines: list[str] = []
    rows = {row.row: row for row in bench.worlds(1, lines.append)}
    assert rows["patch-create: 16 in and out, median"].reference == 60.0
    assert rows["patch-create: share without any fault"].ours == 1.0
    assert rows["endless-street: frame with a new patch, slowest"].unit == "ms"


def test_the_documented_reader_of_worlds_runs_and_is_right(
    street: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("city.world").write_bytes(street.read_bytes())
    text = (ROOT / "docs/formats/world.md").read_text()
    code = "\n".join(re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL))
    read: dict[str, Any] = {}
    exec(compile(code, "world.md", "exec"), read)
    world = cq.World.load(street)
    for secs in (0.05, 3.33, 9.97, 1234.5):
        all_of = [read["people"](int(kind), secs) + place[:2]
                  for kind, place in zip(world.instances, world.places, strict=True)]  # fmt: skip
        _, places, _ = world.at(secs)
        assert np.allclose(np.concatenate(all_of), places, atol=1e-3)


def test_the_documented_fields_of_worlds_are_those_of_the_file(street: Path) -> None:
    data = street.read_bytes()
    header = json.loads(data[24 : 24 + int.from_bytes(data[12:16], "little")])
    names = set(header) | set(header["arrays"]) | set(header["limits"]) | set(header["templates"][0])
    told = set(re.findall(r"`([\w.]+)`", (ROOT / "docs/formats/world.md").read_text()))
    assert names <= told
