"""Which states of a motion an animation shows, and how long it takes on the screen."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from polhode._rounding import at_least
from polhode._scene.clock import pace
from polhode._scene.sampling import COARSE, MOST, TURN, fastest, motion_times, turns

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import FreeMotion, GyrostatMotion, HeavyTop, Trajectory

    Floats = NDArray[np.float64]

__all__ = ["GIF_RATE", "RATE", "Footage", "of_motion", "of_samples"]

_SECONDS: Final = 10.0
"""That a motion takes on the screen at least."""
RATE: Final = 30.0
"""Pictures a second, of a film and of a browser on a slow machine."""
GIF_RATE: Final = 50.0
"""Pictures a second that every viewer of GIFs keeps to."""
_FILM: Final = 1800
"""Pictures of a film: a minute of it, and a few minutes of drawing."""
_PAGE_TURN: Final = float(np.deg2rad(40.0))
"""From one frame of a page to the next, between which it interpolates, on the turns and on ω."""
_PAGE_CHORD: Final = 0.02
_PAGE_FRAMES: Final = 3600
"""Of a page: 48 bytes each."""
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
        notes += _judged(widest, f"animate: from one frame to the next, at t = {where},", way_out)
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
        Of the same motion. A page shows these and what is between them, a film the span from the first to the
        last.
    duration, time_unit, is_film, is_page, fps
        As of `of_samples`.
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
    """Choose evenly spaced times for the pictures of a film; also give its length in seconds, and notes."""
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
        _judged(abs(length) * rate / (count - 1), where, way_out),
    )


def _judged(angle: float, where: str, way_out: str) -> list[str]:
    """Give a note where the turn from one picture to the next is large; an error where it is too large."""
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
    """Give the seconds that a page or a window takes, with no turn above `TURN` between pictures; and notes.

    A page, which names its speed, runs at one that has a name, in real time where that can be watched.
    """
    turned = abs(length) * rate / RATE
    needed = max(_SECONDS, turned / TURN)
    if duration is None:
        return (needed if time_unit is None else pace(abs(length), needed, turned / TURN, time_unit)), []
    where = f"duration: at {RATE:g} pictures a second from one to the next"
    return duration, _judged(
        turned / duration, where, f"give duration={at_least(float(np.ceil(needed)), 6)} or more"
    )
