"""Every function, class, method and property that a user can reach, by its dotted name."""

from __future__ import annotations

import importlib
import inspect
import types
from collections.abc import Iterator
from functools import cached_property
from importlib.util import find_spec
from typing import Any

MODULES = [
    "polhode",
    "polhode.assembly",
    "polhode.distributions",
    "polhode.identify",
    "polhode.images",
    "polhode.interop",
    "polhode.laminae",
    "polhode.reductions",
    "polhode.regions",
    "polhode.rods",
    "polhode.rolling",
    "polhode.solids",
    "polhode.validity",
    "polhode.loads",
    "polhode.euler_angles",
    "polhode.equimomental",
    "polhode.errors",
    "polhode.flybys",
    "polhode.animation",
    "polhode.motion.auditing",
    "polhode.motion.events",
    "polhode.io",
    "polhode.motion.free",
    "polhode.kinematics",
    "polhode.orbits",
    "polhode.parallel_axis",
    "polhode.results",
    "polhode.robots",
    "polhode.samples",
    "polhode.tops",
    "polhode.motion.trajectory",
    "polhode.uncertainty",
    "polhode.view",
]

MODULES += ["polhode.symbolic"] if find_spec("sympy") else []


def public_objects() -> Iterator[tuple[str, Any]]:
    """Every function, class, method and property that a user can reach, compiled or not, by dotted name."""
    seen: set[int] = set()
    for module_name in MODULES:
        module = importlib.import_module(module_name)
        yield module_name, module
        for name in module.__all__:
            value = getattr(module, name)
            if isinstance(value, types.ModuleType | str) or id(value) in seen:
                continue
            seen.add(id(value))
            yield f"{module_name}.{name}", value
            if inspect.isclass(value):
                yield from _members(f"{module_name}.{name}", value)


def _members(path: str, cls: type) -> Iterator[tuple[str, Any]]:
    for name, member in sorted(vars(cls).items()):  # two processes that share the tests name them alike
        if name.startswith("_"):
            continue
        is_data = not (
            callable(member) or isinstance(member, property | cached_property | staticmethod | classmethod)
        )
        if is_data and not inspect.isdatadescriptor(member):
            continue
        if type(member).__name__ in {"member_descriptor", "_tuplegetter"}:
            continue  # slots and tuple fields: described by their class
        yield f"{path}.{name}", member


OBJECTS = dict(public_objects())
