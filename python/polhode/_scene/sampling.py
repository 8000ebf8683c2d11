"""The times at which a motion is drawn: so close that the picture shows what happens.

From one picture to the next a body seems to turn the shorter way: by more than half a turn it seems to turn
backward. And a curve through too few points cuts through the surface on which it lies. So pictures follow the
motion, not the length of the time over which it is shown.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from polhode import _core

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from polhode import FreeMotion, GyrostatMotion, HeavyTop

    Floats = NDArray[np.float64]

__all__ = [
    "CHORD",
    "COARSE",
    "MOST",
    "TURN",
    "Span",
    "axis_times",
    "drawn_times",
    "fastest",
    "follow",
    "motion_times",
    "once_round",
    "turns",
]

TURN: Final = float(np.deg2rad(20.0))
"""From one picture to the next a body turns by this at most, where the times are ours to choose."""
COARSE: Final = float(np.deg2rad(30.0))
"""Past this between two pictures the user is told; past half a turn nothing is drawn."""
CHORD: Final = 0.002
"""How deep a chord of a drawn curve may cut, of the size of what it lies on: half a pixel."""
MOST: Final = 12_000
"""Points of a curve that a browser still draws smoothly."""
_DRAWN: Final = 50_000
"""Points of a curve in a picture that does not move."""
_PER_NUTATION: Final = 24
_PER_PERIOD: Final = 1440
"""States in which the fastest of a gyrostat is looked for."""
_GROWTHS: Final = 40.0
"""In so many times of growth by e a departure goes from rounding to its full size."""


class Span(NamedTuple):
    """Times that were chosen.

    Attributes
    ----------
    t : numpy.ndarray, shape (T,)
        From the start on.
    is_whole : bool
        Whether they reach the end; else so many would have been too many.
    """

    t: Floats
    is_whole: bool


def turns(t: Floats, omega: Floats) -> Floats:
    """Angles by which a body turns from each time to the next, at the greater of both rates, shape (T - 1,).

    Parameters
    ----------
    t : numpy.ndarray, shape (T,)
    omega : numpy.ndarray, shape (T, 3)
    """
    rate = np.linalg.norm(omega, axis=-1)
    angles: Floats = np.maximum(rate[1:], rate[:-1]) * np.abs(np.diff(t))
    return angles


def fastest(motion: FreeMotion | HeavyTop | GyrostatMotion) -> float:
    """Find the greatest angular velocity of one body's motion at any time."""
    if isinstance(motion, _core.FreeMotion):
        return float(np.linalg.norm(motion.polhode(721), axis=-1).max())
    if isinstance(motion, _core.GyrostatMotion):
        return float(np.linalg.norm(motion.at(once_round(motion)).omega, axis=-1).max())
    # The energy: ½ I_t ω_t² + m g l cos θ is constant, as is the rate about the axis.
    body, start = motion.body, motion.at([0.0])
    center = body.center_of_mass
    arm, gravity = float(np.linalg.norm(center)), motion.gravity
    square = float(motion.omega @ motion.omega)
    if not arm > 0.0:
        return float(np.sqrt(square))
    axis, tensor = center / arm, body.inertia_about("origin")
    transverse = 0.5 * (np.trace(tensor) - axis @ tensor @ axis)
    height = -float(start.point("center_of_mass")[0] @ gravity)
    lowest = arm * float(np.linalg.norm(gravity)) * np.cos(motion.nutation_limits[1])
    return float(np.sqrt(square + 2.0 * float(body.mass) * max(0.0, height - lowest) / transverse))


def once_round(motion: GyrostatMotion) -> Floats:
    """Give times in which ω of one gyrostat comes to every place in the body to which it ever comes."""
    period = float(motion.period)
    if str(motion.mode) == "steady":
        return np.zeros(1)
    if np.isfinite(period):
        return np.linspace(0.0, period, _PER_PERIOD + 1)
    reach = _GROWTHS / _quickest(motion)
    return np.linspace(-reach, reach, _PER_PERIOD + 1)


def _quickest(motion: GyrostatMotion) -> float:
    """Find the greatest rate at which L circles about an equilibrium of one gyrostat, or departs from it."""
    if str(motion.mode) == "steady":
        return 0.0
    return float(np.sqrt(np.abs(motion.equilibria.squared_rate).max()))


def follow(
    curve: Callable[[Floats], Floats], t: Floats, *, step: float, most: int = MOST, chord: float = CHORD
) -> Span:
    """Put times between those given, so that the chords of curves stay near them.

    Parameters
    ----------
    curve : callable
        Of times (T,), points (T, n, 3) of n curves, each on something of size 1.
    t : numpy.ndarray, shape (T,)
        Rising or falling; the start and the end are enough. All of them are kept, as far as they are reached.
    step : float
        Times are never farther from each other; the curves have to be smooth over it.
    most : int
        How many times at most.
    chord : float
        Between two of them no curve strays farther from its chord.

    Returns
    -------
    Span
    """
    t, is_whole = _divided(t, step, most)
    points = curve(t)
    checked = np.zeros(len(t) - 1, dtype=bool)  # intervals whose chords are near enough
    while not checked.all():
        asked = np.flatnonzero(~checked)
        low, high = t[asked], t[asked + 1]
        middle = 0.5 * (low + high)
        between = curve(middle)
        off = np.linalg.norm(between - 0.5 * (points[asked] + points[asked + 1]), axis=-1).max(axis=-1)
        # Neighbouring floats have nothing between them.
        far = (off > chord) & (middle != low) & (middle != high)
        split = asked[far]
        checked[:] = True
        checked[split] = False
        t, points = np.insert(t, split + 1, middle[far]), np.insert(points, split + 1, between[far], axis=0)
        checked = np.insert(checked, split + 1, False)
        if len(t) > most:
            t, points, checked, is_whole = t[:most], points[:most], checked[: most - 1], False
    return Span(t, is_whole)


