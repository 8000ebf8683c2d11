"""Orbits about an attractor: position and velocity over time, and the local frame that points down.

An :class:`Orbit` is made by :func:`kepler` from a state or by :func:`from_elements`; a :class:`SampledOrbit`
by :func:`sampled` from a table of positions, or of positions and velocities. The loads
:func:`polhode.loads.gravity_gradient` and :func:`polhode.loads.magnetic` act along them, and
:func:`polhode.loads.feedback` can point a body down along them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode import _core
from polhode._format import short
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
    from scipy.spatial.transform import Rotation

    Floats = NDArray[np.float64]

__all__ = [
    "DipoleField",
    "Elements",
    "LocalFrame",
    "Orbit",
    "OrbitState",
    "RelativeMotion",
    "SampledOrbit",
    "from_elements",
    "kepler",
    "sampled",
]


class OrbitState(NamedTuple):
    """Position and velocity of a body on its orbit relative to the attractor, components in space.

    Attributes
    ----------
    position, velocity : numpy.ndarray, shape (..., 3)
    """

    position: Floats
    velocity: Floats

    def __repr__(self) -> str:
        return short(self)


class Elements(NamedTuple):
    """The elements of an orbit at its epoch, with angles in radians; :meth:`in_degrees` gives degrees.

    Attributes
    ----------
    periapsis : float or numpy.ndarray, shape (...)
        Least distance from the attractor.
    eccentricity : float or numpy.ndarray, shape (...)
    inclination : float or numpy.ndarray, shape (...)
        Angle between the normal of the orbit and z.
    node : float or numpy.ndarray, shape (...)
        Angle from x to the ascending node, where the orbit crosses the plane xy upward; 0 for an orbit in
        that plane.
    argument : float or numpy.ndarray, shape (...)
        Angle from the node to the periapsis; 0 for a circle.
    anomaly : float or numpy.ndarray, shape (...)
        Angle from the periapsis to the body (the true anomaly); for a circle the angle from the node.
    """

    periapsis: Any
    eccentricity: Any
    inclination: Any
    node: Any
    argument: Any
    anomaly: Any

    def in_degrees(self) -> Elements:
        """Return the elements with the four angles in degrees."""
        angles = ("inclination", "node", "argument", "anomaly")
        return self._replace(**{name: np.rad2deg(getattr(self, name)) for name in angles})

    def __repr__(self) -> str:
        return short(self)


class LocalFrame(NamedTuple):
    """The local frame of an orbit: z points to the attractor, y against the normal of the orbit, x forward.

    Attributes
    ----------
    quaternion : numpy.ndarray, shape (..., 4)
        Attitude of the frame in space as (x, y, z, w), of either sign: the attitude of a body whose axes are
        those of the frame.
    omega : numpy.ndarray, shape (..., 3)
        Angular velocity of the frame relative to space, components in this frame: ``(0, -h/r**2, -r a/h)``.
        Here h is the angular momentum of the orbit per mass, and a the acceleration along its normal, which
        turns the plane of the orbit. On a Kepler orbit a is zero.
    """

    quaternion: Floats
    omega: Floats

    def __repr__(self) -> str:
        return short(self)


@dataclass(frozen=True, eq=False)
class RelativeMotion:
    """Attitude and rates of a body relative to the local frame of an orbit, see :class:`LocalFrame`.

    :meth:`polhode.Trajectory.relative_to` makes it.

    Attributes
    ----------
    t : numpy.ndarray, shape (T,)
        Times of the motion.
    quaternion : numpy.ndarray, shape (..., T, 4)
        Attitude R_LB of the body in the local frame L as (x, y, z, w), continuous in time.
    omega : numpy.ndarray, shape (..., T, 3)
        Angular velocity of the body relative to L, components in the body frame.
    """

    t: Floats
    quaternion: Floats
    omega: Floats

    @property
    def roll(self) -> Floats:
        """Angle of roll, about the body's x, in radians; see :meth:`angles`."""
        return np.asarray(self.angles()[..., 2])

    @property
    def pitch(self) -> Floats:
        """Angle of pitch, in radians; see :meth:`angles`."""
        return np.asarray(self.angles()[..., 1])

    @property
    def yaw(self) -> Floats:
        """Angle of yaw, about the local z, in radians; see :meth:`angles`."""
        return np.asarray(self.angles()[..., 0])

    @property
    def rotation(self) -> Rotation:
        """Attitude in the local frame as a SciPy ``Rotation``."""
        from polhode._optional import require

        transform = require("scipy.spatial.transform", extra=None, purpose="RelativeMotion.rotation")
        rotation: Rotation = transform.Rotation.from_quat(self.quaternion)
        return rotation

    def angles(self, *, degrees: bool = False) -> Floats:
        """Compute yaw, pitch and roll: R_LB = R_z(yaw) R_y(pitch) R_x(roll).

        Parameters
        ----------
        degrees : bool
            Give degrees.

        Returns
        -------
        numpy.ndarray, shape (..., T, 3)
            Yaw and roll from -pi to pi, pitch from -pi/2 to pi/2, in radians unless `degrees`. Yaw and roll
            are NaN where the pitch is a right angle, since only their sum or difference is defined there.
        """
        angles = _core.euler_angles_from_quaternion(self.quaternion, "ZYX", "nan")
        return np.rad2deg(angles) if degrees else angles

    def __repr__(self) -> str:
        return f"RelativeMotion({self.quaternion.shape[:-1]} attitudes in the local frame of an orbit)"


