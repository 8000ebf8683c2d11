"""The body of the solids in a CAD file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from polhode import _core
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode._typing import SupportsSigma
    from polhode.files.cad_file import CadFile
    from polhode.files.cad_moments import Moments

    Floats = NDArray[np.float64]
    Number = float | _core.Uncertain | SupportsSigma

__all__ = ["SolidPart", "solids_of"]

_METRE: Final = 1e-3
"""OCCT gives millimetres, whatever the file has."""
_BOUNDS: Final = slice(22, 25)
_PROVENANCE: Final = slice(25, 28)
_SOLID: Final = (10, 1, 4 + 8 + 32 + 64)
"""One solid, checked: finite, closed, orientation, volume."""


class SolidPart(NamedTuple):
    """One solid of a CAD file, at its place.

    Attributes
    ----------
    name : str
        The assemblies that it is in before it: ``"pump/rotor"``.
    material : str
        ``""`` where the file names none.
    body : RigidBody
        In kg and m.
    volume : float
        In m^3.
    """

    name: str
    material: str
    body: _core.RigidBody
    volume: float


def solids_of(
    cad: CadFile, density: Number | None = None, mass: Number | None = None
) -> tuple[_core.RigidBody, tuple[SolidPart, ...]]:
    """Give the whole and its parts.

    Parameters
    ----------
    cad : CadFile
    density, mass : float or Uncertain, optional
        At most one: of every part, or of the whole. Without `density` each part has that of its material;
        without materials `mass` goes by volume.

    Raises
    ------
    PolhodeError
        Where neither is given and a part has no density of its own.
    """
    if density is not None and mass is not None:
        raise PolhodeError("density and mass: give one of the two, since the other follows from the volume")
    own = [part.density for part in cad.parts]
    if density is None and mass is None and None in own:
        nameless = cad.parts[own.index(None)].name
        raise PolhodeError(f"density or mass is needed: {nameless!r} has no density in the file; give one")
    uses_own = density is None and None not in own
    known: dict[int, _core.RigidBody] = {}
    parts = []
    for part in cad.parts:
        key = id(part.moments)
        if key not in known:
            known[key] = _at_density_1(part.moments)
        placed = known[key].rotated(_quaternion(part.rotation)).translated(part.position * _METRE)
        weight: Number = part.density if uses_own and part.density is not None else 1.0
        weight = weight if density is None else density
        parts.append(
            SolidPart(part.name, part.material, placed.scaled(mass=weight), part.moments.volume * _METRE**3)
        )
    whole = sum((part.body for part in parts[1:]), start=parts[0].body)
    if mass is not None:
        total = whole.mass
        parts = [part._replace(body=part.body.scaled(mass=1.0 / total).scaled(mass=mass)) for part in parts]
        whole = whole.scaled(mass=1.0 / total).scaled(mass=mass)
    return whole, tuple(parts)


def _quaternion(rotation: Floats) -> Floats:
    return _core.quaternion_from_matrix(rotation)


def _at_density_1(moments: Moments) -> _core.RigidBody:
    """Give the body of a solid before it is placed, with the bounds of the integration."""
    volume, reach = moments.volume, moments.reach
    offset = moments.first / volume
    spread = moments.second - np.outer(offset, offset) * volume
    tensor = np.trace(spread) * np.eye(3) - spread
    body = _core.RigidBody(
        mass=volume * _METRE**3,
        inertia=tensor * _METRE**5,
        center_of_mass=(moments.about + offset) * _METRE,
    )
    share = float(np.abs(offset).max()) / reach
    of_center = moments.error * reach * (1.0 + share) / volume
    of_tensor = 3.0 * moments.error * reach**2 * (1.0 + share) ** 2
    numbers = np.array(body.__reduce__()[1][0], dtype=np.float64)
    numbers[_BOUNDS] = moments.error * _METRE**3, of_center * _METRE, of_tensor * _METRE**5
    numbers[_PROVENANCE] = _SOLID
    return _core.RigidBody._from_numbers(numbers)
