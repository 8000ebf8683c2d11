"""glTF, as text (``.gltf``) and binary (``.glb``): triangles of the scene, placed by its nodes, in metres.

What is stored in a way that is not read is an error: compressed and sparse arrays, fans, lines, points.
"""

from __future__ import annotations

import base64
import binascii
import json
import struct
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, BinaryIO, Final
from urllib.parse import unquote

import numpy as np

from polhode.errors import FileFormatError
from polhode.io.budget import read_bytes, whole_of, with_way_out
from polhode.io.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Sized

    from numpy.typing import NDArray

    from polhode.io.budget import Budget
    from polhode.io.mesh import Mesh

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

__all__ = ["read_gltf"]

_HEAD: Final = 20
_FLOAT: Final = 5126
_INDICES: Final = {5121: "<u1", 5123: "<u2", 5125: "<u4"}
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


def read_gltf(
    stream: BinaryIO, file: Path, budget: Budget, *, is_binary: bool
) -> tuple[Mesh, tuple[tuple[str, int], ...]]:
    """Read every triangle that the scene of a file shows.

    Parameters
    ----------
    stream : binary stream
        The file, at its beginning.
    file : pathlib.Path
        Its name. Binary files that a text names are read from its own folder and those below it alone.
    budget : Budget
    is_binary : bool
        Whether it is a GLB.

    Returns
    -------
    mesh : Mesh
        In metres.
    groups : tuple of (str, int)
        The name of each node's mesh and the number of its triangles, in the order of the file.
    """
    kind = "GLB" if is_binary else "glTF"
    try:
        placed = _File(whole_of(stream, file), file, budget, is_binary=is_binary).scene()
    except FileFormatError:
        raise
    # A damaged description can raise any of these where a number, a list or an object is expected.
    except (
        ValueError, KeyError, TypeError, IndexError, AttributeError, RecursionError, OverflowError,
        struct.error,
    ) as error:  # fmt: skip
        reason = " ".join(str(error).split()) or type(error).__name__
        fault = with_way_out(reason[:200], "export it again")
        raise FileFormatError(file, f": not a readable {kind} file: {fault}") from None
    mesh = placed.mesh(kind)
    if not len(mesh.faces):
        raise FileFormatError(file, ": holds no triangles; export it with them")
    return mesh, placed.groups


