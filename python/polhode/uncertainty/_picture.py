"""Pictures of a ledger: who contributes mass, as a sunburst, and who contributes variance, as bars."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._rounding import with_sigma
from polhode.plot._style import axes_2d, matplotlib

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from polhode.uncertainty._results import Part
    from polhode.uncertainty._shares import Shares

__all__ = ["bars", "sunburst"]

_RINGS: Final = 3
"""Levels of a sunburst."""
_LEAST: Final = 0.004
"""Of the circle: what is less is drawn together with its neighbours of that kind."""
_NAMED: Final = 0.025
"""Of the circle: what is less bears no name."""
_UPRIGHT: Final = 0.2
"""In the first ring what is more than two thirds of this bears its name upright; farther out less will do."""
_DARK: Final = 0.5
"""Brightness below which letters are white."""
_BARS: Final = 12
_LONGEST: Final = 22
_COLORS: Final = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#F0E442")
"""Those of Okabe and Ito."""
_OTHERS: Final = "0.8"


def sunburst(node: Part, ax: Axes | None = None) -> Axes:
    """Draw the masses below a node: a ring for each level, an angle for each mass."""
    ax = axes_2d(ax)
    total = node.mass
    levels = min(_RINGS, _height(node, _RINGS))
    waiting: list[tuple[Part, float, int, str]] = [(node, 0.0, 0, "")]
    while waiting:
        parent, start, level, inherited = waiting.pop()
        if level == levels:
            continue
        rest, shown = 0.0, 0
        for child in sorted(parent.children, key=lambda child: -child.mass):
            share = child.mass / total
            if share < _LEAST:
                rest += share
                continue
            color = inherited or _COLORS[shown % len(_COLORS)]
            _wedge(ax, child.id, start, share, level, color)
            waiting.append((child, start, level + 1, color))
            start += share
            shown += 1
        if rest:
            _wedge(ax, "others", start, rest, level, _OTHERS)
    mass = with_sigma(*node.with_sigma("mass"))
    ax.text(0.0, 0.0, f"{_short(node.id)}\n{mass}", ha="center", va="center", fontsize=10, parse_math=False)
    reach = 1.02 * (1.0 + max(levels, 1))
    ax.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    ax.set_title(f"mass of {_short(node.id)}", parse_math=False)
    ax.set_axis_off()
    return ax


def bars(shares: Shares, ax: Axes | None = None) -> Axes:
    """Draw the largest shares of a variance, each bar split by the number whose error it is."""
    ax = axes_2d(ax)
    count = min(len(shares), _BARS)
    split = 100.0 * shares.by_number[:count]
    names = [_short(name) for name in shares.names[:count]]
    if len(shares) > count:
        split = np.vstack([split, 100.0 * shares.by_number[count:].sum(axis=0)])
        names.append(f"{len(shares) - count} others")
    groups = (("mass", slice(0, 1)), ("centre", slice(1, 4)), ("tensor", slice(4, 10)))
    left = np.zeros(len(names))
    for (label, numbers), color in zip(groups, _COLORS, strict=False):
        width = split[:, numbers].sum(axis=1)
        if width.any():
            ax.barh(np.arange(len(names)), width, left=left, color=color, label=f"its {label}", height=0.7)
        left += width
    for row, width in enumerate(left):
        ax.text(width + 1.0, row, f"{width:.3g} %", va="center", fontsize=8)
    ax.set_yticks(np.arange(len(names)), names, parse_math=False)
    ax.invert_yaxis()
    ax.set_xlim(0.0, max(1.18 * float(left.max()), 1.0))
    told = f"share of the variance of {shares.of} of {_short(shares.at)}, %; sigma {shares.sigma:.2g}"
    ax.set_xlabel(told, parse_math=False)
    ax.legend(frameon=False, ncols=3, title="error of", loc="lower left", bbox_to_anchor=(0.0, 1.0))
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    return ax


def _wedge(ax: Axes, name: str, start: float, share: float, level: int, color: str) -> None:
    """Draw one part: `start` and `share` in turns, clockwise from the top."""
    patches: Any = matplotlib("patches")
    begin, end = 90.0 - 360.0 * (start + share), 90.0 - 360.0 * start
    # Farther out paler, down to a third of the colour.
    shade = matplotlib("colors").to_rgba(color, 1.0 - 0.25 * level)
    inner = 1.0 + level
    ax.add_patch(
        patches.Wedge((0.0, 0.0), inner + 1.0, begin, end, width=1.0, facecolor=shade, edgecolor="white")
    )
    if share < _NAMED:
        return
    middle = np.deg2rad(0.5 * (begin + end))
    turn = np.rad2deg(middle) % 360.0
    turn = turn + 180.0 if 90.0 < turn < 270.0 else turn
    if share > _UPRIGHT / (inner + 0.5):
        turn = 0.0
    place = (inner + 0.5) * np.array([np.cos(middle), np.sin(middle)])
    brightness = shade[3] * np.dot(shade[:3], (0.3, 0.59, 0.11)) + 1.0 - shade[3]
    ax.text(
        float(place[0]),
        float(place[1]),
        f"{_short(name)}\n{100.0 * share:.3g} %",
        ha="center",
        va="center",
        fontsize=7,
        rotation=turn,
        parse_math=False,
        color="white" if brightness < _DARK else "black",
    )


def _height(node: Part, most: int) -> int:
    """Count the levels below a node, up to so many."""
    if most == 0 or not node.children:
        return 0
    return 1 + max(_height(child, most - 1) for child in node.children)


def _short(name: str) -> str:
    return name if len(name) <= _LONGEST else f"{name[: _LONGEST - 3]}..."
