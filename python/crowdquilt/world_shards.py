"""Builds of large worlds: in shards, which are kept, so that a build that was killed goes on where it was.

A folder of shards holds one file per block of cells and `index.jsonl`: JSON, one value per line. The first line
says which build it is of; every other line names a shard, its round and cells, and the SHA-256 of its bytes. A shard
is written under another name, renamed, and then named in the index: so whatever the index names was whole. A line
that was cut is no line. A shard whose bytes have another hash is named, its cells are done again, and another line
with an empty hash takes it back.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import IO

from crowdquilt._core import CrowdquiltError, World, WorldScene, WorldSite, __version__
from crowdquilt.world_workers import Crew, Round, threads

INDEX = "index.jsonl"
FORMAT = 1
BLOCK = 64
"""Cells of a block: a quarter of a second's work or so, and some hundred kilobytes."""

Progress = Callable[[tuple[int, int]], object]


@dataclass(frozen=True)
class Entry:
    """A shard, as the index names it."""

    shard: str
    round: int
    cells: list[int]
    sha256: str


def build_sharded(
    scene: WorldScene,
    folder: Path,
    *,
    crew: Crew = threads,
    block: int = BLOCK,
    progress: Progress | None = None,
) -> tuple[World, list[str]]:
    """Build the world of `scene` in shards that are kept in `folder`, or go on with those that are there.

    The world is the same to the byte for any crew, size of blocks, and number of times that the build was killed.
    Returns it, and what had to be repaired, left out or done again, in words. `progress((done, all))` is told about
    cells, and stops the build by returning False.
    """
    if block < 1:
        raise CrowdquiltError(f"build: expected blocks of at least 1 cell, found {block}")
    site, told = WorldSite(scene), progress or (lambda _: True)
    notes: list[str] = []
    with Shards(folder, scene) as shards:
        while site.left:
            for entry, problem in shards.take(site):
                notes.append(f"{folder / entry.shard}: {problem}: {len(entry.cells)} cells are done again")
            work = Round(scene.to_bytes(), tuple(tuple(cells) for cells in site.failures))
            for cells, shard in solved(work, site, block, crew, told):
                shards.add(site.round, cells, shard)
                site.take(shard)
            site.end_round()
    world, repaired = site.bake()
    return world, notes + repaired


def solved(work: Round, site: WorldSite, block: int, crew: Crew, told: Progress) -> Iterator[tuple[list[int], bytes]]:
    """Cells and shard of every block of the round that is open."""
    cells = site.open
    blocks = [cells[at : at + block] for at in range(0, len(cells), block)]
    done = site.cells - len(cells)
    for index, shard in crew(work, site, blocks) if blocks else ():
        yield blocks[index], shard
        done += len(blocks[index])
        if told((done, site.cells)) is False:
            raise CrowdquiltError("stopped")


class Shards:
    """The shards of a build, in a folder that no other build uses meanwhile."""

    def __init__(self, folder: Path, scene: WorldScene) -> None:
        """Open the folder, or make it."""
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        build = hashlib.sha256(scene.to_bytes() + __version__.encode()).hexdigest()
        self.head = {"format": FORMAT, "name": scene.name, "version": __version__, "build": build}
        self.index: IO[bytes] = (folder / INDEX).open("a+b")
        try:
            lock(self.index, folder)
            self.entries = self._read()
        except BaseException:
            self.index.close()
            raise

    def __enter__(self) -> Shards:
        """Nothing more."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the index."""
        self.index.close()

    def _read(self) -> dict[str, Entry]:
        """What the index names; of a shard that it names twice, the last."""
        self.index.seek(0)
        lines = self.index.read().split(b"\n")
        cut = lines.pop()
        if cut:
            # The build was killed as it wrote this.
            self.index.truncate(sum(len(line) + 1 for line in lines))
        if not lines:
            self._append(self.head)
            return {}
        place = self.folder / INDEX
        head = parsed(lines[0], f"{place}: line 1")
        if head != self.head:
            found = f"{head.get('name')!r} (version {head.get('version')}, build {str(head.get('build'))[:12]})"
            own = f"{self.head['name']!r} (version {__version__}, build {self.head['build']!s:.12})"
            raise CrowdquiltError(f"{place}: line 1: expected shards of {own}, found those of {found}")
        entries: dict[str, Entry] = {}
        for number, line in enumerate(lines[1:], 2):
            entry = entry_of(line, f"{place}: line {number}")
            entries[entry.shard] = entry
        # Whose cells were done again since have no hash any more.
        return {name: entry for name, entry in entries.items() if entry.sha256}

    def _append(self, value: dict[str, object]) -> None:
        """Add a line to the index, and see that it is on the disk."""
        self.index.write(json.dumps(value).encode() + b"\n")
        self.index.flush()
        os.fsync(self.index.fileno())

    def take(self, site: WorldSite) -> Iterator[tuple[Entry, str]]:
        """Give the site all whole shards of its round; yield those that are not."""
        for entry in [entry for entry in self.entries.values() if entry.round == site.round]:
            problem = self._give(site, entry)
            if problem:
                del self.entries[entry.shard]
                self._append(asdict(replace(entry, sha256="")))
                (self.folder / entry.shard).unlink(missing_ok=True)
                yield entry, problem

    def _give(self, site: WorldSite, entry: Entry) -> str | None:
        """Give a shard to the site; what is wrong with it, if anything."""
        try:
            data = (self.folder / entry.shard).read_bytes()
        except OSError as error:
            return str(error.strerror)
        found = hashlib.sha256(data).hexdigest()
        if found != entry.sha256:
            return f"expected SHA-256 {entry.sha256[:12]}..., found {found[:12]}..."
        try:
            site.take(data)
        except CrowdquiltError as error:
            return str(error)
        return None

    def add(self, number: int, cells: list[int], data: bytes) -> None:
        """Keep a shard."""
        name = f"{number}-{cells[0]:08}-{len(cells)}.shard"
        part = self.folder / f".{name}.part"
        with part.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        part.replace(self.folder / name)
        entry = Entry(name, number, cells, hashlib.sha256(data).hexdigest())
        self._append(asdict(entry))
        self.entries[name] = entry


def parsed(line: bytes, place: str) -> dict[str, object]:
    """A line of an index."""
    try:
        value = json.loads(line)
    except ValueError:
        value = None
    if not isinstance(value, dict):
        raise CrowdquiltError(f"{place}: expected a JSON object, found {line[:40]!r}")
    return value


def entry_of(line: bytes, place: str) -> Entry:
    """A shard that an index names."""
    value = parsed(line, place)
    types = {"shard": str, "round": int, "cells": list, "sha256": str}
    odd = [name for name, kind in types.items() if not isinstance(value.get(name), kind)]
    if odd or Path(str(value["shard"])).name != value["shard"]:
        raise CrowdquiltError(f"{place}: expected shard, round, cells and sha256, found {line[:80]!r}")
    return Entry(**{name: value[name] for name in types})  # type: ignore[arg-type]


def lock(file: IO[bytes], folder: Path) -> None:
    """See that no other build writes to the folder; the lock ends with the process."""
    try:
        import fcntl
    except ImportError:  # not on Windows
        return
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        raise CrowdquiltError(f"{folder}: expected a folder of our own, found a build that uses it") from None
