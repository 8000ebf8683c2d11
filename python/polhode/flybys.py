"""Flybys of tumbling asteroids: how the spin of many clones changes when they pass a planet.

On 13 April 2029 the asteroid Apophis, which tumbles, passes the Earth inside the geostationary ring. The
phase of its tumbling at that time is not known. Clones with all phases and directions show the possible
results.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import wraps
from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple, TypeVar, cast

import numpy as np

from polhode import _core, distributions, loads
from polhode._format import short
from polhode._hints import check_kind
from polhode.ensembles.call import ensemble
from polhode.errors import PolhodeError
from polhode.orbits import Orbit
from polhode.uncertainty.propagation import propagate

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from polhode._core import FreeMotion, RigidBody, Uncertain
    from polhode._progress import Progress
    from polhode.ensembles.result import Ensemble
    from polhode.motion.trajectory import Trajectory
    from polhode.orbits import SampledOrbit

    Floats = NDArray[np.float64]

__all__ = ["Flyby", "Tumble", "clones", "flyby"]

F = TypeVar("F", bound="Callable[..., Any]")

ROUNDING: Final = 1e-9
"""Tolerance for a parabola: with rounding errors of its state it may be an ellipse."""


def _names_modes(function: F) -> F:
    """Make a call without `mode` raise an error that names the modes."""

    @wraps(function)
    def check_mode(*args: Any, **kwargs: Any) -> Any:
        if "mode" not in kwargs:
            raise TypeError(
                'mode: state which of the two motions has these periods: mode="long-axis", where the angular '
                'velocity circles the axis of the least moment, or mode="short-axis", where it circles that '
                "of the greatest"
            )
        return function(*args, **kwargs)

    return cast("F", check_mode)


class Tumble(NamedTuple):
    """Torque-free motion of the clones at a time.

    Attributes
    ----------
    mode : numpy.ndarray of str, shape (n,)
        Mode of each clone, as in :attr:`polhode.FreeMotion.mode`; empty for a clone that failed.
    rotation_period, precession_period : numpy.ndarray, shape (n,)
        P_ψ and P_φ; of a symmetric body those of its spin and of the precession of its axis. Infinite or NaN
        where the motion has none: see :class:`polhode.Periods`.
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
        """Return the share of each mode among the clones after the flyby."""
        names, counts = np.unique(self.after.mode[~self.failed], return_counts=True)
        return {
            str(name): float(count) / int(counts.sum()) for name, count in zip(names, counts, strict=True)
        }

    def __repr__(self) -> str:
        return f"Flyby({len(self.failed)} clones, {int(self.failed.sum())} failed)"


@_names_modes
def clones(
    body: RigidBody,
    orbit: Orbit | SampledOrbit,
    span: float,
    *,
    rotation_period: float | Uncertain,
    precession_period: float | Uncertain,
    mode: Literal["long-axis", "short-axis"],
    sense: Literal[1, -1] = 1,
    pole: ArrayLike | None = None,
    pole_sigma: float = 0.0,
    radius: float | None = None,
    n: int = 1000,
    seed: int = 0,
    **options: Any,
) -> Ensemble:
    """Make the ensemble of clones that :func:`flyby` runs, with random phases of the tumbling.

    Parameters
    ----------
    body : RigidBody
        One body; only the ratios of its moments matter. If it is uncertain, each clone has moments of its
        own.
    orbit : Orbit or SampledOrbit
        Orbit of the body about the planet: a parabola, a hyperbola or a table of positions.
    span : float
        Duration of the flyby. It begins at the epoch of the orbit, at 0 if it has none, or at the first time
        of a table.
    rotation_period, precession_period, mode, sense
        As for :meth:`polhode.RigidBody.free_motion_from_periods`. If a period is an `Uncertain`, each clone
        has one of its own, from a normal distribution.
    pole : array_like, shape (3,), optional
        Direction of the angular momentum in space; all directions by default.
    pole_sigma : float, optional
        Standard deviation of this direction along each of two axes perpendicular to it, in radians.
    radius : float, optional
        Radius of the planet: an orbit that comes nearer is refused. By default that of the orbit, if it is
        one about an oblate planet.
    n, seed
        As of :func:`polhode.ensemble`.
    **options
        Further arguments of :func:`polhode.ensemble`: `rtol`, `chunk`, `reduce`, `client`, `progress` …

    Returns
    -------
    Ensemble
        Of two times: start and end.

    Raises
    ------
    PolhodeError
        If the orbit is closed, or nearer to the centre of the planet than its radius; and as for
        :meth:`polhode.RigidBody.free_motion_from_periods`.
    """
    check_kind(body, "body", "RigidBody")
    long, spread = _number(span, "span"), _number(pole_sigma, "pole_sigma")
    if not long > 0.0:
        raise ValueError(f"span: must be positive, got {long}")
    if not spread >= 0.0:
        raise ValueError(f"pole_sigma: must not be negative, got {spread}")
    if pole is None and spread > 0.0:
        raise TypeError("pole_sigma: it is that of a direction; give pole= too")
    _check_orbit(orbit, None if radius is None else _number(radius, "radius"))
    motion = body.free_motion_from_periods(rotation_period, precession_period, mode, sense)
    if motion.shape:
        raise ValueError(f"body and periods: expected one of each, got a stack of shape {motion.shape}")
    numbers = _numbers(motion)
    if numbers is None:
        known = cast("float", rotation_period)
        phase = distributions.uniform(0.0, float(known), name="phase")
        bodies: Any = body
        start = distributions.apply(_at, motion, phase)
    else:
        share = distributions.uniform(0.0, 1.0, name="phase")
        bodies = distributions.apply(_bodies, body, numbers)
        start = distributions.apply(_start, bodies, numbers, mode, sense, share)
    if pole is None:
        attitude = distributions.apply(
            _turn_attitudes, start, distributions.uniform_rotation(name="direction")
        )
    else:
        toward = _core.real_numbers(pole, "pole")
        if toward.shape != (3,) or not np.isfinite(toward).all() or not toward.any():
            raise ValueError(f"pole: expected three numbers that are not all zero, got {toward.tolist()}")
        around = distributions.uniform(0.0, 2 * np.pi, name="azimuth")
        toward = toward / np.abs(toward).max()
        tilt = distributions.normal(np.zeros(2), sigma=spread, name="direction")
        attitude = distributions.apply(_toward, start, toward / np.linalg.norm(toward), around, tilt)
    return ensemble(
        bodies,
        [orbit.begins, orbit.begins + long],
        distributions.apply(_omega, start),
        attitude,
        loads.gravity_gradient(orbit),
        n=n,
        seed=seed,
        outputs=["omega", "quaternion"],
        **options,
    )


