"""Uncertainty of motions: of the states of a run, and of the results of a free motion."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple

import numpy as np

from polhode import _core
from polhode._format import short
from polhode.errors import PolhodeError
from polhode.uncertainty.propagation import Neighbours, PropagationResult, is_enough, propagate, slopes_of
from polhode.uncertainty.variables import angles_of, of_forms, row_of, rows_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from polhode import FreeMotion
    from polhode.motion.trajectory import Trajectory
    from polhode.results import MotionSensitivity

    Places = NDArray[np.intp]
    Floats = NDArray[np.float64]

__all__ = [
    "FromPeriods",
    "PeriodsLinear",
    "PeriodsSigma",
    "StateLinear",
    "StateSigma",
    "each_motion",
    "periods_sigma",
    "runs_from_zero",
    "spin_covariance",
    "start_from_periods",
    "state_covariance",
    "state_linear",
    "state_sigma",
]


def runs_from_zero(run: Trajectory) -> list[tuple[Trajectory, Places, Places]]:
    """Return runs of a closed form from t = 0, forwards and backwards, with all times of this one.

    With each: which of the times, flat, and their places in the run.

    Raises
    ------
    ValueError
        For a run that goes on from another one, and for one from a file that does not hold its load.
    """
    motion = run.uncertain_start
    if motion is None or isinstance(motion, tuple):
        raise ValueError(
            "covariance: the uncertainty of the first state is unknown here, because the motion was resumed "
            "or its load was not saved; simulate from the original start, or use uncertainty.propagate"
        )
    times, found = np.ravel(run.t), []
    for sense, is_its in ((1.0, times >= 0.0), (-1.0, times < 0.0)):
        if is_its.any():
            distances, places = np.unique(np.append(0.0, np.abs(times[is_its])), return_inverse=True)
            found.append((motion.at(sense * distances), np.flatnonzero(is_its), places.ravel()[1:]))
    return found


ELEMENTS: Final = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


class _StateSigma(NamedTuple):
    attitude: Any
    omega: Any


class StateSigma(_StateSigma):
    """Standard deviations of the states of a motion, to first order.

    Attributes
    ----------
    attitude : numpy.ndarray, shape (..., T, 3)
        Standard deviations of the small rotation δ from the attitude, ``R → R exp(δ×)``, components in the
        body frame, in radians.
    omega : numpy.ndarray, shape (..., T, 3)
    """

    _run: Trajectory | None = None
    """The motion they are of."""

    @cached_property
    def linear(self) -> StateLinear:
        """Whether the first order is enough, at every time.

        It is found when it is first asked for, by 256 runs of neighbours of the motion.

        Examples
        --------
        >>> from polhode import RigidBody, Uncertain
        >>> brick = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
        >>> run = brick.simulate([0, 10, 1000], omega=Uncertain((0.3, 0.2, 1.1), sigma=0.001))
        >>> run.sigma.linear.attitude.all(axis=1)
        array([ True,  True, False])
        """
        if self._run is None:
            raise ValueError("linear: these sigmas are not of a motion; ask those of Trajectory.sigma")

        return state_linear(self._run)

    def __repr__(self) -> str:
        return short(self)


def state_covariance(self: Trajectory) -> Floats | None:
    """Compute :attr:`polhode.Trajectory.covariance`."""
    forms, _ = _forms(self)
    if forms is None:
        return None
    found = _squares(forms[..., :6, :])
    found[np.isnan(self.omega).any(axis=-1)] = np.nan  # after the end of a run
    return found


def state_sigma(self: Trajectory) -> StateSigma | None:
    """Compute the standard deviations of attitude and angular velocity, shape (..., T, 3) each, or None."""
    found = self.covariance
    if found is None:
        return None
    deviations = np.sqrt(np.diagonal(found, axis1=-2, axis2=-1))
    both = StateSigma(deviations[..., :3], deviations[..., 3:])
    both._run = self
    return both


def spin_covariance(self: Trajectory, frame: Literal["space", "body"]) -> Floats | None:
    """Return the covariance of L = I_P ω at every time, shape (..., T, 3, 3), or None as of `covariance`.

    δL = δI ω + I δω in the body, and in space what the rotation δ of the body adds, R (δ × L).
    """
    if self.t.ndim != 1:
        raise ValueError("angular_momentum: its covariance is for times of shape (T,)")
    forms, columns = _forms(self)
    if forms is None:
        return None
    body = self.body
    tensor = body.inertia_about(self._about_word())[..., None, :, :]
    changes: Floats = tensor @ forms[..., 3:6, :]
    if self.states:
        by_omega, by_states = _of_carried(self)
        changes = changes + by_omega @ forms[..., 3:6, :] + by_states @ forms[..., 6:, :]
    doubts, stack = body._doubts(), self.omega.shape[:-2]
    if doubts is not None:
        by_numbers = _tensors(self).reshape(-1, 10, 3, 3)
        flat = changes.reshape(-1, *changes.shape[-3:])  # a view: the changes are new
        omega = self.omega.reshape(-1, *self.omega.shape[-2:])
        ends = np.cumsum(doubts["counts"]).tolist()
        for k, row in enumerate(rows_of(body.shape, stack)):
            for entry in range(ends[row] - int(doubts["counts"][row]), ends[row]):
                column = columns[tuple(doubts["variables"][entry].tolist())]
                change = np.tensordot(doubts["tangents"][entry], by_numbers[row], 1)
                flat[k, :, :, column] += omega[k] @ change
    if frame == "space":
        spin = (tensor @ self.omega[..., None])[..., 0]
        if self.carried is not None:
            spin = spin + self.carried[0]
        # Columns (δ × L) of the matrix that belongs to every change of the attitude.
        changes = changes + np.cross(forms[..., :3, :], spin[..., None], axis=-2)
        turned = _core.rotate(self.quaternion[..., None, :], np.swapaxes(changes, -1, -2))
        changes = np.swapaxes(turned, -1, -2)
    return _squares(changes)


def _of_carried(self: Trajectory) -> tuple[Floats, Floats]:
    """Return the derivatives, by ω and by the states, of the momentum of wheels; it is linear in both."""
    load = self._acting("covariance")
    assert load is not None
    stack = self.omega.shape[:-2]
    over_time = self._over_time(load)
    own = {name: np.zeros((*stack, len(self.t), values.shape[-1])) for name, values in self.states.items()}

    def momentum_of(omega: Floats) -> Floats:
        return over_time.carried(self.t, np.broadcast_to(omega, self.omega.shape), own)[0]

    columns = [momentum_of(axis) for axis in np.eye(3)]
    for values in own.values():
        for k in range(values.shape[-1]):
            values[..., k] = 1.0
            columns.append(momentum_of(np.zeros(3)))
            values[..., k] = 0.0
    still = momentum_of(np.zeros(3))  # of rotors, and of wheels whose speed is given
    found = np.stack([column - still for column in columns], axis=-1)
    return found[..., :3], found[..., 3:]


def _squares(forms: Floats) -> Floats:
    """Return the covariance of numbers that depend on independent variables."""
    return np.asarray(np.einsum("...ik,...jk->...ij", forms, forms))


def _forms(self: Trajectory) -> tuple[Floats | None, dict[tuple[int, ...], int]]:
    """Return changes of (δ, ω, states) per deviation of each variable, (..., T, 6 + n, k), and columns."""
    if not isinstance(self.uncertain_start, tuple):
        return _forms_from_zero(self)
    omega, attitude = self.uncertain_start
    doubts = self.body._doubts()
    if doubts is None and omega is None and attitude is None:
        return None, {}
    slopes = self.sensitivity()
    count = slopes.state.shape[-1]  # of (δ, ω) and of the states of the load
    stack, times = self.omega.shape[:-2], self.omega.shape[-2]
    columns: dict[tuple[int, ...], int] = {}
    terms: list[tuple[int, int, Floats]] = []  # row of the stack, column, change at every time
    if doubts is not None:
        by_numbers = _by_numbers(self, slopes).reshape(-1, times, count, 10)
        ends = np.cumsum(doubts["counts"]).tolist()
        for k, row in enumerate(rows_of(self.body.shape, stack)):
            for entry in range(ends[row] - int(doubts["counts"][row]), ends[row]):
                column = columns.setdefault(tuple(doubts["variables"][entry].tolist()), len(columns))
                terms.append((k, column, by_numbers[k] @ doubts["tangents"][entry]))
    by_state = slopes.state.reshape(-1, times, count, count)
    # The states that begin with ω go with it.
    by_omega = by_state[..., 3:6]
    if count > 6:
        by_omega = by_omega + by_state[..., 6:] @ slopes.begins.reshape(-1, 1, count - 6, 3)
    if omega is not None:
        forms, shape = omega._forms(), np.shape(omega.value)
        for k, row in enumerate(rows_of(shape[:-1], stack)):
            for place, form in enumerate(forms[3 * row : 3 * row + 3]):
                for words, step in form:
                    column = columns.setdefault(tuple(words), len(columns))
                    terms.append((k, column, by_omega[k][:, :, place] * step))
    if attitude is not None:
        # Its small angles are about fixed axes; those of the derivatives about the body's.
        starts = self.quaternion[..., 0, :].reshape(-1, 4)
        for k, start in enumerate(starts):
            for axis, form in zip(np.eye(3), angles_of(attitude, stack, k), strict=True):
                local = by_state[k][:, :, :3] @ _core.rotate(start, axis, inverse=True)
                for words, step in form:
                    terms.append((k, columns.setdefault(tuple(words), len(columns)), local * step))
    out = np.zeros((int(np.prod(stack, dtype=int)), times, count, len(columns)))
    for k, column, term in terms:
        out[k, :, :, column] += term
    return out.reshape(*stack, times, count, len(columns)), columns


def _forms_from_zero(self: Trajectory) -> tuple[Floats | None, dict[tuple[int, ...], int]]:
    """Return the same changes and columns as `_forms`, for a motion in closed form at any times."""
    stack = self.omega.shape[: self.omega.ndim - 1 - self.t.ndim]
    flat = np.zeros(0)
    columns: dict[tuple[int, ...], int] = {}
    for run, which, places in runs_from_zero(self):
        forms, columns = _forms(run)
        if forms is None:
            return None, {}
        if not flat.size:
            flat = np.full((*stack, self.t.size, 6, len(columns)), np.nan)
        flat[..., which, :, :] = forms[..., places, :, :]
    return flat.reshape(*stack, *self.t.shape, 6, len(columns)), columns


def _by_numbers(self: Trajectory, slopes: MotionSensitivity) -> Floats:
    """Return the derivatives of (δ, ω, states) by the body's ten numbers, shape (..., T, 6 + n, 10).

    The sensitivities are by the tensor about the reference point P, in its principal axes:
    ``I_P = I_C + m (d² 1 − d dᵀ)``, d from P to C.
    """
    body, about = self.body, self._about_word()
    axes = body.principal_about(about).axes if self.pivoted else body.principal.axes
    tensors = _tensors(self)
    turned = np.swapaxes(axes, -1, -2)[..., None, :, :] @ tensors @ axes[..., None, :, :]
    # By moments, and by the elements 23, 31, 12.
    places = ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))
    changes = np.stack([turned[..., i, j] for i, j in places], axis=-2)
    by_tensor = np.concatenate([slopes.moments, slopes.products], axis=-1)
    found = by_tensor @ changes[..., None, :, :]
    found[..., 0] += slopes.mass
    found[..., 1:4] += slopes.center_of_mass
    return np.asarray(found)


def _tensors(self: Trajectory) -> Floats:
    """Return the derivatives of the tensor about P by the body's ten numbers, shape (..., 10, 3, 3)."""
    body = self.body
    d = body.center_of_mass if self.pivoted else np.zeros_like(body.center_of_mass)
    mass = np.asarray(body.mass)[..., None, None]
    one = np.eye(3)
    tensors = np.zeros((*body.shape, 10, 3, 3))
    tensors[..., 0, :, :] = (d**2).sum(axis=-1)[..., None, None] * one - d[..., :, None] * d[..., None, :]
    for k, axis in enumerate(one):
        if self.pivoted:
            cross = d[..., :, None] * axis + axis[:, None] * d[..., None, :]
            tensors[..., 1 + k, :, :] = mass * (2 * d[..., k, None, None] * one - cross)
    for k, (i, j) in enumerate(ELEMENTS):
        tensors[..., 4 + k, i, j] = tensors[..., 4 + k, j, i] = 1.0
    return tensors


