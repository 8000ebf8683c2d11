"""Surfaces of solids that are drawn: closed, outward, with the moments of the solid as they get finer."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, solids
from polhode._scene.solids import solid_surface

SOLIDS: list[tuple[str, dict[str, Any]]] = [
    ("cylinder", {"radius": 1.5, "height": 0.7}),
    ("tube", {"inner_radius": 0.5, "outer_radius": 1.5, "height": 0.7}),
    ("cone", {"radius": 1.5, "height": 2.0}),
    ("frustum", {"bottom_radius": 1.5, "top_radius": 0.5, "height": 2.0}),
    ("frustum", {"bottom_radius": 1.5, "top_radius": 0.0, "height": 2.0}),
    ("sphere", {"radius": 1.5}),
    ("ellipsoid", {"semi_axes": [1.0, 2.0, 0.5]}),
    ("hemisphere", {"radius": 1.5}),
    ("capsule", {"radius": 0.5, "length": 2.0}),
    ("torus", {"major_radius": 2.0, "minor_radius": 0.5}),
    ("prism", {"sides": 5, "radius": 1.5, "height": 2.0}),
]


@pytest.mark.parametrize(("name", "arguments"), SOLIDS)
def test_it_is_the_solid(name: str, arguments: dict[str, Any]) -> None:
    exact = getattr(solids, name)(**arguments, density=2.0)
    off = []
    for segments in (40, 160):
        surface = solid_surface(name, arguments, segments)
        assert surface is not None
        drawn = RigidBody.from_mesh(*surface, density=2.0)  # closed and outward, or this is an error
        assert np.allclose(drawn.center_of_mass, exact.center_of_mass, atol=0.02)
        off.append(np.abs(drawn.inertia - exact.inertia).max() / exact.inertia.max() + 1e-13)
    assert off[0] < 0.05
    assert off[1] < off[0] / 12.0 or off[0] < 1e-12  # by the square of the segments


def test_others_have_none() -> None:
    assert solid_surface("box", {"size": [1, 2, 3]}) is None
    assert solid_surface("", {}) is None
