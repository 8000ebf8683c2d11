"""Clones of Apophis past the Earth beside SciPy's DOP853 and heyoka's batches of eight, from the same starts.

heyoka (``pip install heyoka``) integrates the orbit with each clone, in units that make all numbers of order
one; it is left out where it is not installed.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np
from harness import Row
from polhode import RigidBody, flybys, loads, orbits
from scipy.integrate import solve_ivp

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

HOUR, DAY = 3600.0, 86400.0
MU, SPAN = 398600.4418, 6 * DAY
MOMENTS = np.array([0.64, 0.97, 1.0])
BODY = RigidBody.from_principal(1.0, MOMENTS)
ORBIT = orbits.from_elements(MU, eccentricity=4.253901873, periapsis=38011.486, since_periapsis=-SPAN / 2)
CLONES, BESIDE_SCIPY, BESIDE_HEYOKA = 20_000, 5, 8000
RTOL = 1e-12


def ensemble(clones: int = CLONES) -> Any:
    """The whole: clones drawn, run and gathered."""
    return flybys.clones(
        BODY,
        ORBIT,
        SPAN,
        rotation_period=264.178 * HOUR,
        precession_period=27.38547 * HOUR,
        mode="short-axis",
        n=clones,
        rtol=RTOL,
        progress=False,
    ).compute()


def rows() -> Iterator[Row]:
    """Yield the comparisons of this file."""
    states = ensemble()
    omega, quaternion = states.omega.to_numpy(), states.quaternion.to_numpy()

    def same(_ours: Any, theirs: NDArray[np.float64]) -> None:
        count = len(theirs)
        size = np.linalg.norm(omega[:count, 1], axis=-1).min()
        assert np.abs(theirs - omega[:count, 1]).max() < 1e-8 * size

    yield Row(
        name=f"flyby, {CLONES:.0e} clones, 6 days at {RTOL:.0e}, drawn and gathered",
        peer=f"SciPy DOP853 at {RTOL:.0e}, {BESIDE_SCIPY} of them",
        ours=ensemble,
        theirs=lambda: np.array([by_scipy(omega[k, 0], quaternion[k, 0]) for k in range(BESIDE_SCIPY)]),
        compare=same,
        items=CLONES,
        peer_items=BESIDE_SCIPY,
        at_least=300,
    )
    if find_spec("heyoka"):
        run = by_heyoka()
        starts = omega[:BESIDE_HEYOKA, 0], quaternion[:BESIDE_HEYOKA, 0]
        load = loads.gravity_gradient(ORBIT)
        yield Row(
            name=f"flyby, {BESIDE_HEYOKA} clones from given starts, {RTOL:.0e}",
            peer=f"heyoka, batch of 8, {RTOL:.0e}",
            ours=lambda: BODY.simulate([0.0, SPAN], *starts, load=load, rtol=RTOL),
            theirs=lambda: run(*starts),
            compare=same,
            items=BESIDE_HEYOKA,
            at_least=1.5,
        )


def equations(state: Any, mu: float) -> list[Any]:
    """The rates of orbit, attitude and ω, for numbers or symbols."""
    rx, ry, rz, vx, vy, vz, x, y, z, w, p, q, r = state
    square = rx * rx + ry * ry + rz * rz
    pull = mu * square**-1.5
    # r in the body: the transpose of the rotation.
    ux = (1 - 2 * (y * y + z * z)) * rx + 2 * (x * y + z * w) * ry + 2 * (x * z - y * w) * rz
    uy = 2 * (x * y - z * w) * rx + (1 - 2 * (x * x + z * z)) * ry + 2 * (y * z + x * w) * rz
    uz = 2 * (x * z + y * w) * rx + 2 * (y * z - x * w) * ry + (1 - 2 * (x * x + y * y)) * rz
    a, b, c = MOMENTS.tolist()
    k = 3 * mu * square**-2.5
    return [
        vx, vy, vz, -pull * rx, -pull * ry, -pull * rz,
        0.5 * (w * p + y * r - z * q), 0.5 * (w * q + z * p - x * r), 0.5 * (w * r + x * q - y * p),
        -0.5 * (x * p + y * q + z * r),
        (b - c) / a * (q * r - k * uy * uz), (c - a) / b * (r * p - k * uz * ux),
        (a - b) / c * (p * q - k * ux * uy),
    ]  # fmt: skip


def units() -> tuple[NDArray[np.float64], float]:
    """The orbit's state at the start and μ, in days and 1e5 kilometres."""
    position, velocity = (np.asarray(one) for one in ORBIT.at(0.0))
    return np.concatenate([position / 1e5, velocity * DAY / 1e5]), MU * DAY**2 / 1e15


def by_scipy(omega: NDArray[np.float64], quaternion: NDArray[np.float64]) -> NDArray[np.float64]:
    """ω at the end; the orbit is integrated with the body."""
    orbit, mu = units()
    start = np.concatenate([orbit, quaternion, omega * DAY])
    run = solve_ivp(
        lambda _, s: equations(s.tolist(), mu), (0.0, SPAN / DAY), start, "DOP853", rtol=RTOL, atol=RTOL
    )
    return run.y[10:, -1] / DAY


def by_heyoka() -> Callable[[Any, Any], NDArray[np.float64]]:
    """A function that gives ω at the end of many clones."""
    import heyoka

    variables = heyoka.make_vars("rx", "ry", "rz", "vx", "vy", "vz", "x", "y", "z", "w", "p", "q", "r")
    orbit, mu = units()
    batch = heyoka.taylor_adaptive_batch(
        list(zip(variables, equations(variables, mu), strict=True)), np.zeros((13, 8)), tol=RTOL
    )

    def run(omega: Any, quaternion: Any) -> NDArray[np.float64]:
        ends = []
        for first in range(0, len(omega), 8):
            batch.set_time(0.0)
            batch.state[:6] = orbit[:, None]
            batch.state[6:10] = quaternion[first : first + 8].T
            batch.state[10:] = omega[first : first + 8].T * DAY
            batch.propagate_until(SPAN / DAY)
            ends.append(batch.state[10:].T / DAY)
        return np.concatenate(ends)

    return run
