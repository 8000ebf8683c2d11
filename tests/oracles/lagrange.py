"""The heavy symmetric top in closed form, with mpmath: Jacobi's functions and Legendre's third integral.

With γ the upward vertical in the body, u = cos θ and, in the frame that turns about the axis as the equal
spherical top does, α = q_w + i q_z and β = q_x + i q_y,

    u̇² = (1 − u²)(h − 2κ(u − u₀)) − (a − b u)²,     u = u₁ + (u₂ − u₁) sn² v,     v = ½ √(2κ(u₃ − u₁)) t + v₀,
    (arg α)˙ = ½ (a + b)/(1 + u),     (arg β)˙ = ½ (a − b)/(1 − u),

κ = m g l/I_t, b = I_s ω_s/I_t, I_t a the angular momentum about the vertical, h the square of ω across the
axis. The integrals are Carlson's R_F and R_J. The axis is the third of the body, gravity acts against the
third of space, and the top neither stays nor arrives upright.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import mpmath
from mpmath import mp, mpc, mpf

__all__ = ["LagrangeTop"]

Vector = list[mpf]


def _roots(coefficients: list[mpf], digits: int) -> list[mpf]:
    """The real roots of x³ + a x² + b x + c, ascending.

    Two that are close cost half of the digits, so thrice as many are carried.
    """
    a, b, c = coefficients
    with mp.workdps(3 * digits):
        p = mpmath.sqrt(a * a - 3 * b) / 3
        cosine = (9 * a * b - 2 * a**3 - 27 * c) / (54 * p**3)
        angle = mpmath.acos(max(-1, min(1, cosine)))
        return sorted(2 * p * mpmath.cos((angle + 2 * k * mp.pi) / 3) - a / 3 for k in range(3))


class LagrangeTop:
    """The motion from a state on; floats are taken at their exact values.

    Parameters
    ----------
    mass, moments, height
        The moments (I_t, I_t, I_s) are those about the centre of mass, `height` is where it is on the axis.
    omega, attitude, gravity
        The start, and g.
    digits : int
        Carried in all; near the separatrix and after n turns this less 2 log₁₀ 1/k′ + log₁₀ n come out.
    """

    def __init__(
        self,
        mass: float,
        moments: Any,
        height: float,
        omega: Any,
        attitude: Iterable[float],
        gravity: float,
        digits: int = 80,
    ) -> None:
        self._digits = digits
        with mp.workdps(digits):
            I_t = mpf(moments[0]) + mpf(mass) * mpf(height) ** 2
            kappa = mpf(mass) * mpf(gravity) * mpf(height) / I_t
            self._kappa = kappa
            x, y, z, w = (mpf(c) for c in attitude)
            size = mpmath.sqrt(x * x + y * y + z * z + w * w)
            alpha, beta = mpc(w, z) / size, mpc(x, y) / size
            rate = mpc(omega[0], omega[1])
            self._spin = mpf(omega[2])
            self._b = mpf(moments[2]) * self._spin / I_t
            vertical = 2j * mpmath.conj(alpha) * beta
            u0 = abs(alpha) ** 2 - abs(beta) ** 2
            lift, fall = (mpmath.conj(vertical) * rate).real, (mpmath.conj(vertical) * rate).imag
            self._a = lift + self._b * u0
            a, b, e = self._a, self._b, abs(rate) ** 2 + 2 * kappa * u0
            # (1 − u²)(e − 2κu) − (a − bu)², over 2κ
            self._u1, self._u2, u3 = _roots(
                [x / (2 * kappa) for x in (-e - b * b, 2 * a * b - 2 * kappa, e - a * a)], digits
            )
            self._range = self._u2 - self._u1
            self._m = self._range / (u3 - self._u1)
            self._m1 = (u3 - self._u2) / (u3 - self._u1)
            self._rate = mpmath.sqrt(2 * kappa * (u3 - self._u1)) / 2
            self._K = mpmath.elliprf(0, self._m1, 1)
            sine = mpmath.sqrt(max(u0 - self._u1, mpf(0)) / self._range)
            cosine = mpmath.sqrt(max(self._u2 - u0, mpf(0)) / self._range)
            self._v0 = mpmath.sign(fall) * self._first(sine, cosine)
            # α and β but for what their start makes of them.
            self._turn = 1, 1
            model = self._pair(self._v0)
            self._start = alpha / model[0], beta / model[1]

    @property
    def period(self) -> mpf:
        """From one highest inclination to the next."""
        return 2 * self._K / self._rate

    @property
    def complement(self) -> float:
        """k′."""
        return float(mpmath.sqrt(self._m1))

    def at(self, t: Any) -> tuple[Vector, Vector]:
        """ω in the body and the quaternion (x, y, z, w)."""
        with mp.workdps(self._digits):
            alpha, beta = (
                factor * value
                for factor, value in zip(self._start, self._pair(self._v0 + self._rate * mpf(t)), strict=True)
            )
            u = abs(alpha) ** 2 - abs(beta) ** 2
            vertical = 2j * mpmath.conj(alpha) * beta
            # W = G (lift + i u̇)/|G|², as lift + i u̇ = G* W.
            rate = vertical * mpc(self._a - self._b * u, self._fall(mpf(t))) / abs(vertical) ** 2
            turn = mpmath.expj((self._spin - self._b) * mpf(t) / 2)
            alpha, beta, rate = alpha * turn, beta / turn, rate / turn**2
            return [rate.real, rate.imag, self._spin], [beta.real, beta.imag, alpha.imag, alpha.real]

    def _fall(self, t: mpf) -> mpf:
        """u̇ = 2 (u₂ − u₁) sn cn dn v̇."""
        v = self._v0 + self._rate * t
        v -= 2 * self._K * mpmath.nint(v / (2 * self._K))
        s, c, d = (mpmath.ellipfun(name, v, m=self._m) for name in ("sn", "cn", "dn"))
        return 2 * self._range * self._rate * s * c * d

    def _pair(self, v: mpf) -> tuple[mpc, mpc]:
        """√((1 ± u)/2) with their phases, which count from v = 0."""
        periods = mpmath.nint(v / (2 * self._K))
        rest = v - 2 * periods * self._K
        s, c = (mpmath.ellipfun(name, rest, m=self._m) for name in ("sn", "cn"))
        u = self._u1 + self._range * s * s
        phases = []
        for side in (1, -1):
            base = 1 + side * self._u1
            n = -side * self._range / base
            whole = 2 * periods * self._third(n, mpf(1), mpf(0))
            angle = (self._a + side * self._b) / (2 * base * self._rate) * (whole + self._third(n, s, c))
            phases.append(mpmath.expj(angle))
        return mpmath.sqrt((1 + u) / 2) * phases[0], mpmath.sqrt((1 - u) / 2) * phases[1]

    def _first(self, s: mpf, c: mpf) -> mpf:
        return s * mpmath.elliprf(c * c, c * c + self._m1 * s * s, 1)

    def _third(self, n: mpf, s: mpf, c: mpf) -> mpf:
        """Legendre's Π(n; φ) at the amplitude with this sine and cosine, cos φ ≥ 0."""
        d2 = c * c + self._m1 * s * s
        return self._first(s, c) + n / 3 * s**3 * mpmath.elliprj(c * c, d2, 1, 1 - n * s * s)
