"""Wheels without a motor, and the results of gyrostats."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from polhode import _core
from polhode._core import Wheel
from polhode._format import short

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["Bifurcations", "Equilibria", "Wheel", "wheel"]


class Bifurcations(NamedTuple):
    """Where the number of steady rotations of a gyrostat changes, in descending order of `rotor`.

    Attributes
    ----------
    meeting : numpy.ndarray of str, shape (n,)
        ``"fold"``: a saddle and a stable equilibrium meet and disappear; ``"pitchfork"``: two equilibria of
        one kind meet at a third one, which stays.
    direction : numpy.ndarray, shape (n, 3)
        ``L/|L|`` there, in the body frame.
    momentum : numpy.ndarray, shape (n,)
        The ``|L|`` of the bifurcation for the given h. The two equilibria of a fold, or the pair of a
        pitchfork, exist only for larger ``|L|``.
    rotor : numpy.ndarray, shape (n,)
        The ``|h|`` of the bifurcation for the ``|L|`` that was given to :meth:`Gyrostat.equilibria` and for
        the direction of h of the gyrostat. The same two equilibria exist only for smaller ``|h|``.
    """

    meeting: NDArray[np.str_]
    direction: Floats
    momentum: Floats
    rotor: Floats

    def __repr__(self) -> str:
        return short(self)


class Equilibria(NamedTuple):
    """Steady rotations of a gyrostat for a given length of L = I ω + h, in ascending order of ω·L.

    Attributes
    ----------
    direction : numpy.ndarray, shape (k, 3)
        Unit vector ``L/|L|`` in the body frame. For a circle of equilibria it is one point of the circle.
    omega : numpy.ndarray, shape (k, 3)
        Angular velocity in the body frame, along L.
    kinetic_energy : numpy.ndarray, shape (k,)
        ``½ ω·I ω``.
    squared_rate : numpy.ndarray, shape (k,)
        At a stable equilibrium the squared frequency with which L circles it in the body, in (radians per
        unit of time)². At an unstable one it is negative: minus the squared rate of exponential growth of a
        disturbance.
    kind : numpy.ndarray of str, shape (k,)
        Kind of stationary point of the energy among states with this ``|L|``: ``"minimum"`` (stable, also
        with dissipation), ``"maximum"`` (stable without dissipation), ``"saddle"`` (unstable),
        ``"degenerate"`` (several equilibria meet here).
    circle : numpy.ndarray, shape (k, 3)
        Axis of the circle of equilibria, if two moments are equal and this entry stands for a circle; else
        zero.
    bifurcations : Bifurcations
        Values of h and of ``|L|`` at which the number of equilibria changes.
    """

    direction: Floats
    omega: Floats
    kinetic_energy: Floats
    squared_rate: Floats
    kind: NDArray[np.str_]
    circle: Floats
    bifurcations: Bifurcations

    def __repr__(self) -> str:
        return short(self)


def wheel(
    *,
    axis: ArrayLike,
    inertia: ArrayLike,
    rate: ArrayLike | None = None,
    momentum: ArrayLike | None = None,
    mode: Literal["free", "held"] = "free",
    name: str = "wheel",
) -> Wheel:
    """Make a wheel in a body, for :meth:`polhode.RigidBody.gyrostat` and as a load of a simulation.

    Parameters
    ----------
    axis : array_like, shape (..., 3)
        Axis a of the wheel, in the body frame; only the direction counts.
    inertia : array_like, shape (...)
        Moment of inertia J of the wheel about its axis. The inertia of the body includes it.
    rate : array_like, shape (...), optional
        Rate Ω of the wheel relative to the body at t = 0, in radians per unit of time.
    momentum : array_like, shape (...), optional
        J Ω, in place of `rate` (give exactly one of the two).
    mode : {"free", "held"}
        A free wheel turns without friction, and J (Ω + a·ω) is constant. For a held wheel a motor keeps Ω
        constant.
    name : str
        Name of its state in ``states`` of a trajectory.

    Returns
    -------
    Wheel
        In a simulation a wheel without moment (``inertia=0``) is a rotor: its momentum is constant in the
        body.

    See Also
    --------
    polhode.loads.wheel : a wheel with a motor and friction.

    Examples
    --------
    >>> import polhode
    >>> polhode.wheel(axis=(0, 0, 1), inertia=0.02, rate=100.0).momentum
    2.0
    """
    if mode not in ("free", "held"):
        raise ValueError(f"mode: {mode!r} is not 'free' or 'held'")
    moment = _core.real_numbers(inertia, "inertia")
    given, numbers = ("rate", rate) if momentum is None else ("momentum", momentum)
    if numbers is None or not (rate is None or momentum is None):
        raise ValueError("give exactly one of rate= and momentum=")
    spin = _core.real_numbers(numbers, given)
    try:
        np.broadcast_shapes(moment.shape, spin.shape)
    except ValueError:
        raise ValueError(
            f"inertia and {given}: shapes {moment.shape} and {spin.shape} do not broadcast"
        ) from None
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        rates, momenta = (spin, moment * spin) if momentum is None else (np.true_divide(spin, moment), spin)
    place = _core.real_numbers(axis, "axis")
    if place.shape[-1:] != (3,):
        raise ValueError(f"axis: expected shape (..., 3), got {place.shape}")
    if not (np.isfinite(place).all() and np.any(place, axis=-1).all()):
        raise ValueError(f"axis: expected finite vectors other than zero, got {place.tolist()}")
    if not (np.isfinite(moment).all() and np.min(moment, initial=0.0) >= 0.0):
        raise ValueError(f"inertia: expected finite numbers that are not negative, got {moment.tolist()}")
    if not np.isfinite(momenta).all():
        raise ValueError(f"{given}: J Ω must be finite, got {momenta.tolist()}")
    return Wheel._of(place, moment, rates, momenta, mode, name)
