"""How people walk in crowd patches: the distributions of speed, acceleration and turning."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdquilt._core import World, WorldScene, build_world
from crowdquilt.bench_row import Row, row

DENSE = """
name = "dense"
period_secs = 10.0
seed = 1
patterns = 24
endless = true
map = '''
{}
'''
[[templates]]
name = "place"
key = "p"
borders.place = {{ type = "mixed", in = 4, out = 4 }}
"""
SIDE = 16
"""Patches to a side, of 8 x 8 m with 16 people in and out each."""
STEP = 0.2
"""Seconds between looks: control points are stored for these, so that rounding them to units does not show."""
STANDING = 0.2
"""Who is slower, m/s, stands and may turn as fast as it likes."""
LIMITS = {"speed": 2.0, "acceleration": 2.5, "turning": 180.0}
UNITS = {"speed": "m/s", "acceleration": "m/s2", "turning": "deg/s"}

Floats = NDArray[np.float64]


def distributions() -> list[Row]:
    """What walkers do in a square of patches, each drawn anew: 5 %, half, 95 % of the time, and the most."""
    scene = WorldScene.from_toml(DENSE.format("\n".join(["p" * SIDE] * SIDE)))
    world, _ = build_world(scene)
    found = measured(world)
    rows = []
    for name, values in found.items():
        for share in (5, 50, 95):
            value = float(np.percentile(values, share))
            rows.append(row("world", f"walkers' {name}: {share} %", value, UNITS[name]))
        most = float(values.max())
        rows.append(row("world", f"walkers' {name}: most", most, UNITS[name], LIMITS[name], "limits of walkers"))
    return rows


def measured(world: World) -> dict[str, Floats]:
    """Speeds, accelerations and turning of everybody all the time: metres, seconds, degrees; of central differences."""
    speeds, accelerations, turning = [], [], []
    for kind in range(world.kinds):
        for _, way in world.ways(kind, STEP):
            places = way.astype(np.float64)
            velocity = (places[2:] - places[:-2]) / (2 * STEP)
            bend = (places[2:] - 2 * places[1:-1] + places[:-2]) / STEP**2
            speed = np.hypot(*velocity.T)
            walks = speed > STANDING
            across = np.abs(velocity[:, 0] * bend[:, 1] - velocity[:, 1] * bend[:, 0])[walks]
            speeds.append(speed)
            accelerations.append(np.hypot(*bend.T))
            turning.append(np.degrees(across / speed[walks] ** 2))
    lists = {"speed": speeds, "acceleration": accelerations, "turning": turning}
    return {name: np.concatenate(values) for name, values in lists.items()}
