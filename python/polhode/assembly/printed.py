"""Mass properties as a CAD program prints them: a mass, a centre, a tensor, and what its products mean."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._core import RigidBody
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from polhode import _core

__all__ = ["ABOUT", "PRODUCTS", "printed_body", "tensor_of"]

PRODUCTS: Final = ("positive", "negative")
ABOUT: Final = ("center_of_mass", "origin")
_NAMES: Final = ("Ixy", "Ixz", "Iyz")


def printed_body(
    mass: float | _core.Uncertain,
    com: Sequence[float],
    tensor: Sequence[float],
    *,
    products: str | None = None,
    about: str = "center_of_mass",
    rtol: float | None = None,
    name: str = "tensor",
) -> RigidBody:
    """Make the body of a printout.

    Parameters
    ----------
    mass : float or Uncertain
    com : sequence of float
        Centre of mass, three numbers.
    tensor : sequence of float
        Three moments, six numbers Ixx Iyy Izz Ixy Ixz Iyz, or nine, row by row.
    products : {"positive", "negative"}, optional
        Whether the off-diagonal numbers are ∫ x y dm or minus that, the elements of the tensor. It has to be
        said where one is not zero.
    about : {"center_of_mass", "origin"}
        The point of the tensor.
    rtol : float, optional
        See `RigidBody`.
    name : str
        Of the tensor, in errors.
    """
    if products is not None and products not in PRODUCTS:
        raise PolhodeError(f"products: {products!r} is neither {' nor '.join(PRODUCTS)}")
    if about not in ABOUT:
        raise PolhodeError(f"about: {about!r} is neither {' nor '.join(ABOUT)}")
    matrix = tensor_of(tensor, name)
    off = ~np.eye(3, dtype=np.bool_)
    if products is None and matrix[off].any():
        k = int(np.flatnonzero(matrix[(0, 0, 1), (1, 2, 2)])[0])
        value = matrix[(0, 0, 1), (1, 2, 2)][k]
        x, y = _NAMES[k][1], _NAMES[k][2]
        raise PolhodeError(
            f"{name}: nothing says which sign {_NAMES[k]} = {value:g} has; products is positive for the "
            f"integral of {x} {y} dm, negative for minus that, the element of the tensor"
        )
    if products == "positive":
        matrix[off] = 0.0 - matrix[off]
    if about == "origin":
        return RigidBody(mass, center_of_mass=com, inertia_about_origin=matrix, rtol=rtol)
    return RigidBody(mass, matrix, com, rtol=rtol)


def tensor_of(numbers: Sequence[float], name: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Give the matrix of three, six or nine numbers, signs as they are."""
    given = np.array(numbers, dtype=np.float64).ravel()
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
    return given.reshape(3, 3)
