"""From a log of the angular velocity of a tumbling body to its tensor, and what a throw would tell of it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from polhode._core import RigidBody, Uncertain, fit_tumble, tumble_information, white_noise
from polhode._hints import check_kind
from polhode.errors import IdentificationError
from polhode.identify.results import ELEMENTS, NUMBERS, Direction, Identified, echelon, p_value_of, tensor_of
from polhode.motion.rates import read_quaternions, read_vectors
from polhode.results import State

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from polhode._core import FreeMotion, GyrostatMotion
    from polhode._typing import SupportsQuaternion

    Floats = NDArray[np.float64]

__all__ = ["best_throw", "design", "from_tumble"]


_STARTS: Final = 4
_LEAST: Final = 8
"""Rows of a log, at least."""
_NEVER: Final = 1e-6
"""Probability below which noise does not explain a sum of squares."""
_UNCERTAIN: Final = 0.1
"""Share of its own size beyond which the sigma of a direction is told."""
_LOST: Final = 0.3
"""Share beyond which a direction is not determined: the triangle inequality tells as much."""
_SHARE: Final = 0.15
_RANK: Final = 1e-13
_AXES: Final = "xyz"
_SCALE: Final = "the scale of the tensor"
_SCALE_REMEDY: Final = (
    "no torque acts and no rotor turns: let a rotor of known momentum turn inside, apply a known torque, or "
    "give what is known by prior="
)
_REMEDY: Final = (
    "throw it so that ω moves about all axes (identify.best_throw), spin it faster, or log longer"
)
_BASIS: Final = np.array(tensor_of(np.eye(6)))
_TRACE: Final = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])


def from_tumble(
    t: ArrayLike,
    omega: ArrayLike,
    *,
    sigma: ArrayLike | None = None,
    bias: bool | Uncertain = False,
    rotor: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    attitude: ArrayLike | SupportsQuaternion | None = None,
    attitude_sigma: ArrayLike | None = None,
    specific_force: ArrayLike | None = None,
    specific_force_sigma: ArrayLike | None = None,
    scale: bool = False,
    mass: float | None = None,
    prior: RigidBody | None = None,
    loss: Literal["gaussian", "student"] = "gaussian",
    starts: int | None = None,
    progress: Callable[[float], object] | None = None,
) -> Identified:
    """Find the most likely tensor of a freely tumbling body from a log of its angular velocity.

    The model is the exact motion of Euler's equations, ``I ω̇ + ω × (I ω + h) = N``, plus white noise. Body
    frame: the axes of the gyro, with the origin at the centre of mass. Without a rotor, a torque or a prior
    the log has only ratios of the tensor: its trace is then 1, and ``scale_known`` is False.

    Parameters
    ----------
    t : array_like, shape (n,)
        Ascending times, evenly spaced or not.
    omega : array_like, shape (n, 3)
        Measured angular velocity in rad per unit of time. A row with a number that is not finite is a lost
        sample: it is left out, and counted in ``dropped``.
    sigma : float or array_like, shape (3,), optional
        Standard deviations of white noise; without one it is estimated from the residuals.
    bias : bool or Uncertain
        Constant offset of the gyro: none, estimated, or known beforehand as an Uncertain of shape (3,).
    rotor : array_like, shape (3,), optional
        Known constant angular momentum of rotors inside, relative to the body, in its axes.
    torque : array_like, shape (3,), optional
        Known constant torque about the centre of mass, in body axes: that of a thruster.
    attitude : array_like or rotation, shape (n, 4) or (n, 3, 3), optional
        Measured attitudes R_NB at the same times, with white noise of small turns about body axes. A row of
        NaN is none: cameras are slower than gyros.
    attitude_sigma : float or array_like, shape (3,), optional
        Standard deviations of these turns, in radians. Needed with `attitude`.
    specific_force : array_like, shape (n, 3), optional
        What an accelerometer at an unknown place r reads in free flight, ``ω̇ × r + ω × (ω × r)``, in body
        axes, in units of length per time squared. A row of NaN is none. The place is estimated.
    specific_force_sigma : float or array_like, shape (3,), optional
        Standard deviations of its noise. Needed with `specific_force`.
    scale : bool
        Whether the gyro's three scales have errors that are estimated. Only beside `attitude`: in principal
        axes three scales and two ratios of moments do not follow from three products of components.
    mass : float, optional
        Mass of the body that is returned, 1 by default. The motion does not depend on it.
    prior : RigidBody, optional
        What is known of the tensor beforehand: a body with a covariance.
    loss : {"gaussian", "student"}
        The second bears outliers: noise by Student's distribution with 4 degrees of freedom.
    starts : int, optional
        Number of further starts, 4 by default, so that no second maximum is missed.
    progress : callable, optional
        Called with the fraction done.

    Returns
    -------
    Identified
        ``parameters`` are the angular velocity at the time of the first finite row, the tensor and what else
        is estimated: ``bias``, ``scale`` (measured over true, less 1), the first attitude as a small turn
        about body axes, ``sensor_place`` from the centre of mass. ``motion`` is the motion of the most likely
        body; its times count from that row.

    Raises
    ------
    IdentificationError
        ``"undetermined"`` where the sigma of a direction of the tensor exceeds 30 % of its size; ``"no fit"``
        where no free motion explains the log, with a probability below 1e-6; ``"units"`` where one explains
        it in degrees; ``"clock"`` for times that do not ascend; ``"saturated"`` where values pile up at a
        limit.
    ValueError
        For arrays whose shapes do not agree.

    Notes
    -----
    Pieces of the log are fitted first, whose gaps close as the fit goes on; then one motion is fitted to the
    whole log, and last to all sensors. See :doc:`/theory/identification`.

    Examples
    --------
    A box thrown with a gyro of 0.01 rad/s noise and an unknown offset, 100 samples a second:

    >>> import numpy as np
    >>> from polhode import RigidBody, identify
    >>> body = RigidBody.from_principal(1.0, (0.2, 0.35, 0.45))
    >>> t = np.linspace(0.0, 8.0, 800)
    >>> exact = body.free_motion((1.0, 3.0, 0.5)).at(t).omega
    >>> gyro = exact + (0.05, -0.02, 0.03) + np.random.default_rng(1).normal(0.0, 0.01, (800, 3))
    >>> found = identify.from_tumble(t, gyro, bias=True)
    >>> found.body.principal_moments.round(2), found.scale_known
    (array([0.2 , 0.35, 0.45]), False)
    >>> [one.words for one in found.observability]
    ['the scale of the tensor']
    """
    times, rows, good = _log(t, omega)
    dropped = {"not finite": int((~good).sum())} if not good.all() else {}
    known = _known(sigma, bias, rotor, torque, prior, loss) | _sensors(
        good, attitude, attitude_sigma, specific_force, specific_force_sigma, scale
    )
    if starts is not None and (isinstance(starts, bool) or int(starts) != starts or starts < 0):
        raise ValueError(f"starts: expected a whole number of at least 0, got {starts!r}")
    known["starts"] = _STARTS if starts is None else int(starts)
    own_mass = 1.0 if mass is None else float(mass)
    if not 0.0 < own_mass < math.inf:
        raise ValueError(f"mass: expected a positive number, got {mass!r}")
    _check_saturation(rows)
    found = fit_tumble(times, rows, known, progress)
    if not found:
        raise IdentificationError(
            "omega: no free motion was found near this log; check its units and axes, and that nothing ",
            "touches the body",
            kind="no fit",
        )
    _check_fit(times, rows, known, found[0])
    fits = [_result(one, known, own_mass, dropped) for one in found]
    weak = tuple(one for one in fits[0].observability if one.words != _SCALE)
    if any(one.relative >= _LOST for one in weak) or np.isnan(fits[0].covariance).any():
        raise IdentificationError(
            f"omega: {len(times)} rows leave undetermined: ",
            "; ".join(one.words for one in weak) or "combinations of start and offsets",
            f"; {_REMEDY}",
            kind="undetermined",
            observability=fits[0].observability,
        )
    if not found[0]["converged"]:
        raise IdentificationError(
            "omega: the fit came near a maximum of the likelihood and did not reach it; ",
            "record longer, give sigma=, or more starts=",
            kind="no fit",
        )
    others = tuple(one for one in fits[1:] if not np.isnan(one.covariance).any())
    return replace(fits[0], alternatives=others)


def design(
    body: RigidBody,
    omega: ArrayLike,
    t: ArrayLike,
    sigma: ArrayLike,
    *,
    bias: bool | Uncertain = False,
    rotor: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    attitude_sigma: ArrayLike | None = None,
    specific_force_sigma: ArrayLike | None = None,
    sensor_place: ArrayLike = (0.0, 0.0, 0.0),
    scale: bool = False,
) -> Identified:
    """Compute what a log of a throw would tell of a body, before it is thrown.

    Parameters
    ----------
    body : RigidBody
        What one believes of the body.
    omega : array_like, shape (3,)
        Angular velocity at the first time, in the body frame.
    t : array_like, shape (n,)
        Ascending times.
    sigma : float or array_like, shape (3,)
        Standard deviations of the noise.
    bias : bool or Uncertain
        As in :func:`from_tumble`.
    rotor, torque : array_like, shape (3,), optional
        As in :func:`from_tumble`.
    attitude_sigma, specific_force_sigma : float or array_like, shape (3,), optional
        Noise of further sensors, if there are any, with a row at each time.
    sensor_place : array_like, shape (3,)
        Where the accelerometer is, from the centre of mass.
    scale : bool
        As in :func:`from_tumble`.

    Returns
    -------
    Identified
        Without data: ``covariance`` and ``crlb`` are the bound of Cramér and Rao, ``observability`` has each
        direction that the log would hardly determine, ``residuals`` is empty. Where something would not be
        determined at all, the covariances are NaN.

    Raises
    ------
    ValueError
        For arguments of wrong shapes.

    Examples
    --------
    A box that spins about an axis tells of few numbers; one that tumbles, of all:

    >>> import numpy as np
    >>> from polhode import RigidBody, identify
    >>> body = RigidBody.from_principal(1.0, (0.2, 0.35, 0.45))
    >>> t = np.linspace(0.0, 2.0, 200)
    >>> spin = identify.design(body, (0.0, 0.0, 9.0), t, sigma=0.01)
    >>> tumble = identify.design(body, (3.0, 8.0, 2.0), t, sigma=0.01)
    >>> len(spin.observability), [one.words for one in tumble.observability]
    (4, ['the scale of the tensor'])
    """
    times = _times(t)
    if not np.isfinite(times).all():
        raise ValueError("t: expected finite times")
    inertia, known = _before_a_throw(body, sigma, bias, rotor, torque)
    still = None if attitude_sigma is None else np.tile([0.0, 0.0, 0.0, 1.0], (len(times), 1))
    zero = None if specific_force_sigma is None else np.zeros((len(times), 3))
    every = np.ones(len(times), dtype=bool)
    known |= _sensors(every, still, attitude_sigma, zero, specific_force_sigma, scale)
    start, place = _vector("omega", omega), _vector("sensor_place", sensor_place)
    fit = _information(times, start, inertia, known, place)
    if fit is None:
        turns = float(np.linalg.norm(start)) * float(np.diff(times).max())
        raise ValueError(
            f"t, omega: the body turns by {turns:.3g} rad from one time to the next, too far to be followed; "
            "give more times, or a slower throw"
        )
    fit |= {"residuals": np.zeros((0, np.shape(fit["residuals"])[1])), "chi2": 0.0}
    return _result(fit, known, float(body.mass), {}, rows=len(times))


def best_throw(
    body: RigidBody,
    energy: float,
    end: float,
    sigma: ArrayLike,
    n: int = 200,
    *,
    bias: bool | Uncertain = False,
    rotor: ArrayLike | None = None,
) -> Floats:
    """Find the angular velocity with which a throw of given energy tells most of the tensor.

    The best throw has the least sum of the variances of the elements of the tensor.

    Parameters
    ----------
    body : RigidBody
        What one believes of the body.
    energy : float
        Kinetic energy of rotation about the centre of mass.
    end : float
        Duration of the log.
    sigma : float or array_like, shape (3,)
        Standard deviations of the noise.
    n : int
        Number of samples.
    bias : bool or Uncertain
        As in :func:`from_tumble`.
    rotor : array_like, shape (3,), optional
        As in :func:`from_tumble`.

    Returns
    -------
    numpy.ndarray, shape (3,)
        In the body frame.

    Raises
    ------
    ValueError
        For a body with a moment of zero, and for numbers that are not positive.

    Examples
    --------
    >>> import numpy as np
    >>> from polhode import RigidBody, identify
    >>> body = RigidBody.from_principal(1.0, (0.2, 0.35, 0.45))
    >>> omega = identify.best_throw(body, energy=10.0, end=1.0, sigma=0.01)
    >>> t = np.linspace(0.0, 1.0, 200)
    >>> best = identify.design(body, omega, t, sigma=0.01)
    >>> flat = identify.design(body, (7.0, 3.0, 1.0), t, sigma=0.01)
    >>> bool(best.body.sigma.principal_moments.max() < flat.body.sigma.principal_moments.max())
    True
    """
    inertia, known = _before_a_throw(body, sigma, bias, rotor, None)
    known |= _sensors(np.ones(0, dtype=bool), None, None, None, None, False)
    for name, x in (("energy", energy), ("end", end)):
        if not 0.0 < float(x) < 1e100:
            raise ValueError(f"{name}: expected a positive number, got {x!r}")
    if isinstance(n, bool) or int(n) != n or not _LEAST <= n <= 10_000_000:
        raise ValueError(f"n: expected a whole number from {_LEAST} to 10000000, got {n!r}")
    moments, axes = np.linalg.eigh(np.asarray(body.inertia))
    if not moments[0] > 1e-9 * moments[2]:
        raise ValueError(
            f"body: the moment {moments[0]:.3g} is zero beside {moments[2]:.3g}; "
            "a spin about this axis has no energy; give the body some thickness"
        )
    times = np.linspace(0.0, float(end), int(n))
    scaled = _has_scale(known)

    def throw(direction: Floats) -> Floats:
        unit = direction / np.linalg.norm(direction)
        return np.asarray(axes @ (unit * np.sqrt(2.0 * float(energy) / moments)))

    def loss(direction: Floats) -> float:
        fit = _information(times, throw(direction), inertia, known)
        if fit is None:
            return math.inf
        covariance = _covariance(np.array(fit["triangle"]), _allowed(inertia, scaled, False))
        return math.inf if covariance is None else float(np.trace(covariance[3:9, 3:9]))

    # Without a rotor the signs of the components do not matter: reflections of the motion.
    k = np.arange(64)
    height, turn = (k + 0.5) / 64.0, k * math.pi * (3.0 - math.sqrt(5.0))
    side = np.sqrt(1.0 - height**2)
    directions = np.stack([side * np.cos(turn), side * np.sin(turn), height], axis=1)
    directions = np.vstack([directions, -directions]) if scaled else np.abs(directions)
    losses = [loss(one) for one in directions]
    best, least = directions[int(np.argmin(losses))], min(losses)
    if least == math.inf:
        raise ValueError(
            f"energy, end, n: no throw with an energy of {float(energy):.3g} tells of this body within "
            f"{float(end):.3g} in {n} samples: it turns too little, or too far from one to the next"
        )
    step = 0.1
    while step > 1e-3:
        tried = [best + step * sign * one for one in np.eye(3) for sign in (1.0, -1.0)]
        tried = [one / np.linalg.norm(one) for one in tried]
        losses = [loss(one) for one in tried]
        if min(losses) < least:
            best, least = tried[int(np.argmin(losses))], min(losses)
        else:
            step *= 0.4
    return throw(best)


def _before_a_throw(
    body: RigidBody,
    sigma: ArrayLike,
    bias: bool | Uncertain,
    rotor: ArrayLike | None,
    torque: ArrayLike | None,
) -> tuple[Floats, dict[str, Any]]:
    """Return the tensor that is believed in, of trace 1 if its scale does not matter, and what is known."""
    check_kind(body, "body", "RigidBody")
    if body.shape != ():
        raise ValueError(f"body: expected one body, got a stack of shape {body.shape}")
    known = _known(sigma, bias, rotor, torque, None, "gaussian") | {"starts": 0}
    inertia = np.asarray(body.inertia)
    return inertia if _has_scale(known) else inertia / np.trace(inertia), known


def _information(
    times: Floats, start: Floats, inertia: Floats, known: dict[str, Any], place: ArrayLike = (0.0, 0.0, 0.0)
) -> dict[str, Any] | None:
    """Compute what a throw would tell; None where the motion is not followed."""
    elements = [float(inertia[i, j]) for i, j in ELEMENTS]
    return tumble_information(times, start.tolist(), elements, np.asarray(place).tolist(), known)


def _times(t: ArrayLike) -> Floats:
    times = np.asarray(t, dtype=float)
    if times.ndim != 1 or len(times) < _LEAST:
        raise ValueError(f"t: expected shape (n,) of at least {_LEAST} times, got {times.shape}")
    finite = np.flatnonzero(np.isfinite(times))
    back = np.flatnonzero(np.diff(times[finite]) <= 0.0)
    if len(back):
        k, after = finite[back[0]], finite[back[0] + 1]
        raise IdentificationError(
            f"t: time does not ascend from row {k} to row {after}: {times[k]}, {times[after]}",
            "; sort the rows, and keep each once; where a clock was reset, take one side of it",
            kind="clock",
        )
    return times


def _log(t: ArrayLike, omega: ArrayLike) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Return the rows with finite numbers, and which they are."""
    times, rows = _times(t), np.asarray(omega, dtype=float)
    if rows.shape != (len(times), 3):
        raise ValueError(f"omega: expected shape ({len(times)}, 3), a row for each time, got {rows.shape}")
    good = np.isfinite(times) & np.isfinite(rows).all(axis=1)
    times, rows = times[good], rows[good]
    if len(times) < _LEAST:
        raise IdentificationError(
            f"omega: {len(times)} finite rows are too few: at least {_LEAST} are needed; record longer",
            kind="undetermined",
        )
    largest = float(np.abs(rows).max())
    if largest > 1e100 or not np.abs(times).max() < 1e100:
        raise ValueError("omega, t: numbers beyond 1e100 are none of a gyro; check the file")
    if not largest > 1e-100:
        raise IdentificationError(
            "omega: all rows are zero; a body at rest tells nothing of its tensor; check the columns",
            kind="undetermined",
        )
    return times, rows, good


