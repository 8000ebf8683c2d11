"""What orbits tell: states, elements, the frame that points down, a dipole's field; orbits along samples."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from polhode import _core
from polhode._repr import short

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "DipoleField",
    "Elements",
    "LocalFrame",
    "OrbitState",
    "Path",
    "SampledOrbit",
    "do_broadcast",
    "kept",
    "reshaped",
    "vector",
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
        """Give the elements with the four angles in degrees."""
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


class Path(ABC):
    """What all orbits tell."""

    @property
    @abstractmethod
    def begins(self) -> float:
        """Its epoch, which is zero where there is none; of a table the first of its times."""

    @abstractmethod
    def at(self, t: ArrayLike) -> OrbitState:
        """Give position and velocity at times of any shape."""

    def frame(self, t: ArrayLike) -> LocalFrame:
        """Give the local frame of the orbit and its angular velocity at times of any shape.

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
        """Give the magnetic field, along the orbit, of a dipole at the attractor.

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

    Between the times it follows cubic splines.

    Attributes
    ----------
    mu : float or numpy.ndarray, shape (...)
        Gravitational parameter of the attractor.
    times : numpy.ndarray, shape (n,)
    position : numpy.ndarray, shape (..., n, 3)
        Positions from the attractor, in space, at the times.
    """

    mu: Any
    times: Floats
    position: Floats

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the stack, as a tuple of int; ``()`` for one."""
        return np.broadcast_shapes(np.shape(self.mu), self.position.shape[:-2])

    @property
    def begins(self) -> float:
        """First time of the table."""
        return float(self.times[0])

    def at(self, t: ArrayLike) -> OrbitState:
        """Give position and velocity at times of any shape.

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
        return reshaped(_core.sampled_states(self.times, self.position, times.ravel()), times.shape)


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
        """Give B at times of any shape, components in space: ``3 (M·r) r/r**5 - M/r**3``.

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


def kept(numbers: Floats) -> Any:
    """Numbers that nobody changes; one as a float."""
    numbers.flags.writeable = False
    return float(numbers) if numbers.ndim == 0 else numbers


def reshaped(states: tuple[Floats, Floats], times: tuple[int, ...]) -> OrbitState:
    """Give states at a list of times those at times of a shape."""
    return OrbitState(*(one.reshape(*one.shape[:-2], *times, 3) for one in states))


def do_broadcast(*arrays: Floats) -> bool:
    """Whether arrays broadcast."""
    try:
        np.broadcast_shapes(*(one.shape for one in arrays))
    except ValueError:
        return False
    return True


def vector(given: ArrayLike, name: str) -> Floats:
    """Vectors of shape (..., 3), finite, that nobody changes."""
    found = np.array(_core.real_numbers(given, name))  # not the caller's
    if found.shape[-1:] != (3,):
        raise ValueError(f"{name}: expected shape (..., 3), got {found.shape}")
    if not np.isfinite(found).all():
        raise ValueError(f"{name}: must be finite, got {found.tolist()}")
    found.flags.writeable = False
    return found