DIRECTIONS: Final = 64
"""Number of directions in which second- and third-order terms are evaluated."""
NEAR: Final = 1.0 / 64
"""Step in deviations: so short that orders above the first are negligible."""
ROUNDING: Final = 1e-9
"""Rounding errors of the attitude in radians, and of the angular velocity."""


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
    """Find at which times the first order is enough for the sigmas of an uncertain motion.

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
    """Find at which times the first order is enough for one motion of a stack, shape (T, 6)."""
    place = np.unravel_index(row, stack)
    body, load = _take_row(run.body, stack, row), _take_row(run.load, stack, row)
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
    if run._origin.states:
        at_start["states"] = {name: run.states[name][place][0] for name in run._origin.states}
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


def _take_row(many: Any, stack: tuple[int, ...], row: int) -> Any:
    """Return the element of a stack of bodies or loads that belongs to a row."""
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
    """Return the quaternions of rotation vectors."""
    half = 0.5 * np.linalg.norm(angles, axis=-1, keepdims=True)
    return np.concatenate([0.5 * angles * np.sinc(half / np.pi), np.cos(half)], axis=-1)


def _logarithm(quaternion: Floats) -> Floats:
    """Return the rotation vectors of quaternions, of at most half a turn."""
    q = np.where(quaternion[..., 3:] < 0.0, -quaternion, quaternion)
    sine = np.linalg.norm(q[..., :3], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, q[..., 3:])
    return q[..., :3] * np.where(sine > 0.0, angle / np.where(sine > 0.0, sine, 1.0), 2.0)


class PeriodsLinear(NamedTuple):
    """Whether standard deviations to first order are enough for each of the periods.

    Attributes
    ----------
    turn, wobble, spin, rotation, precession, flip : bool or numpy.ndarray, shape (...)
    rates : numpy.ndarray of bool, shape (..., 3)
    """

    turn: Any
    wobble: Any
    spin: Any
    rotation: Any
    precession: Any
    flip: Any
    rates: Any

    def __repr__(self) -> str:
        return short(self)


class PeriodsSigma(NamedTuple):
    """Standard deviations of the periods of a free motion, to first order.

    Attributes
    ----------
    turn, wobble, spin, rotation, precession, flip : float or numpy.ndarray, shape (...)
        NaN where a period is infinite, or where the motion does not have it. Of a motion that was made from
        its periods, theirs are those that were given, or 0.
    rates : numpy.ndarray, shape (..., 3)
    linear : PeriodsLinear
        Whether the first order is enough. Near the separatrix, where periods grow without bounds, it is not.
    """

    turn: Any
    wobble: Any
    spin: Any
    rotation: Any
    precession: Any
    flip: Any
    rates: Any
    linear: PeriodsLinear

    def __repr__(self) -> str:
        return short(self)


def periods_sigma(motion: FreeMotion) -> PeriodsSigma | None:
    """Compute standard deviations of the periods, or None where nothing is uncertain."""
    if motion.body.covariance is None and motion.uncertain_start[0] is None:
        return None

    def numbers(body: _core.RigidBody, omega: Any) -> Any:
        near = body.free_motion(omega).periods
        own = [x for x in (near.wobble, near.spin, near.rotation) if not np.isnan(x)]
        speed = np.linalg.norm(omega)
        turn = 2.0 * np.pi / speed if speed > 0.0 else np.inf
        return np.array([turn, *(own or [np.nan]), *(2.0 * np.pi / near.rates), *near.rates])

    # What lies beside a steady or symmetric motion has another mode, and its periods have other names. Their
    # numbers are continuous: wobble, spin and rotation are one, and a flip is half of it.
    found = each_motion(motion, numbers, (8,))
    periods = motion.periods
    axis = np.where(np.isnan(periods.spin), 0, motion.cones.axis)[..., np.newaxis]

    def by_name(values: Any) -> dict[str, Any]:
        of_axes = np.take_along_axis(values[..., 2:5], axis, axis=-1)[..., 0]
        turn, own = values[..., 0], values[..., 1]
        return {"turn": turn, "wobble": own, "spin": own, "rotation": own, "precession": of_axes, "flip": own}

    sigma, linear = by_name(np.asarray(found.sigma)), by_name(np.asarray(found.linear))
    sigma["flip"] = 0.5 * sigma["flip"]
    given = motion._from_periods
    if given is not None:
        rotation, precession = (
            np.broadcast_to(one.sigma if isinstance(one, _core.Uncertain) else 0.0, motion.shape)
            for one in (given.rotation_period, given.precession_period)
        )
        # That of axis 1 was given; a symmetric body whose axis is the third has another one.
        is_given = axis[..., 0] == 0
        exact = {"spin": rotation, "rotation": rotation, "flip": 0.5 * rotation}
        sigma |= exact | {"precession": np.where(is_given, precession, sigma["precession"])}
        linear |= dict.fromkeys(exact, np.ones(motion.shape, dtype=bool))
        linear["precession"] = linear["precession"] | is_given
    for name in sigma:
        is_finite = np.isfinite(getattr(periods, name))
        sigma[name] = np.where(is_finite, sigma[name], np.nan)[()]
        linear[name] = (linear[name] & is_finite)[()]
    return PeriodsSigma(
        **sigma,
        rates=np.asarray(found.sigma)[..., 5:],
        linear=PeriodsLinear(**linear, rates=np.asarray(found.linear)[..., 5:]),
    )


def each_motion(motion: FreeMotion, f: Callable[..., Any], tail: tuple[int, ...]) -> PropagationResult:
    """Propagate ``f(body, omega)``, of shape `tail`, to first order, for each motion of a stack by itself.

    The angular velocity of a motion that was made from periods is solved anew for each neighbour.
    """
    shape = motion.shape
    omega, of_omega = motion.omega.reshape(-1, 3), motion.uncertain_start[0]
    doubts = [] if of_omega is None else rows_of(np.shape(of_omega.value)[:-1], shape)
    given = motion._from_periods
    found = []
    for row, rates in enumerate(omega):
        body = _row_of_body(motion, row)
        with np.errstate(invalid="ignore"):  # of infinite periods
            if given is not None:
                one = given.row(shape, row)

                def of_periods(body: Any, *periods: Any, one: FromPeriods = one) -> Any:
                    return f(body, one.motion(body, periods).omega)

                found.append(propagate(of_periods, body, arguments=one.uncertain))
            elif of_omega is None:
                found.append(propagate(lambda body, rates=rates: f(body, rates), body))
            else:
                found.append(propagate(f, body, arguments=[row_of(of_omega, doubts[row])]))
    size = int(np.prod(tail, dtype=int))
    tails = {"value": tail, "sigma": tail, "covariance": (size, size), "linear": tail}
    joined = {
        name: np.array([getattr(one, name) for one in found], dtype=bool if name == "linear" else float)
        for name in tails
    }
    return PropagationResult(**{name: joined[name].reshape((*shape, *of))[()] for name, of in tails.items()})


def _row_of_body(motion: FreeMotion, row: int) -> _core.RigidBody:
    body = motion.body
    if not body.shape:
        return body
    return body[np.unravel_index(rows_of(body.shape, motion.shape)[row], body.shape)]


def _value(given: Any) -> Floats:
    return np.asarray(given.value if isinstance(given, _core.Uncertain) else given, dtype=float)


class FromPeriods(NamedTuple):
    """The arguments of `RigidBody.free_motion_from_periods`, of an uncertain motion."""

    rotation_period: Any
    precession_period: Any
    mode: Literal["long-axis", "short-axis"]
    sense: float
    phase: Any
    angular_momentum_direction: Any

    def row(self, shape: tuple[int, ...], row: int) -> FromPeriods:
        """Return the arguments of one motion of a stack."""
        periods: list[Any] = []
        for given in self[:2]:
            value = _value(given)
            which = rows_of(value.shape, shape)[row]
            number = value.reshape(-1)[which]
            if isinstance(given, _core.Uncertain):
                periods.append(of_forms(number, [given._forms()[which]]))
            else:
                periods.append(float(number))
        direction = np.broadcast_to(self.angular_momentum_direction, (*shape, 3)).reshape(-1, 3)[row]
        phase = np.broadcast_to(self.phase, shape).reshape(-1)[row]
        return FromPeriods(periods[0], periods[1], self.mode, self.sense, float(phase), direction)

    @property
    def uncertain(self) -> list[_core.Uncertain]:
        """The uncertain ones of the two periods."""
        return [one for one in self[:2] if isinstance(one, _core.Uncertain)]

    def motion(self, body: _core.RigidBody, periods: Any) -> FreeMotion:
        """Solve for the motion of a body, with these values in place of the uncertain periods."""
        values = iter(periods)
        rotation, precession = (next(values) if isinstance(x, _core.Uncertain) else x for x in self[:2])
        return body.free_motion_from_periods(
            rotation, precession, self.mode, self.sense, self.phase, self.angular_momentum_direction
        )


@dataclass(frozen=True)
class _Attitude:
    """Quaternions in the form that `Uncertain` accepts for rotations."""

    quaternion: Any

    def as_quat(self) -> Any:
        return self.quaternion


def start_from_periods(
    motion: FreeMotion, arguments: dict[str, Any]
) -> tuple[FromPeriods, tuple[_core.Uncertain, _core.Uncertain]]:
    """Solve for the start of a motion with given periods, once for each source of uncertainty.

    Parameters
    ----------
    motion : FreeMotion
        That of the values alone.
    arguments : dict
        Those of `RigidBody.free_motion_from_periods`, the periods with their sigmas.

    Returns
    -------
    tuple
        The arguments; and angular velocity and attitude at t = 0, which depend on the variables of body and
        periods to first order.
    """
    given = FromPeriods(**arguments)
    shape = motion.shape
    of_omega: list[Any] = []
    of_attitude: list[Any] = []
    for row, quaternion in enumerate(motion.quaternion.reshape(-1, 4)):
        one = given.row(shape, row)
        around = Neighbours(_row_of_body(motion, row), one.uncertain)
        back = quaternion * np.array([-1.0, -1.0, -1.0, 1.0])

        def start(body: Any, *periods: Any, one: FromPeriods = one, back: Floats = back) -> Floats:
            near = one.motion(body, periods)
            return np.concatenate([near.omega, _logarithm(_product(near.quaternion, back))])

        steps = slopes_of(start, around, (6,)).T @ around.of_variables
        forms = [
            [(words, float(step)) for words, step in zip(around.variables, of_number, strict=True) if step]
            for of_number in steps
        ]
        of_omega += forms[:3]
        of_attitude += forms[3:]
    attitude: Any = _Attitude(motion.quaternion)
    return given, (of_forms(motion.omega, of_omega), of_forms(attitude, of_attitude))
