"""Small files that ask for much: one or more of each reader, each of at most a megabyte."""

# ruff: noqa: E501 (texts of files)
from __future__ import annotations

import base64
import gzip
import io
import json
import struct
import zipfile
from collections.abc import Callable, Mapping
from functools import cache
from typing import TypeAlias

import numpy as np

__all__ = ["HOSTILE", "Case", "Files"]

Files: TypeAlias = dict[str, bytes]
"""By name; the first is the one that is read."""
Case: TypeAlias = Files | Callable[[], Files]
"""Files, or what makes them where that takes long."""

MEGA = 1_000_000
XYZ = '<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>'
TETRAHEDRON = "0 0 0 1 0 0 0 1 0 0 0 1"
FACES = "0 2 1 0 1 3 0 3 2 1 2 3"


def packed(data: bytes) -> bytes:
    """Pack what is to be unpacked, in as many bytes as a file may have: empty members with long heads."""
    body = gzip.compress(data, 6)
    empty = b"\x1f\x8b\x08\x04\0\0\0\0\0\xff\xff\xff" + bytes(0xFFFF) + b"\x03\0" + bytes(8)
    return body + empty * ((MEGA - len(body)) // len(empty))


def zipped(members: dict[str, str | bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", method) as archive:
        for name, data in members.items():
            archive.writestr(name, data)
        if (left := MEGA - 10_000 - stream.tell()) > 0:  # more may come of a larger file
            archive.writestr("padding", bytes(left), zipfile.ZIP_STORED)
    return stream.getvalue()


# COLLADA ----------------------------------------------------


def dae(nodes: str, scene: str, geometry: str = "", numbers: str = TETRAHEDRON) -> bytes:
    count = len(numbers.split())
    geometry = geometry or (
        '<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>'
        + f"<p>{FACES}</p></triangles>"
    )
    return f"""<COLLADA><library_geometries><geometry id="g"><mesh><source id="s">
<float_array id="a" count="{count}">{numbers}</float_array><technique_common>
<accessor source="#a" count="{count // 3}" stride="3">{XYZ}</accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>{geometry}</mesh></geometry>
</library_geometries><library_nodes>{nodes}</library_nodes><library_visual_scenes>
<visual_scene id="view">{scene}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#view"/></scene></COLLADA>""".encode()


def doubling(depth: int, leaf: str) -> str:
    return "".join(
        f'<node id="n{i}">' + 2 * f'<instance_node url="#n{i + 1}"/>' + "</node>" for i in range(depth)
    ) + (f'<node id="n{depth}">{leaf}</node>')


SHOWN = '<instance_geometry url="#g"/>'
START = '<node><instance_node url="#n0"/></node>'
GROUP = '<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>'


def collada() -> dict[str, Case]:
    many = " ".join(["0"] * 150_000)
    children = f'<node id="n0">{"<extra/>" * 30_000}{SHOWN}</node>'
    vcount = '<polylist count="4"><input semantic="VERTEX" source="#v" offset="0"/><vcount>{}</vcount><p>{}</p></polylist>'
    return {
        "nodes of nodes": {"a.dae": dae(doubling(60, ""), START)},
        "geometries of nodes": {"a.dae": dae(doubling(60, SHOWN), START)},
        "a node shown again and again": {"a.dae": dae(f'<node id="n0">{SHOWN}</node>', START * 20_000)},
        "a node of many children": {"a.dae": dae(children, START * 15_000)},
        "groups of one source": {"a.dae": dae("", f"<node>{SHOWN}</node>", GROUP * 5_000, many)},
        "a geometry shown by many nodes": {"a.dae": dae("", f"<node>{SHOWN}</node>" * 15_000, GROUP * 4_000)},
        "transforms": {"a.dae": dae("", f"<node>{'<translate>0 0 0</translate>' * 30_000}{SHOWN}</node>")},
        "polygons whose sum wraps": {
            "a.dae": dae("", f"<node>{SHOWN}</node>", vcount.format(f"{2**62} {2**62} {2**62} {2**62}", ""))
        },
        "one large polygon": {
            "a.dae": dae(
                "", f"<node>{SHOWN}</node>", vcount.replace('"4"', '"1"').format(300_000, "0 " * 300_000)
            )
        },
        "long numbers": {"a.dae": dae("", f"<node>{SHOWN}</node>", numbers="1" * 900_000 + " 0 0")},
        "huge numbers": {"a.dae": dae("", f"<node>{SHOWN}</node>", numbers="1e5000 " * 12)},
        "nested": {"a.dae": dae("", "<node>" * 70_000 + "</node>" * 70_000)},
        "entities": {
            "a.dae": b"<!DOCTYPE a [<!ENTITY a 'aaaa'>"
            + b"".join(b"<!ENTITY a%d '%s'>" % (i, b"&a%d;" % (i - 1) * 10) for i in range(1, 30))
            + b"]><COLLADA>&a29;</COLLADA>"
        },
        "unclosed comments": {"a.dae": b"<COLLADA>" + b"<!--" * 240_000},
        "attributes": {"a.dae": b"<COLLADA " + b" ".join(b"a%d=''" % i for i in range(90_000)) + b"/>"},
        "a packed text of zeros": lambda: {
            "a.dae.gz": packed(dae("", f"<node>{SHOWN}</node>", numbers="0 " * 22_000_000))
        },
        "packed elements": lambda: {"a.dae.gz": packed(b"<COLLADA>" + b"<a/>" * 11_000_000 + b"</COLLADA>")},
    }


# glTF -------------------------------------------------------


def scene(data: bytes, count: int = 3, **changes: object) -> dict[str, object]:
    return {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 12 * count}],
        "buffers": [
            {"byteLength": len(data), "uri": "data:;base64," + base64.b64encode(data).decode()},
        ],
        **changes,
    }


def gltf() -> dict[str, Case]:
    large = np.zeros((15_000, 3), "<f4").tobytes()
    one = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4").tobytes()
    view = {"bufferView": 0, "componentType": 5126, "count": 15_000, "type": "VEC3"}
    primitive = {"attributes": {"POSITION": 0}}

    def text(**kinds: object) -> bytes:
        return json.dumps(kinds).encode()

    beside = {**scene(large), "buffers": [{"byteLength": 3 * 10**5, "uri": "b.bin"}] * 900}
    return {
        "a buffer named again": {"a.gltf": text(**beside), "b.bin": bytes(300_000)},
        "accessors of one view": {
            "a.gltf": text(
                **scene(
                    large,
                    15_000,
                    accessors=[view] * 8_000,
                    meshes=[{"primitives": [{"attributes": {"POSITION": i}} for i in range(8_000)]}],
                )
            )
        },
        "primitives of one accessor": {
            "a.gltf": text(**scene(large, 15_000, meshes=[{"primitives": [primitive] * 20_000}]))
        },
        "nodes of one mesh": {
            "a.gltf": text(
                **scene(
                    large,
                    15_000,
                    nodes=[{"mesh": 0}] * 40_000,
                    scenes=[{"nodes": list(range(40_000))}],
                )
            )
        },
        "meshes of many primitives": {
            "a.gltf": text(
                **scene(
                    one,
                    meshes=[{"primitives": [primitive] * 10_000}],
                    nodes=[{"mesh": 0}] * 20_000,
                    scenes=[{"nodes": list(range(20_000))}],
                )
            )
        },
        "a node in the scene again": {"a.gltf": text(**scene(one, scenes=[{"nodes": [0] * 200_000}]))},
        "a chain of nodes": {
            "a.gltf": text(**scene(one, nodes=[{"children": [i + 1]} for i in range(40_000)] + [{"mesh": 0}]))
        },
        "a huge count": {"a.gltf": text(**scene(one, 10**15))},
        "a huge stride": {
            "a.gltf": text(**scene(one, bufferViews=[{"buffer": 0, "byteLength": 36, "byteStride": 10**18}]))
        },
        "negative offsets": {
            "a.gltf": text(
                **scene(one, bufferViews=[{"buffer": 0, "byteLength": 10**9, "byteOffset": -(10**9)}])
            )
        },
        "nested": {"a.gltf": b'{"asset":' + b"[" * 400_000},
        "long numbers": {"a.gltf": b'{"asset":' + b"1" * 900_000 + b"}"},
        "huge numbers": {"a.gltf": text(**scene(one)).replace(b'"count": 3', b'"count": 1e5000')},
        "packed objects": lambda: {"a.gltf.gz": packed(b'{"asset":[' + b"{}," * 14_000_000 + b"{}]}")},
    }


def glb() -> dict[str, Files]:
    text = b'{"asset":{"version":"2.0"}}'.ljust(28)
    head = struct.pack("<5I", 0x46546C67, 2, 20 + len(text), 2**32 - 1, 0x4E4F534A)
    data = bytes(180_000)
    view = {"bufferView": 0, "componentType": 5126, "count": 15_000, "type": "VEC3"}
    much = {
        **scene(b"", 15_000, accessors=[view] * 8_000),
        "meshes": [{"primitives": [{"attributes": {"POSITION": i}} for i in range(8_000)]}],
        "buffers": [{"byteLength": len(data)}],
    }
    described = json.dumps(much).encode()
    described += b" " * (-len(described) % 4)
    whole = struct.pack("<5I", 0x46546C67, 2, 28 + len(described) + len(data), len(described), 0x4E4F534A)
    whole += described + struct.pack("<2I", len(data), 0x004E4942) + data
    return {"a huge length": {"a.glb": head + text}, "accessors of one view": {"a.glb": whole}}


# 3MF --------------------------------------------------------

MODEL = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
RELATIONS = f'<Relationships><Relationship Type="{MODEL}" Target="/m.model"/></Relationships>'
MESH = (
    "<mesh><vertices>"
    + "".join(
        f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
    )
    + "</vertices><triangles>"
    + "".join(
        '<triangle v1="{}" v2="{}" v3="{}"/>'.format(*f) for f in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
    )
    + "</triangles></mesh>"
)


def three_mf(objects: str, build: str, **more: str) -> bytes:
    model = f"<model><resources>{objects}</resources><build>{build}</build></model>"
    return zipped({"_rels/.rels": RELATIONS, "m.model": model, **more})


def packages() -> dict[str, Case]:
    one = f'<object id="0">{MESH}</object>'
    tens = one + "".join(
        f'<object id="{i}"><components>' + f'<component objectid="{i - 1}"/>' * 10 + "</components></object>"
        for i in range(1, 40)
    )
    many = '<object id="0"><mesh><vertices><vertex x="0" y="0" z="0"/></vertices><triangles>{}</triangles></mesh></object>'
    triangle = '<triangle v1="0" v2="0" v3="0"/>'
    stored = io.BytesIO()
    with zipfile.ZipFile(stored, "w") as archive:
        archive.writestr("_rels/.rels", RELATIONS)
        archive.writestr("m.model", b"<model>" + b" " * 400_000 + b"</model>")
    return {
        "components of components": {"a.3mf": three_mf(tens, '<item objectid="39"/>')},
        "a mesh of many items": lambda: {
            "a.3mf": three_mf(many.format(triangle * 300_000), '<item objectid="0"/>' * 140)
        },
        "items": lambda: {"a.3mf": three_mf(one, '<item objectid="0"/>' * 2_000_000)},
        "itself": {
            "a.3mf": three_mf(
                '<object id="1"><components><component objectid="1"/><component objectid="1"/></components></object>',
                '<item objectid="1"/>',
            )
        },
        "packed blanks": lambda: {"a.3mf": three_mf(" " * 200_000_000, "")},
        "packed elements": lambda: {"a.3mf": three_mf("<a/>" * 11_000_000, "")},
        "packed vertices": lambda: {
            "a.3mf": three_mf(
                '<object id="0"><mesh>' + '<vertex x="0" y="0" z="0"/>' * 1_500_000 + "</mesh></object>", ""
            )
        },
        "one long token": lambda: {"a.3mf": three_mf(f'<object id="{"a" * 40_000_000}"/>', "")},
        "nested": lambda: {"a.3mf": three_mf("<a>" * 5_000_000, "")},
        "settings": lambda: {
            "a.3mf": three_mf(
                one,
                '<item objectid="0"/>',
                **{
                    "Metadata/Slic3r_PE_model.config": '<config><object id="0">'
                    + '<volume firstid="0" lastid="3"/>' * 1_000_000
                    + "</object></config>"
                },
            )
        },
        "negative volumes": {
            "a.3mf": three_mf(
                one
                + one.replace('id="0"', 'id="1"')
                + '<object id="2"><components>'
                + '<component objectid="0"/>' * 400
                + '<component objectid="1"/>' * 400
                + "</components></object>",
                '<item objectid="2"/>',
                **{
                    "Metadata/model_settings.config": '<config><object id="2"><part id="0" '
                    'subtype="negative_part"/></object></config>'
                },
            )
        },
    }


# Texts of triangles, and binary ones ------------------------


def meshes() -> dict[str, Case]:
    facet = b"facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 0 0 vertex 0 0 0 endloop endfacet\n"
    ply = b"ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
    ply += b"element face %d\nproperty list uchar int vertex_indices\nend_header\n"
    binary = ply.replace(b"ascii", b"binary_little_endian")
    wide = b"ply\nformat binary_little_endian 1.0\nelement vertex 900000\n" + b"".join(
        b"property double a%d\n" % i for i in range(40_000)
    )
    fan = b"v 0 0 0\n" + b"f " + b"1 " * 450_000 + b"\n"
    tetrahedron = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    many = b"".join(
        b"v %d 0 0\nv %d 1 0\nv %d 0 1\nv %d 0 0\nf %d %d %d\nf %d %d %d\nf %d %d %d\nf %d %d %d\n"
        % (x, x, x, x + 90000, *(4 * x + k for k in (1, 3, 2, 1, 2, 4, 1, 4, 3, 2, 3, 4)))
        for x in range(190)
    )
    return {
        "STL: solids without facets": {"a.stl": b"solid facet\nendsolid facet\n" * 35_000},
        "STL: a long line": {"a.stl": b"solid facet " + b"a" * 900_000 + b"\nendsolid\n"},
        "STL: huge numbers": {
            "a.stl": b"solid a\n" + facet.replace(b"vertex 0", b"vertex 1e5000") + b"endsolid\n"
        },
        "STL: long numbers": {
            "a.stl": b"solid facet\n"
            + facet.replace(b"vertex 0", b"vertex " + b"1" * 200_000)
            + b"endsolid\n"
        },
        "STL: packed facets": lambda: {"a.stl.gz": packed(b"solid a\n" + facet * 500_000 + b"endsolid\n")},
        "STL: packed triangles": {
            "a.stl.gz": packed(bytes(80) + struct.pack("<I", 900_000) + bytes(50 * 900_000))
        },
        "STL: a huge count": {"a.stl": bytes(80) + struct.pack("<I", 2**32 - 1) + bytes(1000)},
        "OBJ: continued lines": {
            "a.obj": tetrahedron + b"f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4" + b" \\\n" * 300_000
        },
        "OBJ: a large polygon": {"a.obj": fan},
        "OBJ: huge numbers": {"a.obj": b"v 1e5000 0 0\n" + fan[:1000]},
        "OBJ: far indices": {"a.obj": tetrahedron + b"f 1 2 99999999999999999999999\n"},
        "OBJ: components that overlap": {"a.obj": many},
        "OBJ: packed lines": lambda: {"a.obj.gz": packed(tetrahedron + b"v 0 0 0\n" * 5_000_000)},
        "plates: huge counts": {"a.tab": b"99999999999\n1 0 0 0\n2 0 0 0\n3 0 0 0\n"},
        "PLY: huge counts": {"a.ply": ply % (10**15, 10**15)},
        "PLY: binary, huge counts": {"a.ply": binary % (10**15, 10**15) + bytes(100)},
        "PLY: a list that is long": {
            "a.ply": binary.replace(b"uchar int", b"uint int") % (3, 2)
            + bytes(36)
            + b"\xff" * 4
            + bytes(800_000)
        },
        "PLY: many properties": {"a.ply": wide + b"end_header\n" + bytes(100_000)},
        "PLY: a large polygon": {
            "a.ply": (ply % (3, 1)).replace(b"uchar", b"uint")
            + b"0 0 0\n1 0 0\n0 1 0\n400000 "
            + b"0 " * 400_000
        },
        "PLY: packed words": {"a.ply.gz": packed(ply % (7_000_000, 0) + b"0 0 0\n" * 7_000_000)},
        "OFF: huge counts": {"a.off": b"OFF\n999999999999999 9999999999999 0\n0 0 0\n"},
        "OFF: long numbers": {"a.off": b"OFF\n" + b"1" * 900_000 + b" 1 0\n"},
        "OFF: a large polygon": {"a.off": b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n400000 " + b"0 " * 400_000},
        "OFF: packed words": lambda: {"a.off.gz": packed(b"OFF\n7000000 0 0\n" + b"0 0 0\n" * 7_000_000)},
    }


def vtk() -> dict[str, Files]:
    head = b"# vtk DataFile Version 3.0\na\nASCII\n"
    grid = b"<VTKFile type='UnstructuredGrid' version='0.1' byte_order='LittleEndian'><UnstructuredGrid>"
    axis = b" ".join(b"%d" % i for i in range(60_000))
    return {
        "huge counts": {"a.vtk": head + b"DATASET POLYDATA\nPOINTS 99999999999 double\n0 0 0\n"},
        "huge cells": {
            "a.vtk": head + b"DATASET POLYDATA\nPOINTS 3 double\n0 0 0 1 0 0 0 1 0\nPOLYGONS 9999999999 99999999999\n3 0 1 2\n"
        },
        "a grid of two axes": {
            "a.vtk": head
            + b"DATASET RECTILINEAR_GRID\nDIMENSIONS 60000 60000 2\nX_COORDINATES 60000 float\n"
            + axis
            + b"\nY_COORDINATES 60000 float\n"
            + axis
            + b"\nZ_COORDINATES 2 float\n0 1\n"
        },
        "points of a grid": {
            "a.vtk": head + b"DATASET STRUCTURED_POINTS\nDIMENSIONS 100000 100000 100000\nORIGIN 0 0 0\nSPACING 1 1 1\n"
        },
        "a large polygon": {
            "a.vtk": head
            + b"DATASET POLYDATA\nPOINTS 40000 double\n"
            + b"".join(b"%d %d 0\n" % (x, x * x) for x in range(40_000))
            + b"POLYGONS 1 40001\n40000 "
            + b" ".join(b"%d" % x for x in range(40_000))
            + b"\n"
        },
        "XML: huge counts": {
            "a.vtu": grid
            + b"<Piece NumberOfPoints='99999999999' NumberOfCells='9999999999'><Points><DataArray type='Float64' "
            b"NumberOfComponents='3' format='ascii'>0 0 0</DataArray></Points><Cells><DataArray type='Int64' "
            b"Name='connectivity' format='ascii'>0</DataArray><DataArray type='Int64' Name='offsets' format='ascii'>1"
            b"</DataArray><DataArray type='UInt8' Name='types' format='ascii'>1</DataArray></Cells></Piece>"
            b"</UnstructuredGrid></VTKFile>"
        },
        "XML: pieces": {
            "a.vtu": grid + b"<Piece NumberOfPoints='0' NumberOfCells='0'/>" * 15_000 + b"</UnstructuredGrid></VTKFile>"
        },
        "XML: entities": {"a.vtu": b"<!DOCTYPE a [<!ENTITY a 'aaaa'>"
            + b"".join(b"<!ENTITY a%d '%s'>" % (i, b"&a%d;" % (i - 1) * 10) if i > 1 else b"<!ENTITY a1 '&a;'>" for i in range(1, 30))
            + b"]><VTKFile>&a29;</VTKFile>"
        },
    }  # fmt: skip


# Molecules --------------------------------------------------


def molecules() -> dict[str, Case]:
    mol = "a\n\n\n{:3d}  0  0  0  0  0  0  0  0  0999 V2000\n"
    atom = "    0.0000    0.0000    0.0000 C   0  0\n"
    return {
        "XYZ: packed atoms": {"a.xyz.gz": packed(b"6000000\n\n" + b"C 0 0 0\n" * 6_000_000)},
        "XYZ: atoms": {"a.xyz": b"120000\n\n" + b"".join(b"C 0 0 %d\n" % (i % 10) for i in range(120_000))[: MEGA - 50_000]},
        "XYZ: a huge count": {"a.xyz": b"9" * 3999 + b"\n\nC 0 0 0\n"},
        "XYZ: huge numbers": {"a.xyz": b"2\n\nC 1e5000 0 0\nC 0 0 1e-999999999\n"},
        "XYZ: long numbers": {"a.xyz": b"1\n\nC 0." + b"1" * 900_000 + b" 0 0\n"},
        "XYZ: exponents": {"a.xyz": b"3\n\nC 1e-300000 1e300 0\nC 1.5e-99999 0 0\nC 1E+300 0 1\n"},
        "XYZ: properties": {"a.xyz": b'1\n' + b' Properties="' * 70_000 + b"\nC 0 0 0\n"},
        "XYZ: a long label": {"a.xyz": b"1\n\n" + b"9" * 900_000 + b" 0 0 0\n"},
        "PDB: blanks": {"a.pdb": b"ATOM  " * 150_000},
        "PDB: atoms": {"a.pdb": b"ATOM      1  C   XXX A   1       0.000   0.000   0.000  1.00  0.00           C  \n" * 12_000},
        "MOL: isotopes": {"a.mol": (mol.format(1) + atom + "M  ISO" + "  1   1  13" * 80_000 + "\nM  END\n").encode()},
        "MOL: a long mass": {
            "a.mol": (
                "a\n\n\n  0  0  0     0  0            999 V3000\nM  V30 BEGIN CTAB\nM  V30 COUNTS 1 0 0 0 0\nM  V30 BEGIN ATOM\n"
                f"M  V30 1 C 0 0 0 0 MASS={'9' * 900_000}\nM  V30 END ATOM\nM  V30 END CTAB\nM  END\n"
            ).encode()
        },
        "SDF: records": {"a.sdf": b"$$$$\n" * 190_000},
    }  # fmt: skip


# Robots -----------------------------------------------------

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def robots() -> dict[str, Files]:
    def include(name: str, times: int) -> str:
        return f"<include><uri>{name}</uri></include>" * times

    def mjcf(inside: str, before: str = "") -> bytes:
        return f"<mujoco>{before}<worldbody>{inside}</worldbody></mujoco>".encode()

    attribute = 'a{}="0"'.format
    replicated = '<replicate count="99">' * 20 + '<geom size="1"/>' + "</replicate>" * 20
    boxes = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
    stl = bytes(80) + struct.pack("<I", 2_000) + bytes(50 * 2_000)
    mesh = '<collision><geometry><mesh filename="m.stl" scale="1 1 {}"/></geometry></collision>'
    joints = "".join(
        f'<joint name="j{i}" type="fixed"><parent link="l{i}"/><child link="l{i + 1}"/></joint>'
        for i in range(3_000)
    )
    links = "".join(f'<link name="l{i}">{INERTIAL}</link>' for i in range(3_001))
    return {
        "URDF: links": {"r.urdf": f"<robot>{'<link/>' * 100_001}</robot>".encode()},
        "URDF: shapes": {"r.urdf": f"<robot><link>{INERTIAL}{boxes * 10_000}</link></robot>".encode()},
        "URDF: a chain": {"r.urdf": f"<robot>{links}{joints}</robot>".encode()},
        "URDF: a mesh in many scales": {
            "r.urdf": f"<robot><link>{INERTIAL}{''.join(map(mesh.format, range(1, 5_000)))}</link></robot>".encode(),
            "m.stl": stl,
        },
        "URDF: huge numbers": {
            "r.urdf": f"<robot><link>{INERTIAL.replace('1', '1e5000')}</link></robot>".encode()
        },
        "URDF: long numbers": {
            "r.urdf": f"<robot><link>{INERTIAL.replace('1', '1' * 100_000)}</link></robot>".encode()
        },
        "URDF: entities": {
            "r.urdf": b"<!DOCTYPE a [<!ENTITY a 'aaaa'>"
            + b"<!ENTITY b '&a;&a;&a;'>"
            + b"]><robot name='&b;'/>"
        },
        "SDF: models of models": {
            "r.sdf": f'<sdf><model name="m"><link/>{include("a.sdf", 10)}</model></sdf>'.encode(),
            **{
                f"{name}.sdf": f'<sdf><model name="m"><link/>{include(f"{inner}.sdf", 10)}</model></sdf>'.encode()
                for name, inner in zip("abcdefgh", "bcdefghi", strict=True)
            },
            "i.sdf": b'<sdf><model name="m"><link/></model></sdf>',
        },
        "SDF: a large model again": {
            "r.sdf": f'<sdf><model name="m">{include("a.sdf", 10_000)}</model></sdf>'.encode(),
            "a.sdf": f'<sdf><model name="m">{"<link/>" * 60_000}</model></sdf>'.encode(),
        },
        "MJCF: replicas": {"r.xml": mjcf(f"<body>{replicated}</body>")},
        "MJCF: classes": {
            "r.xml": mjcf(
                '<body><geom class="c149"/></body>' * 1_000,
                "<default>"
                + "".join(
                    f'<default class="c{i}"><geom {" ".join(map(attribute, range(300)))}/>'
                    for i in range(150)
                )
                + "</default>" * 151,
            )
        },
        "MJCF: bodies": {"r.xml": mjcf("<body/>" * 120_000)},
        "MJCF: includes": {"r.xml": mjcf('<include file="b.xml"/>' * 30_000), "b.xml": b"<x><body/></x>"},
    }


# Assemblies, ledgers, saved files ---------------------------

PART = '[[part]]\nname="{}"\n{}\n'


def assemblies() -> dict[str, Files]:
    def nested(inner: str, times: int) -> str:
        return "".join(PART.format(k, f'assembly="{inner}"') for k in range(times))

    cube = 'solid="cube"\nside=1\nmass=1'
    stl = bytes(80) + struct.pack("<I", 8_000) + bytes(50 * 8_000)
    box = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    return {
        "tens of tens": {
            "a.toml": nested("b.toml", 10).encode(),
            "b.toml": nested("c.toml", 10).encode(),
            "c.toml": nested("d.toml", 10).encode(),
            "d.toml": nested("e.toml", 10).encode(),
            "e.toml": nested("f.toml", 10).encode(),
            "f.toml": PART.format("x", cube).encode(),
        },
        "copies": {"a.toml": PART.format("x", cube + "\ncount=99999").encode()},
        "copies of round parts": {
            "a.toml": PART.format("x", 'solid="sphere"\nradius=1\nmass=1\ncount=2900\nstep=[0.1,0,0]').encode()
        },
        "round parts that overlap": {
            "a.toml": "".join(
                PART.format(k, f'solid="torus"\nmajor_radius=1\nminor_radius=0.{k + 1:04}\nmass=1') for k in range(2_500)
            ).encode()
        },
        "a prism of many sides": {"a.toml": PART.format("x", 'solid="prism"\nsides=1000000000\nradius=1\nheight=1\nmass=1').encode()},
        "parts": {"a.toml": "".join(PART.format(k, cube) for k in range(14_000)).encode()},
        "a file again": {
            "a.toml": ('length_unit="m"\n' + "".join(PART.format(k, f'file="m.obj"\ndensity={k + 1}') for k in range(15_000))).encode(),
            "m.obj": box,
        },
        "a large file again": {
            "a.toml": ('length_unit="m"\n' + "".join(PART.format(k, f'file="m.stl"\nmass={k + 1}\nclosure="hull"') for k in range(9_000))).encode(),
            "m.stl": stl,
        },
        "nested tables": {"a.toml": b"a=" + b"[" * 900_000},
        "dotted keys": {"a.toml": b".".join([b"a"] * 400_000) + b"=1\n"},
        "long numbers": {"a.toml": PART.format("x", cube.replace("mass=1", "mass=" + "1" * 900_000)).encode()},
        "huge numbers": {"a.toml": PART.format("x", cube.replace("mass=1", "mass=1e5000")).encode()},
        "a long unit": {"a.toml": PART.format("x", cube.replace("mass=1", 'mass="1 ' + "k" * 900_000 + '"')).encode()},
        "a long power": {"a.toml": PART.format("x", cube.replace("mass=1", 'mass="1 ' + "kg^9*" * 150_000 + 'kg"')).encode()},
        "itself": {"a.toml": nested("a.toml", 3).encode()},
    }  # fmt: skip


LEDGER = "id,parent,mass,Cx,Cy,Cz,Ixx,Iyy,Izz,Ixy,Ixz,Iyz,sigma_mass,source,POIconv\n"


def ledgers() -> dict[str, Files]:
    deep = "".join(f"{k},{k - 1 if k else ''},,,,,,,,,,,,,\n" for k in range(25_000))
    leaf = "{},{},1,0,0,0,1,1,1,0,0,0,1,{},+\n"
    chain = "".join(f"{k},{k - 1 if k else ''},,,,,,,,,,,,,\n" for k in range(900))
    shared = "".join(leaf.format(f"p{k}", 899, f"s{k // 2}") for k in range(20_000))
    return {
        "a chain": {"a.csv": (LEDGER + deep + leaf.format("x", 24_999, "")).encode()},
        "shared sources in a chain": {"a.csv": (LEDGER + chain + shared).encode()},
        "columns": {"a.csv": ",".join(f"c{k}" for k in range(140_000)).encode()},
        "columns without names": {"a.csv": b"," * 900_000},
        "an unknown column": {"a.csv": b"m" * 900_000 + b"\n1\n"},
        "a circle": {"a.csv": (LEDGER + "".join(leaf.format(k, (k + 1) % 25_000, "") for k in range(25_000))).encode()},
        "long numbers": {"a.csv": (LEDGER + leaf.format("a", "", "").replace(",1,", f",{'1' * 900_000},", 1)).encode()},
        "huge numbers": {"a.csv": (LEDGER + leaf.format("a", "", "").replace(",1,", ",1e5000,", 1)).encode()},
        "an open quote": {"a.csv": b'id,parent\n"' + b"a\n" * 400_000},
    }  # fmt: skip


def npy(shape: tuple[int, ...], data: bytes = b"") -> bytes:
    header = str({"descr": "<f8", "fortran_order": False, "shape": shape}).encode()
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header + data


@cache
def overlapping(count: int, size: int) -> bytes:
    """An archive whose directory names one stored member again and again."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("a0.npy", npy((size // 8,), bytes(size)))
        (only,) = archive.infolist()
        for k in range(1, count):
            other = zipfile.ZipInfo(f"a{k}.npy")
            other.header_offset, other.CRC = only.header_offset, only.CRC
            other.file_size = other.compress_size = only.file_size
            archive.filelist.append(other)
            archive.NameToInfo[other.filename] = other
        archive._didModify = True  # type: ignore[attr-defined] # so that the directory is written
    return stream.getvalue()


@cache
def zeros() -> bytes:
    """An archive of one array of zeros."""
    return zipped({"mass.npy": npy((15_000_000,), bytes(8 * 15_000_000))})


@cache
def many_zeros() -> bytes:
    """An archive of sixty arrays of zeros, the bytes of which are packed once."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("m0.npy", npy((1_900_000,), bytes(15_200_000)))
        (first,) = archive.infolist()
        data = stream.getvalue()[len(first.FileHeader()) :]
        for k in range(1, 60):
            other = zipfile.ZipInfo(f"m{k}.npy")
            other.compress_type, other.header_offset, other.CRC = (
                first.compress_type,
                stream.tell(),
                first.CRC,
            )
            other.file_size, other.compress_size = first.file_size, first.compress_size
            stream.write(other.FileHeader() + data)
            archive.filelist.append(other)
            archive.NameToInfo[other.filename] = other
        archive.start_dir = stream.tell()
        archive.writestr("padding", bytes(max(0, MEGA - 10_000 - stream.tell())), zipfile.ZIP_STORED)
    return stream.getvalue()


def saved(format_name: str) -> dict[str, Files]:
    twice = ",".join(f'"k{k}":0' for k in range(90_000)) + ',"k89999":0'
    nested = f'{{"format": "{format_name}", "mass": ' + "[" * 300_000
    return {
        "an array of zeros": {"a.npz": zeros()},
        "many arrays of zeros": {"a.npz": many_zeros()},
        "one member named again": {"a.npz": overlapping(5_000, 400_000)},
        "a huge shape": {"a.npz": zipped({"mass.npy": npy((2**62, 2**62))})},
        "a field twice": {"a.json": f"{{{twice}}}".encode()},
        "nested": {"a.json": nested.encode()},
        "wide": {"a.json": f'{{"format": "{format_name}", "mass": [{",".join(["[]"] * 300_000)}]}}'.encode()},
        "long numbers": {"a.json": f'{{"format": "{format_name}", "mass": {"1" * 900_000}}}'.encode()},
        "huge numbers": {"a.json": f'{{"format": "{format_name}", "mass": 1e5000}}'.encode()},
    }  # fmt: skip


# CAD --------------------------------------------------------


def step(entities: str) -> bytes:
    return (
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
        f"FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n{entities}\nENDSEC;\nEND-ISO-10303-21;\n"
    ).encode()


def iges(parameter: str) -> bytes:
    lines = [
        f"{'':72}S      1",
        f"{'1H,,1H;,4HSLOT,1Ha,1Ha,1Ha,32,38,6,308,15,1Ha,1.,1,4HINCH,8,0.016,':<72}G      1",
        f"{'13H830214.110000,0.0001,21.,1Ha,1Ha,8,0;':<72}G      2",
        f"{'     110       1       0       0       0       0       0       000000000':<72}D      1",
        f"{'     110       0       0       1       0                               0':<72}D      2",
        f"{parameter:<64}       1P      1",
        f"{'S      1G      2D      2P      1':<72}T      1",
    ]
    return ("\n".join(lines) + "\n").encode()


def cad() -> dict[str, Files]:
    unclosed = "#1=MEASURE_REPRESENTATION_ITEM('" + "density" * 100_000 + "');\n" + "#2=" * 100_000
    return {
        "IGES: a huge number": {"a.igs": iges("110,1E5000,0.,0.,1.,0.,0.;")},
        "IGES: a huge number of doubles": {"a.igs": iges("110,0.,1.D+99999999999,0.,1.,0.,0.;")},
        "IGES: nothing but huge numbers": {"a.igs": iges("110," + "1E999999" + ";")},
        "STEP: a huge number": {"a.step": step("#1=CARTESIAN_POINT('',(1.E5000,0.,0.));")},
        "STEP: unclosed": {"a.step": step(unclosed)},
        "STEP: nested lists": {
            "a.step": step("#1=CARTESIAN_POINT('',(" + "(" * 400_000 + ")" * 400_000 + "));")
        },
        "STEP: itself": {
            "a.step": step("#1=PRODUCT('a','a','',(#1));\n#2=SHAPE_REPRESENTATION('',(#2),#2);")
        },
        "STEP: packed": {"a.step.gz": packed(step("#1=A();\n" * 5_000_000))},
    }


HOSTILE: dict[str, Callable[[], Mapping[str, Case]]] = {
    "COLLADA": collada,
    "glTF": gltf,
    "GLB": glb,
    "3MF": packages,
    "meshes": meshes,
    "VTK": vtk,
    "molecules": molecules,
    "robots": robots,
    "assemblies": assemblies,
    "ledgers": ledgers,
    "bodies": lambda: saved("polhode.RigidBody/1"),
    "motions": lambda: saved("polhode.Trajectory/1"),
    "CAD": cad,
}
