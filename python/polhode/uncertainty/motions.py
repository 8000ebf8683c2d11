"""Uncertainty of what a free motion tells."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from polhode._repr import short
from polhode._rows import rows_of
from polhode._variables import of_forms
from polhode.uncertainty.propagation import Propagated, propagate

if TYPE_CHECKING:
    from collections.abc import Callable

    from polhode import FreeMotion, _core

__all__ = ["PeriodsLinear", "PeriodsSigma", "each_motion", "periods_sigma", "row_of"]


class PeriodsLinear(NamedTuple):
    """Whether standard deviations to first order are enough for each of the periods.

    Attributes
    ----------
    rotation, precession, flip : bool or numpy.ndarray, shape (...)
    rates : numpy.ndarray of bool, shape (..., 3)
    """

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
    rotation, precession, flip : float or numpy.ndarray, shape (...)
        NaN where a period is infinite.
    rates : numpy.ndarray, shape (..., 3)
    linear : PeriodsLinear
        Whether the first order is enough. Near the separatrix, where periods grow without bounds, it is not.
    """

    rotation: Any
    precession: Any
    flip: Any
    rates: Any
    linear: PeriodsLinear

    def __repr__(self) -> str:
        return short(self)


def periods_sigma(motion: FreeMotion) -> PeriodsSigma | None:
    """Give standard deviations of the periods, or None where nothing is uncertain."""
    if motion.body.covariance is None and motion.uncertain_start[0] is None:
        return None

    def numbers(body: _core.RigidBody, omega: Any) -> Any:
        periods = body.free_motion(omega).periods
        return np.array([periods.rotation, periods.precession, periods.flip, *periods.rates])

    found = each_motion(motion, numbers, (6,))

    def parts(numbers: Any) -> tuple[Any, Any, Any, Any]:
        return numbers[..., 0][()], numbers[..., 1][()], numbers[..., 2][()], numbers[..., 3:]

    linear = PeriodsLinear(*parts(np.asarray(found.linear)))
    return PeriodsSigma(*parts(np.asarray(found.sigma)), linear)


def each_motion(motion: FreeMotion, f: Callable[..., Any], tail: tuple[int, ...]) -> Propagated:
    """Propagate ``f(body, omega)``, of shape `tail`, to first order, for each motion of a stack by itself."""
    shape = motion.shape
    omega, of_omega = motion.omega.reshape(-1, 3), motion.uncertain_start[0]
    bodies = rows_of(motion.body.shape, shape)
    doubts = [] if of_omega is None else rows_of(np.shape(of_omega.value)[:-1], shape)
    found = []
    for row, rates in enumerate(omega):
        place = np.unravel_index(bodies[row], motion.body.shape)
        body = motion.body[place] if place else motion.body
        with np.errstate(invalid="ignore"):  # of infinite periods
            if of_omega is None:
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


def row_of(given: _core.Uncertain, row: int) -> _core.Uncertain:
    """One row of vectors with a sigma."""
    value = np.reshape(given.value, (-1, 3))[row]
    return of_forms(value, given._forms()[3 * row : 3 * row + 3])
