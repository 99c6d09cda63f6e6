"""The built wheel, not the checkout: it carries the studio, the licences and the types, and works on its own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from conftest import ROOT
from crowdquilt import server

MATURIN = shutil.which("maturin", path=str(Path(sys.executable).parent))


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if MATURIN is None or shutil.which("cargo") is None or not (server.STUDIO / "index.html").exists():
        assert os.environ.get("CI") != "true", "CI must test the wheel"
        pytest.skip("maturin, cargo or the built studio is not there: run `make setup`")
    out = tmp_path_factory.mktemp("wheel")
    command = [MATURIN, "build", "--quiet", "--release", "--locked", "--out", out]
    subprocess.run([*command, "--manifest-path", ROOT / "python" / "Cargo.toml"], check=True, timeout=900)
    return next(out.glob("crowdquilt-*.whl"))


def test_it_carries_what_it_needs(wheel: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    for name in ("_core.abi3.so", "_core.pyi", "py.typed", "studio_dist/index.html"):
        assert f"crowdquilt/{name}" in names, name
    assert any(n.startswith("crowdquilt/studio_dist/assets/") and n.endswith(".js") for n in names)
    for name in ("LICENSE", "NOTICE", "THIRD_PARTY.md"):
        assert any(n.endswith(f"licenses/{name}") for n in names), name
    assert not any("test" in n for n in names)


def test_it_works_away_from_the_checkout(wheel: Path, tmp_path: Path, walkers: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path / "site")
    program = f"""
import crowdquilt, crowdquilt.server
assert crowdquilt.__file__.startswith({str(tmp_path)!r}), crowdquilt.__file__
crowdquilt.server.app(__import__("pathlib").Path({str(walkers)!r}))
print(len(crowdquilt.Crowd.load({str(walkers)!r})))
"""
    env = os.environ | {"PYTHONPATH": str(tmp_path / "site")}
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, env=env, capture_output=True, text=True, check=False
    )
    assert done.stdout == "3\n", done.stderr
