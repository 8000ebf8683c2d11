"""The times at which a motion is drawn: close enough that the picture shows the whole motion.

From one picture to the next a body seems to turn the shorter way: by more than half a turn it seems to turn
backward. And a curve through too few points cuts through the surface on which it lies. So pictures follow the
motion, not the length of the time over which it is shown.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from polhode import _core
from polhode._format import at_least

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from polhode import FreeMotion, GyrostatMotion, HeavyTop, Trajectory

    Floats = NDArray[np.float64]

__all__ = [
    "CHORD",
    "COARSE",
    "GIF_RATE",
    "MOST",
    "RATE",
    "SECONDS",
    "TURN",
    "Footage",
    "Span",
    "axis_times",
    "drawn_times",
    "fastest",
    "follow",
    "motion_times",
    "of_motion",
    "of_samples",
    "once_round",
    "pace",
    "turns",
]

TURN: Final = float(np.deg2rad(20.0))
"""Largest turn of a body between two pictures, if the times can be chosen."""
COARSE: Final = float(np.deg2rad(30.0))
"""Beyond this turn between two pictures a note is made; beyond half a turn nothing is drawn."""
CHORD: Final = 0.002
"""Largest distance of a chord from its curve, relative to the size of the surface: half a pixel."""
MOST: Final = 12_000
"""Points of a curve that a browser still draws smoothly."""
_DRAWN: Final = 50_000
"""Points of a curve in a picture that does not move."""
_PER_NUTATION: Final = 24
_PER_PERIOD: Final = 1440
"""States in which the fastest of a gyrostat is looked for."""
_GROWTHS: Final = 40.0
"""Number of e-folding times in which a departure grows from rounding to its full size."""


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
    """Compute the angle of turn from each time to the next, at the greater of both rates, shape (T - 1,).

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
    """Return times over one period of ω in the body, for one gyrostat."""
    if str(motion.mode) == "steady":
        return np.zeros(1)
    period = float(motion.periods.rotation)
    if np.isfinite(period):
        return np.linspace(0.0, period, _PER_PERIOD + 1)
    reach = _GROWTHS / _quickest(motion)
    return np.linspace(-reach, reach, _PER_PERIOD + 1)


def _quickest(motion: GyrostatMotion) -> float:
    """Find the greatest rate at which L circles about an equilibrium of one gyrostat, or departs from it."""
    if str(motion.mode) == "steady":
        return 0.0
    return float(np.sqrt(np.abs(motion.equilibria().squared_rate).max()))


def follow(
    curve: Callable[[Floats], Floats], t: Floats, *, step: float, most: int = MOST, chord: float = CHORD
) -> Span:
    """Insert times, so that the chords of curves stay near the curves.

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
    t, is_whole = _divide(t, step, most)
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


def _divide(t: Floats, step: float, most: int) -> Span:
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
    """Insert times, so that a picture follows the turns of one body and the path of its ω."""
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
    """Return moments and axes of the ellipsoid ω·Iω = 2T on which ω is, or near which."""
    if isinstance(motion, _core.GyrostatMotion):
        moments, axes = np.linalg.eigh(motion.gyrostat.inertia)
        return moments, axes
    about = "center_of_mass" if isinstance(motion, _core.FreeMotion) else "origin"
    principal = motion.body.principal_about(about)
    return principal.moments, principal.axes


def axis_times(top: HeavyTop, t: Floats, *, most: int = MOST) -> Span:
    """Insert times, so that a picture follows the axis of one top on the unit sphere."""
    across = np.sqrt(max(0.0, fastest(top) ** 2 - float(top.axial_spin) ** 2))
    arm = float(np.linalg.norm(top.body.center_of_mass))
    step = min(TURN / across if across > 0.0 else np.inf, _nutation_step(top))
    return follow(lambda t: top.at(t).point("center_of_mass")[:, np.newaxis] / arm, t, step=step, most=most)


def drawn_times(
    motion: FreeMotion | HeavyTop | GyrostatMotion, t: ArrayLike, choose: Callable[..., Span] = motion_times
) -> Floats:
    """Insert times between those of a picture; if no curve can follow the motion, say why.

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


SECONDS: Final = {
    "ns": 1e-9, "µs": 1e-6, "us": 1e-6, "ms": 1e-3, "s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0,
    "day": 86400.0, "days": 86400.0, "yr": 31557600.0,
}  # fmt: skip
"""Seconds in each unit of time that a page knows."""
_REAL: Final = (2.0, 300.0)
"""Seconds of a motion that is shown in real time."""
_FINEST: Final = np.array([1.0, 2.0, 5.0, 10.0])


