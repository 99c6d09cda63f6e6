"""Scenes: obstacles that move, wishes as functions, overrides of the command line, pictures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import crowdquilt as cq
from crowdquilt.plot import loom, plan

FOLDER = Path(__file__).parents[2] / "examples" / "scenes"
CART = """
region = [[0, 0], [8, 0], [8, 8], [0, 8]]
duration_secs = 6
density = 0.1
interaction = 0.0
[[obstacle]]
outline = [[-0.8, -0.15], [0.8, -0.15], [0.8, 0.15], [-0.8, 0.15]]
height = 0.2
path = [[1, 2, 4, 90], [5, 6, 4, 90]]
"""


@pytest.fixture(scope="module")
def sample_set(patches: Path) -> cq.PatchSet:
    return cq.PatchSet.load(patches)


def test_obstacles_say_where_they_are_when() -> None:
    scene = cq.Scene.from_toml(CART)
    assert scene.characters == 6
    (cart,) = scene.obstacles
    assert cart.moves
    assert cart.height == pytest.approx(0.2)
    assert cart.path.shape == (2, 4)
    for secs, x in ((0.0, 2.0), (3.0, 4.0), (9.0, 6.0)):
        np.testing.assert_allclose(cart.at(secs).mean(axis=0), [x, 4.0], atol=1e-5)
    # Turned by a quarter its length lies along z.
    assert np.ptp(cart.at(2.0)[:, 1]) == pytest.approx(1.6, abs=1e-5)


def test_a_crowd_keeps_its_obstacles_and_is_drawn_with_them(sample_set: cq.PatchSet, tmp_path: Path) -> None:
    outcome = cq.tiling.tile(cq.Scene.from_toml(CART), sample_set, seed=1)
    assert cq.check.check(outcome.crowd).ok
    outcome.crowd.save(tmp_path / "cart.crowd")
    (cart,) = cq.Crowd.load(tmp_path / "cart.crowd").obstacles
    assert cart.moves and cart.height == pytest.approx(0.2)
    for draw in (plan, loom):
        assert isinstance(draw(outcome.crowd), Figure)


def test_overrides_stand_in_for_the_scene() -> None:
    scene = cq.Scene.load(FOLDER / "static-1.toml")
    assert scene.replace(density=0.5).characters == 72
    assert scene.replace(characters=5, interaction=0.0).characters == 5
    with pytest.raises(cq.CrowdquiltError, match="density"):
        scene.replace(density=0.5, characters=3)


def test_functions_of_ones_own_are_called_once_and_followed(sample_set: cq.PatchSet) -> None:
    calls = []

    def corner(places: np.ndarray) -> np.ndarray:
        calls.append(places.shape)
        return ((places - [2.0, 2.0]) ** 2).sum(axis=1)

    plain = cq.Scene.demo().replace(characters=12, interaction=0.0, duration_secs=8.0)
    wanted = cq.tiling.prefer(plain, sample_set, position=corner, sigma=(2.0, 1.0, 1.0, 1.0))
    assert len(calls) == 1 and calls[0][1] == 2

    def distance(scene: cq.Scene) -> float:
        crowd = cq.tiling.tile(scene, sample_set, seed=3).crowd
        roots = np.concatenate([crowd.roots(p) for p in range(len(crowd))])[:, [0, 2]]
        return float(np.hypot(*(roots - 2.0).T).mean())

    assert distance(wanted) < distance(plain) - 1.5


def test_every_term_takes_arrays_and_bad_numbers_are_named(sample_set: cq.PatchSet) -> None:
    scene = cq.Scene.demo()
    cq.tiling.prefer(
        scene,
        sample_set,
        direction=lambda places, headings: 1 - np.cos(headings - places[:, 0] / 12),
        time=lambda secs: (secs > 10) * 1.0,
        kind=lambda kinds: [0.0 if "walk" in k.labels else 1.0 for k in kinds],
    )
    with pytest.raises(cq.CrowdquiltError, match="time: expected numbers that are finite and not negative"):
        cq.tiling.prefer(scene, sample_set, time=lambda secs: secs - 1)


def test_what_cannot_be_done_is_refused_with_its_name(sample_set: cq.PatchSet) -> None:
    for key, text in (("source", "[[source]]\nat = [0, 4]\nrate = 1\n"), ("periodic", "")):
        head = 'periodic = ["x"]\n' if key == "periodic" else ""
        scene = cq.Scene.from_toml(head + CART + text)
        with pytest.raises(cq.CrowdquiltError, match=key):
            cq.tiling.tile(scene, sample_set, method="paper")


WANG = """region = [[0, 0], [16, 0], [16, 16], [0, 16]]
duration_secs = 8
characters = 48
interaction = 0.1

[wang]
tile = 8
"""


def test_a_plane_of_tiles_is_tiled_and_checked(sample_set: cq.PatchSet) -> None:
    outcome = cq.tiling.tile(cq.Scene.from_toml(WANG), sample_set, seed=1)
    assert outcome.status == "perfect", outcome.reason
    assert len(outcome.crowd) == 48
    report = cq.check.check(outcome.crowd)
    assert report.ok, report


def test_all_that_is_wrong_with_tiles_is_told_with_its_line(sample_set: cq.PatchSet) -> None:
    text = WANG.replace("[16, 16], [0, 16]", "[16, 17], [0, 17]").replace("tile = 8", "tile = 8\ncolors = 2")
    with pytest.raises(cq.CrowdquiltError) as told:
        cq.Scene.from_toml('periodic = ["t"]\n' + text + "[[source]]\nat = [0, 4]\nrate = 1\n")
    for part in ("line 1: periodic", "line 2", "whole tiles of 8 m", "line 9", "colors", "line 10: source"):
        assert part in str(told.value), part
    with pytest.raises(cq.CrowdquiltError, match="wang"):
        cq.tiling.tile(cq.Scene.from_toml(WANG), sample_set, method="paper")


def test_a_crowd_that_repeats_is_unrolled_checked_and_drawn(sample_set: cq.PatchSet, tmp_path: Path) -> None:
    text = "region = [[0, 0], [8, 0], [8, 7], [0, 7]]\nduration_secs = 8\ncharacters = 8\ninteraction = 0.2\n"
    tile = cq.tiling.tile(cq.Scene.from_toml(text + 'periodic = ["x", "t"]\n'), sample_set, seed=2).crowd
    assert tile.periodic == ["x", "t"]
    report = cq.check.check(tile)
    assert report.ok
    assert {"seam in time", "border"} <= {row.row.split(":")[0] for row in report.rows}
    tile.save(tmp_path / "tile.crowd")
    again = cq.Crowd.load(tmp_path / "tile.crowd")
    assert again.periodic == tile.periodic
    block = again.unrolled(x=2, t=2)
    assert block.periodic == [] and block.frames == 2 * (tile.frames - 1) + 1
    assert len(block) >= 2 * len(tile) and cq.check.check(block).ok
    with pytest.raises(ValueError, match="at least one"):
        tile.unrolled(0)
    for draw in (plan, loom):
        assert isinstance(draw(tile), Figure)
