"""Exact free motion beside SciPy's integrator, and beside an elliptic integral for each state."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from harness import Row
from polhode import RigidBody
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipkinc, elliprf, elliprj

if TYPE_CHECKING:
    from collections.abc import Iterator

MOMENTS = np.array([1.0, 2.0, 2.5])
OMEGA = np.array([0.3, 0.2, 1.1])
ROTATION = 2 * np.pi * MOMENTS[1] / np.linalg.norm(MOMENTS * OMEGA)
STATES = 100_000
BODIES = 100_000
INTEGRATED = 2


def integrated(moments: Any, omega: Any, t: float) -> tuple[Any, Any]:
    """ω and quaternion at t by DOP853 at 1e-12."""
    a, b, c = moments
    k1, k2, k3 = (b - c) / a, (c - a) / b, (a - b) / c

    def rhs(_t: float, s: Any) -> list[float]:
        p, q, r, x, y, z, w = s.tolist()
        return [
            k1 * q * r,
            k2 * r * p,
            k3 * p * q,
            0.5 * (w * p + y * r - z * q),
            0.5 * (w * q + z * p - x * r),
            0.5 * (w * r + x * q - y * p),
            -0.5 * (x * p + y * q + z * r),
        ]

    end = solve_ivp(rhs, (0, t), [*omega, 0, 0, 0, 1], method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    return end[:3], end[3:]


class OneIntegralEach:
    """Short-axis mode by Jacobi's functions, the angle of precession by a third integral at each time."""

    def __init__(self, moments: Any, omega: Any) -> None:
        a, b, c = moments
        momentum, energy = np.linalg.norm(moments * omega), moments @ omega**2
        d1, d3 = momentum**2 - energy * a, energy * c - momentum**2
        self.amplitudes = np.sqrt([d3 / (a * (c - a)), d3 / (b * (c - b)), d1 / (c * (c - a))])
        self.rate = np.sqrt((c - b) * d1 / (a * b * c))
        self.m = (b - a) * d3 / ((c - b) * d1)
        self.n = -c * (b - a) / (a * (c - b))
        self.moments, self.L = moments, momentum
        self.lead = self.L * (c - a) / (a * c * self.rate)
        self.K = elliprf(0.0, 1 - self.m, 1.0)
        self.full = self.K + self.n / 3 * elliprj(0.0, 1 - self.m, 1.0, 1 - self.n)
        phase = np.arctan2(omega[1] / self.amplitudes[1], omega[0] / self.amplitudes[0])
        self.u0 = ellipkinc(phase, self.m)
        self.start = self.third(self.u0)

    def third(self, u: Any) -> Any:
        """The third integral of the amplitude of u."""
        half_turns = np.round(u / (2 * self.K))
        s, k, _, _ = ellipj(u - 2 * half_turns * self.K, self.m)
        x, y = k * k, 1 - self.m * s * s
        part = s * elliprf(x, y, 1.0) + self.n / 3 * s**3 * elliprj(x, y, 1.0, 1 - self.n * s * s)
        return 2 * half_turns * self.full + part

    def __call__(self, t: Any) -> tuple[Any, Any]:
        """ω in the body, and the angle of precession."""
        u = self.rate * t + self.u0
        sn, cn, dn, _ = ellipj(u, self.m)
        omega = np.stack([cn, sn, dn], axis=-1) * self.amplitudes
        return omega, self.L / self.moments[2] * t + self.lead * (self.third(u) - self.start)


def rows() -> Iterator[Row]:
    """Yield the comparisons of this file."""
    body = RigidBody.from_principal(1.0, MOMENTS)
    motion = body.free_motion(OMEGA)
    times = np.linspace(0, 100 * ROTATION, STATES)
    peer = OneIntegralEach(MOMENTS, OMEGA)

    def same_rates(ours: Any, theirs: Any) -> None:
        assert np.abs(ours.omega - theirs[0]).max() < 1e-11

    yield Row(
        name=f"many times of one body, {STATES:.0e} states",
        peer="one Π(n; φ|m) each, SciPy",
        ours=lambda: motion.at(times),
        theirs=lambda: peer(times),
        compare=same_rates,
        items=STATES,
        at_least=10,
    )

    rng = np.random.default_rng(7)
    parts = rng.uniform(0.2, 1.0, size=(BODIES, 3))
    moments = parts.sum(axis=-1, keepdims=True) - parts
    stack = RigidBody.from_principal(1.0, moments)
    omegas = rng.normal(size=(BODIES, 3))
    omegas /= np.linalg.norm(omegas, axis=-1, keepdims=True)
    spans = 2 * np.pi * 10

    def close(ours: Any, theirs: Any) -> None:
        for omega, quaternion, (w, q) in zip(ours.omega, ours.quaternion, theirs, strict=False):
            assert np.abs(omega - w).max() < 1e-8
            assert 1 - abs(quaternion @ q) / np.linalg.norm(q) < 1e-12

    # The peer integrates a few of the bodies.
    for name, factor in (("10 rotations", 1.0), ("1e6 rotations", 1e5)):
        yield Row(
            name=f"{BODIES:.0e} bodies at {name}",
            peer="SciPy DOP853, 10 rotations",
            ours=lambda factor=factor: stack.free_motion(omegas).at(spans * factor),
            theirs=lambda: [integrated(moments[k], omegas[k], spans) for k in range(INTEGRATED)],
            compare=close if factor == 1.0 else lambda _ours, _theirs: None,
            items=BODIES,
            peer_items=INTEGRATED,
            at_least=300,
        )
