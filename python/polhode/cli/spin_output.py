"""What ``polhode spin`` saves: a picture, an animation or the numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Literal

from polhode._extras import require
from polhode._files.trajectory import TRAJECTORY_SUFFIXES
from polhode.animation import ANIMATION_SUFFIXES, animate
from polhode.cli.progress import progress
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from polhode import Trajectory
    from polhode.cli.options import SpinOptions

__all__ = ["check_paths", "save"]

PICTURE_SUFFIXES: Final = (".png", ".pdf", ".svg")
_SUFFIXES: Final = (*PICTURE_SUFFIXES, *ANIMATION_SUFFIXES, *TRAJECTORY_SUFFIXES)
_FRAMES: Final = 300
"""Pictures of an animation: ten seconds at thirty a second."""


def check_paths(paths: Sequence[Path]) -> None:
    """Refuse what cannot be written before anything is computed."""
    for path in paths:
        if path.suffix.lower() not in _SUFFIXES:
            raise PolhodeError(f"--save: {path} does not end in one of {', '.join(_SUFFIXES)}")
        if not path.parent.is_dir():
            raise PolhodeError(f"--save: there is no directory {path.parent}; create it first")


def save(trajectory: Trajectory, path: Path, spin: SpinOptions, *, title: str) -> None:
    """Write a motion in the form that the name asks for."""
    suffix = path.suffix.lower()
    if suffix in TRAJECTORY_SUFFIXES:
        trajectory.save(path)
    elif suffix in ANIMATION_SUFFIXES:
        with progress(f"drawing {path.name}"):
            animate(
                trajectory,
                path,
                frames=min(_FRAMES, len(trajectory)),
                title=title or "Motion of a rigid body",
            )
    else:
        _draw(trajectory, path, spin, title)


def _draw(trajectory: Trajectory, path: Path, spin: SpinOptions, title: str) -> None:
    figure_module = require("matplotlib.figure", extra="plot", purpose=f"--save {path}:")
    from polhode.plot import angular_velocity

    # A figure of its own, outside pyplot: no window system is asked for.
    figure = figure_module.Figure(figsize=(8.0, 4.5), layout="constrained")
    frame: Literal["body", "principal"] = "principal" if spin.axes == "principal" else "body"
    ax = angular_velocity(trajectory, figure.add_subplot(), frame=frame, degrees=spin.degrees)
    ax.set_title(title, loc="left")
    figure.savefig(path, dpi=160)
