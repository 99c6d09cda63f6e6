"""The Python classes against files written by an independent writer, and against each other."""

from __future__ import annotations

import ast
import inspect
from pathlib import Path

import numpy as np
import pytest

import crowdfile
import crowdquilt as cq
from crowdquilt import _core


def test_a_crowd_says_what_its_file_says(walkers: Path) -> None:
    crowd = cq.Crowd.load(walkers)
    assert (len(crowd), crowd.seed, crowd.fps, crowd.frames, crowd.seconds) == (3, 7, 30, 91, 3)
    assert crowd.instances.tolist() == [0] * 9
    assert [kind.name for kind in crowd.kinds] == ["walk"]
    assert np.ptp(crowd.region, axis=0).tolist() == [12, 12]
    roots = crowd.roots(1)
    assert roots.shape == (91, 3) and roots.dtype == np.float32
    np.testing.assert_allclose(roots[:, 0], 2.0)
    np.testing.assert_allclose(roots[:, 2], np.linspace(1.0, 4.6, 91), atol=1e-6)
    rotations = crowd.rotations(1)
    assert rotations.shape == (91, 22, 4)
    np.testing.assert_allclose(np.linalg.norm(rotations, axis=2), 1, atol=1e-4)
    fragments = crowd.fragments(2)
    assert [(f.instance, f.role, f.begin, f.end) for f in fragments] == [(6, 0, 0, 30), (7, 0, 30, 60), (8, 0, 60, 90)]
    np.testing.assert_allclose(fragments[0].points[-1], fragments[1].points[0], atol=1e-6)


def test_joints_stand_where_forward_kinematics_puts_them(walkers: Path) -> None:
    crowd = cq.Crowd.load(walkers)
    joints = crowd.positions(0, 30)
    assert joints.shape == (22, 3) and len(crowd.joints) == 22 and crowd.parents[0] == -1
    np.testing.assert_allclose(joints[0], crowd.roots(0)[30])
    # The pose is upright and faces +z: the head over the hips, the left foot at the side of +x.
    head, left = joints[crowd.joints.index("head")], joints[crowd.joints.index("left_foot")]
    assert head[1] > 1.4 and abs(head[0] - joints[0, 0]) < 1e-3
    assert left[0] > joints[0, 0] and left[1] < 0.15
    hand = joints[crowd.joints.index("left_hand")]
    assert hand[1] < joints[crowd.joints.index("left_arm"), 1] - 0.3, "the arms hang"


def test_everybody_at_a_time(walkers: Path) -> None:
    crowd = cq.Crowd.load(walkers)
    people, joints = crowd.at(1.0)
    assert people.tolist() == [0, 1, 2] and joints.shape == (3, 22, 3)
    np.testing.assert_allclose(joints[1], crowd.positions(1, 30), atol=1e-5)
    between = crowd.at(0.5 / 30)[1]
    np.testing.assert_allclose(between, (crowd.at(0)[1] + crowd.at(1 / 30)[1]) / 2, atol=1e-5)
    people, capsules = crowd.capsules(1.0)
    assert people.tolist() == [0, 1, 2] and capsules.shape == (3, 16, 7)
    assert (capsules[..., 6] > 0.02).all() and (capsules[..., 6] < 0.2).all()
    nobody, none = crowd.at(1000.0)
    assert nobody.shape == (0,) and none.shape == (0, 22, 3)


def test_absent_people_and_frames_are_index_errors(walkers: Path) -> None:
    crowd = cq.Crowd.load(walkers)
    for call in (lambda: crowd.roots(3), lambda: crowd.positions(0, 91), lambda: crowd.span(99)):
        with pytest.raises(IndexError):
            call()


def test_files_survive_a_round_trip(tmp_path: Path, walkers: Path, patches: Path) -> None:
    crowd, made = cq.Crowd.load(walkers), cq.PatchSet.load(patches)
    crowd.save(tmp_path / "again.crowd")
    assert (tmp_path / "again.crowd").read_bytes() == crowd.to_bytes()
    assert cq.Crowd.from_bytes(crowd.to_bytes()).to_bytes() == crowd.to_bytes()
    # Rotations are rounded to 16 bits and made unit length again, which may turn over a last bit.
    again = cq.PatchSet.from_bytes(made.to_bytes())
    assert len(again.to_bytes()) == patches.stat().st_size
    assert [kind.name for kind in again.kinds] == [kind.name for kind in made.kinds]
    np.testing.assert_array_equal(again.path(3, 0)[0], made.path(3, 0)[0])


def test_a_patch_set(patches: Path) -> None:
    made = cq.PatchSet.load(patches)
    assert made.validate() == [] and len(made) == len(made.kinds)
    assert {1, 2, 3} <= {kind.people for kind in made.kinds}
    assert sum(kind.mirrored for kind in made.kinds) > 0
    for index, kind in enumerate(made.kinds):
        for number, role in enumerate(kind.roles):
            points, headings = made.path(index, number)
            assert points.shape == (role.frames, 2) and headings.shape == (role.frames,)
            assert {role.entry, role.exit} <= set(made.groups)
    with pytest.raises(cq.CrowdquiltError, match="no role 9"):
        made.path(0, 9)


