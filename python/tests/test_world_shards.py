"""Builds in shards: killed, resumed, damaged, by processes and by Dask; the world is always the same to the byte."""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import crowdquilt as cq
from crowdquilt import world_shards, world_workers

SCENES = Path(__file__).parents[2] / "examples" / "worlds"
BLOCK = 40


@pytest.fixture(scope="module")
def city() -> cq.WorldScene:
    return cq.WorldScene.load(SCENES / "city.toml")


@pytest.fixture(scope="module")
def local(city: cq.WorldScene) -> bytes:
    return cq.world.build(city)[0].to_bytes()


class Watched:
    """The threads of this process; remembers which cells they were given."""

    def __init__(self) -> None:
        self.cells: list[int] = []

    def __call__(
        self, work: world_workers.Round, site: cq.WorldSite, blocks: list[list[int]]
    ) -> Iterator[tuple[int, bytes]]:
        self.cells += [cell for block in blocks for cell in block]
        return world_workers.threads(work, site, blocks)


def index_of(folder: Path) -> list[dict[str, object]]:
    return [json.loads(line) for line in (folder / "index.jsonl").read_text().splitlines()[1:]]


def test_shards_make_the_same_world(city: cq.WorldScene, local: bytes, tmp_path: Path) -> None:
    steps: list[tuple[int, int]] = []
    made, notes = cq.world.build_sharded(city, tmp_path, block=BLOCK, progress=steps.append)
    assert made.to_bytes() == local and notes == []
    assert steps[-1][0] == steps[-1][1] and len(steps) == len(index_of(tmp_path)) > 5
    again = Watched()
    assert cq.world.build_sharded(city, tmp_path, crew=again)[0].to_bytes() == local
    assert again.cells == []


def test_an_area_is_built_in_rounds(tmp_path: Path) -> None:
    scene = cq.WorldScene.load(SCENES / "square.toml")
    world, notes = cq.world.build(scene)
    made, told = cq.world.build_sharded(scene, tmp_path, block=7)
    assert made.to_bytes() == world.to_bytes() and told == notes


