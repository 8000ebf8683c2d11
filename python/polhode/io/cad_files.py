"""STEP and IGES files, read by OCCT: solids with names, places, densities, overlaps, and the body of them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode import _core
from polhode.errors import FileFormatError, MeshError, PolhodeError
from polhode.io.budget import Budget, read_bytes
from polhode.io.cad_geometry import moments_of_faces, occt
from polhode.io.components import Overlap, assign, describe_overlaps

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode._typing import SupportsSigma
    from polhode.io.cad_geometry import Moments

    Floats = NDArray[np.float64]
    Number = float | _core.Uncertain | SupportsSigma

__all__ = [
    "CadFile",
    "CadPart",
    "Pair",
    "SolidPart",
    "box_of",
    "densities_of",
    "faces_of",
    "near_pairs",
    "overlaps_told",
    "read_cad",
    "read_with_shapes",
    "solids_of",
    "volume_shared",
    "within",
]

_IGES: Final = (".igs", ".iges")
_WORST: Final = 1e-3
"""Bound of a volume, as a part of it, with which a solid is still taken."""
_WITH_EXPONENT: Final = re.compile(rb"[,;]\s*([+-]?[\d.]+[EeDd]\+?(\d+))\s*(?=[,;])")
"""A parameter of IGES that has a positive exponent."""
_LARGEST: Final = 308
_UNITS: Final = {
    "millimetre": "mm", "millimeter": "mm", "mm": "mm",
    "metre": "m", "meter": "m", "m": "m",
    "centimetre": "cm", "centimeter": "cm", "cm": "cm",
    "micrometre": "um", "micrometer": "um", "micron": "um", "um": "um",
    "nanometre": "nm", "nanometer": "nm", "nm": "nm",
    "kilometre": "km", "kilometer": "km", "km": "km",
    "inch": "in", "inches": "in", "in": "in",
    "foot": "ft", "feet": "ft", "ft": "ft",
}  # fmt: skip
"""As files spell them."""
_IGES_UNITS: Final = {
    1: "in", 2: "mm", 4: "ft", 5: "mile", 6: "m", 7: "km", 8: "mil", 9: "um", 10: "cm", 11: "microinch"
}  # fmt: skip
"""By the flag of the global section; 3 says that the name beside it tells."""


@dataclass(frozen=True)
class CadPart:
    """One solid at its place.

    Attributes
    ----------
    name : str
        As the file has it, the assemblies that it is in before it: ``"pump/rotor"``.
    moments : Moments
        Of the solid before it is placed, in millimetres.
    rotation, position : numpy.ndarray
        Its place, in millimetres.
    material : str
        ``""`` where the file names none.
    density : float or None
        In kg/m^3, where the file has one.
    faces : int
    """

    name: str
    moments: Moments
    rotation: Floats
    position: Floats
    material: str
    density: float | None
    faces: int


@dataclass(frozen=True)
class CadFile:
    """What a CAD file holds.

    Attributes
    ----------
    format : str
        ``"STEP"`` or ``"IGES"``.
    unit : str
        The file's own, of :data:`polhode.units.METRES`; ``"m"`` where that has no name for it.
    parts : tuple of CadPart
    left_out : int
        Faces that bound no solid.
    unread_densities : bool
        Whether materials have densities whose units could not be told.
    names_of_units : tuple of str
        As the file has them; mostly one.
    overlaps : tuple of str
        What is to be told of solids that share matter, so that it counts twice.
    """

    format: str
    unit: str
    parts: tuple[CadPart, ...]
    left_out: int
    unread_densities: bool = False
    names_of_units: tuple[str, ...] = ()
    overlaps: tuple[str, ...] = ()


def read_cad(path: Path) -> CadFile:
    """Read the solids of a STEP or IGES file; what they share is not looked for.

    Parameters
    ----------
    path : pathlib.Path

    Raises
    ------
    FileFormatError
        If the file is not what its name says, is damaged, or holds no solid.
    MeshError
        If a solid is open or inside out.
    """
    return read_with_shapes(path)[0]


def read_with_shapes(path: Path, limit_time: Callable[[bool], object] = bool) -> tuple[CadFile, list[Any]]:
    """Read the solids of a file, each with its shape of OCCT at its place; see :func:`read_cad`.

    `limit_time` is called with True before OCCT reads the file, and with False when it has.
    """
    _check_numbers(path)
    occt("STEPCAFControl")  # imported before the time runs
    occt("IGESCAFControl")
    limit_time(True)
    kind, names, document = _document(path)
    limit_time(False)
    is_iges = kind == "IGES"
    units = {_UNITS.get(name, "m") for name in names}
    unit = units.pop() if len(units) == 1 else "m"
    walk = _AssemblyWalk(path, kind, document)
    parts = tuple(walk.parts())
    if not parts:
        way_out = "export STEP" if is_iges else "export solids, not surfaces or meshes"
        raise FileFormatError(path, f": holds no solid ({walk.left_out} faces bound none); {way_out}")
    raw = sorted({part.density for part in parts if part.density is not None})
    stated = densities_of(read_bytes(path).decode("latin-1")) if raw else []
    is_unread = stated is None or len(stated) != len(raw)
    known: dict[float | None, float | None] = dict(
        zip(raw, [None] * len(raw) if is_unread else stated or [], strict=True)
    )
    parts = tuple(replace(part, density=known.get(part.density)) for part in parts)
    return CadFile(kind, unit, parts, walk.left_out, is_unread, names), walk.placed


def _check_numbers(path: Path) -> None:
    """Refuse an IGES file with a number beyond float64, at which OCCT does not end."""
    if path.suffix.lower() not in _IGES:
        return
    for number in _WITH_EXPONENT.finditer(read_bytes(path)):
        if len(number[2].lstrip(b"0")) > 3 or int(number[2]) > _LARGEST:
            raise FileFormatError(
                path, f": the number {number[1].decode()[:40]} is beyond float64; correct it, or export STEP"
            )


def _document(path: Path) -> tuple[str, tuple[str, ...], Any]:
    """Read a file into a document of OCCT; with it what the format is and what units the file names."""
    messenger = occt("Message").Message.DefaultMessenger_s()
    messenger.ChangePrinters().Clear()  # it would speak on standard output
    is_iges = path.suffix.lower() in _IGES
    kind = "IGES" if is_iges else "STEP"
    if not is_iges and b"END-ISO-10303-21" not in read_bytes(path)[-2000:]:
        raise FileFormatError(path, ": does not end with END-ISO-10303-21; is it cut short?")
    document = occt("TDocStd").TDocStd_Document(occt("TCollection").TCollection_ExtendedString("polhode"))
    if is_iges:
        reader = occt("IGESCAFControl").IGESCAFControl_Reader()
    else:
        reader = occt("STEPCAFControl").STEPCAFControl_Reader()
        reader.SetMatMode(True)
    reader.SetNameMode(True)
    done = occt("IFSelect").IFSelect_ReturnStatus.IFSelect_RetDone
    if reader.ReadFile(str(path)) != done:
        raise FileFormatError(path, f": not a readable {kind} file; export it again")
    names = _iges_units(reader) if is_iges else _step_units(reader, path)
    if not reader.Transfer(document):
        raise FileFormatError(path, f": its {kind} shapes could not be read; export it again")
    return kind, names, document


def _step_units(reader: Any, path: Path) -> tuple[str, ...]:
    sequence = occt("collections").Sequence_TCollection_AsciiString
    lengths, angles, solid_angles = sequence(), sequence(), sequence()
    reader.ChangeReader().FileUnits(lengths, angles, solid_angles)
    names = {lengths.Value(i).ToCString().lower() for i in range(1, lengths.Length() + 1)}
    if not names:
        raise FileFormatError(path, ": says no unit of length; export it again with one")
    return tuple(sorted(names))


def _iges_units(reader: Any) -> tuple[str, ...]:
    section = reader.IGESModel().GlobalSection()
    name = section.UnitName()
    stated = name.ToCString().lower() if name is not None else ""
    return (_IGES_UNITS.get(section.UnitFlag(), stated or "none"),)


class _AssemblyWalk:
    """Goes through the assemblies of a document."""

    def __init__(self, path: Path, kind: str, document: Any) -> None:
        self._path, self._kind = path, kind
        self._tools = occt("XCAFDoc")
        self._shapes = self._tools.XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
        self._known: dict[int, tuple[Moments, int]] = {}
        self._budget = Budget(str(path), path.stat().st_size)
        self.left_out = 0
        self.placed: list[Any] = []
        """The shapes of the parts that were given, at their places."""

    def parts(self) -> Iterator[CadPart]:
        labels = occt("collections").Sequence_TDF_Label()
        self._shapes.GetFreeShapes(labels)
        for i in range(1, labels.Length() + 1):
            yield from self._below(labels.Value(i), occt("gp").gp_Trsf(), "", 0)

    def _below(self, label: Any, place: Any, above: str, depth: int) -> Iterator[CadPart]:
        tool = self._tools.XCAFDoc_ShapeTool
        if depth > 100:
            raise FileFormatError(self._path, ": assemblies are nested more than 100 deep; check the file")
        self._budget.spend("placements")
        if not tool.IsAssembly_s(label):
            yield from self._solids(label, place, above)
            return
        components = occt("collections").Sequence_TDF_Label()
        tool.GetComponents_s(label, components, False)
        for i in range(1, components.Length() + 1):
            component = components.Value(i)
            of = occt("TDF").TDF_Label()
            if not tool.GetReferredShape_s(component, of):
                continue
            moved = place.Multiplied(tool.GetLocation_s(component).Transformation())
            name = _name(component)
            if not name or name.startswith(("=>", "NAUO")):  # what programs put where no name was given
                name = _name(of)
            yield from self._below(of, moved, f"{above}/{name}" if above else name, depth + 1)

    def _solids(self, label: Any, place: Any, name: str) -> Iterator[CadPart]:
        shape = self._tools.XCAFDoc_ShapeTool.GetShape_s(label)
        kinds = occt("TopAbs").TopAbs_ShapeEnum
        solids = list(within(shape, kinds.TopAbs_SOLID))
        self.left_out += sum(1 for _ in within(shape, kinds.TopAbs_FACE, kinds.TopAbs_SOLID))
        name = name or _name(label)
        material, density = _material(label)
        for number, solid in enumerate(solids):
            self._budget.spend("placements")
            own = f"{name}[{number + 1}]" if len(solids) > 1 else name
            whole = place.Multiplied(solid.Location().Transformation())
            if whole.IsNegative() or abs(whole.ScaleFactor() - 1.0) > 1e-12:
                raise FileFormatError(
                    self._path, f": {own} is placed by a reflection or a scale; export it as its own part"
                )
            moments, faces = self._moments(solid, own)
            rotation, position = _numbers(whole)
            self.placed.append(solid.Located(occt("TopLoc").TopLoc_Location(whole)))
            yield CadPart(own, moments, rotation, position, material, density, faces)

    def _moments(self, solid: Any, name: str) -> tuple[Moments, int]:
        """Compute the moments of a solid before it is placed: once, however often it is placed."""
        unplaced = solid.Located(occt("TopLoc").TopLoc_Location())
        key = hash(unplaced)
        if key not in self._known:
            faces = faces_of(unplaced)
            about, reach = box_of(unplaced)
            try:
                moments = moments_of_faces(faces, about, reach)
            except ValueError as error:
                raise FileFormatError(self._path, f": {name}: {error}; export it again") from None
            self._check(moments, name)
            self._known[key] = moments, len(faces)
        return self._known[key]

    def _check(self, moments: Moments, name: str) -> None:
        numbers = [moments.volume, moments.area, moments.error, *moments.second.ravel()]
        solid = f": the solid {name!r}"
        if not np.isfinite(numbers).all():
            raise FileFormatError(self._path, f"{solid} has faces that are not finite; export it again")
        fault = ""
        if moments.loose or moments.openness > 1e-6 * moments.area:
            fault = f"is open: {moments.loose} edges do not belong to two faces; heal it in CAD"
        elif moments.error > _WORST * abs(moments.volume) > 0.0:
            share = 100.0 * moments.error / abs(moments.volume)
            fault = (
                f"has faces that do not meet, or bend too sharply: its volume is known to {share:.2g} "
                "% alone; heal it in CAD and export it again"
            )
        elif not moments.volume > moments.error:
            sign = "is inside out" if moments.volume < -moments.error else "has no volume"
            fault = f"{sign} ({moments.volume:.4g} mm^3); heal it in CAD and export it again"
        if fault:
            raise MeshError(self._path, f"{solid} {fault}")


def faces_of(shape: Any) -> list[Any]:
    """Return the faces of a shape."""
    return [
        occt("TopoDS").TopoDS.Face(face)
        for face in within(shape, occt("TopAbs").TopAbs_ShapeEnum.TopAbs_FACE)
    ]


def within(shape: Any, kind: Any, but_in: Any = None) -> Iterator[Any]:
    """Return what of a kind is in a shape; with `but_in` alone what is in nothing of that kind."""
    explorer = occt("TopExp").TopExp_Explorer
    found = explorer(shape, kind) if but_in is None else explorer(shape, kind, but_in)
    while found.More():
        yield found.Current()
        found.Next()


def box_of(shape: Any) -> tuple[Floats, float]:
    """Return the middle of the box around a shape, and half of its diagonal."""
    box = occt("Bnd").Bnd_Box()
    occt("BRepBndLib").BRepBndLib.Add_s(shape, box)
    if box.IsVoid():
        return np.zeros(3), 1.0
    low, high = (np.array([p.X(), p.Y(), p.Z()]) for p in (box.CornerMin(), box.CornerMax()))
    return (low + high) / 2.0, float(np.linalg.norm(high - low) / 2.0) or 1.0


def _numbers(place: Any) -> tuple[Floats, Floats]:
    rows = np.array([[place.Value(i, j) for j in range(1, 5)] for i in range(1, 4)])
    return rows[:, :3], rows[:, 3]


def _name(label: Any) -> str:
    attribute = occt("TDataStd").TDataStd_Name()
    if not label.IsAttribute(attribute.GetID_s()) or not label.FindAttribute(attribute.GetID_s(), attribute):
        return ""
    return " ".join(str(attribute.Get().ToExtString()).split())[:200]


def _material(label: Any) -> tuple[str, float | None]:
    """Name and density of the material of a part, the density in a unit that OCCT does not tell."""
    tools = occt("XCAFDoc")
    link, node = tools.XCAFDoc.MaterialRefGUID_s(), occt("TDataStd").TDataStd_TreeNode()
    # A search for what is not there ends the process.
    if not label.IsAttribute(link) or not label.FindAttribute(link, node) or not node.HasFather():
        return "", None
    material, owner = tools.XCAFDoc_Material(), node.Father().Label()
    if not owner.IsAttribute(material.GetID_s()) or not owner.FindAttribute(material.GetID_s(), material):
        return "", None
    name, density = material.GetName(), float(material.GetDensity())
    is_known = np.isfinite(density) and density > 0.0
    return "" if name is None else name.ToCString(), density if is_known else None


_ENTITY: Final = re.compile(r"\s*#(\d+)\s*=(.*)", re.DOTALL)
_MEASURE: Final = re.compile(
    r"MEASURE_REPRESENTATION_ITEM\s*\(\s*'([^']*)'\s*,\s*\w+\s*\(\s*([-+.\dEe]+)\s*\)\s*,\s*#(\d+)",
    re.IGNORECASE,
)
_ELEMENT: Final = re.compile(r"DERIVED_UNIT_ELEMENT\s*\(\s*#(\d+)\s*,\s*([-+.\dEe]+)\s*\)", re.IGNORECASE)
_SI: Final = re.compile(r"SI_UNIT\s*\(\s*(?:\.(\w+)\.|\$)\s*,\s*\.(\w+)\.\s*\)", re.IGNORECASE)
_PREFIXES: Final = {"": 1.0, "KILO": 1e3, "DECI": 1e-1, "CENTI": 1e-2, "MILLI": 1e-3, "MICRO": 1e-6}
_BASES: Final = {"GRAM": 1e-3, "METRE": 1.0}
_OF_OCCT: Final = {("GRAM", 1e-3, 3.0), ("METRE", 1e-2, 2.0)}
"""OCCT itself writes g/cm^3 with these powers."""


def densities_of(text: str) -> list[float] | None:
    """Return the densities of a file, each once and ascending; None where a unit is not understood.

    Parameters
    ----------
    text : str
        The whole file.
    """
    measures = [found[1:] for found in _MEASURE.findall(text) if "density" in found[0].lower()]
    if not measures:
        return []
    entities = dict(_entities(text))
    found = set()
    for value, unit in measures:
        scale = _unit(unit, entities)
        if scale is None:
            return None
        found.add(float(value) * scale)
    return sorted(found)


def _entities(text: str) -> Iterator[tuple[str, str]]:
    """Return the number of each entity and what it is; a semicolon within quotes ends none."""
    pieces: list[str] = []
    for place, piece in enumerate(text.split("'")):
        first, *others = piece.split(";") if place % 2 == 0 else (piece,)
        pieces.append(first)
        for other in others:
            if (found := _ENTITY.fullmatch("'".join(pieces))) is not None:
                yield found[1], found[2]
            pieces = [other]


def _unit(number: str, entities: dict[str, str]) -> float | None:
    """Compute how many kilograms per cubic metre one of a unit is."""
    parts = set()
    for reference in re.findall(r"#(\d+)", entities.get(number, "")):
        element = _ELEMENT.search(entities.get(reference, ""))
        si = _SI.search(entities.get(element[1], "")) if element else None
        if element is None or si is None or si[2].upper() not in _BASES:
            return None
        prefix, base = (si[1] or "").upper(), si[2].upper()
        if prefix not in _PREFIXES:
            return None
        parts.add((base, _PREFIXES[prefix] * _BASES[base], float(element[2])))
    if parts == _OF_OCCT:
        return 1000.0
    powers = {base: power for base, _, power in parts}
    if len(parts) != 2 or powers != {"GRAM": 1.0, "METRE": -3.0}:
        return None
    scale = 1.0
    for _, size, power in parts:
        scale *= size**power
    return scale


_MOST_PAIRS: Final = 2000
_CONTACT: Final = 1e-9
"""What is shared by less than this, of the smaller one, is contact."""
_TWICE: Final = "what they share counts twice"


class Pair(NamedTuple):
    """Two solids by their numbers, the larger one first, and what they share in mm^3; None: not known."""

    large: int
    small: int
    volume: float | None


def overlaps_told(cad: CadFile, pairs: Sequence[Pair], fault: str = "") -> tuple[str, ...]:
    """Say which solids of a file overlap and by how much of their volume, and what of that is not known.

    Parameters
    ----------
    cad : CadFile
    pairs : sequence of Pair
        That were looked at.
    fault : str
        Why not all of :func:`near_pairs` were.
    """
    near = _meeting(cad.parts)
    if len(near) > _MOST_PAIRS:
        return (f"{len(near)} pairs of solids are near enough to overlap, too many to look at: {_TWICE}",)
    found = [
        Overlap(
            cad.parts[pair.large].name,
            cad.parts[pair.small].name,
            pair.volume * 1e-9,
            pair.volume >= (1.0 - _CONTACT) * cad.parts[pair.small].moments.volume,
        )
        for pair in pairs
        if pair.volume is not None and pair.volume > _CONTACT * cad.parts[pair.small].moments.volume
    ]
    total = sum(part.moments.volume for part in cad.parts) * 1e-9
    lines = [line.replace("component", "solid", 1) for line in describe_overlaps(found, total, " m^3")]
    unknown = [f"{cad.parts[i].name} and {cad.parts[k].name}" for i, k, volume in pairs if volume is None]
    if unknown:
        more = f" and of {len(unknown) - 3} more pairs" if len(unknown) > 3 else ""
        lines.append(
            f"whether solids overlap is not known of {', '.join(unknown[:3])}{more}: OCCT does not tell; "
            f"where they do, {_TWICE}"
        )
    if len(pairs) < len(near):
        lines.append(
            f"{fault}: {len(near) - len(pairs)} pairs of solids that are near enough to overlap were not "
            f"looked at; where they do, {_TWICE}"
        )
    return tuple(lines)


def near_pairs(parts: Sequence[CadPart]) -> list[tuple[int, int]]:
    """Return the pairs of solids that may share matter; none where they are too many to be looked at."""
    near = _meeting(parts)
    return near if len(near) <= _MOST_PAIRS else []


def _meeting(parts: Sequence[CadPart]) -> list[tuple[int, int]]:
    """Return the pairs whose spheres around their boxes meet, the larger one first."""
    middles = np.array([part.rotation @ part.moments.about + part.position for part in parts])
    reaches = np.array([part.moments.reach for part in parts])
    volumes = np.array([part.moments.volume for part in parts])
    order = np.argsort(-volumes, kind="stable")
    pairs = []
    for place, i in enumerate(order.tolist()):
        later = order[place + 1 :]
        near = np.linalg.norm(middles[later] - middles[i], axis=1) < reaches[later] + reaches[i]
        pairs += [(i, k) for k in later[near].tolist()]
    return pairs


def volume_shared(one: Any, other: Any, least: float) -> float | None:
    """Return the volume that two placed solids share, in mm^3; None where OCCT does not tell.

    Parameters
    ----------
    one, other : TopoDS_Solid
    least : float
        The smaller one's volume.
    """
    from polhode.io.cad_geometry import moments_of_faces

    if _apart(one, other):
        return 0.0
    common = occt("BRepAlgoAPI").BRepAlgoAPI_Common(one, other)
    if not common.IsDone():
        return None
    shape = common.Shape()
    faces = [] if shape is None or shape.IsNull() else faces_of(shape)
    if not faces:
        return None if _holds_corner(one, other) or _holds_corner(other, one) else 0.0
    try:
        moments = moments_of_faces(faces, *box_of(shape))
    except ValueError:
        return None
    is_solid = moments.openness <= 1e-6 * moments.area and moments.error <= 1e-3 * least
    if not is_solid or not -_CONTACT * least <= moments.volume <= (1.0 + 1e-6) * least:
        return None
    return max(moments.volume, 0.0)


def _apart(one: Any, other: Any) -> bool:
    """Return whether the boxes around two solids do not meet."""
    boxes = [occt("Bnd").Bnd_Box(), occt("Bnd").Bnd_Box()]
    for shape, box in zip((one, other), boxes, strict=True):
        occt("BRepBndLib").BRepBndLib.Add_s(shape, box)
    return bool(boxes[0].IsOut(boxes[1]))


def _holds_corner(outer: Any, inner: Any) -> bool:
    """Return whether a corner of one solid lies well within the other, so that they share something."""
    kinds = occt("TopAbs")
    classifier = occt("BRepClass3d").BRepClass3d_SolidClassifier(outer)
    for vertex in within(inner, kinds.TopAbs_ShapeEnum.TopAbs_VERTEX):
        classifier.Perform(occt("BRep").BRep_Tool.Pnt_s(occt("TopoDS").TopoDS.Vertex(vertex)), 1e-6)
        if classifier.State() == kinds.TopAbs_State.TopAbs_IN:
            return True
    return False


_METRE: Final = 1e-3
"""OCCT gives millimetres, whatever the file has."""
_BOUNDS: Final = slice(22, 25)
_PROVENANCE: Final = slice(25, 28)
_SOLID: Final = (10, 1, 4 + 8 + 32 + 64)
"""One solid, checked: finite, closed, orientation, volume."""


class SolidPart(NamedTuple):
    """One solid of a CAD file, at its place.

    Attributes
    ----------
    name : str
        The assemblies that it is in before it: ``"pump/rotor"``.
    material : str
        ``""`` where the file names none.
    body : RigidBody
        In kg and m.
    volume : float
        In m^3.
    """

    name: str
    material: str
    body: _core.RigidBody
    volume: float


def names_of_solids(cad: CadFile) -> list[tuple[str, ...]]:
    """Return the names of each solid: its path (#2 where that stands twice), last name, material."""
    counts: dict[str, int] = {}
    names = []
    for part in cad.parts:
        counts[part.name] = number = counts.get(part.name, 0) + 1
        own = part.name if number == 1 else f"{part.name}#{number}"
        names.append((own, f"{part.name}#{number}", part.name, part.name.rpartition("/")[2], part.material))
    # The bare name is that of all, where it stands twice.
    return [(of[1], *of[2:]) if counts[of[2]] > 1 else of for of in names]


def solids_of(
    cad: CadFile, density: Number | Mapping[Any, Number] | None = None, mass: Number | None = None
) -> tuple[_core.RigidBody, tuple[SolidPart, ...]]:
    """Return the whole and its parts.

    Parameters
    ----------
    cad : CadFile
    density, mass : float or Uncertain, optional
        At most one: of every part, or of the whole. Without `density` each part has that of its material;
        without materials `mass` goes by volume. A mapping has the densities of parts by name or number; the
        others have those of their materials.

    Raises
    ------
    PolhodeError
        Where neither is given and a part has no density of its own.
    """
    if density is not None and mass is not None:
        raise PolhodeError("density and mass: give one of the two, since the other follows from the volume")
    own: list[Number | None] = [part.density for part in cad.parts]
    if isinstance(density, Mapping):
        said = assign(density, names_of_solids(cad))
        own = [known if new is None else new for known, new in zip(own, said, strict=True)]
        density = None
    if density is None and mass is None and None in own:
        nameless = cad.parts[own.index(None)].name
        raise PolhodeError(f"density or mass is needed: {nameless!r} has no density in the file; give one")
    uses_own = density is None and None not in own
    known: dict[int, _core.RigidBody] = {}
    parts = []
    for part, of_material in zip(cad.parts, own, strict=True):
        key = id(part.moments)
        if key not in known:
            known[key] = _at_density_1(part.moments)
        placed = known[key].rotated(_quaternion(part.rotation)).translated(part.position * _METRE)
        weight: Number = of_material if uses_own and of_material is not None else 1.0
        weight = weight if density is None else density
        parts.append(
            SolidPart(part.name, part.material, placed.scaled(mass=weight), part.moments.volume * _METRE**3)
        )
    whole = sum((part.body for part in parts[1:]), start=parts[0].body)
    if mass is not None:
        total = whole.mass
        parts = [part._replace(body=part.body.scaled(mass=1.0 / total).scaled(mass=mass)) for part in parts]
        whole = whole.scaled(mass=1.0 / total).scaled(mass=mass)
    return whole, tuple(parts)


def _quaternion(rotation: Floats) -> Floats:
    return _core.quaternion_from_matrix(rotation)


def _at_density_1(moments: Moments) -> _core.RigidBody:
    """Return the body of a solid before it is placed, with the bounds of the integration."""
    volume, reach = moments.volume, moments.reach
    offset = moments.first / volume
    spread = moments.second - np.outer(offset, offset) * volume
    tensor = np.trace(spread) * np.eye(3) - spread
    body = _core.RigidBody(
        mass=volume * _METRE**3,
        inertia=tensor * _METRE**5,
        center_of_mass=(moments.about + offset) * _METRE,
    )
    share = float(np.abs(offset).max()) / reach
    of_center = moments.error * reach * (1.0 + share) / volume
    of_tensor = 3.0 * moments.error * reach**2 * (1.0 + share) ** 2
    numbers = np.array(body.__reduce__()[1][0], dtype=np.float64)
    numbers[_BOUNDS] = moments.error * _METRE**3, of_center * _METRE, of_tensor * _METRE**5
    numbers[_PROVENANCE] = _SOLID
    return _core.RigidBody._from_numbers(numbers)
