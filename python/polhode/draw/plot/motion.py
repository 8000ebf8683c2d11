"""Pictures of a motion over time, with bands where its states are uncertain."""

from __future__ import annotations

from statistics import NormalDist
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from polhode import _core
from polhode._hints import check_kind, with_hints
from polhode.draw.plot.axes import axes_2d, columns_that_fit, in_lines, matplotlib, room, tidy
from polhode.draw.sampling import drawn_times
from polhode.draw.shape import check_one
from polhode.draw.style import AXIS_COLORS, AXIS_DASHES
from polhode.errors import PolhodeError
from polhode.motion.invariants import changes, lengths

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from polhode import FreeMotion, GyrostatMotion, HeavyTop
    from polhode.motion.trajectory import Trajectory

    Floats = NDArray[np.float64]

__all__ = [
    "angular_momentum",
    "angular_velocity",
    "draw_band",
    "euler_angles",
    "invariants",
    "name_band",
    "of_euler_angles",
    "of_omega",
    "of_spin",
]

_TURN: Final = 360.0
_EPSILON: Final = float(np.finfo(float).eps)
_ROUNDING: Final = 64.0 * _EPSILON
"""Relative changes of conserved quantities up to this are no drift."""
_SHOWN: Final = 1e-12
"""The least change at which a picture of drift may end, so that rounding does not fill it."""


def _until(motion: FreeMotion | HeavyTop | GyrostatMotion, end: float | None) -> Trajectory:
    """Compute the states of one motion in closed form at as many times as its curves need."""
    check_one(motion.shape, "angular_velocity")
    if end is None:
        raise ValueError(
            "end: a motion in closed form has none of its own; give the time to which it is drawn"
        )
    return motion.at(drawn_times(motion, [0.0, end]))


@with_hints
def angular_velocity(
    trajectory: Trajectory | FreeMotion | HeavyTop | GyrostatMotion,
    ax: Axes | None = None,
    *,
    end: float | None = None,
    frame: Literal["body", "principal"] = "body",
    degrees: bool = False,
    time_label: str = "s",
    coverage: float | None = 0.95,
) -> Axes:
    """Draw the components of the angular velocity over time.

    Parameters
    ----------
    trajectory : Trajectory, FreeMotion, HeavyTop or GyrostatMotion
        The motion; of a stack of trajectories, every body is drawn.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure by default.
    end : float, optional
        For a motion in closed form, which has no times of its own: the motion is drawn from 0 to this time.
    frame : {"body", "principal"}
        Components along the body's axes or along its principal axes (ascending moments).
    degrees : bool
        Degrees instead of radians.
    time_label : str
        Word for the unit of the times; it converts no number.
    coverage : float or None
        If the body or the start have sigmas, a band is drawn about each curve. At any one time the component
        is inside the band with this probability, to first order: 0.95 for 1.96 standard deviations. If
        `polhode.Trajectory.covariance` cannot be computed, the legend says why there is no band. If a band
        becomes wider than the range of the curve, the legend says from which time on the first order is not
        enough. None draws no band.

    Returns
    -------
    matplotlib.axes.Axes
    """
    check_kind(trajectory, "trajectory", "Trajectory", "FreeMotion", "HeavyTop", "GyrostatMotion")
    if isinstance(trajectory, _core.FreeMotion | _core.HeavyTop | _core.GyrostatMotion):
        trajectory = _until(trajectory, end)
    elif end is not None:
        raise ValueError("end: a trajectory has its own times; leave it out")
    trajectory._check_series("angular_velocity")
    ax = axes_2d(ax)
    omega = trajectory.omega
    if frame == "principal":
        omega = np.einsum("...ij,...ti->...tj", trajectory.body.principal.axes, omega)
        labels = [rf"$\omega_{i}$" for i in "123"]
    elif frame == "body":
        labels = [rf"$\omega_{i}$" for i in "xyz"]
    else:
        raise ValueError(f"frame: {frame!r} is not 'body' or 'principal'")
    half = of_omega(trajectory, trajectory.body.principal.axes if frame == "principal" else None, coverage)
    if degrees:
        omega = np.rad2deg(omega)
        half = np.rad2deg(half) if isinstance(half, np.ndarray) else half
    _components(ax, trajectory, omega, labels, half)
    note = name_band(ax, trajectory.t, half, coverage, float(np.nanmax(lengths(omega), initial=0.0)))
    return _over_time(ax, time_label, f"angular velocity ({'deg' if degrees else 'rad'}/{time_label})", *note)