class Path(ABC):
    """Base class of all orbits."""

    @property
    @abstractmethod
    def begins(self) -> float:
        """Epoch of the orbit; zero if there is none. For a table, the first of its times."""

    @abstractmethod
    def at(self, t: ArrayLike) -> OrbitState:
        """Return position and velocity at times of any shape."""

    def frame(self, t: ArrayLike) -> LocalFrame:
        """Return the local frame of the orbit and its angular velocity at times of any shape.

        Parameters
        ----------
        t : array_like, shape (T...)
            Times as in :meth:`at`.

        Returns
        -------
        LocalFrame
        """
        times = _core.real_numbers(t, "t")
        found = _core.local_frames(self, times.ravel())
        return LocalFrame(*(one.reshape(*one.shape[:-2], *times.shape, one.shape[-1]) for one in found))

    def dipole_field(self, strength: ArrayLike) -> DipoleField:
        """Return the magnetic field, along the orbit, of a dipole at the attractor.

        Parameters
        ----------
        strength : array_like, shape (..., 3)
            The dipole's moment times μ₀/4π, in space; for the Earth's about 7.8e15 T m³, southward.

        Returns
        -------
        DipoleField
            For :func:`polhode.loads.magnetic`; its ``at(t)`` gives B.
        """
        return DipoleField(self, vector(strength, "strength"))


