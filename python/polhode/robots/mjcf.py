"""MJCF, MuJoCo's format: nested ``<body>`` elements and default classes, as its compiler reads them."""

from __future__ import annotations

import os
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from polhode import RigidBody, euler_angles
from polhode._core import rotate
from polhode._format import Note
from polhode.errors import FileFormatError
from polhode.interop.programs import mjcf_tensor
from polhode.io.xml_source import Edit, Element, remove_attribute, set_attribute
from polhode.robots.edits import attribute, first_child, number_text
from polhode.robots.model import (
    WORLD,
    Compiler,
    Inertial,
    Joint,
    Link,
    Place,
    Shape,
    numbers,
    quote,
    scale,
    unit,
)
from polhode.robots.sources import LimitError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode.robots.model import Robot
    from polhode.robots.sources import Sources
    from polhode.robots.verdict import Verdict

__all__ = [
    "as_compiled",
    "compiler_of",
    "copies",
    "expand_includes",
    "legacy_solid",
    "links",
    "matrix",
    "mesh_shape",
    "total_mass_of",
]

_ORIENTATIONS = ("quat", "axisangle", "euler", "xyaxes", "zaxis")
_HALF_LENGTHS = {"sphere": 1, "ellipsoid": 3, "box": 3, "cylinder": 2, "capsule": 2}
_WATER = "1000"
_OF_GEOMS = frozenset({"type", "size", "pos", "fromto", "mesh", "mass", "density", "group", *_ORIENTATIONS})
_AFTERWARDS = (
    "boundmass, boundinertia or balanceinertia of the compiler change masses and tensors later: what is "
    "declared is judged as it stands"
)
_COPIED = "bodies within <replicate> are judged once, their copies not"


def links(root: Element, sources: Sources) -> Iterator[Link]:
    """Read every body below the world, those of included files and attached models too."""
    reader = _Reader(root, sources.folder, sources)
    sources.total_mass = total_mass_of(list(root.all("compiler")))
    made = sum(1 for tag in ("composite", "flexcomp") for _ in root.descendants(tag))
    if made:
        sources.notes[f"{made} composite or flexcomp parts make bodies that are not judged"] = None
    for world in root.all("worldbody"):
        yield from reader.below(world, None, WORLD)
    if sources.total_mass and (made or _COPIED in sources.notes):
        sources.total_mass = 0.0
        sources.notes[
            "settotalmass of the compiler scales bodies that are not all judged: it is left out"
        ] = None


class Member(NamedTuple):
    """An element of a body, with the frame it stands in, the class it inherits and what is wrong there."""

    element: Element
    place: Place
    inherited: str | None
    problem: str