def _vector(name: str, given: ArrayLike) -> Floats:
    found = np.asarray(given, dtype=float)
    if found.shape != (3,) or not (np.abs(found) < 1e100).all():
        raise ValueError(f"{name}: expected three finite numbers, shape (3,), got {given!r}")
    return found


def _known(
    sigma: ArrayLike | None,
    bias: bool | Uncertain,
    rotor: ArrayLike | None,
    torque: ArrayLike | None,
    prior: RigidBody | None,
    loss: str,
) -> dict[str, Any]:
    """Return what is known of gyro and body beside the log."""
    sigmas = None if sigma is None else _three_sigmas("sigma", sigma)
    if loss not in ("gaussian", "student"):
        raise ValueError(f"loss: expected 'gaussian' or 'student', got {loss!r}")
    offset: Any = bias
    if isinstance(bias, Uncertain):
        if np.shape(bias.value) != (3,):
            raise ValueError(f"bias: expected an Uncertain of shape (3,), got {np.shape(bias.value)}")
        offset = (bias.value.tolist(), _whitening("bias", np.asarray(bias.covariance)).tolist())
    elif not isinstance(bias, (bool, np.bool_)):
        raise ValueError(
            f"bias: expected True, False or an Uncertain of shape (3,), got {bias!r}; "
            "a known offset is subtracted: omega - bias"
        )
    else:
        offset = bool(bias)
    momentum = np.zeros(3) if rotor is None else _vector("rotor", rotor)
    turning = np.zeros(3) if torque is None else _vector("torque", torque)
    before = None
    if prior is not None:
        check_kind(prior, "prior", "RigidBody")
        if prior.shape != () or prior.covariance is None:
            raise ValueError("prior: expected one body with a covariance; give it one by with_covariance")
        mean = [float(prior.inertia[i, j]) for i, j in ELEMENTS]
        before = (mean, _whitening("prior", np.asarray(prior.covariance)[4:, 4:]).tolist())
    return {
        "sigma": sigmas, "bias": offset, "momentum": momentum.tolist(), "torque": turning.tolist(),
        "prior": before, "student": loss == "student",
    }  # fmt: skip