@with_hints
def angular_momentum(
    trajectory: Trajectory,
    ax: Axes | None = None,
    *,
    frame: Literal["space", "body"] = "space",
    momentum_label: str = "kg m²/s",
    time_label: str = "s",
    coverage: float | None = 0.95,
) -> Axes:
    """Draw the components of the spin angular momentum over time.

    Parameters
    ----------
    trajectory : Trajectory
        The motion; of a stack, every body is drawn.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure by default.
    frame : {"space", "body"}
        The frame whose axes the components refer to.
    momentum_label, time_label : str
        Words for the units of the momentum and of the times; they convert no number.
    coverage : float or None
        Probability of the bands, as for :func:`angular_velocity`. Correlations of the tensor with the motion
        are included.

    Returns
    -------
    matplotlib.axes.Axes
    """
    check_kind(trajectory, "trajectory", "Trajectory")
    trajectory._check_series("angular_momentum")
    ax = axes_2d(ax)
    spin = trajectory.angular_momentum(frame).spin
    half = of_spin(trajectory, frame, coverage)
    _components(ax, trajectory, spin, [rf"$L_{i}$" for i in "xyz"], half)
    note = name_band(ax, trajectory.t, half, coverage, float(np.nanmax(lengths(spin), initial=0.0)))
    return _over_time(ax, time_label, f"angular momentum in {frame} ({momentum_label})", *note)


@with_hints
def euler_angles(
    trajectory: Trajectory,
    ax: Axes | None = None,
    *,
    sequence: str = "ZXZ",
    unwrap: bool = False,
    time_label: str = "s",
    coverage: float | None = 0.95,
) -> Axes:
    """Draw the Euler angles over time, in degrees; where they are not defined there is a gap.

    Parameters
    ----------
    trajectory : Trajectory
        The motion; of a stack, every body is drawn.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure by default.
    sequence : str
        As in :mod:`polhode.euler_angles`.
    unwrap : bool
        Whether the first and third angle are counted on over many turns. Otherwise each of them is drawn from
        -180° to 180°, or from 0° to 360° where this saves half of the breaks. Where it leaves this turn,
        the line goes to the edge and on from the other edge.
    time_label : str
        Word for the unit of the times; it converts no number.
    coverage : float or None
        Probability of the bands, as for :func:`angular_velocity`. The first and third angle are not defined
        at some values of the second. They have no band where the band of the second angle contains such a
        value.

    Returns
    -------
    matplotlib.axes.Axes
    """
    check_kind(trajectory, "trajectory", "Trajectory")
    trajectory._check_series("euler_angles")
    ax = axes_2d(ax)
    angles = np.rad2deg(trajectory.euler_angles(sequence, "nan", unwrap=unwrap))
    lowest = None if unwrap else {i: _lowest(angles[..., i]) for i in (0, 2)}
    names = [r"$\varphi$", r"$\theta$", r"$\psi$"]
    half = of_euler_angles(trajectory, sequence, coverage)
    half = np.rad2deg(half) if isinstance(half, np.ndarray) else half
    _components(ax, trajectory, angles, names, half, lowest)
    if not unwrap:
        ax.yaxis.set_major_locator(matplotlib("ticker").MultipleLocator(90.0))
    note = name_band(ax, trajectory.t, half, coverage, 90.0)
    return _over_time(ax, time_label, f"Euler angles {sequence} (degrees)", *note)


@with_hints
def invariants(trajectory: Trajectory, ax: Axes | None = None, *, time_label: str = "s") -> Axes:
    """Draw the drift of energy and angular momentum from their values at the start.

    Parameters
    ----------
    trajectory : Trajectory
        The motion; of a stack, every body is drawn.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure by default.
    time_label : str
        Word for the unit of the times; it converts no number.

    Returns
    -------
    matplotlib.axes.Axes
        Axes with the changes relative to the largest value of the motion, on a logarithmic scale. Changes in
        the grey band, up to 64 times the rounding error of float64, are no drift; the legend says so where
        all are. A change of exactly zero is drawn at half the rounding error.

    Raises
    ------
    ValueError
        If the load conserves neither.
    """
    check_kind(trajectory, "trajectory", "Trajectory")
    kept = trajectory.invariants()
    if kept.energy is None and kept.angular_momentum is None:
        raise ValueError(
            "trajectory: its load keeps neither the energy nor a component of the angular momentum"
        )
    trajectory._check_series("invariants")
    ax = axes_2d(ax)
    size = lengths(trajectory.angular_momentum().spin)
    shown = [
        (kept.energy, None if kept.energy is None else np.abs(kept.energy), "energy", 0),
        (kept.angular_momentum, size, "angular momentum", 1),
    ]
    greatest = 0.0
    for values, scale, name, number in shown:
        if values is None or scale is None:
            continue
        change, largest = changes(values, scale)
        change = change / np.where(largest > 0.0, largest, 1.0)[..., np.newaxis]
        greatest = max(greatest, float(np.nanmax(change, initial=0.0)))
        curves = np.maximum(change, 0.5 * _EPSILON).reshape(-1, len(trajectory))
        for row, curve in enumerate(curves):
            ax.plot(
                trajectory.t, curve, color=AXIS_COLORS[number], linestyle=AXIS_DASHES[1 - number],
                linewidth=1.0, label=name if row == 0 else None,
            )  # fmt: skip
    ax.axhspan(0.25 * _EPSILON, _ROUNDING, color="0.93", zorder=0.5, label="rounding of float64")
    ax.set_yscale("log")
    ax.set_ylim(0.25 * _EPSILON, max(3.0 * greatest, _SHOWN))
    note = "no drift: all changes are rounding" if greatest <= _ROUNDING else None
    return _over_time(ax, time_label, "relative change since the start", note)


