"""Writers of mesh files, one for each format, by the formats' own definitions."""

from __future__ import annotations

import base64
import io
import json
import struct
import zipfile
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


def dae(
    vertices: Floats, faces: Integers, unit: str = '<unit name="meter" meter="1"/>', placed: str = ""
) -> bytes:
    """COLLADA with one geometry; `placed` are the transforms of its node."""
    numbers = " ".join(repr(x) for x in vertices.ravel().tolist())
    corners = " ".join(str(k) for k in faces.ravel().tolist())
    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><created>2026-01-01T00:00:00</created>{unit}<up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="shape"><mesh>
<source id="places"><float_array id="numbers" count="{3 * len(vertices)}">{numbers}</float_array>
<technique_common><accessor source="#numbers" count="{len(vertices)}" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source>
<vertices id="corners"><input semantic="POSITION" source="#places"/></vertices>
<triangles count="{len(faces)}"><input semantic="VERTEX" source="#corners" offset="0"/><p>{corners}</p>
</triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="view"><node>{placed}<instance_geometry url="#shape"/></node>
</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#view"/></scene>
</COLLADA>
""".encode()


def three_mf(
    vertices: Floats,
    faces: Integers,
    unit: str = 'unit="meter"',
    build: str = '<item objectid="1"/>',
    more: str = "",
) -> bytes:
    """A 3MF package with one object, and whatever more is placed."""
    points = "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in vertices.tolist())
    plates = "".join('<triangle v1="{}" v2="{}" v3="{}"/>'.format(*face) for face in faces)
    model = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
    relations = f'<Relationship Type="{model}" Target="/m.model"/>'
    package = io.BytesIO()
    with zipfile.ZipFile(package, "w", zipfile.ZIP_DEFLATED) as members:
        members.writestr("_rels/.rels", f"<Relationships>{relations}</Relationships>")
        members.writestr(
            "m.model",
            f'<?xml version="1.0"?><model {unit} xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
            f'<resources><object id="1" type="model"><mesh><vertices>{points}</vertices>'
            f"<triangles>{plates}</triangles></mesh></object>{more}</resources><build>{build}</build></model>",
        )
    return package.getvalue()


def gltf(vertices: Floats, faces: Integers) -> bytes:
    """GlTF with its numbers in it."""
    data = vertices.astype("<f4").tobytes() + faces.astype("<u4").tobytes()
    half = 12 * len(vertices)
    low, high = vertices.astype("<f4").min(axis=0).tolist(), vertices.astype("<f4").max(axis=0).tolist()
    scene = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": len(vertices),
                "type": "VEC3",
                "min": low,
                "max": high,
            },
            {"bufferView": 1, "componentType": 5125, "count": 3 * len(faces), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": half},
            {"buffer": 0, "byteOffset": half, "byteLength": len(data) - half},
        ],
        "buffers": [
            {
                "byteLength": len(data),
                "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode(),
            }
        ],
    }
    return json.dumps(scene).encode()


def numbered_plates(vertices: Floats, faces: Integers) -> bytes:
    """Gaskell's form: counts, and rows with their numbers before them."""
    lines = [str(len(vertices))]
    lines += [f"{k} {x!r} {y!r} {z!r}" for k, (x, y, z) in enumerate(vertices.tolist(), start=1)]
    lines += [str(len(faces))]
    lines += ["{} {} {} {}".format(k, *face) for k, face in enumerate((faces + 1).tolist(), start=1)]
    return "\n".join([*lines, ""]).encode()


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
    "glTF": (".gltf", gltf, "glTF"),
    "DAE": (".dae", dae, "COLLADA"),
    "3MF": (".3mf", three_mf, "3MF"),
    "numbered plates": (".tab", numbered_plates, "numbered plates"),
}
