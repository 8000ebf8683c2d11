"""Closed forms at any times, by runs that begin at t = 0."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode.trajectory import Trajectory

    Places = NDArray[np.intp]

__all__ = ["runs_from_zero"]


def runs_from_zero(run: Trajectory) -> list[tuple[Trajectory, Places, Places]]:
    """Give runs of a closed form from t = 0, forwards and backwards, which meet all times of this one.

    With each: which of the times, flat, and their places in the run.

    Raises
    ------
    ValueError
        For a run that goes on from another one, and for one from a file that does not hold its load.
    """
    motion = run.uncertain_start
    if motion is None or isinstance(motion, tuple):
        raise ValueError(
            "covariance: the state at the first time is uncertain by the motion before it, or a load acted "
            "that a file did not keep; simulate from the start on, or ask uncertainty.propagate"
        )
    times, found = np.ravel(run.t), []
    for sense, is_its in ((1.0, times >= 0.0), (-1.0, times < 0.0)):
        if is_its.any():
            distances, places = np.unique(np.append(0.0, np.abs(times[is_its])), return_inverse=True)
            found.append((motion.at(sense * distances), np.flatnonzero(is_its), places.ravel()[1:]))
    return found