def _has_scale(known: dict[str, Any]) -> bool:
    return any(known["momentum"]) or any(known["torque"]) or known["prior"] is not None


def _three_sigmas(name: str, sigma: ArrayLike) -> list[float]:
    found = np.asarray(sigma, dtype=float)
    if found.shape not in ((), (3,)) or not ((found > 1e-100) & (found < 1e100)).all():
        raise ValueError(f"{name}: expected a positive number or three, got {sigma!r}")
    return [float(one) for one in np.broadcast_to(found, 3)]


def _sensors(
    good: NDArray[np.bool_],
    attitude: ArrayLike | SupportsQuaternion | None,
    attitude_sigma: ArrayLike | None,
    specific_force: ArrayLike | None,
    specific_force_sigma: ArrayLike | None,
    scale: bool,
) -> dict[str, Any]:
    """Return what further sensors measured in the rows that are kept."""
    attitudes = None if attitude is None else read_quaternions(attitude, len(good), None)
    forces = None if specific_force is None else read_vectors(specific_force, len(good), "specific_force")
    found = {
        "attitude": _rows("attitude", attitudes, attitude_sigma, good),
        "specific_force": _rows("specific_force", forces, specific_force_sigma, good),
        "scale": bool(scale),
    }
    if scale and found["attitude"] is None:
        raise ValueError(
            "scale: the scales of a gyro follow only beside attitude=; measure attitudes too, or leave it out"
        )
    return found


