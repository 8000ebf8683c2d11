"""3MF: the objects that a build places, in the unit that the file states.

Slicers keep in a 3MF file what is no matter: support blockers and enforcers, modifiers, negative volumes.
Their own files in the package say which triangles or objects these are. What is no matter is left out, and a
negative volume is subtracted from the object that it belongs to.
"""

from __future__ import annotations

import errno
import math
import struct
import zipfile
import zlib
from array import array
from collections import Counter
from typing import TYPE_CHECKING, BinaryIO, Final, NamedTuple
from xml.parsers import expat

import numpy as np

from polhode.errors import FileFormatError, MeshError
from polhode.io.scene import Scene
from polhode.io.subtraction import subtract

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode.io.budget import Budget
    from polhode.io.mesh import Mesh

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]
    Start = Callable[[str, dict[str, str]], None]
    _Placement = tuple[str, str, str | None]
    """The model and the object that is placed, and its transform as it is written."""

__all__ = ["Package", "read_three_mf"]

_UNITS: Final = {
    "micron": "um",
    "millimeter": "mm",
    "centimeter": "cm",
    "inch": "in",
    "foot": "ft",
    "meter": "m",
}
_DEEPEST: Final = 50
_RELATIONS: Final = "_rels/.rels"
_MODEL: Final = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
_OF_PRUSA: Final = "Metadata/Slic3r_PE_model.config"
_OF_BAMBU: Final = "Metadata/model_settings.config"
_MATTER, _NEGATIVE = "matter", "negative volume"
_ROLES: Final = {
    "modelpart": _MATTER,
    "normal_part": _MATTER,
    "negativevolume": _NEGATIVE,
    "negative_part": _NEGATIVE,
    "parametermodifier": "modifier",
    "modifier_part": "modifier",
    "supportblocker": "support blocker",
    "support_blocker": "support blocker",
    "supportenforcer": "support enforcer",
    "support_enforcer": "support enforcer",
}
"""What slicers call the volumes of an object: `volume_type` of PrusaSlicer, `subtype` of Bambu and Orca."""


class _FaultError(ValueError):
    """What is wrong, without the name of the file."""


class Package(NamedTuple):
    """What a 3MF file holds.

    Attributes
    ----------
    mesh : Mesh
        In the unit of the file.
    unit : str
        Of :data:`polhode.units.METRES`.
    states_unit : bool
        Whether the file says it; else it is the format's, millimetres.
    groups : tuple of (str, int)
        The name of each object and the number of its triangles, in the order of the file.
    materials : tuple of (str, int)
        The same of base materials; empty where the file has none.
    notes : tuple of str
        What of the file is no matter.
    """

    mesh: Mesh
    unit: str
    states_unit: bool
    groups: tuple[tuple[str, int], ...]
    materials: tuple[tuple[str, int], ...]
    notes: tuple[str, ...]


def read_three_mf(stream: BinaryIO, file: Path, budget: Budget) -> Package:
    """Read the triangles of a 3MF file and its unit.

    Parameters
    ----------
    stream : binary stream
    file : pathlib.Path
        Its name.
    budget : Budget

    Returns
    -------
    Package
    """
    try:
        with zipfile.ZipFile(stream) as package:
            return _Build(package, budget).whole()
    except FileFormatError:
        raise
    except (
        _FaultError,
        zipfile.BadZipFile,
        expat.ExpatError,
        NotImplementedError,  # of zipfile, for a compression that it does not know
        RuntimeError,  # of zipfile, for a member under a password
        EOFError,
    ) as error:
        raise FileFormatError(file, f": not a readable 3MF file: {error}; export it again") from None
    except MeshError as error:
        raise FileFormatError(file, f": {error}") from None
    except (KeyError, ValueError, OverflowError) as error:
        raise FileFormatError(file, f": not a whole 3MF file: {error}; export it again") from None
    except (zlib.error, struct.error) as error:
        raise FileFormatError(file, f": not a whole 3MF file: {error}; export it again") from None
    except OSError as error:
        if error.errno != errno.EINVAL:
            raise
        raise FileFormatError(
            file, ": not a whole 3MF file: a member is said to begin outside of it; export it again"
        ) from None


