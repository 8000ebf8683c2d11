"""Both ends of float64: what can be held is right, what cannot is refused with the law and the number."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from polhode import MassAccumulator, RigidBody, regions, solids
from polhode.errors import InvalidInertiaError, PolhodeError

NODES = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
CELL = [(0, 1, 2, 3)]


def test_a_nearly_flat_cell_has_the_volume_that_its_corners_say() -> None:
    """One corner is 2⁻⁵³ beside the plane of the others: the volume is exactly 2⁻⁵⁴/6."""
    up = 2.0**-53
    nodes = [(0.25, 0.25, 0.0), (0.75, 0.75, 0.0), (0.25, 0.25, 1.0), (0.5, 0.5 + up, 0.5)]
    body = RigidBody.from_tetrahedra(nodes, CELL, density=1.0)
    assert body.mass == pytest.approx(2.0**-54 / 6, rel=1e-15)


@pytest.mark.parametrize(("size", "density"), [(1e-80, 1e240), (1e-90, 1e250), (1e90, 1e-280)])
def test_tiny_and_huge_cells_are_the_cell(size: float, density: float) -> None:
    one = RigidBody.from_tetrahedra(NODES, CELL, density=1.0)
    body = RigidBody.from_tetrahedra(size * NODES, CELL, density=density)
    assert body.center_of_mass / size == pytest.approx(one.center_of_mass, rel=1e-15)
    assert body.mass / (density * size * size * size) == pytest.approx(one.mass, rel=1e-14)
    assert body.principal_moments / body.mass / size / size == pytest.approx(
        one.principal_moments / one.mass, rel=1e-14
    )


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: RigidBody.from_tetrahedra(1e-90 * NODES, CELL, density=1.0), "e-452"),
        (lambda: RigidBody.from_tetrahedra(1e90 * NODES, CELL, density=1.0), "e448"),
        (lambda: RigidBody.from_particles([1.0, 1.0], [(0, 0, 0), (1e-160, 0, 0)]), r"5\.00e-321"),
        (lambda: RigidBody.from_particles([1.0, 1.0], [(0, 0, 0), (1e160, 0, 0)]), r"5\.00e319"),
        (lambda: RigidBody.from_voxels(np.ones((2, 2, 2)), 1e-80), r"5\.33e-400"),
        (lambda: solids.sphere(1e-156, mass=1.0), "e-313"),
        (lambda: RigidBody.from_density(lambda r: np.ones(len(r)), regions.ball(1e-70)), "e-350"),
        (lambda: RigidBody.from_density(lambda r: np.ones(len(r)), regions.ball(1e70)), "e350"),
    ],
)
def test_moments_beyond_the_range_are_refused_with_their_number(make: Any, told: str) -> None:
    with pytest.raises(InvalidInertiaError, match=rf"{told}.*float64 holds 2.2e-308 to 1.8e\+308"):
        make()


def test_particles_between_normal_and_denormal() -> None:
    """Moments of ½ d² for two unit masses: on this side of 2.2e-308 exact, on that side refused."""
    at = 2.0**-510
    pair = RigidBody.from_particles([1.0, 1.0], [(0, 0, 0), (at, 0, 0)])
    assert pair.principal_moments.tolist() == [0.0, 2.0**-1021, 2.0**-1021]
    with pytest.raises(InvalidInertiaError, match="largest principal moment"):
        RigidBody.from_particles([1.0, 1.0], [(0, 0, 0), (at / 2, 0, 0)])


def test_denormal_masses_are_exact() -> None:
    least = 5e-324
    pair = RigidBody.from_particles([least, 3 * least], [(0, 0, 0), (2.0**200, 0, 0)])
    assert pair.mass == 4 * least
    assert pair.center_of_mass[0] == 0.75 * 2.0**200
    assert pair.principal_moments[2] == least * (0.75 * 2.0**400)


def test_a_density_of_any_size_over_a_region_of_any_size() -> None:
    one = RigidBody.from_density(lambda r: 1 + r[:, 0] ** 2, regions.box((0, 0, 0), (1, 2, 3)))
    for size, rho in ((2.0**-250, 2.0**900), (2.0**250, 2.0**-1000)):
        box = regions.box((0, 0, 0), (size, 2 * size, 3 * size))

        def density(r: np.ndarray, size: float = size, rho: float = rho) -> Any:
            return rho * (1 + (r[:, 0] / size) ** 2)

        body = RigidBody.from_density(density, box)
        assert body.mass / size / size / size / rho == one.mass
        assert (body.center_of_mass / size).tolist() == one.center_of_mass.tolist()


@pytest.mark.parametrize(
    ("distance", "is_refused"), [(1e-120, False), (1e-121, True), (1e150, False), (1e151, True)]
)
def test_chunks_tell_where_their_sums_may_have_lost_digits(distance: float, is_refused: bool) -> None:
    sums = MassAccumulator()
    sums.add([1.0, 1.0], [(0, 0, 0), (distance, 0, 0)])
    if is_refused:
        with pytest.raises(PolhodeError, match=r"sum of the second moments must be from 1\.5e-241"):
            sums.finish()
    else:
        assert sums.finish().principal_moments[2] / distance / distance == pytest.approx(0.5, rel=1e-15)


@pytest.mark.parametrize("scale", [1e-300, 1e-160, 1e154, 1e200, 1e306])
@pytest.mark.parametrize("moments", [(1, 1, 1), (1, 1, 2), (1, 2, 2.5), (0, 1, 1)])
def test_the_drift_of_a_heavy_bodys_momentum_is_a_number(scale: float, moments: Any) -> None:
    body = RigidBody.from_principal(1.0, scale * np.array(moments, float))
    kept = body.simulate([0.0, 5.0, 10.0], (0.0, 0.2, 0.5)).invariants()
    one = RigidBody.from_principal(1.0, moments).simulate([0.0, 5.0, 10.0], (0.0, 0.2, 0.5)).invariants()
    for name in ("energy_drift", "angular_momentum_drift"):
        assert 0.0 <= getattr(kept, name) <= 1e-9
        assert getattr(one, name) <= 1e-9


def test_radii_of_what_is_very_light_or_heavy() -> None:
    for mass, moment in ((1e-200, 1e200), (1e200, 1e-200)):
        body = RigidBody.from_principal(mass, (moment,) * 3)
        assert body.radii_of_gyration == pytest.approx([moment / 1.0] * 3, rel=1e-14)
