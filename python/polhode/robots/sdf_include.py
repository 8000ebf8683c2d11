"""``<include>`` of SDF: models in files and folders of their own."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from polhode._files.reading import read_bytes
from polhode._files.xml_source import parse_xml
from polhode.errors import FileFormatError
from polhode.robots import urdf
from polhode.robots.model import Link

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from polhode._files.xml_source import Element
    from polhode.robots.sources import Sources

    Reader = Callable[[Element, Sources, Path, str], Iterator[Link]]

__all__ = ["included"]


def included(
    include: Element, sources: Sources, folder: Path, prefix: str, read_links: Reader
) -> Iterator[Link]:
    """Read the links of an included model; one that is not found is a link that cannot be read.

    Parameters
    ----------
    include : Element
    sources : Sources
    folder : pathlib.Path
        Where a relative address starts.
    prefix : str
        Of the names of the links.
    read_links : callable
        Reads those below an element.
    """
    uri = _text(include, "uri")
    if uri.startswith(("http://", "https://")):
        sources.notes[f"{uri} is not judged: nothing is fetched from a network"] = None
        return
    path = sources.addresses.find(uri, folder)
    if path is not None and path.is_dir():
        path = _model_file(path)
    if path is None or not path.is_file():
        problem = f"{include.where}: {uri} was not found; name the folder that holds it with --packages"
        yield Link(f"{prefix}(include of {include.where})", include.line, None, problem, file=include.file)
        return
    root = sources.read(path, uri, include)
    with sources.inside(path, uri, include):
        model = next(root.descendants("model"), root)
        name = _text(include, "name") or model.attributes.get("name", "")
        is_merged = include.attributes.get("merge", "false").lower() in ("true", "1")
        inner = prefix if is_merged or not name else f"{prefix}{name}::"
        if root.tag == "robot":
            for link in urdf.links(root, sources):
                yield replace(link, name=inner + link.name, folder=path.parent)
        else:
            yield from read_links(root, sources, path.parent, inner)


def _text(parent: Element, tag: str) -> str:
    element = parent.find(tag)
    return element.text.strip() if element is not None else ""


def _model_file(folder: Path) -> Path | None:
    """Find the newest file that a model's folder offers."""
    config = folder / "model.config"
    if config.is_file():
        root = parse_xml(read_bytes(config), str(config))
        offered = sorted(root.all("sdf"), key=_version)
        if not offered:
            raise FileFormatError(f"{config}: names no <sdf>; add the name of its file")
        return folder / offered[-1].text.strip()
    plain = folder / "model.sdf"
    return plain if plain.is_file() else None


def _version(sdf: Element) -> tuple[int, ...]:
    numbers = sdf.attributes.get("version", "0").split(".")
    return tuple(int(number) if number.isdecimal() else 0 for number in numbers)
