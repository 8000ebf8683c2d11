"""From a gyro's log to the tensor: efficiency, coverage, what is not told, errors.

Logs and bounds are SciPy's.
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from polhode import RigidBody, Uncertain, identify
from polhode.errors import IdentificationError
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from scipy.stats import chi2 as chi_square

Floats = NDArray[np.float64]
ELEMENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
SIGMA, BIAS = 0.01, np.array([0.05, -0.02, 0.03])


def cross(omega: Floats) -> Floats:
    """The matrix of ω ×."""
    x, y, z = omega.tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def motion(inertia: Floats, start: Floats, t: Floats, rotor: Any = (0.0, 0.0, 0.0)) -> Floats:
    """ω at times, by Euler's equations."""
    inverse, h = np.linalg.inv(inertia), np.asarray(rotor)
    found = solve_ivp(
        lambda _, omega: -inverse @ (cross(omega) @ (inertia @ omega + h)), (t[0], t[-1]), start, "DOP853", t,
        rtol=1e-12, atol=1e-13,
    )  # fmt: skip
    return np.asarray(found.y.T)


def elements(inertia: Floats) -> Floats:
    return np.array([inertia[place] for place in ELEMENTS])


def tensor(numbers: Floats) -> Floats:
    found = np.zeros((3, 3))
    for x, (i, j) in zip(numbers, ELEMENTS, strict=True):
        found[i, j] = found[j, i] = x
    return found


def derivatives(inertia: Floats, start: Floats, t: Floats, rotor: Any = (0.0, 0.0, 0.0)) -> Floats:
    """∂ω/∂(ω₀, tensor) at times, shape (n, 3, 9), by the variational equations."""
    h, inverse = np.asarray(rotor), np.linalg.inv(inertia)
    basis = np.array([tensor(one) for one in np.eye(6)])

    def whole(_: float, y: Floats) -> Floats:
        omega, columns = y[:3], y[3:].reshape(3, 9)
        momentum, turns = inertia @ omega + h, cross(omega)
        turn = -inverse @ (turns @ momentum)
        change = cross(momentum) @ columns - turns @ (inertia @ columns)
        change[:, 3:] -= (basis @ turn).T + turns @ (basis @ omega).T
        return np.concatenate([turn, (inverse @ change).ravel()])

    first = np.concatenate([start, np.eye(3, 9).ravel()])
    found = solve_ivp(whole, (t[0], t[-1]), first, "DOP853", t, rtol=1e-9, atol=1e-9)
    return np.asarray(found.y[3:].reshape(3, 9, -1).transpose(2, 0, 1))


class Throw:
    """A body, its motion, and the information of a log on (ω₀, tensor of trace 1, bias)."""

    def __init__(self, moments: Any, turn: int, start: Any, end: float, n: int) -> None:
        axes = Rotation.random(random_state=turn).as_matrix()
        moments = np.asarray(moments) / np.sum(moments)
        self.inertia = axes @ np.diag(moments) @ axes.T
        self.start = axes @ np.asarray(start)
        self.t = np.linspace(0.0, end, n)
        self.omega = motion(self.inertia, self.start, self.t)

    @functools.cached_property
    def jacobian(self) -> Floats:
        by_motion = derivatives(self.inertia, self.start, self.t)
        by_bias = np.broadcast_to(np.eye(3), (len(self.t), 3, 3))
        return np.concatenate([by_motion, by_bias], axis=2)

    def log(self, seed: int) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """Times, rows, and which of them are there."""
        rng = np.random.default_rng(seed)
        rows = self.omega + BIAS + rng.normal(0.0, SIGMA, self.omega.shape)
        there = rng.random(len(self.t)) > 0.1
        there[0] = True  # ω₀ is that of the first row
        rows[~there] = np.nan
        return self.t, rows, there

    @functools.cached_property
    def by_parameters(self) -> Floats:
        """∂(predictions)/∂(ω₀, xx yy xy xz yz, bias), where the trace stays, shape (n, 3, 11)."""
        maps = np.delete(np.eye(12), 5, axis=0)
        maps[3:5, 5] = -1.0
        return self.jacobian @ maps.T

    def errors(self, found: Any, there: NDArray[np.bool_]) -> tuple[float, float]:
        """Squares of the errors: by the information F at the truth, and by the covariance that was told.

        The error e is that in normal coordinates at the truth: F e = Jᵀ (f(estimate) − f(truth))/σ². To first
        order it is the difference of the parameters. But the frequency of the tumble is known 1e4 times
        better than ω₀ and tensor are one by one, and is no linear function of them.
        """
        predicted = found.motion.at(self.t[there] - self.t[0]).omega + found.estimate[9:]
        change = (predicted - self.omega[there] - BIAS) / SIGMA
        tangent = np.linalg.qr(self.by_parameters[there].reshape(-1, 11))[0]
        white = tangent.T @ change.ravel()
        five = [3, 4, 6, 7, 8]
        off = (found.estimate[3:9] - elements(self.inertia))[[0, 1, 3, 4, 5]]
        told = found.covariance[np.ix_(five, five)]
        return float(white @ white), float(off @ np.linalg.solve(told, off))


