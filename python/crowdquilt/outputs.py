"""Outputs appear whole or not at all: written beside their place, then moved there."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Yield a path to write to; it becomes `path` on success and vanishes on failure."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.stem}.part{path.suffix}")
    try:
        yield part
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


@contextmanager
def whole_folder(folder: Path, stale: str | None = None) -> Iterator[Path]:
    """Yield an empty folder to write to; on success its entries move into `folder`, whose other entries stay.

    Files of `folder` that match the pattern `stale` and were not written again are removed: they were made by
    an earlier run and would pass for this one's.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    part = Path(tempfile.mkdtemp(prefix=f".{folder.name}.part.", dir=folder.parent))
    try:
        yield part
        folder.mkdir(exist_ok=True)
        written = {file.name for file in part.iterdir()}
        for name in sorted(written):
            if (folder / name).is_dir():
                # A folder cannot be replaced: the old one moves out of the way and goes with the temporary folder.
                (folder / name).replace(part / f"{name}.old")
            (part / name).replace(folder / name)
        for file in folder.glob(stale) if stale else ():
            if file.name not in written:
                file.unlink()
    finally:
        shutil.rmtree(part, ignore_errors=True)
