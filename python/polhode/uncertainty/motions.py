"""Uncertainty of what follows from a free motion, and of a motion that follows from its periods."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from polhode import _core
from polhode._repr import short
from polhode._rows import rows_of
from polhode._variables import of_forms, row_of
from polhode.uncertainty.neighbours import Neighbours
from polhode.uncertainty.propagation import Propagated, propagate, slopes_of
from polhode.uncertainty.runs import _logarithm, _product

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from polhode import FreeMotion

    Floats = NDArray[np.float64]

__all__ = [
    "FromPeriods",
    "PeriodsLinear",
    "PeriodsSigma",
    "each_motion",
    "periods_sigma",
    "start_from_periods",
]


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

    def named(values: Any) -> dict[str, Any]:
        of_axes = np.take_along_axis(values[..., 2:5], axis, axis=-1)[..., 0]
        turn, own = values[..., 0], values[..., 1]
        return {"turn": turn, "wobble": own, "spin": own, "rotation": own, "precession": of_axes, "flip": own}

    sigma, linear = named(np.asarray(found.sigma)), named(np.asarray(found.linear))
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


def each_motion(motion: FreeMotion, f: Callable[..., Any], tail: tuple[int, ...]) -> Propagated:
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
    return Propagated(**{name: joined[name].reshape((*shape, *of))[()] for name, of in tails.items()})


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
        """Those of the two periods that are uncertain."""
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
    """Quaternions as what `Uncertain` takes for rotations."""

    quaternion: Any

    def as_quat(self) -> Any:
        return self.quaternion


def start_from_periods(
    motion: FreeMotion, arguments: dict[str, Any]
) -> tuple[FromPeriods, tuple[_core.Uncertain, _core.Uncertain]]:
    """Solve for the start of a motion with given periods anew along each source of uncertainty.

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
