"""Least squares among the possible bodies: a convex problem, solved by a barrier method with a certificate.

A body is possible where a matrix that is linear in its parameters is positive semidefinite: the
pseudo-inertia of Wensing, Kim and Slotine (IEEE Robot. Autom. Lett. 3, 2018, 60), or the second moment about
a known centre of mass. Boyd and Vandenberghe, Convex Optimization (2004), chapter 11.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from polhode.errors import IdentificationError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["along_the_edge", "fit_possible", "pseudo_inertia_maps", "second_moment_maps"]

_FACTOR: Final = 30.0
"""Factor between the weights of two points of the central path."""
_ENOUGH: Final = 1e-12
"""Gap relative to the sum of squares at which the path ends."""
_AGAIN: Final = 6
"""Further steps of Newton's method at one weight."""
_STEPS: Final = 2000
_CERTIFIED: Final = 1e-6
"""Gap relative to the sum of squares beyond which a fit has failed."""
_ROUNDING: Final = 1e-12
"""The same relative to the squares of the data, whose rounding errors an exact fit has left."""


def second_moment_maps(basis: Floats) -> Floats:
    """Return matrices S_k with Σ z_k S_k = ½ tr(I) 1 − I, for tensors I = Σ z_k I_k, shapes (p, 3, 3)."""
    return np.asarray(0.5 * np.trace(basis, axis1=1, axis2=2)[:, None, None] * np.eye(3) - basis)


def pseudo_inertia_maps(tensors: Floats) -> Floats:
    """Return matrices of shape (10, 4, 4) for the parameters m, mc and six elements of the tensor about O."""
    maps = np.zeros((10, 4, 4))
    maps[0, 3, 3] = 1.0
    for k in range(3):
        maps[1 + k, k, 3] = maps[1 + k, 3, k] = 1.0
    maps[4:, :3, :3] = second_moment_maps(tensors)
    return maps


def fit_possible(
    triangle: Floats, target: Floats, maps: Floats, start: Floats, rest: float = 0.0
) -> tuple[Floats, float, bool]:
    """Minimise ``|R x − c|²`` where ``Σ x_k M_k`` is positive semidefinite.

    Parameters
    ----------
    triangle, target : numpy.ndarray, shapes (p, p) and (p,)
        R of full rank and c.
    maps : numpy.ndarray, shape (p, k, k)
    start : numpy.ndarray, shape (p,)
        Any point where the matrix is positive definite. Its size sets the scale.
    rest : float
        Further part of the sum of squares that no x changes.

    Returns
    -------
    x : numpy.ndarray, shape (p,)
    gap : float
        No possible x has a sum of squares that is smaller by more than this.
    at_edge : bool
        Whether the unconstrained minimum is impossible.

    Raises
    ------
    IdentificationError
        ``"no fit"`` where the certificate stays large.

    Notes
    -----
    On the central path Z = P⁻¹/t is feasible in the dual problem. For any Z ≥ 0 the difference between the
    sum of squares and the value of the dual function is ``|R x − c − R⁻ᵀ M*(Z)/2|² + ⟨Z, P(x)⟩``, a sum of
    two positive terms, so it is known without cancellation wherever the path is left.
    """
    free: Floats = np.asarray(np.linalg.solve(triangle, target), dtype=np.float64)
    if _is_definite(np.tensordot(free, maps, 1)):
        return free, 0.0, False
    # In units in which the first matrix is the unit matrix.
    factor = np.linalg.inv(np.linalg.cholesky(np.tensordot(start, maps, 1)))
    own = factor @ maps @ factor.T
    flat = own.reshape(len(maps), -1)
    squares = triangle.T @ triangle
    smallest = rest + float(np.sum((triangle @ free - target) ** 2))
    x = np.asarray(start, dtype=float)
    weight = len(own[0]) / max(float(np.sum((triangle @ x - target) ** 2)), 1e-300)
    gap, best, floor, again = np.inf, x, 1e-30 * float(target @ target), 0
    for _ in range(_STEPS):
        try:
            lower = np.linalg.inv(np.linalg.cholesky((x @ flat).reshape(own[0].shape)))
        except np.linalg.LinAlgError:  # rounding errors: the last point is the best
            break
        local = (lower @ own @ lower.T).reshape(len(own), -1)
        gradient = 2.0 * weight * triangle.T @ (triangle @ x - target) - local[:, :: len(own[0]) + 1].sum(
            axis=1
        )
        hessian = 2.0 * weight * squares + local @ local.T
        unit = np.sqrt(np.diagonal(hessian))
        step = np.linalg.solve(hessian / np.outer(unit, unit), -gradient / unit) / unit
        decrement = np.sqrt(max(float(-gradient @ step), 0.0))
        if decrement < 0.1:
            dual = flat @ (lower.T @ lower).ravel() / weight
            off = triangle @ x - target - 0.5 * np.linalg.solve(triangle.T, dual)
            now = float(off @ off) + len(own[0]) / weight
            worse = now >= gap
            if not worse:
                gap, best = now, x
            if gap <= max(_ENOUGH * smallest, floor):
                break
            # Newton's method converges at once here, until rounding errors are left.
            again += 1
            if float(off @ off) * weight <= len(own[0]) or again > _AGAIN:
                if worse and again > _AGAIN:
                    break
                weight, again = weight * _FACTOR, 0
                continue
        x = x + step / (1.0 + decrement) if decrement > 0.25 else x + step
    if not gap <= _CERTIFIED * smallest + _ROUNDING * float(target @ target):
        raise IdentificationError(
            f"measurements: the best possible body was not found: the certificate is {gap:.3g} of a chi2 of "
            f"{smallest:.6g}; ",
            "give a prior, or leave out what hardly depends on the body",
            kind="no fit",
        )
    return best, gap, True


def _is_definite(matrix: Floats) -> bool:
    try:
        np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        return False
    return True


def along_the_edge(covariance: Floats, maps: Floats, x: Floats) -> Floats:
    """Return the matrix that takes changes of x to the changes along the edge on which x lies, shape (p, p).

    On the edge the matrix P has a null space V; bodies along it keep ``Vᵀ P V = 0``. Of changes with the
    given covariance those remain that their conditional distribution has.
    """
    moments, vectors = np.linalg.eigh(np.tensordot(x, maps, 1))
    empty = vectors[:, moments < 1e-5 * moments[-1]]
    k = empty.shape[1]
    places = np.triu_indices(k)
    kept = (empty.T @ maps @ empty)[:, places[0], places[1]].T
    if not len(kept):
        return np.eye(len(x))
    mixed = covariance @ kept.T
    return np.asarray(np.eye(len(x)) - mixed @ np.linalg.pinv(kept @ mixed, hermitian=True) @ kept)
