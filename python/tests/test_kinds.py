"""Patch sets looked at: how kinds follow each other, contact sheet, graph of pose groups, the viewer's server."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import urllib.error
import urllib.request
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

import crowdquilt as cq
from conftest import crowdquilt
from crowdquilt import plot, server
from crowdquilt.plot.card import MOST_LINES
from crowdquilt.plot.cards import cards
from crowdquilt.plot.figures import View, bodies_of, box_faces, extent, limbs
from crowdquilt.plot.ports import typical

HIPS, HEAD = 0, 13


@pytest.fixture(scope="module")
def samples(patches: Path) -> cq.PatchSet:
    return cq.PatchSet.load(patches)


@pytest.fixture(scope="module")
def trap(samples: cq.PatchSet) -> cq.PatchSet:
    """The samples' kinds with those gone who go from standing to walking."""
    header_kinds = [k.name for k in samples.kinds if k.people == 1 and k.roles[0].entry == "stand"]
    return without(
        samples,
        {n for n, k in zip(header_kinds, named(samples, header_kinds), strict=True) if k.roles[0].exit != "stand"},
    )


def named(patches: cq.PatchSet, names: list[str]) -> list[cq.Kind]:
    by_name = {kind.name: kind for kind in patches.kinds}
    return [by_name[name] for name in names]


def without(patches: cq.PatchSet, names: set[str]) -> cq.PatchSet:
    """The set without some kinds, by its file's documented layout."""
    data = patches.to_bytes()
    length = int.from_bytes(data[12:16], "little")
    header = json.loads(data[24 : 24 + length])
    # What was found out is about all kinds.
    del header["study"]
    header["arrays"] = {name: a for name, a in header["arrays"].items() if not name.startswith("study_")}
    arrays = {
        name: np.frombuffer(
            data,
            {"f32": "<f4", "i16": "<i2", "u32": "<u4", "i32": "<i4", "u8": "u1"}[a["type"]],
            a["count"],
            24 + length + a["offset"],
        )
        for name, a in header["arrays"].items()
    }
    lengths = [(k["name"] not in names, f["frames"]) for k in header["kinds"] for f in k["fragments"]]
    keep = np.repeat([kept for kept, _ in lengths], [frames for _, frames in lengths])
    frames = len(keep)
    chosen = {
        name: a.reshape(frames, -1)[keep].ravel() if len(a) and len(a) % frames == 0 else a
        for name, a in arrays.items()
    }
    header["kinds"] = [k for k in header["kinds"] if k["name"] not in names]
    body = b""
    for name, values in chosen.items():
        body += bytes(-len(body) % 8)
        header["arrays"][name] |= {"offset": len(body), "count": len(values)}
        body += values.tobytes()
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 8)
    prelude = data[:12] + len(text).to_bytes(4, "little") + len(body).to_bytes(8, "little")
    return cq.PatchSet.from_bytes(prelude + text + body)


def test_bodies_of_kinds_stand_on_their_paths(samples: cq.PatchSet) -> None:
    for index in (0, len(samples) - 1):
        for role, own in enumerate(samples.kinds[index].roles):
            joints = cq.patch.positions(samples, index, role)
            capsules = cq.patch.capsules(samples, index, role)
            points, _ = samples.path(index, role)
            assert joints.shape == (own.frames, 22, 3) and capsules.shape == (own.frames, 16, 7)
            assert np.allclose(joints[:, HIPS][:, [0, 2]], points, atol=1e-5)
            assert 0.4 < joints[:, HIPS, 1].min() < joints[:, HEAD, 1].max() < 1.9
            # The first capsule is the belly: it begins at the hips.
            assert np.allclose(capsules[:, 0, :3], joints[:, HIPS], atol=1e-6)
    with pytest.raises(cq.CrowdquiltError, match="no role 9"):
        cq.patch.positions(samples, 0, 9)
    with pytest.raises(cq.CrowdquiltError, match="kind 9999"):
        cq.patch.capsules(samples, 9999, 0)


def test_the_samples_are_closed_and_can_be_steered(samples: cq.PatchSet) -> None:
    found = cq.patch.connectivity(samples)
    assert found.closed and found.advice == [] and found.missing == []
    assert found.not_entered == [] and found.not_left == []
    assert [g.name for g in found.groups] == samples.groups
    for group in found.groups:
        out = [k for k in samples.kinds if k.people == 1 and k.roles[0].entry == group.name]
        assert group.out_alone == len(out)
        assert group.steering is not None
        seconds = [k.seconds for k in out]
        assert group.steering.secs == pytest.approx((min(seconds), max(seconds)), abs=1e-3)
        assert group.steering.turn_deg[0] < -15 and group.steering.turn_deg[1] > 15
    alone = sum(link.alone for link in found.links)
    assert alone == sum(k.people == 1 for k in samples.kinds)


