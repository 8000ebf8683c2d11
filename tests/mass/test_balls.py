"""Unions of overlapping balls: quadrature to 40 digits, Monte Carlo, closed forms, degenerate places."""

from __future__ import annotations

import itertools
import math
import time
from typing import Any

import numpy as np
import pytest
from oracles.unions_of_balls import sampled_union, union_by_slices
from polhode import RigidBody, solids
from polhode.errors import PolhodeError

SIX = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]


def second_about_origin(body: Any) -> Any:
    tensor = body.inertia_about("origin")
    return 0.5 * np.trace(tensor) * np.eye(3) - tensor


def clump(rng: Any, count: Any) -> Any:
    """Balls around a common place, so that most of them overlap; some inside others or equal."""
    centers = rng.normal(scale=rng.choice([0.3, 0.7, 1.2]), size=(count, 3))
    radii = rng.uniform(0.3, 1.2, size=count)
    if rng.random() < 0.3:
        radii[:] = 1.0
    if rng.random() < 0.2:
        centers[-1], radii[-1] = centers[0], radii[0] * rng.choice([0.5, 1.0])
    return centers + rng.choice([0.0, 5.0]), radii


def check_against_slices(centers: Any, radii: Any, nodes: Any, digits: Any) -> Any:
    body = RigidBody.from_balls(centers, radii, density=1.0)
    volume, *rest = (float(x) for x in union_by_slices(centers, radii, nodes, digits))
    size = np.abs(centers).max() + radii.max()
    assert body.mass == pytest.approx(volume, rel=1e-12)
    np.testing.assert_allclose(
        body.mass * body.center_of_mass, rest[:3], rtol=0, atol=1e-12 * volume * size, err_msg=f"{centers}"
    )
    second = second_about_origin(body)
    np.testing.assert_allclose([second[at] for at in SIX], rest[3:], rtol=0, atol=1e-12 * volume * size**2)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_quadrature_to_many_digits(count: Any) -> None:
    rng = np.random.default_rng(count)
    centers, radii = clump(rng, count)
    check_against_slices(centers, radii, nodes=20, digits=24)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(200))
def test_quadrature_to_40_digits(seed: Any) -> None:
    rng = np.random.default_rng(1000 + seed)
    centers, radii = clump(rng, 2 + seed % 4)
    check_against_slices(centers, radii, nodes=40, digits=40)


def check_by_samples(seeds: Any, samples: Any) -> Any:
    """As many errors beyond four sigmas as chance has, one in 16,000."""
    beyond = total = 0
    for seed in seeds:
        rng = np.random.default_rng(seed)
        centers, radii = clump(rng, int(rng.integers(2, 12)))
        body = RigidBody.from_balls(centers, radii, density=1.0)
        found = np.concatenate([[body.mass], body.mass * body.center_of_mass])
        mean, sigma = sampled_union(centers, radii, samples, rng)
        errors = np.abs(found - mean) / sigma
        assert errors.max() < 6.0, seed
        beyond, total = beyond + int((errors > 4.0).sum()), total + errors.size
    print(f"{beyond} of {total} errors are beyond 4 sigma")
    assert beyond <= 2 + 1.5e-4 * total


def test_monte_carlo() -> None:
    check_by_samples(range(300), 2000)


@pytest.mark.long
def test_ten_thousand_clumps_by_monte_carlo() -> None:
    check_by_samples(range(10_000), 4000)


def test_two_balls_in_closed_form() -> None:
    rng = np.random.default_rng(3)
    for _ in range(200):
        a, b = rng.uniform(0.1, 2.0, size=2)
        d = rng.uniform(abs(a - b), a + b)
        lens = math.pi * (a + b - d) ** 2 * (d * d + 2 * d * (a + b) - 3 * (a - b) ** 2) / (12 * d)
        volume = 4 / 3 * math.pi * (a**3 + b**3) - lens
        way = rng.normal(size=3)
        way *= d / np.linalg.norm(way)
        body = RigidBody.from_balls(np.array([7, 8, 9]) + np.array([0 * way, way]), [a, b], density=1.0)
        assert body.mass == pytest.approx(volume, rel=2e-14)
        assert abs(body.mass - volume) <= body.error_bound.mass + 1e-14 * volume


def test_the_clump_of_two_unit_spheres() -> None:
    clump = RigidBody.from_balls([(0, 0, 0), (1, 0, 0)], 1.0, density=1.0)
    assert round(clump.mass, 8) == 7.06858347
    np.testing.assert_array_equal(clump.principal_moments.round(8), [3.00414797, 5.21308031, 5.21308031])


@pytest.mark.parametrize("gap", [0.0, 1e-16, -1e-16, 3e-16, -3e-16, 1e-12, -1e-12, 1e-8, -1e-8])
@pytest.mark.parametrize("inner", [False, True])
def test_spheres_that_touch(gap: Any, inner: Any) -> None:
    a, b = 1.0, 0.7
    d = (a - b if inner else a + b) + gap
    for way in np.eye(3), np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]:
        body = RigidBody.from_balls([(0, 0, 0), d * way[0]], [a, b], density=1.0)
        volume = 4 / 3 * math.pi * (a**3 if inner else a**3 + b**3)
        assert body.mass == pytest.approx(volume, rel=1e-14 + 10 * gap**2)


