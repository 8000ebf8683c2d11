"""COLLADA (DAE): triangles of the scene, placed by its nodes, in the unit that the file states.

``<unit meter=>`` is the file's own unit; without it COLLADA means metres. ``<up_axis>`` says how the file
was drawn and turns nothing here: the axes are those of the stored numbers, about which inertia is told.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from polhode.errors import FileFormatError
from polhode.io.budget import with_way_out
from polhode.io.scene import Scene
from polhode.io.xml_source import Element, parse_xml

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode.io.budget import Budget
    from polhode.io.mesh import Mesh

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

__all__ = ["read_collada"]

_DEEPEST: Final = 100
_DIGITS: Final = re.compile(r"\s*[0-9][0-9\s]*", re.ASCII)
_BLOCK: Final = 1 << 20
"""Characters of which the numbers are read at once: as words they take far more memory than as numbers."""
_FACES: Final = ("triangles", "polylist", "polygons", "trifans", "tristrips")


class _FaultError(ValueError):
    """What is wrong, without the name of the file."""


def read_collada(
    source: bytes, file: Path, budget: Budget
) -> tuple[Mesh, tuple[tuple[str, int], ...], float | None, str]:
    """Read the triangles of a COLLADA file and its unit.

    Parameters
    ----------
    source : bytes
    file : pathlib.Path
        Its name.
    budget : Budget

    Returns
    -------
    mesh : Mesh
        In the unit of the file.
    groups : tuple of (str, int)
        The name of each node that shows a geometry and the number of its triangles, in the order of the file.
    metres : float or None
        In one of its units; None where the file does not say, which in COLLADA means metres.
    up : str
        What it calls the axis that points up: ``"X"``, ``"Y"`` or ``"Z"``.
    """
    root = parse_xml(source, str(file), budget=budget)
    try:
        if _tag(root) != "COLLADA":
            raise _FaultError(f"its root is <{root.tag}>, not <COLLADA>; rename the file")
        metres = _metres(root)
        placed = _Document(root, budget).scene()
        return placed.mesh("COLLADA"), placed.groups, metres, _up(root)
    except _FaultError as fault:
        raise FileFormatError(file, f": {with_way_out(fault, 'export it again')}") from None


def _tag(element: Element) -> str:
    return element.tag.rpartition(":")[2]


def _all(element: Element, *tags: str) -> Iterator[Element]:
    return (child for child in element.children if _tag(child) in tags)


def _one(element: Element, tag: str) -> Element | None:
    return next(_all(element, tag), None)


def _up(root: Element) -> str:
    asset = _one(root, "asset")
    up = _one(asset, "up_axis") if asset is not None else None
    return up.text.strip()[:1].upper() if up is not None else "Y"


def _metres(root: Element) -> float | None:
    asset = _one(root, "asset")
    unit = _one(asset, "unit") if asset is not None else None
    if unit is None or "meter" not in unit.attributes:
        return None
    text = unit.attributes["meter"].strip()
    try:
        metres = float(text.replace(",", ".")) if text.count(",") == 1 and "." not in text else float(text)
    except ValueError:
        metres = math.nan
    if not (math.isfinite(metres) and 1e-12 <= metres <= 1e12):
        raise _FaultError(
            f"{unit.where}: <unit meter={text[:40]!r}> is no length; write the metres in one unit"
        )
    return metres


class _Node(NamedTuple):
    """A node: where it stands in the one around it, and what of it is placed."""

    matrix: Floats
    name: str
    placed: list[Element]


class _Document:
    """The nodes of a document, and the geometries that they place."""

    def __init__(self, root: Element, budget: Budget) -> None:
        self._ids: dict[str, Element] = {}
        waiting = [root]
        while waiting:
            element = waiting.pop()
            name = element.attributes.get("id")
            if name and (_tag(element) != "source" or name not in self._ids):
                self._ids.setdefault(name, element)
            waiting += element.children
        self._root = root
        self._budget = budget
        self._placed = Scene(budget)
        self._nodes: dict[int, _Node] = {}
        self._known: dict[int, tuple[Floats, Integers]] = {}
        self._numbers: dict[int, Floats] = {}
        self._points_of: dict[int, Floats] = {}

    def scene(self) -> Scene:
        scene = _one(self._root, "scene")
        shown = _one(scene, "instance_visual_scene") if scene is not None else None
        if shown is None:
            raise _FaultError("shows no scene; export it with one")
        visual = self._resolve(shown)
        for node in _all(visual, "node"):
            self._place(node, np.eye(4), 0)
        if not self._placed.groups:
            raise _FaultError("its scene shows no triangles")
        return self._placed

    def _resolve(self, element: Element, attribute: str = "url") -> Element:
        address = element.attributes.get(attribute, "")
        found = self._ids.get(address.removeprefix("#"))
        if not address.startswith("#"):
            raise _FaultError(f"{element.where}: {address[:60]!r} names another file; write all into one")
        if found is None:
            raise _FaultError(f"{element.where}: {address[:60]!r} names nothing in the file; check it")
        return found

    def _place(self, node: Element, above: Floats, depth: int) -> None:
        if depth > _DEEPEST:
            raise _FaultError(f"{node.where}: nodes are nested more than {_DEEPEST} deep; check the file")
        self._budget.spend("placements")
        if id(node) not in self._nodes:
            self._nodes[id(node)] = _node(node)
        own = self._nodes[id(node)]
        matrix = above @ own.matrix
        for child in own.placed:
            tag = _tag(child)
            if tag == "instance_geometry":
                geometry = self._resolve(child)
                if id(geometry) not in self._known:
                    self._known[id(geometry)] = self._geometry(geometry)
                name = own.name or geometry.attributes.get("name", "")
                self._placed.place(*self._known[id(geometry)], matrix, name)
            elif tag == "instance_node":
                self._place(self._resolve(child), matrix, depth + 1)
            else:
                self._place(child, matrix, depth + 1)

    def _geometry(self, geometry: Element) -> tuple[Floats, Integers]:
        mesh = _one(geometry, "mesh")
        if mesh is None:
            raise _FaultError(f"{geometry.where}: a geometry without <mesh> is not read; export triangles")
        vertices: list[Floats] = []
        faces: list[Integers] = []
        starts: dict[int, int] = {}  # of the points that groups share
        count = 0
        for group in _all(mesh, *_FACES):
            if _tag(group) not in ("triangles", "polylist", "polygons"):
                raise _FaultError(f"{group.where}: <{_tag(group)}> is not read; export triangles")
            source, points, corners = self._group(group)
            if corners.size and (corners.min() < 0 or corners.max() >= len(points)):
                raise _FaultError(f"{group.where}: a face names a vertex that the file does not hold")
            if id(source) not in starts:
                self._budget.spend("numbers", points.size)
                starts[id(source)] = count
                vertices.append(points)
                count += len(points)
            faces.append(corners + starts[id(source)])
        if not faces:
            return np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)
        return np.concatenate(vertices), np.concatenate(faces)

    def _group(self, group: Element) -> tuple[Element, Floats, Integers]:
        inputs = list(_all(group, "input"))
        at = [i for i in inputs if i.attributes.get("semantic") == "VERTEX"]
        if len(at) != 1:
            raise _FaultError(f"{group.where}: has no input VERTEX; check the file")
        offsets = [_whole(i, i.attributes.get("offset", "0")) for i in inputs]
        stride, offset = max(offsets) + 1, _whole(at[0], at[0].attributes.get("offset", "0"))
        source = self._resolve(at[0], "source")
        if id(source) not in self._points_of:
            self._points_of[id(source)] = self._points(source)
        points = self._points_of[id(source)]
        if _tag(group) == "polygons":
            if _one(group, "ph") is not None:
                raise _FaultError(f"{group.where}: polygons with holes are not read; export triangles")
            texts = [p.text for p in _all(group, "p")]
            rows = [_integers(text, group)[offset::stride] for text in texts]
            return (
                source,
                points,
                _fans(np.concatenate([[], *rows]).astype(np.int64), [len(row) for row in rows], group),
            )
        stored = _one(group, "p")
        flat = _integers(stored.text, group) if stored is not None else np.empty(0, dtype=np.int64)
        if len(flat) % stride:
            raise _FaultError(
                f"{group.where}: <p> does not hold {stride} numbers for each corner; is it cut short?"
            )
        corners = flat.reshape(-1, stride)[:, offset]
        count = _whole(group, group.attributes.get("count", "0"))
        if _tag(group) == "triangles":
            if len(corners) != 3 * count:
                raise _FaultError(f"{group.where}: promises {count} triangles, <p> holds {len(corners) // 3}")
            return source, points, corners.reshape(-1, 3)
        counts = _one(group, "vcount")
        sizes = _integers(counts.text, group) if counts is not None else np.empty(0, dtype=np.int64)
        largest = int(sizes.max(initial=0))
        if len(sizes) != count or largest > len(corners) or sizes.sum() != len(corners):
            raise _FaultError(f"{group.where}: its counts and <p> do not fit together; is it cut short?")
        return source, points, _fans(corners, sizes.tolist(), group)

    def _points(self, vertices: Element) -> Floats:
        inputs = [i for i in _all(vertices, "input") if i.attributes.get("semantic") == "POSITION"]
        if len(inputs) != 1:
            raise _FaultError(f"{vertices.where}: has no input POSITION; check the file")
        source = self._resolve(inputs[0], "source")
        array, common = _one(source, "float_array"), _one(source, "technique_common")
        accessor = _one(common, "accessor") if common is not None else None
        if array is None or accessor is None:
            raise _FaultError(f"{source.where}: has no numbers or does not say how they are laid out")
        if id(array) not in self._numbers:
            self._numbers[id(array)] = _floats(array.text, array)
        numbers = self._numbers[id(array)]
        promised = _whole(array, array.attributes.get("count", str(len(numbers))))
        stride = _whole(accessor, accessor.attributes.get("stride", "1"))
        start = _whole(accessor, accessor.attributes.get("offset", "0"))
        count = _whole(accessor, accessor.attributes.get("count", "0"))
        names = [p.attributes.get("name", "") for p in _all(accessor, "param")]
        if (
            [name for name in names if name][:3] != ["X", "Y", "Z"]
            or names[:3] != ["X", "Y", "Z"]
            or stride < 3
        ):
            raise _FaultError(
                f"{accessor.where}: expected coordinates X, Y, Z, got {names[:6]}; export it again"
            )
        if len(numbers) != promised or start + stride * count > len(numbers):
            raise _FaultError(
                f"{array.where}: holds {len(numbers)} numbers, not as many as it says; is it cut short?"
            )
        return numbers[start : start + stride * count].reshape(-1, stride)[:, :3]


def _node(node: Element) -> _Node:
    placed = []
    for child in node.children:
        tag = _tag(child)
        if tag == "instance_controller":
            raise _FaultError(
                f"{child.where}: a skin is bent by bones, which is not read; export the plain mesh"
            )
        if tag in ("instance_geometry", "instance_node", "node"):
            placed.append(child)
    return _Node(_transform(node), node.attributes.get("name") or node.attributes.get("id", ""), placed)


def _transform(node: Element) -> Floats:
    """Multiply the transforms of a node in the order in which they stand."""
    whole = np.eye(4)
    for child in node.children:
        tag = _tag(child)
        if tag in ("lookat", "skew"):
            raise _FaultError(f"{child.where}: <{tag}> is not read; export it with <matrix>")
        size = {"matrix": 16, "translate": 3, "rotate": 4, "scale": 3}.get(tag)
        if size is None:
            continue
        numbers = _floats(child.text, child)
        if len(numbers) != size or not np.isfinite(numbers).all():
            raise _FaultError(f"{child.where}: <{tag}> needs {size} finite numbers")
        step = np.eye(4)
        if tag == "matrix":
            step = numbers.reshape(4, 4)
            if not np.array_equal(step[3], [0.0, 0.0, 0.0, 1.0]):
                raise _FaultError(f"{child.where}: <matrix> does not end with the row 0 0 0 1")
        elif tag == "translate":
            step[:3, 3] = numbers
        elif tag == "scale":
            step[:3, :3] = np.diag(numbers)
        else:
            step[:3, :3] = _rotation(numbers, child)
        whole = whole @ step
    return whole


def _rotation(numbers: Floats, element: Element) -> Floats:
    length = float(np.linalg.norm(numbers[:3]))
    angle = math.radians(numbers[3])
    if length == 0.0:
        if angle == 0.0:
            return np.eye(3)
        raise _FaultError(f"{element.where}: <rotate> has an axis of no length")
    x, y, z = numbers[:3] / length
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: Floats = np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross
    return turned


def _fans(corners: Integers, sizes: list[int], group: Element) -> Integers:
    """Divide polygons into triangles at their first corner: of flat ones, whose volume is then theirs."""
    if sizes and min(sizes) < 3:
        raise _FaultError(f"{group.where}: a polygon has fewer than three corners")
    lengths = np.array(sizes, dtype=np.int64)
    starts = np.cumsum(lengths) - lengths
    of = np.repeat(np.arange(len(lengths)), lengths - 2)
    place = np.arange(len(of)) - np.repeat(np.cumsum(lengths - 2) - (lengths - 2), lengths - 2)
    first = starts[of]
    return np.stack([corners[first], corners[first + place + 1], corners[first + place + 2]], axis=-1)


def _floats(text: str, element: Element) -> Floats:
    found, start = [np.empty(0)], 0
    try:
        while start < len(text):
            end = start + _BLOCK
            while end < len(text) and not text[end].isspace():
                end += 1
            found.append(np.array(text[start:end].split(), dtype=np.float64))
            start = end
    except ValueError as error:
        raise _FaultError(f"{element.where}: {str(error)[:100]}") from None
    return np.concatenate(found)


def _integers(text: str, element: Element) -> Integers:
    if _DIGITS.fullmatch(text):  # which is read sooner as a whole, numbers out of range as the largest
        found = np.fromstring(text, dtype=np.int64, sep=" ")
        if found.max() < np.iinfo(np.int64).max:
            return found
    try:
        return np.array(text.split(), dtype=np.int64)
    except (ValueError, OverflowError) as error:
        raise _FaultError(f"{element.where}: {error}") from None


def _whole(element: Element, text: str) -> int:
    if not (text.isdecimal() and len(text) < 12):
        raise _FaultError(f"{element.where}: {text[:40]!r} is no whole number")
    return int(text)
