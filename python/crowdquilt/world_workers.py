"""Who solves the cells of a world: the threads of this process, other processes, or the workers of a Dask cluster.

A crew is a function: it is given a site and blocks of its cells, and yields number and shard of every block, in any
order. Whatever happens to its workers, every block is done in the end, or an error says which could not be.
"""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from crowdquilt._core import CrowdquiltError, WorldScene, WorldSite, __version__

LOOPBACK = "127.0.0.1"
"""A cluster of our own is nobody else's business."""

MOST_DEATHS = 3
"""Workers that a block may take with it before it is given up."""


@dataclass(frozen=True)
class Round:
    """What somebody far away needs to know to solve cells of a round."""

    scene: bytes
    failures: tuple[tuple[int, ...], ...]
    version: str = __version__


Crew = Callable[[Round, WorldSite, list[list[int]]], Iterator[tuple[int, bytes]]]


@lru_cache(maxsize=2)
def site_of(work: Round) -> WorldSite:
    """The site of a round; made once in a process."""
    if work.version != __version__:
        raise CrowdquiltError(f"worker: expected Crowdquilt {work.version} as the build has, found {__version__}")
    return WorldSite(WorldScene.from_bytes(work.scene), [list(cells) for cells in work.failures])


def solve(work: Round, cells: list[int]) -> bytes:
    """Solve a block of cells on one thread, anywhere."""
    return site_of(work).solve(cells, threads=1)


def threads(work: Round, site: WorldSite, blocks: list[list[int]]) -> Iterator[tuple[int, bytes]]:
    """All cores of this process, one block after the other."""
    for index, cells in enumerate(blocks):
        yield index, site.solve(cells)


def processes(workers: int) -> Crew:
    """So many processes of this machine; those that die are replaced, and their blocks done again."""

    def crew(work: Round, site: WorldSite, blocks: list[list[int]]) -> Iterator[tuple[int, bytes]]:
        left = set(range(len(blocks)))
        for _ in range(MOST_DEATHS + 1):
            # Forked processes would share our threads' locks, not our threads.
            pool = ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"))
            try:
                futures = {pool.submit(solve, work, blocks[index]): index for index in sorted(left)}
                for future in as_completed(futures):
                    result = future.result()
                    left.discard(futures[future])
                    yield futures[future], result
                return
            except BrokenProcessPool:
                continue
            finally:
                pool.shutdown(wait=True, cancel_futures=True)
        raise CrowdquiltError(f"build: processes died {MOST_DEATHS + 1} times; {len(left)} blocks are left")

    return crew


def dask(address: str, workers: int | None = None) -> Crew:
    """The workers of a Dask cluster at `address`, with the same version of this package; "local" starts one here."""

    def crew(work: Round, site: WorldSite, blocks: list[list[int]]) -> Iterator[tuple[int, bytes]]:
        distributed = need_dask()
        with connect(distributed, address, workers) as client:
            # What a round is goes with every task, so that nothing is lost with a worker.
            futures = {client.submit(solve, work, cells, pure=False): index for index, cells in enumerate(blocks)}
            try:
                for future in distributed.as_completed(futures):
                    yield futures[future], result_of(distributed, future)
                    future.release()
            finally:
                client.cancel(list(futures))

    return crew


def result_of(distributed: Any, future: Any) -> bytes:
    """The shard of a finished task."""
    try:
        shard: bytes = future.result()
    except distributed.KilledWorker as error:
        raise CrowdquiltError(f"build: a block was given up after its workers died: {error}") from None
    return shard


def need_dask() -> Any:
    """The module `distributed`, or a message that says how to get it."""
    try:
        import distributed
    except ImportError:
        raise CrowdquiltError("--dask needs Dask: pip install 'crowdquilt[dask]'") from None
    return distributed


def connect(distributed: Any, address: str, workers: int | None) -> Any:
    """A client of the cluster at `address`, or of one started here."""
    if address != "local":
        try:
            return distributed.Client(address, timeout="20s")
        except (OSError, ValueError) as error:
            raise CrowdquiltError(f"--dask: expected a Dask scheduler at {address}, found none: {error}") from None
    # One thread each: a task solves its cells on one core.
    return distributed.Client(
        n_workers=workers, threads_per_worker=1, processes=True, host=LOOPBACK, dashboard_address=None
    )
