"""The contact of a body that rolls or slips: what the plane does to it at every time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from polhode._format import short

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["ContactHistory", "Extreme"]


class Extreme(NamedTuple):
    """An extreme of a contact over a whole run.

    Attributes
    ----------
    value : float or numpy.ndarray, shape (...)
    t : float or numpy.ndarray, shape (...)
        When it is reached, located between the times of the motion.
    """

    value: Any
    t: Any

    def __repr__(self) -> str:
        return short(self)


@dataclass(frozen=True, eq=False)
class ContactHistory:
    """The contact of a body that rolls or slips on a plane, at every time of its motion.

    Attributes
    ----------
    point : numpy.ndarray, shape (..., T, 3)
        The point of contact, in space; of a body that flies its lowest point.
    point_in_body : numpy.ndarray, shape (..., T, 3)
        The same point from the origin of the body frame, components in the body frame.
    force : numpy.ndarray, shape (..., T, 3)
        Force of the plane on the body, components in space.
    normal_force : numpy.ndarray, shape (..., T)
        Its component along the normal.
    couple : numpy.ndarray, shape (..., T, 3)
        Couple of the plane on the body, components in space: the resistance to rolling and pivoting.
    friction_needed : numpy.ndarray, shape (..., T)
        The force across the normal over that along it. The body rolls if the coefficient of friction is
        larger.
    slip : numpy.ndarray, shape (..., T, 3)
        Velocity of the body at the point of contact less that of the plane, in space; of a body that rolls
        rounding errors of zero.
    power : numpy.ndarray, shape (..., T)
        Power of force and couple; zero for a body that rolls on a plane at rest without resistance.
    work : numpy.ndarray, shape (..., T)
        Work of force and couple since the start, integrated with the motion.
    phase : numpy.ndarray of str, shape (..., T)
        "rolling", "sliding" or "flying"; "" after the end of a run.
    residual : numpy.ndarray, shape (..., T, 2)
        Height of the contact over the plane, relative to the size of the surface, and slip, relative to the
        size times the angular speed; of a body that slips the part of the slip along the normal.
    largest_friction_needed, smallest_normal_force : Extreme
        Over the whole run, located between the times too: value and time. Where the plane would have to pull,
        the friction needed is inf.

    Examples
    --------
    A coin wobbles; between its two outputs it needs more friction than coins have on a table:

    >>> import numpy as np
    >>> from polhode import loads, rolling, solids
    >>> coin = solids.cylinder(0.01, 0.0, mass=0.005)
    >>> tilted = (np.sin(0.5), 0, 0, np.cos(0.5))
    >>> motion = coin.simulate(
    ...     [0, 0.2], omega=(0, 10, 0), attitude=tilted, load=loads.uniform_gravity((0, 0, -9.81)),
    ...     contact=rolling.plane(rolling.disk(0.01)),
    ... )
    >>> contact = motion.contact
    >>> contact.force.shape, bool(contact.largest_friction_needed.value >= contact.friction_needed.max())
    ((2, 3), True)
    """

    point: Floats
    point_in_body: Floats
    force: Floats
    normal_force: Floats
    couple: Floats
    friction_needed: Floats
    slip: Floats
    power: Floats
    work: Floats
    phase: NDArray[np.str_]
    residual: Floats
    largest_friction_needed: Extreme
    smallest_normal_force: Extreme

    def __repr__(self) -> str:
        most, least = self.largest_friction_needed, self.smallest_normal_force
        return f"ContactHistory(largest_friction_needed={most!r}, smallest_normal_force={least!r})"