def _rows(
    name: str, rows: Floats | None, sigma: ArrayLike | None, good: NDArray[np.bool_]
) -> tuple[Floats, list[float]] | None:
    """Return the rows of a sensor that are kept, and the sigmas of its noise; None without this sensor."""
    if rows is None and sigma is None:
        return None
    if rows is None:
        raise ValueError(f"{name}: it is needed beside {name}_sigma")
    if sigma is None:
        raise ValueError(f"{name}_sigma: it is needed beside {name}")
    kept = np.ascontiguousarray(rows[good])
    if len(good) and not np.isfinite(kept).all(axis=1).any():
        raise IdentificationError(
            f"{name}: no row is finite where the gyro has one; leave {name} out", kind="undetermined"
        )
    return kept, _three_sigmas(f"{name}_sigma", sigma)


def _whitening(name: str, covariance: Floats) -> Floats:
    """Return rows that make errors of unit variance; what has no variance is known to nine digits."""
    largest = float(np.abs(covariance).max())
    if not 0.0 < largest < 1e200:
        raise ValueError(f"{name}: expected a covariance that is not zero")
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray((vectors / np.sqrt(np.maximum(values, 1e-18 * largest))).T)


def _check_saturation(rows: Floats) -> None:
    """Refuse a log whose values pile up at the largest one: a gyro beyond its range."""
    for k, axis in enumerate(_AXES):
        for sign in (1.0, -1.0):
            values, counts = np.unique(sign * rows[:, k], return_counts=True)
            if len(values) < 2:
                continue
            piled = int(counts[-1])
            # A rounded peak has many values just below it, too.
            if piled >= max(5, 0.01 * len(rows)) and piled > 4 * int(counts[-2]):
                limit = sign * float(values[-1])
                raise IdentificationError(
                    f"omega: {piled} of {len(rows)} rows have {limit:g} about {axis}, and none is beyond: ",
                    "the gyro is saturated; throw it slower, choose a wider range, or set these rows to NaN",
                    kind="saturated",
                )


