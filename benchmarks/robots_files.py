"""URDF and SDF files read by ElementTree, NumPy and trimesh, without polhode: links, joints, solids."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections import defaultdict
from dataclasses import dataclass, field, replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import trimesh

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

Array = np.ndarray[Any, np.dtype[np.float64]]


@dataclass
class Solid:
    """Corners that span a shape; volume, centre and second moments (per volume) of what it fills.

    Of a DAE mesh also which axis is said to be up: simulators do not agree whether that turns it.
    """

    corners: Array
    volume: float
    center: Array
    second: Array
    dae: str = ""

    @classmethod
    def of(cls, mesh: trimesh.Trimesh) -> Solid:
        """Take a closed mesh as it is and any other as its hull; what is flat fills nothing."""
        try:
            hull = mesh.convex_hull
        except Exception:  # Qhull refuses what is flat
            return cls(np.asarray(mesh.vertices), 0.0, np.zeros(3), np.zeros((3, 3)))
        whole = mesh if mesh.is_volume and mesh.volume > 0.0 else hull
        if not whole.volume > 0.0:
            return cls(np.asarray(mesh.vertices), 0.0, np.zeros(3), np.zeros((3, 3)))
        tensor = np.asarray(whole.moment_inertia) / whole.volume
        second = np.trace(tensor) / 2.0 * np.eye(3) - tensor
        return cls(np.asarray(hull.vertices), whole.volume, np.asarray(whole.center_mass), second)

    def moved(self, matrix: Array) -> Solid:
        """Return it after an affine map."""
        turn, shift = matrix[:3, :3], matrix[:3, 3]
        volume = self.volume * abs(float(np.linalg.det(turn)))
        corners, center = self.corners @ turn.T + shift, turn @ self.center + shift
        return Solid(corners, volume, center, turn @ self.second @ turn.T, self.dae)


@dataclass
class Link:
    """A link as its file has it; ``tensor`` about the centre of mass, in the axes of the link."""

    name: str
    mass: float = 0.0
    center: Array = field(default_factory=lambda: np.zeros(3))
    tensor: Array = field(default_factory=lambda: np.zeros((3, 3)))
    is_declared: bool = False
    is_static: bool = False
    problem: str = ""
    shapes: list[tuple[str, Solid | None]] = field(default_factory=list)

    @property
    def is_empty(self) -> bool:
        """Whether it has neither mass nor tensor."""
        return self.mass == 0.0 and not self.tensor.any()


@dataclass
class Robot:
    """Links in the order of the file; joints as parent, child and whether they are fixed."""

    format: str
    links: list[Link]
    joints: list[tuple[str, str, bool]]


def numbers(text: str | None, count: int) -> Array:
    """Read so many finite numbers."""
    values = np.array([float(word) for word in (text or "").split()])
    if len(values) != count or not np.isfinite(values).all():
        raise ValueError(f"{text!r} where {count} finite numbers have to stand")
    return values


def pose_of(xyz: Array, rpy: Array) -> Array:
    """Return the matrix of a pose."""
    matrix: Array = trimesh.transformations.compose_matrix(translate=xyz, angles=rpy)
    return matrix


def symmetric(values: dict[str, float]) -> Array:
    """Return a tensor by the names of its elements."""
    xx, yy, zz, xy, xz, yz = (values[name] for name in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"))
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


class Meshes:
    """Finds meshes as in a workspace that holds every package of a checkout, by folder or by its own name."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.packages: dict[str, set[Path]] = defaultdict(set)
        for mark in ("package.xml", "manifest.xml", "model.config"):
            for path in folder.rglob(mark):
                name = re.search(r"<name>\s*([^<]+?)\s*</name>", path.read_text(errors="replace"))
                self.packages[path.parent.name].add(path.parent)
                if name:
                    self.packages[name[1]].add(path.parent)

    def find(self, address: str, robot: Path) -> Path | None:
        """Return file that an address means: beside the robot, or in the package that is nearest to it."""
        named = re.match(r"(?:package|model)://([^/]+)/+(.+)|(?:file://)?\$\(find ([^)]+)\)/+(.+)", address)
        if not named:
            path = robot.parent / address.removeprefix("file://")
            return path if path.is_file() else None
        package, rest = (named[1] or named[3]).strip(), named[2] or named[4]
        around = [p for p in robot.parents if p.is_relative_to(self.folder)]
        above = [p for p in around if p.name == package]
        above += [p / package for p in around]
        shared = {p: sum(map(str.__eq__, p.parts, robot.parts)) for p in self.packages[package]}
        places = [*above, *sorted(shared, key=lambda p: (-shared[p], p))]
        return next((p / rest for p in places if (p / rest).is_file()), None)


