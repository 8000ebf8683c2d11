"""What bodies with wheels and slugs keep: momentum at any scale and over long times, balance of energy."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from polhode import RigidBody, Trajectory, loads

if TYPE_CHECKING:
    from collections.abc import Callable


@settings(max_examples=25, deadline=None)
@given(
    moments=st.tuples(*[st.floats(1.0, 1.9)] * 3),
    omega=st.tuples(*[st.floats(-3, 3)] * 3),
    axis=st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda a: np.linalg.norm(a) > 0.1),
    numbers=st.tuples(
        st.floats(0.01, 0.9), st.floats(-50, 50), st.floats(0, 2), st.floats(0.01, 2), st.floats(0, 2)
    ),
    scale=st.sampled_from([1e-30, 1.0, 1e25]),
)
def test_momentum_is_kept_at_any_scale(
    moments: Any, omega: Any, axis: Any, numbers: Any, scale: float
) -> None:
    inertia, rate, friction, slug, damping = numbers
    body = RigidBody.from_principal(scale, np.multiply(moments, scale))
    load = loads.wheel(axis, inertia * scale, rate, friction=friction * scale) + loads.slug(
        slug * scale, damping * scale
    )
    run = body.simulate([0, 1, 5], omega, load=load, rtol=2.3e-15)
    spin = run.angular_momentum().spin / scale
    size = np.linalg.norm(spin[0]) + np.linalg.norm(omega) + abs(inertia * rate)
    assert np.abs(spin - spin[0]).max() <= 1e-13 * size
    energy = run.kinetic_energy().total / scale
    assert (np.diff(energy) <= 1e-12 * size**2).all()


@pytest.mark.parametrize(("rtol", "allowed"), [(1e-20, 1e-14), (2.3e-15, 2e-13)])
@pytest.mark.parametrize("name", ["slug", "driven"])
def test_momentum_over_ten_thousand_rotations(name: str, rtol: float, allowed: float) -> None:
    """In doubles its error grows as the root of the steps; beyond them nothing is lost."""
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    omega = np.array([0.3, 0.4, 1.1])
    end = 2e4 * np.pi / np.linalg.norm(omega)
    times = np.linspace(0, end, 1000, endpoint=False)
    all_loads = {
        "slug": loads.slug(0.1, 1e-3),
        "driven": loads.wheel((1, 2, 2), 0.1, 3.0, torque=np.tile([0.01, -0.01], 500), times=times),
    }
    run = body.simulate(np.array([0, end / 2, end]), omega, load=all_loads[name], method="taylor", rtol=rtol)
    spin = run.angular_momentum().spin
    assert np.linalg.norm(spin - spin[0], axis=1).max() <= allowed * np.linalg.norm(spin[0])


class TestEnergyBalance:
    """What the energy loses over ten thousand rotations is the work that bearings and motors do."""

    BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    OMEGA = np.array([0.3, 0.4, 1.1])
    END = 53000.0

    def error(self, load: loads.Load, power: Callable[[Trajectory], np.ndarray]) -> float:
        """Integrate the power by Gauss's formula, on pieces of one second."""
        x, weights = np.polynomial.legendre.leggauss(12)
        inside = (np.arange(self.END)[:, None] + 0.5 * (x + 1)).ravel()
        times = np.concatenate([[0.0], inside, [self.END]])
        run = self.BODY.simulate(times, self.OMEGA, load=load, method="taylor", rtol=1e-20)
        work = math.fsum(power(run)[1:-1].reshape(-1, 12) @ weights * 0.5)
        energy = run.kinetic_energy().total
        assert abs(work) > 1e-3 * energy[0]
        return float(abs(energy[-1] - energy[0] - work) / energy[0])

    def test_a_slug(self) -> None:
        def power(run: Trajectory) -> Any:
            return -1e-3 * ((run.states["slug"] - run.omega) ** 2).sum(1)

        assert self.error(loads.slug(0.1, 1e-3), power) <= 1e-15

    def test_a_motor_and_friction(self) -> None:
        times, torques = np.arange(1000) * 53.0, np.tile([0.01, -0.01], 500)

        def power(run: Trajectory) -> Any:
            speed = run.states["wheel"][:, 0] / 0.1 - run.omega @ (np.array([1, 2, 2]) / 3)
            motor = torques[np.searchsorted(times, run.t, side="right") - 1]
            return motor * speed - 1e-3 * speed**2

        wheel = loads.wheel((1, 2, 2), 0.1, 3.0, torque=torques, times=times, friction=1e-3)
        assert self.error(wheel, power) <= 1e-13

    @pytest.mark.parametrize(
        ("method", "rtol", "rotations"),
        [
            ("dop853", 1e-14, 30),
            ("radau", 1e-12, 10),
            pytest.param("dop853", 1e-14, 10_000, marks=pytest.mark.long),
        ],
    )
    @pytest.mark.parametrize("name", ["slug", "wheel"])
    def test_the_work_as_one_more_state_of_the_run(
        self, name: str, method: Any, rtol: float, rotations: int
    ) -> None:
        along = np.array([1, 2, 2]) / 3

        def power(_t: float, omega: Any, _q: Any, _r: Any, _v: Any, states: Any) -> float:
            if name == "slug":
                slip = states["slug"] - omega
                return -1e-3 * float(slip @ slip)
            speed = float(states["wheel"][0] / 0.1 - omega @ along)
            return (0.002 - 1e-3 * speed) * speed

        inside = {
            "slug": loads.slug(0.1, 1e-3),
            "wheel": loads.wheel((1, 2, 2), 0.1, 3.0, torque=0.002, friction=1e-3),
        }
        load = inside[name] + loads.with_states(power, [0.0], name="work", scale=1.0)
        end = rotations * 2 * np.pi / float(np.linalg.norm(self.OMEGA))
        run = self.BODY.simulate([0.0, end], self.OMEGA, load=load, method=method, rtol=rtol)
        energy, work = run.kinetic_energy().total, run.states["work"][-1, 0]
        assert abs(work) > 1e-3 * energy[0]
        assert abs(energy[-1] - energy[0] - work) <= 1e-13 * energy[0]
