"""Flybys of tumbling asteroids: how the spin of many clones changes when they pass a planet.

On 13 April 2029 the asteroid Apophis, which tumbles, passes the Earth inside the geostationary ring. The
phase of its tumbling at that time is not known. Clones with all phases and directions show the possible
results. Where phase and direction are known before, :attr:`Flyby.forecast` has sigmas of what is after.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
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
from polhode.uncertainty.uncertain import join

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from polhode._core import FreeMotion, RigidBody, Uncertain
    from polhode._progress import Progress
    from polhode.ensembles.result import Ensemble
    from polhode.motion.trajectory import Trajectory
    from polhode.orbits import SampledOrbit

    Floats = NDArray[np.float64]

__all__ = ["Flyby", "Forecast", "Spread", "Tumble", "clones", "flyby"]

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


class Spread(NamedTuple):
    """A figure after a flyby, with its uncertainty.

    Attributes
    ----------
    value : float or numpy.ndarray
        Of the body with the given numbers.
    sigma : float or numpy.ndarray
        Standard deviation to first order; NaN unless `linear`. Of a direction, shape (2,): half axes of the
        ellipse of one standard deviation in radians, the larger one first.
    linear : bool
        Whether the first order is enough, to about a percent of `sigma`. If not, the quantiles say how wide
        the distribution is.
    low, median, high : float
        Quantiles of 5, 50 and 95 per cent of the clones. Of a direction: of the angle from `value`.
    """

    value: Any
    sigma: Any
    linear: bool
    low: float
    median: float
    high: float

    def __repr__(self) -> str:
        return short(self)


class Forecast(NamedTuple):
    """What is known of a body after a flyby if its attitude before is known: see :attr:`Flyby.forecast`.

    Attributes
    ----------
    rotation_period, precession_period, spin_ratio, pole_shift : Spread
        As of :class:`Tumble` and :class:`Flyby`.
    pole : Spread
        Direction of L in space after the flyby, shape (3,).
    """

    rotation_period: Spread
    precession_period: Spread
    spin_ratio: Spread
    pole_shift: Spread
    pole: Spread

    @property
    def linear(self) -> bool:
        """Whether all figures have a sigma."""
        return all(one.linear for one in self)

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
    forecast : Forecast or None
        Periods, spin and pole after the flyby with their sigmas; None unless `phase`, `azimuth` and `pole`
        were given, and something of them or of body and periods is uncertain.
    """

    body: RigidBody
    before: Tumble
    after: Tumble
    failed: NDArray[np.bool_]
    forecast: Forecast | None = None

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
    phase: float | Uncertain | None = None,
    azimuth: float | Uncertain | None = None,
    pole: ArrayLike | None = None,
    pole_sigma: float = 0.0,
    radius: float | None = None,
    n: int = 1000,
    seed: int = 0,
    **options: Any,
) -> Ensemble:
    """Make the ensemble of clones that :func:`flyby` runs, with random phases of the tumbling or a known one.

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
    phase : float or Uncertain, optional
        Phase at the start, as of :meth:`polhode.RigidBody.free_motion_from_periods`; all phases by default.
    azimuth : float or Uncertain, optional
        Angle about `pole`, in radians, by which the body is turned at the start from the attitude that
        :meth:`polhode.RigidBody.free_motion_from_periods` gives to this phase and direction; all angles by
        default. It needs `pole`.
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
    if pole is None and azimuth is not None:
        raise TypeError("azimuth: it is an angle about the pole; give pole= too")
    _check_orbit(orbit, None if radius is None else _number(radius, "radius"))
    start = _read_start(body, rotation_period, precession_period, mode, sense, phase, azimuth)
    bodies, motion, around = start.draws()
    if pole is None:
        attitude = distributions.apply(
            _turn_attitudes, motion, distributions.uniform_rotation(name="direction")
        )
    else:
        tilt = distributions.normal(np.zeros(2), sigma=spread, name="direction")
        attitude = distributions.apply(_toward, motion, _direction(pole), around, tilt, azimuth is not None)
    return ensemble(
        bodies,
        [orbit.begins, orbit.begins + long],
        distributions.apply(_omega, motion),
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
    sense: Literal[1, -1] = 1,
    phase: float | Uncertain | None = None,
    azimuth: float | Uncertain | None = None,
    pole: ArrayLike | None = None,
    pole_sigma: float = 0.0,
    n: int = 1000,
    seed: int = 0,
    progress: Progress = None,
    **options: Any,
) -> Flyby:
    """Simulate clones of a tumbling body that pass a planet, and compare their motion before and after.

    Parameters
    ----------
    body, orbit, span, rotation_period, precession_period, mode, sense, phase, azimuth, pole, pole_sigma
        As of :func:`clones`.
    n, seed
        As of :func:`clones`.
    progress : bool or callable, optional
        As in :func:`polhode.ensemble`.
    **options
        Further arguments of :func:`clones`: `radius`, `rtol`, `client` …

    Returns
    -------
    Flyby
        With `phase`, `azimuth` and `pole` it has a forecast: sigmas of the figures after the flyby.

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

    The attitude three days before the passage may be known, from a campaign of observations. With a sigma of
    the period the forecast has one:

    >>> from polhode import Uncertain
    >>> periods["precession_period"] = Uncertain(27.38547 * hour, 5.0)
    >>> known = {"phase": 0.3, "azimuth": 0.7, "pole": (0.2, 0.1, -1.0)}
    >>> found = flybys.flyby(apophis, earth, 6 * day, **periods, **known, mode="short-axis", n=500)
    >>> found.forecast.spin_ratio.linear
    True
    """
    check_kind(body, "body", "RigidBody")
    for name in ("reduce", "outputs"):
        if name in options:
            raise TypeError(
                f"{name}: flyby tells the start and the end of all clones; flybys.clones takes it"
            )
    given: dict[str, Any] = {
        "rotation_period": rotation_period, "precession_period": precession_period, "mode": mode,
        "sense": sense, "phase": phase, "azimuth": azimuth, "pole": pole, "pole_sigma": pole_sigma,
    }  # fmt: skip
    many = clones(body, orbit, span, **given, n=n, seed=seed, progress=progress, **options)
    start = _read_start(body, rotation_period, precession_period, mode, sense, phase, azimuth)
    found = _describe(body, start.numbers, seed, many.to_numpy())
    if found.failed.all():
        # Why tells a clone alone.
        clones(body, orbit, span, **given, n=1, seed=seed, on_failure="raise", **options).to_numpy()
    if pole is None or phase is None or azimuth is None or (start.numbers is None and not pole_sigma):
        return found
    return replace(found, forecast=_forecast(found, start, orbit, span, _direction(pole), pole_sigma))


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
        radius = orbit.radius if radius is None else radius
    if radius is not None and not least > float(np.max(radius)):
        raise PolhodeError(
            f"orbit: the least distance from the planet's centre is {least:.6g}, within its radius of "
            f"{float(np.max(radius)):.6g}; give an orbit with a periapsis beyond it, or another radius="
        )


class _Start(NamedTuple):
    """How clones start: their moments, periods, phase, and azimuth about the pole."""

    body: RigidBody
    motion: FreeMotion
    periods: tuple[float, float]
    mode: Literal["long-axis", "short-axis"]
    sense: Literal[1, -1]
    phase: Any
    azimuth: Any
    numbers: distributions.Normal | None
    covariance: Floats
    """Of `numbers`: three moments and two periods, then phase and azimuth if they are uncertain."""

    def angle(self, given: Any, column: int, drawn: Any) -> Any:
        """Return a phase or an azimuth: as it was given, or of clones with these numbers."""
        if not isinstance(given, _core.Uncertain):
            return given
        if isinstance(drawn, distributions.Distribution):
            return distributions.apply(_column, drawn, column)
        return drawn[..., column]

    def angles(self, drawn: Any) -> tuple[Any, Any]:
        """Return phase and azimuth of clones with these numbers; None for all that there are."""
        both = isinstance(self.azimuth, _core.Uncertain)
        return self.angle(self.phase, -2 if both else -1, drawn), self.angle(self.azimuth, -1, drawn)

    def draws(self) -> tuple[Any, Any, Any]:
        """Return distributions of bodies, of their motions with L along z, and of the azimuth."""
        share, around = self.angles(self.numbers)
        if around is None:
            around = distributions.uniform(0.0, 2 * np.pi, name="azimuth")
        if self.numbers is None and share is None and self.azimuth is None:
            phase = distributions.uniform(0.0, self.periods[0], name="phase")
            return self.body, distributions.apply(_at, self.motion, phase), around
        if share is None:
            share = distributions.uniform(0.0, 1.0, name="phase")
        drawn: Any = self.known if self.numbers is None else self.numbers
        bodies: Any = self.body
        if self.numbers is not None:
            bodies = distributions.apply(_bodies, self.body, drawn)
        motion = distributions.apply(_start, bodies, drawn, self.mode, self.sense, share)
        return bodies, motion, around

    @property
    def known(self) -> Floats:
        """Moments and periods, without their sigmas."""
        return np.array([*self.body.principal_moments, *self.periods])

    def one(self, drawn: Floats | None) -> tuple[RigidBody, FreeMotion, float]:
        """Return body, motion and azimuth of one clone with known angles."""
        share, around = self.angles(drawn)
        body = self.body if drawn is None else _bodies(self.body, drawn)
        given = self.known if drawn is None else drawn
        return body, _start(body, given, self.mode, self.sense, share), around


def _read_start(
    body: RigidBody,
    rotation: float | Uncertain,
    precession: float | Uncertain,
    mode: Literal["long-axis", "short-axis"],
    sense: Literal[1, -1],
    phase: Any,
    azimuth: Any,
) -> _Start:
    motion = body.free_motion_from_periods(rotation, precession, mode, sense)
    if motion.shape:
        raise ValueError(f"body and periods: expected one of each, got a stack of shape {motion.shape}")
    phase, azimuth = _angle(phase, "phase"), _angle(azimuth, "azimuth")
    given = motion._from_periods
    periods: tuple[Any, ...] = (rotation, precession) if given is None else given.row((), 0)[:2]
    known = [float(one.value if isinstance(one, _core.Uncertain) else one) for one in periods]
    doubts = [one for one in (*periods, phase, azimuth) if isinstance(one, _core.Uncertain)]
    numbers, covariance = None, np.zeros((0, 0))
    if body.covariance is not None or doubts:

        def of(body: RigidBody, *uncertain: Any) -> Floats:
            values = iter(uncertain)
            both = [next(values) if isinstance(x, _core.Uncertain) else x for x in periods]
            return np.array([*body.principal_moments, *map(float, both), *map(float, values)])

        found = propagate(of, body, arguments=doubts)
        numbers = distributions.normal(found.value, found.covariance, name="moments and periods")
        covariance = found.covariance
    return _Start(body, motion, (known[0], known[1]), mode, sense, phase, azimuth, numbers, covariance)


SHARES: Final = (0.05, 0.5, 0.95)
RTOL: Final = 1e-12
"""Of the motions whose differences are derivatives."""
ENOUGH: Final = 0.02
"""Part by which the standard deviation of clones may differ from that to first order, beside chance."""
NOISE: Final = 1e-9
"""Deviation of a figure, relative to its scale, that may be an error of integration."""
CHANCE: Final = 4.0
"""How many standard deviations of its own that of the clones may be off by chance."""


def _forecast(
    found: Flyby, start: _Start, orbit: Orbit | SampledOrbit, span: float, pole: Floats, pole_sigma: float
) -> Forecast:
    """Propagate what is uncertain before a flyby to what is after, beside the clones."""
    times = [orbit.begins, orbit.begins + float(span)]
    load = loads.gravity_gradient(orbit)
    doubts: list[Any] = []
    if start.numbers is not None:
        doubts.append(_core.Uncertain(start.numbers.mean, covariance=start.covariance))
    if pole_sigma:
        doubts.append(_core.Uncertain(np.zeros(2), float(pole_sigma)))

    def after(*values: Any) -> tuple[Floats, Floats]:
        drawn = iter(values)
        body, motion, around = start.one(None if start.numbers is None else next(drawn))
        tilt = np.asarray(next(drawn, np.zeros(2)))
        attitude = _toward(motion, pole, np.array([around]), tilt[np.newaxis], True)
        run = body.simulate(times, motion.omega.reshape(1, 3), attitude, load=load, rtol=RTOL)
        first, last = (_tumble(body, None, run.omega[:, k], run.quaternion[:, k]) for k in (0, -1))
        one = Flyby(body, first, last, failed=np.zeros(1, bool))
        return _figures(one)[:, 0], _unit(one.after.momentum)[0]

    figures, toward = after(*(doubt.value for doubt in doubts))
    sides = _across(toward)

    def numbers(*values: Any) -> Floats:
        these, direction = after(*values)
        return np.array([*these, *_tilts(direction, toward, sides)])

    result = propagate(numbers, None, arguments=doubts)
    sigma, linear = np.asarray(result.sigma), np.asarray(result.linear)
    drawn_figures = np.array([*_figures(found), *_tilts(_unit(found.after.momentum), toward, sides).T])
    drawn_figures = drawn_figures[:, ~found.failed]
    is_one = not found.failed.any() and len(found.modes()) == 1
    scales = [*figures[:2], 1.0, 1.0, 1.0, 1.0]
    fits = [
        is_one and _fit(values, wide, bool(ok), scale)
        for values, wide, ok, scale in zip(drawn_figures, sigma, linear, scales, strict=True)
    ]
    ellipse = np.sqrt(np.maximum(np.linalg.eigvalsh(result.covariance[4:, 4:])[::-1], 0.0))
    spreads = [
        Spread(float(value), float(wide) if ok else np.nan, ok, *_quantiles(these))
        for value, wide, ok, these in zip(figures, sigma[:4], fits[:4], drawn_figures[:4], strict=True)
    ]
    is_linear = all(fits[4:])
    off = np.hypot(*drawn_figures[4:])
    direction = Spread(toward, ellipse if is_linear else np.full(2, np.nan), is_linear, *_quantiles(off))
    rotation, precession, spin, shift = spreads
    return Forecast(rotation, precession, spin, shift, direction)


def _figures(found: Flyby) -> Floats:
    """Return the four figures of clones, shape (4, n)."""
    after = found.after
    return np.array([after.rotation_period, after.precession_period, found.spin_ratio, found.pole_shift])


def _fit(values: Floats, sigma: float, is_linear: bool, scale: float) -> bool:
    """Return whether the deviation of clones is that to first order, but for chance and rounding."""
    seen = float(np.std(values))
    if max(seen, sigma) <= NOISE * scale:
        return True
    allowed = ENOUGH + CHANCE / np.sqrt(2.0 * max(values.size - 1, 1))
    return is_linear and bool(abs(seen - sigma) <= allowed * sigma)


def _quantiles(values: Floats) -> tuple[float, float, float]:
    low, median, high = np.quantile(values, SHARES).tolist()
    return low, median, high


def _unit(vectors: Floats) -> Floats:
    found: Floats = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return found


def _across(direction: Floats) -> Floats:
    """Return two unit vectors perpendicular to a direction and to each other."""
    side = np.eye(3)[int(np.argmin(np.abs(direction)))]
    one = np.cross(direction, side) / np.linalg.norm(np.cross(direction, side))
    return np.stack([one, np.cross(direction, one)])


def _tilts(directions: Floats, toward: Floats, sides: Floats) -> Floats:
    """Return the angles of directions from one of them, along two sides."""
    across = directions @ sides.T
    size = np.linalg.norm(across, axis=-1, keepdims=True)
    angle = np.arctan2(size, (directions @ toward)[..., np.newaxis])
    found: Floats = across * np.where(size > 0.0, angle / np.where(size > 0.0, size, 1.0), 1.0)
    return found


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


def _angle(given: Any, name: str) -> Any:
    """Return a known angle as a float, an uncertain one as `Uncertain`; None as it is."""
    if given is None:
        return None
    found = given if isinstance(given, _core.Uncertain) else join(given)
    if found is None:
        return _number(given, name)
    if np.shape(found.value):
        raise ValueError(f"{name}: expected one number, got the shape {np.shape(found.value)}")
    return found


def _direction(pole: ArrayLike) -> Floats:
    """Return the unit vector along a pole."""
    toward = _core.real_numbers(pole, "pole")
    if toward.shape != (3,) or not np.isfinite(toward).all() or not toward.any():
        raise ValueError(f"pole: expected three numbers that are not all zero, got {toward.tolist()}")
    return _unit(toward / np.abs(toward).max())


def _column(numbers: Floats, column: int) -> Floats:
    return numbers[..., column]


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


def _toward(
    start: Trajectory | FreeMotion, pole: Floats, around: Any, tilt: Floats, is_counted: bool
) -> Floats:
    """Return attitudes at the start, with L near a direction.

    If the angles `around` are counted, zero is the attitude of a motion from periods: by the shortest turn.
    """
    one, two = _across(pole)
    # The shortest turn to the pole from z; or from -z, where that is nearer and half a turn about x leads.
    near = np.array([0.0, 0.0, 1.0 if pole[2] >= 0.0 else -1.0])
    aligned = np.array([*np.cross(near, pole), 1.0 + near @ pole])
    if pole[2] < 0.0:
        aligned = _product(aligned, np.array([1.0, 0.0, 0.0, 0.0]))
        if is_counted and (pole[0] or pole[1]):
            around = around - (2 * np.arctan2(pole[1], pole[0]) + np.pi)
    around = np.asarray(around)
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
