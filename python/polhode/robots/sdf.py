"""SDF: ``<sdf>`` with models of ``<link>`` elements; values are texts of elements, poses ``x y z r p y``."""

from __future__ import annotations

import re
from collections import Counter
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Final, Literal, NamedTuple

import numpy as np

from polhode._core import rotate
from polhode._format import Note
from polhode.errors import FileFormatError
from polhode.io.xml_source import Edit, Element
from polhode.robots import urdf
from polhode.robots.edits import first_child, indent_element, number_text, text_of
from polhode.robots.model import (
    WORLD,
    Inertial,
    Joint,
    Link,
    Place,
    Shape,
    Spot,
    numbers,
    quote,
    scale,
    shorten,
    unit,
)
from polhode.robots.urdf import LinkReader, forms, roll_pitch_yaw, tensor_text

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from polhode.robots.sources import Sources

    Reader = Callable[[Element, Sources, "Scope"], Iterator[Link]]

__all__ = [
    "check_version",
    "child_text",
    "is_true",
    "links",
    "read_include",
]

_WATER = "1000"
_SETS = {
    "mass": "without <mass> the format sets 1 kg",
    "inertia": "without <inertia> the format sets the unit tensor",
}
_COMMA = re.compile(r",(?=\s|$)")
_DEFAULT = {"ixx": "1", "iyy": "1", "izz": "1", "ixy": "0", "ixz": "0", "iyz": "0"}
_SIZES = {
    "box": (("size", 3),),
    "sphere": (("radius", 1),),
    "cylinder": (("radius", 1), ("length", 1)),
    "capsule": (("radius", 1), ("length", 1)),
    "ellipsoid": (("radii", 3),),
}


class Scope(NamedTuple):
    """Context of elements: their folder, the prefix of their names, and whether their model is static.

    Attributes
    ----------
    folder : pathlib.Path
    prefix : str
        Of the names of links as they are shown.
    path : str
        The models around, as joints name them: ``"arm::hand::"``.
    is_static : bool
    is_named : bool
        Whether the path names the model already that comes next, as an ``<include>`` does.
    """

    folder: Path
    prefix: str = ""
    path: str = ""
    is_static: bool = False
    is_named: bool = False


def links(root: Element, sources: Sources) -> Iterator[Link]:
    """Read the links of every model, those of included files too, and their joints."""
    found = list(below(root, sources, Scope(sources.folder)))
    keys = dict.fromkeys(link.key for link in found)
    count = Counter(link.name for link in found)
    found = [
        replace(link, name=link.key) if count[link.name] > 1 and not link.file else link for link in found
    ]
    sources.joints[:] = [
        joint._replace(
            parent=_resolve_link(joint.parent, keys, sources.frames),
            child=_resolve_link(joint.child, keys, sources.frames),
        )
        for joint in sources.joints
    ]
    yield from found


def below(parent: Element, sources: Sources, scope: Scope) -> Iterator[Link]:
    """Read the links below an element.

    What else holds elements named so, <state>, <plugin>, <actor>, tells of links that stand elsewhere or that
    no physics moves.
    """
    for element in parent.children:
        tag = element.tag
        if tag == "include" and element.find("uri") is not None:
            yield from read_include(element, sources, scope, below)
        elif tag == "link":
            yield _link(element, sources, scope)
        elif tag == "joint":
            sources.joints.append(_joint(element, scope))
        elif tag == "frame":
            name, target = (element.attributes.get(which, "") for which in ("name", "attached_to"))
            sources.frames[scope.path + name] = scope.path + target
        elif tag == "model":
            own = "" if scope.is_named else f"{element.attributes.get('name', '')}::"
            is_static = scope.is_static or is_true(element, "static")
            inner = scope._replace(path=scope.path + own, is_static=is_static, is_named=False)
            yield from below(element, sources, inner)
        elif tag in ("world", "population"):
            yield from below(element, sources, scope)
        elif tag == "actor" and element.find("link") is not None:
            sources.notes["links of an <actor> follow its script and are not judged"] = None
        elif tag == "state" and element.find("insertions") is not None:
            sources.notes["what <state> inserts into the world is not judged"] = None


