"""Orbits about an attractor: where a body is, how it moves there, and the local frame that points down.

An :class:`Orbit` is made by :func:`kepler` from a state or by :func:`from_elements`. The loads
:func:`polhode.loads.gravity_gradient` and :func:`polhode.loads.magnetic` act along it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from polhode import _core
from polhode._repr import short

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["DipoleField", "Elements", "LocalFrame", "Orbit", "OrbitState", "from_elements", "kepler"]


class OrbitState(NamedTuple):
    """Where a body is on its orbit, from the attractor, in space.

    Attributes
    ----------
    position, velocity : numpy.ndarray, shape (..., 3)
    """

    position: Floats
    velocity: Floats

    def __repr__(self) -> str:
        return short(self)


class LocalFrame(NamedTuple):
    """The frame that points down: z to the attractor, y along minus the normal of the orbit, x forward.

    Attributes
    ----------
    quaternion : numpy.ndarray, shape (..., 4)
        Its attitude in space as (x, y, z, w), of either sign: that of a body whose axes these are.
    omega : numpy.ndarray, shape (..., 3)
        Its angular velocity relative to space, components in this frame: ``(0, -h/r**2, 0)``.
    """

    quaternion: Floats
    omega: Floats

    def __repr__(self) -> str:
        return short(self)


class Elements(NamedTuple):
    """The elements of an orbit at its epoch; angles in radians.

    Attributes
    ----------
    periapsis : float or numpy.ndarray, shape (...)
        Least distance from the attractor.
    eccentricity : float or numpy.ndarray, shape (...)
    inclination : float or numpy.ndarray, shape (...)
        Between the normal of the orbit and z.
    node : float or numpy.ndarray, shape (...)
        From x to where the orbit crosses the plane xy upward; 0 for an orbit in that plane.
    argument : float or numpy.ndarray, shape (...)
        From the node to the periapsis; 0 for a circle.
    anomaly : float or numpy.ndarray, shape (...)
        From the periapsis to the body (the true anomaly); of a circle from the node.
    """

    periapsis: Any
    eccentricity: Any
    inclination: Any
    node: Any
    argument: Any
    anomaly: Any

    def __repr__(self) -> str:
        return short(self)


@dataclass(frozen=True, eq=False)
class Orbit:
    """A Kepler orbit, or a stack of them: ellipses, parabolas, hyperbolas.

    Attributes
    ----------
    mu : float or numpy.ndarray, shape (...)
        Gravitational parameter of the attractor.
    position, velocity : numpy.ndarray, shape (..., 3)
        From the attractor, in space, at the epoch.
    epoch : float or None
        When the orbit has that state; None: when a motion starts.
    """

    mu: Any
    position: Floats
    velocity: Floats
    epoch: float | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the stack."""
        return np.broadcast_shapes(np.shape(self.mu), self.position.shape[:-1], self.velocity.shape[:-1])

    @property
    def period(self) -> Any:
        """Time of a revolution; infinite but for ellipses. A rounded parabola may be a very long ellipse."""
        return _core.kepler_period(self.mu, self.position, self.velocity)[()]

    @property
    def elements(self) -> Elements:
        """Its elements at the epoch."""
        r, v = self.position, self.velocity
        distance = np.linalg.norm(r, axis=-1)
        swept = np.cross(r, v)
        size = np.linalg.norm(swept, axis=-1)
        mu = np.asarray(self.mu)
        toward = np.cross(v, swept) / mu[..., None] - r / distance[..., None]
        eccentricity = np.linalg.norm(toward, axis=-1)
        flat = np.hypot(swept[..., 0], swept[..., 1])
        node = np.where(flat > 0.0, np.arctan2(swept[..., 0], -swept[..., 1]), 0.0)
        across = np.stack([np.cos(node), np.sin(node), np.zeros_like(node)], axis=-1)
        up = np.cross(swept / size[..., None], across)

        def angle(vector: Floats) -> Any:
            return np.arctan2(np.sum(vector * up, axis=-1), np.sum(vector * across, axis=-1))

        argument = np.where(eccentricity > 0.0, angle(toward), 0.0)
        anomaly = np.remainder(angle(r) - argument + np.pi, 2.0 * np.pi) - np.pi
        found = (
            size**2 / mu / (1.0 + eccentricity),
            eccentricity,
            np.arctan2(flat, swept[..., 2]),
            node,
            argument,
            anomaly,
        )
        return Elements(*(np.asarray(one)[()] for one in found))

    def at(self, t: ArrayLike) -> OrbitState:
        """Give position and velocity at times of any shape.

        Parameters
        ----------
        t : array_like, shape (T...)
            From the epoch on they are ``t - epoch`` later; where there is none, from 0 on.

        Returns
        -------
        OrbitState
            Of shape (..., T..., 3): those of the stack, then those of the times.
        """
        times = _core.real_numbers(t, "t")
        new = (np.newaxis,) * times.ndim
        return OrbitState(
            *_core.kepler_states(
                np.asarray(self.mu)[(..., *new)],
                self.position[(..., *new, slice(None))],
                self.velocity[(..., *new, slice(None))],
                times - (self.epoch or 0.0),
            )
        )

    def frame(self, t: ArrayLike) -> LocalFrame:
        """Give the frame that points down, and its angular velocity, at times of any shape.

        Parameters
        ----------
        t : array_like, shape (T...)
            As of :meth:`at`.

        Returns
        -------
        LocalFrame
        """
        r, v = self.at(t)
        swept = np.cross(r, v)
        size, distance = np.linalg.norm(swept, axis=-1), np.linalg.norm(r, axis=-1)
        z, y = -r / distance[..., None], -swept / size[..., None]
        matrix = np.stack([np.cross(y, z), y, z], axis=-1)
        omega = np.zeros_like(r)
        omega[..., 1] = -size / distance / distance
        return LocalFrame(_core.quaternion_from_matrix(matrix), omega)

    def dipole_field(self, strength: ArrayLike) -> DipoleField:
        """Give the magnetic field along the orbit of a dipole at the attractor.

        Parameters
        ----------
        strength : array_like, shape (..., 3)
            The dipole's moment times μ₀/4π, in space; for the Earth's about 7.8e15 T m³, southward.

        Returns
        -------
        DipoleField
            For :func:`polhode.loads.magnetic`; its ``at(t)`` gives B.
        """
        return DipoleField(self, _vector(strength, "strength"))