class _Reader:
    """A model's compiler settings, default classes and meshes."""

    def __init__(self, root: Element, folder: Path, sources: Sources, prefix: str = "") -> None:
        expand_includes(root, folder, sources)
        self.root, self.folder, self.sources, self.prefix = root, folder, sources, sources.prefix(prefix)
        self._open_copies = 0
        settings = {k: v for compiler in root.all("compiler") for k, v in compiler.attributes.items()}
        self.in_radians = settings.get("angle", "degree") == "radian"
        self.sequence = settings.get("eulerseq", "xyz").swapcase()
        self.infers_always = settings.get("inertiafromgeom", "auto") == "true"
        self.groups = [int(x) for x in settings.get("inertiagrouprange", "").split() if x.isdecimal()]
        compiler = compiler_of(list(root.all("compiler")))
        self.compiler = compiler if any(compiler) else None
        if self.compiler is not None:
            sources.notes[_AFTERWARDS] = None
        self.geoms: dict[str, dict[str, str]] = {"main": {}}
        self.of_meshes: dict[str, dict[str, str]] = {}  # of each class
        for default in root.all("default"):
            self._add_class(default, {}, default.attributes.get("class", "main"))
        self.meshes: dict[str, tuple[Element, str]] = {}
        mesh_folder = settings.get("meshdir", settings.get("assetdir", "")).rstrip("/")
        self.models: dict[str, str] = {}
        for asset in root.all("asset"):
            for mesh in asset.all("mesh"):
                file = mesh.attributes.get("file", "")
                name = mesh.attributes.get("name", file.rpartition("/")[2].rpartition(".")[0])
                self.meshes[name] = mesh, f"{mesh_folder}/{file}" if mesh_folder and file else file
            for model in asset.all("model"):
                self._add_model(model)

    def below(
        self, parent: Element, inherited: str | None, above: str, above_name: str = ""
    ) -> Iterator[Link]:
        """Read the bodies and the attached models that hang on a body or the world, by its key and name."""
        unnamed = 0
        for body in self.members(parent, "body", Place.identity(), inherited):
            unnamed += "name" not in body.element.attributes
            own_name = body.element.attributes.get("name", f"{above_name}/{unnamed}")
            yield from self.bodies(body, above, own_name)
        for attach in self.members(parent, "attach", Place.identity(), inherited):
            for link in self._read_attach(attach.element, above):
                yield replace(link, problem=attach.problem or link.problem)

    def bodies(self, member: Member, above: str, own_name: str) -> Iterator[Link]:
        """Read a body, with the problem of the frame that it stands in, and those that hang on it."""
        body, _, inherited, problem = member
        inherited = body.attributes.get("childclass", inherited)
        inertial: Inertial | None = None
        shapes: tuple[Shape, ...] = ()
        declared = body.find("inertial")
        is_inferred = declared is None or self.infers_always
        try:
            geoms = self.members(body, "geom", Place.identity(), inherited)
            shapes = tuple(self._shape(geom, weighs=is_inferred) for geom in geoms)
            # MuJoCo keeps what is declared where no geom weighs, whatever the compiler says.
            masses = (geom.density if geom.mass is None else geom.mass for geom in shapes)
            is_inferred = declared is None or (self.infers_always and any(masses))
            if declared is not None and not is_inferred:
                inertial = self._inertial(declared)
        except LimitError:
            raise
        except FileFormatError as error:
            problem = problem or Note(*error.args)
        is_elsewhere = bool(body.file) or any(child.file for child in body.children)
        reach = 0.0
        with suppress(FileFormatError):
            reach = float(np.linalg.norm(numbers(body, body.attributes.get("pos", "0 0 0"), 3, "pos")))
        shown = body.attributes.get("name", f"(body of {body.where})")
        name = self.sources.name(self.prefix, shown, body)
        key = f"body {len(self.sources.joints)}"
        self.sources.joints.append(self._joint(body, name, above, key))
        yield Link(
            name=name,
            line=body.line,
            inertial=inertial,
            problem=problem,
            shapes=shapes,
            inferred=is_inferred,
            rewrite=None if is_elsewhere or self.infers_always else partial(_rewrite, body, declared),
            file=body.file,
            folder=self.folder,
            key=key,
            reach=reach,
            compiler=self.compiler,
            own_name=own_name,
            element=body,
        )
        yield from self.below(body, inherited, key, own_name)

    def _joint(self, body: Element, name: str, above: str, key: str) -> Joint:
        """Return the joint that moves a body; None without a joint."""
        free = [*self.members(body, "freejoint", Place.identity(), None)]
        joints = [*free, *self.members(body, "joint", Place.identity(), None)]
        if not joints:
            return Joint("", "fixed", above, key)
        kind = "free" if free else joints[0].element.attributes.get("type", "hinge")
        return Joint(joints[0].element.attributes.get("name", f"of {name}"), kind, above, key)

    def members(
        self, parent: Element, tag: str, place: Place, inherited: str | None, problem: str = ""
    ) -> Iterator[Member]:
        """Return the elements of a body or the world, those in frames too."""
        for child in parent.children:
            if child.tag == tag:
                yield Member(child, place, inherited, problem)
            elif child.tag == "frame":
                step, fault = self._step(child, child.attributes)
                name = child.attributes.get("childclass", inherited)
                yield from self.members(child, tag, place.then(step), name, problem or fault)
            elif child.tag == "replicate":
                yield from self._read_copies(child, tag, Member(child, place, inherited, problem))

    def _step(self, element: Element, attributes: dict[str, str]) -> tuple[Place, str]:
        """Return a frame, and the text of its fault; the fault concerns only the elements in this frame."""
        try:
            return self._place(element, attributes), ""
        except FileFormatError as error:
            return Place.identity(), Note(*error.args)

    def _read_copies(self, replicate: Element, tag: str, first: Member) -> Iterator[Member]:
        """Return the elements of every copy; bodies once, as they are the same in all."""
        attributes = replicate.attributes
        turn = {"pos": attributes.get("offset", "0 0 0"), "euler": attributes.get("euler", "0 0 0")}
        step, fault = self._step(replicate, turn)
        count = copies(replicate)
        is_geom, place = tag == "geom", first.place
        if is_geom:
            self.sources.count_copies(count, replicate)
        for number in range(count if is_geom else 1):
            self._open_copies += 1
            inside = list(self.members(replicate, tag, place, first.inherited, first.problem or fault))
            self._open_copies -= 1
            if is_geom and number == 0:
                self.sources.count_copied(count * len(inside), replicate, keep=self._open_copies == 0)
            if inside and not is_geom:
                self.sources.notes[_COPIED] = None
            yield from inside
            place = place.then(step)

    def _add_model(self, model: Element) -> None:
        file = model.attributes.get("file", "")
        name = model.attributes.get("name")
        if name is None:  # then it goes by the name that its own file gives it
            path = self.sources.locate(file, self.folder, model)
            name = self.sources.read(path, file, model).attributes.get("model", "")
        self.models[name] = file

    def _read_attach(self, attach: Element, above: str) -> Iterator[Link]:
        """Read the bodies of an ``<attach>``: a body or a frame of another model, or all its bodies."""
        tag = next((tag for tag in ("body", "frame") if tag in attach.attributes), "")
        wanted = attach.attributes.get(tag, "")
        if "model" not in attach.attributes and tag:
            self.sources.notes["what <attach> repeats of the model itself is judged once"] = None
            return
        name = attach.attributes.get("model", "")
        if name not in self.models:
            raise FileFormatError(
                f"{attach.where}: <attach> of model {quote(name)}, which no <model> of the assets "
                "names; add it"
            )
        file = self.models[name]
        path = self.sources.locate(file, self.folder, attach)
        prefix = self.prefix + attach.attributes.get("prefix", "")
        root = self.sources.read(path, file, attach)
        with self.sources.inside(path, file, attach):
            model = _Reader(root, path.parent, self.sources, prefix)
            for world in root.all("worldbody"):
                if not tag:
                    yield from model.below(world, None, above)
                    continue
                everything = model.everything(world, tag, None)
                found = [each for each in everything if each.element.attributes.get("name") == wanted]
                for member in found:
                    read = partial(model.bodies, own_name=wanted) if tag == "body" else model.read_frame
                    yield from read(member, above)
                if found:
                    return
            if tag:
                raise FileFormatError(
                    f"{attach.where}: {file} has no {tag} {quote(wanted)}; correct the name"
                )

    def read_frame(self, frame: Member, above: str) -> Iterator[Link]:
        """Read the bodies of a frame."""
        inherited = frame.element.attributes.get("childclass", frame.inherited)
        yield from self.below(frame.element, inherited, above)

    def everything(self, parent: Element, tag: str, inherited: str | None) -> Iterator[Member]:
        """Return every body, or every frame, below a body or the world."""
        for child in parent.children:
            if child.tag not in ("body", "frame", "replicate"):
                continue
            if child.tag == tag:
                yield Member(child, Place.identity(), inherited, "")
            yield from self.everything(child, tag, child.attributes.get("childclass", inherited))

    def _add_class(
        self, default: Element, geoms: dict[str, str], name: str, meshes: dict[str, str] | None = None
    ) -> None:
        own, of_meshes = dict(geoms), dict(meshes or {})
        for geom in default.all("geom"):
            own |= {name: text for name, text in geom.attributes.items() if name in _OF_GEOMS}
        for mesh in default.all("mesh"):
            of_meshes |= mesh.attributes
        self.geoms[name], self.of_meshes[name] = own, of_meshes
        for child in default.all("default"):
            self._add_class(child, own, child.attributes.get("class", ""), of_meshes)

    def _place(self, element: Element, attributes: dict[str, str]) -> Place:
        position = numbers(element, attributes.get("pos", "0 0 0"), 3, "pos")
        return Place(self._rotation(element, attributes), position)

    def _rotation(self, element: Element, attributes: dict[str, str]) -> Any:
        to_radians = 1.0 if self.in_radians else np.pi / 180.0
        if "quat" in attributes:
            w, x, y, z = numbers(element, attributes["quat"], 4, "quat")
            return matrix(unit(element, np.array([x, y, z, w])))
        if "euler" in attributes:
            angles = numbers(element, attributes["euler"], 3, "euler") * to_radians
            if len(self.sequence) != 3 or not (
                set(self.sequence) <= set("xyz") or set(self.sequence) <= set("XYZ")
            ):
                sequence = quote(self.sequence.swapcase())
                raise FileFormatError(
                    f"{element.where}: euler by eulerseq {sequence}, which is not read: three letters of "
                    "xyz or of XYZ have to stand there; give quat"
                )
            return matrix(euler_angles.to_quaternion(angles, self.sequence))
        if "axisangle" in attributes:
            *axis, angle = numbers(element, attributes["axisangle"], 4, "axisangle")
            half = angle * to_radians / 2.0
            return matrix(np.append(np.sin(half) * unit(element, np.array(axis)), np.cos(half)))
        if "xyaxes" in attributes:
            values = numbers(element, attributes["xyaxes"], 6, "xyaxes")
            x_axis = unit(element, values[:3])
            y_axis = unit(element, values[3:] - values[3:] @ x_axis * x_axis)
            return np.stack([x_axis, y_axis, np.cross(x_axis, y_axis)], axis=-1)
        if "zaxis" in attributes:
            return _turning_z_to(unit(element, numbers(element, attributes["zaxis"], 3, "zaxis")))
        return np.eye(3)

    def _inertial(self, element: Element) -> Inertial:
        attributes = element.attributes
        numbers(element, attributes.get("pos"), 3, "pos")  # which MuJoCo asks for here
        place = self._place(element, attributes)
        (mass,) = numbers(element, attributes.get("mass"), 1, "mass")
        if "fullinertia" in attributes:
            xx, yy, zz, xy, xz, yz = numbers(element, attributes["fullinertia"], 6, "fullinertia")
            tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        else:
            # A point mass without it, which MuJoCo takes where no joint moves the body.
            tensor = np.diag(numbers(element, attributes.get("diaginertia", "0 0 0"), 3, "diaginertia"))
        return Inertial(float(mass), place.position, place.rotation @ tensor @ place.rotation.T)

    def _shape(self, member: Member, *, weighs: bool) -> Shape:
        """Read a geom; one with ``shellinertia`` counts as a shell."""
        geom, frame, inherited, problem = member
        if problem:
            raise FileFormatError(problem)
        name = geom.attributes.get("class", inherited) or "main"
        attributes = {**self.geoms.get(name, {}), **geom.attributes}
        kind = attributes.get("type", "mesh" if "mesh" in attributes else "sphere")
        density = float(numbers(geom, attributes.get("density", _WATER), 1, "density")[0])
        mass = float(numbers(geom, attributes["mass"], 1, "mass")[0]) if "mass" in attributes else None
        if kind in ("plane", "hfield"):  # which bound no matter
            mass = 0.0
        group = attributes.get("group", "0")
        if len(self.groups) == 2 and group.isdecimal() and len(group) < 10:
            low, high = self.groups
            mass = mass if low <= int(group) <= high else 0.0
        is_shell = weighs and attributes.get("shellinertia") == "true"
        if kind == "mesh":
            place = frame.then(self._place(geom, attributes))
            name = attributes.get("mesh", "")
            if name not in self.meshes:
                return Shape("mesh", (1.0, 1.0, 1.0), place, "collision", "", density, mass, geom.where)
            mesh, address = self.meshes[name]
            own = {**self.of_meshes.get(mesh.attributes.get("class", "main"), {}), **mesh.attributes}
            own |= {"inertia": "shell"} if is_shell else {}
            return mesh_shape(geom, place, mesh, own, address, density, mass, weighs=weighs)
        if "mesh" in attributes:  # MuJoCo takes the size from the mesh, whatever stands here
            kind = f"{kind} fitted to a mesh"
            return Shape(kind, (), frame, "collision", "", density, mass, geom.where)
        place, size = self._read_size(geom, attributes, kind)
        counting = "shell" if is_shell else ""
        return Shape(
            kind, size, frame.then(place), "collision", "", density, mass, geom.where, counting=counting
        )

    def _read_size(
        self, geom: Element, attributes: dict[str, str], kind: str
    ) -> tuple[Place, tuple[float, ...]]:
        """Return the place and the full lengths; ``fromto`` gives both for a long shape."""
        place = self._place(geom, attributes)
        if kind not in _HALF_LENGTHS:
            return place, ()
        size = numbers(geom, attributes.get("size", ""), None, "size").tolist()
        needed = _HALF_LENGTHS[kind]
        if "fromto" in attributes and kind != "sphere" and size:
            ends = numbers(geom, attributes["fromto"], 6, "fromto")
            along = ends[3:] - ends[:3]
            place = Place(_turning_z_to(unit(geom, along)), (ends[:3] + ends[3:]) / 2.0)
            half = float(np.linalg.norm(along)) / 2.0
            size = [size[0], half] if needed == 2 else [size[0], size[min(1, len(size) - 1)], half]
        if not needed <= len(size) <= 3:
            raise FileFormatError(
                f"{geom.where}: a geom of type {kind} needs {needed} numbers of size, at most 3, and has "
                f"{len(size)}; correct it"
            )
        if kind == "box":
            return place, tuple(2.0 * x for x in size[:3])
        if kind in ("cylinder", "capsule"):
            return place, (size[0], 2.0 * size[1])
        return place, tuple(size[:needed])