def _misfit(times: Floats, rows: Floats, fit: dict[str, Any], known: dict[str, Any]) -> bool:
    """Return whether noise does not explain the residuals."""
    count = _measured(known, len(times))
    if known["sigma"] is not None:
        return not known["student"] and p_value_of(fit["chi2"], count - _unknowns(known)) < _NEVER
    level = white_noise(times, rows)
    floor = 1e-7 * float(np.sqrt(np.mean(rows**2)))
    # A smooth curve through the rows leaves the noise; a motion that leaves far more does not fit.
    return bool(fit["sigma"][0] > 2.0 * max(level, floor))


def _measured(known: dict[str, Any], rows: int) -> int:
    """Count the numbers that were measured."""
    count = 3 * rows
    for name in ("attitude", "specific_force"):
        if known[name] is not None:
            count += 3 * int(np.isfinite(known[name][0]).all(axis=1).sum())
    return count


def _unknowns(known: dict[str, Any]) -> int:
    free: int = 8 + _has_scale(known) + 3 * (known["bias"] is not False)
    free += 3 * (known["scale"] + (known["attitude"] is not None) + (known["specific_force"] is not None))
    return free - 6 * (known["prior"] is not None) - 3 * isinstance(known["bias"], tuple)


def _check_fit(times: Floats, rows: Floats, known: dict[str, Any], fit: dict[str, Any]) -> None:
    if not _misfit(times, rows, fit, known):
        return
    by = math.pi / 180.0
    again = dict(known)
    if known["sigma"] is not None:
        again["sigma"] = [by * one for one in known["sigma"]]
    if isinstance(known["bias"], tuple):
        mean, white = known["bias"]
        again["bias"] = ((by * np.array(mean)).tolist(), (np.array(white) / by).tolist())
    # The gyro alone tells its unit.
    again |= {"attitude": None, "specific_force": None, "scale": False}
    in_degrees = fit_tumble(times, by * rows, again)
    if in_degrees and not _misfit(times, by * rows, in_degrees[0], again):
        raise IdentificationError(
            f"omega: no free motion fits rates up to {np.abs(rows).max():.3g} rad per unit of time, ",
            "but one fits them in degrees; convert them: np.deg2rad(omega)",
            kind="units",
        )
    if known["sigma"] is None:
        misfit = f"the residuals have a sigma of {fit['sigma'][0]:.3g}, far more than the noise of the log; "
    else:
        freedom = _measured(known, len(times)) - _unknowns(known)
        misfit = f"chi2 is {fit['chi2']:.6g} with {freedom} degrees of freedom; "
    raise IdentificationError(
        f"omega: {misfit}",
        "no free motion explains the log; cut off the rows of throw and catch, estimate the offset by ",
        'bias=True, take loss="student" for outliers, or enlarge the sigmas',
        kind="no fit",
    )


