"""Benchmark rows: their form, their ratio, and that they are measured."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import pytest

import crowdquilt as cq
from crowdquilt import bench, bench_steering, bench_tiling, bench_walks


def test_rows_are_measured_on_the_scene(monkeypatch: pytest.MonkeyPatch) -> None:
    class Small:
        from_toml = staticmethod(cq.Scene.from_toml)
        load = staticmethod(cq.Scene.load)

        @staticmethod
        def demo() -> cq.Scene:
            return cq.Scene.from_toml(
                "region = [[0, 0], [7, 0], [7, 7], [0, 7]]\nduration_secs = 3.0\ncharacters = 5\ninteraction = 0.0\n"
            )

    monkeypatch.setattr(bench_tiling, "Scene", Small)
    monkeypatch.setattr(bench, "STATIC", [bench_tiling.Static("static-173", 5, 0.0, 173, 16, 18.0)])
    monkeypatch.setattr(bench_tiling, "SQUARES", ((5, 0.3),))
    monkeypatch.setattr(bench_tiling, "THREADED", (5, 0.3))
    monkeypatch.setattr(bench, "EXAMPLES", [bench_tiling.Example("hopping", None, 30, 7 * 60)])
    monkeypatch.setattr(bench_tiling, "REPEATING", (bench_tiling.Repeating(("x", "t"), 6, 8.0),))
    monkeypatch.setattr(bench_tiling, "PLANES", (2,))
    lines: list[str] = []
    rows = {row.row: row for row in bench.AREAS["tiling"](2, lines.append)}
    assert len(lines) == 5
    people = rows["static-173: characters, least"]
    assert people.ours == 5 and people.ratio == pytest.approx(5 / 16)
    solve = rows["static-173: seconds, median"]
    assert 0 < solve.ours <= rows["static-173: seconds, most"].ours
    assert rows["static-173: seconds, least"].ours <= solve.ours
    assert lines[0].startswith("tiling: static-173: perfect 2/2, ") and "5/5/5 people" in lines[0]
    assert solve.reference == 18 and solve.unit == "s"
    assert solve.ratio == pytest.approx(solve.ours / 18)
    danglings = rows["static-173: danglings, all runs"]
    assert danglings.reference == 0 and danglings.ratio is None
    assert rows["static-173: Algorithms 1 and 2 here: seconds, median"].ours > 0
    assert rows["repeating: x, t: perfect and checked, of 2 seeds"].ours == 2
    assert rows["repeating: x, t: seam in time, worst gap or overlap"].ours < 0.01
    assert rows["repeating: x, t: border, worst gap or overlap"].ours < 0.01
    assert rows["wang: 20 x 20 m: characters"].ours == 160
    assert rows["wang: 20 x 20 m: perfect and checked"].ours == 1
    assert rows["wang: 20 x 20 m: per tile"].ours == pytest.approx(rows["wang: 20 x 20 m: seconds"].ours / 4)
    assert rows["hopping: bumps, fewest"].ours > 5
    assert rows["area-growth: 5 x 5 m, per character"].ours > 0
    assert rows["area-growth: 5 x 5 m, one thread / two"].ours > 0
    assert rows["area-growth: 5 x 5 m, perfect and checked"].ours in (0, 1)


def test_a_scene_that_a_set_cannot_play_is_skipped_with_the_reason(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, patches: Path
) -> None:
    text = (bench_tiling.SCENES / "hopping.toml").read_text()
    (tmp_path / "hopping.toml").write_text(text.replace("bump", "somersault"))
    monkeypatch.setattr(bench_tiling, "SCENES", tmp_path)
    lines: list[str] = []
    assert bench_tiling.example(bench_tiling.Example("hopping"), cq.PatchSet.load(patches), 1, lines.append) == []
    assert len(lines) == 1 and lines[0].startswith("tiling: hopping: skipped, ") and "somersault" in lines[0]
    assert bench_tiling.example(bench_tiling.Example("boxes"), cq.PatchSet.load(patches), 1, lines.append) == []
    assert lines[1].endswith("boxes.toml is not there")


def test_row_fields() -> None:
    assert [f.name for f in fields(bench.Row)] == ["area", "row", "ours", "unit", "reference", "source", "ratio"]


def test_steering_that_is_missing_is_skipped_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(world: cq.World) -> float:
        raise ImportError(world.name)

    def there(world: cq.World) -> float:
        places, velocities = bench_steering.people(world)
        assert len(places) == len(velocities) > 50
        return bench_steering.timed(len(places), lambda: sum(range(1000)))

    said: list[str] = []
    monkeypatch.setattr(bench_steering, "LIBRARIES", {"pyrvo": missing, "numpy": there})
    found = bench_steering.measured(said.append)
    assert [name.split()[0] for name in found] == ["numpy"] and min(found.values()) > 0
    assert "pyrvo: skipped" in said[0] and "M agent-steps/s" in said[1]


@pytest.mark.parametrize("name", ["pyrvo", "jupedsim"])
def test_steering_walks_on_the_street(name: str) -> None:
    pytest.importorskip(name, reason=f"{name} is not installed")
    assert bench_steering.LIBRARIES[name](bench_steering.street()) > 100


def test_walkers_keep_their_limits() -> None:
    rows = {row.row: row for row in bench_walks.distributions()}
    for name in bench_walks.LIMITS:
        low, half, high = (rows[f"walkers' {name}: {share} %"].ours for share in (5, 50, 95))
        most = rows[f"walkers' {name}: most"]
        assert most.reference is not None
        assert 0 <= low < half < high < most.ours <= most.reference, name
    assert rows["walkers' speed: 50 %"].ours > 1.0
