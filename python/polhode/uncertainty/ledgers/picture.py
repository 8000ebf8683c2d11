"""Pictures of a ledger: contributions to the mass as a sunburst, contributions to a variance as bars."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._format import with_sigma
from polhode.draw.plot.axes import axes_2d, columns_that_fit, matplotlib, room, text_size

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from polhode.uncertainty.ledgers.results import Part
    from polhode.uncertainty.ledgers.rollup import Shares

__all__ = ["bars", "sunburst"]

_RINGS: Final = 3
"""Largest number of levels of a sunburst."""
_LEAST: Final = 0.004
"""Fraction of the circle below which neighbouring wedges are drawn as one."""
_FILLED: Final = 0.94
"""Fraction of a figure for axes without labels and title."""
_MARGIN: Final = 0.04
"""Margin between a name and the edge of its wedge, relative to the width of a ring."""
_SIZES: Final = (8.0, 7.0, 6.0, 5.0)
"""Font sizes of names, the best first."""
_DARK: Final = 0.5
"""Brightness below which letters are white."""
_BARS: Final = 12
_LONGEST: Final = 22
_COLORS: Final = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#F0E442")
"""Colours of Okabe and Ito."""
_OTHERS: Final = "0.8"


def sunburst(node: Part, ax: Axes | None = None, *, mass_label: str | None = None) -> Axes:
    """Draw the masses below a node: a ring for each level, an angle for each mass."""
    ax = axes_2d(ax)
    total = node.mass
    levels = min(_RINGS, _height(node, _RINGS))
    reach = 1.02 * (1.0 + max(levels, 1))
    ax.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    ax.set_axis_off()
    unit = _FILLED * min(room(ax)) / (2.0 * reach)
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
            _wedge(ax, child.id.removeprefix(f"{parent.id}/"), start, share, level, color, unit)
            waiting.append((child, start, level + 1, color))
            start += share
            shown += 1
        if rest:
            _wedge(ax, "others", start, rest, level, _OTHERS, unit)
    mass = with_sigma(*node.with_sigma("mass"))
    words = f"mass of\n{_short(node.id)}\n{mass} {mass_label or ''}".rstrip()
    if mass_label is None:
        words = f"{words}\n(unit of the table)"
    size = min(10.0, 10.0 * 1.9 * unit / float(np.hypot(*text_size(words, 10.0, parse_math=False))))
    ax.text(0.0, 0.0, words, ha="center", va="center", fontsize=size, parse_math=False)
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
            label = f"error of its {label}"
            ax.barh(np.arange(len(names)), width, left=left, color=color, label=label, height=0.7)
        left += width
    for row, width in enumerate(left):
        ax.text(width + 1.0, row, f"{width:.3g} %", va="center", fontsize=8)
    ax.set_yticks(np.arange(len(names)), names, parse_math=False)
    ax.invert_yaxis()
    ax.set_xlim(0.0, max(1.18 * float(left.max()), 1.0))
    told = f"share of the variance (%) of {shares.of} of {_short(shares.at)}\nwith sigma {shares.sigma:.2g}"
    if text_size(told, 10.0, parse_math=False)[0] > 0.6 * room(ax)[0]:
        told = told.replace("(%) of", "(%)\nof", 1)
    ax.set_xlabel(told, parse_math=False)
    labels = ax.get_legend_handles_labels()[1]
    ax.legend(
        frameon=False, ncols=columns_that_fit(room(ax)[0], labels, 10.0, 3), loc="lower left",
        bbox_to_anchor=(0.0, 1.0), columnspacing=1.2,
    )  # fmt: skip
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    return ax


def _wedge(ax: Axes, name: str, start: float, share: float, level: int, color: str, unit: float) -> None:
    """Draw one part: `start` and `share` in turns, clockwise from the top; `unit` in points."""
    patches: Any = matplotlib("patches")
    begin, end = 90.0 - 360.0 * (start + share), 90.0 - 360.0 * start
    # Farther out paler, down to a third of the colour.
    shade = matplotlib("colors").to_rgba(color, 1.0 - 0.25 * level)
    inner = 1.0 + level
    ax.add_patch(
        patches.Wedge((0.0, 0.0), inner + 1.0, begin, end, width=1.0, facecolor=shade, edgecolor="white")
    )
    middle = 0.5 * (begin + end)
    found = _words_within(_short(name), f"{100.0 * share:.3g} %", middle, 360.0 * share, inner, unit)
    if found is None:
        return
    words, size, turn = found
    place = (inner + 0.5) * np.array([np.cos(np.deg2rad(middle)), np.sin(np.deg2rad(middle))])
    brightness = shade[3] * np.dot(shade[:3], (0.3, 0.59, 0.11)) + 1.0 - shade[3]
    ax.text(
        float(place[0]),
        float(place[1]),
        words,
        ha="center",
        va="center",
        fontsize=size,
        rotation=turn,
        parse_math=False,
        color="white" if brightness < _DARK else "black",
    )


def _words_within(
    name: str, share: str, middle: float, opening: float, inner: float, unit: float
) -> tuple[str, float, float] | None:
    """Choose words, size and rotation of what stands within a wedge; None where nothing does.

    Parameters
    ----------
    name, share : str
        What it would bear.
    middle, opening : float
        Angles of the wedge, in degrees.
    inner : float
        Its inner radius; it is 1 wide.
    unit : float
        Of the axes, in points.
    """
    shortened = [f"{name[:count]}..." for count in range(len(name) - 4, 2, -2)]
    choices = [
        *((f"{name}\n{share}", size) for size in _SIZES[:-1]),
        *((words, size) for words in (name, *shortened) for size in _SIZES),
    ]
    turns = dict.fromkeys([0.0, _readable(middle), _readable(middle - 90.0)])
    for words, size in choices:
        width, height = (length / unit for length in text_size(words, size, parse_math=False))
        for turn in turns:
            if _is_within(width, height, turn - middle, opening, inner):
                return words, size, turn
    return None


def _readable(turn: float) -> float:
    """Return the rotation by which a text along a direction is not upside down."""
    return (turn + 90.0) % 180.0 - 90.0


def _is_within(width: float, height: float, turn: float, opening: float, inner: float) -> bool:
    """Return whether a box in the middle of a wedge, turned against its radius, lies in it; in degrees."""
    along = np.linspace(-0.5, 0.5, 9)
    edge = np.full(9, 0.5)
    x = width * np.concatenate([along, along, edge, -edge])
    y = height * np.concatenate([edge, -edge, along, along])
    cosine, sine = np.cos(np.deg2rad(turn)), np.sin(np.deg2rad(turn))
    across, up = inner + 0.5 + cosine * x - sine * y, sine * x + cosine * y
    radius, angle = np.hypot(across, up), np.rad2deg(np.abs(np.arctan2(up, across)))
    is_between = (radius >= inner + _MARGIN) & (radius <= inner + 1.0 - _MARGIN)
    return bool((is_between & (angle <= 0.5 * opening - np.rad2deg(_MARGIN / radius))).all())


def _height(node: Part, most: int) -> int:
    """Count the levels below a node, up to so many."""
    if most == 0 or not node.children:
        return 0
    return 1 + max(_height(child, most - 1) for child in node.children)


def _short(name: str) -> str:
    return name if len(name) <= _LONGEST else f"{name[: _LONGEST - 3]}..."