def _allowed(inertia: Floats, scaled: bool, at_edge: bool) -> Floats:
    """Return an orthonormal basis, shape (6, k), of changes of the elements that were free."""
    laws = []
    if not scaled:
        laws.append(_TRACE)
    if at_edge:
        axis = np.linalg.eigh(inertia)[1][:, 2]
        normal = 0.5 * np.eye(3) - np.outer(axis, axis)
        laws.append(np.array([np.sum(one * normal) for one in _BASIS]))
    if not laws:
        return np.eye(6)
    rows = np.linalg.svd(np.array(laws))[2]
    return np.asarray(rows[len(laws) :].T)


def _covariance(triangle: Floats, space: Floats) -> Floats | None:
    """Return the covariance of all parameters with tensors in a space; None where it is not finite."""
    extra = len(triangle) - 9
    maps = np.zeros((len(triangle), 3 + space.shape[1] + extra))
    maps[:3, :3] = np.eye(3)
    maps[3:9, 3 : 3 + space.shape[1]] = space
    maps[9:, 3 + space.shape[1] :] = np.eye(extra)
    inner = triangle @ maps
    lengths = np.linalg.norm(inner, axis=0)
    if not (lengths > 0.0).all():
        return None
    upper = np.linalg.qr(inner / lengths, mode="r")
    values, rows = np.linalg.svd(upper)[1:]
    if values[-1] <= _RANK * values[0]:
        return None
    root = maps @ ((rows.T / values) / lengths[:, None])
    return np.asarray(root @ root.T)