def _turning_z_to(axis: Any) -> Any:
    """Return the shortest rotation from z to an axis."""
    if axis[2] < -1.0 + 1e-12:
        return np.diag([1.0, -1.0, -1.0])
    return matrix(np.array([-axis[1], axis[0], 0.0, 1.0 + axis[2]]) / np.sqrt(2.0 * (1.0 + axis[2])))


def _rewrite(body: Element, declared: Element | None, source: bytes, new: Inertial) -> list[Edit]:
    """Write mass properties with the axes of the body, or of the tensor where it is small."""
    tensor = {name: number_text(values) for name, values in mjcf_tensor(new.inertia).items()}
    position = number_text(new.center_of_mass)
    if declared is None:
        texts = " ".join(f'{name}="{text}"' for name, text in tensor.items())
        return [first_child(source, body, f'<inertial pos="{position}" mass="{new.mass!r}" {texts}/>')]
    gone = {"diaginertia", "fullinertia", *_ORIENTATIONS} - set(tensor)
    removed = [remove_attribute(source, declared, each) for each in sorted(gone)]
    edits = [edit for edit in removed if edit is not None]
    edits += [set_attribute(source, declared, name, text) for name, text in tensor.items()]
    edits += attribute(source, declared, "pos", position)
    edits += attribute(source, declared, "mass", repr(new.mass))
    return edits


