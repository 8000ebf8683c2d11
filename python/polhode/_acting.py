"""What acts on a body along its motion: torque, force, potential, and what follows from them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode import _core
from polhode._carried import of_rotor

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode.motion.trajectory import Trajectory

    Floats = NDArray[np.float64]

__all__ = ["angular_acceleration", "force", "pivot_reaction", "potential_energy", "torque"]


def torque(self: Trajectory) -> Floats:
    """Torque of the load about the point `about` at every time, components in the body frame.

    The torque of wheels is ``I ω̇ + ω × I ω``, where I includes the wheels as if they were locked.

    Returns
    -------
    numpy.ndarray, shape (..., T, 3)
    """
    if self.load is None and "_within" in self.__dict__:
        return of_rotor(self)
    if self._acting("torque") is None:
        return np.zeros_like(self.omega)
    assert self.load is not None
    return self._over_time(self.load).torque(*self._states(), **self._subject(), states=self._own_states())


def force(self: Trajectory) -> Floats:
    """Sum of the forces of the load at every time, components in space.

    Returns
    -------
    numpy.ndarray, shape (..., T, 3)
    """
    if self.load is None:
        if self._is_loaded():
            self._acting("force")
        return np.zeros_like(self.omega)
    return self._over_time(self.load).force(*self._states(), **self._subject(), states=self._own_states())


def angular_acceleration(self: Trajectory) -> Floats:
    """Angular acceleration at every time by Euler's equations, components in the body frame.

    Returns
    -------
    numpy.ndarray, shape (..., T, 3)
    """
    return self._bodies().angular_acceleration(self.omega, self.torque(), about=self._reference())


def potential_energy(self: Trajectory) -> Floats:
    """Potential energy in the field of the load at every time.

    Returns
    -------
    numpy.ndarray, shape (..., T)
        For example ``-m g·r_C`` in uniform gravity; see :meth:`polhode.loads.Load.potential`; zero without a
        load.

    Raises
    ------
    ValueError
        For a load with a part that has no potential.
    """
    potential = self._potential()
    if potential is None:
        raise ValueError(
            "potential_energy: a part of the load has no potential; weight, forces constant in space and "
            "feedback without damping have one"
        )
    return potential


def pivot_reaction(
    self: Trajectory, gravity: ArrayLike = (0.0, 0.0, 0.0), force: ArrayLike = (0.0, 0.0, 0.0)
) -> Floats:
    """Force with which the pivot holds a body simulated with ``about="origin"``, at every time.

    Parameters
    ----------
    gravity : array_like, shape (..., 3)
        Gravitational acceleration g, components in space. Give it only if the load of the simulation held the
        torque of the weight but not the weight itself.
    force : array_like, shape (..., 3)
        Sum of the forces that act besides those of the load, components in space.

    Returns
    -------
    numpy.ndarray, shape (..., T, 3)
        Force on the body, components in space: m a_C minus the forces of the load, minus m g, minus `force`.

    Raises
    ------
    ValueError
        For a motion whose point `about` is not the origin of the body frame, or moves.
    """
    if not self.pivoted:
        raise ValueError('pivot_reaction: no pivot holds this body; simulate it with about="origin"')
    return self._bodies().pivot_reaction(
        self.omega,
        self.angular_acceleration(),
        self.quaternion,
        gravity=gravity,
        force=self.force() + _core.real_numbers(force, "force"),
    )
