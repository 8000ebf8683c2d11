"""Steps of derivations on the pages of the theory, in many digits, beside the definitions they come from."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf
from oracles.polynomials import roots

DIGITS = 30
TINY = mpf(10) ** -20


@pytest.fixture(autouse=True)
def _digits() -> Any:
    with mp.workdps(DIGITS):
        yield


class Free:
    """The symbols of the page on free motion, at a start with ω_y = 0."""

    def __init__(self, mode: int) -> None:
        moments = [mpf(1), mpf(2), mpf("2.5")]
        self.s = mode
        x, y, z = moments if mode > 0 else moments[::-1]
        wx, wz = (mpf("0.3"), mpf("1.1")) if mode > 0 else (mpf("0.1"), mpf("1.1"))
        self.moments = x, y, z
        self.L = mpmath.sqrt((x * wx) ** 2 + (z * wz) ** 2)
        energy = x * wx**2 + z * wz**2  # 2T
        dx, dz = (abs(self.L**2 - energy * i) for i in (x, z))
        self.rate = mpmath.sqrt(abs(z - y) * dx / (x * y * z))
        self.m = abs(y - x) * dz / (abs(z - y) * dx)
        self.K, self.K1 = mpmath.ellipk(self.m), mpmath.ellipk(1 - self.m)
        self.p = y * abs(z - x) / (x * abs(z - y))
        self.kappa = (energy * z - self.L**2) / (self.L * z)
        self.eta = mpmath.ellipf(mpmath.atan2(z * wz, x * wx), 1 - self.m)
        sizes = (
            mpmath.sqrt(dz / (x * abs(z - x))),
            mode * mpmath.sqrt(dz / (y * abs(z - y))),
            mpmath.sqrt(dx / (z * abs(z - x))),
        )
        self.largest = [i * a / self.L for i, a in zip(self.moments, sizes, strict=True)]

    def function(self, name: str, u: Any) -> Any:
        return mpmath.ellipfun(name, u, m=self.m)

    def direction(self, u: Any) -> list[Any]:
        """ℓ at a complex u."""
        names = ("cn", "sn", "dn")
        return [a * self.function(name, u) for a, name in zip(self.largest, names, strict=True)]

    def theta(self, u: Any) -> Any:
        return mpmath.jtheta(4, mp.pi * u / (2 * self.K), mpmath.exp(-mp.pi * self.K1 / self.K))


@pytest.mark.parametrize("mode", [1, -1])
class TestFreeMotion:
    def test_jacobi_s_formula_and_its_factor(self, mode: int) -> None:
        it, u = Free(mode), mpf("0.7")
        a = 1j * it.eta
        sn, cn, dn = (it.function(name, a) for name in ("sn", "cn", "dn"))
        assert abs(-it.m * sn**2 - (it.p - 1)) < TINY
        x, _, z = it.moments
        assert abs(it.L * (z - x) / (it.rate * x * z) * sn / (cn * dn) - 1j * mode) < TINY
        integral = mpmath.quad(lambda v: 1 / (1 - it.m * (sn * it.function("sn", v)) ** 2), [0, u])
        bracket = (
            u * mpmath.diff(it.theta, a) / it.theta(a) + mpmath.log(it.theta(u - a) / it.theta(u + a)) / 2
        )
        assert abs(integral - u - sn / (cn * dn) * bracket) < TINY

    def test_zeros_of_alpha_and_beta(self, mode: int) -> None:
        """The sum of the residues is 1 at a zero, and 0 where α or β has none."""
        it = Free(mode)
        for sign, (alpha, beta) in ((mode, (0, 1)), (-mode, (1, 0))):
            for one, eta, due in ((1, it.eta, alpha), (-1, -it.eta, beta)):
                u = 1j * sign * (it.K1 + eta)
                x, y, z = it.direction(u)
                assert abs(one + z) < TINY
                assert abs(y - 1j * mode * sign * x) < TINY
                slope = it.rate * mpmath.diff(lambda v: it.direction(v)[2], u)
                assert abs(mpf(1) / 2 + one * 1j * it.kappa / (2 * slope) - due) < TINY


@pytest.mark.parametrize(
    "seed", [*range(15), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(15, 40))]
)
def test_steady_rates_of_a_heavy_top(seed: int) -> None:
    """Legendre's relation splits off the half turn, and the rate of W has the sign that the page states."""
    rng = np.random.default_rng(seed)
    kappa, b = mpf(rng.uniform(0.2, 2)), mpf(rng.uniform(-4, 4))
    tilt, W = rng.uniform(0.2, 2.9), mpmath.mpc(*rng.uniform(-2, 2, 2))
    u0, G = mpmath.cos(tilt), 1j * mpmath.sin(tilt)
    a, end = (mpmath.conj(G) * W).real + b * u0, u0 + abs(W) ** 2 / (2 * kappa)
    cubic = [2 * kappa, -(2 * kappa * end + b * b), 2 * a * b - 2 * kappa, 2 * kappa * end - a * a]
    u1, u2, u3 = sorted(mpmath.re(root) for root in roots(cubic, maxsteps=200, extraprec=200))
    m = (u2 - u1) / (u3 - u1)
    K, rate = mpmath.ellipk(m), mpmath.sqrt(kappa * (u3 - u1) / 2)
    turn = mp.pi * rate / (2 * K)  # half a turn in a period

    def mean(function: Any) -> Any:
        def integrand(phi: Any) -> Any:
            square = mpmath.sin(phi) ** 2
            return function(u1 + (u2 - u1) * square, square) / mpmath.sqrt(1 - m * square)

        return mpmath.quad(integrand, [0, mp.pi / 4, mp.pi / 2]) / K

    sign = mpmath.sign
    bottom, top = (1 + u1) / (u3 - u1), (1 - u1) / (u3 - u1)
    alpha = (a + b) / (2 * (u3 - u1)) * mean(lambda _, square: square / (1 + bottom * square))
    beta = -(a - b) / (2 * (u3 - u1)) * mean(lambda _, square: square / (1 - top * square))
    tolerance = mpf(10) ** -12 * (1 + turn)
    assert abs(mean(lambda u, _: (a + b) / (2 * (1 + u))) - alpha - sign(a + b) * turn) < tolerance
    assert abs(mean(lambda u, _: (a - b) / (2 * (1 - u))) - beta - sign(a - b) * turn) < tolerance
    of_w = mean(lambda u, _: -b / 2 - (a - b * end) / (2 * (end - u))) + sign(a - b * end) * turn
    assert abs(of_w - (beta - alpha + sign(a - b * max(1, end)) * turn)) < tolerance
    # The count of turns in one period, from the three half turns and the curve round zero.
    at_ends = sign(a - b * u1), sign(a - b * u2)
    round_zero = at_ends[0] if at_ends[0] != at_ends[1] else 0
    count = sign(a - b * end) + sign(a - b) - sign(a + b) + 2 * round_zero
    assert count == sign(a - b * max(1, end))


