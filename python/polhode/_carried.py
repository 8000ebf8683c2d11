"""What a body carries along on its motion: the momentum of wheels, rotors and slugs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from polhode import _core
from polhode.motion.gyrostat import Wheel, wheel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode.motion.trajectory import Trajectory

    Floats = NDArray[np.float64]

ROUNDING = 1e-12
"""A moment that small, relative to the largest, is that of no wheel."""

__all__ = ["acting", "exact", "now", "of_rotor"]


def _rotor(self: Trajectory) -> tuple[Floats, Floats]:
    """Give the momentum h inside a gyrostat, and Σ J a aᵀ of its free wheels."""
    motion: _core.GyrostatMotion = self.__dict__["_within"]
    return motion.rotor, motion.gyrostat._rotor()[1]


def now(self: Trajectory) -> tuple[Floats, Floats] | None:
    """Give momentum and energy of what the body carries along under the load, or as a gyrostat."""
    if "_within" in self.__dict__:
        momentum, free = _rotor(self)
        of_free = np.einsum(
            "...ij,...j->...i", free[(..., *self._time_axes(), slice(None), slice(None))], self.omega
        )
        return self._per_time(momentum) - of_free, -0.5 * np.einsum("...i,...i->...", self.omega, of_free)
    if self.load is None or not self.load.carries:
        return None
    return self._over_time(self.load).carried(self.t, self.omega, self._own_states())


def acting(self: Trajectory, what: str, index: int = 0) -> _core.Load | None:
    """Give the load under which a simulation finds this motion; of a gyrostat from one of its times on."""
    if self.load is None and self._is_loaded() and self.carried is None:
        raise ValueError(f"{what}: a load acted on this motion, which its file does not hold")
    if self.load is not None or self.carried is None:
        return self.load
    if "_within" not in self.__dict__:
        raise ValueError(
            f"{what}: the body carries something along of which these states tell the momentum alone, "
            "not the load; a file does not hold it"
        )
    momentum, free = _rotor(self)
    return _inside(self, what, index) if np.any(free) else _core.rotor(momentum)


def _inside(self: Trajectory, what: str, index: int) -> _core.Load:
    """Give what turns freely in a gyrostat as wheels along the axes of Σ J a aᵀ, and the rest as a rotor."""
    momentum, free = _rotor(self)
    inertias, axes = np.linalg.eigh(free)
    turning = inertias > ROUNDING * inertias[..., -1:]
    rows = turning.reshape(-1, 3)
    if (rows != rows[0]).any():
        raise ValueError(
            f"{what}: the gyrostats have free wheels along one, two or three axes; ask one by one"
        )
    start = self.omega[..., index, :]
    load, rest = None, momentum
    for k in np.flatnonzero(rows[0]):
        axis, inertia = axes[..., k], inertias[..., k]
        held = np.einsum("...i,...i->...", axis, momentum)
        rest = rest - held[..., None] * axis
        rate = held / inertia - np.einsum("...i,...i->...", axis, start)
        one = _core.wheel(axis, inertia, rate)
        load = one if load is None else load + one
    assert load is not None
    return load + _core.rotor(rest)


def exact(self: Trajectory) -> _core.FreeMotion | _core.GyrostatMotion | None:
    """Give the motion in closed form from the first state on, of one body; None where none is known."""
    if self._is_loaded() or self.pivoted:
        return None
    if "_within" not in self.__dict__:
        return self.body.free_motion(self.omega[0], self.quaternion[0]) if self.carried is None else None
    motion: _core.GyrostatMotion = self.__dict__["_within"]
    _, (_, besides, wheels) = cast("tuple[Any, tuple[Any, Floats, Any]]", motion.gyrostat.__reduce__())
    now = [_at(one, motion.omega - self.omega[0]) for one in wheels]
    return self.body.gyrostat(besides, wheels=now).free_motion(self.omega[0], self.quaternion[0])


def _at(one: Wheel, slower: Floats) -> Wheel:
    """Give a wheel as it turns where ω is less by so much: one that is free keeps ``J (Ω + a·ω)``."""
    if one.mode == "held":
        return one
    along = (one.axis / np.linalg.norm(one.axis)) @ slower
    return wheel(axis=one.axis, inertia=one.inertia, momentum=one.momentum + one.inertia * along)


def of_rotor(self: Trajectory) -> Floats:
    """Torque of the momentum inside a gyrostat: its own ``(I − F) ω̇ + ω × ((I − F) ω + h) = 0``."""
    momentum, free = _rotor(self)
    tensor = self._bodies().inertia_about(self._reference())
    inertias = free[(..., *self._time_axes(), slice(None), slice(None))]
    total = np.einsum("...ij,...j->...i", tensor - inertias, self.omega) + self._per_time(momentum)
    rate = np.linalg.solve(tensor - inertias, -np.cross(self.omega, total)[..., np.newaxis])
    in_body = np.einsum("...ij,...j->...i", tensor, self.omega)
    torque: Floats = (tensor @ rate)[..., 0] + np.cross(self.omega, in_body)
    return torque
