"""Tests whether any body can have a tensor, and whether a body of a given size can.

:class:`polhode.RigidBody` refuses a tensor that no body can have. The functions here compute how far a tensor
is from a possible one, and whether a body with given mass properties can be as small as a given box.
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
    """Find the possible tensor that is nearest to a given one.

    The principal axes stay. The moments are replaced by the nearest three that are not negative and obey the
    triangle inequality. On the edge, where I1 + I2 = I3, the rounding of the elements decides whether the
    moments that a program computes from them obey it. Therefore the same small part of the trace, 1.8e-15,
    is added to all three moments there: MuJoCo and other programs then accept the tensor. A tensor that is
    possible and not on the edge is returned unchanged, at distance zero; so is a diagonal one on the edge,
    whose moments are exact.

    Parameters
    ----------
    inertia : array_like, shape (..., 3, 3)
        Symmetric, about the centre of mass. A row that is not finite gives NaN.

    Returns
    -------
    NearestValid
        The tensor, and its distance from the given one in the Frobenius norm.

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
    """Return whether matter inside a box can have the mass, centre of mass and tensor of a body.

    The walls limit the spread of matter along each axis: ``∫ (x − C_x)² dm ≤ m (C_x − low_x) (high_x −
    C_x)``. For two axes, the means of the products of the distances from the walls cannot be negative, which
    limits the products of inertia. The conditions are exact for each axis and for each pair of axes.
    Conditions that involve all three axes are not tested.

    Parameters
    ----------
    body : RigidBody
    low, high : array_like, shape (..., 3)
        Opposite corners of the box in the body frame.

    Returns
    -------
    BoxFit
        Whether the body fits, the margin of the tightest condition, and the two axes of that condition.

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
