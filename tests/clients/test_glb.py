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


def primitives(glb: Path) -> int:
    """How many pieces of people there are to draw, from the file's JSON."""
    raw = glb.read_bytes()
    found = json.loads(raw[20 : 20 + int.from_bytes(raw[12:16], "little")])
    meshes = [node["mesh"] for node in found.get("nodes", []) if "mesh" in node and "skin" in node]
    return sum(len(found["meshes"][mesh]["primitives"]) for mesh in meshes)


@pytest.mark.parametrize("name, people, last", [("fixture", 4, 119), ("avatars", 12, 30), ("empty", 0, 0)])
def test_no_error_and_no_warning(name: str, people: int, last: int):
    code, report = validate(TMP / f"{name}.glb")
    assert code == 0 and report["errors"] == 0 and report["warnings"] == 0, report
    pieces = report["three"]["skinned_meshes"]
    assert pieces == primitives(TMP / f"{name}.glb") and 4 * people <= pieces <= 9 * people
    assert abs(report["three"]["duration"] - last / 30) < 1e-5


def test_a_characters_outfit_is_whole():
    code, report = validate(TMP / "dressed.glb")
    assert code == 0 and report["errors"] == 0 and report["warnings"] == 0, report
    assert report["info"]["hasMorphTargets"] and report["info"]["hasTextures"] and report["info"]["maxUVs"] == 2


def test_a_truncated_file_fails(tmp_path: Path):
    whole = TMP / "fixture.glb"
    if not whole.exists():
        pytest.skip(f"{whole} is not there: run `cargo test --test export` first")
    cut = tmp_path / "cut.glb"
    cut.write_bytes(whole.read_bytes()[:-1000])
    code, report = validate(cut)
    assert code == 1 and report["errors"] > 0
