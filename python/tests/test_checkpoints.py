"""Checkpoints from the command line: runs that are killed go on with everybody who was there."""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import crowdquilt as cq
from conftest import crowdquilt

WISH = 280
SQUARE = f"""
region = [[0, 0], [24, 0], [24, 24], [0, 24]]
duration_secs = 20
characters = {WISH}
interaction = 0.25
"""


@pytest.fixture
def square(tmp_path: Path) -> Path:
    """A scene that takes seconds: whoever looks every 50 ms sees it grow."""
    path = tmp_path / "square.toml"
    path.write_text(SQUARE)
    return path


def run_until(checkpoint: Path, args: list[object], count: int, how: signal.Signals) -> int:
    """Tile with a checkpoint every 50 ms and send a signal once it holds so many people; how many it holds then."""
    text = f"""
import sys
from crowdquilt.cli import main, progress
real = progress.tile
progress.tile = lambda *args, **kwargs: real(*args, **kwargs, checkpoint_every=0.05)
sys.argv = {["crowdquilt", "tile", *map(str, args), "--threads", "1"]!r}
main()
"""
    running = subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    before = time.monotonic()
    while not checkpoint.exists() or len(cq.tiling.Checkpoint.load(checkpoint)) < count:
        assert running.poll() is None, "it ended before it was stopped"
        assert time.monotonic() - before < 60
    running.send_signal(how)
    _, errors = running.communicate(timeout=60)
    assert "Traceback" not in errors
    # Never half a file, whenever it is killed.
    return len(cq.tiling.Checkpoint.load(checkpoint))


@pytest.mark.parametrize("count", [1, 60, 150])
def test_a_killed_run_goes_on(tmp_path: Path, patches: Path, square: Path, count: int) -> None:
    checkpoint, out = tmp_path / "crowd.tiling", tmp_path / "crowd.crowd"
    held = run_until(checkpoint, [patches, "-o", out, "--scene", square], count, signal.SIGKILL)
    assert held >= count and not out.exists()
    # What is there is told without going on, and nothing changes.
    bytes_before = checkpoint.read_bytes()
    told = crowdquilt("tile", "--resume", checkpoint, "--time", 0)
    assert told.returncode == (3 if held < WISH else 0), told.stdout + told.stderr
    assert re.search(rf"{held} people, \d+ patches", told.stdout), told.stdout
    assert ", 0 faults" in told.stdout and f"wished for: {WISH} people" in told.stdout
    assert checkpoint.read_bytes() == bytes_before and not out.exists()
    # The same checkpoint leads to the same crowd with one thread and with two; it goes when the crowd is perfect.
    shutil.copy(checkpoint, tmp_path / "again.tiling")
    done = crowdquilt("tile", "--resume", checkpoint, "--threads", 1, "--report", tmp_path / "report.json")
    assert done.returncode == 0, done.stdout + done.stderr
    assert not checkpoint.exists() and out.exists()
    assert crowdquilt("tile", "--resume", tmp_path / "again.tiling", "--threads", 2).returncode == 0
    assert out.read_bytes() == (tmp_path / "again.crowd").read_bytes()
    crowd = cq.Crowd.load(out)
    assert len(crowd) == WISH and cq.check.check(crowd).ok


@pytest.mark.skipif(sys.platform == "win32", reason="SIGTERM is a Unix signal")
def test_sigterm_saves_what_there_is(tmp_path: Path, patches: Path, square: Path) -> None:
    checkpoint, out = tmp_path / "crowd.tiling", tmp_path / "crowd.crowd"
    more_than_find_room = [patches, "-o", out, "--scene", square, "--characters", 5000]
    held = run_until(checkpoint, more_than_find_room, 10, signal.SIGTERM)
    assert len(cq.Crowd.load(out)) == held < 5000


def test_checkpoints_are_where_they_are_wanted(tmp_path: Path, patches: Path, scene: Path) -> None:
    out, wanted = tmp_path / "a.crowd", tmp_path / "kept" / "a.tiling"
    assert crowdquilt("tile", patches, "-o", out, "--scene", scene).returncode == 0
    assert [f.name for f in tmp_path.iterdir()] == ["a.crowd"]
    done = crowdquilt("tile", patches, "-o", out, "--scene", scene, "--checkpoint", wanted)
    assert done.returncode == 0 and f"{wanted}: written" in done.stdout.replace("\n", "")
    # Later the crowd can be made denser.
    denser = tmp_path / "denser.crowd"
    done = crowdquilt("tile", "--resume", wanted, "--characters", 14, "-o", denser)
    assert done.returncode == 0, done.stdout + done.stderr
    assert wanted.exists() and len(cq.Crowd.load(denser)) == 14
    without = tmp_path / "without.crowd"
    wishes = ("--scene", scene, "--characters", 900, "--time", 1)
    short = crowdquilt("tile", patches, "-o", without, *wishes, "--no-checkpoint")
    assert short.returncode == 3 and not without.with_suffix(".tiling").exists()
    assert "short of what was wished for" in short.stdout and "of 900 characters found room" in short.stdout


