"""The same seed gives the same bytes: for one and two threads, from the command line, from Python and from Rust."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from pathlib import Path

import pytest

import crowdquilt as cq
from conftest import ROOT, crowdquilt


def digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def test_threads_do_not_matter(patches: Path, scene: Path) -> None:
    where, kinds = cq.Scene.load(scene), cq.PatchSet.load(patches)
    one, two = (cq.tiling.tile(where, kinds, seed=5, threads=n).crowd.to_bytes() for n in (1, 2))
    assert one == two
    assert cq.tiling.tile(where, kinds, seed=6).crowd.to_bytes() != one


def test_samples_depend_on_the_seed_alone(captures: Path, tmp_path: Path) -> None:
    again = cq.samples.write(tmp_path / "again", 1)
    assert all(digest(Path(p)) == digest(captures / Path(p).name) for p in again)
    other = cq.samples.write(tmp_path / "other", 2)
    assert any(digest(Path(p)) != digest(captures / Path(p).name) for p in other)


@pytest.fixture(scope="module")
def example(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that examples/demo.py makes."""
    out = tmp_path_factory.mktemp("example")
    command = [sys.executable, ROOT / "examples" / "demo.py", out]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return out


def test_the_command_line_makes_the_crowd_of_the_python_example(example: Path, tmp_path: Path) -> None:
    done = crowdquilt("demo", "-o", tmp_path / "demo")
    assert done.returncode in (0, 1, 3), done.stderr
    assert digest(tmp_path / "demo" / "crowd.crowd") == digest(example / "crowd.crowd")


def test_the_rust_example_makes_the_crowd_of_the_python_example(example: Path, tmp_path: Path) -> None:
    program = ROOT / "target" / "release" / "examples" / "pipeline"
    if not program.exists():
        pytest.skip("the Rust example is not built: run `cargo test --release` first")
    subprocess.run([program, "1", example / "captures"], cwd=tmp_path, capture_output=True, timeout=300, check=True)
    assert digest(tmp_path / "out" / "pipeline" / "crowd.crowd") == digest(example / "crowd.crowd")
