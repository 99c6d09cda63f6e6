"""`crowdquilt patches`: what is made of captures that nobody annotated, and what is said of those that give nothing."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import crowdquilt as cq
from conftest import ROOT, crowdquilt
from crowdquilt import plot

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


def test_who_stands_about_beside_another_is_no_event_and_the_reason_is_told(bare: Path, tmp_path: Path) -> None:
    # Both idle, back to back.
    people = [{"file": "idle-a.bvh"}, {"file": "idle-a.bvh", "offset": {"z": -1.1, "heading_deg": 180.0}}]
    _, code, said = make(write_take(bare, "idlers", people), tmp_path / "x.patches")
    (bare / "idlers.take.json").unlink()
    assert code == 2 and not (tmp_path / "x.patches").exists()
    assert "idlers: no event: people 0 and 1: nearest 1.10 m apart at frame" in said
    assert "nobody touches, and nobody reacts noticeably while near" in said


def test_what_is_too_short_for_anything_is_refused_with_its_reasons(bare: Path, tmp_path: Path) -> None:
    head, motion = (bare / "walk-normal-a.bvh").read_text().split("MOTION")
    lines = motion.strip().splitlines()
    (tmp_path / "two.bvh").write_text("\n".join([head + "MOTION", "Frames: 4", *lines[1:6], ""]))
    people = [{"file": "two.bvh"}, {"file": "two.bvh", "offset": {"x": 3.0}}]
    source = write_take(tmp_path, "glimpse", people)
    _, code, said = make(source, tmp_path / "x.patches")
    assert code == 2 and len(said.strip().splitlines()) == 1
    assert "nothing to make patches of: glimpse: no event: people 0 and 1: nearest 3.00 m apart" in said
    assert "expected two moments in a recurring pose" in said
    assert not (tmp_path / "x.patches").exists()


def test_a_prop_in_the_hands_of_somebody_who_is_not_there_is_refused(bare: Path, tmp_path: Path) -> None:
    props = [{"name": "crate", "size": [0.4, 0.3, 0.3], "held": [{"person": 3, "begin": 0.0, "end": 1.0}]}]
    path = write_take(bare, "no-hands", [{"file": "walk-normal-a.bvh"}], props)
    _, code, said = make(path, tmp_path / "x.patches")
    path.unlink()
    assert (
        code == 2
        and "no-hands.take.json: props[0].held[0]: expected a person below 1, found 3" in said
        and "Traceback" not in said
    )


def test_labels_by_hand_survive(bare: Path, tmp_path: Path) -> None:
    """The free words of a take file are those of the kind, of its mirrored copy, and of the file."""
    found, out = tmp_path / "found", tmp_path / "x.patches"
    done = crowdquilt("patches", bare, "-o", out, "--takes", found, "-q")
    assert done.returncode == 0, done.stderr
    path = found / "push-walk.take.json"
    take = json.loads(path.read_text())
    own = next(p for p in take["patches"] if len(p["roles"]) == 2)
    own["labels"] = ["hostile", "Größe 12", "push"]
    path.write_text(json.dumps(take))
    done = crowdquilt("patches", found, "--captures", bare, "-o", out, "-q")
    assert done.returncode == 0, done.stderr
    kinds = {k.name: k for k in cq.PatchSet.load(out).kinds}
    assert kinds[own["name"]].labels == own["labels"] == kinds[own["name"] + "-mirror"].labels
    told = json.loads(crowdquilt("kinds", out, "--json").stdout)["kinds"]
    assert next(k for k in told if k["name"] == own["name"])["labels"] == own["labels"]


def test_labels_of_composed_patches_survive(captures: Path, tmp_path: Path) -> None:
    text = (ROOT / "examples/compose/push-and-stumble.compose.toml").read_text()
    file = tmp_path / "own.compose.toml"
    file.write_text(text.replace('["hostile"]', '["hostile", "two words"]'))
    made = cq.patch.make(captures, compose=[file]).set
    labels = {k.name: k.labels for k in made.kinds}
    assert labels["push-and-stumble"] == labels["push-and-stumble-mirror"] == ["hostile", "two words"]


def test_events_are_explained_by_a_picture(bare: Path, tmp_path: Path) -> None:
    picture = tmp_path / "events.png"
    done = crowdquilt("patches", bare, "-o", tmp_path / "x.patches", "--plot", picture, "-q")
    assert done.returncode == 0, done.stderr
    assert picture.stat().st_size > 50_000
    done = crowdquilt("patches", bare, "-o", tmp_path / "y.patches", "--plot", tmp_path / "events.doc", "-q")
    assert done.returncode == 2 and "expected a picture" in done.stderr and not (tmp_path / "y.patches").exists()


def test_several_sources_make_one_set(bare: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.bvh"
    shutil.copy(next(bare.glob("*.bvh")), other)
    made, alone = cq.patch.make([bare, other], study=False), cq.patch.make(bare, study=False)
    assert [take.name for take in made.takes] == [*(take.name for take in alone.takes), "other"]
    done = crowdquilt("patches", bare, bare, "-o", tmp_path / "x.patches", "-q")
    assert done.returncode != 0 and "a name of its own" in done.stderr and not (tmp_path / "x.patches").exists()


def test_signals_are_those_that_thresholds_are_held_against(bare: Path) -> None:
    made = cq.patch.make(bare)
    limits = made.thresholds
    assert limits["near"] == pytest.approx(1.2) and 0 < limits["in_place"] < limits["travelling"]
    shared = [take for take in made.signals() if take.pairs]
    assert len(shared) == sum(take.people > 1 for take in made.takes)
    for take in shared:
        pairs = {tuple(p.people): p for p in take.pairs}
        for kind, people, begin, end in take.signs:
            own = pairs[people]
            span = slice(begin, end + 1)
            if kind == "contact":
                assert own.gap[span].min() < limits["touch_gap"]
            elif kind == "proximity":
                assert own.apart[span].max() < limits["near"] and own.reaction[span].min() >= 1
            else:
                assert own.synchronicity[span].min() >= 1


def test_nothing_to_explain_is_a_picture_too(captures: Path, tmp_path: Path) -> None:
    """All takes are annotated: no events were looked for."""
    made = cq.patch.make(captures)
    assert made.signals() == [] and made.thresholds == {}
    figure = plot.events(made, tmp_path / "events.svg")
    assert (tmp_path / "events.svg").stat().st_size > 3000
    told = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert told[1] == "all takes say themselves where to cut: none was looked at"
    assert told.count("no take of several people was looked at") == 4 == len(told) - 1


def test_patches_draws_what_it_made(bare: Path, tmp_path: Path) -> None:
    sheet = tmp_path / "sheet.png"
    done = crowdquilt("patches", bare / "walk-normal-a.bvh", "-o", tmp_path / "x.patches", "--sheet", sheet)
    assert done.returncode == 0, done.stderr
    assert sheet.stat().st_size > 20_000
    done = crowdquilt("patches", bare, "-o", tmp_path / "y.patches", "--sheet", tmp_path / "sheet.doc")
    assert done.returncode == 2 and "expected a picture" in done.stderr and not (tmp_path / "y.patches").exists()


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
