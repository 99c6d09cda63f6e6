"""The command line: helps, exit codes, progress, Ctrl-C."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import crowdfile
import crowdquilt as cq
from conftest import crowdquilt

COMMANDS = ["samples", "inspect", "patches", "tile", "check", "export", "plot", "kinds", "view", "bench", "demo"]


def test_help_names_every_command() -> None:
    text = crowdquilt("--help").stdout
    assert all(re.search(rf"\b{command}\b", text) for command in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_help_shows_an_example_that_parses(command: str) -> None:
    done = crowdquilt(command, "--help")
    assert done.returncode == 0
    examples = re.findall(rf"\$ crowdquilt {command}\b(.*)", done.stdout)
    assert examples, "no example"
    for options in (re.findall(r"(?<=\s)--?[a-z-]+", example) for example in examples):
        for option in options:
            assert re.search(rf"(?<!\w){option}\b", done.stdout.split("Example")[0]), option


def test_version() -> None:
    assert crowdquilt("--version").stdout.strip() == f"crowdquilt {cq.__version__}"


def test_samples_patches_tile_check_export_in_a_row(tmp_path: Path, scene: Path) -> None:
    folder, patches, crowd = tmp_path / "captures", tmp_path / "p.patches", tmp_path / "new" / "small.crowd"
    assert crowdquilt("samples", "-o", folder).returncode == 0
    assert crowdquilt("patches", folder, "-o", patches).returncode == 0
    report = tmp_path / "report.json"
    done = crowdquilt("tile", patches, "--scene", scene, "-o", crowd, "--report", report)
    assert done.returncode == 0, done.stdout + done.stderr
    assert len(cq.Crowd.load(crowd)) == 8
    checked = crowdquilt("check", crowd, "--json")
    told = json.loads(checked.stdout)
    assert checked.returncode == (0 if told["ok"] else 1)
    assert told["check"] == json.loads(report.read_text())["check"]
    assert crowdquilt("export", crowd, "-o", tmp_path / "small.glb").returncode == 0
    assert (tmp_path / "small.glb").read_bytes()[:4] == b"glTF"
    assert crowdquilt("export", crowd, "-o", tmp_path / "bvh").returncode == 0
    assert len(list((tmp_path / "bvh").glob("person_*.bvh"))) == 8
    inspected = json.loads(crowdquilt("inspect", tmp_path / "bvh" / "person_000.bvh", "--json").stdout)
    assert inspected["joints"] == 22 and inspected["fps"] == pytest.approx(30, abs=0.01)


def test_check_is_0_or_1_as_the_contract_holds_or_not(tmp_path: Path, walkers: Path) -> None:
    assert crowdquilt("check", walkers).returncode == 0
    close = tmp_path / "close.crowd"
    close.write_bytes(crowdfile.walkers(apart=0.2))
    done = crowdquilt("check", close)
    assert done.returncode == 1, done.stdout
    assert "1 of" in done.stdout and "rows fail" in done.stdout
    assert "✗  bodies of different patches overlap" in done.stdout


def program(patches: Path, out: Path, told: str, *options: str) -> list[str]:
    """The command line's `tile` with `told` run at every report `p` of progress, before the real one is told."""
    text = f"""
import sys
import crowdquilt.cli.progress as progress
from crowdquilt.cli import main
real = progress.tile
def tile(*args, progress, **kwargs):
    def told(p):
        {told}
        return progress(p)
    return real(*args, progress=told, **kwargs)
progress.tile = tile
sys.argv = ["crowdquilt", "tile", {str(patches)!r}, "-o", {str(out)!r}, *{options!r}]
main()
"""
    return [sys.executable, "-c", text]


def test_a_tiling_with_loose_ends_is_4_with_the_best_one_saved(tmp_path: Path, patches: Path) -> None:
    out = tmp_path / "loose.crowd"
    command = program(patches, out, "if p.danglings: return False", "--method", "paper")
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 4, done.stdout + done.stderr
    found = re.search(r"not perfect: .* (\d+) danglings", done.stdout)
    assert found, done.stdout
    assert cq.check.summary(cq.Crowd.load(out)).danglings == int(found[1]) > 0


def test_no_time_at_all_is_short_of_the_wish(tmp_path: Path, patches: Path) -> None:
    done = crowdquilt("tile", patches, "-o", tmp_path / "empty.crowd", "--method", "paper", "--time", 1e-6)
    assert done.returncode == 3, done.stdout + done.stderr
    assert len(cq.Crowd.load(tmp_path / "empty.crowd")) == 0


def start_long_solve(patches: Path, out: Path) -> subprocess.Popen[str]:
    """A solve that goes on for a minute; returns once it is under way."""
    command = program(patches, out, 'print("under way", flush=True)', "--characters", "500")
    running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert running.stdout is not None
    assert running.stdout.readline() == "under way\n"
    return running


def test_ctrl_c_keeps_the_best_tiling(tmp_path: Path, patches: Path) -> None:
    out = tmp_path / "stopped.crowd"
    running = start_long_solve(patches, out)
    time.sleep(0.5)
    asked = time.monotonic()
    running.send_signal(signal.SIGINT)
    _, errors = running.communicate(timeout=60)
    assert time.monotonic() - asked < 30
    assert running.returncode in (0, 3), errors
    assert "Traceback" not in errors
    assert len(cq.Crowd.load(out)) > 0


def test_keyboard_interrupt_in_python_carries_the_best_tiling(patches: Path) -> None:
    program = f"""
import _thread, signal, crowdquilt as cq
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
def told(p):
    _thread.interrupt_main()
try:
    cq.tiling.tile(cq.Scene.demo().replace(characters=500), cq.PatchSet.load({str(patches)!r}), progress=told)
except KeyboardInterrupt as stop:
    print(type(stop.outcome.crowd).__name__)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=90, check=False)
    assert done.stdout == "Crowd\n", done.stderr


def test_an_error_in_the_callback_comes_back(patches: Path) -> None:
    def told(_progress: object) -> None:
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        cq.tiling.tile(cq.Scene.demo().replace(characters=500), cq.PatchSet.load(patches), progress=told)


def test_a_callback_that_returns_false_stops(patches: Path) -> None:
    begin = time.monotonic()
    outcome = cq.tiling.tile(
        cq.Scene.demo().replace(characters=500), cq.PatchSet.load(patches), progress=lambda _: False
    )
    assert time.monotonic() - begin < 30
    assert outcome.status != "perfect"
