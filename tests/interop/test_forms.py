"""The interop of other libraries, against sums over particles and NumPy's own factorization."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.bodies import Body, bodies
from polhode import RigidBody, interop, laminae, solids
from polhode.errors import InvalidInertiaError

MASSES = np.array([1.0, 2.0, 0.5, 1.5, 3.0])
POSITIONS = np.array([(0.5, 0, 1), (-1, 2, 0.5), (0.25, -1, -0.5), (2, 1, 0), (0, 0.5, -1.0)])
PARTICLES = RigidBody.from_particles(MASSES, POSITIONS)
BRICK = solids.box((1.0, 2.0, 3.0), mass=2.5).translated((0.5, -0.25, 1.0))

FORMS: dict[str, tuple[Callable[[RigidBody], Any], Callable[..., RigidBody]]] = {
    "parameters": (interop.to_parameters, interop.from_parameters),
    "pseudo_inertia": (interop.to_pseudo_inertia, interop.from_pseudo_inertia),
    "spatial_inertia": (interop.to_spatial_inertia, interop.from_spatial_inertia),
    "spatial_inertia, linear first": (
        lambda body: interop.to_spatial_inertia(body, "linear-angular"),
        lambda matrix, **k: interop.from_spatial_inertia(matrix, "linear-angular", **k),
    ),
    "log_cholesky": (interop.to_log_cholesky, interop.from_log_cholesky),
}


@pytest.mark.parametrize("name", FORMS)
class TestEveryForm:
    @given(data=bodies(decades=3, thinnest=1))
    def test_it_leads_back(self, name: str, data: Body) -> None:
        there, back = FORMS[name]
        body = RigidBody.from_principal(*data)
        if (
            name == "log_cholesky"
            and body.principal_moments[2] > (1 - 1e-9) * body.principal_moments[:2].sum()
        ):
            return  # no thickness
        lever = 1 + body.mass * (data.center_of_mass @ data.center_of_mass) / data.moments[2]
        if lever > 1e4:
            return  # about the origin the tensor is lost, as the interop are
        same = back(there(body))
        assert same.isclose(body, rtol=1e-14 * (1 if name == "log_cholesky" else lever) * 10)

    def test_stacks(self, name: str) -> None:
        there, back = FORMS[name]
        stack = RigidBody.stack([PARTICLES, BRICK])[None]
        numbers = there(stack)
        assert numbers.shape[:2] == (1, 2)
        assert np.array_equal(numbers[0, 1], there(BRICK))
        again = back(numbers)
        assert again.shape == (1, 2)
        assert again[0, 1] == back(numbers[0, 1])

    @pytest.mark.parametrize("value", [np.nan, np.inf])
    def test_numbers_are_finite(self, name: str, value: float) -> None:
        there, back = FORMS[name]
        numbers = np.array([there(BRICK)] * 3)
        numbers[1].flat[-1] = value
        argument = "parameters" if name == "log_cholesky" else name.split(",")[0]
        with pytest.raises(ValueError, match=rf"row 1: {argument} must be finite"):
            back(numbers)

    def test_shapes_are_named(self, name: str) -> None:
        _, back = FORMS[name]
        with pytest.raises(ValueError, match=r"expected shape \(\.\.\., .*\), got \(7, 7\)"):
            back(np.ones((7, 7)))


def test_pseudo_inertia_is_the_sum_over_particles() -> None:
    homogeneous = np.hstack([POSITIONS, np.ones((5, 1))])
    expected = np.einsum("n,ni,nj->ij", MASSES, homogeneous, homogeneous)
    assert interop.to_pseudo_inertia(PARTICLES) == pytest.approx(expected, rel=1e-14, abs=1e-14)


def test_spatial_inertia_takes_velocities_to_momenta() -> None:
    omega, velocity = np.array([0.1, -0.7, 0.4]), np.array([1.0, 2.0, -0.5])
    velocities = velocity + np.cross(omega, POSITIONS)
    linear = MASSES @ velocities
    angular = MASSES @ np.cross(POSITIONS, velocities)
    by_matrix = interop.to_spatial_inertia(PARTICLES) @ np.concatenate([omega, velocity])
    assert by_matrix == pytest.approx(np.concatenate([angular, linear]), rel=1e-14)
    linear_first = interop.to_spatial_inertia(PARTICLES, "linear-angular") @ np.concatenate([velocity, omega])
    assert linear_first == pytest.approx(np.concatenate([linear, angular]), rel=1e-14)


def test_parameters_are_what_the_equations_are_linear_in() -> None:
    m, hx, hy, hz, xx, xy, yy, xz, yz, zz = interop.to_parameters(PARTICLES)
    about_origin = np.einsum("n,nij->ij", MASSES, [r @ r * np.eye(3) - np.outer(r, r) for r in POSITIONS])
    assert m == MASSES.sum()
    assert np.array([hx, hy, hz]) == pytest.approx(MASSES @ POSITIONS, rel=1e-14)
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    assert tensor == pytest.approx(about_origin, rel=1e-14, abs=1e-14)
    both = interop.to_parameters(PARTICLES) + interop.to_parameters(BRICK)
    assert interop.from_parameters(both).isclose(PARTICLES + BRICK, rtol=1e-13)


class TestLogCholesky:
    def test_it_is_the_logarithm_of_numpys_factor(self) -> None:
        """J = U Uᵀ with U upper triangular: the Cholesky factor of J with rows and columns reversed."""
        flip = np.eye(4)[::-1]
        upper = flip @ np.linalg.cholesky(flip @ interop.to_pseudo_inertia(PARTICLES) @ flip) @ flip
        alpha, d1, d2, d3, s12, s23, s13, *t = interop.to_log_cholesky(PARTICLES)
        u = upper / upper[3, 3]
        assert alpha == pytest.approx(np.log(upper[3, 3]), rel=1e-14)
        assert [d1, d2, d3] == pytest.approx(np.log(np.diag(u)[:3]), rel=1e-13)
        assert [s12, s23, s13, *t] == pytest.approx(
            [u[0, 1], u[1, 2], u[0, 2], *u[:3, 3]], rel=1e-13, abs=1e-15
        )

    @given(parameters=st.lists(st.floats(-2, 2), min_size=10, max_size=10))
    def test_any_ten_numbers_are_a_body(self, parameters: list[float]) -> None:
        body = interop.from_log_cholesky(parameters)
        assert interop.to_log_cholesky(body) == pytest.approx(parameters, rel=1e-9, abs=1e-9)

    def test_far_from_the_origin_nothing_is_lost(self) -> None:
        far = BRICK.translated((1e8, 0, 0))
        assert interop.from_log_cholesky(interop.to_log_cholesky(far)).isclose(far, rtol=1e-15)
        assert np.array_equal(interop.to_log_cholesky(far)[:7], interop.to_log_cholesky(BRICK)[:7])

    def test_a_lamina_has_none(self) -> None:
        with pytest.raises(InvalidInertiaError, match=r"no log-Cholesky.*along z is 0\.0"):
            interop.to_log_cholesky(laminae.disk(1.0, mass=1.0))


class TestPositiveProducts:
    def test_products_are_minus_the_off_diagonal_elements(self) -> None:
        moments, products = interop.to_positive_products(PARTICLES)
        r = POSITIONS - PARTICLES.center_of_mass
        expected = [MASSES @ (r[:, i] * r[:, j]) for i, j in ((0, 1), (0, 2), (1, 2))]
        assert products == pytest.approx(expected, rel=1e-14)
        same = RigidBody.from_positive_products(PARTICLES.mass, moments, products, PARTICLES.center_of_mass)
        assert np.array_equal(same.inertia, PARTICLES.inertia)

    def test_the_orbital_station_of_nasas_check_cases(self) -> None:
        """Its table gives positive products; a sign lost there is a classic."""
        moments, products = (9.1e7, 1.64e8, 1.80e8), (-7.0e5, -8.2e6, 1.2e6)
        station = RigidBody.from_positive_products(4.2e5, moments, products)
        assert station.inertia[0, 1] == 7.0e5
        assert station.inertia[2, 1] == -1.2e6

    def test_arguments_are_named_and_broadcast(self) -> None:
        assert RigidBody.from_positive_products([1.0, 2.0], (1, 1, 1), np.zeros((3, 1, 3))).shape == (3, 2)
        with pytest.raises(ValueError, match="products"):
            RigidBody.from_positive_products(1.0, (1, 1, 1), (0, 0, np.nan))
        with pytest.raises(InvalidInertiaError, match="triangle"):
            RigidBody.from_positive_products(1.0, (1, 1, 3), (0, 0, 0))


class TestMistakes:
    def test_an_asymmetric_pseudo_inertia(self) -> None:
        matrix = interop.to_pseudo_inertia(BRICK)
        matrix[0, 3] += 0.5
        with pytest.raises(
            InvalidInertiaError, match=r"pseudo_inertia must be symmetric: element \[0\]\[3\]"
        ):
            interop.from_pseudo_inertia(matrix)

    def test_an_impossible_pseudo_inertia(self) -> None:
        with pytest.raises(InvalidInertiaError, match="triangle"):
            interop.from_pseudo_inertia(np.diag([-1.0, 4.0, 9.0, 12.0]))
        with pytest.raises(InvalidInertiaError, match="mass"):
            interop.from_pseudo_inertia(np.diag([1.0, 4.0, 9.0, 0.0]))

    def test_the_wrong_order_is_told(self) -> None:
        with pytest.raises(InvalidInertiaError, match=r"element \[\d\]\[\d\].*order"):
            interop.from_spatial_inertia(interop.to_spatial_inertia(BRICK), "linear-angular")
        with pytest.raises(ValueError, match=r"order: expected \"angular-linear\""):
            interop.to_spatial_inertia(BRICK, "angular")  # type: ignore[arg-type]

    @pytest.mark.parametrize("element", [(0, 1), (0, 3), (1, 3), (5, 2), (4, 4), (3, 5)])
    def test_an_element_that_contradicts_the_others_is_told(self, element: tuple[int, int]) -> None:
        matrix = interop.to_spatial_inertia(BRICK)
        matrix[element] += 1e-3
        with pytest.raises(InvalidInertiaError, match=r"symmetric|imply"):
            interop.from_spatial_inertia(matrix)

    def test_rtol_admits_printed_tables(self) -> None:
        matrix = interop.to_spatial_inertia(PARTICLES).round(3)
        assert interop.from_spatial_inertia(matrix, rtol=1e-3).isclose(PARTICLES, rtol=1e-3)