@cache
def mesh_of(path: Path) -> Solid | None:
    """Read a mesh in metres; None where it cannot be told."""
    factor, dae = 1.0, ""
    if path.suffix.lower() == ".dae":
        head = path.read_text(errors="replace")[:20000]
        unit = re.search(r'<unit[^>]*meter="([^"]+)"', head)
        factor, dae = float(unit[1]) if unit else 1.0, "z-up" if "Z_UP" in head else "y-up"
    try:
        mesh = trimesh.load(path, force="mesh", process=False)
    except Exception:  # whatever a reader meets, the mesh is unread
        return None
    if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces) or not np.isfinite(mesh.vertices).all():
        return None
    return replace(Solid.of(mesh.apply_scale(factor)), dae=dae)


def shape(kind: str, size: dict[str, Any], pose: Array, meshes: Meshes, robot: Path) -> Solid | None:
    """Return a shape in its link; None where it cannot be told."""
    make = trimesh.creation
    try:
        if kind == "mesh":
            path = meshes.find(size.get("filename") or size.get("uri") or "", robot)
            found = mesh_of(path) if path is not None and path.is_file() else None
            words = (size.get("scale") or "1").split()
            scale = [float(word) for word in (words if len(words) == 3 else words * 3)]
            placed = found and found.moved(pose @ np.diag([*scale, 1.0]))
            return placed if placed and np.isfinite(placed.corners).all() else None
        if kind == "box":
            mesh = make.box(np.abs(numbers(size["size"], 3)))
        elif kind == "sphere":
            mesh = make.icosphere(4, abs(float(size["radius"])))
        elif kind == "cylinder":
            mesh = make.cylinder(abs(float(size["radius"])), abs(float(size["length"])), sections=96)
        elif kind == "capsule":
            mesh = make.capsule(abs(float(size["length"])), abs(float(size["radius"])))
        else:
            return None
    except (KeyError, ValueError):
        return None
    return Solid.of(mesh).moved(pose)


def parsed(path: Path) -> ET.Element:
    """Parse a file as simulators do, who know of no namespaces."""
    text = re.sub(
        r"<\?xml.*?\?>", "", path.read_text(encoding="utf-8-sig", errors="replace"), flags=re.DOTALL
    )
    return ET.fromstring(re.sub(r"(</?|\s)(\w+):(?=[\w.-]+[\s=/>])", r"\1\2_", text))


def read(path: Path, meshes: Meshes) -> Robot:
    """Read a URDF or SDF file."""
    root = parsed(path)
    return _urdf(root, path, meshes) if root.tag == "robot" else _sdf(root, path, meshes)


def _urdf(root: ET.Element, path: Path, meshes: Meshes) -> Robot:
    links = []
    for element in root.findall("link"):
        link = Link(element.get("name", ""))
        try:
            _urdf_inertial(link, element.find("inertial"))
        except (AttributeError, KeyError, ValueError, TypeError) as error:
            link.problem = str(error) or "unreadable"
        for role in ("collision", "visual"):
            for each in element.findall(role):
                for form in each.findall("geometry/*"):
                    pose = _urdf_pose(each.find("origin"))
                    link.shapes.append((role, shape(form.tag, dict(form.attrib), pose, meshes, path)))
        links.append(link)
    joints = [
        (parent.get("link", ""), child.get("link", ""), j.get("type") == "fixed")
        for j in root.findall("joint")
        for parent, child in zip(j.findall("parent")[:1], j.findall("child")[:1], strict=False)
    ]
    return Robot("URDF", links, joints)


