"""What many tests share: the command line as a process, samples, a small patch set and a small crowd."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import crowdfile
import crowdquilt as cq

ROOT = Path(__file__).parents[2]
SCENE = "region = [[0, 0], [7, 0], [7, 7], [0, 7]]\nduration_secs = 5.0\ncharacters = 8\ninteraction = 0.1\n"


def crowdquilt(*args: object, cwd: Path | None = None, timeout: float = 300) -> subprocess.CompletedProcess[str]:
    """Run the command line as a user does."""
    command = [sys.executable, "-m", "crowdquilt", *map(str, args)]
    env = os.environ | {"COLUMNS": "200", "TERM": "dumb", "NO_COLOR": "1"}
    return subprocess.run(command, cwd=cwd, env=env, capture_output=True, text=True, timeout=timeout, check=False)


@pytest.fixture(scope="session")
def captures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("captures")
    cq.samples.write(folder, 1)
    return folder


@pytest.fixture(scope="session")
def patches(captures: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("patches") / "samples.patches"
    cq.patch.cut(captures).save(path)
    return path


@pytest.fixture(scope="session")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scene") / "small.toml"
    path.write_text(SCENE)
    return path


@pytest.fixture(scope="session")
def small(patches: Path, scene: Path) -> cq.Outcome:
    """A small scene, solved."""
    return cq.tiling.tile(cq.Scene.load(scene), cq.PatchSet.load(patches), seed=1)


@pytest.fixture
def walkers(tmp_path: Path) -> Path:
    """A crowd file written by its documented layout alone: three people walking abreast."""
    path = tmp_path / "walkers.crowd"
    path.write_bytes(crowdfile.walkers())
    return path
