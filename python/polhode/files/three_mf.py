"""3MF: the objects that a build places, in the unit that the file states."""

from __future__ import annotations

import errno
import math
import struct
import zipfile
import zlib
from array import array
from typing import TYPE_CHECKING, BinaryIO, Final
from xml.parsers import expat

import numpy as np

from polhode.errors import FileFormatError
from polhode.files.mesh import Mesh, weld

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

__all__ = ["read_three_mf"]

_UNITS: Final = {
    "micron": "um",
    "millimeter": "mm",
    "centimeter": "cm",
    "inch": "in",
    "foot": "ft",
    "meter": "m",
}
_MOST_BYTES: Final = 1 << 30
"""Of a model when it is unpacked."""
_MOST_TRIANGLES: Final = 100_000_000
_MOST_PLACED: Final = 100_000
_RELATIONS: Final = "_rels/.rels"
_MODEL: Final = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"


class _FaultError(ValueError):
    """What is wrong, without the name of the file."""


def read_three_mf(stream: BinaryIO, file: Path) -> tuple[Mesh, str, bool]:
    """Read the triangles of a 3MF file and its unit.

    Parameters
    ----------
    stream : binary stream
    file : pathlib.Path
        Its name.

    Returns
    -------
    mesh : Mesh
        In the unit of the file.
    unit : str
        Of :data:`polhode.units.METRES`.
    is_stated : bool
        Whether the file says it; else it is the format's, millimetres.
    """
    try:
        with zipfile.ZipFile(stream) as package:
            build = _Build(package)
            return build.mesh(), build.unit, build.states_unit
    except (
        _FaultError,
        zipfile.BadZipFile,
        expat.ExpatError,
        NotImplementedError,  # of zipfile, for a compression that it does not know
        RuntimeError,  # of zipfile, for a member under a password
        EOFError,
    ) as error:
        raise FileFormatError(f"{file}: not a readable 3MF file: {error}; export it again") from None
    except (KeyError, ValueError, OverflowError) as error:
        raise FileFormatError(f"{file}: not a whole 3MF file: {error}; export it again") from None
    except (zlib.error, struct.error) as error:
        raise FileFormatError(f"{file}: not a whole 3MF file: {error}; export it again") from None
    except OSError as error:
        if error.errno != errno.EINVAL:
            raise
        raise FileFormatError(
            f"{file}: not a whole 3MF file: a member is said to begin outside of it; export it again"
        ) from None


class _Object:
    """Triangles of its own, or others that it places."""

    def __init__(self) -> None:
        self.numbers, self.corners = array("d"), array("q")
        self.components: list[tuple[str, str, Floats]] = []
        self.is_model = True


class _Model:
    """One model of a package."""

    def __init__(self) -> None:
        self.unit, self.states_unit = "millimeter", False
        self.objects: dict[str, _Object] = {}
        self.items: list[tuple[str, str, Floats]] = []


