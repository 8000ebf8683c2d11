"""The pages of the interface: one for each class and module that ``docs/interface.toml`` names."""

from __future__ import annotations

import importlib
import inspect
import re
import tomllib
import types
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from written import keep

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sphinx.application import Sphinx

Table = dict[str, Any]


def setup(app: Sphinx) -> dict[str, bool]:
    """Write the pages before Sphinx looks for them."""
    app.connect("builder-inited", lambda app: write(Path(app.srcdir)))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def write(docs: Path) -> None:
    """Write all pages into ``docs/interface``, and take away those of names that are gone."""
    keep(docs / "interface", dict(pages(tomllib.loads((docs / "interface.toml").read_text("utf-8")))))


def pages(table: Table) -> Iterator[tuple[str, str]]:
    """Return the name and the text of each page."""
    listing = [INTRODUCTION]
    for group, names in table["groups"].items():
        listing += [f"\n## {group}\n", "| page | what |", "|---|---|"]
        for name in names:
            value = found(name)
            short = name.removeprefix("polhode.")
            listing.append(f"| [{short}]({short}.md) | {summary(value)} |")
            parts = table["parts"].get(name, {})
            yield f"{short}.md", page(name, value, table, parts)
            for title, members in parts.items():
                stem = f"{short}.{title.lower().replace(' ', '_')}"
                listing.append(f"| [{short}: {title.lower()}]({stem}.md) | {listed(members)} |")
                yield f"{stem}.md", part(name, value, title, members)
    listing += ["\n```{toctree}\n:hidden:\n:glob:\n", "*\n```\n"]
    yield "index.md", "\n".join(listing)


INTRODUCTION = """# Interface

Arguments broadcast over leading axes: a body may be a stack of bodies, a vector an array of shape (…, 3).
In a shape, the dots stand for these axes. Results have the same leading axes.

What all pages have in common ([conventions](../conventions.md), [glossary](../glossary.md)):

- **Units.** Any consistent units will do. Angles are in radians, angular velocities in radians per unit of
  time.
- **Frames.** Components are in the *body frame* B or *in space*, that is, in the inertial frame N.
- **Attitude.** R_NB turns components in the body into components in space, ``v_N = R_NB v_B``. Quaternions
  are (x, y, z, w).
- **Symbols.** O is the origin of the body frame, C the centre of mass, I the inertia tensor, ω the angular
  velocity, L the angular momentum, T the kinetic energy, m the mass. Axes 1, 2 and 3 are the principal axes
  in the order of ascending moments. ε = 2.2·10⁻¹⁶ is the rounding of float64."""


def page(name: str, value: object, table: Table, parts: dict[str, list[str]]) -> str:
    """Return the page of a class or of a module."""
    short = name.removeprefix("polhode.")
    lines = [f"# {short}\n"]
    if name in table["pictures"]:
        file, shows = table["pictures"][name]
        lines.append(f"![{shows}](../{file})\n")
    for title, members in parts.items():
        lines.append(f"- [{title}]({short}.{title.lower().replace(' ', '_')}.md): {listed(members)}")
    lines.append("\n```{eval-rst}")
    apart = {member for members in parts.values() for member in members}
    if inspect.isclass(value):
        lines += of_class(name, value, apart)
    else:
        assert isinstance(value, types.ModuleType)
        lines.append(f".. automodule:: {name}\n   :no-members:\n")
        for export in table["names"].get(name, value.__all__):
            if export not in apart:
                lines += of_name(f"{name}.{export}", getattr(value, export))
    for function in table["beside"].get(name, ()):
        lines.append(f"\n.. autofunction:: polhode.{function}\n")
    return "\n".join([*lines, "```\n"])


def part(name: str, value: object, title: str, members: list[str]) -> str:
    """Return the page of some members of a class or of a module."""
    short = name.removeprefix("polhode.")
    lines = [f"# {short}: {title.lower()}\n", f"Of [{short}]({short}.md).\n", "```{eval-rst}"]
    for member in members:
        if inspect.isclass(value):
            kind = "method" if inspect.isroutine(getattr(value, member)) else "attribute"
            lines.append(f".. auto{kind}:: {name}.{member}\n")
        else:
            lines += of_name(f"{name}.{member}", getattr(value, member))
    return "\n".join([*lines, "```\n"])


def of_class(name: str, cls: type, apart: set[str]) -> list[str]:
    """Return the directive of a class; of one without methods its fields are described by the class."""
    held: dict[str, object] = {}  # its own members first, then those of its bases, which have no pages
    for base in cls.__mro__:
        if base.__module__.startswith("polhode"):
            held = {**vars(base), **held}
    fields = {k for k, v in held.items() if type(v).__name__ in {"member_descriptor", "_tuplegetter"}}
    fields |= set(getattr(cls, "__dataclass_fields__", ()))
    members = [
        k
        for k, v in held.items()
        if not k.startswith("_")
        and k not in fields | apart
        and (
            callable(v)
            or inspect.isdatadescriptor(v)
            or isinstance(v, cached_property | staticmethod | classmethod)
        )
    ]
    lines = [f".. autoclass:: {name}"]
    if members:
        lines.append(f"   :members: {', '.join(members)}")
    return [*lines, ""]


def of_name(name: str, value: object) -> list[str]:
    """Return the directive of what a module holds."""
    if inspect.isclass(value):
        return of_class(name, value, set())
    if callable(value):
        return [f".. autofunction:: {name}", ""]
    # Not by autodata, which would show what the type of the value says of itself.
    home, _, last = name.rpartition(".")
    return [f".. py:data:: {last}", f"   :module: {home}", "", f"   {DATA[name]}", ""]


DATA = {
    "polhode.io.BODY_SCHEMA": "JSON Schema of the JSON file of a body, as a dict.",
    "polhode.io.TRAJECTORY_SCHEMA": "JSON Schema of the JSON file of a motion, as a dict.",
    "polhode.plot.AXIS_COLORS": "Colours of the three principal axes and of components along them.",
    "polhode.plot.MOMENTUM_COLOR": "Colour of the angular momentum.",
    "polhode.plot.OMEGA_COLOR": "Colour of the angular velocity.",
    "polhode.plot.OUTLINE_COLOR": "Colour of the edges of bodies.",
    "polhode.animation.ANIMATION_SUFFIXES": "Endings of the files that :func:`animate` can write.",
    "polhode.units.METRES": "Metres in one of each unit, as a mapping of names to exact numbers.",
}
"""What the values of modules are; each needs a line here."""


def found(name: str) -> object:
    """Return the class or the module of a dotted name."""
    home, _, last = name.rpartition(".")
    if last[0].isupper():
        return getattr(importlib.import_module(home), last)
    return importlib.import_module(name)


def summary(value: object) -> str:
    """Return the first sentence of what it says of itself, on one line."""
    text = " ".join((inspect.getdoc(value) or "").split("\n\n")[0].split())
    text = re.sub(r":\w+:`~?([^`]+)`", r"`\1`", text)  # a reference, as a name
    return text.replace("|", "\\|").replace("``", "`")


def listed(members: list[str]) -> str:
    """Return names as code, with commas between them."""
    return ", ".join(f"`{member}`" for member in members)
