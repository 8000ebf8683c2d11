"""Surfaces of solids that are drawn: closed, outward, with the moments of the solid as they get finer."""

from __future__ import annotations

import numpy as np
import pytest
from polhode import RigidBody, solids
from polhode._scene.solids import solid_surface

SOLIDS: list[tuple[str, tuple[float, ...]]] = [
    ("cuboid", (1.0, 2.0, 3.0)),
    ("cube", (2.0,)),
    ("wedge", (1.0, 2.0, 3.0)),
    ("pyramid", (1.0, 2.0, 3.0)),
    ("tetrahedron", (2.0,)),
    ("cylinder", (1.5, 0.7)),
    ("tube", (0.5, 1.5, 0.7)),
    ("cone", (1.5, 2.0)),
    ("frustum", (1.5, 0.5, 2.0)),
    ("frustum", (1.5, 0.0, 2.0)),
    ("sphere", (1.5,)),
    ("ellipsoid", (1.0, 2.0, 0.5)),
    ("hemisphere", (1.5,)),
    ("capsule", (0.5, 2.0)),
    ("torus", (2.0, 0.5)),
    ("prism", (5, 1.5, 2.0)),
]
BY_SIZE = {"cuboid": "box", "wedge": "wedge", "pyramid": "pyramid", "ellipsoid": "ellipsoid"}
"""Those that take their lengths as one argument."""


@pytest.mark.parametrize(("name", "numbers"), SOLIDS)
def test_it_is_the_solid(name: str, numbers: tuple[float, ...]) -> None:
    make = getattr(solids, BY_SIZE.get(name, name))
    exact = make(numbers, density=2.0) if name in BY_SIZE else make(*numbers, density=2.0)
    off = []
    for segments in (40, 160):
        surface = solid_surface(name, np.array(numbers), segments)
        assert surface is not None
        drawn = RigidBody.from_mesh(*surface, density=2.0)  # closed and outward, or this is an error
        assert np.allclose(drawn.center_of_mass, exact.center_of_mass, atol=0.02)
        off.append(np.abs(drawn.inertia - exact.inertia).max() / exact.inertia.max() + 1e-13)
    assert off[0] < 0.05
    assert off[1] < off[0] / 12.0 or off[0] < 1e-12  # by the square of the segments


def test_others_have_none() -> None:
    assert solid_surface("disk", np.array([1.0])) is None
    assert solid_surface("", np.array([])) is None