def _link(element: Element, sources: Sources, scope: Scope) -> Link:
    own = element.attributes.get("name", "")
    for inside in element.children:
        for pose in inside.descendants("pose"):
            if own and pose.attributes.get("relative_to") == own:  # as it is without
                del pose.attributes["relative_to"]
    declared = element.find("inertial")
    inferred = declared is not None and is_true(declared, "auto", declared.attributes)
    link = LinkReader(_inertial, _shapes, _rewrite).read(
        element, sources, scope.folder, scope.prefix, inferred=inferred
    )
    defaults, inertial = "", link.inertial
    if declared is None:
        defaults = "without <inertial> the format sets 1 kg and the unit tensor"
        inertial = Inertial(1.0, np.zeros(3), np.eye(3))
    elif inertial is not None:
        absent = [tag for tag in ("mass", "inertia") if declared.find(tag) is None]
        defaults = " and ".join(_SETS[tag] for tag in absent)
    reach = 0.0
    with suppress(FileFormatError):
        reach = float(np.linalg.norm(_pose(element.find("pose")).position))
    key = scope.path + own
    return replace(
        link,
        inertial=inertial,
        key=key,
        defaults=defaults,
        is_static=scope.is_static,
        reach=reach,
        own_name="" if element.file else key,
    )


def _joint(element: Element, scope: Scope) -> Joint:
    parent, child = (child_text(element, tag) for tag in ("parent", "child"))
    ends = (name if name == WORLD else scope.path + name for name in (parent, child))
    return Joint(element.attributes.get("name", ""), element.attributes.get("type", ""), *ends)


def _resolve_link(name: str, keys: dict[str, None], frames: dict[str, str]) -> str:
    """Find the link of a joint: by the name of the link, of a frame on it, or of its model."""
    for _ in range(len(frames) + 1):
        if name in keys or name == WORLD or name not in frames:
            break
        name = frames[name]
    if name in keys or name == WORLD:
        return name
    inside = name.removesuffix("__model__").removesuffix("::") + "::"
    return next((key for key in keys if key.startswith(inside)), name)


def _pose(element: Element | None) -> Place:
    if element is None or not element.text.strip():
        return Place.identity()
    if element.attributes.get("relative_to"):
        frame = quote(element.attributes["relative_to"])
        raise FileFormatError(
            f"{element.where}: a pose relative to {frame} is not followed; give it in the link"
        )
    if element.attributes.get("rotation_format", "euler_rpy") == "quat_xyzw":
        values = numbers(element, _without_commas(element.text), 7, "pose")
        turn = unit(element, values[3:])
        return Place(np.stack([rotate(turn, axis) for axis in np.eye(3)], axis=-1), values[:3])
    values = numbers(element, _without_commas(element.text), 6, "pose")
    in_degrees = element.attributes.get("degrees", "false").lower() in ("true", "1")
    angles = np.deg2rad(values[3:]) if in_degrees else values[3:]
    return Place(roll_pitch_yaw(angles), values[:3])


def _without_commas(text: str) -> str:
    """Remove the commas from the numbers of a pose, as libsdformat does; it reads ``0,0`` as one number."""
    return _COMMA.sub("", text)


def _value(parent: Element, name: str, count: int, default: str | None = None) -> tuple[float, ...]:
    element = parent.find(name)
    if element is None and default is None:
        raise FileFormatError(Spot(parent, ""), f": <{parent.tag}> without <{name}>; add it")
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
    declared = link.find("inertial")
    is_inferred = declared is not None and is_true(declared, "auto", declared.attributes)
    (of_link,) = _value(declared or link, "density", 1, _WATER) if is_inferred else (1.0,)
    for role, element, form in forms(link):
        try:
            shape = _shape(element, form, role)
            if is_inferred and role == "collision":
                shape = replace(shape, density=_value(element, "density", 1, repr(of_link))[0])
            yield shape
        except FileFormatError as error:
            if role == "collision":
                raise
            yield Shape(form.tag, (), Place.identity(), role, where=form.where, problem=Note(*error.args))


