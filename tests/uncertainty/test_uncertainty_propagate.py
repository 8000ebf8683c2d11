"""Sigmas of any function of a body: to first order, to second order and by draws, against oracles."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from oracles.matter_models import PAIRS, Given, Quantity
from oracles.uncertainty import covariance, jacobian, monte_carlo
from polhode import Uncertain
from polhode.uncertainty import propagate
from scipy.spatial.transform import Rotation
from uncertain_bodies import Bodies, RigidBody, laminae, solids, symmetric

SIX = np.array([0, 4, 8, 1, 2, 5])


def given(sigma: float, gap: float = 1.0, seed: int = 0) -> Given:
    """Ten numbers of an asymmetric body, all correlated, with these sigmas relative to their sizes."""
    rng = np.random.default_rng(seed)
    q, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    tensor = q @ np.diag([3.0, 4.0, 4.0 + gap]) @ q.T
    factor = (
        sigma * np.array([2.0, *[1.0] * 3, *[4.0] * 6])[:, None] * rng.standard_normal((10, 10)) / 10**0.5
    )
    numbers = np.array([2.0, 0.5, -0.3, 0.8, *((tensor[i, j] + tensor[j, i]) / 2 for i, j in PAIRS)])
    return Given(Quantity(numbers, factor, (10,)))


def ten(body: Any) -> Any:
    return np.concatenate([[body.mass], body.center_of_mass, body.inertia.ravel()[SIX]])


class TestFirstOrder:
    def test_of_the_ten_numbers(self) -> None:
        body = Bodies().body(given(0.003))
        found = propagate(ten, body)
        assert np.array_equal(found.value, ten(body))
        sigma = np.sqrt(np.diag(body.covariance))
        assert np.abs((found.covariance - body.covariance) / np.outer(sigma, sigma)).max() < 1e-9
        assert found.sigma == pytest.approx(sigma, rel=1e-9)
        assert np.all(found.linear)

    def test_of_moments_and_radii_together(self) -> None:
        node = given(0.003)
        exact = covariance(jacobian(node))
        rows = np.array([10, 11, 12, 16, 17, 18])
        found = propagate(lambda b: np.stack([b.principal_moments, b.radii_of_gyration]), Bodies().body(node))
        assert found.value.shape == found.sigma.shape == (2, 3)
        sigma = np.sqrt(np.diag(exact))[rows]
        assert found.sigma.ravel() == pytest.approx(sigma, rel=1e-8)
        P = np.asarray(found.covariance).reshape(6, 6)
        assert np.abs((P - exact[np.ix_(rows, rows)]) / np.outer(sigma, sigma)).max() < 1e-8

    def test_of_one_number(self) -> None:
        body = Bodies().body(given(0.003))
        found = propagate(lambda b: b.mass, body)
        assert found.value == body.mass
        assert np.ndim(found.sigma) == 0
        assert found.sigma == pytest.approx(body.sigma.mass, rel=1e-12)

    def test_of_a_body_without_sigma(self) -> None:
        body = RigidBody(2.0, np.diag([3.0, 4.0, 5.0]))
        with pytest.raises(ValueError, match=r"no covariance.*with_sigma"):
            propagate(lambda b: b.mass, body)

    @pytest.mark.parametrize("omega", [(2.0, 0.3, 0.4), (0.3, 0.4, 2.0)], ids=["long-axis", "short-axis"])
    def test_of_the_period_of_a_tumbling_body(self, omega: tuple[float, float, float]) -> None:
        """Landau and Lifshitz, Mechanics §37, with derivatives of fifty digits."""
        node = given(0.001)
        numbers = Quantity(node.numbers.value, node.numbers.factor, (10,))
        flat = symmetric(numbers.value[4:])
        w = np.linalg.eigh(flat)[1] @ np.array(omega)

        def period(six: list[Any]) -> Any:
            I = mpmath.matrix(3, 3)
            for x, (i, j) in zip(six, PAIRS, strict=True):
                I[i, j] = I[j, i] = x
            v = mpmath.matrix([mpmath.mpf(float(x)) for x in w])
            L = I * v
            M, E = (L.T * L)[0], (v.T * L)[0]
            a, b, c = sorted(mpmath.eigsy(I, eigvals_only=True))
            if E * b > M:
                a, c = c, a
            parameter = (b - a) * (E * c - M) / ((c - b) * (M - E * a))
            return 4 * mpmath.ellipk(parameter) * mpmath.sqrt(a * b * c / ((c - b) * (M - E * a)))

        with mpmath.workdps(50):
            nominal = [mpmath.mpf(float(x)) for x in numbers.value[4:]]
            h = mpmath.mpf(10) ** -15
            value = float(period(nominal))
            gradient = []
            for k in range(6):
                up, down = list(nominal), list(nominal)
                up[k] += h
                down[k] -= h
                gradient.append(float((period(up) - period(down)) / (2 * h)))
        assert numbers.factor is not None
        sigma = float(np.linalg.norm(np.array(gradient) @ numbers.factor[4:]))
        found = propagate(lambda b: b.free_motion(w).periods.rotation, Bodies().body(node))
        assert found.value == pytest.approx(value, rel=1e-13)
        assert found.sigma == pytest.approx(sigma, rel=1e-7)


class TestDraws:
    def test_against_the_oracle(self) -> None:
        """Also where first order is far off: moments that all but agree."""
        for gap in (1.0, 0.03):
            node = given(0.003, gap)
            drawn = monte_carlo(node, 200_000)
            body = Bodies().body(node)
            found = propagate(lambda b: b.principal_moments, body, method="monte-carlo", n=40_000, seed=1)
            assert found.sigma == pytest.approx(drawn.sigma[10:13], rel=5 / np.sqrt(2 * 40_000))
        assert drawn.departure[12] > 0.05
        assert not propagate(lambda b: b.principal_moments, body).linear[2]

    def test_a_seed_is_one_answer(self) -> None:
        body = Bodies().body(given(0.003))
        runs = [
            propagate(lambda b: b.principal_moments, body, method="monte-carlo", n=500, seed=seed)
            for seed in (3, 3, 4)
        ]
        assert np.array_equal(runs[0].covariance, runs[1].covariance)
        assert not np.array_equal(runs[0].covariance, runs[2].covariance)

    def test_every_draw_is_a_body(self) -> None:
        """A thin plate's thickness is uncertain by half of it: draws that no body could have are none."""
        thin = RigidBody(1.0, np.diag([1.0, 1.0, 1.99])).with_sigma(inertia=np.diag([0.0, 0.0, 0.005]))
        with pytest.warns(UserWarning, match="those of no body"):
            found = propagate(lambda b: b.principal_moments, thin, method="monte-carlo", n=2000, seed=0)
        assert np.isfinite(found.sigma).all()


