"""What all pictures share: colours, dashes and new axes."""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Any, Final, TypeVar, cast

from polhode._extras import require

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from mpl_toolkits.mplot3d.axes3d import Axes3D

__all__ = [
    "AXIS_COLORS",
    "AXIS_DASHES",
    "MOMENTUM_COLOR",
    "OMEGA_COLOR",
    "OUTLINE_COLOR",
    "axes_2d",
    "axes_3d",
    "matplotlib",
    "tidy",
]

_Given = TypeVar("_Given")

AXIS_COLORS: Final = ("#0072B2", "#D55E00", "#009E73")
"""Blue, vermilion and bluish green: first, second and third axis."""
AXIS_DASHES: Final = ("--", "-", "-.")
"""Of lines in those colours."""
OMEGA_COLOR: Final = "#B0479A"
"""Reddish purple: the angular velocity."""
MOMENTUM_COLOR: Final = "#111111"
"""Nearly black: the angular momentum."""
OUTLINE_COLOR: Final = (0.17, 0.18, 0.22)
"""Red, green and blue of a body's edges."""


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
