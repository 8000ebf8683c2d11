"""The period of a gyrostat next to a separatrix, against 80 digits: by the pencil of energy and momentum."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf
from polhode import RigidBody

if TYPE_CHECKING:
    from polhode import GyrostatMotion

TURN = np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]])
"""Three times a rotation: what it makes of whole numbers is exact."""


def period(moments: Any, momentum: Any, omega: Any) -> Any:
    """Give det I · 2∫dx/y over a positive lobe of y² = det(Q_T − x Q_L), by the arithmetic-geometric mean."""
    inertia, h, w = mpmath.diag(moments), mpmath.matrix(momentum), mpmath.matrix(omega)
    twice = (w.T * inertia * w)[0]
    whole = inertia * w + h
    rest = (h.T * h)[0] - (whole.T * whole)[0]
    inside = inertia * h

    def determinant(x: Any) -> Any:
        matrix = mpmath.matrix(4, 4)
        matrix[:3, :3] = inertia - x * inertia * inertia
        for i in range(3):
            matrix[i, 3] = matrix[3, i] = -x * inside[i]
        matrix[3, 3] = -twice - x * rest
        return mpmath.det(matrix)

    places = [mpf(k) / 4 for k in range(5)]
    powers = mpmath.matrix([[x**k for k in range(4, -1, -1)] for x in places])
    a, b, c, d, e = mpmath.lu_solve(powers, mpmath.matrix([determinant(x) for x in places]))
    b, c, d = b / 4, c / 6, d / 4
    second = a * e - 4 * b * d + 3 * c * c
    third = a * c * e + 2 * b * c * d - a * d * d - b * b * e - c**3
    roots = mpmath.polyroots([4, 0, -second, -third], maxsteps=500, extraprec=800)
    real = sorted(x.real for x in roots if abs(x.imag) < mpf(10) ** -60 * abs(x))
    root = real[-1]
    height = mpmath.sqrt(3 * root**2 - second / 4)
    mean = mpmath.agm(2 * mpmath.sqrt(height), mpmath.sqrt(3 * root + 2 * height))
    return 2 * mpmath.pi / mean * mpmath.det(inertia)


def turned(moments: Any, momentum: Any, omega: Any) -> GyrostatMotion:
    """Give the motion with other axes, three times as fast; the products of the tensor are whole numbers."""
    tensor = TURN @ np.diag(moments) @ TURN.T
    return RigidBody(1.0, tensor).gyrostat(9 * TURN @ momentum).free_motion(TURN @ omega)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("power", range(10, 53, 3))
@pytest.mark.parametrize(
    ("moments", "momentum", "omega"),
    [
        ((2.0, 3.0, 4.0), (1.0, 1.0, 2.0), (-2.5, 1.0, -2.5)),
        ((3.0, 4.0, 6.0), (2.5, 0.0, -1.0), (-1.5, 1.0, -1.5)),
        ((2.0, 3.0, 4.0), (0.0, 0.0, 2.0), (2.0, 0.0, -0.5)),
    ],
    ids=["h along none", "h in a plane", "h along the third axis"],
)
def test_next_to_a_separatrix_it_has_all_its_digits(
    moments: Any, momentum: Any, omega: Any, power: int, sign: int
) -> None:
    start = np.array(omega) * [1 + sign * 2.0**-power, 1, 1]
    body = RigidBody.from_principal(1.0, moments)
    with mp.workdps(80):
        exact = period(moments, momentum, start)
        for found, want in (
            (body.gyrostat(momentum).free_motion(start).period, exact),
            (turned(moments, momentum, start).period, exact / 3),
        ):
            assert abs(mpf(float(found)) / want - 1) <= 4e-16
