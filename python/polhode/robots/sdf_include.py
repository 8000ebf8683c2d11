"""``<include>`` of SDF: models in files and folders of their own."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from polhode.errors import FileFormatError
from polhode.robots import urdf
from polhode.robots.model import Link
from polhode.robots.words import shortened

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from polhode.files.xml_source import Element
    from polhode.robots.sdf import Scope
    from polhode.robots.sources import Sources

    Reader = Callable[[Element, Sources, Scope], Iterator[Link]]

__all__ = ["check_version", "included", "is_true", "text_of"]

# What nearly every world of Gazebo includes, from its own folders: lights, and a static plane.
_WITHOUT_LINKS: Final = frozenset({"sun", "ground_plane"})
_ROOTS: Final = frozenset({"sdf", "robot", "gazebo", "world", "model"})


def included(include: Element, sources: Sources, scope: Scope, read_links: Reader) -> Iterator[Link]:
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
    uri = text_of(include, "uri")
    if uri.startswith(("http://", "https://")):
        sources.notes[f"{shortened(uri)} is not judged: nothing is fetched from a network"] = None
        return
    try:
        path = _located(include, uri, sources, scope.folder)
        root = sources.read(path, uri, include)
        if root.tag == "mujoco":
            sources.notes[f"{shortened(uri)} is not judged: it is MJCF, to be checked for itself"] = None
            return
        if root.tag not in _ROOTS:
            found = f"the root of {shortened(uri)} is <{shortened(root.tag)}>"
            raise FileFormatError(f"{include.where}: {found}, not <sdf> or <robot>; check the file")
        check_version(root, f"{include.where}: {shortened(uri)}")
    except FileFormatError as error:
        if uri.removeprefix("model://").strip("/") in _WITHOUT_LINKS:
            sources.notes[f"{shortened(uri)} is not judged: Gazebo's own, of which nothing moves"] = None
            return
        name = sources.name(scope.prefix, f"(include of {include.where})", include)
        is_static = scope.is_static or is_true(include, "static")
        yield Link(name, include.line, None, str(error), file=include.file, is_static=is_static)
        return
    with sources.inside(path, uri, include):
        model = next(root.descendants("model"), root)
        name = text_of(include, "name") or model.attributes.get("name", "")
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
        else:
            yield from read_links(root, sources, inner)


def check_version(root: Element, name: str) -> None:
    """Refuse SDF before 1.2, whose root is ``<gazebo>`` as in 1.2: its values are attributes."""
    if root.tag == "gazebo" and root.attributes.get("version", "1.0") in ("1.0", "1.1"):
        raise FileFormatError(
            f"{name}: is SDF before 1.2, whose values are attributes; export it as SDF 1.2 or later"
        )


def _located(include: Element, uri: str, sources: Sources, folder: Path) -> Path:
    """Find the file that an address means: itself, or the newest that a model's folder offers."""
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
        raise FileFormatError(f"{include.where}: {shortened(uri)} {reason}")
    return path


def text_of(parent: Element, tag: str) -> str:
    """Give the text of a child; "" where there is none."""
    element = parent.find(tag)
    return element.text.strip() if element is not None else ""


def is_true(parent: Element, tag: str, attributes: dict[str, str] | None = None) -> bool:
    """Tell whether a child, or an attribute, says yes."""
    text = text_of(parent, tag) if attributes is None else attributes.get(tag, "")
    return text.lower() in ("true", "1")


def _newest(root: Element, config: Path) -> str:
    """Give the name of the newest file that a ``model.config`` offers."""
    offered = sorted(root.all("sdf"), key=_version)
    if not offered:
        raise FileFormatError(f"{config}: names no <sdf>; add the name of its file")
    return offered[-1].text.strip()


def _version(sdf: Element) -> tuple[int, ...]:
    numbers = sdf.attributes.get("version", "0").split(".")
    return tuple(int(number) if number.isdecimal() and len(number) < 10 else 0 for number in numbers)
