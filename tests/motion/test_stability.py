"""Steady spins: the squared frequency of small oscillations, exactly, and what bodies then do."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import rational
from oracles.bodies import Body, bodies
from polhode import RigidBody, solids


@given(body=bodies(), rate=st.floats(0.01, 100))
def test_the_formula(body: Body, rate: float) -> None:
    """ω² (I_k − I_i)(I_k − I_j)/(I_i I_j)."""
    made = RigidBody.from_principal(*body)
    squares = made.stability(rate)
    I = rational(made.principal_moments)
    for k, (i, j) in enumerate(((1, 2), (2, 0), (0, 1))):
        exact = Fraction(rate) ** 2 * (I[k] - I[i]) * (I[k] - I[j]) / (I[i] * I[j])
        assert abs(Fraction(float(squares[k])) - exact) <= abs(exact) * Fraction(2e-15)
    assert squares[0] >= 0
    assert squares[1] <= 0
    assert squares[2] >= 0


@pytest.mark.parametrize("axis", [0, 2])
def test_a_stable_spin_oscillates_with_that_frequency(axis: int) -> None:
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    rate = 3.0
    frequency = np.sqrt(body.stability(rate)[axis])
    omega = np.full(3, 1e-6)
    omega[axis] = rate
    omega[1] = 0.0
    t = np.linspace(0, 10, 201)
    found = body.simulate(t, omega, rtol=1e-13).omega[:, 2 - axis]
    assert np.abs(found - 1e-6 * np.cos(frequency * t)).max() < 1e-11


def test_an_unstable_spin_departs_with_that_rate() -> None:
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    growth = np.sqrt(-body.stability(2.0)[1])
    omega = np.array([1e-8, 2.0, 0.0])
    t = np.linspace(0, 5, 51)
    found = body.simulate(t, omega, rtol=1e-14).omega[:, 0]
    assert np.abs(found / (1e-8 * np.cosh(growth * t)) - 1).max() < 1e-6


def test_limits() -> None:
    assert solids.sphere(1.0, mass=1.0).stability(3.0).tolist() == [0.0, 0.0, 0.0]
    assert solids.sphere(0.0, mass=1.0).stability(3.0).tolist() == [0.0, 0.0, 0.0]
    rod = solids.box((0.0, 0.0, 1.0), mass=1.0)
    assert rod.stability(3.0).tolist() == [9.0, 0.0, 0.0]
    disk = solids.cylinder(1.0, 0.0, mass=1.0)
    assert disk.stability(3.0).tolist() == [0.0, 0.0, 9.0]


def test_about_a_fixed_point() -> None:
    box = solids.box((1.0, 2.0, 3.0), mass=12.0)
    twin = RigidBody.from_principal(1.0, box.principal_about((1.0, 0, 0)).moments)
    assert np.array_equal(box.stability(2.0, about=(1.0, 0, 0)), twin.stability(2.0))


def test_stacks_broadcast_and_a_nan_stays_in_its_row() -> None:
    stack = solids.box([(1.0, 2.0, 3.0), (1.0, 1.0, 1.0)], mass=1.0)
    assert stack.stability(np.ones((5, 1))).shape == (5, 2, 3)
    got = stack[0].stability([1.0, np.nan, 2.0])
    assert np.isnan(got[1]).all()
    assert np.isfinite(got[[0, 2]]).all()
    assert (got[2] == 4 * got[0]).all()
    with pytest.raises(TypeError, match="rate"):
        stack.stability("fast")
