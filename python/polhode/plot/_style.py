"""Axes to draw in, and how they look."""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Any, TypeVar, cast

from polhode._extras import require

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from mpl_toolkits.mplot3d.axes3d import Axes3D

__all__ = [
    "axes_2d",
    "axes_3d",
    "matplotlib",
    "show_around",
    "tidy",
]

_Given = TypeVar("_Given")


def matplotlib(module: str) -> Any:
    """Import a module of matplotlib, or say what installs it."""
    return require(f"matplotlib.{module}", extra="plot", purpose="drawing")


def axes_2d(ax: Axes | None) -> Axes:
    """Give the axes to draw in, in a new figure where there are none."""
    if ax is not None:
        return _checked(ax)
    return cast("Axes", matplotlib("pyplot").subplots(layout="constrained")[1])


def axes_3d(ax: Axes3D | None) -> Axes3D:
    """Give the axes of three dimensions to draw in, in a new figure where there are none."""
    if ax is not None:
        return _checked(ax)
    figure = matplotlib("pyplot").figure(layout="constrained")
    return cast("Axes3D", figure.add_subplot(projection="3d", computed_zorder=False))


def _checked(ax: _Given) -> _Given:
    if isinstance(ax, str | PathLike):
        raise TypeError(
            f"ax: expected axes of matplotlib, got {str(ax)!r}; draw first and save the figure: "
            f".figure.savefig({str(ax)!r}) of what this returns"
        )
    return ax


def tidy(ax: Axes) -> Axes:
    """Give axes over time the grid and the open frame that all of them have."""
    ax.margins(x=0.0)
    ax.grid(color="0.9", linewidth=0.6)
    ax.set_axisbelow(True)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    return ax


def show_around(ax: Axes3D, middle: Any, half: float) -> None:
    """Show the cube around a point that reaches so far along every axis."""
    for name, value in zip("xyz", middle, strict=True):
        getattr(ax, f"set_{name}lim")(value - half, value + half)
