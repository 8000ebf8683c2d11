"""Where the principal axes of an uncertain body may point."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode._scene.shape import check_one
from polhode._tangents import changes_in_principal_axes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import RigidBody

    Floats = NDArray[np.float64]

__all__ = ["angle_covariance", "axis_scatter"]


def angle_covariance(body: RigidBody) -> Floats | None:
    """Covariance of the small rotation φ of the principal axes, about themselves, in rad², shape (3, 3).

    Not numbers where an angle is not determined, as in ``body.sigma.axes``; None where nothing is uncertain.

    Parameters
    ----------
    body : RigidBody
        One body.

    Notes
    -----
    With W = Vᵀ δI V perturbation theory gives φ_k = W_ij / (I_j - I_i) for (i, j, k) in turn.
    """
    check_one(body.shape, "body")
    changes, sigma = changes_in_principal_axes(body), body.sigma
    if changes is None or sigma is None:
        return None
    moments, turned = body.principal.moments, changes[0]
    angles = np.full((3, len(turned)), np.nan)
    for k in np.flatnonzero(~np.isnan(sigma.axes)):
        i, j = (k + 1) % 3, (k + 2) % 3
        gap = moments[j] - moments[i]
        angles[k] = turned[:, i, j] / gap if gap != 0.0 else 0.0  # equal, and nothing about them uncertain
    return np.asarray(angles @ angles.T)


def axis_scatter(covariance: Floats, k: int) -> Floats:
    """Covariance of where axis k points, along axes k + 1 and k + 2, shape (2, 2).

    Parameters
    ----------
    covariance : numpy.ndarray, shape (3, 3)
        Of the small rotation φ: the axis moves by φ × e_k.
    k : int
    """
    i, j = (k + 1) % 3, (k + 2) % 3
    return np.array([[covariance[j, j], -covariance[i, j]], [-covariance[i, j], covariance[i, i]]])