def _shape(element: Element, form: Element, role: Literal["collision", "visual"]) -> Shape:
    pose = element.find("pose")
    if pose is not None and pose.attributes.get("relative_to"):
        return Shape("pose in another frame", (), Place.identity(), role, where=element.where)
    place = _pose(pose)
    if form.tag in _SIZES:
        size = tuple(x for name, count in _SIZES[form.tag] for x in _value(form, name, count))
        return Shape(form.tag, size, place, role, where=form.where)
    if form.tag == "mesh" and form.find("submesh") is None:
        factors = scale(form.find("scale") or form, child_text(form, "scale") or "1")
        address = child_text(form, "uri") or child_text(form, "filename")  # as it is called in SDF 1.2
        return Shape("mesh", factors, place, role, mesh=address, where=form.where)
    kind = form.tag if form.tag != "mesh" else "part of a mesh"
    return Shape(kind, (), place, role, where=form.where)


def _rewrite(link: Element, declared: Element | None, source: bytes, new: Inertial) -> list[Edit]:
    """Write mass properties with the axes of the link."""
    pose_text = number_text((*new.center_of_mass, 0.0, 0.0, 0.0))
    texts = tensor_text(new.inertia)
    if declared is None:
        parts = [f"<pose>{pose_text}</pose>"] if np.any(new.center_of_mass) else []
        parts += [f"<mass>{new.mass!r}</mass>", _inertia(texts)]
        return [first_child(source, link, indent_element(source, link, "<inertial>", parts, "</inertial>"))]
    edits, additions = [], ""
    pose, mass, inertia = (declared.find(tag) for tag in ("pose", "mass", "inertia"))
    if pose is not None:
        edits.append(Edit(pose.start, pose.end, f"<pose>{pose_text}</pose>"))
    elif np.any(new.center_of_mass):
        additions += f"<pose>{pose_text}</pose>"
    if mass is not None:
        edits += text_of(mass, repr(new.mass))
    elif new.mass != 1.0:
        additions += f"<mass>{new.mass!r}</mass>"
    if inertia is None:
        additions += _inertia(texts)
    else:
        absent = ""
        for name, text in texts.items():
            element = inertia.find(name)
            if element is not None:
                edits += text_of(element, text)
            elif float(text) != float(_DEFAULT[name]):
                absent += f"<{name}>{text}</{name}>"
        if absent:
            edits.append(first_child(source, inertia, absent))
    if additions:
        edits.append(first_child(source, declared, additions))
    return edits


def _inertia(texts: dict[str, str]) -> str:
    return "<inertia>" + "".join(f"<{n}>{t}</{n}>" for n, t in texts.items()) + "</inertia>"


# What nearly every world of Gazebo includes, from its own folders: lights, and a static plane.
_WITHOUT_LINKS: Final = frozenset({"sun", "ground_plane"})
_ROOTS: Final = frozenset({"sdf", "robot", "gazebo", "world", "model"})