def pace(length: float, wished: float, least: float, time_unit: str) -> float:
    """Return the seconds of a motion on the screen: in real time, or slower or faster by a round factor.

    Parameters
    ----------
    length : float
        Of the motion, in units of time.
    wished : float
        Seconds on the screen where real time cannot be watched.
    least : float
        Seconds below which pictures would be too far from each other.
    time_unit : str
        One that is not known has no real time: the motion takes the seconds wished.
    """
    unit = SECONDS.get(time_unit)
    if unit is None or not length > 0.0:
        return wished
    real = length * unit
    if least <= real and _REAL[0] <= real <= _REAL[1]:
        return real
    factor = real / wished  # as many times real time
    decade = 10.0 ** np.floor(np.log10(factor))
    if not 0.0 < decade < np.inf:
        return wished
    if factor < 1.0:  # one part in a round number
        parts = 1.0 / factor
        decade = 10.0 ** np.floor(np.log10(parts))
        return real * float(decade * _FINEST[_FINEST * decade >= parts * (1.0 - 1e-9)][0])
    return real / float(decade * _FINEST[_FINEST * decade <= factor * (1.0 + 1e-9)][-1])


_SECONDS: Final = 10.0
"""Shortest time of a motion on the screen, in seconds."""
RATE: Final = 30.0
"""Pictures a second, of a film and of a browser on a slow machine."""
GIF_RATE: Final = 50.0
"""Pictures a second that every viewer of GIFs keeps to."""
_FILM: Final = 1800
"""Pictures of a film: a minute of it, and a few minutes of drawing."""
_PAGE_TURN: Final = float(np.deg2rad(40.0))
"""Largest turn between two frames of a page, which interpolates between them."""
_PAGE_CHORD: Final = 0.02
_PAGE_FRAMES: Final = 3600
"""Largest number of frames of a page, of 48 bytes each."""
_BETWEEN: Final = 20
"""Points of the path of ω for each picture of a film, at most."""


@dataclass(frozen=True)
class Footage:
    """The states that are shown.

    Attributes
    ----------
    trajectory : Trajectory
        The states along the path of ω.
    chosen : numpy.ndarray, shape (F,)
        Which of them are frames.
    duration : float
        Seconds that the whole takes on the screen.
    notes : tuple of str
        What the viewer does not see of the motion.
    """

    trajectory: Trajectory
    chosen: NDArray[np.int64]
    duration: float
    notes: tuple[str, ...] = ()


def of_samples(
    trajectory: Trajectory,
    *,
    frames: int | None,
    duration: float | None,
    time_unit: str,
    is_film: bool = False,
    is_page: bool = False,
    fps: float | None = None,
) -> Footage:
    """Choose frames evenly among the samples of a motion of which no other states are known.

    Parameters
    ----------
    trajectory : Trajectory
        Of one body.
    frames : int or None
        How many; all samples by default.
    duration : float or None
        Seconds on the screen; by default as the rate of turning needs.
    time_unit : str
        For messages, and for what real time is.
    is_film : bool
        Whether each frame is one picture.
    is_page : bool
        Whether what shows them interpolates, so that fewer do.
    fps : float, optional
        Pictures of a film a second.
    """
    count = len(trajectory)
    if frames is not None and not 1 <= frames <= count:
        raise ValueError(f"frames: {frames} is not between 1 and the {count} samples of the motion")
    angles = turns(trajectory.t, trajectory.omega)
    shown = frames or count
    if is_page and frames is None:
        shown = min(count, max(_PAGE_FRAMES, int(np.ceil(angles.sum() / TURN)) + 1))
    elif is_film and frames is None and duration is not None:
        shown = min(count, max(2, int(GIF_RATE * duration * (1.0 + 1e-9))))
    chosen = np.unique(np.linspace(0, count - 1, shown).round().astype(int))
    whole = float(abs(trajectory.t[-1] - trajectory.t[0]))
    rate = float(np.linalg.norm(trajectory.omega, axis=-1).max())
    notes: list[str] = []
    if len(chosen) > 1:
        between = np.add.reduceat(angles, chosen[:-1])
        widest = float(between.max())
        needed = np.ceil(whole * rate / TURN) + 1.0
        where = f"{trajectory.t[chosen[int(between.argmax())]]:.6g} {time_unit}"
        can_help = float(angles.max()) <= COARSE and count >= needed  # samples that are near enough
        way_out = f"ask for {needed:.7g} times or more, evenly spaced"
        if can_help:
            is_short = is_film and frames is None
            way_out = "give a longer duration" if is_short else f"give frames={needed:.7g} or more"
        notes += _check_turn(widest, f"animate: from one frame to the next, at t = {where},", way_out)
    if is_film:
        if fps is not None and duration is not None:
            raise ValueError("fps: of samples each is one picture; give fps or duration, not both")
        least = max(_SECONDS, len(chosen) / GIF_RATE) if duration is None else duration
        seconds = least if fps is None else len(chosen) / fps
        return Footage(trajectory, chosen, seconds, tuple(notes))
    seconds, told = _on_screen(whole, rate, duration, time_unit if is_page else None)
    return Footage(trajectory, chosen, seconds, (*notes, *told))


