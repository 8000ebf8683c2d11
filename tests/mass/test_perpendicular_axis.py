"""Perpendicular axes: about its normal a lamina has the sum of the moments about two axes in its plane."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.bodies import attitudes, matrix
from polhode import RigidBody, solids

number = st.floats(-2, 2)


@given(
    places=st.lists(st.tuples(number, number), min_size=1, max_size=9),
    q=attitudes(),
    point=st.tuples(number, number),
    angle=st.floats(0, 6.3),
)
def test_for_every_lamina_about_every_point_of_its_plane(
    places: list[tuple[float, float]], q: np.ndarray, point: tuple[float, float], angle: float
) -> None:
    axes = matrix(q)
    lamina = RigidBody.from_particles(np.arange(1.0, len(places) + 1), np.array(places) @ axes[:, :2].T)
    about = axes[:, :2] @ point
    u, v = np.cos(angle) * axes[:, 0] + np.sin(angle) * axes[:, 1], axes[:, 2]
    normal = lamina.moment_about(v, about)
    sum_ = lamina.moment_about(u, about) + lamina.moment_about(np.cross(u, v), about)
    size = float(lamina.mass) * 20
    assert abs(normal - sum_) <= 1e-14 * size
    I1, I2, I3 = lamina.principal_moments
    assert abs(I1 + I2 - I3) <= 1e-14 * size


def test_a_body_with_thickness_has_less_about_the_normal(rng: np.random.Generator) -> None:
    stack = solids.box(rng.uniform(0.1, 2.0, (50, 3)), mass=1.0)
    I1, I2, I3 = stack.principal_moments.T
    assert (I1 + I2 > I3).all()


def test_mex73_a_coin_about_its_rim(rng: np.random.Generator) -> None:
    mass, radius, angle = rng.uniform(0.5, 3.0, (3, 50))
    coin = solids.cylinder(radius, 0.0, mass=mass)
    rim = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(50)])
    moments = coin.principal_about(rim).moments / (mass * radius**2)[:, None]
    assert np.abs(moments - [0.25, 1.25, 1.5]).max() < 1e-14
    assert coin.moment_about((0, 0, 1), rim) == pytest.approx(1.5 * mass * radius**2, rel=1e-14)
