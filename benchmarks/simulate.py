"""Taylor series beside heyoka's, one motion and stacks, and beside SciPy's DOP853 at 1e-12.

Both sides run at the loosest tolerance of a ladder up to which the error after ten rotations, of ω relative
to its magnitude and of the attitude, is at most 1e-13 against heyoka's series in extended precision; for a
stack, of 64 of its motions. The tolerances stand in the rows. Further rows have both at their tightest,
which is heyoka's default. The last row has a loop of steps beside a chain of `resume`.

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
OURS = (TIGHTEST, 5e-15, 1e-14, 3e-14, 1e-13, 3e-13, 1e-12, 3e-12, 1e-11, 3e-11, 1e-10)
"""Tolerances, and those of heyoka, the first its default."""
THEIRS = (2.3e-16, 5e-16, 1e-15, 3e-15, 1e-14, 3e-14, 1e-13, 3e-13, 1e-12, 3e-12, 1e-11)
ERROR = 1e-13
ROTATIONS = 10
ATTITUDE = (np.sin(0.35), 0.0, 0.0, np.cos(0.35))
WEIGHT = np.array([0.0, 0.0, -1.0])


class Case:
    """A body about its fixed point or centre: its moments, its weight or a rotor in it, and how it starts."""

    def __init__(
        self, name: str, moments: Any, center: Any, omega: Any, rotor: Any = None, bar: float = 1.4
    ) -> None:
        self.name, self.rotor, self.bar = name, rotor, bar
        self.moments, self.center = np.array(moments), np.array(center)
        self.omega = np.array(omega)
        self.time = 2 * np.pi * ROTATIONS / float(np.linalg.norm(omega))
        c = self.center
        about_center = np.diag(self.moments) - (c @ c * np.eye(3) - np.outer(c, c))
        self.body = RigidBody(1.0, about_center, c)
        self.load = loads.uniform_gravity(WEIGHT) if c.any() else None
        if rotor is not None:
            self.load = loads.rotor(rotor)

    def ours(self, omega: Any, rtol: float = TIGHTEST) -> NDArray[np.float64]:
        """Rates and attitudes at the end."""
        motion = self.body.simulate(
            [0.0, self.time],
            omega,
            ATTITUDE,
            load=self.load,
            about="origin",
            method="taylor",
            rtol=rtol,
        )
        return np.concatenate([motion.omega[..., -1, :], motion.quaternion[..., -1, :]], axis=-1)

    def equations(self, w: Any, q: Any) -> list[Any]:
        """The rates of change of rates and attitude, for numbers or symbols."""
        (i1, i2, i3), (c1, c2, c3) = self.moments, self.center
        x, y, z, s = q
        change = [(i2 - i3) * w[1] * w[2], (i3 - i1) * w[2] * w[0], (i1 - i2) * w[0] * w[1]]
        if self.rotor is not None:
            h1, h2, h3 = self.rotor
            torque = [h2 * w[2] - h3 * w[1], h3 * w[0] - h1 * w[2], h1 * w[1] - h2 * w[0]]
            change = [a + b for a, b in zip(change, torque, strict=True)]
        elif self.load is not None:
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

    def exact(self, starts: Any) -> NDArray[np.longdouble]:
        """The ends to 18 digits."""
        import heyoka

        ends = []
        for omega in starts:
            start = np.array([*omega, *ATTITUDE], dtype=np.longdouble)
            precise = heyoka.taylor_adaptive(self.symbols(), start, fp_type=np.longdouble)
            precise.propagate_until(np.longdouble(self.time))
            ends.append(precise.state.copy())
        return np.array(ends)

    def loosest(self, run: Callable[[float], Any], ladder: Any, exact: Any) -> float:
        """The last tolerance of a ladder before the error of a run is too large."""
        unit = np.array([np.linalg.norm(self.omega)] * 3 + [1.0] * 4)
        reached = None
        for tolerance in ladder:
            if np.abs((run(tolerance) - exact) / unit).max() > ERROR:
                break
            reached = tolerance
        assert reached is not None, f"{self.name}: no tolerance gives {ERROR}"
        return reached


CASES = (
    Case("free, asymmetric", (1.0, 2.0, 2.5), (0.0, 0.0, 0.0), (0.3, 0.4, 1.1)),
    Case("heavy symmetric top", (1.25, 1.25, 0.4), (0.0, 0.0, 0.5), (0.2, 0.1, 5.0)),
    Case("heavy asymmetric top", (1.0, 2.0, 2.5), (0.1, -0.2, 0.4), (0.3, -0.2, 3.0)),
    Case("gyrostat", (1.0, 2.0, 2.5), (0.0, 0.0, 0.0), (0.3, 0.4, 1.1), (0.4, -0.2, 0.9), 1.8),
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
    yield a_loop_of_steps()


def a_loop_of_steps() -> Row:
    """A loop that steps a satellite with three wheels, beside a chain of `resume`."""
    body = RigidBody.from_principal(20.0, (2.0, 3.0, 4.0))
    x, y, z = (loads.wheel(axis, 0.01, torque=0.001, name=f"wheel {k}") for k, axis in enumerate(np.eye(3)))
    load, omega, dt, steps = x + y + z, (0.01, 0.02, 0.03), 0.1, 100

    def ours() -> Any:
        stepper = body.stepper(omega, ATTITUDE, load=load)
        for _ in range(steps):
            stepper.step(dt)
        return stepper.state().omega

    def chain() -> Any:
        # The times of the stepper, which adds steps one by one.
        t, motion = dt, body.simulate([0.0, dt], omega, ATTITUDE, load=load)
        for _ in range(steps - 1):
            motion = motion.resume([t, t + dt])
            t += dt
        return motion.omega[-1]

    def same(one: Any, other: Any) -> None:
        assert np.array_equal(one, other)

    return Row(
        name="a step with three wheels",
        peer="Trajectory.resume",
        ours=ours,
        theirs=chain,
        compare=same,
        items=steps,
        at_least=8.0,
    )


def beside_heyoka(case: Case) -> Iterator[Row]:
    """One motion, and a stack by one integrator of a batch of eight, used again and again."""
    count = 10_000
    starts = case.omega * np.random.default_rng(1).uniform(0.9, 1.1, size=(count, 3))
    one, some = case.omega[np.newaxis], starts[:64]
    exact_one, exact_some = case.exact(one), case.exact(some)
    alone = {tolerance: heyoka_alone(case, tolerance) for tolerance in THEIRS}
    batch = {tolerance: heyoka_batch(case, tolerance) for tolerance in THEIRS}
    for kind, bar in (("equal errors", case.bar), ("at the tightest", None)):
        ours, theirs = TIGHTEST, THEIRS[0]
        if bar is not None:
            ours = case.loosest(lambda rtol: case.ours(case.omega, rtol), OURS, exact_one)
            theirs = case.loosest(lambda rtol: alone[rtol](), THEIRS, exact_one)
        yield Row(
            name=f"{case.name}, a rotation, {kind}, {ours:.0e}",
            peer=f"heyoka, {theirs:.0e}",
            ours=lambda ours=ours: case.ours(case.omega, ours),
            theirs=alone[theirs],
            compare=within(1e-12),
            items=ROTATIONS,
            at_least=bar,
        )
    # The bar is held against the peer as it comes, in doubles to the last digit.
    for kind, bar in (("equal errors", None), ("at the tightest", 1.5)):
        ours, theirs = TIGHTEST, THEIRS[0]
        if bar is None:
            ours = case.loosest(lambda rtol: case.ours(some, rtol), OURS, exact_some)
            theirs = case.loosest(lambda rtol: batch[rtol](some), THEIRS, exact_some)
        yield Row(
            name=f"{case.name}, 1e4 motions, {kind}, {ours:.0e}",
            peer=f"heyoka, batch of 8, {theirs:.0e}",
            ours=lambda ours=ours: case.ours(starts, ours),
            theirs=lambda theirs=theirs: batch[theirs](starts),
            compare=within(2e-12),
            items=count,
            at_least=bar,
        )


def heyoka_alone(case: Case, tolerance: float) -> Callable[[], Any]:
    """The end of the motion by one integrator."""
    import heyoka

    alone = heyoka.taylor_adaptive(case.symbols(), [*case.omega, *ATTITUDE], tol=tolerance)

    def run() -> Any:
        alone.time = 0.0
        alone.state[:] = [*case.omega, *ATTITUDE]
        alone.propagate_until(case.time)
        return alone.state.copy()

    return run


def heyoka_batch(case: Case, tolerance: float, lanes: int = 8) -> Callable[[Any], Any]:
    """The ends of many motions by one integrator of a batch."""
    import heyoka

    batch = heyoka.taylor_adaptive_batch(case.symbols(), np.zeros((7, lanes)), tol=tolerance)

    def run(starts: Any) -> Any:
        ends = np.empty((len(starts), 7))
        for first in range(0, len(starts), lanes):
            batch.set_time(0.0)
            batch.state[:3] = starts[first : first + lanes].T
            batch.state[3:] = np.array(ATTITUDE)[:, np.newaxis]
            batch.propagate_until(case.time)
            ends[first : first + lanes] = batch.state.T
        return ends

    return run
