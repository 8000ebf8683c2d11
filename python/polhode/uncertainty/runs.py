"""Whether the first order is enough for the sigmas of a motion: by runs of bodies and starts beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode import _core
from polhode._from_zero import runs_from_zero
from polhode._repr import short
from polhode._rows import rows_of
from polhode._variables import angles_of, of_forms, row_of
from polhode.errors import PolhodeError
from polhode.uncertainty.neighbours import Neighbours
from polhode.uncertainty.propagation import is_enough

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode.trajectory import Trajectory

    Floats = NDArray[np.float64]

__all__ = ["StateLinear", "state_linear"]

DIRECTIONS: Final = 64
"""In which second- and third-order terms are looked for."""
NEAR: Final = 1.0 / 64
"""Of a step, in deviations: so short that the first order is all that is seen."""
ROUNDING: Final = 1e-9
"""Of attitude in radians, and of the angular velocity."""


class StateLinear(NamedTuple):
    """Whether standard deviations to first order are enough at every time: within about a percent.

    Attributes
    ----------
    attitude, omega : numpy.ndarray of bool, shape (..., T, 3)
    """

    attitude: Any
    omega: Any

    def __repr__(self) -> str:
        return short(self)


def state_linear(run: Trajectory) -> StateLinear:
    """Tell at which times the sigmas of an uncertain motion are linear enough.

    Runs of 256 neighbours, along random directions in the space of what is uncertain, show the terms of
    second and third order. They are run by the defaults of :meth:`polhode.RigidBody.simulate`.
    """
    if isinstance(run.uncertain_start, tuple):
        stack, times = run.omega.shape[:-2], run.omega.shape[-2]
        found = [_row(run, stack, row) for row in range(int(np.prod(stack, dtype=int)))]
        linear = np.array(found).reshape(*stack, times, 6)
    else:
        stack = run.omega.shape[: run.omega.ndim - 1 - run.t.ndim]
        linear = np.zeros((*stack, run.t.size, 6), dtype=bool)
        for part, which, places in runs_from_zero(run):
            of_part = state_linear(part)
            linear[..., which, :] = np.concatenate(of_part, axis=-1)[..., places, :]
        linear = linear.reshape(*stack, *run.t.shape, 6)
    return StateLinear(linear[..., :3], linear[..., 3:])


def _row(run: Trajectory, stack: tuple[int, ...], row: int) -> NDArray[np.bool_]:
    """Tell it of one motion of a stack, shape (T, 6)."""
    place = np.unravel_index(row, stack)
    body, load = _taken(run.body, stack, row), _taken(run.load, stack, row)
    start = run.uncertain_start
    of_omega, of_attitude = start if isinstance(start, tuple) else (None, None)
    arguments = []
    if of_omega is not None:
        arguments.append(row_of(of_omega, rows_of(np.shape(of_omega.value)[:-1], stack)[row]))
    if of_attitude is not None:
        arguments.append(of_forms(np.zeros(3), angles_of(of_attitude, stack, row)))
    around = Neighbours(None if body.covariance is None else body, arguments)
    rng = np.random.default_rng(20)
    directions = rng.normal(size=(DIRECTIONS, around.rank))
    steps = np.concatenate([directions, -directions, NEAR * directions, -NEAR * directions])
    try:
        neighbours = [around.at(step) for step in steps]
    except PolhodeError:  # beyond what bodies have
        return np.zeros((len(run.t), 6), dtype=bool)
    bodies: Any = body
    if body.covariance is not None:
        bodies = _core.RigidBody.stack([one[0] for one in neighbours])
        neighbours = [one[1:] for one in neighbours]
    omega: Any = run.omega[place][0]
    attitude: Any = run.quaternion[place][0]
    if of_omega is not None:
        omega = np.array([one[0] for one in neighbours])
    if of_attitude is not None:
        attitude = _product(_exponential(np.array([one[-1] for one in neighbours])), attitude)
    at_start: dict[str, Any] = {} if run.pivoted else {"velocity": run.velocity[place][0]}
    if "_given" in run.__dict__:
        at_start["states"] = {name: run.states[name][place][0] for name in run.__dict__["_given"]}
    try:
        beside = bodies.simulate(
            run.t,
            omega,
            attitude,
            load=load,
            position=run.position[place][0],
            about=run._about_word(),
            **at_start,
        )
    except PolhodeError:
        return np.zeros((len(run.t), 6), dtype=bool)
    back = run.quaternion[place] * np.array([-1.0, -1.0, -1.0, 1.0])
    moved = np.concatenate(
        [_logarithm(_product(back, beside.quaternion)), beside.omega - run.omega[place]], axis=-1
    )
    above, below, near, beyond = moved.reshape(4, DIRECTIONS, len(run.t), 6)
    first = (near - beyond) / (2 * NEAR)
    speed = float(np.nanmax(np.abs(run.omega[place]), initial=0.0))
    noise = ROUNDING * np.array([1.0, 1.0, 1.0, speed, speed, speed])
    return is_enough(first, 0.5 * (above - below), 0.5 * (above + below), (first**2).mean(axis=0), noise)


def _taken(many: Any, stack: tuple[int, ...], row: int) -> Any:
    """Take what a row has of a stack of bodies or loads."""
    if many is None or not many.shape:
        return many
    return many[np.unravel_index(rows_of(many.shape, stack)[row], many.shape)]


def _product(a: Floats, b: Floats) -> Floats:
    """Multiply quaternions (x, y, z, w): the rotation b, then a."""
    u, v = a[..., :3], b[..., :3]
    vector = a[..., 3:] * v + b[..., 3:] * u + np.cross(u, v)
    scalar = a[..., 3:] * b[..., 3:] - (u * v).sum(axis=-1, keepdims=True)
    return np.concatenate([vector, scalar], axis=-1)


def _exponential(angles: Floats) -> Floats:
    """Give the quaternions of rotation vectors."""
    half = 0.5 * np.linalg.norm(angles, axis=-1, keepdims=True)
    return np.concatenate([0.5 * angles * np.sinc(half / np.pi), np.cos(half)], axis=-1)


def _logarithm(quaternion: Floats) -> Floats:
    """Give the rotation vectors of quaternions, of at most half a turn."""
    q = np.where(quaternion[..., 3:] < 0.0, -quaternion, quaternion)
    sine = np.linalg.norm(q[..., :3], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, q[..., 3:])
    return q[..., :3] * np.where(sine > 0.0, angle / np.where(sine > 0.0, sine, 1.0), 2.0)
