"""Flybys of tumbling asteroids: how the spin of many clones changes when they pass a planet.

On 13 April 2029 the asteroid Apophis, which tumbles, passes the Earth inside the geostationary ring. The
phase of its tumbling at that time is not known. Clones with all phases and directions show the possible
results.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from polhode import _core, distributions, loads
from polhode._repr import short
from polhode.ensembles.call import ensemble

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode._core import FreeMotion, RigidBody
    from polhode._progress import Progress
    from polhode.ensembles.result import Ensemble
    from polhode.orbits import Orbit, SampledOrbit

    Floats = NDArray[np.float64]

__all__ = ["Flyby", "Tumble", "clones", "flyby"]


class Tumble(NamedTuple):
    """Torque-free motion of the clones at a time.

    Attributes
    ----------
    mode : numpy.ndarray of str, shape (n,)
        Mode of each clone, as in :attr:`polhode.FreeMotion.mode`; empty for a clone that failed.
    rotation_period, precession_period : numpy.ndarray, shape (n,)
        P_ψ and P_φ.
    spin_rate : numpy.ndarray, shape (n,)
        ``2 E/|L|``: the rate of a steady spin with this energy and angular momentum, in radians per unit of
        time.
    momentum : numpy.ndarray, shape (n, 3)
        L in space.
    """

    mode: NDArray[np.str_]
    rotation_period: Floats
    precession_period: Floats
    spin_rate: Floats
    momentum: Floats

    def __repr__(self) -> str:
        return short(self)


@dataclass(frozen=True, eq=False)
class Flyby:
    """Clones of a body before and after a flyby.

    Attributes
    ----------
    body : RigidBody
        The body that the clones are copies of.
    before, after : Tumble
        Their motion at the start and at the end.
    failed : numpy.ndarray of bool, shape (n,)
        Clones whose integration failed. Their other fields are NaN.
    """

    body: RigidBody
    before: Tumble
    after: Tumble
    failed: NDArray[np.bool_]

    @property
    def spin_ratio(self) -> Floats:
        """Spin rate after the flyby divided by that before."""
        return self.after.spin_rate / self.before.spin_rate

    @property
    def pole_shift(self) -> Floats:
        """The angle between L before and after, in radians."""
        a, b = self.before.momentum, self.after.momentum
        across = np.linalg.norm(np.cross(a, b), axis=-1)
        found: Floats = np.arctan2(across, np.sum(a * b, axis=-1))
        return found

    def modes(self) -> dict[str, float]:
        """Give the share of each mode among the clones after the flyby."""
        names, counts = np.unique(self.after.mode[~self.failed], return_counts=True)
        return {
            str(name): float(count) / int(counts.sum()) for name, count in zip(names, counts, strict=True)
        }

    def __repr__(self) -> str:
        return f"Flyby({len(self.failed)} clones, {int(self.failed.sum())} failed)"


def clones(
    body: RigidBody,
    orbit: Orbit | SampledOrbit,
    span: float,
    *,
    rotation_period: float,
    precession_period: float,
    mode: Literal["long-axis", "short-axis"] = "short-axis",
    sense: Literal[1, -1] = 1,
    pole: ArrayLike | None = None,
    pole_sigma: float = 0.0,
    n: int = 1000,
    seed: int = 0,
    **options: Any,
) -> Ensemble:
    """Make the ensemble of clones that :func:`flyby` runs, with random phases of the tumbling.

    Parameters
    ----------
    body : RigidBody
        One body; only the ratios of its moments matter.
    orbit : Orbit or SampledOrbit
        Orbit of the body about the planet.
    span : float
        Duration of the flyby. It begins at the epoch of the orbit, at 0 if it has none, or at the first time
        of a table.
    rotation_period, precession_period, mode, sense
        As for :meth:`polhode.RigidBody.free_motion_from_periods`.
    pole : array_like, shape (3,), optional
        Direction of the angular momentum in space; all directions by default.
    pole_sigma : float, optional
        Standard deviation of this direction along each of two axes perpendicular to it, in radians.
    n, seed
        As of :func:`polhode.ensemble`.
    **options
        Further arguments of :func:`polhode.ensemble`: `rtol`, `chunk`, `reduce`, `client`, `progress` …

    Returns
    -------
    Ensemble
        Of two times: start and end.
    """
    motion = body.free_motion_from_periods(rotation_period, precession_period, mode=mode, sense=sense)
    if motion.shape:
        raise ValueError(f"body and periods: expected one of each, got a stack of shape {motion.shape}")
    long, spread = _number(span, "span"), _number(pole_sigma, "pole_sigma")
    if not long > 0.0:
        raise ValueError(f"span: must be positive, got {long}")
    if not spread >= 0.0:
        raise ValueError(f"pole_sigma: must not be negative, got {spread}")
    if pole is None and spread > 0.0:
        raise TypeError("pole_sigma: it is that of a direction; give pole= too")
    phase = distributions.uniform(0.0, float(rotation_period), name="phase")
    if pole is None:
        attitude = distributions.made(
            _turned, motion, phase, distributions.uniform_rotation(name="direction")
        )
    else:
        toward = _core.real_numbers(pole, "pole")
        if toward.shape != (3,) or not np.isfinite(toward).all() or not toward.any():
            raise ValueError(f"pole: expected three numbers that are not all zero, got {toward.tolist()}")
        around = distributions.uniform(0.0, 2 * np.pi, name="azimuth")
        toward = toward / np.abs(toward).max()
        tilt = distributions.normal(np.zeros(2), sigma=spread, name="direction")
        attitude = distributions.made(_toward, motion, phase, toward / np.linalg.norm(toward), around, tilt)
    return ensemble(
        body,
        [orbit.begins, orbit.begins + long],
        distributions.made(_omega, motion, phase),
        attitude,
        loads.gravity_gradient(orbit),
        n=n,
        seed=seed,
        outputs=["omega", "quaternion"],
        **options,
    )


def flyby(
    body: RigidBody,
    orbit: Orbit | SampledOrbit,
    span: float,
    *,
    rotation_period: float,
    precession_period: float,
    n: int = 1000,
    seed: int = 0,
    progress: Progress = None,
    **options: Any,
) -> Flyby:
    """Simulate clones of a tumbling body that pass a planet, and give their motion before and after.

    Parameters
    ----------
    body, orbit, span, rotation_period, precession_period, n, seed
        As of :func:`clones`.
    progress : bool or callable, optional
        As in :func:`polhode.ensemble`.
    **options
        Further arguments of :func:`clones`: `mode`, `sense`, `pole`, `pole_sigma`, `rtol`, `client` …

    Returns
    -------
    Flyby

    Raises
    ------
    PolhodeError
        When all clones fail; the message is that of the first.

    Examples
    --------
    >>> from polhode import RigidBody, flybys, orbits
    >>> day, hour = 86400.0, 3600.0
    >>> earth = orbits.from_elements(
    ...     398600.4418, eccentricity=4.253901873, periapsis=38011.486, since_periapsis=-3 * day
    ... )
    >>> apophis = RigidBody.from_principal(1.0, (0.64, 0.97, 1.0))
    >>> found = flybys.flyby(
    ...     apophis, earth, 6 * day, rotation_period=264.178 * hour, precession_period=27.38547 * hour, n=500
    ... )
    >>> bool(found.spin_ratio.min() < 0.8), bool(found.spin_ratio.max() > 1.2)
    (True, True)
    """
    for name in ("reduce", "outputs"):
        if name in options:
            raise TypeError(
                f"{name}: flyby tells the start and the end of all clones; flybys.clones takes it"
            )
    many = clones(
        body,
        orbit,
        span,
        rotation_period=rotation_period,
        precession_period=precession_period,
        n=n,
        seed=seed,
        progress=progress,
        **options,
    )
    found = _told(body, many.compute())
    if found.failed.all():
        # Why tells a clone alone.
        alone = {"rotation_period": rotation_period, "precession_period": precession_period, "seed": seed}
        clones(body, orbit, span, n=1, on_failure="raise", **alone | options).compute()
    return found


def _told(body: RigidBody, states: Any) -> Flyby:
    """Tell how clones tumble at the start and at the end, from the states of their ensemble."""
    omega, quaternion = states.omega.to_numpy(), states.quaternion.to_numpy()
    failed = ~np.isfinite(omega[:, -1]).all(axis=-1)
    before, after = (_tumble(body, omega[:, k], quaternion[:, k]) for k in (0, -1))
    return Flyby(body, before, after, failed)


def _tumble(body: RigidBody, omega: Floats, quaternion: Floats) -> Tumble:
    known: NDArray[np.bool_] = np.asarray(np.isfinite(omega).all(axis=-1))
    motion = body.free_motion(omega[known], quaternion[known])
    momentum = motion.angular_momentum

    def spread(values: Any, fill: Any) -> Any:
        values = np.asarray(values)
        found = np.full((len(known), *values.shape[1:]), fill, values.dtype)
        found[known] = values
        return found

    energy = np.asarray(body.kinetic_energy(omega[known]).rotational)
    return Tumble(
        spread(motion.mode, ""),
        spread(motion.periods.rotation, np.nan),
        spread(motion.periods.precession, np.nan),
        spread(2.0 * energy / np.linalg.norm(momentum, axis=-1), np.nan),
        spread(momentum, np.nan),
    )


def _number(given: Any, name: str) -> float:
    found = _core.real_numbers(given, name)
    if found.ndim or not np.isfinite(found):
        raise ValueError(f"{name}: expected one finite number, got {found.tolist()}")
    return float(found)


def _omega(motion: FreeMotion, phase: Floats) -> Floats:
    return motion.at(phase).omega


def _turned(motion: FreeMotion, phase: Floats, turn: Floats) -> Floats:
    """Attitudes at phases, with L in any direction."""
    return _product(turn, motion.at(phase).quaternion)


def _toward(motion: FreeMotion, phase: Floats, pole: Floats, around: Floats, tilt: Floats) -> Floats:
    """Attitudes at phases, with L near a direction."""
    side = np.eye(3)[int(np.argmin(np.abs(pole)))]
    one = np.cross(pole, side) / np.linalg.norm(np.cross(pole, side))
    two = np.cross(pole, one)
    # The shortest turn to the pole from z; or from -z, where that is nearer and half a turn about x leads.
    near = np.array([0.0, 0.0, 1.0 if pole[2] >= 0.0 else -1.0])
    aligned = np.array([*np.cross(near, pole), 1.0 + near @ pole])
    if pole[2] < 0.0:
        aligned = _product(aligned, np.array([1.0, 0.0, 0.0, 0.0]))
    spun = np.stack([0 * around, 0 * around, np.sin(around / 2), np.cos(around / 2)], axis=-1)
    angle = np.linalg.norm(tilt, axis=-1)
    share = 0.5 * np.sinc(angle / (2 * np.pi))  # sin(angle/2)/angle
    leaning = np.concatenate(
        [(tilt @ np.stack([one, two])) * share[:, None], np.cos(angle / 2)[:, None]], axis=-1
    )
    turn = _product(_product(leaning, aligned), spun)
    return _product(turn, motion.at(phase).quaternion)


def _product(p: Floats, q: Floats) -> Floats:
    """Give p∘q of quaternions (x, y, z, w), at unit length."""
    a, s, b, t = p[..., :3], p[..., 3:], q[..., :3], q[..., 3:]
    vector = s * b + t * a + np.cross(a, b)
    found = np.concatenate([vector, s * t - np.sum(a * b, axis=-1, keepdims=True)], axis=-1)
    unit: Floats = found / np.linalg.norm(found, axis=-1, keepdims=True)
    return unit