# Below it MuJoCo refuses the mass and the moments of what moves.
_LEAST = 1e-15


def compiler_of(compilers: Sequence[Element]) -> Compiler:
    """Read what the ``<compiler>`` elements of a model say; the last word counts."""
    least = [_number(compilers, name) for name in ("boundmass", "boundinertia")]
    texts = [each.attributes.get("balanceinertia") for each in compilers]
    return Compiler(least[0], least[1], next((t for t in reversed(texts) if t), "false") == "true")


def total_mass_of(compilers: Sequence[Element]) -> float:
    """Return the mass that ``settotalmass`` sets for all bodies together; 0 where it does not."""
    return max(_number(compilers, "settotalmass"), 0.0)


def as_compiled(robot: Robot, verdicts: Sequence[Verdict]) -> list[Verdict]:
    """Apply the settings of the compiler to the verdicts of inferred bodies."""
    pairs = list(zip(robot.links, verdicts, strict=True))
    if not (robot.total_mass or any(link.compiler for link in robot.links)):
        return list(verdicts)
    found = [_apply_bounds(link.compiler, verdict) if link.compiler else verdict for link, verdict in pairs]
    masses = [_mass(link, verdict) for link, verdict in zip(robot.links, found, strict=True)]
    total = sum(mass for mass in masses if mass is not None)
    if not (robot.total_mass and total > 0.0):
        return found
    if None in masses:
        unknown = robot.links[masses.index(None)].name
        return [
            _add_reason(v, f"settotalmass would scale it: the mass of {unknown} is not known") for v in found
        ]
    factor = robot.total_mass / total
    return [
        _add_reason(v, f"times {factor:.4g} by settotalmass", v.mass * factor, np.asarray(v.moments) * factor)
        if v.mass is not None and v.moments is not None
        else v
        for v in found
    ]