def _marginal(triangle: Floats) -> Floats:
    """Return the triangle of what the log tells of the tensor where start and offsets are not known."""
    order = [*range(3), *range(9, len(triangle)), *range(3, 9)]
    upper = np.asarray(np.linalg.qr(triangle[:, order], mode="r"))
    return upper[-6:, -6:]


def _directions(triangle: Floats, inertia: Floats, scaled: bool) -> tuple[Direction, ...]:
    """Find the directions of the tensor that the log hardly determines, the worst first.

    Their parameters are those of the triangle: start, tensor and what else is unknown.
    """
    space, size = _allowed(inertia, scaled, False), float(np.trace(inertia)) / 3.0
    jacobian = _marginal(triangle) @ space * size
    values, rows = np.linalg.svd(jacobian, full_matrices=True)[1:]
    values = np.append(values, np.zeros(space.shape[1] - len(values)))
    found = [] if scaled else [_scale_direction(inertia, size)]
    large = float(np.abs(triangle[:, :3]).max()) * float(np.sqrt(size))
    lost = values <= 1e-11 * large
    weak = ~lost & (values * _UNCERTAIN < 1.0)
    open_rows = rows[lost] @ space.T
    if not scaled:
        # A multiple of the tensor changes nothing. Without its largest element directions that differ have
        # names that differ.
        own = np.array([inertia[i, j] for i, j in ELEMENTS])
        largest = int(np.argmax(np.abs(own)))
        open_rows = open_rows - np.outer(open_rows[:, largest] / own[largest], own)
    named = [(math.inf, one) for one in echelon(open_rows)]
    named += [(1.0 / float(value), space @ row) for value, row in zip(values[weak], rows[weak], strict=True)]
    for relative, row in named:
        vector, words = _describe(row, inertia, scaled)
        sigma = relative * size * float(np.abs(vector).max())
        found.append(Direction(words, vector * size, sigma, relative, _REMEDY))
    around = (3, len(triangle) - 9)
    found = [replace(one, parameters=np.pad(one.parameters, around)) for one in found]
    return tuple(sorted(found, key=lambda one: -one.relative))


def _scale_direction(inertia: Floats, size: float) -> Direction:
    vector = np.array([inertia[i, j] for i, j in ELEMENTS])
    return Direction(_SCALE, vector * (size / np.linalg.norm(vector)), math.inf, math.inf, _SCALE_REMEDY)


def _describe(vector: Floats, inertia: Floats, scaled: bool) -> tuple[Floats, str]:
    """Return a direction of the tensor and its words.

    Without a scale a multiple of the tensor changes nothing, and the multiple with the fewest parts is taken.
    """
    own = np.array([inertia[i, j] for i, j in ELEMENTS])
    tries = [vector]
    if not scaled:
        moments, axes = np.linalg.eigh(inertia)
        along = np.einsum("ik,ij,jk->k", axes, tensor_of(vector), axes)
        tries += [vector - one / moment * own for one, moment in zip(along, moments, strict=True)]
    best, words, fewest = vector, "", math.inf
    for one in tries:
        size = float(np.linalg.norm(tensor_of(one)))
        if not size > 1e-3 * np.linalg.norm(vector):
            continue
        moments, axes = np.linalg.eigh(tensor_of(one) / size)
        order = np.argsort(-np.abs(moments))
        parts = float(np.abs(moments[order[1:]]).sum())
        if parts < fewest:
            best, fewest = one, parts
            if abs(moments[order[1]]) < 2.0 * _SHARE:
                axis = axes[:, order[0]]
                axis = axis * np.sign(axis[np.argmax(np.abs(axis))])
                words = f"the moment about {_axis_words(axis)}"
            else:
                words = _mixed(one)
    return best * (np.linalg.norm(vector) / np.linalg.norm(best)), words


