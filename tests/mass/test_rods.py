"""Homogeneous thin rods against closed forms in fifty digits, and their limits."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp, mpf
from polhode import RigidBody, rods, solids


def exact_arc(radius: float, angle: float) -> tuple[Any, Any]:
    """∫ y² and ∫ (x − x_C)² of a unit mass along an arc, in sixty digits."""
    with mp.workdps(80):
        r, a = mpf(radius), mpf(angle)
        y = r**2 / 2 * (1 - mp.sin(a) / a)
        x = r**2 / 2 * (1 + mp.sin(a) / a) - (r * mp.sin(a / 2) / (a / 2)) ** 2
        return x, y


@given(radius=st.floats(1e-3, 1e3), angle=st.floats(1e-9, 2 * np.pi))
def test_arc(radius: float, angle: float) -> None:
    along_x, along_y = (float(s) for s in exact_arc(radius, angle))
    arc = rods.arc(radius, angle, mass=1.0)
    assert np.diag(arc.inertia) == pytest.approx([along_y, along_x, along_x + along_y], rel=2e-15, abs=0)
    assert not arc.center_of_mass.any()
    assert rods.arc(radius, angle, density=2.0).mass == pytest.approx(2 * radius * angle, rel=1e-15)


def test_arc_against_numbers_along_it() -> None:
    """A million points, midpoint rule: C at x = R sin(α/2)/(α/2) from the centre of the circle."""
    radius, angle = 2.0, 4.0
    phi = (np.arange(1_000_000) + 0.5) / 1_000_000 * angle - angle / 2
    points = radius * np.stack([np.cos(phi), np.sin(phi), 0 * phi], axis=-1)
    particles = RigidBody.from_particles(np.full(phi.shape, 3.0 / len(phi)), points)
    arc = rods.arc(radius, angle, mass=3.0)
    assert particles.center_of_mass == pytest.approx([2 * np.sin(2.0) / 2.0, 0, 0], abs=1e-11)
    assert arc.inertia == pytest.approx(particles.inertia, rel=1e-10, abs=1e-11)


def test_a_whole_arc_is_a_ring_and_a_straight_one_a_rod() -> None:
    assert rods.arc(3.0, 2 * np.pi, mass=2.0).isclose(rods.ring(3.0, mass=2.0), rtol=1e-15)
    straight = rods.arc(1e9, 1e-9, mass=3.0).rotated([(0, 0, 1), (1, 0, 0), (0, 1, 0)])
    assert straight.isclose(rods.rod(1.0, mass=3.0), rtol=1e-15)


def test_ring() -> None:
    ring = rods.ring(2.0, density=0.5)
    assert ring.mass == pytest.approx(2 * np.pi, rel=1e-15)
    assert np.diag(ring.inertia) == pytest.approx(np.array([2.0, 2.0, 4.0]) * ring.mass, rel=1e-15)
    assert ring.isclose(solids.torus(2.0, 0.0, mass=ring.mass), rtol=1e-15)


def test_rod() -> None:
    assert rods.rod(2.0, mass=3.0) == solids.cylinder(0.0, 2.0, mass=3.0)
    assert rods.rod(2.0, density=3.0).mass == 6.0
    assert rods.rod(2.0, mass=3.0).principal_moments.tolist() == [0.0, 1.0, 1.0]
    assert not rods.rod(0.0, mass=1.0).inertia.any()


@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
def test_what_is_no_length_is_named(value: float) -> None:
    makers: list[tuple[Callable[[], object], str]] = [
        (lambda: rods.rod(value, mass=1.0), "length"),
        (lambda: rods.ring(value, mass=1.0), "radius"),
        (lambda: rods.arc(value, 1.0, mass=1.0), "radius"),
        (lambda: rods.arc(1.0, value, mass=1.0), "angle"),
    ]
    for make, name in makers:
        with pytest.raises(ValueError, match=name):
            make()
    with pytest.raises(ValueError, match=r"angle.*2π.*7"):
        rods.arc(1.0, 7.0, mass=1.0)


def test_without_length_a_density_gives_no_mass() -> None:
    makers: list[Callable[[], object]] = [
        lambda: rods.rod(0.0, density=1.0),
        lambda: rods.ring(0.0, density=1.0),
        lambda: rods.arc(1.0, 0.0, density=1.0),
    ]
    for make in makers:
        with pytest.raises(ValueError, match=r"length.*mass="):
            make()


def test_arrays_make_stacks() -> None:
    stack = rods.arc([1.0, 2.0], [[0.5], [1.0], [2.0]], mass=1.0)
    assert stack.shape == (3, 2)
    assert stack[1, 1] == rods.arc(2.0, 1.0, mass=1.0)
    with pytest.raises(ValueError, match=r"radius \(2,\), angle \(3,\)"):
        rods.arc([1.0, 2.0], [0.5, 1.0, 2.0], mass=1.0)
