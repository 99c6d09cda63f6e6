"""Khronos' validator and three.js read an exported GLB without an error or a warning.

Needs Node and the two packages of `package.json` beside this file (`npm install`), and the files that
`cargo test --test export` leaves behind.
"""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

HERE = Path(__file__).parent
TMP = HERE.parents[1] / "target" / "tmp"

if shutil.which("node") is None or not (HERE / "node_modules").is_dir():
    pytest.skip(f"Node or its packages are not installed (npm install in {HERE})", allow_module_level=True)


def validate(glb: Path) -> tuple[int, dict]:
    if not glb.exists():
        pytest.skip(f"{glb} is not there: run `cargo test --test export` first")
    command = ["node", "validate_glb.mjs", glb]
    done = subprocess.run(command, cwd=HERE, capture_output=True, text=True, timeout=120, check=False)
    return done.returncode, json.loads(done.stdout)


@pytest.mark.parametrize("name, people", [("fixture", 4), ("empty", 0)])
def test_no_error_and_no_warning(name: str, people: int):
    code, report = validate(TMP / f"{name}.glb")
    assert code == 0 and report["errors"] == 0 and report["warnings"] == 0, report
    assert report["three"]["skinned_meshes"] == 5 * people  # one per material
    if people:
        assert abs(report["three"]["duration"] - 119 / 30) < 1e-5


def test_a_truncated_file_fails(tmp_path: Path):
    whole = TMP / "fixture.glb"
    if not whole.exists():
        pytest.skip(f"{whole} is not there: run `cargo test --test export` first")
    cut = tmp_path / "cut.glb"
    cut.write_bytes(whole.read_bytes()[:-1000])
    code, report = validate(cut)
    assert code == 1 and report["errors"] > 0