class _File:
    """The description of a scene, and the arrays that it names."""

    def __init__(self, source: bytes, file: Path, budget: Budget, *, is_binary: bool) -> None:
        self._path, self._budget = file, budget
        self._beside: dict[str, bytes] = {}
        self._arrays: dict[int, NDArray[Any]] = {}
        text, binary = _chunks(source) if is_binary else (source, b"")
        # Each value of the description takes far more memory than its text.
        budget.spend("elements", text.count(b",") + text.count(b"[") + text.count(b"{"))
        self._scene: Any = json.loads(text.decode())
        self._size = len(source)
        self._buffers: list[bytes] = []
        for buffer in self._scene.get("buffers", []):
            self._buffers.append(self._buffer(buffer, binary, is_binary=is_binary))
            self._size += len(self._buffers[-1])

    def scene(self) -> Scene:
        scene = self._scene
        for name in scene.get("extensionsRequired", []):
            if not name.startswith(_HARMLESS):
                raise ValueError(f"it needs the extension {name}, which is not read; export it without")
        for accessor in scene.get("accessors", []):
            if not 0 <= accessor["count"] <= self._size:
                raise ValueError(
                    f"an array of it says that it holds {accessor['count']} items in {self._size} bytes"
                )
        for mesh in scene.get("meshes", []):
            for primitive in mesh["primitives"]:
                _check_primitive(primitive, scene)
        nodes = scene.get("nodes", [])
        below = _check_nodes(nodes)
        placed = Scene(self._budget)
        known: dict[int, list[tuple[Floats, Integers]]] = {}
        waiting = [(number, np.eye(4)) for number in reversed(self._roots(below))]
        while waiting:
            number, above = waiting.pop()
            self._budget.spend("placements")
            node = nodes[_index(number, nodes, "node")]
            matrix = above @ _transform(node)
            if "mesh" in node:
                mesh = scene["meshes"][at := _index(node["mesh"], scene["meshes"], "mesh")]
                if at not in known:
                    known[at] = [self._triangles(primitive) for primitive in mesh["primitives"]]
                name = str(node.get("name") or mesh.get("name") or "")
                for vertices, faces in known[at]:
                    placed.place(vertices, faces, matrix, name)
            waiting += [(child, matrix) for child in reversed(node.get("children", []))]
        return placed

    def _roots(self, below: set[int]) -> list[int]:
        """Return the nodes that the scene begins with: without a scene, those that are below none."""
        scenes = self._scene.get("scenes", [])
        if not scenes:
            return [number for number in range(len(self._scene.get("nodes", []))) if number not in below]
        shown = scenes[_index(self._scene.get("scene", 0), scenes, "scene")]
        roots: list[int] = shown.get("nodes", [])
        if len(set(roots)) < len(roots):
            raise ValueError("its scene names a node twice")
        return roots

    def _buffer(self, buffer: dict[str, Any], binary: bytes, *, is_binary: bool) -> bytes:
        size = int(buffer["byteLength"])
        if "uri" not in buffer:
            if self._buffers or not is_binary:
                raise ValueError("a buffer of it names no file; write all into one binary")
            address, data = "it", binary
        elif is_binary:
            raise ValueError("its numbers stand in another file or as text; write all into one binary")
        else:
            address = buffer["uri"]
            data = self._bytes_of(address)
        if not 0 <= size <= len(data):
            raise ValueError(f"{address[:60]!r} holds {len(data)} bytes, not {size}")
        return data[:size] if size < len(data) else data

    def _bytes_of(self, address: str) -> bytes:
        if address.startswith("data:"):
            kind, _, text = address.partition(",")
            if not kind.endswith(";base64"):
                raise ValueError("its numbers stand in it as something else than base64")
            try:
                return base64.b64decode(text, validate=True)
            except binascii.Error as error:
                raise ValueError(f"its numbers are no base64: {error}") from None
        path = PurePosixPath(unquote(address))
        if not path.parts:
            raise ValueError("a buffer of it names no file")
        if path.is_absolute() or ".." in path.parts or ":" in path.parts[0] or "\\" in address:
            raise ValueError(f"it names {address[:60]!r}, outside of its own folder; put it beside it")
        beside = self._path.parent / path
        if not beside.resolve().is_relative_to(self._path.parent.resolve()):
            raise ValueError(f"it names {address[:60]!r}, a link out of its own folder; put it beside it")
        if address not in self._beside:
            self._budget.spend("files")
            self._beside[address] = read_bytes(beside)
            self._budget.add_file(len(self._beside[address]))
        return self._beside[address]

    def _array(self, number: Any, columns: int, form: str) -> NDArray[Any]:
        """Read an array: rows of so many numbers, which may stand apart in their buffer."""
        at = _index(number, self._scene["accessors"], "accessor")
        if at not in self._arrays:
            accessor = self._scene["accessors"][at]
            views = self._scene["bufferViews"]
            view = views[_index(accessor["bufferView"], views, "bufferView")]
            data = self._buffers[_index(view["buffer"], self._buffers, "buffer")]
            start, end = view.get("byteOffset", 0), view.get("byteOffset", 0) + view["byteLength"]
            kind = np.dtype(form)
            row, count = columns * kind.itemsize, accessor["count"]
            stride = view.get("byteStride", row)
            first = start + accessor.get("byteOffset", 0)
            last = first + (count - 1) * stride + row
            if not (0 <= start <= first and last <= end <= len(data) and stride >= row) and count:
                raise ValueError(f"the array {at} reaches beyond its {len(data)} bytes")
            self._budget.spend("numbers", count * columns)
            where = first if count else 0
            rows: NDArray[Any] = np.ndarray((count, columns), kind, data, where, (stride, kind.itemsize))
            self._arrays[at] = np.array(rows, dtype=np.float64 if kind.kind == "f" else np.int64)
        return self._arrays[at].reshape(-1, columns)

    def _triangles(self, primitive: dict[str, Any]) -> tuple[Floats, Integers]:
        vertices: Floats = self._array(primitive["attributes"]["POSITION"], 3, "<f4")
        if "indices" in primitive:
            accessor = self._scene["accessors"][primitive["indices"]]
            corners = self._array(primitive["indices"], 1, _INDICES[accessor["componentType"]]).reshape(-1)
        else:
            self._budget.spend("numbers", len(vertices))
            corners = np.arange(len(vertices))
        if primitive.get("mode", _TRIANGLES) == _STRIP:
            faces = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=-1)
            faces[1::2] = faces[1::2, ::-1]  # every other triangle of a strip is wound the other way
            a, b, c = faces.T
            faces = faces[(a != b) & (b != c) & (c != a)]  # where two strips are joined
        elif len(corners) % 3:
            raise ValueError(f"{len(corners)} corners are no whole number of triangles")
        else:
            faces = corners.reshape(-1, 3)
        if faces.size and faces.max() >= len(vertices):
            row = int(np.flatnonzero((faces >= len(vertices)).any(axis=1))[0])
            raise ValueError(f"face {row} names a vertex that the file does not hold; is it cut short?")
        return vertices, faces


