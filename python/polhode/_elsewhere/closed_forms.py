"""Motions in closed form at times that are computed later."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from polhode._elsewhere.datasets import check_coordinates, dataset, require_xarray
from polhode._elsewhere.kinds import check_real, dask_array, labelled

__all__ = ["motion_at"]

_TAILS: Final = {"omega": 3, "quaternion": 4, "position": 3, "velocity": 3}


def motion_at(motion: Any, t: Any) -> Any:
    """Give the states of a motion as an `xarray.Dataset` of dask arrays.

    Parameters
    ----------
    motion : FreeMotion, HeavyTop or GyrostatMotion
    t : array_like

    Returns
    -------
    xarray.Dataset or None
        None where the times are in memory.
    """
    if dask_array(t) is None:
        return None
    check_real(dask_array(t), "t")
    body = motion.gyrostat.body if hasattr(motion, "gyrostat") else motion.body
    if body.covariance is not None or any(one is not None for one in getattr(motion, "uncertain_start", ())):
        raise ValueError(
            "t: the motion is uncertain, and states at times of dask have no place for a covariance; compute "
            "the times, or begin without sigmas"
        )
    xarray = require_xarray()
    depth = len(motion.shape)
    stack = ["body"] if depth == 1 else [f"body_{axis}" for axis in range(depth)]
    if labelled(t) is None:
        dims = ["time"] if t.ndim == 1 else [f"time_{axis}" for axis in range(t.ndim)]
        t = xarray.DataArray(t, dims=dims)
    results = {*stack, *_TAILS, "component", "quaternion_component"}
    check_coordinates(t, 0, results)
    taken = sorted(set(t.dims) & results)
    if taken:
        raise ValueError(f"t: its axis {taken[0]!r} has the name of one of the result; rename it")
    found = xarray.apply_ufunc(
        _chunk,
        t,
        kwargs={"motion": motion},
        output_core_dims=[[*stack, f"{name} "] for name in _TAILS],
        dask="parallelized",
        output_dtypes=[float] * len(_TAILS),
        dask_gufunc_kwargs={
            "output_sizes": dict(zip(stack, motion.shape, strict=True))
            | {f"{n} ": k for n, k in _TAILS.items()}
        },
    )
    # Not as the coordinate of its axis: that would be computed at once.
    name = "t" if "t" not in t.coords and "t" not in t.dims else "times"
    return dataset(dict(zip(_TAILS, found, strict=True)), stack, {name: t})


def _chunk(t: Any, *, motion: Any) -> Any:
    """Ask for the states of a chunk; the axes of the stack come after those of the times here."""
    run, depth = motion.at(t), len(motion.shape)
    front = tuple(range(depth))
    back = tuple(range(np.ndim(t), np.ndim(t) + depth))
    return tuple(np.moveaxis(getattr(run, name), front, back) for name in _TAILS)
