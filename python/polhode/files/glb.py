"""Checks of GLB files before trimesh reads them: that they are whole, and hold nothing that it passes over.

trimesh passes over what it does not know: compressed and sparse arrays become zeros, triangle fans nothing,
normalized integers plain ones.
"""

from __future__ import annotations

import json
import os
import struct
from typing import Any, BinaryIO, Final

__all__ = ["check_glb"]

_HEAD: Final = 20
_FLOAT: Final = 5126
_INDICES: Final = (5121, 5123, 5125)
_TRIANGLES, _STRIP = 4, 5
_HARMLESS: Final = (
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "KHR_xmp",
    "EXT_texture_",
    "MSFT_texture_",
)
"""Extensions by the beginnings of their names: what they change is not geometry."""


def check_glb(stream: BinaryIO) -> None:
    """Refuse a GLB file that is not whole, or whose triangles are stored in a way that is not read.

    Parameters
    ----------
    stream : binary stream
        The file, at its beginning.

    Raises
    ------
    ValueError
        Or whatever the damaged description of a scene can raise, from KeyError to TypeError.
    """
    size = stream.seek(0, os.SEEK_END)
    stream.seek(0)
    _, _, length, json_length, kind = struct.unpack("<5I", stream.read(_HEAD))
    if length != size:
        raise ValueError(f"it says that it is {length} bytes long, and is {size}")
    if kind != 0x4E4F534A or _HEAD + json_length > size:
        raise ValueError("it does not begin with a whole description of its scene")
    scene = json.loads(stream.read(json_length))
    for name in scene.get("extensionsRequired", []):
        if not name.startswith(_HARMLESS):
            raise ValueError(f"it needs the extension {name}, which is not read; export it without")
    for buffer in scene.get("buffers", []):
        if "uri" in buffer:
            raise ValueError("its numbers stand in another file or as text; write all into one binary")
    for accessor in scene.get("accessors", []):
        if not 0 <= accessor["count"] <= size:
            raise ValueError(f"an array of it says that it holds {accessor['count']} items in {size} bytes")
    for mesh in scene.get("meshes", []):
        for primitive in mesh["primitives"]:
            _check_primitive(primitive, scene)
    _check_nodes(scene.get("nodes", []))


def _check_primitive(primitive: dict[str, Any], scene: dict[str, Any]) -> None:
    mode = primitive.get("mode", _TRIANGLES)
    if mode not in (_TRIANGLES, _STRIP):
        raise ValueError(f"holds points, lines or fans (mode {mode}) where triangles are needed")
    if primitive.get("extensions", {}).keys() & {"KHR_draco_mesh_compression"}:
        raise ValueError("its triangles are compressed; export it without")
    corners = scene["accessors"][primitive["attributes"]["POSITION"]]
    if corners["componentType"] != _FLOAT or corners["type"] != "VEC3":
        raise ValueError("its coordinates are no 32-bit floats; export it without quantization")
    needed = [corners]
    if "indices" in primitive:
        needed.append(scene["accessors"][primitive["indices"]])
        if needed[-1]["componentType"] not in _INDICES or needed[-1]["type"] != "SCALAR":
            raise ValueError("the corners of its triangles are no whole numbers")
    if any("bufferView" not in accessor or "sparse" in accessor for accessor in needed):
        raise ValueError("its arrays are sparse or not in the file; export it with whole arrays")


def _check_nodes(nodes: list[dict[str, Any]]) -> None:
    """Refuse nodes that are not trees: one may have one parent, and none may be below itself."""
    parents: dict[int, int] = {}
    for number, node in enumerate(nodes):
        if "EXT_mesh_gpu_instancing" in node.get("extensions", {}):
            raise ValueError("its nodes place meshes by EXT_mesh_gpu_instancing, which is not read")
        for child in node.get("children", []):
            if child in parents:
                raise ValueError(f"node {child} has two parents")
            parents[child] = number
    reached: set[int] = set()
    waiting = [number for number in range(len(nodes)) if number not in parents]
    while waiting:
        number = waiting.pop()
        reached.add(number)
        waiting += nodes[number].get("children", [])
    if len(reached) < len(nodes):
        raise ValueError("a node stands below itself")