@pytest.mark.parametrize(
    ("start", "turned"),
    [((0.3, 0.2, 1.1), (-1, -1, 1)), ((1.1, 0.2, 0.3), (1, -1, -1))],
    ids=["short", "long"],
)
def test_two_rates_change_their_sign_in_half_a_period(
    start: tuple[float, ...], turned: tuple[int, ...]
) -> None:
    """The page on the sensitivity: those of the axes that ω does not circle."""
    w = [mpf(str(rate)) for rate in start]
    contrasts = mpf("0.5"), mpf("0.75"), mpf("0.4")  # of the moments 1, 2, 2.5
    p = contrasts[0] * (contrasts[2] * w[1] ** 2 + contrasts[1] * w[2] ** 2)
    q = contrasts[2] * (contrasts[1] * w[0] ** 2 + contrasts[0] * w[1] ** 2)
    half = 2 * mpmath.ellipk(min(p, q) / max(p, q)) / mpmath.sqrt(max(p, q))
    with mp.workdps(15):
        solution = mpmath.odefun(
            lambda _, x: [
                -contrasts[0] * x[1] * x[2],
                contrasts[1] * x[2] * x[0],
                -contrasts[2] * x[0] * x[1],
            ],
            0,
            w,
        )
        end = solution(half)
    for rate, sign, at_start in zip(end, turned, w, strict=True):
        assert abs(rate - sign * at_start) < mpf(10) ** -11


@pytest.mark.parametrize(("i", "j", "k"), [(0, 1, 2), (1, 2, 0), (2, 0, 1)])
def test_the_angle_of_the_axes_is_positive_from_j_towards_i(i: int, j: int, k: int) -> None:
    """First and second order of the page on uncertainty: minus the right-handed angle."""
    moments = [mpf(1), mpf(2), mpf("3.5")]
    change = mpmath.matrix([[3, 1, -2], [1, -1, 4], [-2, 4, 2]]) / 4

    def about(axis: int, step: Any) -> Any:
        """The component of the rotation vector of the axes."""
        _, axes = mpmath.eigsy(mpmath.diag(moments) + step * change)
        columns = [axes[:, c] * mpmath.sign(axes[c, c]) for c in range(3)]
        turn = mpmath.acos((sum(columns[c][c] for c in range(3)) - 1) / 2)
        after, last = (axis + 1) % 3, (axis + 2) % 3
        return turn / (2 * mpmath.sin(turn)) * (columns[after][last] - columns[last][after])

    with mp.workdps(50):
        step = mpf(10) ** -12
        forth, back = about(k, step), about(k, -step)
        first, second = (forth - back) / (2 * step), (forth + back) / (2 * step**2)

    def gap(m: int, n: int) -> Any:
        return moments[m] - moments[n]

    of_first = change[i, j] / gap(j, i)
    of_second = (
        (change[i, i] - change[j, j]) * change[i, j] / gap(j, i)
        + change[i, k] * change[k, j] / 2 * (1 / gap(j, k) - 1 / gap(k, i))
    ) / gap(j, i)
    assert abs(first + of_first) < mpf(10) ** -12
    assert abs(second + of_second) < mpf(10) ** -9