def test_a_trap_is_named_and_what_would_open_it(trap: cq.PatchSet, tmp_path: Path) -> None:
    found = cq.patch.connectivity(trap)
    assert not found.closed
    assert [c.groups for c in found.components if not c.main and not c.left] == [["stand"]] or any(
        "stand" in c.groups for c in found.components
    )
    assert any("stand" in pair for pair in found.missing)
    assert any("capture somebody who goes from" in advice for advice in found.advice)
    path = tmp_path / "trap.patches"
    trap.save(path)
    told = crowdquilt("kinds", path)
    assert told.returncode == 0 and "not closed" in told.stdout and "advice" in told.stdout


def test_kinds_tells_and_draws(patches: Path, samples: cq.PatchSet, tmp_path: Path) -> None:
    sheet, groups = tmp_path / "sheet.png", tmp_path / "groups.svg"
    done = crowdquilt("kinds", patches, "--sheet", sheet, "--groups", groups)
    assert done.returncode == 0, done.stderr
    own = sum(not kind.mirrored for kind in samples.kinds)
    assert "closed" in done.stdout and "walk_left" in done.stdout and f"{own} kinds" in done.stdout
    assert f"and {len(samples) - own} mirrored copies" in done.stdout
    assert sheet.stat().st_size > 100_000 and groups.stat().st_size > 5000
    told = json.loads(crowdquilt("kinds", patches, "--json").stdout)
    assert told["connectivity"]["closed"] is True
    assert [k["name"] for k in told["kinds"]] == [k.name for k in samples.kinds]


def test_kinds_are_measured(patches: Path, samples: cq.PatchSet) -> None:
    found = dict(zip((k.name for k in samples.kinds), cq.patch.measures(samples), strict=True))
    for index, kind in enumerate(samples.kinds):
        own = found[kind.name]
        assert (own.people, own.seconds) == (kind.people, pytest.approx(kind.seconds))
        assert ("contact" in own.words) == (kind.contacts > 0) and ("together" in own.words) == (kind.people > 1)
        # Everybody's joints lie in the circle, so it is at least half as wide as the farthest two are apart.
        joints = np.concatenate([cq.patch.positions(samples, index, r).reshape(-1, 3) for r in range(kind.people)])
        assert own.radius >= np.ptp(joints[:, [0, 2]], axis=0).max() / 2
        ways = [np.linalg.norm(np.diff(samples.path(index, r)[0], axis=0), axis=1).sum() for r in range(kind.people)]
        assert own.speed == pytest.approx(sum(ways) / sum((r.frames - 1) / 30 for r in kind.roles), rel=1e-3, abs=1e-4)
        assert own.fastest >= own.speed - 1e-3
    assert found["pivot-90"].turn_deg == pytest.approx(-found["pivot-90-mirror"].turn_deg, abs=1e-3)
    assert found["handshake-stand"].words == ["stand", "together", "contact"]
    assert found["sit"].words[-2:] == ["low", "prop"] and found["carry-walk-cycle"].props == 1
    assert found["tie-shoe"].words == ["stand", "low"]


def test_measures_are_told(patches: Path, samples: cq.PatchSet) -> None:
    told = json.loads(crowdquilt("kinds", patches, "--json").stdout)["kinds"]
    for kind, own in zip(told, cq.patch.measures(samples), strict=True):
        assert kind["measures"]["words"] == own.words and kind["measures"]["radius"] == pytest.approx(
            own.radius, abs=1e-3
        )
    text = crowdquilt("kinds", patches, "--each").stdout
    line = next(line for line in text.splitlines() if line.startswith("handshake-stand "))
    assert "stand together contact" in line and "stand → stand" in line
    assert "handshake-stand-mirror" not in text


def test_a_picture_of_no_known_format_is_refused(patches: Path, tmp_path: Path) -> None:
    done = crowdquilt("kinds", patches, "--sheet", tmp_path / "sheet.xyz")
    assert done.returncode == 2 and "expected a picture" in done.stderr


def test_the_sheet_shows_every_kind_once_people_alone_first(samples: cq.PatchSet) -> None:
    shown = cards(samples, cq.patch.connectivity(samples))
    assert sorted(c.kind.name for c in shown) == sorted(k.name for k in samples.kinds if not k.mirrored)
    order = [(c.kind.people, c.kind.labels[0]) for c in shown]
    assert order == sorted(order), "by people, then by label"
    for card in shown:
        assert 2 <= len(card.moments) <= 7 and sorted(set(card.moments)) == card.moments
        assert all(card.at(frame) for frame in card.moments)
    figure = plot.sheet(samples)
    texts = [t.get_text() for t in figure.axes[0].texts]
    # Of many people those who do alike share a line.
    lines = [
        len({(r.entry, r.exit) for r in k.roles}) if k.people > MOST_LINES else k.people
        for k in (c.kind for c in shown)
    ]
    assert sum("→" in text for text in texts) == sum(lines)


