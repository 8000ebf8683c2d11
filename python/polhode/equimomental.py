"""Equimomental systems: bodies with the same mass, centre of mass and moments of inertia as a given one.

`polhode.RigidBody.equimomental_particles` gives the smallest set of equal particles for any body.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from polhode._core import RigidBody, real_numbers, stick
from polhode._format import short

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "EquivalentEllipsoid",
    "ellipsoid",
    "stick",
]


class EquivalentEllipsoid(NamedTuple):
    """A homogeneous ellipsoid with the moments of a body.

    Attributes
    ----------
    semi_axes : numpy.ndarray, shape (..., 3)
        Semi-axes along the principal axes of the body, in descending order; zero in a direction in which the
        body has no extent.
    axes : numpy.ndarray, shape (..., 3, 3)
        Principal axes of the body, as columns.
    volume : float or numpy.ndarray, shape (...)
    """

    semi_axes: Floats
    axes: Floats
    volume: Any

    def __repr__(self) -> str:
        return short(self)


def ellipsoid(body: RigidBody, volume: ArrayLike | None = None) -> EquivalentEllipsoid:
    """Find the homogeneous ellipsoid with the same mass and the same moments, ``a² = 5 (I2 + I3 - I1) / 2m``.

    Parameters
    ----------
    body : RigidBody
        One body or a stack.
    volume : float or array_like, optional
        Volume of the body. The ellipsoid then has this volume, and the same ratios of semi-axes as the one
        with the moments of the body. For an asteroid it is called the dynamically equivalent equal-volume
        ellipsoid. Its moments are those of the body only if the ellipsoid that is found without `volume` has
        this volume.

    Returns
    -------
    EquivalentEllipsoid

    Examples
    --------
    >>> from polhode import equimomental, solids
    >>> brick = solids.box((3.0, 2.0, 1.0), density=1.0)
    >>> equimomental.ellipsoid(brick).semi_axes
    array([1.93649167, 1.29099445, 0.64549722])
    >>> equimomental.ellipsoid(brick, volume=6.0).semi_axes
    array([1.86105147, 1.24070098, 0.62035049])
    """
    if not isinstance(body, RigidBody):
        raise TypeError(f"body: expected a RigidBody, got {type(body).__name__}")
    principal = body.principal
    least, middle, greatest = np.moveaxis(principal.moments, -1, 0)
    # A quarter of each, of which no sum is beyond the range of float64.
    least, middle, greatest = least / 4.0, middle / 4.0, greatest / 4.0
    # The two larger moments of a thin body differ by little: their difference first.
    spread = greatest - middle
    squares = np.stack([middle + greatest - least, least + spread, least - spread], axis=-1)
    mass = np.asarray(body.mass)[..., np.newaxis]
    semi_axes = np.sqrt(10.0) * (np.sqrt(np.maximum(squares, 0.0)) / np.sqrt(mass))
    with np.errstate(over="ignore", under="ignore"):  # zero or infinite beyond the range of float64
        own = 4.0 / 3.0 * np.pi * np.prod(semi_axes, axis=-1)
    if volume is None:
        return EquivalentEllipsoid(semi_axes, principal.axes, own[()])
    wanted = real_numbers(volume, "volume")
    if not (np.isfinite(wanted) & (wanted > 0.0)).all():
        raise ValueError(f"volume: must be positive and finite, got {np.asarray(volume)}")
    if wanted.shape not in ((), own.shape):
        raise ValueError(
            f"volume: expected one, or one for each body of shape {own.shape}, got {wanted.shape}"
        )
    wanted = np.broadcast_to(wanted, own.shape)
    if not (semi_axes > 0.0).all():
        raise ValueError("volume: a flat or straight body has no ellipsoid with a volume; leave it out")
    # Lengths over the mean one, whose volumes stay within the range of float64.
    ratios = semi_axes / np.cbrt(semi_axes).prod(axis=-1, keepdims=True)
    semi_axes = ratios * np.cbrt(wanted / (4.0 / 3.0 * np.pi))[..., np.newaxis]
    return EquivalentEllipsoid(semi_axes, principal.axes, wanted.copy()[()])
