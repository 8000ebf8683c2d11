"""Writers of mesh files, one for each format, by the formats' own definitions."""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import TypeAlias

import numpy as np
import pytest
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Integers: TypeAlias = NDArray[np.int64]
Writer: TypeAlias = Callable[[Floats, Integers], bytes]

__all__ = ["WRITERS", "Writer", "ascii_ply", "ascii_stl", "binary_ply", "binary_stl", "glb", "obj", "off"]


def binary_stl(vertices: Floats, faces: Integers, header: bytes = b"part") -> bytes:
    triangles = [struct.pack("<12fH", 0, 0, 0, *vertices[face].ravel(), 0) for face in faces]
    return header.ljust(80) + struct.pack("<I", len(faces)) + b"".join(triangles)


def ascii_stl(vertices: Floats, faces: Integers, name: str = "part") -> bytes:
    lines = [f"solid {name}"]
    for face in faces:
        lines += ["  facet normal 0 0 0", "    outer loop"]
        lines += [f"      vertex {x!r} {y!r} {z!r}" for x, y, z in vertices[face].tolist()]
        lines += ["    endloop", "  endfacet"]
    return "\n".join([*lines, f"endsolid {name}", ""]).encode()


def obj(vertices: Floats, faces: Integers, base: int = 1) -> bytes:
    lines = ["# a comment", *(f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist())]
    return "\n".join([*lines, *("f {} {} {}".format(*face) for face in faces + base), ""]).encode()


def ascii_ply(vertices: Floats, faces: Integers) -> bytes:
    header = f"""ply
format ascii 1.0
element vertex {len(vertices)}
property double x
property double y
property double z
element face {len(faces)}
property list uchar int vertex_indices
end_header
"""
    return header.encode() + rows(vertices, faces)


def binary_ply(vertices: Floats, faces: Integers) -> bytes:
    header = (
        ascii_ply(vertices, faces).partition(b"end_header\n")[0].replace(b"ascii", b"binary_little_endian")
    )
    body = vertices.astype("<f8").tobytes() + b"".join(struct.pack("<B3i", 3, *face) for face in faces)
    return header + b"end_header\n" + body


def off(vertices: Floats, faces: Integers) -> bytes:
    return f"OFF\n{len(vertices)} {len(faces)} 0\n".encode() + rows(vertices, faces)


def rows(vertices: Floats, faces: Integers) -> bytes:
    lines = [f"{x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    return "\n".join([*lines, *("3 {} {} {}".format(*face) for face in faces), ""]).encode()


def glb(vertices: Floats, faces: Integers) -> bytes:
    trimesh = pytest.importorskip("trimesh")
    data: bytes = trimesh.Trimesh(vertices, faces, process=False).export(file_type="glb")
    return data


WRITERS: dict[str, tuple[str, Writer, str]] = {
    "binary STL": (".stl", binary_stl, "binary STL"),
    "binary STL that begins with 'solid'": (
        ".stl",
        lambda v, f: binary_stl(v, f, b"solid part"),
        "binary STL",
    ),
    "ASCII STL": (".STL", ascii_stl, "ASCII STL"),
    "OBJ": (".obj", obj, "v/f text"),
    "plates": (".tab", obj, "v/f text"),
    "ASCII PLY": (".ply", ascii_ply, "PLY"),
    "binary PLY": (".ply", binary_ply, "PLY"),
    "OFF": (".off", off, "OFF"),
    "GLB": (".glb", glb, "GLB"),
}