def _components(
    ax: Axes,
    trajectory: Trajectory,
    vectors: Floats,
    labels: list[str],
    half: Floats | str | None,
    lowest: dict[int, float] | None = None,
) -> None:
    """Draw three components over time, of every body of a stack, with half the widths of their bands.

    `lowest` holds the numbers of components that are angles of a whole turn, and where the turn begins.
    """
    curves = vectors.reshape(-1, len(trajectory), 3)
    halves = half.reshape(curves.shape) if isinstance(half, np.ndarray) else None
    opacity = 1.0 if len(curves) == 1 else 0.5
    for number, curve in enumerate(curves):
        for i in range(3):
            columns = [trajectory.t, curve[:, i], *([] if halves is None else [halves[number, :, i]])]
            if lowest is not None and i in lowest:
                columns = _cut_at_turns(columns, lowest[i])
            if halves is not None:
                draw_band(ax, columns[0], columns[1], columns[2], i)
            ax.plot(
                columns[0],
                columns[1],
                color=AXIS_COLORS[i],
                linestyle=AXIS_DASHES[i],
                alpha=opacity,
                label=labels[i] if number == 0 else None,
            )


def _lowest(angles: Floats) -> float:
    """Choose the range of an angle: from −180°, or from 0° if this saves half of the breaks."""
    breaks = [
        int((np.abs(np.diff(one, axis=-1)) > 0.5 * _TURN).sum())
        for one in (angles, np.where(angles < 0.0, angles + _TURN, angles))
    ]
    return 0.0 if breaks[0] >= max(1, 2 * breaks[1]) else -0.5 * _TURN


def _cut_at_turns(columns: list[Floats], lowest: float) -> list[Floats]:
    """Bring an angle into its range. Where the angle leaves it, the curve goes on at the other edge.

    The columns are times, the angle, and what else goes with it.
    """
    angle = columns[1] if lowest < 0.0 else np.where(columns[1] < 0.0, columns[1] + _TURN, columns[1])
    step = np.diff(angle)
    k = np.flatnonzero(np.abs(step) > 0.5 * _TURN)
    is_up = step[k] < 0.0
    edge = np.where(is_up, lowest + _TURN, lowest)
    way = step[k] + np.where(is_up, _TURN, -_TURN)
    part = np.divide(edge - angle[k], way, out=np.zeros_like(way), where=way != 0.0)
    found = []
    for n, values in enumerate([columns[0], angle, *columns[2:]]):
        at = values[k] + part * (values[k + 1] - values[k])
        ends = (at, at, at)
        if n == 1:
            ends = (edge, np.full_like(at, np.nan), 2.0 * lowest + _TURN - edge)
        found.append(np.insert(values, np.repeat(k + 1, 3), np.stack(ends, axis=-1).ravel()))
    return found


def _over_time(ax: Axes, time_label: str, quantity: str, note: str | None = None, columns: int = 3) -> Axes:
    ax.set_xlabel(f"time ({time_label})")
    ax.set_ylabel(in_lines(ax, quantity))
    tidy(ax)
    names = [str(name) for name in ax.get_legend_handles_labels()[1]]
    ax.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, frameon=False, columnspacing=1.2,
        ncols=columns_that_fit(0.85 * room(ax)[0], names, 10.0, columns), title=note, title_fontsize="small",
    )  # fmt: skip
    return ax


_INK: Final = "0.35"
"""Colour of the legend's entry of bands."""