def _number(compilers: Sequence[Element], name: str) -> float:
    value = 0.0
    for each in compilers:
        if name in each.attributes:
            value = float(numbers(each, each.attributes[name], 1, name)[0])
    return value


def _apply_bounds(compiler: Compiler, verdict: Verdict) -> Verdict:
    """Raise mass and moments to the bounds, and balance moments that violate the triangle inequality."""
    is_empty = verdict.verdict == "missing" and min(compiler.mass, compiler.moment) > _LEAST
    if not is_empty and (verdict.verdict != "inferred" or verdict.mass is None):
        return verdict
    before = np.zeros(3) if is_empty or verdict.moments is None else np.asarray(verdict.moments)
    mass = max(0.0 if is_empty else float(verdict.mass or 0.0), compiler.mass)
    moments = np.maximum(before, compiler.moment)
    is_balanced = compiler.is_balanced and 2.0 * moments.max() > moments.sum()
    moments = np.full(3, moments.mean()) if is_balanced else np.sort(moments)
    if not is_empty and mass == verdict.mass and np.array_equal(moments, before):
        return verdict
    if is_empty:
        verdict = verdict._replace(verdict="inferred", reason="", better=None, law="")
    return _add_reason(verdict, "by boundmass and boundinertia of the compiler", mass, moments)


