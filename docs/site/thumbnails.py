"""Pictures that are drawn to be small: one view of a figure, thick lines, no numbers and no words."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import numpy as np
from matplotlib import colors
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.lines import Line2D

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE = (3.2, 2.0)
"""Inches; at 200 dots each the file has twice the pixels of its place on the page."""

THEMES = {"light": "#ffffff", "dark": "#14181e"}
"""What is behind the picture: the page in both its modes."""


def save(figure: Figure, view: int, folder: Path) -> None:
    """Write ``light.png`` and ``dark.png`` of one view of a figure, which is changed for it."""
    ax = alone(figure, view)
    (in_space if ax.name == "3d" else in_plane)(ax)
    for theme, ground in THEMES.items():
        if theme == "dark" and ax.name != "3d":  # in space lines lie on light surfaces
            for artist in figure.findobj():
                turned(artist)
        figure.set_facecolor(ground)
        ax.set_facecolor("none")
        figure.savefig(folder / f"{theme}.png", dpi=200)


def alone(figure: Figure, view: int) -> Axes:
    """Leave one view of the figure, without a word."""
    kept = figure.axes[view]
    for ax in figure.axes:
        if ax is not kept:
            ax.remove()
    for words in (*figure.texts, *figure.legends, *kept.texts):
        words.remove()
    figure.suptitle("")
    kept.set_title("")
    if legend := kept.get_legend():
        legend.remove()
    figure.set_layout_engine("none")
    figure.set_size_inches(SIZE)
    return kept


def in_plane(ax: Axes) -> None:
    """Thick lines within a frame of two sides."""
    ax.set_position((0.05, 0.07, 0.9, 0.86))
    ax.set(xlabel="", ylabel="")
    ax.tick_params(which="both", length=0, labelleft=False, labelbottom=False, labelright=False)
    ax.grid(visible=False)
    for name, side in ax.spines.items():
        side.set(visible=name in {"left", "bottom"}, linewidth=1.0, color="0.45")
    for line in ax.lines:
        line.set_linewidth(max(2.0, 1.4 * line.get_linewidth()))
        line.set_markersize(1.2 * line.get_markersize())


def in_space(ax: Axes) -> None:
    """Fill the picture with what is drawn, without its box unless nothing but points is in it."""
    if all(isinstance(each, PathCollection) for each in ax.collections):
        ax.set(xlabel="", ylabel="", zlabel="", xticklabels=[], yticklabels=[], zticklabels=[])
        ax.tick_params(length=0)
        for points in ax.collections:
            points.set_sizes([70.0])
    else:
        ax.set_axis_off()
    for line in ax.lines:
        line.set_linewidth(1.3 * line.get_linewidth())
    fitted(ax)


def fitted(ax: Axes) -> None:
    """Move and stretch a view so that what is drawn in it just fits."""
    figure, first = ax.get_figure(root=True), np.array([0.2, 0.2])
    ax.set_position((*first, 0.6, 0.6))
    written = io.BytesIO()
    figure.savefig(written, format="rgba", dpi=100, facecolor="w")
    width, height = (round(100 * each) for each in SIZE)
    pixels = np.frombuffer(written.getvalue(), np.uint8).reshape(height, width, 4)
    drawn = np.argwhere(pixels[..., :3].min(axis=-1) < 250)[:, ::-1] / (width, height)
    low, high = drawn.min(axis=0), drawn.max(axis=0)
    middle = ((low + high) / 2 - (0, 1)) * (1, -1)  # rows go down, the figure goes up
    scale = 0.92 / (high - low).max()
    ax.set_position((*(0.5 - scale * (middle - first)), 0.6 * scale, 0.6 * scale))


def turned(artist: Artist) -> None:
    """Return lines the lightness that they need on a dark page."""
    if isinstance(artist, Line2D):
        for part in ("color", "markeredgecolor", "markerfacecolor"):
            value = getattr(artist, f"get_{part}")()
            if not isinstance(value, str) or value.lower() != "none":
                getattr(artist, f"set_{part}")(lighter(colors.to_rgba_array(value))[0])
    elif isinstance(artist, LineCollection):
        artist.set_color(lighter(colors.to_rgba_array(artist.get_color())))


def lighter(rgba: np.ndarray) -> np.ndarray:
    """Turn what is grey and dark round, and blend a dark colour with white."""
    found, shades = rgba.copy(), rgba[:, :3]
    grey = np.ptp(shades, axis=1) < 0.08
    turn, blend = grey & (shades.mean(axis=1) < 0.5), ~grey & (shades @ (0.2126, 0.7152, 0.0722) < 0.45)
    found[turn, :3] = 0.95 - 0.7 * shades[turn]
    found[blend, :3] = 0.3 + 0.7 * shades[blend]
    return found
