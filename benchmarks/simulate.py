"""Taylor series beside heyoka's, one motion and stacks, and beside SciPy's DOP853 at 1e-12.

heyoka (``pip install heyoka``) is left out where it is not installed.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np
from harness import Row
from polhode import RigidBody, loads
from scipy.integrate import solve_ivp

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

TIGHTEST = 2.3e-15
ROTATIONS = 10
ATTITUDE = (np.sin(0.35), 0.0, 0.0, np.cos(0.35))
WEIGHT = np.array([0.0, 0.0, -1.0])


class Case:
    """A body about its fixed point or centre: moments there, where its weight acts, and how it starts."""

    def __init__(self, name: str, moments: Any, center: Any, omega: Any) -> None:
        self.name = name
        self.moments, self.center = np.array(moments), np.array(center)
        self.omega = np.array(omega)
        self.time = 2 * np.pi * ROTATIONS / float(np.linalg.norm(omega))
        c = self.center
        about_center = np.diag(self.moments) - (c @ c * np.eye(3) - np.outer(c, c))
        self.body = RigidBody(1.0, about_center, c)
        self.load = loads.uniform_gravity(WEIGHT) if c.any() else None

    def ours(self, omega: Any) -> NDArray[np.float64]:
        """Rates and attitudes at the end."""
        motion = self.body.simulate(
            [0.0, self.time],
            omega,
            ATTITUDE,
            load=self.load,
            about="origin",
            method="taylor",
            rtol=TIGHTEST,
        )
        return np.concatenate([motion.omega[..., -1, :], motion.quaternion[..., -1, :]], axis=-1)

    def equations(self, w: Any, q: Any) -> list[Any]:
        """The rates of change of rates and attitude, for numbers or symbols."""
        (i1, i2, i3), (c1, c2, c3) = self.moments, self.center
        x, y, z, s = q
        change = [(i2 - i3) * w[1] * w[2], (i3 - i1) * w[2] * w[0], (i1 - i2) * w[0] * w[1]]
        if self.load is not None:
            f = [-2 * (x * z - y * s), -2 * (y * z + x * s), -(1 - 2 * (x * x + y * y))]
            torque = [c2 * f[2] - c3 * f[1], c3 * f[0] - c1 * f[2], c1 * f[1] - c2 * f[0]]
            change = [a + b for a, b in zip(change, torque, strict=True)]
        return [
            *(a / i for a, i in zip(change, self.moments, strict=True)),
            0.5 * (s * w[0] + y * w[2] - z * w[1]),
            0.5 * (s * w[1] + z * w[0] - x * w[2]),
            0.5 * (s * w[2] + x * w[1] - y * w[0]),
            -0.5 * (x * w[0] + y * w[1] + z * w[2]),
        ]

    def symbols(self) -> list[Any]:
        """The equations as heyoka takes them."""
        import heyoka

        names = ("w1", "w2", "w3", "x", "y", "z", "s")
        variables = heyoka.make_vars(*names)
        return list(zip(variables, self.equations(variables[:3], variables[3:]), strict=True))

    def scipy(self) -> NDArray[np.float64]:
        """By DOP853 at 1e-12."""
        start = [*self.omega, *ATTITUDE]

        def rates(_t: float, y: Any) -> Any:
            return self.equations(y[:3], y[3:])

        return solve_ivp(rates, (0.0, self.time), start, "DOP853", rtol=1e-12, atol=1e-12).y[:, -1]


CASES = (
    Case("free, asymmetric", (1.0, 2.0, 2.5), (0.0, 0.0, 0.0), (0.3, 0.4, 1.1)),
    Case("heavy symmetric top", (1.25, 1.25, 0.4), (0.0, 0.0, 0.5), (0.2, 0.1, 5.0)),
    Case("heavy asymmetric top", (1.0, 2.0, 2.5), (0.1, -0.2, 0.4), (0.3, -0.2, 3.0)),
)


def within(bar: float) -> Callable[[Any, Any], None]:
    """Compare states."""

    def compare(one: Any, other: Any) -> None:
        assert np.abs(np.asarray(one) - other).max() < bar

    return compare


def rows() -> Iterator[Row]:
    """Yield the comparisons of this file."""
    for case in CASES:
        if find_spec("heyoka"):
            yield from beside_heyoka(case)
        yield Row(
            name=f"{case.name}, a rotation",
            peer="SciPy DOP853 at 1e-12",
            ours=lambda case=case: case.ours(case.omega),
            theirs=case.scipy,
            compare=within(1e-9),
            items=ROTATIONS,
            at_least=150.0,
        )


def beside_heyoka(case: Case) -> Iterator[Row]:
    """One motion, and a stack by one integrator of a batch of eight, used again and again."""
    import heyoka

    alone = heyoka.taylor_adaptive(case.symbols(), [*case.omega, *ATTITUDE])

    def one() -> Any:
        alone.time = 0.0
        alone.state[:] = [*case.omega, *ATTITUDE]
        alone.propagate_until(case.time)
        return alone.state.copy()

    yield Row(
        name=f"{case.name}, a rotation",
        peer="heyoka",
        ours=lambda: case.ours(case.omega),
        theirs=one,
        compare=within(2e-13),
        items=ROTATIONS,
        at_least=1.4,
    )

    count, lanes = 10_000, 8
    starts = case.omega * np.random.default_rng(1).uniform(0.9, 1.1, size=(count, 3))
    batch = heyoka.taylor_adaptive_batch(case.symbols(), np.zeros((7, lanes)))

    def many() -> Any:
        ends = np.empty((count, 7))
        for first in range(0, count, lanes):
            batch.set_time(0.0)
            batch.state[:3] = starts[first : first + lanes].T
            batch.state[3:] = np.array(ATTITUDE)[:, np.newaxis]
            batch.propagate_until(case.time)
            ends[first : first + lanes] = batch.state.T
        return ends

    yield Row(
        name=f"{case.name}, 1e4 motions",
        peer="heyoka, batch of 8",
        ours=lambda: case.ours(starts),
        theirs=many,
        compare=within(1e-12),
        items=count,
        at_least=1.5,
    )
