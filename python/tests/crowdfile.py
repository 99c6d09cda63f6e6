"""Writes small crowd and patch-set files by their documented layout alone: an oracle for the readers."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass, field
from typing import Any

import numpy as np

JOINTS = 22
FPS = 30.0


def container(magic: bytes, header: dict[str, Any], arrays: dict[str, np.ndarray], version: int = 1) -> bytes:
    """The container layout of docs: prelude, JSON header, arrays at multiples of 8 bytes."""
    data, table = b"", {}
    for name in sorted(arrays):
        array = arrays[name]
        data += b"\0" * (-len(data) % 8)
        element = {"float32": "f32", "int16": "i16"}[str(array.dtype)]
        table[name] = {"type": element, "offset": len(data), "count": array.size}
        data += array.tobytes()
    text = json.dumps(header | {"arrays": table}).encode()
    text += b" " * (-len(text) % 8)
    return magic + struct.pack("<IIQ", version, len(text), len(data)) + text + data


def yaw(angle: np.ndarray) -> np.ndarray:
    """Rotations about +y as x, y, z, w."""
    zero = np.zeros_like(angle)
    return np.stack([zero, np.sin(angle / 2), zero, np.cos(angle / 2)], axis=-1)


def standing_pose(frames: int) -> np.ndarray:
    """(frames, 22, 4) of somebody standing with the arms down."""
    rotations = np.zeros((frames, JOINTS, 4))
    rotations[..., 3] = 1
    for joint, sign in ((15, -1), (19, 1)):
        rotations[:, joint] = [0, 0, sign * np.sin(0.65), np.cos(0.65)]
    return rotations


def packed(rotations: np.ndarray) -> np.ndarray:
    return np.round(rotations * 32767).astype(np.int16).ravel()


@dataclass
class Fragment:
    """A source motion: a straight walk of `length` metres over `frames` frames, beginning at `start`."""

    frames: int
    length: float
    start: tuple[float, float] = (0.0, 0.0)
    heading: float = 0.0
    entry: int = 0
    exit: int = 0

    @property
    def points(self) -> np.ndarray:
        along = np.linspace(0, self.length, self.frames)[:, None]
        return np.array(self.start) + along * [np.sin(self.heading), np.cos(self.heading)]


@dataclass
class Kind:
    name: str
    fragments: list[Fragment]
    core: tuple[int, int] | None = None
    labels: list[str] = field(default_factory=list)


WALK = Kind("walk", [Fragment(31, 1.2)])
MEET = Kind("greet", [Fragment(61, 1.6), Fragment(61, 1.6, (0.0, 4.0), np.pi)], core=(20, 40), labels=["greet"])


def set_parts(kinds: list[Kind], prefix: str) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Header and arrays of a patch set."""
    fragments = [f for kind in kinds for f in kind.fragments]
    header = {
        "fps": FPS,
        "skeleton": {"joints": []},
        "groups": [{"name": "walk"}, {"name": "never"}],
        "kinds": [
            {
                "name": kind.name,
                "labels": kind.labels,
                "mirrored": False,
                "core": kind.core,
                "contacts": [],
                "fragments": [
                    {
                        "begin": 0,
                        "frames": f.frames,
                        "entry_group": f.entry,
                        "exit_group": f.exit,
                        "plants": [],
                    }
                    for f in kind.fragments
                ],
            }
            for kind in kinds
        ],
    }
    arrays = {
        "points": np.concatenate([f.points for f in fragments]).astype(np.float32).ravel(),
        "headings": np.concatenate([np.full(f.frames, f.heading) for f in fragments]).astype(np.float32),
        "heights": np.concatenate([np.full(f.frames, 0.935) for f in fragments]).astype(np.float32),
        "rotations": np.concatenate([packed(standing_pose(f.frames)) for f in fragments]),
    }
    return header, {prefix + name: array for name, array in arrays.items()}


def patch_set(kinds: list[Kind]) -> bytes:
    """A patch-set file."""
    header, arrays = set_parts(kinds, "")
    return container(b"CQPATCH\0", header, arrays)


@dataclass
class Use:
    """A fragment placed in a person's life: instance, role, first frame, ground points, heading."""

    instance: int
    role: int
    begin: int
    points: np.ndarray
    headings: np.ndarray


def crowd(
    kinds: list[Kind],
    instances: list[int],
    people: list[list[Use]],
    last_frame: int = 600,
    side: float = 12.0,
    obstacles: list[list[tuple[float, float]]] | None = None,
) -> bytes:
    """A crowd file; everybody glides along the placed fragments in a standing pose."""
    set_header, arrays = set_parts(kinds, "set_")
    roots, rotations, points, headings, characters = [], [], [], [], []
    for uses in people:
        begin = max(0, uses[0].begin)
        end = min(last_frame, uses[-1].begin + len(uses[-1].points) - 1)
        path = np.concatenate([u.points[: len(u.points) - 1] for u in uses] + [uses[-1].points[-1:]])
        turn = np.concatenate([u.headings[: len(u.points) - 1] for u in uses] + [uses[-1].headings[-1:]])
        cut = slice(begin - uses[0].begin, end - uses[0].begin + 1)
        path, turn = path[cut], turn[cut]
        pose = standing_pose(len(path))
        pose[:, 0] = yaw(turn)
        roots.append(np.stack([path[:, 0], np.full(len(path), 0.935), path[:, 1]], axis=1))
        rotations.append(packed(pose))
        points += [u.points for u in uses]
        headings += [u.headings for u in uses]
        fragments = [
            {
                "instance": u.instance,
                "role": u.role,
                "begin": u.begin,
                "end": u.begin + len(u.points) - 1,
                "samples": len(u.points),
            }
            for u in uses
        ]
        characters.append({"begin": begin, "frames": len(path), "fragments": fragments})
    square = [[0, 0], [side, 0], [side, side], [0, side]]
    header = {
        "fps": FPS,
        "seed": 7,
        "skeleton": {"joints": []},
        "domain": {
            "region": {"points": square},
            "obstacles": [{"points": [list(p) for p in o]} for o in obstacles or []],
            "last_frame": last_frame,
        },
        "instances": [{"kind": kind} for kind in instances],
        "characters": characters,
        "set": set_header,
    }
    arrays |= {
        "root": np.concatenate(roots).astype(np.float32).ravel(),
        "rotations": np.concatenate(rotations),
        "path_points": np.concatenate(points).astype(np.float32).ravel(),
        "path_headings": np.concatenate(headings).astype(np.float32),
    }
    return container(b"CQCROWD\0", header, arrays)


def walkers(count: int = 3, last_frame: int = 90, side: float = 12.0, apart: float = 1.0) -> bytes:
    """`count` people who walk abreast along +z, each by three patches that meet end to end."""
    instances, people = [], []
    for person in range(count):
        uses = []
        for step in range(3):
            z = 1.0 + 1.2 * step + np.linspace(0, 1.2, 31)
            uses.append(
                Use(len(instances), 0, 30 * step, np.stack([np.full(31, 1.0 + apart * person), z], 1), np.zeros(31))
            )
            instances.append(0)
        people.append(uses)
    return crowd([WALK], instances, people, last_frame, side)