@dataclass(frozen=True, eq=False)
class SampledOrbit(Path):
    """An orbit through positions at given times, as from an ephemeris, or a stack of them.

    Between the times it follows cubic splines, or with velocities quintics.

    Attributes
    ----------
    mu : float or numpy.ndarray, shape (...)
        Gravitational parameter of the attractor.
    times : numpy.ndarray, shape (n,)
    position : numpy.ndarray, shape (..., n, 3)
        Positions from the attractor, in space, at the times.
    velocity : numpy.ndarray, shape (..., n, 3), or None
        Velocities relative to the attractor, in space, at the times.
    j2, radius : float, numpy.ndarray of shape (...) or None
        J₂ of the attractor and the radius that it refers to; None for a sphere.
    pole : numpy.ndarray, shape (..., 3), or None
        Axis of the attractor, in space.
    """

    mu: Any
    times: Floats
    position: Floats
    velocity: Floats | None = None
    j2: Any = None
    radius: Any = None
    pole: Floats | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the stack, as a tuple of int; ``()`` for one."""
        shapes = [np.shape(self.mu), self.position.shape[:-2]]
        if self.pole is not None:
            shapes += [np.shape(self.j2), np.shape(self.radius), self.pole.shape[:-1]]
        return np.broadcast_shapes(*shapes)

    @property
    def begins(self) -> float:
        """First time of the table."""
        return float(self.times[0])

    def at(self, t: ArrayLike) -> OrbitState:
        """Return position and velocity at times of any shape.

        Parameters
        ----------
        t : array_like, shape (T...)
            Times from the first of the table to the last.

        Returns
        -------
        OrbitState
            Arrays of shape (..., T..., 3): axes of the stack, axes of the times, components.
        """
        times = _core.real_numbers(t, "t")
        found = _core.sampled_states(self.times, self.position, times.ravel(), self.velocity)
        return reshape_times(found, times.shape)


@dataclass(frozen=True, eq=False)
class DipoleField:
    """The magnetic field of a dipole at the attractor, along an orbit.

    Attributes
    ----------
    orbit : Orbit or SampledOrbit
    strength : numpy.ndarray, shape (..., 3)
        The dipole's moment times μ₀/4π, in space.
    """

    orbit: Path
    strength: Floats

    def at(self, t: ArrayLike) -> Floats:
        """Return B at times of any shape, components in space: ``3 (M·r) r/r**5 - M/r**3``.

        Parameters
        ----------
        t : array_like, shape (T...)
            Times as in :meth:`Orbit.at`.

        Returns
        -------
        numpy.ndarray, shape (..., T..., 3)
        """
        moment = self.strength[(..., *(np.newaxis,) * np.ndim(t), slice(None))]
        return _core.dipole_field(moment, self.orbit.at(t).position)


def freeze(numbers: Floats) -> Any:
    """Return a read-only array; a single number as a float."""
    numbers.flags.writeable = False
    return float(numbers) if numbers.ndim == 0 else numbers


def reshape_times(states: tuple[Floats, Floats], times: tuple[int, ...]) -> OrbitState:
    """Reshape states at a list of times to the shape of the times."""
    return OrbitState(*(one.reshape(*one.shape[:-2], *times, 3) for one in states))


def do_broadcast(*arrays: Floats) -> bool:
    """Return whether arrays broadcast."""
    try:
        np.broadcast_shapes(*(one.shape for one in arrays))
    except ValueError:
        return False
    return True


def vector(given: ArrayLike, name: str) -> Floats:
    """Return finite vectors of shape (..., 3), read-only."""
    found = np.array(_core.real_numbers(given, name))  # not the caller's
    if found.shape[-1:] != (3,):
        raise ValueError(f"{name}: expected shape (..., 3), got {found.shape}")
    if not np.isfinite(found).all():
        raise ValueError(f"{name}: must be finite, got {found.tolist()}")
    found.flags.writeable = False
    return found


@dataclass(frozen=True, eq=False)
class Orbit(Path):
    """An orbit through a given state, or a stack of them: ellipse, parabola or hyperbola.

    The attractor is a sphere, or an oblate body.

    Attributes
    ----------
    mu : float or numpy.ndarray, shape (...)
        Gravitational parameter of the attractor.
    position, velocity : numpy.ndarray, shape (..., 3)
        Position and velocity from the attractor, in space, at the epoch.
    epoch : float or None
        Time at which the orbit has that state; None: the start of a motion.
    j2, radius : float, numpy.ndarray of shape (...) or None
        J₂ of the attractor and the radius that it refers to; None for a sphere.
    pole : numpy.ndarray, shape (..., 3), or None
        Axis of the attractor, in space.
    """

    mu: Any
    position: Floats
    velocity: Floats
    epoch: float | None = None
    j2: Any = None
    radius: Any = None
    pole: Floats | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the stack, as a tuple of int; ``()`` for one."""
        shapes = [np.shape(self.mu), self.position.shape[:-1], self.velocity.shape[:-1]]
        if self.pole is not None:
            shapes += [np.shape(self.j2), np.shape(self.radius), self.pole.shape[:-1]]
        return np.broadcast_shapes(*shapes)

    @property
    def begins(self) -> float:
        """Epoch of the orbit, or zero."""
        return 0.0 if self.epoch is None else self.epoch

    @property
    def period(self) -> Any:
        """Time of a revolution; infinite for parabola and hyperbola.

        Rounding may turn a parabola into a very long ellipse.

        For an oblate attractor, that of the osculating Kepler orbit at the epoch.
        """
        return _core.kepler_period(self.mu, self.position, self.velocity)[()]

    @property
    def elements(self) -> Elements:
        """Elements of the orbit at its epoch.

        For an oblate attractor, those of the osculating Kepler orbit: it has the same position and velocity
        at the epoch.
        """
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
        """Return position and velocity at times of any shape.

        Parameters
        ----------
        t : array_like, shape (T...)
            Times. The orbit has its given state at t equal to the epoch; without an epoch, at t = 0.

        Returns
        -------
        OrbitState
            Arrays of shape (..., T..., 3): axes of the stack, axes of the times, components. NaN after an
            orbit about an oblate attractor has reached its centre.

        Raises
        ------
        PolhodeError
            Beyond the reach of the orbit. On an ellipse the phase is known to 2**-90 of the revolutions made;
            nothing is left of it after 2**88 revolutions, and near a parabola after fewer. About an oblate
            attractor an orbit reaches 30 000 revolutions.
        """
        times = _core.real_numbers(t, "t")
        if self.pole is not None:
            found = _core.oblate_states(
                self.mu,
                self.position,
                self.velocity,
                self.j2,
                self.radius,
                self.pole,
                times.ravel() - self.begins,
            )
            return reshape_times(found, times.shape)
        new = (np.newaxis,) * times.ndim
        return OrbitState(
            *_core.kepler_states(
                np.asarray(self.mu)[(..., *new)],
                self.position[(..., *new, slice(None))],
                self.velocity[(..., *new, slice(None))],
                times - self.begins,
            )
        )


