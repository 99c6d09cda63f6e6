"""What commands print of patch sets, for terminals of any width."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path

import pytest
from rich.console import Console

import crowdquilt as cq
from crowdquilt.cli.sets import label_table
from crowdquilt.cli.tables import kind_table, notes_of, ports_of, signed


@pytest.fixture(scope="module")
def samples(patches: Path) -> cq.PatchSet:
    return cq.PatchSet.load(patches)


def test_tables_fit_into_narrow_terminals(samples: cq.PatchSet) -> None:
    """Columns are left out whole, and named; figures are never cut."""

    def told(width: int) -> str:
        with (screen := Console(width=width, file=io.StringIO())).capture() as text:
            screen.print(kind_table(samples, width))
            screen.print(label_table(samples, width))
        return text.get()

    wide = told(160)
    assert "ports" in wide and "wider" not in wide
    for width in (60, 80, 100, 120):
        text = told(width)
        assert "…" not in text and max(map(len, text.splitlines())) <= width
        assert "measured" in text and all(kind.name in text for kind in samples.kinds if not kind.mirrored)
    assert "a wider terminal shows radius" in told(80)


def test_turns_are_told_without_a_sign_of_nothing() -> None:
    assert [signed(d) for d in (-0.4, 0.0, 0.4, -93.6, 88.5001)] == ["0°", "0°", "0°", "-94°", "+89°"]


def test_people_who_come_and_go_alike_share_a_line(samples: cq.PatchSet) -> None:
    trio = next(k for k in samples.kinds if k.name == "trio-talk-stand")
    assert ports_of(trio) == "3 × stand → stand"
    walk = next(k for k in samples.kinds if k.name == "trio-talk-walk")
    assert ports_of(walk).count("×") <= 1 and "→" in ports_of(walk)


@dataclass
class Noted:
    """What `notes_of` looks at of a take."""

    name: str
    notes: list[str]


def test_the_same_of_many_takes_is_said_once() -> None:
    short = "no patch: expected two moments, found 0 in {} frames"
    takes = [Noted("a", [short.format(79)]), Noted("b", ["other"]), Noted("c", [short.format(70), "other"])]
    assert notes_of(takes) == [("a, c", "no patch: expected two moments, found 0"), ("b, c", "other")]
    assert notes_of([Noted("d", ["found 1 in 7 frames"])]) == [("d", "found 1 in 7 frames")]
