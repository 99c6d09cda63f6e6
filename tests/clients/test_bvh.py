"""A public reader (bvhio) finds every joint of our BVH files where it should be; the validator likes the clips as GLB.

Needs the files that `cargo test --test formats` leaves behind: each sample as BVH and GLB, read back there to within
0.1 mm.
"""

import json
import shutil
import struct
import subprocess
from pathlib import Path

import pytest

np = pytest.importorskip("numpy")

HERE = Path(__file__).parent
TMP = HERE.parents[1] / "target" / "tmp"
CLIPS = ["walk-slow-a", "handshake-stand-a", "argue-walk-b"]
FRAMES = [0, 1, 40, -1]


def existing(name: str) -> Path:
    path = TMP / name
    if not path.exists():
        pytest.skip(f"{path} is not there: run `cargo test --test formats` first")
    return path


class Glb:
    """The joints of a clip as GLB, from its numbers alone."""

    def __init__(self, path: Path):
        raw = path.read_bytes()
        length = struct.unpack_from("<I", raw, 12)[0]
        self.json = json.loads(raw[20 : 20 + length])
        self.binary = raw[28 + length :]

    def numbers(self, index: int) -> "np.ndarray":
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        offset = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        values = np.frombuffer(self.binary, "<f4", accessor["count"] * width, offset)
        return values.reshape(-1, width).astype(float)

    def positions(self, frame: int) -> dict[str, "np.ndarray"]:
        """Global joint positions at a frame, by name."""
        nodes = self.json["nodes"]
        place = {i: np.array(node["translation"]) for i, node in enumerate(nodes)}
        turn = {}
        animation = self.json["animations"][0]
        for channel in animation["channels"]:
            node, path = channel["target"]["node"], channel["target"]["path"]
            value = self.numbers(animation["samplers"][channel["sampler"]]["output"])[frame]
            (place if path == "translation" else turn)[node] = value
        children = {child: i for i, node in enumerate(nodes) for child in node.get("children", [])}
        found = {}
        for i, node in enumerate(nodes):
            p, at = np.zeros(3), i
            while at is not None:
                p = place[at] + (rotate(turn[at], p) if at != i else p)
                at = children.get(at)
            found[node["name"]] = p
        return found


def rotate(q: "np.ndarray", v: "np.ndarray") -> "np.ndarray":
    """The vector v turned by the quaternion q (x, y, z, w)."""
    t = 2.0 * np.cross(q[:3], v)
    return v + q[3] * t + np.cross(q[:3], t)


@pytest.mark.parametrize("name", CLIPS)
def test_bvhio_finds_every_joint(name: str):
    bvhio = pytest.importorskip("bvhio", reason="bvhio is not installed (pip install bvhio)")
    glb = Glb(existing(f"{name}.clip.glb"))
    root = bvhio.readAsHierarchy(str(existing(f"{name}.clip.bvh")))
    for frame in FRAMES:
        index = frame if frame >= 0 else len(root.Keyframes) + frame
        root.loadPose(index)
        expected = glb.positions(frame)
        joints = {joint.Name: np.array(joint.PositionWorld) for joint, _, _ in root.layout()}
        for joint, position in expected.items():
            assert np.linalg.norm(joints[joint] - position) < 0.001, (frame, joint, joints[joint], position)


@pytest.mark.parametrize("name", CLIPS)
def test_a_clip_as_glb_has_no_error_and_no_warning(name: str):
    if shutil.which("node") is None or not (HERE / "node_modules").is_dir():
        pytest.skip(f"Node or its packages are not installed (npm install in {HERE})")
    command = ["node", "validate_glb.mjs", existing(f"{name}.clip.glb")]
    done = subprocess.run(command, cwd=HERE, capture_output=True, text=True, timeout=120, check=False)
    report = json.loads(done.stdout)
    assert done.returncode == 0 and report["errors"] == 0 and report["warnings"] == 0, report
    assert report["three"]["tracks"] == 23  # a rotation for each of 22 joints, and the root's place