@dataclass(frozen=True, eq=False)
class DipoleField:
    """The magnetic field of a dipole at the attractor, along an orbit.

    Attributes
    ----------
    orbit : Orbit
    strength : numpy.ndarray, shape (..., 3)
        The dipole's moment times μ₀/4π, in space.
    """

    orbit: Orbit
    strength: Floats

    def at(self, t: ArrayLike) -> Floats:
        """Give B in space, ``3 (M·r) r/r**5 - M/r**3``, at times of any shape.

        Parameters
        ----------
        t : array_like, shape (T...)
            As of :meth:`Orbit.at`.

        Returns
        -------
        numpy.ndarray, shape (..., T..., 3)
        """
        moment = self.strength[(..., *(np.newaxis,) * np.ndim(t), slice(None))]
        return _core.dipole_field(moment, self.orbit.at(t).position)


def kepler(mu: ArrayLike, position: ArrayLike, velocity: ArrayLike, epoch: float | None = None) -> Orbit:
    """Give the Kepler orbit through a state.

    Parameters
    ----------
    mu : array_like, shape (...)
        Gravitational parameter of the attractor.
    position, velocity : array_like, shape (..., 3)
        From the attractor, in space, at the epoch.
    epoch : float, optional
        When the orbit has that state; the start of a motion by default.

    Returns
    -------
    Orbit

    Raises
    ------
    PolhodeError
        When `mu` is not positive, a position is at the attractor, or the orbit falls into it.

    Examples
    --------
    >>> import numpy as np
    >>> from polhode import orbits
    >>> orbit = orbits.kepler(1.0, (1, 0, 0), (0, 1, 0))
    >>> orbit.at(np.pi / 2).position.round(12)
    array([0., 1., 0.])
    >>> orbit.frame(0.0).omega
    array([ 0., -1.,  0.])
    """
    mass = np.array(_core.real_numbers(mu, "mu"))
    place, speed = _vector(position, "position"), _vector(velocity, "velocity")
    when = None if epoch is None else float(_core.real_numbers(epoch, "epoch"))
    if when is not None and not np.isfinite(when):
        raise ValueError(f"epoch: must be finite, got {when}")
    _core.kepler_states(mass, place, speed, np.zeros(()))  # checks them
    mass.flags.writeable = False
    return Orbit(float(mass) if mass.ndim == 0 else mass, place, speed, when)


