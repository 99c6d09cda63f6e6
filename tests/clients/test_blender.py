"""Blender imports an exported GLB and finds every joint where the crowd file has it.

Needs `bpy` (about 800 MB; Blender as a Python module) and the two files of one crowd, which `cargo test --test export`
leaves behind. Others can be named with CROWDQUILT_GLB and CROWDQUILT_CROWD.
"""

import os
from pathlib import Path

import pytest

np = pytest.importorskip("numpy")
bpy = pytest.importorskip("bpy", reason="Blender's Python module is not installed (pip install bpy)")

import crowd_file

TMP = Path(__file__).parents[2] / "target" / "tmp"
GLB = Path(os.environ.get("CROWDQUILT_GLB", TMP / "fixture.glb"))
CROWD = Path(os.environ.get("CROWDQUILT_CROWD", TMP / "fixture.crowd"))
MILLIMETRE = 0.001
FPS = 30


@pytest.fixture(scope="module")
def crowd():
    for path in (GLB, CROWD):
        if not path.exists():
            pytest.skip(f"{path} is not there: run `cargo test --test export` first")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = FPS
    bpy.ops.import_scene.gltf(filepath=str(GLB))
    return crowd_file.read(CROWD)


def bones() -> dict:
    """Every bone's armature, by bone name. (The importer's own 'Icosphere' is a mesh and so left out.)"""
    armatures = [o for o in bpy.data.objects if o.type == "ARMATURE"]
    return {bone.name: armature for armature in armatures for bone in armature.pose.bones}


def head(armatures: dict, name: str):
    armature = armatures[name]
    x, y, z = armature.matrix_world @ armature.pose.bones[name].head
    return np.array([x, z, -y])  # Blender's z up to y up


def first_key() -> int:
    """Importers begin at Blender's frame 0 or 1."""
    starts = [action.frame_range[0] for action in bpy.data.actions]
    return round(min(starts))


def test_joints_are_within_a_millimetre(crowd):
    header, people = crowd
    armatures = bones()
    for frame in (0, 20, 37, 60, 79, 119):
        bpy.context.scene.frame_set(frame + first_key())
        for p, person in enumerate(people):
            if not person.begin <= frame < person.begin + len(person.root):
                continue
            for name, expected in crowd_file.joint_positions(header, person, frame).items():
                found = head(armatures, f"person_{p}_{name}")
                assert np.linalg.norm(found - expected) < MILLIMETRE, (frame, p, name, found, expected)


def test_absent_people_have_no_size(crowd):
    header, people = crowd
    armatures = bones()
    last = header["domain"]["last_frame"]
    for frame in (0, last // 2, last):
        bpy.context.scene.frame_set(frame + first_key())
        for p, person in enumerate(people):
            present = person.begin <= frame < person.begin + len(person.root)
            size = np.linalg.norm(head(armatures, f"person_{p}_head") - head(armatures, f"person_{p}_hips"))
            assert (size > 0.3) == present, (frame, p, size)


def test_everybody_has_a_skinned_body(crowd):
    _, people = crowd
    bodies = [o for o in bpy.data.objects if o.type == "MESH" and any(m.type == "ARMATURE" for m in o.modifiers)]
    assert len(bodies) == sum(len(p.root) > 0 for p in people)
    assert all(4 <= len(o.data.materials) <= 9 for o in bodies)


def test_a_bvh_file_has_the_joints_within_a_millimetre():
    bvh = TMP / "person_2.bvh"
    path = TMP / "fixture.crowd"
    if not (bvh.exists() and path.exists()):
        pytest.skip(f"{bvh} or {path} is not there: run `cargo test --test export` first")
    header, people = crowd_file.read(path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = FPS
    bpy.ops.import_anim.bvh(filepath=str(bvh), axis_forward="-Z", axis_up="Y")
    armatures = bones()
    for frame in (0, 37, 79):
        bpy.context.scene.frame_set(frame + first_key())
        for name, expected in crowd_file.joint_positions(header, people[2], frame).items():
            found = head(armatures, name)
            assert np.linalg.norm(found - expected) < MILLIMETRE, (frame, name, found, expected)
