"""Which arrays are not in memory."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["check_real", "check_sizes", "dask_array", "in_memory", "is_stored", "labelled"]


def _library(array: Any) -> str:
    return type(array).__module__.partition(".")[0]


def labelled(array: Any) -> Any:
    """Give an array with names for its axes, of xarray; else None."""
    return array if _library(array) == "xarray" and hasattr(array, "variable") else None


def dask_array(array: Any) -> Any:
    """Give the array of dask that an argument is or that xarray holds; else None."""
    if labelled(array) is not None:
        array = array.data if getattr(array, "chunks", None) is not None else None
    if array is None or _library(array) != "dask":
        return None
    from dask.array import Array

    return array if isinstance(array, Array) else None


def is_stored(array: Any) -> bool:
    """Whether slices of an array are read from a file when they are asked for."""
    if labelled(array) is not None:
        return not getattr(array.variable, "_in_memory", True)
    return isinstance(array, np.memmap) or (
        _library(array) in ("h5py", "zarr") and hasattr(array, "shape") and hasattr(array, "dtype")
    )


def in_memory(array: Any) -> Any:
    """Give a piece of an array as what the core reads where it is; masked elements and units stay."""
    if labelled(array) is not None:
        return in_memory(array.variable.data)
    return np.asarray(array) if isinstance(array, np.memmap) else array


def check_sizes(array: Any, name: str) -> None:
    """Refuse an array of so many numbers as nobody knows."""
    if np.isnan(np.array(np.shape(array), dtype=float)).any():
        raise ValueError(
            f"{name}: the sizes of its chunks are not known; {name}.compute_chunk_sizes() finds them"
        )


def check_real(array: Any, name: str) -> None:
    """Refuse an array of dask of no real numbers, or of so many as nobody knows, before it is computed."""
    if array.dtype.kind not in "biuf":
        raise TypeError(f"{name}: expected real numbers, got dtype {array.dtype}")
    check_sizes(array, name)
    if isinstance(array._meta, np.ma.MaskedArray):
        raise TypeError(
            f"{name}: its elements may be masked and have no value; give them values with "
            "dask.array.ma.filled(array, value)"
        )