def read_include(include: Element, sources: Sources, scope: Scope, read_links: Reader) -> Iterator[Link]:
    """Read the links of an included model; one that is not found is a link that cannot be read.

    Parameters
    ----------
    include : Element
    sources : Sources
    scope : Scope
        Where it stands.
    read_links : callable
        Reads those below an element.
    """
    uri = child_text(include, "uri")
    if uri.startswith(("http://", "https://")):
        sources.notes[f"{shorten(uri)} is not judged: nothing is fetched from a network"] = None
        return
    try:
        path = _find_model_file(include, uri, sources, scope.folder)
        root = sources.read(path, uri, include)
        if root.tag == "mujoco":
            sources.notes[f"{shorten(uri)} is not judged: it is MJCF, to be checked for itself"] = None
            return
        if root.tag not in _ROOTS:
            found = f"the root of {shorten(uri)} is <{shorten(root.tag)}>"
            raise FileFormatError(f"{include.where}: {found}, not <sdf> or <robot>; check the file")
        check_version(root, f"{include.where}: {shorten(uri)}")
    except FileFormatError as error:
        if uri.removeprefix("model://").strip("/") in _WITHOUT_LINKS:
            sources.notes[f"{shorten(uri)} is not judged: Gazebo's own, of which nothing moves"] = None
            return
        name = sources.name(scope.prefix, f"(include of {include.where})", include)
        is_static = scope.is_static or is_true(include, "static")
        yield Link(
            name,
            include.line,
            None,
            Note(*error.args),
            file=include.file,
            is_static=is_static,
            own_name=f"include of {uri}",
            element=include,
        )
        return
    with sources.inside(path, uri, include):
        model = next(root.descendants("model"), root)
        name = child_text(include, "name") or model.attributes.get("name", "")
        own = "" if is_true(include, "merge", include.attributes) or not name else f"{name}::"
        inner = scope._replace(
            folder=path.parent,
            prefix=sources.prefix(scope.prefix + own),
            path=scope.path + own,
            is_static=scope.is_static or is_true(include, "static"),
            is_named=True,
        )
        if root.tag == "robot":
            for link in urdf.links(root, sources, path.parent, inner.prefix, inner.path):
                yield replace(link, is_static=inner.is_static)
            return
        own_model = model.attributes.get("name", "")
        for link in read_links(root, sources, inner):
            # As where its own file is judged: by the name that this gives to its model.
            below = link.key.removeprefix(inner.path)
            yield link if link.own_name else replace(link, own_name=f"{own_model}::{below}")


def check_version(root: Element, name: str) -> None:
    """Refuse SDF before 1.2, whose root is ``<gazebo>`` as in 1.2: its values are attributes."""
    if root.tag == "gazebo" and root.attributes.get("version", "1.0") in ("1.0", "1.1"):
        raise FileFormatError(
            f"{name}: is SDF before 1.2, whose values are attributes; export it as SDF 1.2 or later"
        )


def _find_model_file(include: Element, uri: str, sources: Sources, folder: Path) -> Path:
    """Find the file of an address: the file itself, or the newest one in the folder of a model."""
    path, fault = sources.addresses.find(uri, folder)
    if path is None and not fault and "://" not in uri:  # the bare name of a model in a folder of models
        path, fault = sources.addresses.find(f"model://{uri}", folder)
    if path is not None and path.is_dir():
        home = path
        path, fault = sources.addresses.find("model.config", home)
        if path is not None:
            path, fault = sources.addresses.find(_newest(sources.read(path, str(path), include), path), home)
        elif not fault:
            path, fault = sources.addresses.find("model.sdf", home)
    if path is None or not path.is_file():
        reason = fault or "was not found; name the folder that holds it with --packages"
        raise FileFormatError(f"{include.where}: {shorten(uri)} ", reason)
    return path


def child_text(parent: Element, tag: str) -> str:
    """Return the text of a child; "" where there is none."""
    element = parent.find(tag)
    return element.text.strip() if element is not None else ""


def is_true(parent: Element, tag: str, attributes: dict[str, str] | None = None) -> bool:
    """Return whether a child, or an attribute, says yes."""
    text = child_text(parent, tag) if attributes is None else attributes.get(tag, "")
    return text.lower() in ("true", "1")


def _newest(root: Element, config: Path) -> str:
    """Return the name of the newest file that a ``model.config`` offers."""
    offered = sorted(root.all("sdf"), key=_version)
    if not offered:
        raise FileFormatError(f"{config}: names no <sdf>; add the name of its file")
    return offered[-1].text.strip()


def _version(sdf: Element) -> tuple[int, ...]:
    numbers = sdf.attributes.get("version", "0").split(".")
    return tuple(int(number) if number.isdecimal() and len(number) < 10 else 0 for number in numbers)
