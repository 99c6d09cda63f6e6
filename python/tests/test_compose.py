"""Patches composed by hand join the set that `crowdquilt patches` makes."""

from __future__ import annotations

from pathlib import Path

import pytest

import crowdquilt as cq
from conftest import ROOT, crowdquilt

EXAMPLES = ROOT / "examples" / "compose"


def test_composed_kinds_are_in_the_set(captures: Path) -> None:
    made = cq.patch.make(captures, compose=[EXAMPLES]).set
    kinds = {kind.name: kind for kind in made.kinds}
    assert [kinds[name].people for name in ("meet-and-bow", "rows-bow", "push-and-stumble")] == [2, 10, 2]
    assert kinds["push-and-stumble"].contacts == 2
    assert kinds["rows-bow-mirror"].mirrored


def test_a_file_beside_the_takes_is_found(captures: Path, tmp_path: Path) -> None:
    folder = tmp_path / "takes"
    folder.mkdir()
    for name in ("bow-stand", "start-stop", "start-stop-90"):
        for file in captures.glob(f"{name}[.-]*"):
            (folder / file.name).write_bytes(file.read_bytes())
    text = (EXAMPLES / "meet-and-bow.compose.toml").read_text()
    (folder / "own.compose.toml").write_text(text.replace("meet-and-bow", "own"))
    assert "own" in {kind.name for kind in cq.patch.make(folder).set.kinds}


def test_a_fault_is_told_with_file_and_line(captures: Path, tmp_path: Path) -> None:
    bad = tmp_path / "bad.compose.toml"
    bad.write_text((EXAMPLES / "meet-and-bow.compose.toml").read_text().replace("ahead = 1.3", "ahead = 0.3"))
    done = crowdquilt("patches", captures, "--compose", bad, "-o", tmp_path / "out.patches")
    assert done.returncode == 2 and not (tmp_path / "out.patches").exists()
    assert "bad.compose.toml: line 16" in done.stderr and "deep in ann" in done.stderr
    with pytest.raises(cq.CrowdquiltError, match="line 16"):
        cq.patch.make(captures, compose=[bad])


def test_a_folder_without_compose_files_is_refused(captures: Path, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    done = crowdquilt("patches", captures, "--compose", tmp_path / "empty", "-o", tmp_path / "out.patches")
    assert done.returncode == 2 and "expected files that end in .compose.toml, found none" in done.stderr
    assert not (tmp_path / "out.patches").exists()
