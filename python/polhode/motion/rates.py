"""Angular velocity and acceleration along attitudes, and attitudes along an angular velocity.

Arguments are read here, and brought into units of a step; `rust/core/src/motion/rates` computes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from polhode import _core
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode._typing import SupportsQuaternion

    Floats = NDArray[np.float64]

__all__ = [
    "angular_acceleration",
    "angular_velocity",
    "quaternion",
    "rates_of",
    "read_quaternions",
    "read_times",
    "read_vectors",
]

_ORDERS: Final = (2, 4, 6, 8)
_NOISIEST: Final = 10.0
"""Noise of rows, relative to their size, beyond which they say nothing."""
_RANGE: Final = 1e15
"""The largest ratio of steps in time."""
_FASTEST: Final = 1e3
"""The largest angle, in radians, by which a known angular velocity may turn a body from row to row."""


# What is read ----------------------------------------------------------------------------------------


def read_times(t: ArrayLike) -> Floats:
    """Return the times, or refuse those that do not ascend."""
    times = _core.real_numbers(t, "t")
    if times.ndim != 1:
        raise ValueError(f"t: expected shape (T,), got {times.shape}")
    if not np.isfinite(times).all():
        row = int(np.flatnonzero(~np.isfinite(times))[0])
        raise PolhodeError(f"t: row {row} is {times[row]}; leave out rows without a time")
    if (falls := np.flatnonzero(np.diff(times) <= 0.0)).size:
        row = int(falls[0]) + 1
        raise PolhodeError(
            f"t: row {row} is {float(times[row])!r} after {float(times[row - 1])!r}, and times must ascend; "
            "sort the rows, and leave out those that stand twice"
        )
    return times


def _plain(attitude: ArrayLike | SupportsQuaternion) -> Any:
    """Return the quaternions of a rotation of another library, and anything else as it is."""
    return attitude.as_quat() if hasattr(attitude, "as_quat") else attitude


def read_quaternions(attitude: ArrayLike | SupportsQuaternion, rows: int, sequence: str | None) -> Floats:
    """Return unit quaternions R_NB of one body, shape (T, 4), continuous in time; rows with a NaN are NaN."""
    known: Floats = _core.real_numbers(_plain(attitude), "attitude")
    tail = (3,) if sequence is not None else (3, 3) if known.shape[-2:] == (3, 3) and known.ndim > 2 else (4,)
    if known.shape != (rows, *tail):
        if known.ndim == len(tail) + 2:
            raise ValueError(
                f"attitude: expected one body, got a stack of shape {known.shape}; take one by one"
            )
        raise ValueError(
            f"attitude: expected {rows} rows like t, of shape (T, 4), (T, 3, 3), or (T, 3) with sequence=, "
            f"got {known.shape}"
        )
    found = np.full((rows, 4), np.nan)
    there = np.asarray(np.isfinite(known).reshape(rows, -1).all(1))
    if not there.all() and np.isinf(known).any():
        row = int(np.flatnonzero(np.isinf(known).any(tuple(range(1, known.ndim))))[0])
        raise PolhodeError(f"attitude: row {row} is infinite; leave the row out, or write NaN")
    if sequence is not None:
        found[there] = _core.quaternion_from_euler_angles(known[there], sequence)
    elif tail == (3, 3):
        found[there] = _of_matrices(known, there)
    else:
        norms = np.sqrt(np.einsum("ij,ij->i", known, known))
        _refuse_far(there & ~(np.abs(norms - 1.0) <= _ROUNDED), norms, "the norm of the quaternion")
        np.divide(known, norms[:, None], out=found, where=there[:, None])
    return _continuous(found, there)


_ROUNDED: Final = 1e-3
"""How far from a rotation a row may be: tables have few digits."""


def _of_matrices(known: Floats, there: NDArray[np.bool_]) -> Floats:
    """Return the quaternions of the nearest rotations of matrices that are nearly rotations."""
    matrices = known[there]
    off = np.full(len(known), 0.0)
    off[there] = np.abs(np.swapaxes(matrices, 1, 2) @ matrices - np.eye(3)).max((1, 2))
    _refuse_far(there & ~(off <= 2.0 * _ROUNDED), off, "the largest element of R^T R - 1")
    determinants = np.linalg.det(known)
    _refuse_far(there & ~(determinants > 0.0), determinants, "the determinant")
    left, _, right = np.linalg.svd(matrices)
    return _core.quaternion_from_matrix(left @ right)


def _refuse_far(bad: NDArray[np.bool_], sizes: Floats, what: str) -> None:
    if bad.any():
        row = int(np.flatnonzero(bad)[0])
        raise PolhodeError(
            f"attitude: row {row} is no rotation: {what} is {sizes[row]:.6g}; rows are unit quaternions "
            "(x, y, z, w), rotation matrices R_NB, or Euler angles with sequence="
        )


def _continuous(quaternions: Floats, there: NDArray[np.bool_]) -> Floats:
    """Return the quaternions with signs that do not jump."""
    known = _without_gaps(there, quaternions)
    jumps = np.einsum("ij,ij->i", known[1:], known[:-1]) < 0.0
    if jumps.any():
        known[1:] *= np.where(np.cumsum(jumps) % 2, -1.0, 1.0)[:, None]
        quaternions[there] = known
    return quaternions


def read_vectors(values: ArrayLike, rows: int, name: str) -> Floats:
    """Return vectors of one body at each time; rows with a NaN are NaN."""
    known = _core.real_numbers(values, name)
    if known.shape != (rows, 3):
        raise ValueError(f"{name}: expected shape ({rows}, 3), a row for each time, got {known.shape}")
    if np.isinf(known).any():
        row = int(np.flatnonzero(np.isinf(known).any(1))[0])
        raise PolhodeError(f"{name}: row {row} is infinite; leave the row out, or write NaN")
    return known


def _rows_there(known: Floats, name: str, least: int = 3) -> NDArray[np.bool_]:
    there = np.asarray(~np.isnan(known).any(1))
    if there.sum() < least:
        raise PolhodeError(f"{name}: needs at least {least} rows without NaN, got {int(there.sum())}")
    return there


def _read_order(order: int | None) -> int | None:
    if order is not None and order not in _ORDERS:
        raise ValueError(f"order: {order!r} is none of {', '.join(map(str, _ORDERS))}")
    return order


def _read_sigma(sigma: float | None) -> float | None:
    if sigma is None:
        return None
    known = _core.real_numbers(sigma, "sigma")
    if known.ndim or not 0.0 < float(known) < np.inf:
        raise ValueError(f"sigma: expected a positive number, got {sigma!r}; None stands for unknown noise")
    return float(known)


# What is computed ------------------------------------------------------------------------------------


def rates_of(
    t: Floats, rows: Floats, order: int | None, sigma: float | None, *, turning: bool
) -> tuple[Floats, Floats]:
    """Compute rates and their errors of rows without gaps, in units of a step and of the values."""
    unit = _unit_of_steps(t)
    size = 1.0 if turning else _power_of_two(np.abs(rows).max())
    if sigma is not None and not sigma < _NOISIEST * size:
        raise PolhodeError(
            f"sigma: {sigma:g} is more than {_NOISIEST * size:g}, at which nothing is known of the rates; "
            "give the standard deviation of one component of a row"
        )
    known = rows if turning else rows / size
    rates, error = _core.rates((t - t[0]) / unit, known, order, None if sigma is None else sigma / size)
    with np.errstate(over="ignore"):
        rates, error = rates * (size / unit), error * (size / unit)
    if not (np.isfinite(rates).all() and np.isfinite(error).all()):
        raise PolhodeError("t: the rates are beyond floating-point numbers; take larger units of time")
    return rates, error


def _power_of_two(size: float) -> float:
    """Return the power of two nearest to a size, by which numbers are divided without rounding."""
    return float(np.ldexp(1.0, int(np.clip(np.frexp(size)[1], -1000, 1000)))) if size > 0.0 else 1.0


def _unit_of_steps(t: Floats) -> float:
    """Return a power of two near a usual step, or refuse steps that differ too much."""
    steps = np.diff(t)
    least, most = float(steps.min()), float(steps.max())
    if not most < np.inf or least < most / _RANGE:
        raise PolhodeError(
            f"t: its steps go from {least:g} to {most:g}, and may differ by a factor of {_RANGE:g}; leave "
            "out rows that are too near to others"
        )
    return _power_of_two(float(np.median(steps)))


def _without_gaps(there: NDArray[np.bool_], rows: Floats) -> Floats:
    """Return the rows that are there."""
    return rows if there.all() else rows[there]


def _with_gaps(there: NDArray[np.bool_], found: Floats) -> Floats:
    """Return the results with rows of NaN where the input had none."""
    if there.all():
        return found
    whole = np.full((len(there), *found.shape[1:]), np.nan)
    whole[there] = found
    return whole


def angular_velocity(
    t: ArrayLike,
    attitude: ArrayLike | SupportsQuaternion,
    frame: Literal["body", "space"] = "body",
    order: int | None = None,
    *,
    sigma: float | None = None,
    sequence: str | None = None,
) -> tuple[Floats, Floats]:
    """Compute the angular velocity along attitudes that are known at some times.

    Around each row the rotation vector from this row, in the axes of the body, is a polynomial through the
    neighbouring rows. Its derivative at the row is the angular velocity.

    Parameters
    ----------
    t : array_like, shape (T,)
        Times, ascending, in any steps.
    attitude : array_like or rotation, shape (T, 4), (T, 3, 3) or (T, 3)
        R_NB at each time: quaternions (x, y, z, w), rotation matrices, SciPy rotations, or Euler angles in
        radians with `sequence`. A row with a NaN is left out. From one row to the next the body must turn by
        less than half a turn.
    frame : {"body", "space"}
        The frame whose axes the components refer to.
    order : {2, 4, 6, 8}, optional
        Degree of the polynomials: through so many neighbours of each row. By default it is the one with the
        least estimated error. Few rows, or large turns from row to row, allow low orders only.
    sigma : float, optional
        Standard deviation, in radians, of white noise of the attitudes about each axis of the body. With it,
        the polynomials fit more rows than they pass through: degree and number of rows have the least
        estimated error. Without it every row is passed through.
    sequence : str, optional
        Sequence of Euler angles, as in :mod:`polhode.euler_angles`.

    Returns
    -------
    omega : numpy.ndarray, shape (T, 3)
        Angular velocity of the body relative to space, in radians per unit of time. NaN at rows with a NaN.
    error : numpy.ndarray, shape (T,)
        Estimated size of the error of each row: the change by two more orders, and the noise. Without `sigma`
        the noise is estimated from what polynomials through the neighbours of a row miss of this row.

    Raises
    ------
    PolhodeError
        For rows that are no rotations, times that do not ascend, and fewer than three rows.

    Notes
    -----
    From the rotation vector φ(t) with ``R(t) = R(t_k) exp(φ×)`` the angular velocity in the axes of the body
    is ``φ̇`` at the row itself, where φ is zero, and ``φ̇ − (1 − cos φ)/φ² φ×φ̇ + (φ − sin φ)/φ³ φ×(φ×φ̇)`` at
    other rows: at the ends, and where noise is smoothed [1]_.

    References
    ----------
    .. [1] J. E. Bortz, "A New Mathematical Formulation for Strapdown Inertial Navigation", IEEE Transactions
       on Aerospace and Electronic Systems AES-7 (1971) 61.

    Examples
    --------
    >>> import numpy as np
    >>> from polhode import kinematics, solids
    >>> t = np.linspace(0.0, 4.0, 81)
    >>> motion = solids.box((3.0, 2.0, 1.0), mass=1.0).free_motion((0.3, 2.0, 0.1)).at(t)
    >>> omega, error = kinematics.angular_velocity(t, motion.quaternion)
    >>> bool(np.abs(omega - motion.omega).max() < 1e-8), bool(error.max() < 1e-8)
    (True, True)
    """
    if frame not in ("body", "space"):
        raise ValueError(f"frame: {frame!r} is not 'body' or 'space'")
    times = read_times(t)
    known = read_quaternions(attitude, len(times), sequence)
    there = _rows_there(known, "attitude")
    attitudes = _without_gaps(there, known)
    rates, error = rates_of(
        _without_gaps(there, times), attitudes, _read_order(order), _read_sigma(sigma), turning=True
    )
    if frame == "space":
        rates = _core.rotate(attitudes, rates)
    return _with_gaps(there, rates), _with_gaps(there, error)


def angular_acceleration(
    t: ArrayLike, omega: ArrayLike, order: int | None = None, *, sigma: float | None = None
) -> tuple[Floats, Floats]:
    """Compute the angular acceleration along an angular velocity that is known at some times.

    Parameters
    ----------
    t : array_like, shape (T,)
        Times, ascending, in any steps.
    omega : array_like, shape (T, 3)
        Angular velocity at each time. A row with a NaN is left out. Of attitudes,
        :func:`angular_velocity` computes it.
    order : {2, 4, 6, 8}, optional
        Degree of the polynomials; by default the one with the least estimated error.
    sigma : float, optional
        Standard deviation of white noise of each component; as in :func:`angular_velocity`.

    Returns
    -------
    acceleration : numpy.ndarray, shape (T, 3)
        In the axes of `omega`: the rate of ω is the same in the body and in space, since ω×ω is zero.
    error : numpy.ndarray, shape (T,)
        Estimated size of the error of each row.

    Examples
    --------
    >>> import numpy as np
    >>> from polhode import kinematics, solids
    >>> t = np.linspace(0.0, 4.0, 81)
    >>> motion = solids.box((3.0, 2.0, 1.0), mass=1.0).free_motion((0.3, 2.0, 0.1)).at(t)
    >>> rate, error = kinematics.angular_acceleration(t, motion.omega)
    >>> bool(np.abs(rate - motion.angular_acceleration()).max() < 1e-6)
    True
    """
    times = read_times(t)
    known = read_vectors(omega, len(times), "omega")
    there = _rows_there(known, "omega")
    times, rows = _without_gaps(there, times), _without_gaps(there, known)
    rates, error = rates_of(times, rows, _read_order(order), _read_sigma(sigma), turning=False)
    return _with_gaps(there, rates), _with_gaps(there, error)


# From angular velocities to attitudes ----------------------------------------------------------------


def quaternion(
    t: ArrayLike,
    omega: ArrayLike,
    attitude: ArrayLike | SupportsQuaternion = (0.0, 0.0, 0.0, 1.0),
    frame: Literal["body", "space"] = "body",
    order: int = 6,
) -> tuple[Floats, Floats]:
    """Compute attitudes from an angular velocity that is known at some times.

    Between two rows the angular velocity is a polynomial through `order` neighbouring rows. The rotation from
    row to row is the Magnus series of sixth order.

    Parameters
    ----------
    t : array_like, shape (T,)
        Times, ascending, in any steps.
    omega : array_like, shape (T, 3)
        Angular velocity relative to space, in radians per unit of time. A row with a NaN is left out.
    attitude : array_like or rotation, shape (4,)
        R_NB at the first row that is not left out.
    frame : {"body", "space"}
        The frame whose axes the components of `omega` refer to.
    order : {2, 4, 6, 8}
        Through how many rows the polynomials pass; few rows allow low orders only.

    Returns
    -------
    quaternion : numpy.ndarray, shape (T, 4)
        R_NB as (x, y, z, w), continuous in time. NaN at rows with a NaN.
    error : numpy.ndarray, shape (T,)
        Estimated size of the error of each row, in radians: the sum of the changes by two more orders and
        half the steps, the noise of `omega`, and rounding.

    Notes
    -----
    The Magnus series and its formula with three nodes are those of [1]_.

    References
    ----------
    .. [1] S. Blanes, F. Casas, J. A. Oteo, J. Ros, "The Magnus expansion and some of its applications",
       Physics Reports 470 (2009) 151, section 5.4.

    Examples
    --------
    >>> import numpy as np
    >>> from polhode import kinematics, solids
    >>> t = np.linspace(0.0, 4.0, 81)
    >>> motion = solids.box((3.0, 2.0, 1.0), mass=1.0).free_motion((0.3, 2.0, 0.1)).at(t)
    >>> found, error = kinematics.quaternion(t, motion.omega)
    >>> bool(np.abs(found - motion.quaternion).max() < 1e-7), bool(error.max() < 1e-7)
    (True, True)
    """
    if frame not in ("body", "space"):
        raise ValueError(f"frame: {frame!r} is not 'body' or 'space'")
    times = read_times(t)
    known = read_vectors(omega, len(times), "omega")
    if _read_order(order) is None:
        raise ValueError(f"order: {order!r} is none of {', '.join(map(str, _ORDERS))}")
    start = _core.real_numbers(_plain(attitude), "attitude")
    if start.shape != (4,):
        raise ValueError(f"attitude: expected shape (4,), at the first row, got {start.shape}")
    first = read_quaternions(start[None], 1, None)[0]
    if np.isnan(first).any():
        raise PolhodeError("attitude: it must be finite, got NaN; give R_NB at the first row")
    there = _rows_there(known, "omega", 2)
    t_there, rows = _without_gaps(there, times), _without_gaps(there, known)
    unit = _unit_of_steps(t_there)
    t_there = (t_there - t_there[0]) / unit
    with np.errstate(over="ignore"):
        rows = rows * unit
    turn = float(np.abs(rows).max() * np.diff(t_there).max())
    if not turn < _FASTEST:
        raise PolhodeError(
            f"omega: the body would turn by {turn:.3g} rad from one row to the next, and its attitude would "
            "not be known; give more rows, or check the units"
        )
    found, error = _core.attitudes(t_there, rows, first, frame, order)
    return _with_gaps(there, found), _with_gaps(there, error)