class _Object:
    """Triangles of its own, or others that it places."""

    def __init__(self, name: str, kind: str, material: tuple[str | None, str | None] = (None, None)) -> None:
        self.name, self.kind = name, kind
        self.numbers, self.corners = array("d"), array("q")
        self.material = material
        """Its group of properties and its number there, of triangles that do not say another."""
        self.materials = array("q")
        self.components: list[_Placement] = []

    def triangles(self, name: str) -> tuple[Floats, Integers, Integers]:
        vertices = np.array(self.numbers).reshape(-1, 3)
        corners = np.array(self.corners, dtype=np.int64).reshape(-1, 3)
        if len(corners) and (corners.min() < 0 or corners.max() >= len(vertices)):
            raise _FaultError(f"a triangle of object {name[:40]!r} names a vertex that it does not hold")
        return vertices, corners, np.array(self.materials, dtype=np.int64)


class _Model:
    """One model of a package."""

    def __init__(self) -> None:
        self.unit, self.states_unit = "millimeter", False
        self.objects: dict[str, _Object] = {}
        self.items: list[_Placement] = []
        self.materials = [""]
        """The names of base materials; the first is that of what has none."""
        self.places: dict[tuple[str | None, str | None], int] = {}
        """Where the name of a base material stands, by its group and number there, as they are written."""

    def runs(self, materials: NDArray[np.int64]) -> tuple[tuple[str, int], ...]:
        """Return the materials of triangles that follow each other, and how many do."""
        starts = np.flatnonzero(np.diff(materials, prepend=-1))
        counts = np.diff(starts, append=len(materials))
        names = (self.materials[k] for k in materials[starts].tolist())
        return tuple(zip(names, counts.tolist(), strict=True))


class _Volume:
    """What a slicer says of a part of an object: of a range of its triangles, or of one that it places."""

    def __init__(self, role: str, first: int = 0, last: int = 0) -> None:
        self.role, self.first, self.last, self.name = role, first, last, ""