def of_motion(
    motion: FreeMotion | HeavyTop | GyrostatMotion,
    samples: Trajectory,
    *,
    duration: float | None,
    time_unit: str,
    is_film: bool = False,
    is_page: bool = False,
    fps: float | None = None,
) -> Footage:
    """Choose frames for a motion whose state is known at every time.

    Parameters
    ----------
    motion : FreeMotion, HeavyTop or GyrostatMotion
        Of one body; its time 0 is that of the first sample.
    samples : Trajectory
        Of the same motion. A page shows these samples and the motion between them. A film shows the motion
        from the first sample to the last.
    duration, time_unit, is_film, is_page, fps
        As in `of_samples`.
    """
    t = samples.t
    rate, since = fastest(motion), t - t[0]
    if is_film and len(t) > 1:
        pictures, seconds, notes = _pictures(float(since[-1]), rate, duration, fps)
        span = motion_times(motion, pictures, most=_BETWEEN * len(pictures))
        chosen = np.flatnonzero(np.isin(span.t, pictures))
    else:
        if is_page:
            ends = np.unique([0, len(t) - 1])
            span = motion_times(motion, since[ends], most=_PAGE_FRAMES, turn=_PAGE_TURN, chord=_PAGE_CHORD)
        else:
            span = motion_times(motion, since, most=max(MOST, 2 * len(t)))
        chosen = np.arange(len(span.t))
        seconds, notes = _on_screen(float(span.t[-1]), rate, duration, time_unit if is_page else None)
    if span.t[chosen[-1]] != since[-1]:
        notes.append(
            f"shown is the beginning, to {span.t[chosen[-1]] + t[0]:.6g} of {t[-1]:.6g} {time_unit}: "
            f"{len(chosen)} frames follow the motion no farther; a shorter span shows all of it"
        )
    is_enough = np.array_equal(span.t, since)
    shown = samples if is_enough else replace(motion.at(span.t), t=span.t + t[0])
    return Footage(shown, chosen, seconds, tuple(notes))


def _pictures(
    length: float, rate: float, duration: float | None, fps: float | None
) -> tuple[Floats, float, list[str]]:
    """Choose evenly spaced times for the pictures of a film; also return its length in seconds, and notes."""
    needed = float(np.ceil(abs(length) * rate / TURN)) + 1.0
    if duration is None:
        count = int(min(max(needed, (fps or RATE) * _SECONDS), _FILM))
        if needed > count:
            length = float(np.copysign((count - 1) * TURN / rate, length))
        return np.linspace(0.0, length, count), count / (fps or RATE), []
    if fps is None:
        count = int(min(max(needed, RATE * duration, 2.0), max(GIF_RATE * duration, 2.0), _FILM))
    else:
        count = int(min(max(round(fps * duration), 2.0), _FILM))
    most = fps or GIF_RATE
    where = f"duration: of {count} pictures, {most:g} a second at most, from one to the next"
    way_out = "give a longer one, or leave it out" if needed > most * duration else "leave it out"
    return (
        np.linspace(0.0, length, count),
        duration,
        _check_turn(abs(length) * rate / (count - 1), where, way_out),
    )


def _check_turn(angle: float, where: str, way_out: str) -> list[str]:
    """Return a note where the turn from one picture to the next is large; an error where it is too large."""
    if angle >= np.pi:
        raise ValueError(
            f"{where} the body turns by up to {np.rad2deg(angle):.4g} deg, past the half turn beyond which a "
            f"picture seems to turn backward; {way_out}"
        )
    if angle <= COARSE:
        return []
    return [
        f"{where} the body turns by up to {np.rad2deg(angle):.3g} deg, more than the "
        f"{np.rad2deg(COARSE):.0f} that an eye follows; {way_out}"
    ]


def _on_screen(
    length: float, rate: float, duration: float | None, time_unit: str | None
) -> tuple[float, list[str]]:
    """Return seconds that a page or a window takes, with no turn above `TURN` between pictures; and notes.

    A page, which names its speed, runs at one that has a name, in real time where that can be watched.
    """
    turned = abs(length) * rate / RATE
    needed = max(_SECONDS, turned / TURN)
    if duration is None:
        return (needed if time_unit is None else pace(abs(length), needed, turned / TURN, time_unit)), []
    where = f"duration: at {RATE:g} pictures a second from one to the next"
    return duration, _check_turn(
        turned / duration, where, f"give duration={at_least(float(np.ceil(needed)), 6)} or more"
    )
