"""Other people's steering on our street, where it is installed: agent-steps per second, to put beside replay."""

from __future__ import annotations

import time
from collections.abc import Callable
from importlib.metadata import version
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdquilt._core import World, WorldScene, build_world

STREET = """
name = "street"
period_secs = 10.0
map = '''
bbbbbbbbbbbbbbbb
ssssssssssssssss
ssssssssssssssss
bbbbbbbbbbbbbbbb
'''
[[templates]]
name = "street"
key = "s"
borders.street = { type = "lanes", in = 4, out = 4 }
[[templates]]
name = "building"
key = "b"
"""
LONG, LOW, HIGH = 128.0, 8.0, 24.0
"""The street in metres: its length, and where it begins and ends across."""
STEPS = 50
SECS = 0.1
"""Steps of this length are what steering needs to stay stable."""

Steering = Callable[[World], float]


def street() -> World:
    """The street of the paper without what stands in it."""
    world: World = build_world(WorldScene.from_toml(STREET))[0]
    return world


def people(world: World) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Places and velocities of all who walk and are not at the edge."""
    _, places, velocities = world.at(0.0)
    inside = (places[:, 0] > 1) & (places[:, 0] < LONG - 1) & (places[:, 1] > LOW + 0.5) & (places[:, 1] < HIGH - 0.5)
    return places[inside], velocities[inside]


def timed(agents: int, step: Callable[[], object]) -> float:
    """Agent-steps per second, of three runs of `STEPS` steps the median."""
    found = []
    for _ in range(3):
        begin = time.perf_counter()
        for _ in range(STEPS):
            step()
        found.append(agents * STEPS / (time.perf_counter() - begin))
    return median(found)


def pyrvo(world: World) -> float:
    """Optimal reciprocal collision avoidance: everybody wants to go on as they do."""
    import pyrvo as library

    places, velocities = people(world)
    simulator = library.RVOSimulator(SECS, 5.0, 10, 2.0, 2.0, world.radius, 2.0)
    for place, velocity in zip(places.tolist(), velocities.tolist(), strict=True):
        agent = simulator.add_agent(tuple(place))
        simulator.set_agent_pref_velocity(agent, tuple(velocity))
    return timed(len(places), simulator.do_step)


def jupedsim(world: World) -> float:
    """The collision-free speed model: everybody walks to the end of the street that they walk towards."""
    import jupedsim as library

    places, velocities = people(world)
    geometry = [(0.0, LOW), (LONG, LOW), (LONG, HIGH), (0.0, HIGH)]
    simulation = library.Simulation(model=library.CollisionFreeSpeedModel(), geometry=geometry, dt=SECS)
    ways = [way(library, simulation, x) for x in (0.0, LONG - 0.5)]
    for place, velocity in zip(places.tolist(), velocities.tolist(), strict=True):
        journey, stage = ways[int(velocity[0] > 0)]
        agent = library.CollisionFreeSpeedModelAgentParameters(
            journey_id=journey, stage_id=stage, position=tuple(place), radius=world.radius * 0.9
        )
        simulation.add_agent(agent)
    return timed(simulation.agent_count(), simulation.iterate)


def way(library: Any, simulation: Any, x: float) -> tuple[int, int]:
    """A journey to an exit at an end of the street, and its stage."""
    stage = simulation.add_exit_stage([(x, LOW), (x + 0.5, LOW), (x + 0.5, HIGH), (x, HIGH)])
    return simulation.add_journey(library.JourneyDescription([stage])), stage


LIBRARIES: dict[str, Steering] = {"pyrvo": pyrvo, "jupedsim": jupedsim}


def measured(say: Callable[[str], None]) -> dict[str, float]:
    """Agent-steps per second of each library that is installed, by its name and version."""
    world, found = street(), {}
    for name, steer in LIBRARIES.items():
        try:
            rate = steer(world)
        except ImportError:
            say(f"stage: {name}: skipped, not installed (pip install 'crowdquilt[steering]')")
            continue
        say(f"stage: {name}: {rate / 1e6:.3g} M agent-steps/s")
        found[f"{name} {version(name)}"] = rate
    return found