@_names_modes
def flyby(
    body: RigidBody,
    orbit: Orbit | SampledOrbit,
    span: float,
    *,
    rotation_period: float | Uncertain,
    precession_period: float | Uncertain,
    mode: Literal["long-axis", "short-axis"],
    n: int = 1000,
    seed: int = 0,
    progress: Progress = None,
    **options: Any,
) -> Flyby:
    """Simulate clones of a tumbling body that pass a planet, and compare their motion before and after.

    Parameters
    ----------
    body, orbit, span, rotation_period, precession_period, mode, n, seed
        As of :func:`clones`.
    progress : bool or callable, optional
        As in :func:`polhode.ensemble`.
    **options
        Further arguments of :func:`clones`: `sense`, `pole`, `pole_sigma`, `radius`, `rtol`, `client` …

    Returns
    -------
    Flyby

    Raises
    ------
    PolhodeError
        As :func:`clones`; and when all clones fail, with the message of the first.

    Examples
    --------
    >>> from polhode import RigidBody, flybys, orbits
    >>> day, hour = 86400.0, 3600.0
    >>> earth = orbits.from_elements(
    ...     398600.4418, eccentricity=4.253901873, periapsis=38011.486, since_periapsis=-3 * day
    ... )
    >>> apophis = RigidBody.from_principal(1.0, (0.64, 0.97, 1.0))
    >>> periods = {"rotation_period": 264.178 * hour, "precession_period": 27.38547 * hour}
    >>> found = flybys.flyby(apophis, earth, 6 * day, **periods, mode="short-axis", n=500)
    >>> bool(found.spin_ratio.min() < 0.8), bool(found.spin_ratio.max() > 1.2)
    (True, True)
    """
    check_kind(body, "body", "RigidBody")
    for name in ("reduce", "outputs"):
        if name in options:
            raise TypeError(
                f"{name}: flyby tells the start and the end of all clones; flybys.clones takes it"
            )
    given: dict[str, Any] = {
        "rotation_period": rotation_period, "precession_period": precession_period, "mode": mode,
    }  # fmt: skip
    many = clones(body, orbit, span, **given, n=n, seed=seed, progress=progress, **options)
    motion = body.free_motion_from_periods(rotation_period, precession_period, mode)
    found = _describe(body, _numbers(motion), seed, many.to_numpy())
    if found.failed.all():
        # Why tells a clone alone.
        clones(body, orbit, span, **given, n=1, seed=seed, on_failure="raise", **options).to_numpy()
    return found