def kepler(
    mu: ArrayLike,
    position: ArrayLike,
    velocity: ArrayLike,
    epoch: float | None = None,
    *,
    j2: ArrayLike | None = None,
    radius: ArrayLike | None = None,
    pole: ArrayLike = (0, 0, 1),
) -> Orbit:
    """Make the orbit through a given state: a Kepler orbit, or with `j2` one about an oblate body.

    Parameters
    ----------
    mu : array_like, shape (...)
        Gravitational parameter of the attractor.
    position, velocity : array_like, shape (..., 3)
        Position and velocity from the attractor, in space, at the epoch.
    epoch : float, optional
        Time at which the orbit has that state; the start of a motion by default.
    j2, radius : array_like, shape (...), optional
        J₂ of the attractor, and the radius that it refers to: of the Earth 1.08263e-3 and 6378137 m. The
        orbit is then integrated by Taylor series to rounding, and :func:`polhode.loads.gravity_gradient`
        includes the torque of J₂.
    pole : array_like, shape (..., 3), optional
        The axis of an oblate attractor, in space, of any length.

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
    >>> orbit.at(np.pi / 2).position.round(12) + 0.0
    array([0., 1., 0.])
    >>> orbit.frame(0.0).omega
    array([ 0., -1.,  0.])
    """
    mass = np.array(_core.real_numbers(mu, "mu"))
    place, speed = vector(position, "position"), vector(velocity, "velocity")
    when = None if epoch is None else float(_core.real_numbers(epoch, "epoch"))
    if when is not None and not np.isfinite(when):
        raise ValueError(f"epoch: must be finite, got {when}")
    _core.kepler_states(mass, place, speed, np.zeros(()))  # checks them
    if j2 is None and radius is None:
        return Orbit(freeze(mass), place, speed, when)
    if j2 is None or radius is None:
        raise TypeError("j2 and radius: give both of an oblate attractor, or none")
    bulge = np.array(_core.real_numbers(j2, "j2")), np.array(_core.real_numbers(radius, "radius"))
    axis = vector(pole, "pole")
    _core.oblate_states(mass, place, speed, *bulge, axis, np.zeros(1))  # checks them
    return Orbit(freeze(mass), place, speed, when, freeze(bulge[0]), freeze(bulge[1]), axis)