def near_separatrix(moments: Any, offset: float, size: float) -> Floats:
    """A motion that starts half way, off the separatrix by a share of ω₃."""
    a, b, c = np.asarray(moments) / np.sum(moments)
    first = 0.5
    third = first * np.sqrt(a * (b - a) / (c * (c - b)))
    return size * np.array([first, 0.7, third * (1.0 + offset)])


@functools.cache
def throws() -> list[Throw]:
    found = []
    for k in range(6):  # about the long axis, about the short axis
        rng = np.random.default_rng(k)
        moments = np.sort(rng.uniform(0.5, 1.0, 3))
        moments[2] = min(moments[2], 0.95 * (moments[0] + moments[1]))
        moments[1] = 0.5 * (moments[0] + moments[2]) + rng.uniform(-0.2, 0.2) * (moments[2] - moments[0])
        n = int(rng.integers(400, 1001))
        found.append(Throw(moments, k, (4.0, 1.0, 1.0), 6.0 + 2 * k, n))
        found.append(Throw(moments, k, (1.0, 1.0, 4.0), 6.0 + 2 * k, n))
    for k, offset in enumerate((1e-3, -1e-3, 1e-3, -1e-3)):
        pair = ((0.2, 0.35, 0.45), (0.25, 0.3, 0.45))[k // 2]
        found.append(Throw(pair, 20 + k, near_separatrix(pair, offset, 6.0), 10.0, 700 + 100 * k))
    for k, start in enumerate(((4.0, 1.0, 2.0), (1.0, 1.0, 4.0), (3.0, 2.0, 3.0), (2.0, 3.0, 1.0))):
        found.append(Throw((0.99, 1.0, 1.01), 30 + k, start, 60.0, 1000))
    return found


class TestEfficiency:
    def check(
        self, seeds: int, pooled: tuple[float, float], each: float, covers: tuple[float, float]
    ) -> None:
        inside, ratios = [], []
        limit = chi_square.ppf(0.95, 5)
        for number, throw in enumerate(throws()):
            squares = []
            for seed in range(seeds):
                t, rows, there = throw.log(1000 * number + seed)
                found = identify.from_tumble(t, rows, sigma=SIGMA, bias=True)
                assert found.dropped == {"not finite": int((~there).sum())}
                square, told = throw.errors(found, there)
                squares.append(square)
                inside.append(told < limit)
            ratios.append(np.mean(squares) / 11.0)
            assert np.sqrt(ratios[-1]) <= each, (number, np.sqrt(ratios[-1]))
        assert pooled[0] <= np.sqrt(np.mean(ratios)) <= pooled[1]
        assert covers[0] <= np.mean(inside) <= covers[1]

    def test_efficiency(self) -> None:
        # 60 fits: the standard error of the pooled number is 2.8 %, that of a body 12 %.
        self.check(3, (0.9, 1.1), 1.5, (0.86, 1.0))

    @pytest.mark.long
    def test_efficiency_of_4000_fits(self) -> None:
        self.check(200, (0.98, 1.03), 1.10, (0.94, 0.96))


ASYMMETRIC = Throw((0.2, 0.35, 0.45), 1, (1.0, 3.0, 0.5), 8.0, 800)


class TestDesign:
    def test_the_bound_is_that_of_variational_equations(self) -> None:
        throw = ASYMMETRIC
        body = RigidBody(mass=1.0, inertia=throw.inertia)
        told = identify.design(body, throw.start, throw.t, SIGMA, bias=True)
        maps = np.delete(np.eye(12), 5, axis=0)
        maps[3:5, 5] = -1.0
        own = throw.by_parameters.reshape(-1, 11) / SIGMA
        root = maps.T @ np.linalg.inv(np.linalg.qr(own, mode="r"))
        assert np.allclose(told.crlb, root @ root.T, rtol=1e-6, atol=1e-15)
        assert told.residuals.shape == (0, 3)

    def test_the_bound_with_a_rotor(self) -> None:
        throw, rotor = ASYMMETRIC, np.array([0.3, -0.2, 0.5])
        body = RigidBody(mass=1.0, inertia=2.0 * throw.inertia)
        told = identify.design(body, throw.start, throw.t, SIGMA, rotor=rotor)
        own = derivatives(2.0 * throw.inertia, throw.start, throw.t, rotor).reshape(-1, 9) / SIGMA
        root = np.linalg.inv(np.linalg.qr(own, mode="r"))
        assert np.allclose(told.crlb, root @ root.T, rtol=1e-6, atol=1e-15)
        assert told.scale_known

    def test_best_throw_tells_more_than_others_of_its_energy(self) -> None:
        body = RigidBody.from_principal(1.0, (0.2, 0.35, 0.45))
        best = identify.best_throw(body, energy=5.0, end=2.0, sigma=SIGMA)
        assert 0.5 * best @ body.inertia @ best == pytest.approx(5.0)
        t = np.linspace(0.0, 2.0, 200)
        size = [np.trace(identify.design(body, best, t, SIGMA).covariance[3:9, 3:9])]
        for seed in range(10):
            omega = np.random.default_rng(seed).normal(size=3) / np.sqrt(body.principal_moments)
            omega *= np.sqrt(10.0 / (omega @ body.inertia @ omega))
            size.append(np.trace(identify.design(body, omega, t, SIGMA).covariance[3:9, 3:9]))
        assert min(size) == size[0]

    def test_throws_that_turn_too_far(self) -> None:
        body = RigidBody.from_principal(1.0, (0.2, 0.35, 0.45))
        t = np.arange(20.0)
        assert np.isfinite(identify.design(body, (40.0, 80.0, 20.0), t, SIGMA).crlb).all()
        with pytest.raises(ValueError, match=r"t, omega: the body turns by 1\.15e\+09 rad from one time"):
            identify.design(body, (5e8, 1e9, 2.5e8), t, SIGMA)
        with pytest.raises(ValueError, match=r"energy, end, n: no throw with an energy of 1e\+18"):
            identify.best_throw(body, energy=1e18, end=20.0, sigma=SIGMA, n=20)


class TestLogs:
    def test_a_rotor_tells_the_scale(self) -> None:
        inertia, rotor = 3.0 * ASYMMETRIC.inertia, (0.8, 1.2, -0.5)
        t = ASYMMETRIC.t
        rows = motion(inertia, ASYMMETRIC.start, t, rotor)
        squares = []
        for seed in range(10):
            noisy = rows + np.random.default_rng(seed).normal(0.0, SIGMA, rows.shape)
            found = identify.from_tumble(t, noisy, sigma=SIGMA, rotor=rotor)
            off = found.estimate[3:9] - elements(inertia)
            squares.append(off @ np.linalg.solve(found.covariance[3:9, 3:9], off))
            assert found.scale_known
            assert found.observability == ()
        assert 3.0 < np.mean(squares) < 9.5  # of chi-square with 6 degrees: 6 ± 1.1

    def test_unknown_noise(self) -> None:
        t, rows, _ = ASYMMETRIC.log(3)
        found = identify.from_tumble(t, rows, bias=True)
        assert found.noise is not None
        assert np.allclose(found.noise.value, SIGMA, rtol=0.06)
        assert np.isnan(found.p_value)

    def test_uneven_times_and_the_motion(self) -> None:
        rng = np.random.default_rng(5)
        t = 100.0 + np.sort(rng.uniform(0.0, 8.0, 700))
        rows = motion(ASYMMETRIC.inertia, ASYMMETRIC.start, t)
        noisy = rows + rng.normal(0.0, SIGMA, rows.shape)
        found = identify.from_tumble(t, noisy, sigma=SIGMA)
        assert found.p_value > 1e-4
        assert found.motion is not None
        assert np.abs(found.motion.at(t - t[0]).omega - rows).max() < 0.01
        assert found.start is not None
        assert np.abs(found.start.omega - rows[0]).max() < 0.01

    def test_exact_rows_give_the_exact_tensor(self) -> None:
        found = identify.from_tumble(ASYMMETRIC.t, ASYMMETRIC.omega, sigma=SIGMA)
        assert np.allclose(found.body.inertia, ASYMMETRIC.inertia, rtol=0.0, atol=1e-9)

    @pytest.mark.parametrize("n", [300, 301, 2000, 2001, 6000])
    def test_logs_of_which_some_rows_or_all_are_taken_for_the_starts(self, n: int) -> None:
        t = np.linspace(0.0, 8.0, n)
        body = RigidBody(mass=1.0, inertia=ASYMMETRIC.inertia)
        rows = body.free_motion(ASYMMETRIC.start).at(t).omega
        found = identify.from_tumble(t, rows + BIAS, sigma=SIGMA, bias=True)
        assert np.allclose(found.body.inertia, ASYMMETRIC.inertia, rtol=0.0, atol=1e-8)
        assert found.alternatives == ()

    def test_student_bears_outliers(self) -> None:
        t, rows, there = ASYMMETRIC.log(4)
        rows[there] += np.where(np.random.default_rng(0).random(there.sum()) < 0.03, 3.0, 0.0)[:, None]
        found = identify.from_tumble(t, rows, bias=True, loss="student")
        off = (
            found.estimate - np.concatenate([ASYMMETRIC.start, elements(ASYMMETRIC.inertia), BIAS])
        ) / np.sqrt(np.diagonal(found.covariance))
        assert np.abs(off).max() < 4.0
        assert np.sqrt(np.diagonal(found.covariance)[3:9]).max() < 0.005

    def test_a_bias_known_beforehand(self) -> None:
        t, rows, _ = ASYMMETRIC.log(6)
        free = identify.from_tumble(t, rows, sigma=SIGMA, bias=True)
        known = identify.from_tumble(t, rows, sigma=SIGMA, bias=Uncertain(BIAS, 1e-6))
        assert known.bias is not None
        assert free.bias is not None
        assert np.allclose(known.bias.value, BIAS, atol=1e-5)
        assert np.diagonal(known.covariance)[3:9].sum() < np.diagonal(free.covariance)[3:9].sum()

    def test_a_prior_is_weighed(self) -> None:
        t, rows, _ = ASYMMETRIC.log(7)
        body = RigidBody(mass=2.0, inertia=5.0 * ASYMMETRIC.inertia)
        prior = body.with_covariance(np.diag([0.0] * 4 + [0.01] * 6))
        found = identify.from_tumble(t, rows, sigma=SIGMA, bias=True, prior=prior)
        assert found.scale_known
        off = found.estimate[3:9] - elements(body.inertia)
        assert off @ np.linalg.solve(found.covariance[3:9, 3:9], off) < 20.0

    def test_a_flat_body_lies_on_the_edge_half_the_time(self) -> None:
        throw = Throw((0.3, 0.7, 1.0), 3, (2.0, 1.0, 2.0), 5.0, 500)
        edges = []
        for seed in range(8):
            t, rows, _ = throw.log(seed)
            found = identify.from_tumble(t, rows, sigma=SIGMA, bias=True)
            edges.append(found.at_edge)
            moments = found.body.principal_moments
            assert moments[2] <= (moments[0] + moments[1]) * (1.0 + 1e-12)
            assert found.linear is not found.at_edge
            assert np.abs(found.body.inertia - throw.inertia).max() < 0.02
        assert any(edges)
        assert not all(edges)

    def test_a_second_maximum_is_told(self) -> None:
        # A third of a turn of a body with two moments 0.2 % apart.
        start = Rotation.random(random_state=27).inv().apply((-4.19388414, -1.95913382, -2.14917511))
        throw = Throw((0.54446782, 0.76171736, 0.76301112), 27, start, 2.1135036420831605, 200)
        t, rows, _ = throw.log(27)
        found = identify.from_tumble(t, rows, sigma=SIGMA, bias=True, starts=8)
        assert len(found.alternatives) >= 1
        for other in found.alternatives:
            assert 0.0 <= other.chi2 - found.chi2 < 6.0
            assert np.abs(other.body.inertia - found.body.inertia).max() > 1e-4
        assert identify.from_tumble(t, rows, sigma=SIGMA, bias=True, starts=0).alternatives == ()


class TestWhatIsNotTold:
    def told(self, inertia: Any, start: Any, t: Floats, bias: bool = False) -> tuple[Any, ...]:
        inertia = np.diag(inertia) if np.ndim(inertia) == 1 else np.asarray(inertia)
        rows = motion(inertia, np.asarray(start), t)
        noisy = rows + np.random.default_rng(0).normal(0.0, SIGMA, rows.shape)
        with pytest.raises(IdentificationError, match="undetermined") as caught:
            identify.from_tumble(t, noisy, sigma=SIGMA, bias=bias)
        assert caught.value.kind == "undetermined"
        return caught.value.observability

    @pytest.mark.parametrize("axis", [0, 1, 2])
    def test_a_pure_spin(self, axis: int) -> None:
        t = np.linspace(0.0, 5.0, 500) if axis != 1 else np.linspace(0.0, 1.0, 500)
        found = self.told((0.2, 0.35, 0.45), 3.0 * np.eye(3)[axis], t)
        assert len(found) >= 3
        assert all(one.remedy for one in found)

    def test_a_spherical_body(self) -> None:
        found = self.told((1.0, 1.0, 1.0), (1.0, 2.0, 2.0), np.linspace(0.0, 5.0, 500))
        assert len(found) >= 3

    def test_a_short_log(self) -> None:
        found = self.told((0.2, 0.35, 0.45), (0.5, 1.0, 0.3), np.linspace(0.0, 0.6, 60), bias=True)
        assert len(found) >= 3

    def test_the_plane_of_the_separatrix(self) -> None:
        moments = (0.2, 0.35, 0.45)
        inertia = np.diag(moments)
        t = np.linspace(0.0, 4.0, 1000)
        start = near_separatrix(moments, 1e-4, 2.0)
        told = identify.design(RigidBody(mass=1.0, inertia=inertia), start, t, SIGMA)
        shape = [one for one in told.observability if one.words != "the scale of the tensor"]
        normal = np.cross(start, motion(inertia, start, t)[300])
        normal /= np.linalg.norm(normal)
        assert len(shape) == 1
        assert shape[0].words.startswith("the moment about")
        direction = np.linalg.eigh(tensor(shape[0].parameters[3:9]))
        axis = direction[1][:, int(np.argmax(np.abs(direction[0])))]
        assert abs(axis @ normal) > 0.99
        far = identify.design(RigidBody(mass=1.0, inertia=inertia), (1.0, 3.0, 0.5), t, SIGMA)
        assert [one.words for one in far.observability] == ["the scale of the tensor"]

    def test_the_scale(self) -> None:
        t, rows, _ = ASYMMETRIC.log(0)
        found = identify.from_tumble(t, rows, bias=True)
        assert [one.words for one in found.observability] == ["the scale of the tensor"]
        assert "rotor" in found.observability[0].remedy
        assert not found.scale_known
        assert np.trace(found.body.inertia) == pytest.approx(1.0, abs=1e-12)


class TestErrors:
    def test_times_that_fall(self) -> None:
        t, rows, _ = ASYMMETRIC.log(0)
        t = t.copy()
        t[400:] -= 3.0
        with pytest.raises(IdentificationError, match="row 399 to row 400") as caught:
            identify.from_tumble(t, rows)
        assert caught.value.kind == "clock"

    def test_degrees(self) -> None:
        t, rows, _ = ASYMMETRIC.log(0)
        with pytest.raises(IdentificationError, match="deg2rad") as caught:
            identify.from_tumble(t, np.rad2deg(rows), bias=True)
        assert caught.value.kind == "units"

    def test_a_gyro_beyond_its_range(self) -> None:
        t, rows, _ = ASYMMETRIC.log(0)
        with pytest.raises(IdentificationError, match="saturated") as caught:
            identify.from_tumble(t, np.clip(rows, -2.0, 2.0), bias=True)
        assert caught.value.kind == "saturated"
        # A gyro of few digits is none.
        identify.from_tumble(t, rows.round(2), bias=True)

    @pytest.mark.parametrize("sigma", [None, SIGMA])
    def test_a_body_that_is_not_free(self, sigma: float | None) -> None:
        t, rows, _ = ASYMMETRIC.log(0)
        rows = rows * (1.0 - 0.05 * t)[:, None]
        with pytest.raises(IdentificationError, match="no free motion") as caught:
            identify.from_tumble(t, rows, sigma=sigma, bias=True)
        assert caught.value.kind == "no fit"

    @pytest.mark.parametrize(
        ("given", "words"),
        [
            ({"sigma": -1.0}, "sigma"),
            ({"bias": 0.1}, "bias"),
            ({"bias": Uncertain(0.1, 0.1)}, "bias"),
            ({"rotor": (1.0, 2.0)}, "rotor"),
            ({"mass": 0.0}, "mass"),
            ({"prior": RigidBody.from_principal(1.0, (1.0, 1.0, 1.0))}, "prior"),
            ({"loss": "huber"}, "loss"),
            ({"starts": -1}, "starts"),
        ],
    )
    def test_arguments(self, given: Any, words: str) -> None:
        t, rows, _ = ASYMMETRIC.log(0)
        with pytest.raises(ValueError, match=words):
            identify.from_tumble(t, rows, **given)

    def test_shapes(self) -> None:
        t, rows, _ = ASYMMETRIC.log(0)
        with pytest.raises(ValueError, match="omega: expected shape"):
            identify.from_tumble(t, rows[:-1])
        with pytest.raises(ValueError, match="t: expected shape"):
            identify.from_tumble(t[:, None], rows)
