"""The homogeneous ellipsoid with the mass and the moments of a body."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import run, write_obj
from oracles.meshes import box
from polhode import RigidBody, equimomental, solids

TILT = np.array([0.1, 0.3, 0.3, 0.9])


def test_of_an_ellipsoid_it_is_that_ellipsoid() -> None:
    semi_axes = np.array([3.0, 2.0, 0.5])
    body = solids.ellipsoid(semi_axes, density=2.0).rotated(TILT).translated((5, 6, 7))
    for found in (equimomental.ellipsoid(body), equimomental.ellipsoid(body, 4 * np.pi)):
        assert np.allclose(found.semi_axes, semi_axes, rtol=1e-14)
        assert found.volume == pytest.approx(4 * np.pi, rel=1e-14)
        assert np.array_equal(found.axes, body.principal.axes)


def test_it_has_the_moments_of_the_body(rng: np.random.Generator) -> None:
    bodies = solids.box(rng.uniform(0.1, 1.0, (20, 3)), mass=rng.uniform(1, 2, 20)).rotated(TILT)
    found = equimomental.ellipsoid(bodies)
    again = solids.ellipsoid(found.semi_axes, mass=bodies.mass)
    assert np.allclose(again.principal_moments, bodies.principal_moments, rtol=1e-13)
    assert np.all(np.diff(found.semi_axes, axis=-1) <= 0.0)


@pytest.mark.parametrize("sides", [(3, 2, 1), (1, 1, 1), (1000, 2, 1), (4, 4, Fraction(1, 64))])
def test_of_a_box(sides: tuple[Any, ...]) -> None:
    # ∫ x² dm = m s²/12 = m a²/5, so a = s √(5/12).
    body = solids.box([float(s) for s in sides], density=1.0)
    expected = np.sqrt(5 / 12) * np.array([float(s) for s in sides])
    spread = max(sides) / min(sides)
    assert np.allclose(
        equimomental.ellipsoid(body).semi_axes, expected, rtol=1e-15 * float(spread) ** 2 + 1e-15
    )
    volume = float(sides[0] * sides[1] * sides[2])
    equal = equimomental.ellipsoid(body, volume)
    ratio = np.cbrt(3 / (4 * np.pi)) / np.sqrt(5 / 12)  # all boxes shrink by the same
    assert np.allclose(equal.semi_axes, ratio * expected, rtol=1e-15 * float(spread) ** 2 + 1e-15)
    assert 4 / 3 * np.pi * np.prod(equal.semi_axes) == pytest.approx(volume, rel=1e-13)


def test_flat_and_straight_bodies() -> None:
    rod = RigidBody.from_particles([1.0, 1.0], [(0, 0, -1), (0, 0, 1)])
    assert np.allclose(equimomental.ellipsoid(rod).semi_axes, (np.sqrt(5), 0, 0), atol=1e-15)
    assert equimomental.ellipsoid(rod).volume == 0.0
    with pytest.raises(ValueError, match="a flat or straight body has no ellipsoid with a volume"):
        equimomental.ellipsoid(rod, 1.0)
    for wrong in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(ValueError, match="must be positive and finite"):
            equimomental.ellipsoid(solids.cube(1.0, mass=1.0), wrong)
    with pytest.raises(TypeError, match="expected a RigidBody"):
        equimomental.ellipsoid(3.0)  # type: ignore[arg-type]


@pytest.mark.parametrize("length", [1e-120, 1e120, 1e153])
def test_volumes_beyond_the_range_of_numbers(length: float) -> None:
    moments = np.array([1.0, 2.0, 2.5]) * length * length
    body: Any = RigidBody.from_principal(1.0, moments)
    assert np.allclose(
        equimomental.ellipsoid(body).semi_axes / length, np.sqrt([8.75, 3.75, 1.25]), rtol=1e-14
    )
    found = equimomental.ellipsoid(body, 4 / 3 * np.pi).semi_axes
    assert np.allclose(found, np.sqrt([8.75, 3.75, 1.25]) / (8.75 * 3.75 * 1.25) ** (1 / 6), rtol=1e-13)


def test_volumes_are_one_or_one_for_each_body() -> None:
    body: Any = solids.cube(1.0, mass=1.0)
    with pytest.raises(
        ValueError, match=r"volume: expected one, or one for each body of shape \(\), got \(2,\)"
    ):
        equimomental.ellipsoid(body, [1.0, 2.0])


def test_reports_tell_both(tmp_path: Path) -> None:
    path = write_obj(tmp_path / "b.obj", *box((30.0, 20.0, 10.0)))
    code, out, _ = run("report", path, "--length-unit", "mm", "--density", "1000", "--format", "json")
    assert code == 0
    told = json.loads(out)["equivalent_ellipsoid"]
    expected = np.sqrt(5 / 12) * np.array([0.03, 0.02, 0.01])
    assert np.allclose(told["semi_axes"], expected, rtol=1e-12)
    assert np.allclose(4 / 3 * np.pi * np.prod(told["equal_volume"]), 6e-6, rtol=1e-12)
    code, out, _ = run("report", "--mass", "1", "--inertia", "1 1 1", "--format", "json")
    told = json.loads(out)["equivalent_ellipsoid"]
    assert np.allclose(told["semi_axes"], np.sqrt(2.5))
    assert "equal_volume" not in told