def sampled(
    mu: ArrayLike,
    t: ArrayLike,
    position: ArrayLike,
    velocity: ArrayLike | None = None,
    *,
    j2: ArrayLike | None = None,
    radius: ArrayLike | None = None,
    pole: ArrayLike = (0, 0, 1),
) -> SampledOrbit:
    """Make an orbit from positions at given times, and velocities if they are known, as from an ephemeris.

    Parameters
    ----------
    mu : array_like, shape (...)
        Gravitational parameter of the attractor. It serves for the torque; the path is that of the samples.
    t : array_like, shape (n,)
        Ascending.
    position : array_like, shape (..., n, 3)
        Positions from the attractor, in space.
    velocity : array_like, shape (..., n, 3), optional
        Velocities relative to the attractor, in space, in units of `position` per unit of `t`.
    j2, radius : array_like, shape (...), optional
        J₂ of the attractor, and the radius that it refers to: :func:`polhode.loads.gravity_gradient` then
        includes the torque of J₂. They do not change the path.
    pole : array_like, shape (..., 3), optional
        The axis of an oblate attractor, in space, of any length.

    Returns
    -------
    SampledOrbit
        From positions alone: a cubic spline through them ("not a knot"). Its error falls with the fourth
        power of the distance between the times. With velocities: a quintic between each two samples, which
        has the position and velocity of both exactly. Its error falls with the sixth power.

    Raises
    ------
    PolhodeError
        When `mu` is not positive, times do not ascend, or velocities contradict the positions: between two
        samples, the difference of the positions and the mean velocity times the difference of the times
        differ by more than half. So it is if the units are not the same, or the axes of one turn.

    Notes
    -----
    A quintic also needs the acceleration at each sample. It is found from the samples: it is that of the one
    quintic through the positions and velocities of this sample and of its two neighbours. Its error falls
    with the fourth power of the distance between the times. The acceleration -mu r/r³ of the attractor is
    not used. It would be wrong wherever something else acts: J₂, a third body, or the attractor's own
    acceleration, as for positions relative to the Moon. From two samples the path is a cubic.

    Examples
    --------
    >>> import numpy as np
    >>> from polhode import orbits
    >>> t = np.linspace(0, 2 * np.pi, 40)
    >>> place = np.stack([np.cos(t), np.sin(t), 0 * t], axis=-1)
    >>> speed = np.stack([-np.sin(t), np.cos(t), 0 * t], axis=-1)
    >>> for circle in (orbits.sampled(1.0, t, place), orbits.sampled(1.0, t, place, speed)):
    ...     print(circle.at(1.0).velocity.round(6))
    [-0.841488  0.540273  0.      ]
    [-0.841471  0.540302  0.      ]
    """
    mass = np.array(_core.real_numbers(mu, "mu"))
    if not (np.isfinite(mass).all() and np.min(mass, initial=1.0) > 0.0):
        raise PolhodeError(f"mu: must be positive, got {mass.tolist()}")
    times, places = np.array(_core.real_numbers(t, "t")), vector(position, "position")
    speeds = None if velocity is None else vector(velocity, "velocity")
    _core.sampled_states(times, places, times[:1], speeds)  # checks them
    if not do_broadcast(mass, places[..., 0, 0]):
        raise ValueError(f"mu and position: shapes {mass.shape} and {places.shape} do not broadcast")
    if speeds is not None:
        _check_velocities(times, places, speeds)
    times.flags.writeable = False
    if j2 is None and radius is None:
        return SampledOrbit(freeze(mass), times, places, speeds)
    if j2 is None or radius is None:
        raise TypeError("j2 and radius: give both of an oblate attractor, or none")
    bulge = np.array(_core.real_numbers(j2, "j2")), np.array(_core.real_numbers(radius, "radius"))
    axis = vector(pole, "pole")
    if not do_broadcast(mass, places[..., 0, 0], *bulge, axis[..., 0]):
        shapes = [one.shape for one in (mass, places, *bulge, axis)]
        raise ValueError(f"mu, position, j2, radius and pole: shapes {shapes} do not broadcast")
    found = SampledOrbit(freeze(mass), times, places, speeds, freeze(bulge[0]), freeze(bulge[1]), axis)
    _core.local_frames(found, times[:1])  # checks them
    return found


APART: Final = 0.5
"""Largest part by which distances of positions and of velocities may differ between two samples. On a circle
it is reached with 2.3 samples in a revolution, where no curve through the samples is near to the circle."""