class _Build:
    def __init__(self, package: zipfile.ZipFile) -> None:
        self._package = package
        self._models: dict[str, _Model] = {}
        self._left, self._placed, self._triangles = _MOST_BYTES, 0, 0
        self._root = self._start()
        root = self._model(self._root)
        self.unit, self.states_unit = _UNITS[root.unit], root.states_unit

    def mesh(self) -> Mesh:
        found: list[tuple[Floats, Integers]] = []
        for path, name, place in self._model(self._root).items:
            self._place(path or self._root, name, place, found, 0)
        if not found:
            raise _FaultError("its build places no triangles")
        starts = np.cumsum([0, *(len(vertices) for vertices, _ in found)])
        faces = [corners + start for (_, corners), start in zip(found, starts, strict=False)]
        return weld(np.concatenate([vertices for vertices, _ in found]), np.concatenate(faces), "3MF")

    def _start(self) -> str:
        found: list[str] = []

        def start(tag: str, attributes: dict[str, str]) -> None:
            if tag.rpartition(":")[2] == "Relationship" and attributes.get("Type") == _MODEL:
                found.append(attributes.get("Target", ""))

        self._parse(_RELATIONS, start)
        if not found:
            raise _FaultError("it names no model")
        return found[0]

    def _parse(self, path: str, start: Callable[[str, dict[str, str]], None]) -> None:
        info = self._package.getinfo(path.lstrip("/"))
        self._left -= info.file_size
        if self._left < 0:
            raise _FaultError(f"its models are larger than {_MOST_BYTES} bytes unpacked")
        parser = expat.ParserCreate()

        def refuse(*_: object) -> None:
            raise _FaultError(f"{path} declares a document type or entities, which are not read")

        parser.StartDoctypeDeclHandler = refuse
        parser.EntityDeclHandler = refuse
        parser.StartElementHandler = start
        with self._package.open(info) as stream:
            rest = (
                info.file_size
            )  # a member that holds more than it says is cut there, and is then no whole XML
            while chunk := stream.read(min(rest, 1 << 20)):
                rest -= len(chunk)
                parser.Parse(chunk, False)
            parser.Parse(b"", True)

    def _model(self, path: str) -> _Model:
        if path in self._models:
            return self._models[path]
        model = self._models[path] = _Model()
        current = [_Object()]

        def start(tag: str, attributes: dict[str, str]) -> None:
            kind = tag.rpartition(":")[2]
            if kind == "vertex":
                current[0].numbers.extend(
                    (float(attributes["x"]), float(attributes["y"]), float(attributes["z"]))
                )
            elif kind == "triangle":
                corners = (int(attributes["v1"]), int(attributes["v2"]), int(attributes["v3"]))
                current[0].corners.extend(corners)
            elif kind == "object":
                current[0] = model.objects[attributes["id"]] = _Object()
                current[0].is_model = attributes.get("type", "model") in ("model", "solidsupport")
            elif kind in ("component", "item"):
                way = next(
                    (text for name, text in attributes.items() if name.rpartition(":")[2] == "path"), ""
                )
                placed = (way, attributes["objectid"], _transform(attributes.get("transform")))
                (current[0].components if kind == "component" else model.items).append(placed)
            elif kind == "model":
                model.unit, model.states_unit = attributes.get("unit", "millimeter"), "unit" in attributes
                if model.unit not in _UNITS:
                    raise _FaultError(f"its unit is {model.unit[:40]!r}, none of {', '.join(_UNITS)}")
                needed = attributes.get("requiredextensions", "").split()
                if set(needed) - {"p", "m", "s", "t", "slic"}:
                    raise _FaultError(f"it needs the extensions {needed}, which are not read")
            elif kind in ("beamlattice", "volumetricstack", "booleanshape", "displacementmesh"):
                raise _FaultError(f"it holds a <{kind}>, which is not read")

        self._parse(path, start)
        return model

    def _place(
        self, path: str, name: str, place: Floats, found: list[tuple[Floats, Integers]], depth: int
    ) -> None:
        self._placed += 1
        if depth > 50 or self._placed > _MOST_PLACED:
            raise _FaultError("its objects place one another without end")
        model = self._model(path)
        if model.unit != self._model(self._root).unit:
            raise _FaultError("its models have different units")
        if name not in model.objects:
            raise _FaultError(f"it places an object {name[:40]!r} that it does not hold")
        thing = model.objects[name]
        if not thing.is_model:
            return
        for way, other, moved in thing.components:
            self._place(way or path, other, place @ moved, found, depth + 1)
        corners = np.array(thing.corners, dtype=np.int64).reshape(-1, 3)
        if not len(corners):
            return
        vertices = np.array(thing.numbers).reshape(-1, 3)
        if corners.min() < 0 or corners.max() >= len(vertices):
            raise _FaultError(f"a triangle of object {name[:40]!r} names a vertex that it does not hold")
        self._triangles += len(corners)
        if self._triangles > _MOST_TRIANGLES:
            raise _FaultError(f"its build places more than {_MOST_TRIANGLES} triangles")
        if np.linalg.det(place[:3, :3]) < 0.0:
            corners = corners[:, ::-1]
        found.append((vertices @ place[:3, :3].T + place[:3, 3], corners))


def _transform(text: str | None) -> Floats:
    whole = np.eye(4)
    if text is not None:
        numbers = [float(word) for word in text.split()]
        if len(numbers) != 12 or not all(math.isfinite(number) for number in numbers):
            raise _FaultError(f"a transform has {len(numbers)} numbers, not 12 finite ones")
        whole[:3, :] = np.array(numbers).reshape(4, 3).T
    return whole