PAULI = [np.array([[0, 1], [1, 0]]), np.array([[0, -1j], [1j, 0]]), np.diag([1, -1])]


def cross(k: np.ndarray) -> np.ndarray:
    return np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])


def test_the_matrix_of_a_gyrostat() -> None:
    """(m·ω)² = mᵀS m, with n eliminated."""
    rng = np.random.default_rng(7)
    for _ in range(20):
        b = rng.normal(size=(3, 3))
        b, k, L = b + b.T, rng.normal(size=3), rng.uniform(0.5, 2)
        psi = rng.normal(size=2) + 1j * rng.normal(size=2)
        psi /= np.linalg.norm(psi)
        n = np.array([(psi.conj() @ pauli @ psi).real for pauli in PAULI])
        p, q = psi
        m = np.array([p * p - q * q, 1j * (p * p + q * q), -2 * p * q])
        omega = L * b @ n - k
        energy = L**2 * n @ b @ n - 2 * L * n @ k
        S = energy * b + L**2 * np.linalg.det(b) * np.linalg.inv(b) + np.outer(k, k)
        S = S + 1j * L * (b @ cross(k) - cross(k) @ b)
        np.testing.assert_allclose(m @ S @ m, (m @ omega) ** 2, atol=1e-11)
        np.testing.assert_allclose(S, S.T, atol=1e-12)


def test_roots_of_the_cubic_are_a_quarter_of_eigenvalues() -> None:
    rng = np.random.default_rng(8)
    for _ in range(5):
        S = mpmath.matrix((rng.normal(size=(3, 3)) + 1j * rng.normal(size=(3, 3))).tolist())
        S = S + S.T
        S -= (S[0, 0] + S[1, 1] + S[2, 2]) / 3 * mpmath.eye(3)
        at = [mpf(x) for x in (0, 1, -1, 2, -2)]
        values = []
        for zeta in at:
            m = mpmath.matrix([1 - zeta**2, 1j * (1 + zeta**2), -2 * zeta])
            values.append(-(m.T * S * m)[0] / 4)
        powers = mpmath.matrix([[x**k for k in range(5)] for x in at])
        e, d, c, b, a = mpmath.lu_solve(powers, mpmath.matrix(values))
        b, c, d = b / 4, c / 6, d / 4
        g2, g3 = a * e - 4 * b * d + 3 * c**2, a * c * e + 2 * b * c * d - c**3 - a * d**2 - b**2 * e
        for eigenvalue in mpmath.eig(S, left=False, right=False):
            r = eigenvalue / 4
            assert abs(4 * r**3 - g2 * r - g3) < TINY


def test_the_largest_nome_of_a_free_motion() -> None:
    """The code changes from one series to the other where the larger nomes of both are equal."""

    def larger(ratio: Any) -> Any:  # K′/K
        return min(mpmath.exp(-mp.pi * ratio), mpmath.exp(-mp.pi / (2 * ratio)))

    change = 1 / mpmath.sqrt(2)
    assert mpf("0.108") < larger(change) < mpf("0.11")
    assert max(larger(mpf(k) / 100) for k in range(1, 400)) <= larger(change)


def test_the_potential_of_an_oblate_attractor() -> None:
    """The acceleration of the page is minus the gradient of its U."""
    mu, j2, radius = mpf("1.3"), mpf("0.1"), mpf("0.7")
    pole, place = [mpf("0.48"), mpf("0.6"), mpf("0.64")], [mpf("1.1"), mpf("-0.4"), mpf("0.8")]

    def potential(*at: Any) -> Any:
        r = mpmath.norm(at)
        xi = mpmath.fdot(at, pole) / r
        return -mu / r * (1 - j2 * (radius / r) ** 2 * (3 * xi**2 - 1) / 2)

    r, along = mpmath.norm(place), mpmath.fdot(place, pole)
    for axis in range(3):
        slope = mpmath.diff(potential, tuple(place), tuple(int(axis == i) for i in range(3)))
        bulge = (1 - 5 * (along / r) ** 2) * place[axis] + 2 * along * pole[axis]
        acceleration = -mu / r**3 * place[axis] - 3 * mu * j2 * radius**2 / (2 * r**5) * bulge
        assert abs(slope + acceleration) < mpf(10) ** -15
