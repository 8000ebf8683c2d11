"""Wheels for gyrostats."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from polhode import _core

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["Wheel", "wheel"]


@dataclass(frozen=True, eq=False)
class Wheel:
    """A wheel in a body, made by :func:`wheel`; a stack of them where its numbers are arrays.

    Attributes
    ----------
    axis : numpy.ndarray, shape (..., 3)
        Its axis a, in the body frame; only the direction counts.
    inertia : float or numpy.ndarray, shape (...)
        Its moment of inertia J about the axis.
    momentum : float or numpy.ndarray, shape (...)
        J Ω at t = 0, with Ω its rate relative to the body.
    mode : {"free", "held"}
        Whether it keeps its momentum in space or its rate relative to the body.
    """

    axis: NDArray[np.float64]
    inertia: Any
    momentum: Any
    mode: Literal["free", "held"]

    @property
    def rate(self) -> Any:
        """Rate relative to the body at t = 0; not a number for a wheel without inertia."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.true_divide(self.momentum, self.inertia)[()]

    def __eq__(self, other: object) -> bool:
        """Tell whether all numbers are equal."""
        if not isinstance(other, Wheel):
            return NotImplemented
        return self.mode == other.mode and all(
            np.array_equal(getattr(self, name), getattr(other, name))
            for name in ("axis", "inertia", "momentum")
        )

    def __hash__(self) -> int:
        return hash((self.mode, np.asarray(self.axis).tobytes()))


def wheel(
    *,
    axis: ArrayLike,
    inertia: ArrayLike,
    rate: ArrayLike | None = None,
    momentum: ArrayLike | None = None,
    mode: Literal["free", "held"] = "free",
) -> Wheel:
    """Describe a wheel in a body, for :meth:`polhode.RigidBody.gyrostat`.

    Parameters
    ----------
    axis : array_like, shape (..., 3)
        Its axis a, in the body frame; only the direction counts.
    inertia : array_like, shape (...)
        Its moment of inertia J about the axis, which the body's inertia includes.
    rate : array_like, shape (...), optional
        Its rate Ω relative to the body at t = 0.
    momentum : array_like, shape (...), optional
        J Ω, in place of `rate` (give exactly one of the two).
    mode : {"free", "held"}
        A free wheel turns without friction and keeps J (Ω + a·ω); a held one keeps Ω.

    Returns
    -------
    Wheel

    Examples
    --------
    >>> import polhode
    >>> polhode.wheel(axis=(0, 0, 1), inertia=0.02, rate=100.0).momentum
    2.0
    """
    if (rate is None) == (momentum is None):
        raise ValueError("give exactly one of rate= and momentum=")
    if mode not in ("free", "held"):
        raise ValueError(f"mode: {mode!r} is not 'free' or 'held'")
    moment = _core.real_numbers(inertia, "inertia")
    if rate is not None:
        spin = moment * _core.real_numbers(rate, "rate")
    else:
        spin = _core.real_numbers(momentum, "momentum")
    place = _core.real_numbers(axis, "axis")
    if place.shape[-1:] != (3,):
        raise ValueError(f"axis: expected shape (..., 3), got {place.shape}")
    return Wheel(place, _plain(moment), _plain(spin), mode)


def _plain(numbers: Any) -> Any:
    """Give a float for a single number."""
    array = np.asarray(numbers)
    return float(array) if array.ndim == 0 else array
