"""Crowd patches: populated worlds from pieces of periodic animation, built from scene files."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from crowdquilt import patch, samples
from crowdquilt._core import Day, PatchSet, Pattern, Spectator, World, WorldScene, WorldSite, journey
from crowdquilt._core import build_world as build
from crowdquilt._core import check_world as check
from crowdquilt.outputs import whole_file
from crowdquilt.world_shards import build_sharded
from crowdquilt.world_workers import Crew, dask, processes, threads

__all__ = [
    "Crew",
    "Day",
    "Pattern",
    "Spectator",
    "World",
    "WorldScene",
    "WorldSite",
    "build",
    "build_sharded",
    "check",
    "dask",
    "facts",
    "holds_world",
    "journey",
    "processes",
    "sample_walks",
    "save",
    "threads",
]

MAGIC = b"CQWORLD"


def holds_world(path: Path) -> bool:
    """Whether a file is a baked world, told by its first bytes."""
    with path.open("rb") as file:
        return file.read(len(MAGIC)) == MAGIC


def sample_walks() -> PatchSet:
    """The patch set of the generated captures: how people walk if nobody says otherwise."""
    with tempfile.TemporaryDirectory() as folder:
        samples.write(Path(folder), 1)
        return patch.cut(Path(folder), study=False)


def save(world: World, path: Path) -> None:
    """Write a world file, whole or not at all, and the folders it is in."""
    with whole_file(path) as part:
        world.save(part)


def facts(world: World) -> dict[str, Any]:
    """What a world consists of, in figures."""
    objects = [len(world.objects(kind)) for kind in range(world.kinds)]
    return {
        "name": world.name,
        "seed": world.seed,
        "period_secs": world.period_secs,
        "patches": len(world),
        "kinds": world.kinds,
        "patterns": world.patterns,
        "walkers": round(world.walkers),
        "stayers": world.stayers,
        "objects": int(sum(objects[kind] for kind in world.instances)),
        "repeats_m": world.repeat,
        "memory_mb": round(world.memory / 1e6, 3),
    }
