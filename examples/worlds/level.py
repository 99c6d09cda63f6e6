"""Writes level.glb, in quads as level editors have them: a yard, a hall with tables and stairs, a terrace, a gallery.

python examples/worlds/level.py examples/worlds/level.glb
"""

import json
import struct
import sys
from pathlib import Path

Point = tuple[float, float, float]
Quad = tuple[Point, Point, Point, Point]


def plate(x: float, z: float, to_x: float, to_z: float, y: float = 0.0, to_y: float | None = None) -> Quad:
    """A rectangle that faces up; a ramp along x if it ends at another height."""
    end = y if to_y is None else to_y
    return ((x, y, z), (x, y, to_z), (to_x, end, to_z), (to_x, end, z))


def box(a: Point, b: Point) -> list[Quad]:
    """A closed box."""
    (x, y, z), (u, v, w) = a, b
    return [
        plate(x, z, u, w, v),
        ((x, y, z), (u, y, z), (u, y, w), (x, y, w)),
        ((x, y, z), (x, y, w), (x, v, w), (x, v, z)),
        ((u, y, z), (u, v, z), (u, v, w), (u, y, w)),
        ((x, y, z), (x, v, z), (u, v, z), (u, y, z)),
        ((x, y, w), (u, y, w), (u, v, w), (x, v, w)),
    ]


def level() -> dict[str, list[Quad]]:
    """Quads by their material."""
    walls = [
        ((18.0, 0.0, 2.0), (18.4, 3.2, 10.0)),
        ((18.0, 0.0, 18.0), (18.4, 3.2, 26.0)),
        ((18.0, 0.0, 2.0), (42.0, 3.2, 2.4)),
        ((18.0, 0.0, 25.6), (26.0, 3.2, 26.0)),
        ((34.0, 0.0, 25.6), (42.0, 3.2, 26.0)),
        ((41.6, 0.0, 2.0), (42.0, 3.2, 26.0)),
    ]
    tables = [((x, 0.7, z), (x + 2.4, 0.75, z + 1.2)) for x in (22.0, 30.0) for z in (12.0, 18.0)]
    stairs = [((38.4, 0.0, 22.0 - 0.3 * i), (41.6, 0.18 * i, 22.3 - 0.3 * i)) for i in range(1, 17)]
    gallery = ((18.4, 2.7, 2.4), (41.6, 2.88, 8.0))
    return {
        "yard": [plate(0.0, 0.0, 18.2, 40.0), plate(18.2, 25.8, 44.0, 40.0)],
        "hall": [plate(18.2, 2.0, 44.0, 25.8)],
        "terrace": [*box((44.0, 0.0, 0.0), (60.0, 1.2, 40.0)), plate(32.0, 29.0, 44.0, 37.0, 0.0, 1.2)],
        "stone": [quad for a, b in [*tables, *stairs, gallery] for quad in box(a, b)],
        "blocked": [quad for a, b in walls for quad in box(a, b)],
    }


def glb(quads: dict[str, list[Quad]]) -> bytes:
    """A mesh with one primitive for each material."""
    binary, views, accessors, primitives = b"", [], [], []
    for material, (_, own) in enumerate(quads.items()):
        corners = [corner for quad in own for corner in quad]
        places = struct.pack(f"<{3 * len(corners)}f", *(v for corner in corners for v in corner))
        order = [4 * quad + i for quad in range(len(own)) for i in (0, 1, 2, 0, 2, 3)]
        for data, kind, component, count in (
            (places, "VEC3", 5126, len(corners)),
            (struct.pack(f"<{len(order)}I", *order), "SCALAR", 5125, len(order)),
        ):
            views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
            accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": count, "type": kind})
            binary += data
        low, high = ([f(corner[i] for corner in corners) for i in range(3)] for f in (min, max))
        accessors[-2] |= {"min": low, "max": high}
        places_at, order_at = len(accessors) - 2, len(accessors) - 1
        primitives.append({"attributes": {"POSITION": places_at}, "indices": order_at, "material": material})
    text = json.dumps(
        {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0, "name": "level"}],
            "meshes": [{"primitives": primitives}],
            "materials": [{"name": name} for name in quads],
            "accessors": accessors,
            "bufferViews": views,
            "buffers": [{"byteLength": len(binary)}],
        }
    ).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


if __name__ == "__main__":
    Path(sys.argv[1]).write_bytes(glb(level()))