@pytest.mark.parametrize("shift", [0.0, 1e-17, 1e-15, 1e-12, 1e-9, 1e-6])
def test_planes_through_a_center_and_a_common_line(shift: Any) -> None:
    """Eight balls at the corners of a cube around one: planes pass through its center, three circles meet."""
    corners = np.array(list(itertools.product([-1.0, 1.0], repeat=3)))
    centers = np.concatenate([corners, [[shift, 0.0, 0.0]]])
    for radius in (1.2, math.sqrt(2.0), 1.5, math.sqrt(3.0), 2.0):
        radii = np.append(np.full(8, radius), math.sqrt(radius**2 - 3.0) if radius**2 > 3.1 else 0.9)
        body = RigidBody.from_balls(centers, radii, density=1.0)
        near = RigidBody.from_balls(
            centers + 1e-7 * np.sin(np.arange(27.0)).reshape(9, 3), radii, density=1.0
        )
        assert body.mass == pytest.approx(near.mass, rel=1e-6)
        np.testing.assert_allclose(body.principal_moments, near.principal_moments, rtol=1e-6)
    two = RigidBody.from_balls(corners[:, :] * (1, 1, 0) + (3, 2, 1), 1.2, density=1.0)  # each ball twice
    one = RigidBody.from_balls(corners[::2] * (1, 1, 0) + (3, 2, 1), 1.2, density=1.0)
    assert two.isclose(one, rtol=1e-14)


def test_balls_along_a_line_that_cover_a_capsule() -> None:
    radius, length, n = 0.5, 3.0, 2_001
    centers = np.column_stack([np.zeros(n), np.zeros(n), np.linspace(-length / 2, length / 2, n)])
    body = RigidBody.from_balls(centers, radius, density=2.0)
    # Between two balls a ring is missing: about h²/12 per length in the square of the radius.
    capsule = solids.capsule(radius, length, density=2.0)
    step = length / (n - 1)
    assert body.mass == pytest.approx(capsule.mass, rel=step**2 + 1e-13)
    np.testing.assert_allclose(body.principal_moments, capsule.principal_moments, rtol=step**2 + 1e-13)


def test_order_place_and_scale() -> None:
    rng = np.random.default_rng(11)
    centers, radii = clump(rng, 9)
    body = RigidBody.from_balls(centers, radii, density=1.0)
    order = rng.permutation(9)
    assert RigidBody.from_balls(centers[order], radii[order], density=1.0).isclose(body, rtol=1e-14)
    for scale in (2.0**-300, 2.0**-100, 2.0**100):
        big = RigidBody.from_balls(centers * scale, radii * scale, mass=1.0)
        same = RigidBody.from_balls(centers, radii, mass=1.0)
        np.testing.assert_array_equal(big.principal_moments / scale / scale, same.principal_moments)
    far = RigidBody.from_balls((centers * 1024).round() / 1024 + 2.0**30, radii, density=1.0)
    near = RigidBody.from_balls((centers * 1024).round() / 1024, radii, density=1.0)
    np.testing.assert_allclose(far.principal_moments, near.principal_moments, rtol=1e-14)
    np.testing.assert_allclose(far.center_of_mass - 2.0**30, near.center_of_mass, atol=1e-6)


def test_hundred_thousand_balls() -> None:
    """Balls of some thirty neighbours each, against samples; the time is told by benchmarks."""
    rng = np.random.default_rng(2)
    n = 20_000
    side = (n * 4 / 3 * math.pi * 8.0 / 28.0) ** (1 / 3)
    centers, radii = rng.uniform(0.0, side, size=(n, 3)), np.ones(n)
    start = time.process_time()
    body = RigidBody.from_balls(centers, radii, density=1.0)
    print(f"{time.process_time() - start:.2f} s of processor time for {n} balls")
    points = rng.uniform(-1.0, side + 1.0, size=(20_000, 3))
    from scipy.spatial import cKDTree

    inside = np.isfinite(cKDTree(centers).query(points, distance_upper_bound=1.0)[0])
    whole = (side + 2.0) ** 3
    sigma = whole * math.sqrt(inside.mean() * (1 - inside.mean()) / len(points))
    assert abs(body.mass - whole * inside.mean()) < 4 * sigma
    assert body.provenance.source == "balls"
    assert body.provenance.elements == n


def test_refused() -> None:
    with pytest.raises(PolhodeError, match=r"radii\[1\] is -2.0"):
        RigidBody.from_balls([(0, 0, 0), (1, 0, 0)], [1.0, -2.0], density=1.0)
    with pytest.raises(PolhodeError, match=r"radii\[0\] is 0.0"):
        RigidBody.from_balls([(0, 0, 0)], 0.0, density=1.0)
    with pytest.raises(ValueError, match=r"radii: expected one radius or shape \(2,\)"):
        RigidBody.from_balls([(0, 0, 0), (1, 0, 0)], [1.0, 1.0, 1.0], density=1.0)
    with pytest.raises(ValueError, match="centers must not be empty"):
        RigidBody.from_balls(np.zeros((0, 3)), 1.0, density=1.0)
    with pytest.raises(PolhodeError, match="centers must be finite"):
        RigidBody.from_balls([(0, 0, math.nan)], 1.0, density=1.0)
    with pytest.raises(TypeError, match="exactly one of mass= and density="):
        RigidBody.from_balls([(0, 0, 0)], 1.0)
