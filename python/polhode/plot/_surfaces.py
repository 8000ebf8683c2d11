"""Surfaces and the curves on them, drawn in the right order."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._extras import require

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d.axes3d import Axes3D
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["arrow", "curve_on", "fan", "inertia_semi_axes", "plain_frame", "solid_ellipsoid", "toward_viewer"]

_SURFACE: Final = np.array([0.79, 0.84, 0.91])
_LONGEST: Final = 3.0
"""A semi-axis without end, that of a zero moment, is cut at so many times the longest other one."""


def toward_viewer(ax: Axes3D) -> Floats:
    """Find the unit vector from the scene toward the viewer."""
    elevation, azimuth = np.deg2rad([ax.elev, ax.azim])
    level = np.cos(elevation)
    return np.array([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)])


def inertia_semi_axes(moments: Floats) -> Floats:
    """Semi-axes of r·I r = 1, shape (3,); those of zero moments are cut.

    Parameters
    ----------
    moments : numpy.ndarray, shape (3,)
        Principal moments, not all zero.
    """
    if not moments.any():
        raise ValueError("body: all its moments are zero; a point has no ellipsoid of inertia")
    with np.errstate(divide="ignore"):
        semi_axes: Floats = 1.0 / np.sqrt(moments)
    longest = semi_axes[np.isfinite(semi_axes)].max()
    cut: Floats = np.minimum(semi_axes, _LONGEST * longest)
    return cut


def solid_ellipsoid(ax: Axes3D, semi_axes: Floats, axes: Floats, center: Floats, opacity: float) -> None:
    """Draw an ellipsoid whose axes are the columns of a matrix."""
    polar, around = np.meshgrid(np.linspace(0.0, np.pi, 61), np.linspace(0.0, 2.0 * np.pi, 121))
    unit = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=-1)
    points = (unit * semi_axes) @ axes.T + center
    normals = (unit / semi_axes) @ axes.T
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    light = toward_viewer(ax) + np.array([0.0, 0.0, 0.7])
    brightness = 0.84 + 0.2 * (normals @ (light / np.linalg.norm(light)))
    colors = np.clip(brightness[..., np.newaxis] * _SURFACE, 0.0, 1.0)
    ax.plot_surface(
        *np.moveaxis(points, -1, 0), facecolors=colors, shade=False, alpha=opacity, linewidth=0,
        antialiased=False, zorder=2, rcount=121, ccount=121,
    )  # fmt: skip


def curve_on(ax: Axes3D, points: Floats, normals: Floats, color: str, **style: Any) -> None:
    """Draw a curve on a convex surface: strong where it faces the viewer, faint behind.

    Parameters
    ----------
    ax : mpl_toolkits.mplot3d.axes3d.Axes3D
    points, normals : numpy.ndarray, shape (n, 3)
        The curve, and the outward normals of the surface along it.
    color : str
    **style
        Of the line.
    """
    near = normals @ toward_viewer(ax) >= 0.0
    for side, order, faint in ((near, 4, {}), (~near, 3, {"alpha": 0.3, "linewidth": 0.8})):
        # A part begins at the last point of the other one, so that no gap is seen.
        shown = side | np.roll(side, 1) if order == 4 else side
        visible = np.where(shown[:, np.newaxis], points, np.nan)
        ax.plot(*visible.T, **({"color": color, "linewidth": 1.6, "zorder": order} | style | faint))


def fan(ax: Axes3D, directions: Floats, color: str, opacity: float) -> None:
    """Draw the cone from the origin over a curve."""
    art3d: Any = require("mpl_toolkits.mplot3d.art3d", extra="plot", purpose="drawing")
    apex = np.zeros_like(directions[1:])
    triangles = np.stack([apex, directions[:-1], directions[1:]], axis=1)
    ax.add_collection3d(
        art3d.Poly3DCollection(triangles, facecolors=color, edgecolors="none", alpha=opacity, zorder=2)
    )
    ax.plot(*directions.T, color=color, linewidth=1.4, zorder=3)


def arrow(ax: Axes3D, tip: Floats, color: str, name: str, *, order: int = 6) -> None:
    """Draw a vector from the origin, with its name."""
    ax.quiver(*np.zeros(3), *tip, color=color, linewidth=2.0, arrow_length_ratio=0.08, zorder=order)
    ax.text(*(1.1 * tip), name, color=color, ha="center", va="center", fontsize=13, zorder=order)


def plain_frame(ax: Axes3D, low: ArrayLike, high: ArrayLike) -> None:
    """Show a cube about the box between two corners, without coordinate axes."""
    corners = np.array([low, high], dtype=np.float64)
    middle, half = corners.mean(axis=0), 0.5 * float(np.ptp(corners, axis=0).max())
    for name, value in zip("xyz", middle, strict=True):
        getattr(ax, f"set_{name}lim")(value - half, value + half)
    ax.set_box_aspect((1.0, 1.0, 1.0), zoom=1.2)
    ax.set_axis_off()