class TestTurned:
    """A turn, however uncertain, changes no principal moment: bodies move along circles, not tangents."""

    @pytest.mark.parametrize("method", ["linear", "second-order", "monte-carlo"])
    def test_moments(self, method: Any) -> None:
        turn = Uncertain(Rotation.from_rotvec([0.3, -1.1, 0.6]), 0.05)
        body = solids.box((1.0, 2.0, 3.0), mass=Uncertain(12.0, 0.012)).rotated(turn)
        found = propagate(lambda b: b.principal_moments, body, method=method, n=4000, seed=0)
        assert found.sigma == pytest.approx([0.005, 0.01, 0.013], rel=0.05)
        assert np.all(found.linear)

    @pytest.mark.parametrize("method", ["linear", "second-order", "monte-carlo"])
    def test_a_thin_plate(self, method: Any) -> None:
        """Steps along the tangents would leave what bodies there are."""
        turn = Uncertain(Rotation.from_rotvec([0.3, -1.1, 0.6]), 0.03)
        plate = solids.box((1.0, 1.0, 0.02), mass=Uncertain(12.0, 0.012)).rotated(turn)
        found = propagate(lambda b: b.principal_moments, plate, method=method, n=1000, seed=0)
        assert found.sigma == pytest.approx(plate.principal_moments * 1e-3, rel=0.1)


class TestSecondOrder:
    def test_a_square(self) -> None:
        """The square of a mass: the variance of x² is 4μ²σ² + 2σ⁴."""
        node = given(0.02)
        body = Bodies().body(node)
        found = propagate(lambda b: np.square(b.mass), body, method="second-order")
        s = body.sigma.mass
        assert found.sigma == pytest.approx(np.sqrt(4 * (body.mass * s) ** 2 + 2 * s**4), rel=1e-6)

    def test_names_of_methods(self) -> None:
        body = laminae.disk(Uncertain(1.0, 0.1), mass=2.0)
        method: Any = "third-order"
        with pytest.raises(ValueError, match=r"linear.*second-order.*monte-carlo"):
            propagate(lambda b: b.mass, body, method=method)


def test_draws_tell_how_far_they_are() -> None:
    told: list[float] = []
    body = Bodies().body(given(0.003))
    found = propagate(ten, body, "monte-carlo", n=50, seed=1, progress=told.append)
    assert told == pytest.approx(np.arange(1, 51) / 50)
    assert np.array_equal(
        found.value, propagate(ten, body, "monte-carlo", n=50, seed=1, progress=False).value
    )
