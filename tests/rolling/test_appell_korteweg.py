"""The two constants of Appell and Korteweg: the spin of a disk is a Legendre function of its inclination.

With θ from the axis to the normal, ω₁ = θ' along the level line of the disk, ω₂ along its line of steepest
slope and ω₃ along its axis, Newton's and Euler's equations divided by θ' are
``dω₃/dθ = m a²/(C + m a²) ω₂`` and ``dω₂/dθ = C/A ω₃ − ω₂ cot θ``. So ω₃ = c₁ P(cos θ) + c₂ P(−cos θ) with
Legendre's function P of the degree ν for which ν(ν + 1) = −C m a²/(A (C + m a²)): complex for a disk and a
hoop. Source: Appell and Korteweg, Rendiconti del Circolo Matematico di Palermo 14 (1900) 1 and 7.
"""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from polhode import RigidBody, loads, rolling

G = loads.uniform_gravity((0, 0, -9.81))
MASS, RADIUS = 0.4, 0.5
SQUARE = MASS * RADIUS**2
BODIES = {
    "disk": (SQUARE / 4, SQUARE / 2),
    "hoop": (SQUARE / 2, SQUARE),
    "thick": (SQUARE / 3, SQUARE * 0.45),
}
STARTS = [(0.9, (0.4, 1.5, 6.0)), (1.3, (-1.0, 0.5, 9.0)), (0.5, (0.2, 4.0, -3.0)), (1.9, (0.3, -2.0, 7.0))]


def simulate(name: str, start: Any, t: Any) -> Any:
    across, along = BODIES[name]
    body = RigidBody.from_principal(MASS, (across, across, along))
    tilt, omega = start
    attitude = (np.sin(tilt / 2), 0.0, 0.0, np.cos(tilt / 2))
    contact = rolling.plane(rolling.disk(RADIUS))
    return body.simulate(t, omega, attitude, load=G, contact=contact, rtol=2.3e-15)


def solutions(name: str, cosine: float) -> mpmath.matrix:
    """ω₃ and ω₂ of P(cos θ) and of P(−cos θ), as columns."""
    across, along = (mpmath.mpf(one) for one in BODIES[name])
    square = mpmath.mpf(SQUARE)
    product = -along * square / (across * (along + square))
    nu = (-1 + mpmath.sqrt(mpmath.mpc(1 + 4 * product))) / 2
    assert abs(mpmath.im(nu)) > 0
    sine, factor = mpmath.sqrt(1 - mpmath.mpf(cosine) ** 2), (along + square) / square

    def function(x: Any) -> tuple[Any, Any]:
        """P and dP/dx."""
        z = (1 - x) / 2
        value = mpmath.hyp2f1(-nu, nu + 1, 1, z)
        rate = nu * (nu + 1) / 2 * mpmath.hyp2f1(1 - nu, nu + 2, 2, z)
        return mpmath.re(value), mpmath.re(rate)

    (one, rate_one), (other, rate_other) = function(mpmath.mpf(cosine)), function(-mpmath.mpf(cosine))
    return mpmath.matrix([[one, other], [-sine * factor * rate_one, sine * factor * rate_other]])


def constants(name: str, omega: Any, quaternion: Any) -> tuple[Any, float]:
    """c₁ and c₂ of a state, and the condition of the matrix that gives them."""
    x, y, z, w = (mpmath.mpf(float(one)) for one in quaternion)
    normal = [2 * (x * z - w * y), 2 * (y * z + w * x), w * w + z * z - x * x - y * y]
    size = mpmath.sqrt(sum(one * one for one in normal))
    normal = [one / size for one in normal]
    sine = mpmath.sqrt(normal[0] ** 2 + normal[1] ** 2)
    across = (normal[0] * mpmath.mpf(float(omega[0])) + normal[1] * mpmath.mpf(float(omega[1]))) / sine
    matrix = solutions(name, normal[2])
    found = mpmath.lu_solve(matrix, mpmath.matrix([mpmath.mpf(float(omega[2])), across]))
    return np.array([float(one) for one in found]), float(mpmath.cond(matrix))


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("name", BODIES)
def test_both_are_kept(name: str, start: Any) -> None:
    """At every output, within the rounding of one state times the condition of the constants."""
    motion = simulate(name, start, np.linspace(0, 12, 13))
    with mpmath.workdps(30):
        found = [constants(name, *state) for state in zip(motion.omega, motion.quaternion, strict=True)]
    values = np.array([one for one, _ in found])
    size = np.abs(values[0]).max()
    worst = max(condition for _, condition in found)
    inclination = np.arccos(motion.rotation.as_matrix()[:, 2, 2])
    assert np.ptp(inclination) > 0.02  # it nods, so that the constants say something
    assert np.abs(values - values[0]).max() / size < 2e-14 * (1 + worst)


def test_they_are_no_constants_of_another_disk() -> None:
    """With the moments of a hoop the numbers of a disk do change."""
    motion = simulate("disk", STARTS[0], np.linspace(0, 12, 13))
    with mpmath.workdps(30):
        values = np.array(
            [constants("hoop", *state)[0] for state in zip(motion.omega, motion.quaternion, strict=True)]
        )
    assert np.ptp(values, axis=0).max() / np.abs(values[0]).max() > 1e-3


@pytest.mark.long
@pytest.mark.parametrize("name", ["disk", "hoop"])
def test_ten_thousand_rotations(name: str) -> None:
    """Both within 1e-12, and no slope over time beyond three of its standard errors."""
    rate = float(np.linalg.norm(STARTS[1][1]))
    motion = simulate(name, STARTS[1], np.linspace(0, 2 * np.pi * 10_000 / rate, 2001))
    with mpmath.workdps(25):
        values = np.array(
            [constants(name, *state)[0] for state in zip(motion.omega, motion.quaternion, strict=True)]
        )
    off = (values - values[0]) / np.abs(values[0]).max()
    assert np.abs(off).max() <= 1e-12
    steps = np.diff(off, axis=0)  # rounding adds up as a random walk
    assert (np.abs(steps.mean(axis=0)) < 3 * steps.std(axis=0, ddof=1) / np.sqrt(len(steps))).all()