class _Build:
    def __init__(self, package: zipfile.ZipFile, budget: Budget) -> None:
        self._package, self._budget = package, budget
        self._models: dict[str, _Model] = {}
        self._meshes: dict[tuple[str, str], tuple[Floats, Integers, Integers]] = {}
        self._cut: dict[str, tuple[Floats, Integers]] = {}
        self._left_out: Counter[str] = Counter()
        self._notes: dict[str, None] = {}
        self._root = self._start()
        members = set(package.namelist())
        self._ranges = self._settings(_OF_PRUSA) if _OF_PRUSA in members else {}
        self._parts = self._settings(_OF_BAMBU) if _OF_BAMBU in members else {}

    def whole(self) -> Package:
        root, scene = self._model(self._root), Scene(self._budget)
        for path, name, place in root.items:
            self._place(path or self._root, name, _transform(place), scene, 0)
        if not scene.groups:
            raise _FaultError("its build places no triangles")
        notes = [
            f"{count} {kind}{'s' if count > 1 else ''} of the file "
            f"{'are' if count > 1 else 'is'} no matter and {'count' if count > 1 else 'counts'} nothing"
            for kind, count in self._left_out.items()
        ]
        unit = _UNITS[root.unit]
        return Package(
            scene.mesh("3MF"),
            unit,
            root.states_unit,
            scene.groups,
            scene.materials,
            (*notes, *self._notes),
        )

    def _start(self) -> str:
        found: list[str] = []

        def start(tag: str, attributes: dict[str, str]) -> None:
            if _local(tag) == "Relationship" and attributes.get("Type") == _MODEL:
                found.append(attributes.get("Target", ""))

        self._parse(_RELATIONS, start)
        if not found:
            raise _FaultError("it names no model")
        return found[0]

    def _parse(self, path: str, start: Start) -> None:
        info = self._package.getinfo(path.lstrip("/"))
        self._budget.spend("unpacked bytes", info.file_size)
        parser = expat.ParserCreate()

        def refuse(*_: object) -> None:
            raise _FaultError(f"{path} declares a document type or entities, which are not read")

        def count(tag: str, attributes: dict[str, str]) -> None:
            self._budget.spend("tags")
            start(tag, attributes)

        parser.StartDoctypeDeclHandler = refuse
        parser.EntityDeclHandler = refuse
        parser.StartElementHandler = count
        with self._package.open(info) as stream:
            # A member that holds more than it says is cut there, and is then no whole XML.
            rest = info.file_size
            while chunk := stream.read(min(rest, 1 << 20)):
                rest -= len(chunk)
                parser.Parse(chunk, False)
            parser.Parse(b"", True)

    def _model(self, path: str) -> _Model:
        if path in self._models:
            return self._models[path]
        self._budget.spend("files")
        model = self._models[path] = _Model()
        current = [_Object("", "model")]
        group = [("", 0)]

        def start(tag: str, attributes: dict[str, str]) -> None:
            kind = _local(tag)
            if kind == "vertex":
                current[0].numbers.extend(
                    (float(attributes["x"]), float(attributes["y"]), float(attributes["z"]))
                )
            elif kind == "triangle":
                corners = (int(attributes["v1"]), int(attributes["v2"]), int(attributes["v3"]))
                of = current[0]
                of.corners.extend(corners)
                own, number = attributes.get("pid", of.material[0]), attributes.get("p1", of.material[1])
                of.materials.append(model.places.get((own, number), 0))
            elif kind == "object":
                name = attributes["id"]
                if name in model.objects:
                    raise _FaultError(f"two objects of {path} have the id {name[:40]!r}")
                material = attributes.get("pid"), attributes.get("pindex")
                current[0] = _Object(attributes.get("name", ""), attributes.get("type", "model"), material)
                model.objects[name] = current[0]
            elif kind == "basematerials":
                group[0] = (attributes["id"], 0)
            elif kind == "base":
                name, count = group[0]
                model.places[name, str(count)] = len(model.materials)
                model.materials.append(" ".join(attributes.get("name", "").split())[:200])
                group[0] = (name, count + 1)
            elif kind in ("component", "item"):
                self._budget.spend("items")
                way = _attribute(attributes, "path")
                if kind == "item" and _attribute(attributes, "printable") == "0":
                    self._left_out["item that is not to be printed"] += 1
                    return
                placed = (way, attributes["objectid"], attributes.get("transform"))
                (current[0].components if kind == "component" else model.items).append(placed)
            elif kind == "model":
                model.unit, model.states_unit = attributes.get("unit", "millimeter"), "unit" in attributes
                if model.unit not in _UNITS:
                    raise _FaultError(f"its unit is {model.unit[:40]!r}, none of {', '.join(_UNITS)}")
                needed = attributes.get("requiredextensions", "").split()
                if set(needed) - {"p", "m", "s", "t", "slic"}:
                    raise _FaultError(f"it needs the extensions {needed}, which are not read")

        self._parse(path, start)
        return model

    def _settings(self, path: str) -> dict[str, dict[str, _Volume]]:
        """Read what a slicer says of the volumes of each object, by their ids or in their order."""
        found: dict[str, dict[str, _Volume]] = {}
        volumes: dict[str, _Volume] = {}
        volume = _Volume(_MATTER)

        def start(tag: str, attributes: dict[str, str]) -> None:
            nonlocal volumes, volume
            key, value = attributes.get("key"), attributes.get("value", "")
            if tag == "object":
                volumes, volume = found.setdefault(attributes["id"], {}), _Volume(_MATTER)
            elif tag == "volume":
                volume = _Volume(_MATTER, int(attributes["firstid"]), int(attributes["lastid"]))
                volumes[str(len(volumes))] = volume
            elif tag == "part":
                volume = volumes[attributes["id"]] = _Volume(_role(attributes.get("subtype", "normal_part")))
            elif tag == "metadata" and key == "name":
                volume.name = value
            elif tag == "metadata" and key == "volume_type":
                volume.role = _role(value)
            elif tag == "metadata" and key == "modifier" and value == "1":  # before there were types
                volume.role = "modifier"

        self._parse(path, start)
        return found

    def _place(self, path: str, name: str, place: Floats, scene: Scene, depth: int, called: str = "") -> None:
        self._budget.spend("placements")
        if depth > _DEEPEST:
            raise _FaultError("its objects place one another without end")
        model = self._model(path)
        if model.unit != self._model(self._root).unit:
            raise _FaultError("its models have different units")
        if name not in model.objects:
            raise _FaultError(f"it places an object {name[:40]!r} that it does not hold")
        thing = model.objects[name]
        if thing.kind not in ("model", "solidsupport"):
            self._left_out[f"object of type {thing.kind[:40]}"] += 1
            return
        is_root = path == self._root
        volumes = self._ranges.get(name, {}) if is_root else {}
        parts = self._parts.get(name, {}) if is_root else {}
        if any(volume.role == _NEGATIVE for volume in (*volumes.values(), *parts.values())):
            if name not in self._cut:
                solid, negative = Scene(self._budget), Scene(self._budget)
                self._place_volumes(path, name, np.eye(4), solid, negative, depth, thing.name)
                cut, notes = solid.mesh("3MF"), list[str]()
                if solid.groups and negative.groups:
                    cut, notes = subtract(cut, negative.mesh("3MF"))
                self._notes |= dict.fromkeys(notes)
                self._cut[name] = cut.vertices, cut.faces
            scene.place(*self._cut[name], place, thing.name)
        else:
            self._place_volumes(path, name, place, scene, scene, depth, called)

    def _place_volumes(
        self, path: str, name: str, place: Floats, solid: Scene, negative: Scene, depth: int, called: str
    ) -> None:
        """Place what an object is made of: its matter, and what is subtracted from it."""
        thing = self._models[path].objects[name]
        is_root = path == self._root
        volumes = self._ranges.get(name, {}) if is_root else {}
        parts = self._parts.get(name, {}) if is_root else {}
        placed = {other for _, other, _ in thing.components}
        stray = next((part for part in parts if part not in placed and parts[part].role != _MATTER), None)
        if stray is not None:
            raise _FaultError(
                f"a part {stray[:40]!r} of its settings is none that object {name[:40]!r} places"
            )
        for way, other, moved in thing.components:
            part = parts.get(other, _Volume(_MATTER))
            if part.role in (_MATTER, _NEGATIVE):
                scene = solid if part.role == _MATTER else negative
                self._place(way or path, other, place @ _transform(moved), scene, depth + 1, part.name)
            else:
                self._left_out[part.role] += 1
        if (path, name) not in self._meshes:
            self._meshes[path, name] = thing.triangles(name)
        vertices, corners, materials = self._meshes[path, name]
        runs = self._models[path].runs
        is_free = np.ones(len(corners), dtype=bool)
        for volume in volumes.values():
            if not 0 <= volume.first <= volume.last < len(corners):
                raise _FaultError(
                    f"its settings name triangles {volume.first} to {volume.last} of object {name[:40]!r}, "
                    f"which has {len(corners)}"
                )
            own = slice(volume.first, volume.last + 1)
            if not is_free[own].all():
                raise _FaultError(f"two volumes of object {name[:40]!r} share triangles by its settings")
            is_free[own] = False
            if volume.role in (_MATTER, _NEGATIVE):
                scene = solid if volume.role == _MATTER else negative
                scene.place(vertices, corners[own], place, volume.name, runs(materials[own]))
            else:
                self._left_out[volume.role] += 1
        if is_free.any():
            solid.place(vertices, corners[is_free], place, called or thing.name, runs(materials[is_free]))


def _local(tag: str) -> str:
    return tag.rpartition(":")[2]


def _attribute(attributes: dict[str, str], name: str) -> str:
    """Return an attribute by its name without the prefix of its extension; "" where there is none."""
    return next((text for known, text in attributes.items() if _local(known) == name), "")


def _role(word: str) -> str:
    """Return the role of what a slicer calls a volume."""
    role = _ROLES.get(word.lower())
    if role is None:
        raise _FaultError(f"its settings name a volume {word[:40]!r}, which is not known")
    return role


def _transform(text: str | None) -> Floats:
    whole = np.eye(4)
    if text is not None:
        numbers = [float(word) for word in text.split()]
        if len(numbers) != 12 or not all(math.isfinite(number) for number in numbers):
            raise _FaultError(f"a transform has {len(numbers)} numbers, not 12 finite ones")
        whole[:3, :] = np.array(numbers).reshape(4, 3).T
    return whole
