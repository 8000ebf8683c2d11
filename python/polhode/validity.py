"""Which tensors belong to bodies, and to bodies of a given size.

:class:`polhode.RigidBody` refuses what no body has. These functions say how far off it is, and whether a
body that is possible in itself could be as small as it is said to be.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode import _core
from polhode.results import BoxFit, NearestValid

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["BoxFit", "NearestValid", "fit_in_box", "nearest_valid"]


def nearest_valid(inertia: ArrayLike) -> NearestValid:
    """Find the tensor of a body that is nearest to a given one.

    The principal axes stay; the moments go to the nearest triple with none negative and no two less than the
    third. A tensor that :class:`polhode.RigidBody` accepts comes back as it is, at distance zero.

    Parameters
    ----------
    inertia : array_like, shape (..., 3, 3)
        Symmetric, about the centre of mass. A row that is not finite gives NaN.

    Returns
    -------
    NearestValid
        The tensor, and its distance from the one given in the Frobenius norm.

    Raises
    ------
    InvalidInertiaError
        When a tensor is not symmetric.

    Examples
    --------
    >>> import numpy as np
    >>> from polhode import validity
    >>> tensor, distance = validity.nearest_valid(np.diag([1.0, 1.0, 5.0]))
    >>> tensor.diagonal(), round(distance, 6)
    (array([2., 2., 4.]), 1.732051)
    """
    return NearestValid(*_core.nearest_valid(inertia))


def fit_in_box(body: _core.RigidBody, low: ArrayLike, high: ArrayLike) -> BoxFit:
    """Tell whether matter within a box could have a body's mass, centre of mass and tensor.

    Along one axis the spread of matter is limited by its distances from the walls,
    ``∫ (x − C_x)² dm ≤ m (C_x − low_x) (high_x − C_x)``; for two axes the products of those distances have
    means that are not negative, which limits the products of inertia. For every axis and every pair of axes
    the conditions decide exactly; what all three axes together forbid beyond that is not tested.

    Parameters
    ----------
    body : RigidBody
    low, high : array_like, shape (..., 3)
        Opposite corners of the box in the body frame.

    Returns
    -------
    BoxFit
        Whether it fits, the room that the tightest condition leaves, and the two axes it is about.

    Examples
    --------
    >>> from polhode import solids, validity
    >>> body = solids.box((1, 2, 3), mass=2.0)
    >>> validity.fit_in_box(body, (-0.5, -1, -1.5), (0.5, 1, 1.5)).possible
    True
    >>> validity.fit_in_box(body, (-0.5, -1, -0.5), (0.5, 1, 0.5)).axes
    ('z', 'z')
    """
    margin, axes = _core.within_box(body, low, high)
    names = np.array(["x", "y", "z"])[axes.astype(int)]
    possible = np.greater_equal(margin, 0)
    if names.ndim == 1:
        return BoxFit(bool(possible), margin, tuple(names.tolist()))
    return BoxFit(possible, margin, names)
