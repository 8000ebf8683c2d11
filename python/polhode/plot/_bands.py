"""Bands about curves over time: where each value lies with a given probability."""

from __future__ import annotations

from statistics import NormalDist
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from polhode import _core
from polhode._scene.style import AXIS_COLORS, AXIS_DASHES
from polhode.errors import PolhodeError
from polhode.plot._style import matplotlib

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from polhode.trajectory import Trajectory

    Floats = NDArray[np.float64]

__all__ = ["draw_band", "name_band", "of_euler_angles", "of_omega", "of_spin"]

_INK: Final = "0.35"
"""Of what the legend says of bands."""


def of_omega(trajectory: Trajectory, turn: Floats | None, coverage: float | None) -> Floats | str | None:
    """Give half the widths of the bands about ω, shape (..., T, 3).

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
    """Give half the widths of the bands about the spin angular momentum; see `of_omega`."""
    return _half_widths(trajectory, lambda: trajectory._spin_covariance(frame), coverage)


def of_euler_angles(trajectory: Trajectory, sequence: str, coverage: float | None) -> Floats | str | None:
    """Give half the widths of the bands about the Euler angles; see `of_omega`.

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
    """Prepare the legend's entry, and give what else the legend has to say, and how many columns it has.

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