def _check_velocities(times: Floats, places: Floats, speeds: Floats) -> None:
    """Refuse velocities that contradict the positions, which is mostly a question of units."""
    with np.errstate(all="ignore"):
        spans = np.diff(times)[:, np.newaxis]
        moved, flown = np.diff(places, axis=-2), 0.5 * (speeds[..., 1:, :] + speeds[..., :-1, :]) * spans
        paces = np.linalg.norm(speeds, axis=-1)
        lengths = np.linalg.norm(moved, axis=-1), 0.5 * (paces[..., 1:] + paces[..., :-1]) * spans[:, 0]
        rounding = 8 * np.finfo(float).eps * np.abs(places).max(initial=0.0)
        off = np.linalg.norm(moved - flown, axis=-1) - APART * np.maximum(*lengths) - rounding
        off = np.where(np.isfinite(off), off, -np.inf)  # of numbers whose squares leave the range
    worst = np.unravel_index(np.argmax(off), off.shape) if off.size else None
    if worst is None or not off[worst] > 0.0:
        return
    row = int(worst[-1])
    stack = f" of orbit {tuple(int(k) for k in worst[:-1])}" if len(worst) > 1 else ""
    raise PolhodeError(
        f"velocity: from row {row} to row {row + 1}{stack} the position moves by {moved[worst].tolist()}, "
        f"but by {flown[worst].tolist()} at the mean of both velocities; the two must agree within half of "
        "the larger. Give velocities in units of position per unit of t, relative to the attractor, in axes "
        "that do not turn, at times that are near enough; or leave velocity out"
    )


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
    j2: ArrayLike | None = None,
    radius: ArrayLike | None = None,
    pole: ArrayLike = (0, 0, 1),
    degrees: bool = False,
) -> Orbit:
    """Make the orbit with given elements.

    Parameters
    ----------
    mu : array_like, shape (...)
        Gravitational parameter of the attractor.
    eccentricity : array_like, shape (...)
    periapsis, semi_major_axis : array_like, shape (...)
        Give exactly one: the least distance, or half of the major axis, negative for a hyperbola.
    inclination, node, argument : array_like, shape (...), optional
        As in :class:`Elements`, in radians unless `degrees`.
    anomaly, since_periapsis : array_like, shape (...), optional
        Position of the body at the epoch: its true anomaly, or the time since it passed the periapsis. By
        default it is at the periapsis.
    epoch : float, optional
        Time of this position; the start of a motion by default.
    j2, radius, pole : array_like, optional
        As for :func:`kepler`; the elements are then those of the osculating Kepler orbit at the epoch.
    degrees : bool, optional
        Inclination, node, argument and anomaly are in degrees.

    Returns
    -------
    Orbit

    Examples
    --------
    >>> from polhode import orbits
    >>> comet = orbits.from_elements(1.0, eccentricity=1.0, periapsis=0.5)
    >>> comet.velocity + 0.0
    array([0., 2., 0.])
    """
    if (periapsis is None) == (semi_major_axis is None):
        raise ValueError("give exactly one of periapsis= and semi_major_axis=")
    if anomaly is not None and since_periapsis is not None:
        raise ValueError("anomaly: not beside since_periapsis=; give one of the two")

    def number(given: Any, name: str) -> Floats:
        found = _core.real_numbers(given, name)
        if not np.isfinite(found).all():
            raise PolhodeError(f"{name}: must be finite, got {found.tolist()}")
        return found

    mass, e = number(mu, "mu"), number(eccentricity, "eccentricity")
    if np.min(e, initial=0.0) < 0.0:
        raise PolhodeError(f"eccentricity: must not be negative, got {e.tolist()}")
    if np.min(mass, initial=1.0) <= 0.0:
        raise PolhodeError(f"mu: must be positive, got {mass.tolist()}")
    if periapsis is not None:
        least = number(periapsis, "periapsis")
    else:
        axis = number(semi_major_axis, "semi_major_axis")
        if not do_broadcast(axis, e):
            raise ValueError(
                f"semi_major_axis and eccentricity: shapes {axis.shape} and {e.shape} do not broadcast"
            )
        least = axis * (1.0 - e)
    if np.min(least, initial=1.0) <= 0.0:
        raise PolhodeError(
            f"periapsis: must be positive, got {least.tolist()}; a hyperbola has a negative semi_major_axis, "
            "a parabola none"
        )
    turn = np.deg2rad if degrees else np.asarray
    angles = [
        turn(number(one, name))
        for one, name in ((inclination, "inclination"), (node, "node"), (argument, "argument"))
    ]
    nu = np.zeros(()) if anomaly is None else turn(number(anomaly, "anomaly"))
    given = (mass, e, least, nu, *angles)
    if not do_broadcast(*given):
        raise ValueError(
            "mu, eccentricity, periapsis, anomaly, inclination, node and argument: shapes "
            f"{[one.shape for one in given]} do not broadcast"
        )
    mass, e, least, nu, i, node_, argument_ = np.broadcast_arrays(*given)
    if np.any(1.0 + e * np.cos(nu) <= 0.0):
        raise PolhodeError(
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
    return kepler(mass, place, speed, epoch, j2=j2, radius=radius, pole=pole)


if not TYPE_CHECKING:

    def __getattr__(name):
        """Refuse a name of others with the one here."""
        from polhode._hints import no_name

        raise no_name(__name__, name, __all__)
