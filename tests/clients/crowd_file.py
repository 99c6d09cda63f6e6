"""Reads a crowd file with numpy: the format of `src/container.rs` and `src/stage/file.rs` in thirty lines."""

import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np


@dataclass
class Person:
    begin: int
    offsets: np.ndarray  # joints x 3: the person's bones, metres
    root: np.ndarray  # frames x 3, metres
    rotations: np.ndarray  # frames x joints x 4, quaternions x, y, z, w; the hips' global, others local


def read(path: Path) -> tuple[dict[str, Any], list[Person]]:
    """The header and the people."""
    raw = path.read_bytes()
    magic, version, header_len, _ = struct.unpack_from("<8sIIQ", raw)
    assert magic == b"CQCROWD\0" and version in (1, 2), (magic, version)
    header = json.loads(raw[24 : 24 + header_len])

    def array(name: str, dtype: str) -> np.ndarray:
        info = header["arrays"][name]
        return np.frombuffer(raw, dtype, info["count"], 24 + header_len + info["offset"])

    joints = len(header["skeleton"]["joints"])
    root = array("root", "<f4").reshape(-1, 3).astype(float)
    rotations = array("rotations", "<i2").reshape(-1, joints, 4) / 32767.0
    bones = [build["offsets"] for build in header.get("builds", [])]
    bones = np.array(bones or [[joint["offset"] for joint in header["skeleton"]["joints"]]])
    people, at = [], 0
    for c in header["characters"]:
        frames = slice(at, at + c["frames"])
        people.append(Person(c["begin"], bones[c.get("build", 0)], root[frames], rotations[frames]))
        at += c["frames"]
    return header, people


def rotate(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The vector v turned by the quaternion q (x, y, z, w)."""
    t = 2.0 * np.cross(q[:3], v)
    return v + q[3] * t + np.cross(q[:3], t)


def multiply(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The turn by b, then by a."""
    xyz = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    return np.append(xyz, a[3] * b[3] - a[:3] @ b[:3])


def joint_positions(header: dict[str, Any], person: Person, frame: int) -> dict[str, np.ndarray]:
    """Global joint positions (y up, metres) of a person at a frame of the crowd, by joint name."""
    i = frame - person.begin
    turned: list[np.ndarray] = []
    placed: list[np.ndarray] = []
    for j, joint in enumerate(header["skeleton"]["joints"]):
        local = person.rotations[i, j] / np.linalg.norm(person.rotations[i, j])
        parent = joint["parent"]
        if parent is None:
            turned.append(local)
            placed.append(person.root[i])
        else:
            turned.append(multiply(turned[parent], local))
            placed.append(placed[parent] + rotate(turned[parent], person.offsets[j]))
    return {joint["name"]: placed[j] for j, joint in enumerate(header["skeleton"]["joints"])}
