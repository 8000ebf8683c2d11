"""Error ellipses on the ellipsoid of inertia: where the principal axes may point."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._hints import check_kind
from polhode._rounding import at_most
from polhode._scene.doubt import angle_covariance, axis_scatter
from polhode._scene.ellipsoid import principal_circles
from polhode._scene.style import AXIS_COLORS
from polhode.plot._surfaces import curve_on

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d.axes3d import Axes3D
    from numpy.typing import NDArray

    from polhode import RigidBody

    Floats = NDArray[np.float64]

__all__ = ["error_ellipses"]

_AROUND: Final = np.linspace(0.0, 2.0 * np.pi, 121)
_INK: Final = "#222222"
"""Of the circle on which axes lie anywhere."""


def error_ellipses(
    ax: Axes3D, body: RigidBody, semi_axes: Floats, center: Floats, coverage: float, enlarged: float
) -> None:
    """Draw them about the ends of the axes, and name their sizes; nothing where nothing is uncertain.

    Parameters
    ----------
    ax : mpl_toolkits.mplot3d.axes3d.Axes3D
    body : RigidBody
        One body.
    semi_axes : numpy.ndarray, shape (3,)
        Of the ellipsoid that is drawn.
    center : numpy.ndarray, shape (3,)
    coverage : float
        Probability that an axis points into its ellipse.
    enlarged : float
        How many times larger the ellipses are drawn.
    """
    check_kind(body, "body", "RigidBody")
    if not 0.0 < coverage < 1.0:
        raise ValueError(f"coverage: {coverage} is not between 0 and 1; it is a probability, as 0.95")
    if not 0.0 < enlarged < np.inf:
        raise ValueError(f"enlarged: {enlarged} is not positive")
    covariance, sigma = angle_covariance(body), body.sigma
    if covariance is None or sigma is None:
        return
    # In two dimensions the square of a normal distance is exponential: 2.4477 deviations hold 95 %.
    radius = float(np.sqrt(-2.0 * np.log1p(-coverage)))
    ellipses, loose = _ellipses(covariance, radius)
    is_linear = np.asarray(sigma.linear.axes)
    legend: list[Any] = []
    if ellipses:
        widest = max(ellipses, key=lambda k: ellipses[k][0][1])
        angle = float(ellipses[widest][0][1])
        if enlarged * angle >= 0.5 * np.pi:
            raise ValueError(
                f"enlarged: {enlarged:g} times the {np.rad2deg(angle):.3g}° of axis {widest + 1} is no "
                f"ellipse; give less than {at_most(0.5 * np.pi / angle)}"
            )
    for k, (half, vectors) in ellipses.items():
        color, others = AXIS_COLORS[k], [(k + 1) % 3, (k + 2) % 3]
        dash = "-" if is_linear[others].all() else "--"
        # Offsets of the tip along the two other axes, and the directions to them on the unit sphere.
        offsets = (enlarged * half * np.stack([np.cos(_AROUND), np.sin(_AROUND)], axis=-1)) @ vectors.T
        angle = np.linalg.norm(offsets, axis=-1, keepdims=True)
        directions = np.zeros((len(_AROUND), 3))
        directions[:, [k]] = np.cos(angle)
        directions[:, others] = np.sinc(angle / np.pi) * offsets
        for sense in (1.0, -1.0):
            _on_ellipsoid(ax, sense * directions, body, semi_axes, center, color, linestyle=dash)
        size = " × ".join(f"{angle:.2g}°" for angle in np.rad2deg(half[::-1]))
        doubt = "" if dash == "-" else ", first order not enough"
        (line,) = ax.plot([], [], [], color=color, linestyle=dash, label=f"$e_{k + 1}$: ± {size}{doubt}")
        legend.append(line)
    legend += _free_axes(ax, body, semi_axes, center, loose)
    times = "" if enlarged == 1.0 else f",\ndrawn {enlarged:g} times as large"
    title = f"where the axes point with {100.0 * coverage:.4g} %{times}"
    fonts = {"fontsize": "small", "title_fontsize": "small"}
    drawn = ax.legend(handles=legend, title=title, loc="lower center", frameon=False, **fonts)
    drawn.set_in_layout(False)


def _ellipses(
    covariance: Floats, radius: float
) -> tuple[dict[int, tuple[Floats, Floats]], NDArray[np.bool_]]:
    """Give semi-axes and their directions for each axis that has an ellipse, and the angles that are free.

    Free is an angle that is not determined, and one that reaches a right angle: an axis has no sense, so
    that it may point anywhere then.
    """
    loose = np.isnan(np.diagonal(covariance))
    ellipses: dict[int, tuple[Floats, Floats]] = {}
    for k in range(3):
        others = [(k + 1) % 3, (k + 2) % 3]
        if loose[others].any():
            continue
        values, vectors = np.linalg.eigh(axis_scatter(covariance, k))
        half = radius * np.sqrt(np.maximum(values, 0.0))
        ellipses[k] = half, vectors
        if half[1] >= 0.5 * np.pi:
            loose[others[int(np.diagonal(covariance)[others].argmax())]] = True
    # An axis may have come before the one that told.
    kept = {k: found for k, found in ellipses.items() if not np.delete(loose, k).any()}
    return kept, loose


def _free_axes(
    ax: Axes3D, body: RigidBody, semi_axes: Floats, center: Floats, loose: NDArray[np.bool_]
) -> list[Any]:
    """Draw the circle on which two axes lie anywhere; of a ball there is none, since all three do."""
    if not loose.any():
        return []
    if loose.sum() > 1:
        return list(ax.plot([], [], [], linestyle="none", label="axes not determined: anywhere"))
    k = int(loose.argmax())
    i, j = sorted({0, 1, 2} - {k})
    _on_ellipsoid(ax, principal_circles()[k], body, semi_axes, center, _INK, linestyle=":", linewidth=2.4)
    label = f"$e_{i + 1}$, $e_{j + 1}$: not determined, anywhere on the circle"
    return list(ax.plot([], [], [], color=_INK, linestyle=":", linewidth=2.4, label=label))


def _on_ellipsoid(
    ax: Axes3D,
    directions: Floats,
    body: RigidBody,
    semi_axes: Floats,
    center: Floats,
    color: str,
    **style: Any,
) -> None:
    """Draw a curve of directions in principal axes where they meet the ellipsoid."""
    points = directions / np.linalg.norm(directions / semi_axes, axis=-1, keepdims=True)
    normals = points / semi_axes**2
    axes = body.principal.axes.T
    curve_on(ax, points @ axes + center, normals @ axes, color, **style)
