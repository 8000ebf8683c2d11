"""Mass properties as a CAD program prints them: mass, centre, tensor, and the sign of the products."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from polhode._core import RigidBody, real_numbers
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode import _core

__all__ = ["from_printout"]

_PRODUCTS: Final = ("positive", "negative")
_ABOUT: Final = ("center_of_mass", "origin")
_NAMES: Final = ("Ixy", "Ixz", "Iyz")


def from_printout(
    mass: float | _core.Uncertain,
    center_of_mass: ArrayLike,
    inertia: ArrayLike,
    *,
    products: str | None = None,
    about: str = "center_of_mass",
    rtol: float | None = None,
    name: str = "inertia",
) -> RigidBody:
    """Make a body from the printout of a CAD program.

    Parameters
    ----------
    mass : float or Uncertain
    center_of_mass : array_like, shape (3,)
    inertia : array_like
        Three moments, six numbers Ixx Iyy Izz Ixy Ixz Iyz, or nine, row by row.
    products : {"positive", "negative"}, optional
        ``"positive"``: the off-diagonal numbers are ∫ x y dm. ``"negative"``: they are minus that, the
        elements of the tensor. It must be given if one of them is not zero.
    about : {"center_of_mass", "origin"}
        Point to which the tensor refers.
    rtol : float, optional
        See `RigidBody`.
    name : str
        Name of the tensor in error messages.

    Returns
    -------
    RigidBody

    Examples
    --------
    A printout of SolidWorks, in pounds and feet, that says "(Using positive tensor notation.)":

    >>> from polhode import interop
    >>> wing = interop.from_printout(
    ...     1.51653435,
    ...     (-0.45582142, 0.92780847, 0),
    ...     [0.50358715, 0.17140362, 0.66303218, -0.05932693, 0, 0],
    ...     products="positive",
    ... )
    >>> wing.principal_moments.round(6)
    array([0.161126, 0.513865, 0.663032])
    """
    if products is not None and products not in _PRODUCTS:
        raise PolhodeError(f"products: expected {' or '.join(_PRODUCTS)}, got {products!r}")
    if about not in (*_ABOUT, "com"):
        raise PolhodeError(f"about: expected {' or '.join(_ABOUT)}, got {about!r}")
    matrix = _matrix(inertia, name)
    off = ~np.eye(3, dtype=np.bool_)
    if products is None and matrix[off].any():
        k = int(np.flatnonzero(matrix[(0, 0, 1), (1, 2, 2)])[0])
        value = matrix[(0, 0, 1), (1, 2, 2)][k]
        x, y = _NAMES[k][1], _NAMES[k][2]
        raise PolhodeError(
            f"{name}: nothing says which sign {_NAMES[k]} = {value:g} has; state products as positive "
            f"for the integral of {x} {y} dm, or as negative for minus that, the element of the tensor"
        )
    if products == "positive":
        matrix[off] = 0.0 - matrix[off]
    if about == "origin":
        return RigidBody(mass, center_of_mass=center_of_mass, inertia_about_origin=matrix, rtol=rtol)
    return RigidBody(mass, matrix, center_of_mass, rtol=rtol)


def _matrix(numbers: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return the matrix of three, six or nine numbers, signs as they are."""
    given = real_numbers(numbers, name).ravel()
    if len(given) == 3:
        return np.diag(given)
    if len(given) == 6:
        xx, yy, zz, xy, xz, yz = given
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if len(given) != 9:
        raise PolhodeError(
            f"{name}: expected 3, 6 or 9 numbers, got {len(given)}: the moments, Ixx Iyy Izz Ixy Ixz Iyz, or "
            "the rows of the tensor"
        )
    return given.reshape(3, 3).copy()
