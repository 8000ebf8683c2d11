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
    """Where a body is on its orbit, from the attractor, in space.

    Attributes
    ----------
    position, velocity : numpy.ndarray, shape (..., 3)
    """

    position: Floats
    velocity: Floats

    def __repr__(self) -> str:
        return short(self)


class Elements(NamedTuple):
    """The elements of an orbit at its epoch; angles in radians, and in degrees by :meth:`in_degrees`.

    Attributes
    ----------
    periapsis : float or numpy.ndarray, shape (...)
        Least distance from the attractor.
    eccentricity : float or numpy.ndarray, shape (...)
    inclination : float or numpy.ndarray, shape (...)
        Between the normal of the orbit and z.
    node : float or numpy.ndarray, shape (...)
        Angle from x to where the orbit crosses the plane xy upward; 0 for an orbit in that plane.
    argument : float or numpy.ndarray, shape (...)
        Angle from the node to the periapsis; 0 for a circle.
    anomaly : float or numpy.ndarray, shape (...)
        Angle from the periapsis to the body (the true anomaly); of a circle from the node.
    """

    periapsis: Any
    eccentricity: Any
    inclination: Any
    node: Any
    argument: Any
    anomaly: Any

    def in_degrees(self) -> Elements:
        """Give them with the four angles in degrees."""
        angles = ("inclination", "node", "argument", "anomaly")
        return self._replace(**{name: np.rad2deg(getattr(self, name)) for name in angles})

    def __repr__(self) -> str:
        return short(self)


class LocalFrame(NamedTuple):
    """The frame that points down: z to the attractor, y along minus the normal of the orbit, x forward.

    Attributes
    ----------
    quaternion : numpy.ndarray, shape (..., 4)
        Its attitude in space as (x, y, z, w), of either sign: that of a body whose axes these are.
    omega : numpy.ndarray, shape (..., 3)
        Its angular velocity relative to space, components in this frame: ``(0, -h/r**2, -r a/h)`` with the
        angular momentum h of the orbit and the acceleration a along its normal, which turns the plane; on a
        Kepler orbit there is none.
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
        """Give the frame that points down, and its angular velocity, at times of any shape.

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
        return DipoleField(self, vector(strength, "strength"))


@dataclass(frozen=True, eq=False)
class SampledOrbit(Path):
    """An orbit known at some times, or a stack of them: cubic splines through positions, as of an ephemeris.

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
        """The shape of the stack."""
        return np.broadcast_shapes(np.shape(self.mu), self.position.shape[:-2])

    @property
    def begins(self) -> float:
        """The first of its times."""
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
            Of shape (..., T..., 3): those of the stack, then those of the times.
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
        """Give B in space, ``3 (M·r) r/r**5 - M/r**3``, at times of any shape.

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
