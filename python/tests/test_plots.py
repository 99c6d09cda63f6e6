"""The pictures: what is drawn is where it belongs, and the same crowd gives the same bytes."""

from __future__ import annotations

from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

import crowdfile
import crowdquilt as cq
from conftest import crowdquilt
from crowdquilt import plot
from crowdquilt.plot import style
from crowdquilt.plot.lives import lives, together
from crowdquilt.plot.loom import Camera
from crowdquilt.plot.plan import stadium


@pytest.mark.parametrize("kind", ["plan", "loom"])
@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_every_picture_in_every_format(tmp_path: Path, walkers: Path, kind: str, suffix: str) -> None:
    out = tmp_path / f"picture.{suffix}"
    done = crowdquilt("plot", walkers, "--kind", kind, "-o", out)
    assert done.returncode == 0, done.stderr
    assert out.stat().st_size > 5000


@pytest.mark.parametrize("kind", ["plan", "loom"])
def test_the_same_crowd_gives_the_same_bytes(tmp_path: Path, walkers: Path, kind: str) -> None:
    draw = getattr(plot, kind)
    for name in ("a.png", "b.png"):
        draw(cq.Crowd.load(walkers), tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_people_are_drawn_where_they_are_with_z_down(tmp_path: Path, walkers: Path) -> None:
    crowd = cq.Crowd.load(walkers)
    figure = plot.plan(crowd, tmp_path / "plan.png", time=1.0, dpi=100)
    picture = matplotlib.image.imread(tmp_path / "plan.png")
    axes = figure.axes[0]

    def darkness(x: float, z: float) -> float:
        column, row = axes.transData.transform((x, z)) * 100 / figure.dpi
        return 1 - float(picture[picture.shape[0] - 1 - int(row), int(column), :3].mean())

    x, _, z = crowd.positions(1, 30)[0]
    assert darkness(x, z) > 0.4, "a person"
    assert darkness(x, z + 3) < 0.2 and darkness(x, 11 - z) < 0.2, "nobody"
    (_, top), (_, bottom) = axes.transData.transform([(0, 0), (0, 12)])
    assert top > bottom, "seen from above, with x to the right, z points down"


def test_colours_tell_what_people_do_together() -> None:
    greet, walk = crowdfile.MEET, crowdfile.WALK
    uses = [
        [crowdfile.Use(0, role, 0, f.points + [3, 3], np.full(f.frames, f.heading))]
        for role, f in enumerate(greet.fragments)
    ]
    uses.append([crowdfile.Use(1, 0, 0, walk.fragments[0].points + [8, 3], np.zeros(31))])
    crowd = cq.Crowd.from_bytes(crowdfile.crowd([walk, greet], [1, 0], uses, last_frame=60))
    per_kind, palette = style.colours(crowd)
    assert list(palette) == ["greet"] and per_kind == [style.ALONE, palette["greet"]]
    who = lives(crowd)
    assert [together(crowd, who, frame) for frame in (0, 30, 60)] == [2, 2, 2]
    assert who.instance_of(2, 30) == 1 and who.instance_of(2, 31) is None


@pytest.mark.parametrize(
    "name, words",
    [
        ("handshake-18_01-19_01-1-mirror", "handshake"),
        ("trio-greet-walk", "trio greet"),
        ("high-five-passing", "high five"),
        ("walk", "walk"),
    ],
)
def test_activities_in_words(name: str, words: str) -> None:
    crowd = cq.Crowd.from_bytes(
        crowdfile.crowd(
            [crowdfile.Kind(name, crowdfile.WALK.fragments)],
            [0],
            [[crowdfile.Use(0, 0, 0, crowdfile.WALK.fragments[0].points + [3, 3], np.zeros(31))]],
        )
    )
    assert style.activity(crowd.kinds[0]) == words


def test_swept_outlines_hold_their_points_and_are_no_larger_than_needed() -> None:
    random = np.random.default_rng(1)
    for _ in range(50):
        points = random.normal(size=(random.integers(1, 9), 2))
        outline = style.swept(points, 0.3, 64)
        edges = np.roll(outline, -1, axis=0) - outline
        for point in points:
            to = point - outline
            assert (edges[:, 0] * to[:, 1] - edges[:, 1] * to[:, 0] > -1e-9).all(), "inside a counter-clockwise outline"
        nearest = np.linalg.norm(outline[:, None] - points, axis=2).min(axis=1)
        np.testing.assert_allclose(nearest, 0.3, atol=1e-9)


def test_stadium_is_a_capsule_from_above() -> None:
    outline = stadium(np.array([1.0, 0.5, 2.0, 1.0, 0.9, 3.0, 0.1]), 0.0)
    np.testing.assert_allclose(outline.min(axis=0), [0.9, 1.9], atol=2e-3)
    np.testing.assert_allclose(outline.max(axis=0), [1.1, 3.1], atol=2e-3)


def test_the_camera_keeps_its_centre_and_sees_near_things_larger() -> None:
    camera = Camera(np.array([1.0, 2.0, 3.0]), 10.0)
    flat, depth = camera.project(np.array([[1.0, 2.0, 3.0]]))
    np.testing.assert_allclose(flat, 0, atol=1e-12)
    np.testing.assert_allclose(depth, 0, atol=1e-12)
    up = camera.project(np.array([[1.0, 3.0, 3.0]]))[0][0]
    assert up[1] > 0 and abs(up[0]) < 1e-9

    def width(depth_metres: float) -> float:
        toward = np.array([np.sin(camera.yaw), 0, np.cos(camera.yaw)]) * depth_metres
        across = np.array([np.cos(camera.yaw), 0, -np.sin(camera.yaw)])
        ends = camera.project(camera.centre + toward + np.outer([-1, 1], across))[0]
        return float(np.linalg.norm(ends[1] - ends[0]))

    assert width(5) > width(0) > width(-5)
