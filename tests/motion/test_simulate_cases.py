"""`simulate` against forty digits under every load, with the condition number of each case in its bar."""

from __future__ import annotations

from functools import reduce
from operator import add
from typing import Any

import numpy as np
import pytest
from oracles import load_cases
from oracles.by_scipy import by_dop853
from oracles.motion_cases import MotionCase, angle, load_table, named, relative_error
from polhode import RigidBody, Trajectory, loads, orbits

CASES = load_table(load_cases.NAME)
MATRICES = ("matrix", "quadratic", "K", "D")
EPSILON = float(np.finfo(float).eps)
TIGHTEST = 2.3e-15
ROUNDING = 4e-16
"""Of four components of a quaternion, as an angle."""


def load_of(case: MotionCase) -> Any:
    """The sum of the case's loads."""
    return reduce(add, (_load(dict(term)) for term in case.load))


def _load(term: dict[str, Any]) -> Any:
    kind = term.pop("kind")
    if kind == "sinusoidal_torque":
        vector, rate, phase = np.array(term["vector"]), term["rate"], term["phase"]
        return loads.torque_callback(lambda t, _omega, _q: vector * np.sin(rate * t + phase))
    return getattr(loads, kind)(**{key: _matrix(x) if key in MATRICES else x for key, x in term.items()})


def _matrix(x: Any) -> Any:
    return x * np.eye(3) if np.ndim(x) == 0 else x


def body_of(case: MotionCase) -> RigidBody:
    return (RigidBody.from_principal if "moments" in case.body else RigidBody)(**case.body)


def simulated(case: MotionCase, method: Any, rtol: float) -> Trajectory:
    path: dict[str, Any] = {"position": case.position, "velocity": case.velocity} if case.position else {}
    return body_of(case).simulate(
        [0.0, *case.times],
        case.omega,
        case.attitude,
        load=load_of(case),
        about=case.about,
        method=method,
        rtol=rtol,
        **path,
    )


def errors(case: MotionCase, trajectory: Trajectory) -> list[float]:
    """The largest error of attitude, rates and path at each time."""
    rate = float(np.linalg.norm(case.omega))
    found = []
    for i, want in enumerate(case.expected, start=1):
        parts = [
            angle(trajectory.quaternion[i], want.quaternion),
            relative_error(trajectory.omega[i], want.omega, at_least=rate),
        ]
        if case.position:
            parts.append(relative_error(trajectory.position[i], want.position))
            parts.append(relative_error(trajectory.velocity[i], want.velocity))
        found.append(max(parts))
    return found


def is_stiff(case: MotionCase) -> bool:
    return "stiff" in case.name


def test_the_table_reaches_a_hundred_rotations_and_chaos() -> None:
    turns = [case.times[-1] * np.linalg.norm(case.omega) / (2 * np.pi) for case in CASES]
    assert sum(turn > 99.0 for turn in turns) >= 2
    assert sum(turn > 9.9 for turn in turns) >= len(CASES) - 1
    assert max(max(case.kappa) for case in CASES) > 1e4


@named(case for case in CASES if "sinusoidal" not in case.name)
def test_taylor(case: MotionCase) -> None:
    for error, kappa in zip(errors(case, simulated(case, "taylor", TIGHTEST)), case.kappa, strict=True):
        assert error <= 1e-13 + 30 * kappa * EPSILON


@named(case for case in CASES if "sinusoidal" not in case.name)
def test_taylor_to_the_last_digit(case: MotionCase) -> None:
    """Beyond doubles the result is the exact one, rounded, while 28 digits are enough for the start."""
    found = errors(case, simulated(case, "taylor", 1e-27))
    for error, kappa in zip(found, case.kappa, strict=True):
        assert error <= ROUNDING + 1e-28 * kappa


# An explicit method on a stiff case stands at the limit of its stability: those are for "radau".
SMOOTH = named(case for case in CASES if not is_stiff(case))


@SMOOTH
def test_dop853(case: MotionCase) -> None:
    assert_dop853(case, TIGHTEST)


@SMOOTH
def test_dop853_holds_its_bar_soon_at_a_looser_tolerance(case: MotionCase) -> None:
    soon: dict[str, Any] = {"times": case.times[:2], "expected": case.expected[:2], "kappa": case.kappa[:2]}
    assert_dop853(case._replace(**soon), 1e-13)


def assert_dop853(case: MotionCase, rtol: float) -> None:
    rotation = 2 * np.pi / np.linalg.norm(case.omega)
    found = errors(case, simulated(case, "dop853", rtol))
    for t, error, kappa in zip(case.times, found, case.kappa, strict=True):
        assert error <= (1e-11 if t < 10.5 * rotation else 1e-9) + 100 * kappa * EPSILON


@SMOOTH
@pytest.mark.parametrize("rtol", [1e-8, pytest.param(1e-11, marks=pytest.mark.long)])
def test_dop853_is_no_worse_than_that_of_scipy(case: MotionCase, rtol: float) -> None:
    """At ten rotations; SciPy's tolerance is absolute besides relative to each component."""
    last = max(i for i, t in enumerate(case.times) if t * np.linalg.norm(case.omega) < 21 * np.pi)
    soon = case._replace(times=case.times[: last + 1], expected=case.expected[: last + 1])
    ours = errors(soon, simulated(soon, "dop853", rtol))[-1]
    peer, want = by_dop853(case, case.times[last], rtol=rtol, atol=rtol), case.expected[last]
    theirs = [
        angle(peer.quaternion, want.quaternion),
        relative_error(peer.omega, want.omega, float(np.linalg.norm(case.omega))),
    ]
    if case.position:
        theirs.append(relative_error(peer.position, want.position))
        theirs.append(relative_error(peer.velocity, want.velocity))
    assert ours <= max(theirs)


