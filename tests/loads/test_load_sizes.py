"""Torques and rates of any size: bodies at rest or hardly rotating."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, loads
from scipy.interpolate import CubicSpline


@pytest.mark.parametrize("frame", ["body", "space"])
@pytest.mark.parametrize("size", [1e230, 1e40, 1e-10, 1e-20, 1e-40, 1e-80, 1e-160, 1e-300])
def test_a_sampled_torque_of_any_size_on_a_body_at_rest(size: float, frame: Any) -> None:
    """Seconds between the samples, zero at one sample, at all but one, or nowhere."""
    t = np.array([0.0, 1.0, 3.0, 6.0])
    # So heavy that it does not turn far.
    moments = np.array([1.0, 1.4, 1.9]) * max(1.0, 1e12 * size)
    body = RigidBody.from_principal(1.0, moments)
    for rows in (*np.eye(4), 1 - np.eye(4)[1], np.ones(4)):
        values = size * np.outer(rows, (1.0, -2.0, 0.5))
        want = CubicSpline(t, values).antiderivative()
        for times in (t, t[::-1]):
            exact = (want(times) - want(times[0])) / moments
            got = body.simulate(times, (0, 0, 0), load=loads.sampled(t, values, frame))
            assert np.abs(got.omega - exact).max() < 1e-10 * np.abs(exact).max()


@pytest.mark.parametrize("moment", [1e-40, 1.0, 1e30])
@pytest.mark.parametrize("begins", [0.0, 1e-300, 1e-40, 1e-16, 1e-12, 1e-9, 1e-7, 1e-5, 1e-2, -1e-9, -1e-40])
def test_quadratic_damping_from_hardly_any_rotation(begins: float, moment: float) -> None:
    """I ω̇ = N − s ω|ω|: from ω₀ on ω is √(N/s) tanh; a tiny ω₀ < 0 is as good as zero."""
    torque, quadratic = 2.0 * moment, 0.5 * moment
    body = RigidBody.from_principal(1.0, moment * np.array([1.0, 1.0, 1.5]))
    load = loads.constant_torque((0, 0, torque)) + loads.damping(0.0, quadratic=quadratic)
    times = np.array([0.0, 1e-3, 1.0, 3.0])
    got = body.simulate(times, (0, 0, begins), load=load, method="taylor", rtol=1e-13)
    end, rate = np.sqrt(torque / quadratic), np.sqrt(torque * quadratic) / (1.5 * moment)
    exact = end * np.tanh(rate * times + np.arctanh(begins / end))
    assert np.abs(got.omega[1:, 2] / exact[1:] - 1).max() < 1e-12


@pytest.mark.parametrize("amplitude", [1e-20, 1e-13, 1e-9])
def test_quadratic_damping_of_tiny_oscillations(amplitude: float) -> None:
    """φ̈ = −φ − s φ̇|φ̇|: with s times the amplitude the same, so is the motion over its amplitude."""
    body, times = RigidBody.from_principal(1.0, (1.0, 1.0, 1.0)), np.linspace(0.0, 30.0, 40)

    def run(size: float) -> np.ndarray:
        load = loads.feedback(2.0, 0.0) + loads.damping(0.0, quadratic=0.3 / size)
        return body.simulate(times, (0, 0, size), load=load, method="taylor", rtol=1e-13).omega[:, 2] / size

    assert np.abs(run(1e-6)).max(where=times > 20, initial=0.0) < 0.3
    assert np.abs(run(amplitude) - run(1e-6)).max() < 1e-10
