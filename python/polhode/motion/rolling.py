"""Rolling in closed form: what :meth:`polhode.RigidBody.rolling_motion` returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from polhode import _core
from polhode.motion.trajectory import Origin, Trajectory

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode._typing import SupportsQuaternion

    Floats = NDArray[np.float64]

__all__ = ["RollingMotion"]

_DOWN = (0.0, 0.0, -9.81)


@dataclass(frozen=True, eq=False)
class RollingMotion:
    """The motion of a ball on a plane, or of a cylinder or a cone that lies on it, in closed form.

    Made by :meth:`polhode.RigidBody.rolling_motion`. The plane is z = 0.

    Attributes
    ----------
    body : RigidBody
        The body, or the stack of them.
    surface : Surface or RuledSurface
        The surface of the body.
    omega : numpy.ndarray, shape (..., 3)
        Angular velocity at t = 0, components in the body frame.
    quaternion : numpy.ndarray, shape (..., 4)
        R_NB at t = 0 as (x, y, z, w).
    gravity : numpy.ndarray, shape (..., 3)
        The acceleration of free fall, components in space.
    turntable : float
        Rate of the plane about z.

    Notes
    -----
    Position, velocity, force and the angular velocity in space are elementary functions of time. A cone on a
    slope is a pendulum, whose angle theta functions give. The attitude is elementary too, but for a ball on a
    slope or a turntable: there it solves a linear equation, which is summed by power series, on a level
    turntable over one period, on a slope from the start.

    Examples
    --------
    A cone rolls round its apex. It tips over its rim if it goes round too fast:

    >>> import numpy as np
    >>> from polhode import rolling, solids
    >>> body, cone = solids.cone(0.1, 0.3, mass=1.0), rolling.cone(0.1, 0.3)
    >>> apex, rim = cone.line_of_contact((1, 0, 0))
    >>> along = (rim - apex) / np.linalg.norm(rim - apex)
    >>> for rate in (10, 20):
    ...     motion = body.rolling_motion(cone, rate * along)
    ...     print(motion.pressure_at(0.0)[0].round(4), motion.tips(0.0))
    0.2415 False
    0.3256 True
    """

    body: _core.RigidBody
    surface: _core.Surface | _core.RuledSurface
    omega: Floats
    quaternion: Floats
    gravity: Floats
    turntable: float

    @classmethod
    def _of_start(
        cls,
        body: _core.RigidBody,
        surface: _core.Surface | _core.RuledSurface,
        omega: ArrayLike,
        attitude: ArrayLike | SupportsQuaternion | None,
        gravity: ArrayLike | None,
        turntable: float,
    ) -> RollingMotion:
        """Make the motion that has this state at t = 0."""
        down = _core.real_numbers(_DOWN if gravity is None else gravity, "gravity")
        start = _core.rolling_states(body, surface, omega, attitude, down, turntable, 0.0)
        return cls(body, surface, start["omega"], start["quaternion"], down, turntable)

    def _states(self, t: ArrayLike) -> dict[str, Any]:
        return _core.rolling_states(
            self.body, self.surface, self.omega, self.quaternion, self.gravity, self.turntable, t
        )

    def at(self, t: ArrayLike) -> Trajectory:
        """Compute the motion at the times asked for.

        Parameters
        ----------
        t : array_like
            Times of any shape and in any order, negative ones too.

        Returns
        -------
        Trajectory
            Of the centre of mass. The axes of the arrays are those of the stack, then those of `t`, then the
            components. That of a ball has a :attr:`~polhode.Trajectory.contact`. A time that is not finite
            gives NaN.

        Raises
        ------
        PolhodeError
            For a time after so many turns that no digit of the attitude is known; of a ball on a slope
            after 1e5 radians.
        """
        times = np.array(_core.real_numbers(t, "t"))
        found = self._states(times)
        stack = found["omega"].shape[: found["omega"].ndim - 1 - times.ndim]
        none = np.zeros(stack, dtype=np.int64)
        is_ball = isinstance(self.surface, _core.Surface)
        motion = Trajectory(
            body=self.body,
            t=times,
            **{name: found[name] for name in ("omega", "quaternion", "position", "velocity")},
            about=self.body.center_of_mass,
            steps=none,
            evaluations=none,
            load=_core.uniform_gravity(self.gravity) if is_ball else None,
        )
        if isinstance(self.surface, _core.Surface):
            motion.__dict__["_contact"] = _core.rolling_plane(self.surface, turntable=self.turntable)
            motion.__dict__["_contact_extremes"] = found["extremes"]
        else:
            motion.__dict__["_origin"] = Origin(plane=True)
        return motion

    def force(self, t: ArrayLike) -> Floats:
        """Compute the resultant force of the plane on the body.

        Parameters
        ----------
        t : array_like

        Returns
        -------
        numpy.ndarray, shape (..., 3)
            Components in space, at each of the times. On a line of contact a couple about the normal acts
            too.
        """
        force: Floats = self._states(t)["force"]
        return force

    def pressure_at(self, t: ArrayLike) -> Floats:
        """Compute the centre of pressure: the point of the plane where the normal force acts.

        Parameters
        ----------
        t : array_like

        Returns
        -------
        numpy.ndarray, shape (..., 3)
            In space, at each of the times: of a ball the point of contact, else a place on the line of
            contact, beyond its ends where the body :meth:`tips`.
        """
        pressure: Floats = self._states(t)["pressure"]
        return pressure

    def tips(self, t: ArrayLike) -> Any:
        """Return whether the centre of pressure would have to be beyond an end of the line of contact.

        There the plane would have to pull: the body tips over that end, and the motion is not this one any
        more.

        Parameters
        ----------
        t : array_like

        Returns
        -------
        bool or numpy.ndarray of bool, shape (...)
            At each of the times.
        """
        return self._states(t)["tips"][()]