def of_omega(trajectory: Trajectory, turn: Floats | None, coverage: float | None) -> Floats | str | None:
    """Return half the widths of the bands about ω, shape (..., T, 3).

    Parameters
    ----------
    trajectory : Trajectory
    turn : numpy.ndarray, shape (..., 3, 3), or None
        Its columns are the axes that the components are along; those of the body by default.
    coverage : float or None
        The probability.

    Returns
    -------
    numpy.ndarray, str or None
        Why they are not known where they are not; None where nothing is uncertain or none are asked for.
    """

    def covariance() -> Floats | None:
        found = trajectory.covariance
        if found is None:
            return None
        found = found[..., 3:, 3:]
        if turn is None:
            return found
        axes = turn[..., np.newaxis, :, :]
        return np.asarray(np.swapaxes(axes, -1, -2) @ found @ axes)

    return _half_widths(trajectory, covariance, coverage)


def of_spin(
    trajectory: Trajectory, frame: Literal["space", "body"], coverage: float | None
) -> Floats | str | None:
    """Return half the widths of the bands about the spin angular momentum; see `of_omega`."""
    return _half_widths(trajectory, lambda: trajectory._spin_covariance(frame), coverage)


def of_euler_angles(trajectory: Trajectory, sequence: str, coverage: float | None) -> Floats | str | None:
    """Return half the widths of the bands about the Euler angles; see `of_omega`.

    Those of the first and third angle are not numbers where the second, within its band, may be one at
    which they are not defined.
    """

    def covariance() -> Floats | None:
        found = trajectory.covariance
        if found is None:
            return None
        angles = trajectory.euler_angles(sequence, "nan")
        # A small rotation changes the angles as a rate does in a unit of time.
        slopes = np.stack(
            [
                _core.euler_rates(angles, np.broadcast_to(axis, angles.shape), sequence, "body", "nan")
                for axis in np.eye(3)
            ],
            axis=-1,
        )
        return np.asarray(slopes @ found[..., :3, :3] @ np.swapaxes(slopes, -1, -2))

    half = _half_widths(trajectory, covariance, coverage)
    if isinstance(half, np.ndarray):
        second = trajectory.euler_angles(sequence, "nan")[..., 1]
        # The singular ones are 0 and π where first and third axis are one, else ±π/2.
        is_proper = sequence[0].lower() == sequence[2].lower()
        apart = np.abs(np.arcsin(np.sin(second) if is_proper else np.cos(second)))
        half[..., ::2] = np.where((apart > half[..., 1])[..., np.newaxis], half[..., ::2], np.nan)
    return half


def draw_band(ax: Axes, t: Floats, curve: Floats, half: Floats, component: int) -> None:
    """Draw one band in the colour and, along its edges, the dashes of its curve."""
    color = AXIS_COLORS[component]
    low, high = curve - half, curve + half
    ax.fill_between(t, low, high, color=color, alpha=0.18, linewidth=0.0, zorder=1.5)
    edges: Any = matplotlib("collections").LineCollection(
        [np.stack([t, edge], axis=-1) for edge in (low, high)],
        colors=color, linestyles=AXIS_DASHES[component], linewidths=0.6, alpha=0.7, zorder=1.6,
    )  # fmt: skip
    ax.add_collection(edges, autolim=False)


def name_band(
    ax: Axes, t: Floats, half: Floats | str | None, coverage: float | None, scale: float
) -> tuple[str | None, int]:
    """Prepare the legend's entry; return the other texts of the legend and its number of columns.

    It says why there is no band, or from when on one is wider than the scale of what is drawn: there at the
    latest the first order is not enough.
    """
    if isinstance(half, str):
        return half, 3
    if half is None or coverage is None:
        return None, 3
    ax.fill_between([], [], [], color=_INK, alpha=0.3, linewidth=0.0, label=f"{100.0 * coverage:.4g} %")
    is_wide = (half > scale).reshape(-1, len(t), 3).any(axis=(0, 2))
    note = f"bands beyond the first order from {t[is_wide.argmax()]:.4g} on" if is_wide.any() else None
    return note, 4


def _half_widths(
    trajectory: Trajectory, covariance: Callable[[], Floats | None], coverage: float | None
) -> Floats | str | None:
    if coverage is None:
        return None
    if not 0.0 < coverage < 1.0:
        raise ValueError(f"coverage: {coverage} is not between 0 and 1; it is a probability, as 0.95")
    if trajectory.uncertain_start is None:
        return "no band: motion before, or load, is not known"
    try:
        found = covariance()
    except PolhodeError:
        return "no band: motion without derivatives"
    if found is None:
        return None
    variances = np.maximum(np.diagonal(found, axis1=-2, axis2=-1), 0.0)  # by rounding below it
    return np.asarray(NormalDist().inv_cdf(0.5 + 0.5 * coverage) * np.sqrt(variances))
