"""A payload from a log of its wrench: the cone of possible bodies, certificates, windows, what is not
told."""

from __future__ import annotations

from typing import Any

import cvxpy
import numpy as np
import pytest
from numpy.typing import NDArray
from polhode import RigidBody, identify, laminae, rods, solids
from polhode.errors import IdentificationError
from polhode.identify import cone
from polhode.interop import to_pseudo_inertia
from scipy.interpolate import BSpline

Floats = NDArray[np.float64]
BOX = solids.box((0.1, 0.2, 0.3), mass=2.0).translated((0.0, 0.02, 0.1))
PLATE = laminae.rectangle((0.2, 0.3), mass=1.0).translated((0.01, 0.0, 0.05))
ROD = rods.rod(0.5, mass=1.0).translated((0.0, 0.1, 0.0))
ELEMENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def fitted(*args: Any, **given: Any) -> Any:
    """Return the result; whether its body has sigmas is what the tests ask."""
    return identify.from_wrench(*args, **given)


def record(body: RigidBody, n: int = 800, seed: int = 0, **given: float) -> dict[str, Any]:
    """A log by the equations of Newton and Euler, written out here, with noise."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, given.get("end", 10.0), n)
    rate = given.get("rate", 1.0) * np.array([[1.0, 1.9, 2.6], [1.3, 2.3, 3.1], [0.7, 1.6, 3.0]])
    phase = np.multiply.outer(t, rate) + rng.uniform(0.0, 6.0, (3, 3))
    omega = given.get("swing", 1.0) * np.sin(phase).sum(axis=2)
    turn = given.get("swing", 1.0) * (rate * np.cos(phase)).sum(axis=2)
    push = 9.81 * np.stack(
        [np.sin(0.7 * t), np.cos(0.7 * t) * np.sin(1.1 * t), np.cos(0.7 * t) * np.cos(1.1 * t)], 1
    )
    wrench = predicted(body, omega, turn, push) + rng.normal(0.0, 1.0, (n, 6)) * np.repeat(
        [given.get("force", 0.1), given.get("torque", 0.01)], 3
    )
    return {
        "t": t,
        "force": wrench[:, :3],
        "torque": wrench[:, 3:],
        "omega": omega + rng.normal(0.0, 1.0, omega.shape) * given.get("spin", 0.0),
        "specific_force": push,
        "angular_acceleration": turn,
    }


def predicted(body: RigidBody, omega: Floats, turn: Floats, push: Floats) -> Floats:
    mc, about = body.mass * body.center_of_mass, body.inertia_about("origin")
    force = body.mass * push + np.cross(turn, mc) + np.cross(omega, np.cross(omega, mc))
    torque = np.cross(mc, push) + turn @ about + np.cross(omega, omega @ about)
    return np.hstack([force, torque])


def numbers(body: RigidBody) -> Floats:
    return np.concatenate([[body.mass], body.center_of_mass, [body.inertia[i, j] for i, j in ELEMENTS]])


WEIGHTS = np.repeat([10.0, 100.0], 3)
"""Of force and torque in the error of a prediction: their sigmas are then 1."""


def bound(data: dict[str, Any], motion: Any, spin: float, rate: float) -> float:
    """Least mean square of the error of wrenches that are predicted for a motion, by Cramér and Rao.

    The angular velocity of the log is a spline of degree 5 with some five pieces in a cycle of the fastest
    motion. Its coefficients are unknown, as the ten numbers of the body are.
    """
    t, pieces, degree = data["t"], round(25 * rate), 5
    knots = t[0] + (t[-1] - t[0]) / pieces * np.arange(-degree, pieces + degree + 1)
    spline = BSpline(knots, np.eye(pieces + degree), degree)
    values, slopes = spline(t), spline.derivative()(t)
    omega, turn, push = data["omega"], data["angular_acceleration"], data["specific_force"]
    truth, steps = numbers(BOX), 1e-4 * np.maximum(np.abs(numbers(BOX)), 0.01)

    def by_body(*motion: Any) -> Floats:
        moved = [(body_of(truth + h), body_of(truth - h)) for h in np.diag(steps)]
        both = [(predicted(one, *motion) - predicted(other, *motion)) * WEIGHTS for one, other in moved]
        return np.stack([one.ravel() for one in both], 1) / (2.0 * steps)

    columns = []
    for k in range(values.shape[1]):
        for axis in np.eye(3):
            by, further = np.outer(values[:, k], axis), np.outer(slopes[:, k], axis)
            # The wrench is of second degree in the motion: the difference is exact.
            up, down = (predicted(BOX, omega + s * by, turn + s * further, push) for s in (1.0, -1.0))
            columns.append(np.concatenate([(0.5 * (up - down) * WEIGHTS).ravel(), by.ravel() / spin]))
    of_body = by_body(omega, turn, push)
    of_body = np.vstack([of_body, np.zeros((omega.size, 10))])
    both = np.hstack([np.stack(columns, 1), of_body])
    triangle = np.asarray(np.linalg.qr(both, mode="r"))
    errors = by_body(*motion) @ np.linalg.inv(triangle[-10:, -10:])
    return float(np.sum(errors**2) / len(errors))


def body_of(ten: Floats) -> RigidBody:
    inertia = np.zeros((3, 3))
    for x, (i, j) in zip(ten[4:], ELEMENTS, strict=True):
        inertia[i, j] = inertia[j, i] = x
    return RigidBody(mass=ten[0], inertia=inertia, center_of_mass=ten[1:4])


SIGMAS: dict[str, Any] = {"force_sigma": 0.1, "torque_sigma": 0.01}


class TestInside:
    def test_errors_are_as_large_as_the_covariance_says(self) -> None:
        squares, p_values = [], []
        for seed in range(60):
            found = fitted(**record(BOX, 200, seed), **SIGMAS)
            off = found.estimate - numbers(BOX)
            squares.append(off @ np.linalg.solve(found.covariance, off))
            p_values.append(found.p_value)
        assert 8.6 < np.mean(squares) < 11.6  # of chi-square with 10 degrees: 10 ± 0.58
        assert 0.38 < np.mean(p_values) < 0.62

    def test_the_covariance_goes_into_the_body(self) -> None:
        found = fitted(**record(BOX), **SIGMAS)
        assert np.allclose(found.body.covariance, found.covariance, rtol=1e-9, atol=1e-18)
        assert np.allclose(found.covariance, found.crlb, rtol=1e-12, atol=0.0)

    def test_unknown_noise_and_offsets(self) -> None:
        data = record(BOX, 3000)
        data["force"] = data["force"] + (1.0, -2.0, 0.5)
        data["torque"] = data["torque"] + (0.1, 0.0, -0.2)
        found = fitted(**data, bias=True)
        assert found.noise is not None
        assert np.allclose(found.noise.value, np.repeat([0.1, 0.01], 3), rtol=0.05)
        assert found.bias is not None
        off = (found.bias.value - (1.0, -2.0, 0.5, 0.1, 0.0, -0.2)) / found.bias.sigma
        assert np.abs(off).max() < 4.0
        off = (found.estimate - numbers(BOX)) / np.sqrt(np.diagonal(found.covariance))
        assert np.abs(off).max() < 4.0

    def test_at_moves_the_origin(self) -> None:
        data = record(BOX)
        here, there = fitted(**data), fitted(**data, at=(0.0, 0.0, 0.1))
        moved = here.body.translated((0.0, 0.0, -0.1))
        assert np.allclose(there.body.center_of_mass, moved.center_of_mass, atol=1e-14)
        assert np.allclose(there.body.covariance, moved.covariance, rtol=1e-9, atol=1e-20)

    def test_a_prior_is_weighed(self) -> None:
        data = record(BOX)
        alone = fitted(**data, **SIGMAS)
        prior = BOX.with_covariance(alone.covariance)
        both = fitted(**data, **SIGMAS, prior=prior)
        assert np.allclose(both.covariance, 0.5 * alone.covariance, rtol=0.05, atol=1e-12)
        assert np.allclose(both.estimate, 0.5 * (alone.estimate + numbers(BOX)), atol=1e-3)

    def test_student_bears_outliers(self) -> None:
        data = record(BOX)
        data["force"][::40] += 30.0
        squares = fitted(**data)
        robust = fitted(**data, loss="student")
        assert abs(robust.body.mass - 2.0) < 4.0 * robust.body.sigma.mass
        assert robust.body.sigma.mass < 0.1 * squares.body.sigma.mass

    def test_rows_that_are_not_finite_are_counted(self) -> None:
        data = record(BOX)
        data["omega"][5] = np.nan
        data["force"][7:9] = np.inf
        found = fitted(**data, **SIGMAS)
        assert found.dropped == {"not finite": 3}
        assert len(found.residuals) == 797


class TestEdge:
    CASES: Any = (
        (PLATE, {}),
        (ROD, {}),
        (BOX, {"swing": 0.02}),
        (BOX.scaled(mass=0.02), {}),
    )

    def problems(self, seeds: int) -> Any:
        """Every fit of the cases, with the problem that the cone was given."""
        for body, given in self.CASES:
            for seed in range(seeds):
                asked: list[Any] = []

                def spy(*args: Any, asked: list[Any] = asked) -> Any:
                    asked.append((args, cone.fit_possible(*args)))
                    return asked[-1][1]

                with pytest.MonkeyPatch.context() as patch:
                    patch.setattr("polhode.identify.wrench.fit_possible", spy)
                    found = fitted(**record(body, 200, seed, **given), **SIGMAS)
                yield found, asked[-1][0], asked[-1][1][0]

    def check(self, seeds: int) -> int:
        edges = 0
        for found, (triangle, target, maps, _, rest), x in self.problems(seeds):
            least = np.linalg.eigvalsh(to_pseudo_inertia(found.body))[0]
            assert least > -1e-15 * found.body.mass
            if not found.at_edge:
                assert found.gap == 0.0
                continue
            edges += 1
            assert not found.linear
            assert found.gap <= 1e-9 * found.chi2
            # The conditions of Karush, Kuhn and Tucker, from the solution alone: the gradient is ⟨Z, M_k⟩ of
            # a Z ≥ 0 that the body has nothing to do with.
            gradient = 2.0 * triangle.T @ (triangle @ x - target)
            values, vectors = np.linalg.eigh(np.tensordot(x, maps, 1))
            empty = vectors[:, values < 1e-5 * values[-1]]
            pairs = np.triu_indices(empty.shape[1])
            lines = (empty.T @ maps @ empty)[:, pairs[0], pairs[1]] * np.where(pairs[0] == pairs[1], 1.0, 2.0)
            dual, *_ = np.linalg.lstsq(lines, gradient, rcond=None)
            multiplier = np.zeros((empty.shape[1], empty.shape[1]))
            multiplier[pairs] = multiplier.T[pairs] = dual
            assert np.linalg.eigvalsh(multiplier)[0] > -1e-6 * np.abs(dual).max()
            # Bound of the dual problem with it: no possible body is better by more.
            z = empty @ multiplier @ empty.T
            off = triangle @ x - target - 0.5 * np.linalg.solve(triangle.T, np.tensordot(maps, z, 2))
            slack = np.tensordot(z, np.tensordot(x, maps, 1), 2)
            assert off @ off + abs(slack) <= 1e-6 * found.chi2
            assert rest >= 0.0
        return edges

    def test_the_best_body_is_possible_and_certified(self) -> None:
        assert self.check(4) >= 6

    @pytest.mark.long
    def test_the_best_body_is_possible_and_certified_in_many_logs(self) -> None:
        assert self.check(60) >= 90

    def test_the_optimum_of_another_solver(self) -> None:
        for found, (triangle, target, maps, _, rest), x in self.problems(3):
            if not found.at_edge:
                continue
            y, size = cvxpy.Variable(10), np.abs(triangle).max()
            matrix = sum(y[k] * maps[k] for k in range(10))
            goal = cvxpy.Minimize(cvxpy.norm(triangle / size @ y - target / size))
            cvxpy.Problem(goal, [matrix >> 0]).solve(solver=cvxpy.CLARABEL)
            ours, theirs = (float(np.sum((triangle @ one - target) ** 2)) + rest for one in (x, y.value))
            assert ours <= theirs * (1.0 + 1e-9)

    def test_a_tiny_problem_in_closed_form(self) -> None:
        """The nearest nonnegative numbers: the cone of diagonal matrices."""
        maps = np.array([np.diag([1.0, 0.0]), np.diag([0.0, 1.0])])
        x, gap, edge = cone.fit_possible(np.eye(2), np.array([3.0, -2.0]), maps, np.ones(2))
        assert edge
        assert gap < 1e-10
        assert np.allclose(x, (3.0, 0.0), atol=1e-6)

    def test_a_fit_without_certificate_is_an_error(self, monkeypatch: pytest.MonkeyPatch) -> None:
        maps = np.array([np.diag([1.0, 0.0]), np.diag([0.0, 1.0])])
        given = np.eye(2), np.array([3.0, -2.0]), maps, np.ones(2)
        monkeypatch.setattr(cone, "_STEPS", 3)
        with pytest.raises(IdentificationError, match="the best possible body was not found") as caught:
            cone.fit_possible(*given)
        assert caught.value.kind == "no fit"
        monkeypatch.undo()
        assert cone.fit_possible(*given)[1] <= 1e-6 * 4.0

    def test_sigmas_along_the_edge(self) -> None:
        found = next(one for one, *_ in self.problems(4) if one.at_edge)
        ratio = np.diagonal(found.covariance) / np.diagonal(found.crlb)
        assert (ratio < 1.0 + 1e-9).all()
        assert ratio.min() < 0.9


class TestWindows:
    def test_without_noise_the_body_comes_back(self) -> None:
        data = record(BOX, 2000, force=0.0, torque=0.0)
        del data["angular_acceleration"]
        found = fitted(**data)
        assert found.window is not None
        assert np.allclose(found.estimate, numbers(BOX), atol=2e-5)

    def test_errors_are_as_large_as_the_covariance_says(self) -> None:
        squares = []
        for seed in range(40):
            data = record(BOX, 800, seed, spin=0.02, rate=2.0)
            del data["angular_acceleration"]
            found = fitted(**data, **SIGMAS)
            off = found.estimate - numbers(BOX)
            squares.append(off @ np.linalg.solve(found.crlb, off))
        assert 8.0 < np.mean(squares) < 13.0

    def compare(self, rate: float, spin: float, seeds: int) -> tuple[float, float, float]:
        """Errors of wrenches predicted on another motion, by those of central differences with the best
        smoothing, by those of a fit that knows the true motion, and by the bound."""
        signal = pytest.importorskip("scipy.signal")
        ours: list[float] = []
        known: list[float] = []
        least: list[float] = []
        theirs: dict[int, list[float]] = {window: [] for window in (5, 11, 21, 41, 61, 81, 121, 161)}
        for seed in range(seeds):
            data, other = record(BOX, 1000, seed, spin=spin, rate=rate), record(BOX, 300, 100 + seed)
            motion = other["omega"], other["angular_acceleration"], other["specific_force"]

            def off(body: RigidBody, motion: Any = motion) -> float:
                return float(np.mean(((predicted(body, *motion) - predicted(BOX, *motion)) * WEIGHTS) ** 2))

            true = data | {"omega": record(BOX, 1000, seed, rate=rate)["omega"]}
            known.append(off(fitted(**true).body))
            least.append(bound(true, motion, spin, rate))
            del data["angular_acceleration"]
            ours.append(off(fitted(**data).body))
            for window, errors in theirs.items():
                smooth = signal.savgol_filter(data["omega"], window, 3, axis=0)
                turn = np.gradient(smooth, data["t"], axis=0)
                errors.append(off(fitted(**data | {"omega": smooth}, angular_acceleration=turn).body))
        best = min(np.mean(errors) for errors in theirs.values())
        by_best, by_known, by_bound = (
            float(np.sqrt(np.mean(ours) / other)) for other in (best, np.mean(known), np.mean(least))
        )
        return by_best, by_known, by_bound

    def test_a_noisy_gyro_beats_differences(self) -> None:
        assert self.compare(2.0, 0.1, 5)[0] < 0.7

    @pytest.mark.long
    @pytest.mark.parametrize("rate", [0.5, 1.0, 2.0, 4.0])
    @pytest.mark.parametrize("spin", [0.1, 0.3])
    def test_a_noisy_gyro_beats_differences_at_any_speed(self, rate: float, spin: float) -> None:
        by_best, _, by_bound = self.compare(rate, spin, 24)
        if (rate, spin) != (0.5, 0.1):
            assert by_best < 0.7
            return
        # The bound itself is 0.8 of the error of differences.
        assert 0.75 < by_best / by_bound < 0.85
        assert by_bound < 1.1  # known to 0.08

    @pytest.mark.parametrize("rate", [0.5, 2.0])
    def test_a_quiet_gyro_is_as_good_as_the_true_motion(self, rate: float) -> None:
        """Where no method can be better than differences."""
        assert self.compare(rate, 0.003, 5)[1] < 1.1

    def test_times_that_are_not_even(self) -> None:
        data = record(BOX, 1000, spin=0.05)
        rng = np.random.default_rng(7)
        keep = np.sort(rng.permutation(1000)[:850])
        keep = keep[(keep < 450) | (keep >= 480)]
        rows = {name: one[keep] for name, one in data.items() if name != "angular_acceleration"}
        found = fitted(**rows, **SIGMAS, omega_sigma=0.05)
        assert found.dropped.get("outside windows", 0) < 80  # a tenth
        off = found.estimate - numbers(BOX)
        assert off @ np.linalg.solve(found.crlb, off) < 35.0  # chi-square with 10 degrees: 1e-4
        assert 1e-3 < found.p_value < 0.999

    def test_a_window_of_too_many_cycles(self) -> None:
        data = record(BOX, 1200, rate=18.0, end=12.0)
        del data["angular_acceleration"]
        with pytest.raises(ValueError, match="cycles of the fastest motion") as caught:
            fitted(**data, window=1200)
        most = int(str(caught.value).split(" rows; or")[0].split()[-1])
        assert fitted(**data, window=most).window == most

    def test_a_motion_that_is_sampled_too_coarsely(self) -> None:
        """Eight samples a cycle of the fastest motion of three, and fewer."""
        for rate, coarse in ((22.0, False), (28.0, True)):
            data = record(BOX, 1000, rate=rate)
            del data["angular_acceleration"]
            if not coarse:
                off = (fitted(**data).estimate - numbers(BOX)) / numbers(BOX)[0]
                assert np.abs(off).max() < 0.01
                continue
            with pytest.raises(IdentificationError, match="samples a cycle") as caught:
                fitted(**data)
            assert caught.value.kind == "undetermined"

    def test_few_rows(self) -> None:
        data = record(BOX, 40)
        del data["angular_acceleration"]
        data["omega"][1:] = np.nan
        with pytest.raises(IdentificationError, match="too few"):
            fitted(**data)

    def test_a_gap_ends_no_window_in_its_middle(self) -> None:
        data = record(BOX, 2000)
        keep = np.ones(2000, dtype=bool)
        keep[720:790] = False
        rows = {name: one[keep] for name, one in data.items() if name != "angular_acceleration"}
        found = fitted(**rows, **SIGMAS, window=100)
        assert found.dropped == {"outside windows": 30}  # 20 of 720 before the gap, 10 of 1210 after
        off = (found.estimate - numbers(BOX)) / np.sqrt(np.diagonal(found.crlb))
        assert np.abs(off).max() < 5.0


class TestLittleIsTold:
    def refused(self, **data: Any) -> set[str]:
        with pytest.raises(IdentificationError, match="undetermined") as caught:
            fitted(**data, **SIGMAS)
        assert caught.value.kind == "undetermined"
        return {one.words for one in caught.value.observability}

    TENSOR = ("the moment about x", "the moment about y", "the moment about z")
    PRODUCTS = tuple(f"the product of inertia {pair}" for pair in ("xy", "xz", "yz"))

    def test_poses_at_rest(self) -> None:
        assert self.refused(**record(BOX, swing=0.0)) == {*self.TENSOR, *self.PRODUCTS}

    def test_slow_poses_are_told_and_mass_and_centre_are_not(self) -> None:
        found = fitted(**record(BOX, swing=0.02), **SIGMAS)
        words = " ".join(one.words for one in found.observability)
        assert "moment" in words
        assert "mass" not in words
        assert abs(found.body.mass - 2.0) < 0.1

    def test_turns_about_one_axis(self) -> None:
        data = record(BOX)
        about = np.array([0.0, 0.0, 1.0])
        spin, turn = data["omega"][:, 2:] * about, data["angular_acceleration"][:, 2:] * about
        wrench = predicted(BOX, spin, turn, data["specific_force"])
        data |= {"omega": spin, "angular_acceleration": turn, "force": wrench[:, :3], "torque": wrench[:, 3:]}
        assert self.refused(**data) == {
            "the moment about x",
            "the moment about y",
            "the product of inertia xy",
        }

    def test_the_other_sign_and_too_small_sigmas_fit_badly(self) -> None:
        data = record(BOX)
        for changed in ({"force_sigma": 0.05}, {"force": -data["force"], "torque": -data["torque"]}):
            with pytest.raises(IdentificationError, match="chi2 is") as caught:
                fitted(**data | SIGMAS | changed)
            assert caught.value.kind == "no fit"


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"force": np.zeros((3, 3))}, "force: expected shape"),
        ({"t": np.zeros(800)}, "time does not ascend from row 0"),
        ({"force_sigma": -1.0}, "force_sigma: expected a positive number"),
        ({"loss": "huber"}, "loss: expected 'gaussian' or 'student'"),
        ({"window": 100}, "window: with angular_acceleration"),
        ({"at": (0.0, np.nan, 0.0)}, "at: expected a point"),
        ({"prior": BOX}, "prior: expected one body with a covariance"),
        ({"force": np.zeros((800, 3))}, "no payload is there"),
        ({"angular_acceleration": None, "window": 5}, "window: expected a whole number"),
    ],
)
def test_bad_input(changed: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        fitted(**record(BOX) | changed)


def test_a_probability_of_chi_square() -> None:
    special = pytest.importorskip("scipy.special")
    from polhode.identify.results import p_value_of

    for freedom in (1, 2, 7, 100, 12_000):
        for share in (0.01, 0.5, 0.97, 1.0, 1.02, 1.5, 3.0):
            found, want = (
                p_value_of(share * freedom, freedom),
                special.gammaincc(freedom / 2, share * freedom / 2),
            )
            assert found == pytest.approx(want, rel=1e-9, abs=1e-12)
