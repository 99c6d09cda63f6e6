"""Benchmark rows: their form, their ratio, and that they are measured."""

from __future__ import annotations

from dataclasses import fields

import pytest

import crowdquilt as cq
from crowdquilt import bench


def test_rows_are_measured_on_the_scene(monkeypatch: pytest.MonkeyPatch) -> None:
    class Small:
        @staticmethod
        def demo() -> cq.Scene:
            return cq.Scene.from_toml(
                "region = [[0, 0], [7, 0], [7, 7], [0, 7]]\nduration_secs = 3.0\ncharacters = 5\ninteraction = 0.0\n"
            )

    monkeypatch.setattr(bench, "Scene", Small)
    lines: list[str] = []
    rows = {row.row: row for row in bench.AREAS["tiling"](2, lines.append)}
    assert len(lines) == 4
    assert rows["characters"].ours == 5 and rows["characters"].ratio == pytest.approx(5 / 70)
    solve = rows["solve time"]
    assert 0 < solve.ours <= rows["slowest solve"].ours and solve.reference == 6180 and solve.unit == "s"
    assert solve.ratio == pytest.approx(solve.ours / 6180)
    assert rows["danglings, all runs"].reference == 0 and rows["danglings, all runs"].ratio is None
    assert rows["Algorithms 1 and 2 here: solve time"].ours > 0


def test_row_fields() -> None:
    assert [f.name for f in fields(bench.Row)] == ["area", "row", "ours", "unit", "reference", "source", "ratio"]
