"""What benches tell: one measured figure beside the published one."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """One measured figure beside the published one; `ratio` is ours over the reference, None without one."""

    area: str
    row: str
    ours: float
    unit: str
    reference: float | None
    source: str
    ratio: float | None


def row(area: str, name: str, ours: float, unit: str = "", reference: float | None = None, source: str = "") -> Row:
    """A row with its ratio."""
    ratio = ours / reference if reference else None
    return Row(area, name, ours, unit, reference, source, ratio)