def from_elements(
    mu: ArrayLike,
    *,
    eccentricity: ArrayLike,
    periapsis: ArrayLike | None = None,
    semi_major_axis: ArrayLike | None = None,
    inclination: ArrayLike = 0.0,
    node: ArrayLike = 0.0,
    argument: ArrayLike = 0.0,
    anomaly: ArrayLike | None = None,
    since_periapsis: ArrayLike | None = None,
    epoch: float | None = None,
) -> Orbit:
    """Give the Kepler orbit with these elements; angles in radians.

    Parameters
    ----------
    mu : array_like, shape (...)
        Gravitational parameter of the attractor.
    eccentricity : array_like, shape (...)
    periapsis, semi_major_axis : array_like, shape (...)
        Give exactly one: the least distance, or half of the major axis, negative for a hyperbola.
    inclination, node, argument : array_like, shape (...), optional
        As in :class:`Elements`.
    anomaly, since_periapsis : array_like, shape (...), optional
        Where the body is at the epoch: its true anomaly, or the time since it passed the periapsis. At the
        periapsis by default.
    epoch : float, optional
        When it is there; the start of a motion by default.

    Returns
    -------
    Orbit

    Examples
    --------
    >>> from polhode import orbits
    >>> comet = orbits.from_elements(1.0, eccentricity=1.0, periapsis=0.5)
    >>> comet.velocity
    array([0., 2., 0.])
    """
    if (periapsis is None) == (semi_major_axis is None):
        raise ValueError("give exactly one of periapsis= and semi_major_axis=")
    if anomaly is not None and since_periapsis is not None:
        raise ValueError("anomaly: not beside since_periapsis=; give one of the two")

    def number(given: Any, name: str) -> Floats:
        found = _core.real_numbers(given, name)
        if not np.isfinite(found).all():
            raise ValueError(f"{name}: must be finite, got {found.tolist()}")
        return found

    mass, e = number(mu, "mu"), number(eccentricity, "eccentricity")
    if np.min(e, initial=0.0) < 0.0:
        raise ValueError(f"eccentricity: must not be negative, got {e.tolist()}")
    if np.min(mass, initial=1.0) <= 0.0:
        raise ValueError(f"mu: must be positive, got {mass.tolist()}")
    if periapsis is not None:
        least = number(periapsis, "periapsis")
    else:
        axis = number(semi_major_axis, "semi_major_axis")
        if not _do_broadcast(axis, e):
            raise ValueError(
                f"semi_major_axis and eccentricity: shapes {axis.shape} and {e.shape} do not broadcast"
            )
        least = axis * (1.0 - e)
    if np.min(least, initial=1.0) <= 0.0:
        raise ValueError(
            f"periapsis: must be positive, got {least.tolist()}; a hyperbola has a negative semi_major_axis, "
            "a parabola none"
        )
    angles = (number(inclination, "inclination"), number(node, "node"), number(argument, "argument"))
    nu = np.zeros(()) if anomaly is None else number(anomaly, "anomaly")
    given = (mass, e, least, nu, *angles)
    if not _do_broadcast(*given):
        raise ValueError(
            "mu, eccentricity, periapsis, anomaly, inclination, node and argument: shapes "
            f"{[one.shape for one in given]} do not broadcast"
        )
    mass, e, least, nu, i, node_, argument_ = np.broadcast_arrays(*given)
    if np.any(1.0 + e * np.cos(nu) <= 0.0):
        raise ValueError(
            f"anomaly: {nu.tolist()} is beyond the asymptote of an orbit with eccentricity {e.tolist()}"
        )
    zero = np.zeros_like(node_)
    across = np.stack([np.cos(node_), np.sin(node_), zero], axis=-1)
    up = np.stack([-np.sin(node_) * np.cos(i), np.cos(node_) * np.cos(i), np.sin(i)], axis=-1)
    c, s = np.cos(argument_)[..., None], np.sin(argument_)[..., None]
    p, q = c * across + s * up, c * up - s * across
    c, s, e = np.cos(nu)[..., None], np.sin(nu)[..., None], e[..., None]
    latus = least[..., None] * (1.0 + e)
    place = latus / (1.0 + e * c) * (c * p + s * q)
    speed = np.sqrt(mass[..., None] / latus) * ((e + c) * q - s * p)
    if since_periapsis is not None:
        place, speed = _core.kepler_states(mass, place, speed, number(since_periapsis, "since_periapsis"))
    return kepler(mass, place, speed, epoch)


def _do_broadcast(*arrays: Floats) -> bool:
    try:
        np.broadcast_shapes(*(one.shape for one in arrays))
    except ValueError:
        return False
    return True


def _vector(given: ArrayLike, name: str) -> Floats:
    found = np.array(_core.real_numbers(given, name))  # not the caller's
    if found.shape[-1:] != (3,):
        raise ValueError(f"{name}: expected shape (..., 3), got {found.shape}")
    if not np.isfinite(found).all():
        raise ValueError(f"{name}: must be finite, got {found.tolist()}")
    found.flags.writeable = False
    return found