def _axis_words(axis: Floats) -> str:
    for k, name in enumerate(_AXES):
        if abs(axis[k]) > 0.999:
            return name
    x, y, z = (f"{one + 0.0:.2g}" for one in axis.round(2))
    return f"({x}, {y}, {z})"


def _mixed(vector: Floats) -> str:
    most = float(np.abs(vector).max())
    parts = [name for name, x in zip(NUMBERS[4:], vector, strict=True) if abs(x) > _SHARE * most]
    words = [
        f"the moment about {one[1]}" if one[1] == one[2] else f"the product of inertia {one[1:]}"
        for one in parts
    ]
    return words[0] if len(words) == 1 else f"a combination of {', '.join(words[:-1])} and {words[-1]}"


def _result(
    fit: dict[str, Any],
    known: dict[str, Any],
    mass: float,
    dropped: dict[str, int],
    rows: int | None = None,
) -> Identified:
    omega, elements = (np.array(fit[one]) for one in ("omega", "inertia"))
    momentum, scaled = np.array(known["momentum"]), _has_scale(known)
    triangle, edge = np.array(fit["triangle"]), bool(fit["at_edge"])
    inertia = np.asarray(tensor_of(elements))
    bound = _covariance(triangle, _allowed(inertia, scaled, False))
    covariance = _covariance(triangle, _allowed(inertia, scaled, True)) if edge else bound
    nothing = np.full((len(triangle), len(triangle)), np.nan)
    names = [f"omega_{one}" for one in _AXES] + list(NUMBERS[4:])
    values = [omega, elements]
    further: dict[str, Uncertain] = {}
    for name, key, is_there in (
        ("bias", "bias", known["bias"] is not False),
        ("scale", "gyro_scale", known["scale"]),
        ("turn", "attitude", known["attitude"] is not None),
        ("sensor_place", "place", known["specific_force"] is not None),
    ):
        if not is_there:
            continue
        # The small turn from the most likely first attitude is zero.
        value = np.zeros(3) if name == "turn" else np.array(fit[key])
        own = slice(len(names), len(names) + 3)
        names += [f"{name}_{one}" for one in _AXES]
        values.append(value)
        if covariance is not None:
            spread = covariance[own, own]
            further[name] = Uncertain(value, covariance=0.5 * (spread + spread.T))
    bare = body = RigidBody(mass=mass, inertia=inertia)
    if covariance is not None:
        whole = np.zeros((10, 10))
        whole[4:, 4:] = covariance[3:9, 3:9]
        body = body.with_covariance(0.5 * (whole + whole.T))
    estimated = known["sigma"] is None
    logged = len(fit["residuals"]) if rows is None else rows
    count = _measured(known, logged)
    freedom = count - _unknowns(known)
    chi2 = float(fit["chi2"])
    has_p = rows is None and not estimated and not known["student"]
    sigmas = np.array(fit["sigma"])
    still, attitude = np.zeros(3), np.array(fit["attitude"])
    motion: FreeMotion | GyrostatMotion | None
    if any(known["torque"]):
        motion = None
    elif momentum.any():
        # A gyrostat's motion carries no sigmas.
        motion = bare.gyrostat(momentum).free_motion(omega, attitude)
    else:
        motion = body.free_motion(omega, attitude)
    sensors = ["omega", *(name for name in ("attitude", "specific_force") if known[name] is not None)]
    return Identified(
        body=body, parameters=tuple(names), estimate=np.concatenate(values),
        covariance=nothing if covariance is None else covariance, crlb=nothing if bound is None else bound,
        residuals=np.asarray(fit["residuals"]), chi2=chi2, degrees_of_freedom=freedom,
        p_value=p_value_of(chi2, freedom) if has_p else math.nan,
        noise=Uncertain(sigmas, sigmas / math.sqrt(6.0 * logged)) if estimated and rows is None else None,
        bias=further.get("bias"), scale=further.get("scale"), sensor_place=further.get("sensor_place"),
        columns=tuple(f"{name} {axis}" for name in sensors for axis in _AXES),
        at_edge=edge, linear=not edge, gap=0.0,
        observability=_directions(triangle, inertia, scaled), scale_known=scaled, dropped=dropped,
        start=State(omega, attitude, still, still),
        start_covariance=None if covariance is None else covariance[:3, :3], motion=motion,
    )  # fmt: skip
