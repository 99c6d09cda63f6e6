"""Outputs appear whole or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from crowdquilt.outputs import whole_file, whole_folder


def test_a_file_that_fails_leaves_the_old_one(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(RuntimeError), whole_file(path) as part:
        part.write_text("half")
        raise RuntimeError
    assert path.read_text() == "old" and list(tmp_path.iterdir()) == [path]
    with whole_file(path) as part:
        part.write_text("new")
    assert path.read_text() == "new" and list(tmp_path.iterdir()) == [path]


def test_a_folder_that_fails_leaves_the_old_one(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    (folder / "sub").mkdir(parents=True)
    (folder / "sub" / "old").touch()
    (folder / "keep").touch()
    with pytest.raises(RuntimeError), whole_folder(folder) as part:
        (part / "half").touch()
        raise RuntimeError
    assert sorted(p.name for p in folder.iterdir()) == ["keep", "sub"]
    with whole_folder(folder) as part:
        (part / "sub").mkdir()
        (part / "sub" / "new").touch()
    assert [p.name for p in (folder / "sub").iterdir()] == ["new"]
    assert (folder / "keep").exists() and list(tmp_path.iterdir()) == [folder]


def test_a_new_folder_that_fails_is_not_made(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError), whole_folder(tmp_path / "out"):
        raise RuntimeError
    assert list(tmp_path.iterdir()) == []