def _divided(t: Floats, step: float, most: int) -> Span:
    """Divide the intervals between times evenly, none longer than `step`, and keep the first `most` times."""
    if len(t) < 2:
        return Span(t, is_whole=True)
    lengths = np.diff(t)
    parts = np.maximum(1.0, np.ceil(np.abs(lengths) / step)) if step > 0.0 else np.full(len(lengths), np.inf)
    ends = np.cumsum(parts)
    if ends[-1] == len(lengths) and len(t) <= most:
        return Span(t, is_whole=True)
    count = int(min(ends[-1], most - 1))
    number = np.arange(count + 1)
    interval = np.minimum(np.searchsorted(ends, number, side="right"), len(lengths) - 1)
    done = (number - (ends - parts)[interval]) / parts[interval]
    divided = np.where(done < 1.0, t[interval] + done * lengths[interval], t[interval + 1])
    return Span(divided, is_whole=bool(count == ends[-1]))


def motion_times(
    motion: FreeMotion | HeavyTop | GyrostatMotion,
    t: Floats,
    *,
    most: int = MOST,
    turn: float = TURN,
    chord: float = CHORD,
) -> Span:
    """Put times between those given, so that the turns of one body and the paths of its ω are followed."""
    size = fastest(motion)
    if size == 0.0:
        return Span(t, is_whole=True)
    moments, axes = _ellipsoid(motion)
    roots = np.sqrt(moments)

    def curve(t: Floats) -> Floats:
        found = motion.at(t)
        on_ellipsoid = (found.omega @ axes) * roots
        radius = np.linalg.norm(on_ellipsoid, axis=-1, keepdims=True)
        on_sphere = np.divide(on_ellipsoid, radius, out=np.zeros_like(on_ellipsoid), where=radius > 0.0)
        return np.stack([on_sphere, _core.rotate(found.quaternion, found.omega) / size], axis=-2)

    step = min(turn / size, _nutation_step(motion))
    return follow(curve, t, step=step, most=most, chord=chord)


def _ellipsoid(motion: FreeMotion | HeavyTop | GyrostatMotion) -> tuple[Floats, Floats]:
    """Give moments and axes of the ellipsoid ω·Iω = 2T on which ω is, or near which."""
    if isinstance(motion, _core.GyrostatMotion):
        moments, axes = np.linalg.eigh(motion.gyrostat.inertia)
        return moments, axes
    about = "center_of_mass" if isinstance(motion, _core.FreeMotion) else "origin"
    principal = motion.body.principal_about(about)
    return principal.moments, principal.axes


def axis_times(top: HeavyTop, t: Floats, *, most: int = MOST) -> Span:
    """Put times between those given for the path of one top's axis on the unit sphere."""
    across = np.sqrt(max(0.0, fastest(top) ** 2 - float(top.axial_spin) ** 2))
    arm = float(np.linalg.norm(top.body.center_of_mass))
    step = min(TURN / across if across > 0.0 else np.inf, _nutation_step(top))
    return follow(lambda t: top.at(t).point("center_of_mass")[:, np.newaxis] / arm, t, step=step, most=most)


def drawn_times(
    motion: FreeMotion | HeavyTop | GyrostatMotion, t: ArrayLike, choose: Callable[..., Span] = motion_times
) -> Floats:
    """Put times between those that a picture was asked for, or say why no curve can follow.

    Parameters
    ----------
    motion : FreeMotion, HeavyTop or GyrostatMotion
        Of one body.
    t : array_like, shape (T,)
        Times between which curves are drawn.
    choose : callable
        `motion_times` or `axis_times`.
    """
    times = _core.real_numbers(t, "t").reshape(-1)
    if not times.size or not np.isfinite(times).all():
        raise ValueError(f"t: expected one or more finite times, got {times[~np.isfinite(times)][:1]}")
    span = choose(motion, times, most=_DRAWN)
    if not span.is_whole:
        raise ValueError(
            f"t: a curve through {_DRAWN} points follows the motion to {span.t[-1]:.6g}, not to "
            f"{times[-1]:.6g}; give a shorter span"
        )
    return span.t


def _nutation_step(motion: FreeMotion | HeavyTop | GyrostatMotion) -> float:
    if isinstance(motion, _core.FreeMotion):
        return np.inf  # |dω/dt| is at most ω²/√3: nothing is faster than the turn
    if isinstance(motion, _core.GyrostatMotion):
        rate = _quickest(motion)
        return 2.0 * np.pi / (rate * _PER_NUTATION) if rate > 0.0 else np.inf
    return float(motion.nutation_period) / _PER_NUTATION