def test_a_capture(captures: Path) -> None:
    path = sorted(captures.glob("*.bvh"))[0]
    clip = cq.motion.load(path)
    assert 1.5 < clip.height_m < 2.0
    assert clip.root.shape == (clip.frames, 3) and clip.positions().shape == (clip.frames, len(clip.joints), 3)
    np.testing.assert_allclose(clip.positions()[:, 0], clip.root, atol=1e-5)
    assert clip.seconds == pytest.approx((clip.frames - 1) / clip.fps)
    for foot, begin, end in clip.plants():
        assert foot in ("left", "right") and 0 <= begin <= end <= clip.seconds + 1 / 30
    half = cq.motion.load(path, fps=clip.fps / 2)
    assert half.seconds == pytest.approx(2 * clip.seconds, rel=1e-3)


def test_an_exported_person_reads_back_in_place(tmp_path: Path, small: cq.Outcome) -> None:
    path = tmp_path / "one.bvh"
    cq.export.save_person(small.crowd, 2, path)
    clip = cq.motion.load(path, metres_per_unit=1.0)
    begin, end = small.crowd.span(2)
    assert clip.frames == end - begin + 1
    for frame in (0, clip.frames // 2, clip.frames - 1):
        np.testing.assert_allclose(clip.positions()[frame], small.crowd.positions(2, begin + frame), atol=1e-3)


def test_bvh_of_an_earlier_larger_crowd_goes_away(tmp_path: Path, walkers: Path) -> None:
    crowd = cq.Crowd.load(walkers)
    (tmp_path / "bvh").mkdir()
    for name in ("person_009.bvh", "mine.txt"):
        (tmp_path / "bvh" / name).write_text("old")
    cq.export.save_bvh(crowd, tmp_path / "bvh")
    names = sorted(p.name for p in (tmp_path / "bvh").iterdir())
    assert names == ["mine.txt", "person_000.bvh", "person_001.bvh", "person_002.bvh"]


def test_summary_counts_shared_time(tmp_path: Path) -> None:
    alone, meet = crowdfile.WALK, crowdfile.MEET
    uses = [
        [crowdfile.Use(0, role, 0, f.points + [3, 3], np.full(f.frames, f.heading))]
        for role, f in enumerate(meet.fragments)
    ]
    walk = alone.fragments[0]
    uses += [[crowdfile.Use(1 + i, 0, 0, walk.points + [6 + i, 6], np.zeros(31))] for i in range(2)]
    crowd = cq.Crowd.from_bytes(crowdfile.crowd([alone, meet], [1, 0, 0], uses, last_frame=60))
    summary = cq.check.summary(crowd)
    assert (summary.characters, summary.instances, summary.kinds) == (4, 3, 2)
    assert summary.multi_person_share == pytest.approx(120 / 180)
    assert summary.danglings == 2  # the two who walk alone end at half time


def test_every_public_thing_has_a_docstring() -> None:
    bare = []
    for name in cq.__all__:
        thing = getattr(cq, name)
        if not inspect.getdoc(thing):
            bare.append(name)
        members = vars(thing) if inspect.isclass(thing) and issubclass(thing, object) else {}
        if thing.__class__ is type and thing.__module__ == "crowdquilt":
            slots = {field for cls in ("Role", "Kind", "Outcome", "Row", "Summary") if cls == name for field in members}
            bare += [
                f"{name}.{m}"
                for m in members
                if not m.startswith("_") and m not in slots and not getattr(thing, m).__doc__
            ]
    assert not bare, bare


def test_stubs_name_what_the_core_has_and_nothing_else() -> None:
    stub = ast.parse((Path(cq.__file__).parent / "_core.pyi").read_text())
    told = {node.name: node for node in stub.body if isinstance(node, ast.ClassDef | ast.FunctionDef)}
    there = {name for name in vars(_core) if not name.startswith("_")}
    assert set(told) == there
    for name, node in told.items():
        if isinstance(node, ast.ClassDef) and name != "CrowdquiltError":
            members = {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
            real = {m for m in vars(getattr(_core, name)) if not m.startswith("_")}
            assert {m for m in members if not m.startswith("_")} == real, name


def test_boxes_are_where_the_hands_are(small: cq.Outcome) -> None:
    crowd = small.crowd
    assert cq.check.summary(crowd).props == len(crowd.props) > 0
    hands = [crowd.joints.index(name) for name in ("left_hand", "right_hand")]
    for prop in crowd.props:
        begin, end = prop.span
        assert prop.positions.shape == (end - begin + 1, 3) and prop.headings.shape == (end - begin + 1,)
        assert prop.size.shape == (3,) and prop.name in ("box", "crate")
        for person, first, last in prop.holds:
            for frame in (first, (first + last) // 2, last):
                wrists = crowd.positions(person, frame)[hands]
                assert np.linalg.norm(wrists - prop.positions[frame - begin], axis=1).max() < 0.4
    there, places = crowd.props_at(2.0)
    assert places.shape == (len(there), 4)
    prop = crowd.props[there[0]]
    np.testing.assert_allclose(places[0, :3], prop.positions[60 - prop.span[0]], atol=1e-4)