def _urdf_pose(origin: ET.Element | None) -> Array:
    if origin is None:
        return np.eye(4)
    return pose_of(numbers(origin.get("xyz", "0 0 0"), 3), numbers(origin.get("rpy", "0 0 0"), 3))


def _urdf_inertial(link: Link, inertial: ET.Element | None) -> None:
    if inertial is None:
        return
    link.is_declared = True
    pose = _urdf_pose(inertial.find("origin"))
    inertia, mass = inertial.find("inertia"), inertial.find("mass")
    if inertia is None or mass is None:
        raise ValueError("<inertial> without <mass> or <inertia>")
    tensor = symmetric({k: float(v) for k, v in inertia.attrib.items()})
    link.mass, link.center = float(mass.attrib["value"]), pose[:3, 3]
    link.tensor = pose[:3, :3] @ tensor @ pose[:3, :3].T
    numbers(" ".join(map(str, [link.mass, *link.tensor.ravel()])), 10)


def _sdf(root: ET.Element, path: Path, meshes: Meshes) -> Robot:
    links: list[Link] = []
    joints: list[tuple[str, str, bool]] = []
    for model, names, is_static in _models(root, (), False):
        for element in model.findall("link"):
            link = Link("::".join((*names, element.get("name", ""))), is_static=is_static)
            try:
                _sdf_inertial(link, element.find("inertial"))
            except (AttributeError, KeyError, ValueError, TypeError) as error:
                link.problem = str(error) or "unreadable"
            for role in ("collision", "visual"):
                for each in element.findall(role):
                    for form in each.findall("geometry/*"):
                        size = {child.tag: (child.text or "").strip() for child in form}
                        pose = _sdf_pose(each.find("pose"))
                        link.shapes.append((role, shape(form.tag, size, pose, meshes, path)))
            links.append(link)
        for joint in model.findall("joint"):
            parent, child = ((joint.findtext(tag) or "").strip() for tag in ("parent", "child"))
            ends = ["world" if end == "world" else "::".join((*names, end)) for end in (parent, child)]
            joints.append((ends[0], ends[1], joint.get("type") == "fixed"))
    return Robot("SDF", links, joints)


def _models(
    parent: ET.Element, names: tuple[str, ...], is_static: bool
) -> Iterator[tuple[ET.Element, tuple[str, ...], bool]]:
    """Return every model with its names and whether it stands still, in the order of the file."""
    for element in parent:
        if element.tag == "model":
            own = (*names, element.get("name", ""))
            still = is_static or (element.findtext("static") or "").strip().lower() in ("1", "true")
            yield element, own, still
            yield from _models(element, own, still)
        elif element.tag == "world":
            yield from _models(element, names, is_static)


def _sdf_pose(pose: ET.Element | None) -> Array:
    if pose is None or not (pose.text or "").strip():
        return np.eye(4)
    values = numbers(pose.text, 6)
    return pose_of(values[:3], np.deg2rad(values[3:]) if pose.get("degrees") == "true" else values[3:])


def _sdf_inertial(link: Link, inertial: ET.Element | None) -> None:
    link.mass, link.tensor = 1.0, np.eye(3)  # the defaults of the format
    if inertial is None:
        return
    link.is_declared = True
    if inertial.get("auto") in ("true", "1"):
        link.tensor = np.full((3, 3), np.nan)
        return
    pose = _sdf_pose(inertial.find("pose"))
    given = {"ixx": 1.0, "iyy": 1.0, "izz": 1.0, "ixy": 0.0, "ixz": 0.0, "iyz": 0.0}
    given |= {child.tag: float(child.text or "") for child in inertial.findall("inertia/*")}
    link.mass, link.center = float(inertial.findtext("mass") or 1.0), pose[:3, 3]
    link.tensor = pose[:3, :3] @ symmetric(given) @ pose[:3, :3].T