def test_a_killed_build_goes_on(city: cq.WorldScene, local: bytes, tmp_path: Path) -> None:
    shards, out = tmp_path / "shards", tmp_path / "city.world"
    words = ["world", SCENES / "city.toml", "-o", out, "--shards", shards, "--no-bodies"]
    command = [sys.executable, "-m", "crowdquilt", *words]
    build = subprocess.Popen([*map(str, command)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    deadline = time.monotonic() + 120
    while len(list(shards.glob("*.shard"))) < 3:
        assert build.poll() is None and time.monotonic() < deadline, build.communicate()
        time.sleep(0.005)
    build.send_signal(signal.SIGKILL)
    build.wait()
    done = {cell for entry in index_of(shards) for cell in entry["cells"]}
    again = Watched()
    made, _ = cq.world.build_sharded(city, shards, crew=again)
    assert made.to_bytes() == local
    assert done and again.cells and not done & set(again.cells)
    assert not out.exists()


def test_damaged_shards_are_named_and_done_again(city: cq.WorldScene, local: bytes, tmp_path: Path) -> None:
    cq.world.build_sharded(city, tmp_path, block=BLOCK)
    entries = index_of(tmp_path)
    damaged, lost = tmp_path / str(entries[1]["shard"]), tmp_path / str(entries[3]["shard"])
    data = bytearray(damaged.read_bytes())
    data[len(data) // 2] ^= 1
    damaged.write_bytes(data)
    lost.unlink()
    with (tmp_path / "index.jsonl").open("ab") as index:
        index.write(b'{"shard": "0-000')
    again = Watched()
    made, notes = cq.world.build_sharded(city, tmp_path, crew=again)
    assert made.to_bytes() == local
    assert again.cells == sorted(entries[1]["cells"] + entries[3]["cells"])
    assert len(notes) == 2 and str(damaged) in notes[0] and "SHA-256" in notes[0] and str(lost) in notes[1]
    assert cq.world.build_sharded(city, tmp_path, crew=again)[1] == []


def test_a_folder_is_of_one_build(city: cq.WorldScene, tmp_path: Path) -> None:
    with world_shards.Shards(tmp_path, city), pytest.raises(cq.CrowdquiltError, match="found a build that uses it"):
        cq.world.build_sharded(city, tmp_path)
    with pytest.raises(cq.CrowdquiltError, match=r"index\.jsonl: line 1: expected shards of 'city'"):
        cq.world.build_sharded(city.replace(seed=9), tmp_path)
    (tmp_path / "index.jsonl").write_text("[]\n")
    with pytest.raises(cq.CrowdquiltError, match="line 1: expected a JSON object"):
        cq.world.build_sharded(city, tmp_path)


def test_processes_that_die_are_replaced(city: cq.WorldScene, local: bytes, tmp_path: Path) -> None:
    killed: list[int] = []

    def kill(step: tuple[int, int]) -> None:
        if not killed:
            killed.append(multiprocessing.active_children()[0].pid or 0)
            os.kill(killed[0], signal.SIGKILL)

    crew = world_workers.processes(2)
    made, notes = cq.world.build_sharded(city, tmp_path, crew=crew, block=BLOCK, progress=kill)
    assert made.to_bytes() == local and killed and notes == []


def test_a_worker_of_a_dask_cluster_that_dies_loses_nothing(city: cq.WorldScene, local: bytes, tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed", reason="Dask is not installed")
    killed: list[int] = []
    settings = {"host": "127.0.0.1", "dashboard_address": None}
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, **settings) as cluster,
        distributed.Client(cluster) as client,
    ):
        assert cluster.scheduler_address.startswith("tcp://127.0.0.1:")
        pids = list(client.run(os.getpid).values())

        def kill(step: tuple[int, int]) -> None:
            if not killed and step[0] < step[1]:
                killed.append(pids[0])
                os.kill(pids[0], signal.SIGKILL)

        crew = world_workers.dask(cluster.scheduler_address)
        made, notes = cq.world.build_sharded(city, tmp_path, crew=crew, block=8, progress=kill)
    assert made.to_bytes() == local and killed and notes == []
    assert sorted(cell for entry in index_of(tmp_path) for cell in entry["cells"]) == list(range(made.kinds))


def test_a_dask_cluster_of_our_own_by_the_command_line(tmp_path: Path) -> None:
    pytest.importorskip("distributed", reason="Dask is not installed")
    out, plain = tmp_path / "dask.world", tmp_path / "plain.world"
    base = [sys.executable, "-m", "crowdquilt", "world", str(SCENES / "street.toml"), "--no-bodies", "-o"]
    extra = ["--shards", str(tmp_path / "shards"), "--dask", "local", "--workers", "1"]
    for arguments in [[*base, str(out), *extra], [*base, str(plain)]]:
        found = subprocess.run(arguments, capture_output=True, text=True, timeout=300)
        assert found.returncode == 0, found.stderr
    assert out.read_bytes() == plain.read_bytes()


def test_a_scheduler_that_is_not_there_is_named(tmp_path: Path) -> None:
    pytest.importorskip("distributed", reason="Dask is not installed")
    command = [
        sys.executable,
        "-m",
        "crowdquilt",
        "world",
        str(SCENES / "street.toml"),
        "-o",
        str(tmp_path / "x.world"),
    ]
    for extra, expected in [
        (["--dask", "local"], "--shards"),
        (["--shards", str(tmp_path), "--dask", "nonsense"], "nonsense"),
    ]:
        found = subprocess.run([*command, *extra], capture_output=True, text=True, timeout=300)
        assert found.returncode == 2 and expected in found.stderr and "Traceback" not in found.stderr
