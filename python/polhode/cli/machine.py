"""What a report of a fault has to tell of the machine: versions, instruction set, threads."""

from __future__ import annotations

import platform
import sys
from importlib.metadata import PackageNotFoundError, requires, version
from typing import Final

from polhode import __version__, _core
from polhode.cli.layout import Field

__all__ = ["as_text", "machine_fields"]

#: Distributions of the extras, where their names are others than the modules'.
_NEEDED: Final = ("numpy",)


def machine_fields() -> list[Field]:
    """Versions of what is installed, and what long runs use."""
    level, threads = _core.machine()
    lock = "" if getattr(sys, "_is_gil_enabled", lambda: True)() else ", without the lock of the interpreter"
    libraries = ", ".join(f"{name} {found}" for name, found in _libraries().items())
    return [
        Field("polhode", "polhode", __version__),
        Field("python", "Python", f"{platform.python_implementation()} {platform.python_version()}{lock}"),
        Field("system", "system", platform.platform()),
        Field("processor", "processor", platform.machine()),
        Field("instruction_set", "instruction set", level),
        Field("threads", "threads", threads),
        Field("libraries", "libraries", libraries),
    ]


def as_text() -> str:
    """Give what ``polhode --version --verbose`` prints."""
    fields = machine_fields()
    return "\n".join(f"{field.label:<16} {field.value!s}" for field in fields)


def _libraries() -> dict[str, str]:
    """Give the versions of those libraries that polhode names and that are there."""
    try:
        needs = requires("polhode") or []
    except PackageNotFoundError:  # a source tree on the path
        needs = list(_NEEDED)
    names = sorted({_name(need) for need in needs} - {"polhode"})
    found = {}
    for name in names:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def _name(need: str) -> str:
    """Give the distribution that a requirement names."""
    for stop in range(len(need)):
        if not (need[stop].isalnum() or need[stop] in "-_."):
            return need[:stop]
    return need