def test_the_sheet_has_room_for_boxes_and_shows_who_sits(samples: cq.PatchSet) -> None:
    shown = {c.kind.name: c for c in cards(samples, cq.patch.connectivity(samples))}
    card = shown["sit-talk"]
    hips = [min(float(body[0, 1]) for _, body in card.at(frame)) for frame in card.moments]
    assert min(hips) < 0.7, "a key pose of somebody who sits"
    for frame in card.moments:
        people, boxes = card.moment(frame)
        low, high = extent([body for _, body in people], card.view, boxes)
        corners = np.concatenate([p for size, place in boxes for p in box_faces(size, place, card.view).polygons])
        assert boxes and (corners >= low).all() and (corners <= high).all()
    # Of who stays on their feet the regular moments tell all.
    assert shown["handshake-stand"].moments == [0, 30, 60]


def test_pictures_of_one_set_are_the_same_to_the_byte(trap: cq.PatchSet, tmp_path: Path) -> None:
    for name in ("a.png", "b.png"):
        plot.groups(trap, tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_the_picture_of_a_group_shows_what_it_holds(samples: cq.PatchSet) -> None:
    for group in samples.groups:
        found = typical(samples, group)
        assert found is not None
        body, boxes = found
        assert np.allclose(body[0, [0, 2]], 0, atol=1e-6), "at the origin"
        assert len(boxes) == group.startswith("carry")
        for _, (x, y, z, heading) in boxes:
            assert abs(x) < 0.1 and 0.7 < y < 1.3 and 0.2 < z < 0.5 and abs(heading) < 0.2, "ahead, between the hands"


def test_faults_are_red(samples: cq.PatchSet, trap: cq.PatchSet, tmp_path: Path) -> None:
    def red(patches: cq.PatchSet) -> int:
        plot.groups(patches, tmp_path / "groups.png", dpi=60)
        picture = matplotlib.image.imread(tmp_path / "groups.png")
        return int(((picture[..., 0] > 0.7) & (picture[..., 1:3].max(axis=-1) < 0.4)).sum())

    assert red(samples) == 0 and red(trap) > 200


def test_somebody_seen_from_the_side_looks_to_the_right(samples: cq.PatchSet) -> None:
    index = next(i for i, k in enumerate(samples.kinds) if k.name.startswith("walk-1.15-cycle"))
    heading = float(samples.path(index, 0)[1][0])
    view = View.beside(heading)
    ahead, _ = view.project(np.array([np.sin(heading), 0.0, np.cos(heading)]))
    up, _ = view.project(np.array([0.0, 1.0, 0.0]))
    _, near = view.project(np.array([np.cos(heading), 0.0, -np.sin(heading)]))
    assert ahead[0] > 0.8 and up[0] == 0 and up[1] > 0.9
    assert near < 0, "who goes to the right shows the right side; the left is farther"
    painted = limbs(bodies_of(samples, index, 0)[0], view, (0.2, 0.4, 0.6))
    assert sum(len(limb.polygons) for limb in painted) == sum(len(limb.fills) for limb in painted) == 34


def test_of_a_box_three_faces_are_seen_where_it_is() -> None:
    view, place = View.beside(0.3), np.array([1.0, 1.1, -0.5, 0.8])
    box = box_faces(np.array([0.4, 0.3, 0.2]), place, view)
    assert len(box.polygons) == len(box.fills) == 6, "an outline and a fill each"
    middle, near = view.project(place[:3])
    corners = np.concatenate(box.polygons[3:])
    assert np.allclose((corners.min(axis=0) + corners.max(axis=0)) / 2, middle, atol=1e-6)
    assert box.near == pytest.approx(float(near))


def test_boxes_of_kinds_are_in_the_hands_of_who_holds_them(samples: cq.PatchSet) -> None:
    carried = [(i, cq.patch.boxes(samples, i)) for i, k in enumerate(samples.kinds) if k.name.startswith("carry-walk")]
    assert carried
    for index, [(size, begin, places)] in carried:
        assert begin == 0 and len(places) == samples.kinds[index].roles[0].frames and max(size) < 1
        hands = cq.patch.positions(samples, index, 0)[:, [17, 21]].mean(axis=1)
        assert np.linalg.norm(places[:, :3] - hands, axis=1).max() < 0.4


@pytest.mark.skipif(not (server.STUDIO / "index.html").exists(), reason="the studio is not built: run `make studio`")
def test_view_serves_a_set_without_a_report(patches: Path) -> None:
    command = [sys.executable, "-u", "-m", "crowdquilt", "view", str(patches), "--no-open"]
    running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert running.stdout is not None
    url = next(word for word in running.stdout.readline().split() if word.startswith("http"))
    with urllib.request.urlopen(url + "data/crowd.crowd") as answer:
        assert answer.read() == patches.read_bytes()
    with pytest.raises(urllib.error.HTTPError) as refused:
        urllib.request.urlopen(url + "data/report.json")
    assert refused.value.code == 404
    running.send_signal(signal.SIGINT)
    _, errors = running.communicate(timeout=10)
    assert "Traceback" not in errors


def test_view_refuses_a_set_that_is_cut(patches: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.patches"
    cut.write_bytes(patches.read_bytes()[:5000])
    done = crowdquilt("view", cut, "--no-open", timeout=30)
    assert done.returncode == 2 and "cut.patches" in done.stderr
