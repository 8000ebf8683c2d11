"""Taylor series against the committed cases to forty digits, in stacks, and where they do not serve."""

from __future__ import annotations

import _thread
import threading
import time
from typing import Any

import numpy as np
import pytest
from oracles import free_cases, load_cases, top_cases
from oracles.motion_cases import MotionCase, angle, load_table, relative_error
from polhode import RigidBody, loads, solids

TIGHTEST = 2.3e-15
TORN = 1e4
"""Neighbours that part by more are no neighbours in doubles."""
CASES = load_table(free_cases.NAME) + load_table(top_cases.NAME)
BRICK = solids.box((8.0, 4.0, 2.25), mass=1.0)


def motion(case: MotionCase, omega: Any, attitude: Any, t: float) -> Any:
    """Rates and attitude at `t`."""
    given = dict(case.body)
    body = RigidBody.from_principal(**given) if "moments" in given else RigidBody(**given)
    load = loads.uniform_gravity(case.gravity) if case.gravity else None
    trajectory = body.simulate(
        [0.0, t], omega, attitude, load=load, about=case.about, method="taylor", rtol=TIGHTEST
    )
    return trajectory.omega[-1], trajectory.quaternion[-1]


def product(a: Any, b: Any) -> np.ndarray:
    (u, p), (v, s) = (a[:3], a[3]), (b[:3], b[3])
    return np.array([*(p * v + s * u + np.cross(u, v)), p * s - u @ v])


def condition(case: MotionCase, n: int) -> float:
    """‖∂(attitude, ω/|ω₀|)(t)/∂(attitude, ω/|ω₀|)(0)‖₂ at the time number n.

    By differences that stay small while neighbours part a thousandfold; where they part further, with 32
    digits.
    """
    speed, small = float(np.linalg.norm(case.omega)), 1e-11
    q = np.array(case.attitude) / np.linalg.norm(case.attitude)
    columns = []
    for k in range(6):
        ends = []
        for side in (small, -small):
            turn, omega = np.array([0.0, 0.0, 0.0, 1.0]), np.array(case.omega)
            if k < 3:
                turn[k] = side / 2
            else:
                omega[k - 3] += side * speed
            ends.append(motion(case, omega, product(q, turn / np.linalg.norm(turn)), case.times[n]))
        (w, p), (v, s) = ends
        turned = 2 * product(s * [-1, -1, -1, 1], p)
        columns.append(np.concatenate([turned[:3] * np.sign(turned[3]), (w - v) / speed]) / (2 * small))
    kappa = float(np.linalg.norm(np.array(columns), 2))
    return kappa if kappa < TORN else exact_condition(case, n)


def exact_condition(case: MotionCase, n: int) -> float:
    """As `condition`, without our integrator."""
    weight = ({"kind": "uniform_gravity", "gravity": case.gravity},) if case.gravity else ()
    return load_cases.condition(case._replace(times=case.times[n : n + 1], load=weight), 32)[0]


# They miss the bar at ten rotations: error, and what is allowed. All pass closely by an unstable
# motion: what is rounded in between grows by κ(t, s), the more the closer, while κ(t, 0) is small
# once more.
MISSES = {
    "near the separatrix: off the intermediate axis by 0.001": "9.1e-12, not 4.5e-12",
    "near the separatrix: off the intermediate axis by 1e-08": "4.3e-11, not 3.1e-13",
    "near the separatrix: off the intermediate axis by 1e-05, long": "1.2e-8, not 3.1e-10",
    "sleeping, unstable: 1e-2 off": "6.1e-12, not 2.5e-12",
    "sleeping, unstable: pushed 1e-9": "8.4e-8, not 3.0e-13",
}


def marked(case: MotionCase) -> Any:
    if case.name not in MISSES:
        return pytest.param(case, id=case.name)
    missed = pytest.mark.xfail(strict=True, reason=f"misses 1e-13 + 30 κ ε: {MISSES[case.name]}")
    return pytest.param(case, id=case.name, marks=missed)


@pytest.mark.parametrize("case", [marked(case) for case in CASES])
def test_ten_rotations_to_the_last_digits(case: MotionCase) -> None:
    for n, want in enumerate(case.expected[:2]):
        omega, quaternion = motion(case, case.omega, case.attitude, case.times[n])
        speed = float(np.linalg.norm(case.omega))
        error = max(angle(quaternion, want.quaternion), relative_error(omega, want.omega, speed))
        assert error <= 1e-13 + 30 * 1.1e-16 * condition(case, n)


class TestStacks:
    @pytest.mark.parametrize("load", [None, loads.uniform_gravity((0.0, 0.0, -9.81))])
    def test_a_row_alone_has_the_bits_of_the_row_in_the_stack(self, load: Any, rng: Any) -> None:
        body, t = BRICK.translated((1.0, 0.5, 2.0)), np.linspace(0.0, 20.0, 7)
        starts = rng.normal(size=(50, 3))
        together = body.simulate(t, starts, load=load, about="origin", method="taylor")
        for row in range(0, 50, 7):
            alone = body.simulate(t, starts[row], load=load, about="origin", method="taylor")
            assert np.array_equal(alone.omega, together.omega[row])
            assert np.array_equal(alone.quaternion, together.quaternion[row])
            assert alone.steps == together.steps[row]

    def test_loads_differ_from_row_to_row(self) -> None:
        torques = np.array([[0.0, 0.0, 1.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.0]])
        t = [0.0, 3.0]
        together = BRICK.simulate(t, np.zeros(3), load=loads.constant_torque(torques), method="taylor")
        for row, torque in enumerate(torques):
            alone = BRICK.simulate(t, np.zeros(3), load=loads.constant_torque(torque), method="taylor")
            assert np.array_equal(alone.omega, together.omega[row])


class TestChoice:
    def test_auto_takes_it_for_analytic_loads(self) -> None:
        load = loads.constant_torque((0.1, 0.2, 0.3), "space")
        t, start = np.linspace(0.0, 9.0, 5), (0.5, -1.0, 0.25)
        auto = BRICK.simulate(t, start, load=load)
        named = BRICK.simulate(t, start, load=load, method="taylor")
        assert np.array_equal(auto.omega, named.omega)
        assert np.array_equal(auto.quaternion, named.quaternion)
        other = BRICK.simulate(t, start, load=load, method="dop853", rtol=1e-13)
        assert np.abs(named.omega - other.omega).max() < 1e-9

    def test_it_says_what_it_needs(self) -> None:
        callback = loads.torque_callback(lambda _t, _omega, _quaternion: np.zeros(3))
        with pytest.raises(ValueError, match=r'method="taylor".*callbacks.*method="dop853"'):
            BRICK.simulate([0.0, 1.0], (1.0, 0.0, 0.0), load=callback, method="taylor")


@pytest.mark.parametrize("count", [1, 3000])
def test_ctrl_c_ends_a_long_run_soon(count: int) -> None:
    starts = np.ones((count, 3)) if count > 1 else np.ones(3)
    threading.Timer(0.3, _thread.interrupt_main).start()
    began = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        BRICK.simulate([0.0, 1e9], starts, method="taylor")
    assert time.perf_counter() - began < 1.0