class TestRadau:
    @named(case for case in CASES if is_stiff(case))
    def test_error(self, case: MotionCase) -> None:
        assert max(errors(case, simulated(case, "radau", 1e-10))) <= 1e-8

    @named(case for case in CASES if is_stiff(case))
    def test_steps_do_not_grow_with_the_stiffness(self, case: MotionCase) -> None:
        """The damping that is stiff up to a million times as strong."""
        (term,) = case.load
        matrix = np.array(term["matrix"])
        strong = matrix > 1.0
        t = [0.0, 6 * np.pi / float(np.linalg.norm(case.omega))]
        body, steps = body_of(case), []
        for factor in (1.0, 1e2, 1e4, 1e6):
            load = loads.damping(np.where(strong, factor * matrix, matrix))
            run = body.simulate(t, case.omega, case.attitude, load=load, method="radau", rtol=1e-10)
            steps.append(run.steps)
        assert max(steps) <= 1.05 * steps[0]

    @pytest.mark.parametrize("rtol", [1e-14, 1e-8])
    def test_a_push_on_a_body_at_rest(self, rtol: float) -> None:
        """Place and velocity begin at zero, and have no size there that errors could be relative to."""
        body, force = RigidBody.from_principal(2.0, (1.0, 2.0, 2.5)), np.array([0.3, -0.2, 0.1])
        load = loads.constant_force(force, "space", point=(0.5, 0.0, 0.0))
        run = body.simulate([0.0, 3.0], (0.3, 0.2, 1.1), load=load, method="radau", rtol=rtol)
        np.testing.assert_allclose(run.velocity[-1], 3.0 * force / 2.0, rtol=1e-13)
        np.testing.assert_allclose(run.position[-1], 4.5 * force / 2.0, rtol=1e-13)
        assert run.steps < 100 * (1e-8 / rtol) ** 0.25


def changes(case: MotionCase, rotations: float, rtol: float = 1e-10) -> Any:
    """ΔE/E of a heavy top by splitting, at four thousand times."""
    t = np.linspace(0.0, rotations * 2 * np.pi / np.linalg.norm(case.omega), 4001)
    body = body_of(case)
    run = body.simulate(
        t, case.omega, case.attitude, load=load_of(case), about="origin", method="splitting", rtol=rtol
    )
    (weight,) = case.load
    inertia = body.inertia_about((0.0, 0.0, 0.0))
    kinetic = 0.5 * np.einsum("ti,ij,tj->t", run.omega, inertia, run.omega)
    center = run.rotation.apply(body.center_of_mass)
    energy = kinetic - body.mass * center @ np.array(weight["gravity"])
    return energy[1:] / energy[0] - 1.0


def drifts(case: MotionCase, rotations: float) -> tuple[float, float]:
    """Largest |ΔE/E| in the first and in the second half of a run."""
    first, second = np.abs(changes(case, rotations)).reshape(2, -1).max(axis=1)
    return float(first), float(second)


REGULAR = ("heavy symmetric top: nodding", "Kovalevskaya top: generic")


@named(case for case in CASES if case.name in (*REGULAR, "heavy asymmetric top: fast"))
def test_splitting_keeps_the_energy_for_a_thousand_rotations(case: MotionCase) -> None:
    first, second = drifts(case, 1e3)
    assert first <= 1e-9
    assert second <= 1.5 * first + 1e-11


@named(case for case in CASES if case.name in REGULAR)
def test_rounding_does_not_move_the_energy(case: MotionCase) -> None:
    """What splitting swings by aside: its mean after ten thousand rotations is that of the first thousand."""
    means = changes(case, 1e4, rtol=1e-12).reshape(10, -1).mean(axis=1)
    assert np.abs(means - means[0]).max() < 2e-13


@pytest.mark.long
@pytest.mark.timeout(3600)
@named(case for case in CASES if case.name in REGULAR)
def test_splitting_keeps_the_energy_for_a_million_rotations(case: MotionCase) -> None:
    first, second = drifts(case, 1e6)
    assert second <= 1.5 * first + 1e-11


def test_radau_serves_the_tightest_tolerance() -> None:
    """Its iterations end there as well, and it agrees with the other method."""
    body = RigidBody(1.0, np.diag([1.0, 2.0, 2.5]))
    load = loads.constant_torque((0.2, -0.1, 0.4), "space")
    times, start = [0.0, 3.0], (0.1, 0.2, 3.0)
    found = body.simulate(times, start, load=load, method="radau", rtol=TIGHTEST)
    exact = body.simulate(times, start, load=load, method="taylor", rtol=TIGHTEST)
    assert np.abs(found.omega - exact.omega).max() < 1e-12
    assert np.abs(found.quaternion - exact.quaternion).max() < 1e-12
    assert found.steps < 10_000


def test_between_the_steps_of_splitting_the_load_knows_the_time() -> None:
    body = RigidBody(1.0, np.diag([1.0, 2.0, 2.5]))
    load = loads.gravity_gradient(orbits.kepler(1.0, (1.0, 0.0, 0.0), (0.0, 1.2, 0.0)))
    t = np.linspace(0.0, 9.7, 137)
    found = body.simulate(t, (0.1, 0.2, 1.0), load=load, method="splitting", rtol=1e-9)
    exact = body.simulate(t, (0.1, 0.2, 1.0), load=load, method="taylor", rtol=1e-13)
    assert found.steps < len(t) / 2
    assert np.abs(found.omega - exact.omega).max() < 1e-9