def _chunks(source: bytes) -> tuple[bytes, bytes]:
    """Return the description of a GLB file and its binary chunk."""
    _, _, length, json_length, kind = struct.unpack("<5I", source[:_HEAD])
    if length != len(source):
        raise ValueError(f"it says that it is {length} bytes long, and is {len(source)}")
    end = _HEAD + json_length
    if kind != 0x4E4F534A or end > len(source):
        raise ValueError("it does not begin with a whole description of its scene")
    if end == len(source):
        return source[_HEAD:end], b""
    size, kind = struct.unpack("<2I", source[end : end + 8])
    if kind != 0x004E4942 or end + 8 + size > len(source):
        raise ValueError("its description is not followed by its whole numbers")
    return source[_HEAD:end], source[end + 8 : end + 8 + size]


def _check_primitive(primitive: dict[str, Any], scene: dict[str, Any]) -> None:
    mode = primitive.get("mode", _TRIANGLES)
    if mode not in (_TRIANGLES, _STRIP):
        raise ValueError(f"holds points, lines or fans (mode {mode}) where triangles are needed")
    if primitive.get("extensions", {}).keys() & {"KHR_draco_mesh_compression"}:
        raise ValueError("its triangles are compressed; export it without")
    accessors = scene["accessors"]
    corners = accessors[_index(primitive["attributes"]["POSITION"], accessors, "accessor")]
    if corners["componentType"] != _FLOAT or corners["type"] != "VEC3":
        raise ValueError("its coordinates are no 32-bit floats; export it without quantization")
    needed = [corners]
    if "indices" in primitive:
        needed.append(accessors[_index(primitive["indices"], accessors, "accessor")])
        if needed[-1]["componentType"] not in _INDICES or needed[-1]["type"] != "SCALAR":
            raise ValueError("the corners of its triangles are no whole numbers")
    if any("bufferView" not in accessor or "sparse" in accessor for accessor in needed):
        raise ValueError("its arrays are sparse or not in the file; export it with whole arrays")


def _check_nodes(nodes: list[dict[str, Any]]) -> set[int]:
    """Return the nodes that are below others; each may have one parent, and none may be below itself."""
    parents: dict[int, int] = {}
    for number, node in enumerate(nodes):
        if "EXT_mesh_gpu_instancing" in node.get("extensions", {}):
            raise ValueError("its nodes place meshes by EXT_mesh_gpu_instancing, which is not read")
        for child in node.get("children", []):
            if child in parents:
                raise ValueError(f"node {child} has two parents")
            parents[_index(child, nodes, "node")] = number
    reached: set[int] = set()
    waiting = [number for number in range(len(nodes)) if number not in parents]
    while waiting:
        number = waiting.pop()
        reached.add(number)
        waiting += nodes[number].get("children", [])
    if len(reached) < len(nodes):
        raise ValueError("a node stands below itself")
    return set(parents)


def _index(number: Any, of: Sized, what: str) -> int:
    """Return a number that counts something from 0; Python would count a negative one from the end."""
    if isinstance(number, bool) or not isinstance(number, int) or not 0 <= number < len(of):
        raise ValueError(f"it names the {what} {str(number)[:40]}, which it does not hold")
    return number


def _transform(node: dict[str, Any]) -> Floats:
    whole = np.eye(4)
    if "matrix" in node:
        whole = np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
        if not np.allclose(whole[3], [0.0, 0.0, 0.0, 1.0], rtol=0.0, atol=1e-9):
            raise ValueError("the matrix of a node does not end with the row 0 0 0 1")
    if "translation" in node:
        whole = whole @ _translation(np.array(node["translation"], dtype=np.float64).reshape(3))
    if "rotation" in node:
        whole = whole @ _rotation(np.array(node["rotation"], dtype=np.float64).reshape(4))
    if "scale" in node:
        whole = whole @ np.diag([*np.array(node["scale"], dtype=np.float64).reshape(3), 1.0])
    if not np.isfinite(whole).all():
        raise ValueError("the transform of a node is not finite")
    return whole


def _translation(by: Floats) -> Floats:
    whole = np.eye(4)
    whole[:3, 3] = by
    return whole


def _rotation(quaternion: Floats) -> Floats:
    whole = np.eye(4)
    length = np.linalg.norm(quaternion)
    if not length > 0.0:
        raise ValueError("the rotation of a node is 0 0 0 0")
    x, y, z, w = quaternion / length
    whole[:3, :3] = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return whole
