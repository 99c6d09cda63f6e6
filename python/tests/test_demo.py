"""What `crowdquilt demo` leaves behind and says; on a small scene, so that it is quick."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import crowdquilt as cq
from conftest import crowdquilt
from crowdquilt import report


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory, scene: Path) -> tuple[Path, str]:
    out = tmp_path_factory.mktemp("demo") / "out"
    done = crowdquilt("demo", "-o", out, "--scene", scene)
    assert done.returncode == 0, done.stdout + done.stderr
    return out, done.stdout


def test_everything_is_there(demo: tuple[Path, str]) -> None:
    out, _ = demo
    names = {p.name for p in out.iterdir()}
    assert names == {
        "captures", "demo.patches", "crowd.crowd", "crowd.glb", "bvh", "plan.png", "loom.png", "report.json",
    }  # fmt: skip
    assert len(list((out / "bvh").iterdir())) == 8
    assert not list(out.parent.glob(".*")), "no temporary folder stays"


def test_report_schema(demo: tuple[Path, str]) -> None:
    out, _ = demo
    data = json.loads((out / "report.json").read_text())
    for name, kind in {
        "characters": int, "instances": int, "kinds": int, "danglings": int, "seed": int,
        "multi_person_share": float, "solve_secs": float, "seconds": float, "ok": bool, "status": str,
    }.items():  # fmt: skip
        assert type(data[name]) is kind, name
    assert data["characters"] == 8 and data["danglings"] == 0 and data["seed"] == 1 and data["solve_secs"] > 0
    assert len(data["check"]) > 10
    for row in data["check"]:
        assert {"row": str, "unit": str, "ok": bool}.items() <= {k: type(v) for k, v in row.items()}.items()
        assert isinstance(row["value"], float) and isinstance(row["limit"], float)
    assert data["ok"] == all(row["ok"] for row in data["check"])


def test_last_lines_say_what_how_good_and_how_to_watch(demo: tuple[Path, str]) -> None:
    out, told = demo
    last = "\n".join(told.strip().splitlines()[-3:])
    assert "8 people" in last and "no loose end" in last and "rows of the check hold" in last
    assert f"crowdquilt view {out / 'crowd.crowd'}" in last


def test_show_tells_the_same_without_making_anything(demo: tuple[Path, str]) -> None:
    out, told = demo
    before = {p: p.stat().st_mtime_ns for p in out.iterdir()}
    shown = crowdquilt("demo", "-o", out, "--show")
    assert shown.returncode == 0 and shown.stdout.strip() == "\n".join(told.strip().splitlines()[-3:])
    assert before == {p: p.stat().st_mtime_ns for p in out.iterdir()}


def test_a_second_demo_replaces_the_first(demo: tuple[Path, str], scene: Path) -> None:
    out, _ = demo
    (out / "mine.txt").write_text("stays")
    done = crowdquilt("demo", "-o", out, "--scene", scene, "--seed", 2)
    assert done.returncode in (0, 1), done.stdout + done.stderr
    assert cq.Crowd.load(out / "crowd.crowd").seed == 2
    assert (out / "mine.txt").read_text() == "stays"
    assert not list(out.glob("*.old"))


def test_a_demo_that_fails_leaves_nothing(tmp_path: Path) -> None:
    scene = tmp_path / "bad.toml"
    scene.write_text("region = [[0, 0], [1, 0], [1, 1]]\nduration_secs = 2.0\ncharacters = 5\n"
                     "obstacles = [[[-1, -1], [2, -1], [2, 2], [-1, 2]]]\n")  # fmt: skip
    done = crowdquilt("demo", "-o", tmp_path / "out", "--scene", scene)
    assert done.returncode == 2, done.stdout
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bad.toml"]


def test_report_is_json_even_where_a_number_is_not_finite(walkers: Path) -> None:
    crowd = cq.Crowd.load(walkers)
    data = report.build(crowd, cq.check.check(crowd))
    json.dumps(data, allow_nan=False)
    assert data["solve_secs"] is None and data["status"] is None