def test_a_set_that_has_moved_is_found_beside_the_checkpoint_or_asked_for(
    tmp_path: Path, patches: Path, scene: Path
) -> None:
    mine, kept = tmp_path / "mine.patches", tmp_path / "a.tiling"
    shutil.copy(patches, mine)
    crowdquilt("tile", mine, "-o", tmp_path / "a.crowd", "--scene", scene, "--checkpoint", kept)
    there = tmp_path / "there"
    there.mkdir()
    mine.rename(there / "mine.patches")
    shutil.copy(kept, there / "a.tiling")
    assert crowdquilt("tile", "--resume", there / "a.tiling", "--time", 0).returncode == 0
    lost = crowdquilt("tile", "--resume", kept, "--time", 0)
    assert lost.returncode == 2 and "mine.patches is not there" in lost.stderr
    assert crowdquilt("tile", there / "mine.patches", "--resume", kept, "--time", 0).returncode == 0


def test_bad_checkpoints_end_in_one_message(tmp_path: Path, patches: Path, scene: Path, captures: Path) -> None:
    kept = tmp_path / "a.tiling"
    crowdquilt("tile", patches, "-o", tmp_path / "a.crowd", "--scene", scene, "--checkpoint", kept)
    cut = tmp_path / "cut.tiling"
    cut.write_bytes(kept.read_bytes()[:-9])
    flipped = tmp_path / "flipped.tiling"
    damaged = bytearray(kept.read_bytes())
    damaged[-100] ^= 4
    flipped.write_bytes(damaged)
    other = tmp_path / "other.patches"
    smaller = tmp_path / "captures"
    cq.samples.write(smaller, seed=2)
    cq.patch.cut(smaller).save(other)
    for args, expected in [
        (["--resume", cut], "cut.tiling"),
        (["--resume", flipped], "the file is damaged"),
        (["--resume", patches], "CQTILNG"),
        (["--resume", tmp_path / "none.tiling"], "No such file"),
        ([other, "--resume", kept], "expected the patch set it was made with"),
        (["--resume", kept, "--scene", scene], "a checkpoint has its scene"),
        (["--resume", kept, "--method", "paper"], "expected the engine"),
    ]:
        done = crowdquilt("tile", *args, "-o", tmp_path / "b.crowd")
        assert done.returncode == 2, (args, done.stdout, done.stderr)
        told = " ".join(done.stderr.replace("│", " ").split())
        assert expected in told and "Traceback" not in told, told
    assert not (tmp_path / "b.crowd").exists()


def test_python_keeps_and_resumes(tmp_path: Path, patches: Path) -> None:
    kinds, kept = cq.PatchSet.load(patches), tmp_path / "a.tiling"
    scene = cq.Scene.demo().replace(characters=20)
    reports = iter([True, True])
    first = cq.tiling.tile(scene, kinds, progress=lambda _: next(reports, False), checkpoint=kept, patches_name="mine")
    assert first.unkept is None
    checkpoint = cq.tiling.Checkpoint.load(kept)
    assert checkpoint.patches == "mine" and checkpoint.scene.people == 20
    assert checkpoint.characters == len(first.crowd)
    status, reason, faults = cq.tiling.review(checkpoint, checkpoint.scene, kinds)
    assert faults == 0 and (status == "perfect") == (not reason)
    further = cq.tiling.tile(checkpoint.scene.replace(characters=30), kinds, resume=checkpoint)
    assert further.status == "perfect" and len(further.crowd) == 30
    nowhere = cq.tiling.tile(scene, kinds, checkpoint=tmp_path / "no" / "folder.tiling")
    assert nowhere.status == "perfect" and nowhere.unkept is not None and "folder.tiling" in nowhere.unkept


def test_teams_are_in_the_crowd_and_its_picture(tmp_path: Path, patches: Path) -> None:
    start = "start = [[{0}, 0.5], [{1}, 0.5], [{1}, 6.5], [{0}, 6.5]]"
    text = (
        "region = [[0, 0], [9, 0], [9, 7], [0, 7]]\nduration_secs = 5\ncharacters = 3\ninteraction = 0\n"
        f'[[team]]\nname = "red"\ncharacters = 3\n{start.format(0.5, 2.5)}\n'
        f'[[team]]\nname = "blue"\ncharacters = 2\n{start.format(6.5, 8.5)}\n'
    )
    outcome = cq.tiling.tile(cq.Scene.from_toml(text), cq.PatchSet.load(patches))
    assert outcome.status == "perfect", outcome.reason
    crowd = cq.Crowd.from_bytes(outcome.crowd.to_bytes())
    assert crowd.teams == ["red", "blue"] and crowd.team_of == outcome.crowd.team_of
    for team, (low, high) in enumerate([(0.5, 2.5), (6.5, 8.5)]):
        inside = [
            person for person in range(len(crowd)) if crowd.span(person)[0] == 0 and crowd.team_of[person] == team
        ]
        assert len(inside) >= (3, 2)[team]
        places = np.array([crowd.roots(person)[0] for person in inside])
        assert (places[:, 0] > low - 0.4).all() and (places[:, 0] < high + 0.4).all()
    from crowdquilt import plot

    sheet = plot.plan(crowd, tmp_path / "teams.svg", time=1.0)
    words = [text.get_text() for text in sheet.texts]
    assert any(word.startswith("red ") for word in words) and any(word.startswith("blue ") for word in words)
    assert (tmp_path / "teams.svg").stat().st_size > 1000
