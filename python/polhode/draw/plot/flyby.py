"""Picture of the clones after a flyby."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from polhode._hints import check_kind, with_hints
from polhode.draw.plot.axes import axes_2d, columns_that_fit, matplotlib, room, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["flyby"]

_COLORS = {"short-axis": "#0072b2", "long-axis": "#d55e00"}
_OTHER = "#999999"


@with_hints
def flyby(
    found: Any,
    of: Literal["spin_ratio", "pole_shift", "rotation_period", "precession_period"] = "spin_ratio",
    ax: Axes | None = None,
    *,
    time_label: str = "",
    time_scale: float = 1.0,
    bins: int = 40,
) -> Axes:
    """Draw a histogram of a number of the clones after a flyby, by mode, with its value before.

    Parameters
    ----------
    found : Flyby
        Result of :func:`polhode.flybys.flyby`.
    of : {"spin_ratio", "pole_shift", "rotation_period", "precession_period"}
        The number: a property of :class:`polhode.flybys.Flyby`, or a period after the flyby.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure by default.
    time_label : str, optional
        Word for the unit of the periods; it converts no number.
    time_scale : float, optional
        Periods are divided by this number: 3600 shows periods in seconds as hours.
    bins : int, optional
        Number of bars. They show 99 % of the clones; those beyond are in the outermost bars, which are
        hatched then, and the legend counts them.

    Returns
    -------
    matplotlib.axes.Axes
    """
    check_kind(found, "found", "Flyby")
    ax = axes_2d(ax)
    unit = f" ({time_label})" if time_label else ""
    values: Any
    before: float | None = None
    match of:
        case "spin_ratio":
            label, values, before = "spin rate, after / before", found.spin_ratio, 1.0
        case "pole_shift":
            label, values = "shift of the pole (degrees)", np.degrees(found.pole_shift)
        case "rotation_period" | "precession_period":
            symbol = "$P_\\psi$" if of == "rotation_period" else "$P_\\varphi$"
            name = of.replace("_", " ")
            label, values = f"{name} {symbol}{unit}", getattr(found.after, of) / time_scale
            before = float(np.nanmedian(getattr(found.before, of))) / time_scale
        case _:
            raise ValueError(
                'of: expected "spin_ratio", "pole_shift", "rotation_period" or "precession_period", '
                f"got {of!r}"
            )
    known = np.isfinite(values)
    low, high = np.quantile(values[known], (0.005, 0.995)) if known.any() else (0.0, 1.0)
    if not high > low:
        low, high = low - 0.5, high + 0.5
    edges = np.linspace(0.0 if of == "pole_shift" else low, high, bins + 1)
    shown = np.clip(values, edges[0], edges[-1])
    modes = list(np.unique(found.after.mode[known]))
    ax.hist(
        [shown[known & (found.after.mode == mode)] for mode in modes],
        edges.tolist(),
        stacked=True,
        color=[_COLORS.get(str(mode), _OTHER) for mode in modes],
        label=[f"{mode} after" for mode in modes],
        edgecolor="white",
        linewidth=0.4,
    )
    tails = _hatch_tails(ax, values[known], edges)
    if before is not None:
        ax.axvline(before, color="black", linewidth=1.2, linestyle="--", label="before")
    ax.set_xlabel(label)
    ax.set_ylabel("clones")
    handles = [*ax.get_legend_handles_labels()[0], *tails]
    names = [str(handle.get_label()) for handle in handles]
    ax.legend(
        handles=handles, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, frameon=False,
        fontsize="small", columnspacing=1.2, ncols=columns_that_fit(0.85 * room(ax)[0], names, 8.4, 4),
    )  # fmt: skip
    return tidy(ax)


def _hatch_tails(ax: Axes, values: Any, edges: Any) -> list[Any]:
    """Hatch the outermost bars, which also hold the values beyond them; return the legend's entry."""
    patches: Any = matplotlib("patches")
    style = {"fill": False, "hatch": "////", "edgecolor": "0.2", "linewidth": 0.0}
    below, above = int((values < edges[0]).sum()), int((values > edges[-1]).sum())
    inner = int((values < edges[1]).sum()), int((values >= edges[-2]).sum())
    for count, height, edge in ((below, inner[0], edges[0]), (above, inner[1], edges[-2])):
        if count:
            ax.add_patch(patches.Rectangle((edge, 0.0), edges[1] - edges[0], height, **style))
    parts = [f"{count} {where}" for count, where in ((below, "below"), (above, "above")) if count]
    return [patches.Patch(**style, label=f"and beyond: {', '.join(parts)}")] if parts else []
