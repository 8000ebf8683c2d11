"""Places for the names in a picture, so that none is written over another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["Name", "placed"]

_AROUND: Final = np.deg2rad([0.0, 45.0, -45.0, 90.0, -90.0, 135.0, -135.0, 180.0])
_FAR: Final = (0.75, 1.4, 2.2)
"""From the point to the text, in heights of the text."""
_APART: Final = 0.1
"""Least space between two names, in the same."""


@dataclass(frozen=True)
class Name:
    """What is written beside a point of a picture.

    Attributes
    ----------
    text, color, weight : str
        As matplotlib takes them.
    at, away : numpy.ndarray, shape (2,)
        The point, and a direction: the text stands that way from it, where there is room.
    size : numpy.ndarray, shape (2,)
        Width and height of the text, in pixels as the point.
    """

    text: str
    color: str
    weight: str
    at: Floats
    away: Floats
    size: Floats


def placed(names: Sequence[Name], low: Floats, high: Floats) -> list[tuple[Name, Floats]]:
    """Find the middle of each name; one that has no room of its own between two corners is left out.

    Parameters
    ----------
    names : sequence of Name
        The most important first.
    low, high : numpy.ndarray, shape (2,)
        The corners.
    """
    done: list[tuple[Name, Floats]] = []
    for name in names:
        half = 0.5 * name.size
        if (high - low < name.size).any():
            continue
        for far in _FAR:
            found = False
            for turn in _AROUND:
                cosine, sine = np.cos(turn), np.sin(turn)
                way = np.array([[cosine, -sine], [sine, cosine]]) @ name.away
                beyond = far * name.size[1] + abs(way[0]) * max(half[0] - half[1], 0.0)
                middle = np.clip(name.at + beyond * way, low + half, high - half)
                if not any(_overlap(name, middle, *other) for other in done):
                    done.append((name, middle))
                    found = True
                    break
            if found:
                break
    return done


def _overlap(name: Name, middle: Floats, other: Name, there: Floats) -> bool:
    apart = np.abs(middle - there) - 0.5 * (name.size + other.size)
    return bool((apart < _APART * min(name.size[1], other.size[1])).all())
