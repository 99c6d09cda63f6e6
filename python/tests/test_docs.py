"""Documents cannot rot: the paths they name exist, their commands are commands, their programs run."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import ROOT, crowdquilt

DOCUMENTS = [p for p in (ROOT / "README.md", ROOT / "ARCHITECTURE.md", *(ROOT / "docs").rglob("*.md")) if p.exists()]
NAMES = [str(p.relative_to(ROOT)) for p in DOCUMENTS]
README = (ROOT / "README.md").read_text()


@pytest.mark.parametrize("name", NAMES)
def test_linked_paths_exist(name: str) -> None:
    links = re.findall(r"\]\(([^)#\s]+)", (ROOT / name).read_text())
    missing = [link for link in links if "://" not in link and not (ROOT / name).parent.joinpath(link).exists()]
    assert not missing


@pytest.mark.parametrize("name", NAMES)
def test_named_source_paths_exist(name: str) -> None:
    quoted = re.findall(
        r"`((?:src|python|studio|tests|examples|docs|fuzz|benches)/[\w./*-]*)`", (ROOT / name).read_text()
    )
    missing = [path for path in quoted if not list(ROOT.glob(path.rstrip("/")))]
    assert not missing


def test_make_targets_of_the_readme_exist() -> None:
    targets = set(re.findall(r"(?:^|`)make ([a-z][a-z-]*)", README, flags=re.MULTILINE))
    assert {"demo", "test", "view"} <= targets
    for target in targets:
        done = subprocess.run(["make", "-n", target], cwd=ROOT, capture_output=True, text=True, check=False)
        assert "No rule to make target" not in done.stderr, target


def commands() -> list[str]:
    return re.findall(r"^crowdquilt .*?(?=\s+#|$)", README, flags=re.MULTILINE)


@pytest.mark.parametrize("line", commands())
def test_commands_of_the_readme_exist_with_their_options(line: str) -> None:
    _, command, *words = line.split()
    done = crowdquilt(command, "--help")
    assert done.returncode == 0, line
    for option in (word for word in words if word.startswith("-")):
        assert re.search(rf"(?<!\w){option}\b", done.stdout), option
    for path in (word for word in words if word.startswith("examples/")):
        assert (ROOT / path).exists(), path


def test_readme_names_every_command() -> None:
    told = {line.split()[1] for line in commands()}
    listed = set(re.findall(r"^│ (\w+)", crowdquilt("--help").stdout.split("Commands")[1], flags=re.MULTILINE))
    assert listed - told <= {"demo"}  # `make demo`


def test_the_python_of_the_readme_is_the_api() -> None:
    import crowdquilt as cq

    code = "\n".join(re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL))
    compile(code, "README.md", "exec")
    for name in set(re.findall(r"\bcq((?:\.\w+)+)", code)):
        thing: object = cq
        for part in name.strip(".").split("."):
            thing = getattr(thing, part)


def test_the_documented_reader_of_patch_sets_runs_and_is_right(
    patches: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import crowdquilt as cq

    monkeypatch.chdir(tmp_path)
    Path("people.patches").write_bytes(patches.read_bytes())
    code = "\n".join(
        re.findall(r"```python\n(.*?)```", (ROOT / "docs/formats/patches.md").read_text(), flags=re.DOTALL)
    )
    read: dict[str, Any] = {}
    exec(compile(code, "patches.md", "exec"), read)
    made = cq.PatchSet.load(patches)
    assert [k["name"] for k in read["header"]["kinds"]] == [k.name for k in made.kinds]
    kinds = [0, len(made) // 2, next(i for i, k in enumerate(made.kinds) if k.people == 3)]
    for kind in kinds:
        for role in range(made.kinds[kind].people):
            assert np.allclose(read["positions"](kind, role), cq.patch.positions(made, kind, role), atol=1e-4)


def test_the_documented_fields_of_patch_sets_are_those_of_the_file(patches: Path) -> None:
    """Every field of the header is named in the document."""
    data = patches.read_bytes()
    header = json.loads(data[24 : 24 + int.from_bytes(data[12:16], "little")])
    kinds = header["kinds"]
    prop = next(p for k in kinds for p in k["props"])
    contact = next(c for k in kinds for c in k["contacts"])
    fragment = next(f for k in kinds for f in k["fragments"] if f["plants"])
    stored = [header, kinds[0], fragment, fragment["plants"][0], contact, contact["a"], prop, prop["holds"][0]]
    names = {name for part in stored for name in part} | set(header["arrays"]) | {"name", "parent", "offset", "tip"}
    told = set(re.findall(r"`([\w.]+)`", (ROOT / "docs/formats/patches.md").read_text()))
    told |= {word for name in told for word in name.split(".")}
    assert names <= told


def test_the_example_scene_is_valid() -> None:
    import crowdquilt as cq

    for scene in (ROOT / "examples").glob("*.toml"):
        assert cq.Scene.load(scene).characters > 0


def test_all_linked_crates_are_named_with_their_licences() -> None:
    told = (ROOT / "THIRD_PARTY.md").read_text()
    command = [
        "cargo",
        "tree",
        "--locked",
        "-p",
        "crowdquilt-python",
        "-e",
        "normal",
        "--prefix",
        "none",
        "--format",
        "{p}",
    ]
    tree = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    crates = {line.split()[0] for line in tree.splitlines() if line and "(/" not in line}
    missing = sorted(crate for crate in crates if f"| {crate} |" not in told)
    assert not missing


def test_package_versions_agree() -> None:
    versions = {
        str(path.relative_to(ROOT)): re.search(pattern, path.read_text(), flags=re.MULTILINE)[1]
        for path, pattern in [
            (ROOT / "Cargo.toml", r'^version = "(.*)"'),
            (ROOT / "python" / "Cargo.toml", r'^version = "(.*)"'),
            (ROOT / "python" / "pyproject.toml", r'^version = "(.*)"'),
            (ROOT / "studio" / "package.json", r'"version": "(.*)"'),
            (ROOT / "CITATION.cff", r"^version: (.*)"),
        ]
    }
    assert len(set(versions.values())) == 1, versions


@pytest.mark.parametrize("package", ["samples", "motion", "patch", "tiling", "stage", "check", "export"])
def test_one_name_for_rust_module_glue_and_python_module(package: str) -> None:
    assert (ROOT / "src" / package / "mod.rs").exists()
    assert (ROOT / "python" / "src" / f"{package}.rs").exists()
    assert (ROOT / "python" / "crowdquilt" / f"{package}.py").exists()


def test_paths_stay_inside(tmp_path: Path) -> None:
    """No document or source names a folder of the machine it was written on."""
    done = subprocess.run(
        ["git", "grep", "-lE", r"/(home|root|Users)/[a-z]+/"], cwd=ROOT, capture_output=True, text=True
    )
    assert done.stdout.splitlines() in ([], ["python/tests/test_docs.py"])
