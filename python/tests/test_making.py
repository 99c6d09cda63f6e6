"""`crowdquilt patches`: what is made of captures that nobody annotated, and what is said of those that give nothing."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import crowdquilt as cq
from conftest import crowdquilt

FACTS = ("kinds", "single_person_kinds", "multi_person_kinds", "pose_groups", "closed", "takes")


@pytest.fixture(scope="module")
def bare(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sample captures, their take files without all that says where to cut."""
    folder = tmp_path_factory.mktemp("bare")
    cq.samples.write(folder, 1)
    for path in folder.glob("*.take.json"):
        take = json.loads(path.read_text())
        path.write_text(json.dumps({**take, "ports": [], "patches": [], "contacts": []}))
    return folder


def write_take(folder: Path, name: str, people: list[dict[str, object]], props: list[dict[str, object]] = ()) -> Path:
    """A take file that nobody annotated."""
    path = folder / f"{name}.take.json"
    fields = {"format": "crowdquilt-take", "version": 1, "name": name, "people": people, "props": list(props)}
    path.write_text(json.dumps(fields))
    return path


def make(source: Path, out: Path) -> tuple[dict[str, object], int, str]:
    """Run `patches --json`: the facts, the exit code, and what was said."""
    done = crowdquilt("patches", str(source), "-o", str(out), "--json")
    return (json.loads(done.stdout) if done.returncode == 0 else {}), done.returncode, done.stderr


def test_takes_that_were_found_cut_the_same_set_again(bare: Path, tmp_path: Path) -> None:
    first, again = tmp_path / "first.patches", tmp_path / "again.patches"
    done = crowdquilt("patches", str(bare), "-o", str(first), "--takes", str(tmp_path / "found"), "-q")
    assert done.returncode == 0, done.stderr
    done = crowdquilt("patches", str(tmp_path / "found"), "--captures", str(bare), "-o", str(again), "-q")
    assert done.returncode == 0, done.stderr
    one, other = cq.PatchSet.load(first), cq.PatchSet.load(again)
    assert sorted(k.name for k in one.kinds) == sorted(k.name for k in other.kinds)


def test_facts_count_kinds_once_and_tell_of_every_take(bare: Path, tmp_path: Path) -> None:
    facts, code, said = make(bare, tmp_path / "x.patches")
    assert code == 0, said
    assert tuple(facts) == FACTS
    kinds = [k for k in cq.PatchSet.load(tmp_path / "x.patches").kinds if not k.mirrored]
    assert facts["kinds"] == len(kinds) == facts["single_person_kinds"] + facts["multi_person_kinds"]
    assert facts["closed"] is True
    takes = {take["name"]: take for take in facts["takes"]}
    assert len(takes) == len(list(bare.glob("*.take.json")))
    events = takes["handshake-walk"]["events"]
    assert [e["kind"] for e in events] == ["contact"]
    assert events[0]["people"] == [0, 1]


def test_who_never_meets_gives_patches_of_one_person_and_a_reason(bare: Path, tmp_path: Path) -> None:
    people = [{"file": "walk-normal-a.bvh"}, {"file": "walk-normal-a.bvh", "offset": {"x": 8.0}}]
    facts, code, said = make(write_take(bare, "strangers", people), tmp_path / "x.patches")
    (bare / "strangers.take.json").unlink()
    assert code == 0, said
    assert facts["multi_person_kinds"] == 0 < facts["single_person_kinds"]
    assert "they never meet" in facts["takes"][0]["notes"][0]


def test_a_capture_alone_gives_patches_of_one_person(bare: Path, tmp_path: Path) -> None:
    facts, code, said = make(bare / "walk-normal-a.bvh", tmp_path / "x.patches")
    assert code == 0, said
    assert facts["single_person_kinds"] >= 6
    assert facts["takes"][0]["events"] == []


def test_a_prop_that_nobody_holds_is_named(bare: Path, tmp_path: Path) -> None:
    props = [{"name": "crate", "size": [0.4, 0.3, 0.3], "held": []}]
    path = write_take(bare, "idle-crate", [{"file": "walk-normal-a.bvh"}], props)
    facts, code, said = make(path, tmp_path / "x.patches")
    path.unlink()
    assert code == 0, said
    assert "prop crate: expected somebody who holds it, found nobody" in facts["takes"][0]["notes"]


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("one.bvh", None, "expected at least 2 frames, found 1"),
        ("index.csv", "file,partner_file\na.bvh,b.bvh\n", "line 2: expected a row of b.bvh"),
        ("index.csv", "file\na.bvh\n", "a.bvh"),
        ("index.csv", "path\na.bvh\n", "expected a column 'file'"),
        ("odd.txt", "hello", "expected a take file"),
    ],
)
def test_what_cannot_be_made_is_said_and_nothing_is_written(
    bare: Path, tmp_path: Path, name: str, content: str | None, expected: str
) -> None:
    if content is None:
        head, motion = (bare / "walk-normal-a.bvh").read_text().split("MOTION")
        lines = motion.strip().splitlines()
        content = "\n".join([head + "MOTION", "Frames: 1", lines[1], lines[2], ""])
    (tmp_path / name).write_text(content)
    _, code, said = make(tmp_path / name, tmp_path / "x.patches")
    assert code == 2, said
    assert len(said.strip().splitlines()) == 1 and expected in said and "Traceback" not in said
    assert [p.name for p in tmp_path.iterdir()] == [name]


def test_it_can_be_stopped(bare: Path) -> None:
    with pytest.raises(cq.CrowdquiltError, match="stopped"):
        cq.patch.make(bare, progress=lambda step: False)


def test_options_outside_their_range_are_refused(bare: Path) -> None:
    with pytest.raises(ValueError, match="threshold: expected"):
        cq.patch.make(bare, threshold=np.inf)