def _check_orbit(orbit: Orbit | SampledOrbit, radius: float | None) -> None:
    """Refuse an orbit that is no flyby."""
    if isinstance(orbit, Orbit):
        elements = orbit.elements
        eccentricity = float(np.min(elements.eccentricity))
        if eccentricity < 1.0 - ROUNDING:
            raise PolhodeError(
                f"orbit: its eccentricity is {eccentricity:.6g}, that of an ellipse, on which the body goes "
                "round the planet; a flyby has 1 or more. For an ellipse call polhode.ensemble with "
                "load=loads.gravity_gradient(orbit)"
            )
        radius = orbit.radius if radius is None else radius
        least = float(np.min(elements.periapsis))
    else:
        least = float(np.linalg.norm(orbit.position, axis=-1).min())
    if radius is not None and not least > float(np.max(radius)):
        raise PolhodeError(
            f"orbit: the least distance from the planet's centre is {least:.6g}, within its radius of "
            f"{float(np.max(radius)):.6g}; give an orbit with a periapsis beyond it, or another radius="
        )


def _numbers(motion: FreeMotion) -> distributions.Normal | None:
    """Return the distribution of three moments and two periods, or None where they are known."""
    given = motion._from_periods
    if given is None:
        return None
    one = given.row((), 0)

    def five(body: RigidBody, *periods: Any) -> Floats:
        values = iter(periods)
        both = [next(values) if isinstance(x, _core.Uncertain) else x for x in one[:2]]
        return np.array([*body.principal_moments, *map(float, both)])

    found = propagate(five, motion.body, arguments=one.uncertain)
    return distributions.normal(found.value, found.covariance, name="moments and periods")


def _describe(
    body: RigidBody, numbers: distributions.Normal | None, seed: int, states: dict[str, Any]
) -> Flyby:
    """Describe how clones tumble at the start and at the end, from the states of their ensemble."""
    omega, quaternion = states["omega"], states["quaternion"]
    failed = ~np.isfinite(omega[:, -1]).all(axis=-1)
    drawn = None if numbers is None else numbers.draw(len(omega), seed=seed)
    before, after = (_tumble(body, drawn, omega[:, k], quaternion[:, k]) for k in (0, -1))
    return Flyby(body, before, after, failed)


def _tumble(body: RigidBody, drawn: Floats | None, omega: Floats, quaternion: Floats) -> Tumble:
    known: NDArray[np.bool_] = np.asarray(np.isfinite(omega).all(axis=-1))
    bodies = body if drawn is None else _bodies(body, drawn[known])
    motion = bodies.free_motion(omega[known], quaternion[known])
    momentum = motion.angular_momentum().spin
    periods = motion.periods

    def expand(values: Any, fill: Any) -> Any:
        values = np.asarray(values)
        found = np.full((len(known), *values.shape[1:]), fill, values.dtype)
        found[known] = values
        return found

    energy = np.asarray(bodies.kinetic_energy(omega[known]).rotational)
    return Tumble(
        expand(motion.mode, ""),
        expand(np.where(np.isnan(periods.spin), periods.rotation, periods.spin), np.nan),
        expand(periods.precession, np.nan),
        expand(2.0 * energy / np.linalg.norm(momentum, axis=-1), np.nan),
        expand(momentum, np.nan),
    )


def _number(given: Any, name: str) -> float:
    found = _core.real_numbers(given, name)
    if found.ndim or not np.isfinite(found):
        raise ValueError(f"{name}: expected one finite number, got {found.tolist()}")
    return float(found)


def _bodies(body: RigidBody, numbers: Floats) -> RigidBody:
    """Return the bodies of clones: the given body with other principal moments."""
    axes, center = body.principal.axes, body.center_of_mass
    return _core.RigidBody.from_principal(body.mass, numbers[..., :3], axes, center)


def _at(motion: FreeMotion, phase: Floats) -> Trajectory:
    return motion.at(phase)


def _start(bodies: RigidBody, numbers: Floats, mode: Any, sense: int, share: Floats) -> FreeMotion:
    """Return the motions of clones, each with its own moments and periods, at shares of a period."""
    return bodies.free_motion_from_periods(numbers[..., 3], numbers[..., 4], mode, sense, share)


def _omega(start: Trajectory | FreeMotion) -> Floats:
    return start.omega


def _turn_attitudes(start: Trajectory | FreeMotion, turn: Floats) -> Floats:
    """Return attitudes at the start, with L in any direction."""
    return _product(turn, start.quaternion)


def _toward(start: Trajectory | FreeMotion, pole: Floats, around: Floats, tilt: Floats) -> Floats:
    """Return attitudes at the start, with L near a direction."""
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
    return _product(turn, start.quaternion)


def _product(p: Floats, q: Floats) -> Floats:
    """Return p∘q of quaternions (x, y, z, w), at unit length."""
    a, s, b, t = p[..., :3], p[..., 3:], q[..., :3], q[..., 3:]
    vector = s * b + t * a + np.cross(a, b)
    found = np.concatenate([vector, s * t - np.sum(a * b, axis=-1, keepdims=True)], axis=-1)
    unit: Floats = found / np.linalg.norm(found, axis=-1, keepdims=True)
    return unit
