"""The one reader of bodies: Python and the command line read every file that holds a body here.

The way to the body of a mesh: ``RigidBody.from_file``, this file, ``formats`` (opens a file and calls the
reader of its format, with ``content``, ``budget`` and ``unpacked``), ``mesh_solid`` (calls the core).
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from polhode._format import Argument
from polhode.errors import PolhodeError
from polhode.io.content import is_molecule
from polhode.io.formats import (
    ASSEMBLY_SUFFIX,
    SAVED_SUFFIXES,
    Whole,
    body_of_molecule,
    check_arguments,
    load,
    read_saved,
    warn,
)
from polhode.io.images import body_of_image, is_image, metres_per_unit, read_image
from polhode.io.mesh_solid import naming_file, solid_of
from polhode.units import metres_per

if TYPE_CHECKING:
    from collections.abc import Callable

    from polhode import _core
    from polhode._core import RigidBody
    from polhode._typing import SupportsSigma
    from polhode.molecules.nuclides import Masses

__all__ = ["body_from_file", "is_whole", "read_whole"]


def body_from_file(
    path: str | os.PathLike[str],
    *,
    density: Any = None,
    mass: float | _core.Uncertain | SupportsSigma | None = None,
    length_unit: str | None = None,
    thickness: float | None = None,
    weld: float = 0.0,
    closure: Literal["caps", "hull"] | None = None,
    orient: bool = False,
    union: bool = False,
    repair: bool = False,
    index_base: int = 1,
    masses: Masses = "most_common",
    progress: Callable[[float], object] | None = None,
) -> RigidBody:
    """Read the body that a file holds: what ``RigidBody.from_file`` does, with its parameters.

    The compiled library calls it. Components of a mesh are not searched for overlaps; ``polhode report`` does
    that.
    """
    for name, value in (("density", density), ("mass", mass)):
        _check_amount(name, value, path)
    if length_unit is not None:
        metres_per(length_unit)
    check_arguments(
        path,
        density=density is not None,
        mass=mass is not None,
        weld=weld != 0.0,
        closure=closure is not None,
        orient=orient,
        union=union,
        repair=repair,
        index_base=index_base != 1,
        masses=masses != "most_common",
        length_unit=length_unit is not None,
        thickness=thickness is not None,
    )
    if is_image(path):
        image = read_image(path)
        scale = metres_per_unit(image, path, length_unit)
        with naming_file(path):
            return body_of_image(image, density, mass, scale)
    if is_whole(path):
        whole = read_whole(path, length_unit)
        warn(path, whole.overlaps)
        return whole.body
    if is_molecule(Path(path)):
        body, _, crossed = body_of_molecule(path, length_unit, masses)
        warn(path, crossed)
        return body
    loaded = load(path, index_base=index_base)
    warn(path, () if loaded.cad is None else loaded.cad.overlaps)
    unit = loaded.length(length_unit)
    scale = 1.0 if unit is None else metres_per(unit)
    if callable(density):
        raise PolhodeError(
            Argument("density"),
            f": {os.fspath(path)} is no image, whose values a function could take; give a number",
        )
    if isinstance(density, Mapping):
        from polhode.io.named_densities import body_by_names

        return body_by_names(
            loaded,
            density,
            scale=scale,
            weld=weld,
            orient=orient,
            progress=progress,
            mass=mass is not None,
            thickness=thickness is not None,
            closure=closure,
            union=union,
            repair=repair,
        )
    return solid_of(
        loaded,
        density=density,
        mass=mass,
        scale=scale,
        weld=weld,
        closure=closure,
        orient=orient,
        union=union,
        repair=repair,
        progress=progress,
        thickness=thickness,
    ).body


def is_whole(path: str | os.PathLike[str]) -> bool:
    """Return whether a file holds a body that needs no shape, by its name."""
    return Path(path).suffix.lower() in (*SAVED_SUFFIXES, ASSEMBLY_SUFFIX)


def read_whole(path: str | os.PathLike[str], length_unit: str | None = None) -> Whole:
    """Read a saved body, a report of one, or an assembly.

    Parameters
    ----------
    path : str or os.PathLike
    length_unit : str, optional
        Unit of length of a saved body, which is then converted to metres.
    """
    if Path(path).suffix.lower() != ASSEMBLY_SUFFIX:
        return read_saved(path, length_unit)
    from polhode.assembly.overlaps import overlap_notes
    from polhode.assembly.reading import read

    made = read(path)
    return Whole(made.body, "assembly", True, made.notes, (*overlap_notes(made.overlaps),))


def _check_amount(name: str, value: object, path: str | os.PathLike[str]) -> None:
    if isinstance(value, str):
        raise TypeError(
            f"{name}: expected a number, got {value!r}; units are read on the command line: "
            f'polhode report {os.fspath(path)} --{name} "{value}"'
        )
