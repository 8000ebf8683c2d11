"""SDF: ``<sdf>`` with models of ``<link>`` elements; values are texts of elements, poses ``x y z r p y``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode._core import rotate
from polhode.errors import FileFormatError
from polhode.files.xml_source import Edit, Element, blanks_of, set_text
from polhode.robots.model import Inertial, Link, Place, Shape, numbers, unit
from polhode.robots.sdf_include import included
from polhode.robots.urdf import LinkReader, forms, roll_pitch_yaw, tensor_text
from polhode.robots.words import quoted

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from polhode.robots.sources import Sources

__all__ = ["links"]

_DEFAULT = {"ixx": "1", "iyy": "1", "izz": "1", "ixy": "0", "ixz": "0", "iyz": "0"}
_SIZES = {
    "box": (("size", 3),),
    "sphere": (("radius", 1),),
    "cylinder": (("radius", 1), ("length", 1)),
    "capsule": (("radius", 1), ("length", 1)),
    "ellipsoid": (("radii", 3),),
}


def links(root: Element, sources: Sources) -> Iterator[Link]:
    """Read the links of every model, those of included files too."""
    return _below(root, sources, sources.folder, "")


def _below(parent: Element, sources: Sources, folder: Path, prefix: str) -> Iterator[Link]:
    for element in parent.children:
        if element.tag == "include" and element.find("uri") is not None:
            yield from included(element, sources, folder, prefix, _below)
            continue
        if element.tag != "link":
            yield from _below(element, sources, folder, prefix)
            continue
        declared = element.find("inertial")
        inferred = declared is not None and declared.attributes.get("auto", "false").lower() in ("true", "1")
        reader = LinkReader(_inertial, _shapes, _rewrite)
        yield reader.read(element, sources, folder, prefix, inferred=inferred)


def _pose(element: Element | None) -> Place:
    if element is None or not element.text.strip():
        return Place.here()
    if element.attributes.get("relative_to"):
        frame = quoted(element.attributes["relative_to"])
        raise FileFormatError(
            f"{element.where}: a pose relative to {frame} is not followed; give it in the link"
        )
    if element.attributes.get("rotation_format", "euler_rpy") == "quat_xyzw":
        values = numbers(element, element.text, 7, "pose")
        turn = unit(element, values[3:])
        return Place(np.stack([rotate(turn, axis) for axis in np.eye(3)], axis=-1), values[:3])
    values = numbers(element, element.text, 6, "pose")
    in_degrees = element.attributes.get("degrees", "false").lower() in ("true", "1")
    angles = np.deg2rad(values[3:]) if in_degrees else values[3:]
    return Place(roll_pitch_yaw(angles), values[:3])


def _value(parent: Element, name: str, count: int, default: str | None = None) -> tuple[float, ...]:
    element = parent.find(name)
    if element is None and default is None:
        raise FileFormatError(f"{parent.where}: <{parent.tag}> without <{name}>; add it")
    text = default if element is None else element.text
    values: tuple[float, ...] = tuple(numbers(element or parent, text, count, name).tolist())
    return values


def _inertial(element: Element) -> Inertial:
    place = _pose(element.find("pose"))
    (mass,) = _value(element, "mass", 1, "1")
    inertia = element.find("inertia")
    parts = {
        name: float(default) if inertia is None else _value(inertia, name, 1, default)[0]
        for name, default in _DEFAULT.items()
    }
    tensor = np.array(
        [
            [parts["ixx"], parts["ixy"], parts["ixz"]],
            [parts["ixy"], parts["iyy"], parts["iyz"]],
            [parts["ixz"], parts["iyz"], parts["izz"]],
        ]
    )
    return Inertial(mass, place.position, place.rotation @ tensor @ place.rotation.T)


def _shapes(link: Element) -> Iterator[Shape]:
    for role, element, form in forms(link):
        pose = element.find("pose")
        if pose is not None and pose.attributes.get("relative_to"):
            yield Shape("pose in another frame", (), Place.here(), role, where=element.where)
            continue
        place = _pose(pose)
        if form.tag in _SIZES:
            size = tuple(x for name, count in _SIZES[form.tag] for x in _value(form, name, count))
            yield Shape(form.tag, size, place, role, where=form.where)
        elif form.tag == "mesh" and form.find("submesh") is None:
            uri = form.find("uri")
            address = uri.text.strip() if uri is not None else ""
            scale = _value(form, "scale", 3, "1 1 1")
            yield Shape("mesh", scale, place, role, mesh=address, where=form.where)
        else:
            kind = form.tag if form.tag != "mesh" else "part of a mesh"
            yield Shape(kind, (), place, role, where=form.where)


def _rewrite(declared: Element, source: bytes, new: Inertial) -> list[Edit]:
    """Write mass properties with the axes of the link."""
    pose_text = " ".join(repr(float(x) + 0.0) for x in (*new.center_of_mass, 0.0, 0.0, 0.0))
    texts = tensor_text(new.inertia)
    edits, additions = [], ""
    pose, inertia = declared.find("pose"), declared.find("inertia")
    if pose is not None:
        edits.append(Edit(pose.start, pose.end, f"<pose>{pose_text}</pose>"))
    elif np.any(new.center_of_mass):
        additions += f"<pose>{pose_text}</pose>"
    if inertia is None:
        additions += "<inertia>" + "".join(f"<{n}>{t}</{n}>" for n, t in texts.items()) + "</inertia>"
    else:
        absent = ""
        for name, text in texts.items():
            element = inertia.find(name)
            if element is not None:
                edits.append(set_text(element, text))
            elif text != _DEFAULT[name]:
                absent += f"<{name}>{text}</{name}>"
        if absent:
            edits.append(_inserted(source, inertia, absent))
    if additions:
        edits.append(_inserted(source, declared, additions))
    return edits


def _inserted(source: bytes, parent: Element, text: str) -> Edit:
    """Put elements before the first child, behind the same blanks."""
    if parent.inside == parent.end:
        return Edit(parent.start, parent.end, f"<{parent.tag}>{text}</{parent.tag}>")
    first = parent.children[0].start if parent.children else parent.outside
    return Edit(first, first, text + blanks_of(source[parent.inside : first]))