def _mass(link: Link, verdict: Verdict) -> float | None:
    """Return the mass of a body as it is before ``settotalmass``; None where it is not known."""
    if verdict.mass is None and verdict.verdict in ("none", "missing"):
        return link.compiler.mass if link.compiler else 0.0
    if verdict.mass is None:
        return None
    return max(verdict.mass, link.compiler.mass) if link.compiler else verdict.mass


def _add_reason(verdict: Verdict, words: str, mass: float | None = None, moments: Any = None) -> Verdict:
    """Add words, and numbers where they are given, to the verdict of an inferred body."""
    if verdict.verdict != "inferred":
        return verdict
    reason = ", ".join(part for part in (verdict.reason, words) if part)
    if mass is None:
        return verdict._replace(reason=reason)
    return verdict._replace(reason=reason, mass=mass, moments=moments)


def matrix(quaternion: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation of a unit quaternion, scalar last."""
    return np.stack([rotate(quaternion, axis) for axis in np.eye(3)], axis=-1)


def mesh_shape(
    geom: Element,
    place: Place,
    mesh: Element,
    attributes: dict[str, str],
    address: str,
    density: float,
    mass: float | None,
    *,
    weighs: bool,
) -> Shape:
    """Return the shape of a geom that is a mesh.

    MuJoCo moves the vertices by minus `refpos`, turns them by the inverse of `refquat`, and then scales them.

    Parameters
    ----------
    geom, mesh : Element
    place : Place
        Of the geom, in its body.
    attributes : dict
        Of the mesh, with those of its class.
    address : str
        Of its file; "" where the model lists the vertices.
    density : float
    mass : float, optional
    weighs : bool
        Whether the inertia of the body is taken from it, so that `inertia` of the mesh counts.
    """
    factors = scale(mesh, attributes.get("scale", "1"))
    counting = attributes.get("inertia", "legacy") if weighs else ""
    kind = "mesh" if address else "mesh without a file"
    shift = numbers(mesh, attributes.get("refpos", "0 0 0"), 3, "refpos")
    w, x, y, z = numbers(mesh, attributes.get("refquat", "1 0 0 0"), 4, "refquat")
    back = matrix(unit(mesh, np.array([x, y, z, w]))).T
    if len(set(factors)) > 1 and not np.array_equal(back, np.eye(3)):
        kind = "mesh, turned by refquat and scaled unevenly"
    inner = Place(back, -np.array(factors) * (back @ shift))
    return Shape(
        kind, factors, place.then(inner), "collision", address, density, mass, geom.where, counting=counting
    )


def legacy_solid(vertices: NDArray[np.float64], faces: NDArray[np.integer]) -> RigidBody:
    """Return the body of density 1 that MuJoCo computes for a mesh with ``inertia="legacy"``, its default.

    The tetrahedra from the centroid of the surface to its triangles all count as full, whichever way they are
    wound: twice where they overlap, as where a mesh is not convex. From their centre of mass new tetrahedra
    are made, whose volumes and moments about that point count.
    """
    corners = vertices[faces]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    middle = areas @ corners.mean(axis=1) / areas.sum()
    volumes = _volumes(corners - middle)
    center = middle + volumes @ (corners - middle).sum(axis=1) / 4.0 / volumes.sum()
    about = corners - center
    volumes = _volumes(about)
    # With one corner at the point, ∫ x xᵀ dV = V/20 (Σ a aᵀ + (Σ a)(Σ a)ᵀ) over the other three.
    sums = about.sum(axis=1)
    second = np.einsum("t,tki,tkj->ij", volumes, about, about) + np.einsum("t,ti,tj->ij", volumes, sums, sums)
    second /= 20.0
    tensor = np.trace(second) * np.eye(3) - second
    return RigidBody(float(volumes.sum()), (tensor + tensor.T) / 2.0, center)


def _volumes(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the volumes of the tetrahedra from the origin to triangles, all positive."""
    heights = np.cross(corners[:, 0], corners[:, 1])
    found: NDArray[np.float64] = np.abs((heights * corners[:, 2]).sum(axis=1)) / 6.0
    return found


def expand_includes(root: Element, folder: Path, sources: Sources) -> None:
    """Put the elements of included files where the ``<include>`` stands, as MuJoCo does before it reads.

    Parameters
    ----------
    root : Element
        Of the model; it is changed.
    folder : pathlib.Path
        Of the model's file, where the names of all its included files start.
    sources : Sources
    """
    included: set[str] = set()
    waiting = [root]
    while waiting:
        element = waiting.pop()
        children: list[Element] = []
        unread = list(reversed(element.children))
        while unread:
            child = unread.pop()
            if child.tag != "include":
                children.append(child)
                continue
            name = child.attributes.get("file", "")
            if not name:
                raise FileFormatError(f"{child.where}: <include> without file; name one")
            path = sources.locate(name, folder, child)
            # MuJoCo knows a file by its name: links to one file are files of their own.
            if (called := os.path.normpath(path)) in included:
                raise FileFormatError(
                    f"{child.where}: {name} is included twice; MuJoCo allows it once: leave one of them out"
                )
            included.add(called)
            unread += reversed(sources.read(path, name, child).children)
        element.children = children
        waiting += children


def copies(replicate: Element) -> int:
    """Return how many copies a ``<replicate>`` asks for."""
    text = replicate.attributes.get("count")
    (count,) = numbers(replicate, text, 1, "count")
    if count != int(count) or count < 1:
        raise FileFormatError(
            f"{replicate.where}: count is {quote(text)} where a whole number from 1 has to stand"
        )
    return int(count)
