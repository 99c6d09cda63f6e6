"""Goals, spectators, several periods and times of day from Python."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import crowdquilt as cq

SCENES = Path(__file__).parents[2] / "examples" / "worlds"

CROSSROADS = """
name = "crossroads"
period_secs = 12.0
map = '''
bbsbb
bbsbb
sssss
bbsbb
bbsbb
'''
goals = [{ from = [20.0, 4.0], to = [36.0, 20.0], rounds = 1 }, { from = "wood", to = "street", rounds = 1 }]
[[templates]]
name = "street"
key = "s"
borders.street = { type = "mixed", in = 3, out = 3 }
borders.house = { type = "door", in = 1, out = 1, door = [0.3, 0.7] }
[[templates]]
name = "house"
key = "b"
repeats = 2
borders.house = { type = "door", in = 1, out = 1, door = [0.3, 0.7] }
"""


@pytest.fixture(scope="module")
def street() -> cq.World:
    return cq.world.build(cq.WorldScene.load(SCENES / "street.toml"))[0]


def test_a_scene_says_goals_and_periods() -> None:
    with pytest.raises(cq.CrowdquiltError, match="goal 2: expected a place on the map"):
        cq.world.build(cq.WorldScene.from_toml(CROSSROADS))
    scene = cq.WorldScene.from_toml(CROSSROADS.replace('"wood"', '"house"'))
    world, notes = cq.world.build(scene)
    assert cq.world.check(world).ok
    assert all("goal" in note for note in notes)
    found = cq.world.journey(world, (20.0, 4.0), (36.0, 20.0), 500.0)
    assert found is not None and found[2] > found[1] >= 500.0
    with pytest.raises(cq.CrowdquiltError, match=r"expected a patch at \(900, 4\)"):
        cq.world.journey(world, (900.0, 4.0), (36.0, 20.0), 500.0)


def test_goals_lead_over_polygons_as_well() -> None:
    text = "goals = [{ from = 'square', to = 'park', rounds = 1 }]\n" + (SCENES / "square.toml").read_text()
    world, notes = cq.world.build(cq.WorldScene.from_toml(text, SCENES))
    assert cq.world.check(world).ok
    assert not any(note.startswith("goal") for note in notes)
    with pytest.raises(cq.CrowdquiltError, match=r"expected a template or a place \[x, z\], found \"moon\""):
        cq.WorldScene.from_toml(text.replace("'park'", "'moon'"), SCENES)


def test_a_spectator_is_walked_around(street: cq.World) -> None:
    spectator, place = cq.world.Spectator(street), (20.0, 12.0)
    gaps, stepped = [], 0
    for frame in range(400):
        spectator.look(frame * 0.05, place)
        _, places, _, aside = spectator.people(frame * 0.05, (*place, 12.0))
        gaps.append(np.linalg.norm(places, axis=1).min())
        stepped += int((np.linalg.norm(aside, axis=1) > 0.05).sum())
    assert stepped > 50 and min(gaps[60:]) > 0.45
    with pytest.raises(cq.CrowdquiltError, match="spectator"):
        spectator.look(float("nan"), place)


def test_days_thin_people_out(street: cq.World) -> None:
    hours = [0.2] * 6 + [1.0] * 18
    day = cq.world.Day(street, hours, ["building"])
    assert day.movable > 0.5 and day.share(3600.0) == pytest.approx(0.2)
    night, noon = day.present(5.9 * 3600), day.present(12.5 * 3600)
    assert len(night) == len(street.at(5.9 * 3600)[0]) and noon.all()
    assert 0.1 < night.mean() < 0.6
    with pytest.raises(cq.CrowdquiltError, match="24 of them, found 3"):
        cq.world.Day(street, [1.0] * 3, [])
    with pytest.raises(cq.CrowdquiltError, match="moon"):
        cq.world.Day(street, hours, ["moon"])
