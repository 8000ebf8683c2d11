"""The free asymmetric body in closed form, with mpmath: Jacobi's functions and Legendre's third integral.

In principal axes, with c the axis that circles L (3 in short-axis, 1 in long-axis mode), b the intermediate
axis and a the third,

    ω_a = α cn u,   ω_b = β sn u,   ω_c = γ dn u,   u = u₀ ± p t,

and the axis c goes round L, which is fixed in space, at the rate

    φ̇ = L (I_a ω_a² + I_b ω_b²)/(L_a² + L_b²) = L/I_c + L (I_c − I_a)/(I_a I_c (1 − n sn² u)),
    n = −I_c (I_b − I_a)/(I_a (I_c − I_b)) < 0,

whose integral is an elliptic integral of the third kind. Complete and incomplete integrals go through
Carlson's R_F and R_J. The time enters once, in working precision: a state in 1e12 rotations is as exact as
one now.
"""

from __future__ import annotations

from typing import Any

import mpmath
from mpmath import mp, mpf

from oracles.rotation import Vector, cross

__all__ = ["JacobiMotion"]

DIGITS = 50


class JacobiMotion:
    """A free body with three different moments, neither in a steady spin nor on the separatrix.

    Parameters
    ----------
    moments : (3,)
        Ascending, along the axes of the frame.
    omega, attitude : (3,), (4,)
        The start; the quaternion is made a unit one.
    digits : int
        Correct digits asked for; thirty more are carried, for long times and motions near special ones.
    """

    def __init__(self, moments: Any, omega: Any, attitude: Any, digits: int = DIGITS) -> None:
        self._digits = digits + 30
        with mp.workdps(self._digits):
            I = [mpf(x) for x in moments]
            w = [mpf(x) for x in omega]
            L2 = sum((i * x) ** 2 for i, x in zip(I, w, strict=True))
            T2 = sum(i * x * x for i, x in zip(I, w, strict=True))
            self._axes = (0, 1, 2) if T2 * I[1] < L2 else (2, 1, 0)
            a, b, c = self._axes
            Ia, Ib, Ic = I[a], I[b], I[c]
            self._moments = I
            self.alpha = mpmath.sqrt((T2 * Ic - L2) / (Ia * (Ic - Ia)))
            self.beta = mpmath.sqrt((T2 * Ic - L2) / (Ib * (Ic - Ib)))
            # I_b ω̇_b = (I₃ − I₁) ω₃ ω₁ decides the sense in which the angle runs.
            self._sense = mpmath.sign(w[c])
            self.gamma = self._sense * mpmath.sqrt((L2 - T2 * Ia) / (Ic * (Ic - Ia)))
            self.p = mpmath.sqrt((L2 - T2 * Ia) * (Ic - Ib) / (Ia * Ib * Ic))
            self.m = (T2 * Ic - L2) * (Ib - Ia) / ((L2 - T2 * Ia) * (Ic - Ib))
            self.n = -Ic * (Ib - Ia) / (Ia * (Ic - Ib))
            self.L = mpmath.sqrt(L2)
            self._steady = self.L / Ic
            self._lead = self._sense * self.L * (Ic - Ia) / (Ia * Ic * self.p)
            m1 = 1 - self.m
            self._K = mpmath.elliprf(0, m1, 1)
            self._Pi = self._K + self.n / 3 * mpmath.elliprj(0, m1, 1, 1 - self.n)
            psi = mpmath.atan2(w[b] / self.beta, w[a] / self.alpha)
            turns = mpmath.nint(psi / mp.pi)
            s, k = mpmath.sin(psi - turns * mp.pi), mpmath.cos(psi - turns * mp.pi)
            self._u0 = 2 * turns * self._K + s * mpmath.elliprf(k * k, 1 - self.m * s * s, 1)
            self._third0 = self._third(turns, s, k)
            q = [mpf(x) for x in attitude]
            length = mpmath.sqrt(mpmath.fdot(q, q))
            self._start = _matrix([x / length for x in q]) * self._triad(w)

    def at(self, t: Any) -> tuple[Vector, Vector]:
        """Rates in the body, and the unit quaternion, at time t."""
        with mp.workdps(self._digits):
            u = self._u0 + self._sense * self.p * mpf(t)
            turns = mpmath.nint(u / (2 * self._K))
            v = u - 2 * turns * self._K
            s, k, d = (mpmath.ellipfun(name, v, m=self.m) for name in ("sn", "cn", "dn"))
            sign = -1 if int(turns) % 2 else 1
            w = [mpf(0)] * 3
            for axis, rate in zip(
                self._axes, (self.alpha * sign * k, self.beta * sign * s, self.gamma * d), strict=True
            ):
                w[axis] = rate
            phi = self._steady * mpf(t) + self._lead * (self._third(turns, s, k) - self._third0)
            cos, sin = mpmath.cos(phi), mpmath.sin(phi)
            turn = mpmath.matrix([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
            return w, _quaternion(self._start * turn * self._triad(w).T)

    def _third(self, turns: mpf, s: mpf, k: mpf) -> mpf:
        """Legendre's Π(n; φ | m), at the amplitude φ = π turns + arcsin s, cos > 0 there."""
        x, y = k * k, 1 - self.m * s * s
        part = s * mpmath.elliprf(x, y, 1) + self.n / 3 * s**3 * mpmath.elliprj(x, y, 1, 1 - self.n * s * s)
        return 2 * turns * self._Pi + part

    def _triad(self, w: Vector) -> Any:
        """Columns: the direction of axis c as seen across L, the normal to both, L; body components."""
        z = [i * x / self.L for i, x in zip(self._moments, w, strict=True)]
        axis = [mpf(int(i == self._axes[2])) for i in range(3)]
        n = cross(z, axis)
        length = mpmath.sqrt(mpmath.fdot(n, n))
        n = [x / length for x in n]
        return mpmath.matrix([cross(n, z), n, z]).T


def _matrix(q: Vector) -> Any:
    x, y, z, w = q
    return mpmath.matrix(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _quaternion(R: Any) -> Vector:
    """The unit quaternion of a rotation matrix, from its largest component."""
    squares = [
        1 + R[0, 0] - R[1, 1] - R[2, 2],
        1 - R[0, 0] + R[1, 1] - R[2, 2],
        1 - R[0, 0] - R[1, 1] + R[2, 2],
    ]
    squares.append(4 - sum(squares))
    largest = max(range(4), key=lambda i: squares[i])
    symmetric, skew = R + R.T, R - R.T
    x = [
        [squares[0], symmetric[0, 1], symmetric[0, 2], skew[2, 1]],
        [symmetric[0, 1], squares[1], symmetric[1, 2], skew[0, 2]],
        [symmetric[0, 2], symmetric[1, 2], squares[2], skew[1, 0]],
        [skew[2, 1], skew[0, 2], skew[1, 0], squares[3]],
    ][largest]
    length = mpmath.sqrt(mpmath.fdot(x, x))
    return [y / length for y in x]
