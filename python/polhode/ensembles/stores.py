"""Chunks in files. Each is written as a whole or not at all: an interrupted ensemble can be resumed."""

from __future__ import annotations

import errno
import json
import re
import zipfile
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np

from polhode._optional import require
from polhode.ensembles.fingerprint import build, fingerprint
from polhode.ensembles.plan import coordinates, layout
from polhode.errors import FileFormatError
from polhode.io.writing import write_bytes, writing

if TYPE_CHECKING:
    from collections.abc import Iterable

    from polhode.ensembles.plan import Plan

    Arrays = dict[str, np.ndarray[Any, Any]]

__all__ = ["NpzStore", "Store", "ZarrStore", "check_same", "header", "open_store"]

_HEADER: Final = "ensemble.json"
_KIND: Final = "polhode ensemble"


class Store(Protocol):
    """Where the chunks of an ensemble are kept."""

    def pending(self) -> list[int]:
        """Return the chunks that are not there."""

    def write(self, index: int, arrays: Arrays) -> None:
        """Write a chunk."""


def header(plan: Plan) -> dict[str, Any]:
    """Return the fields that identify an ensemble."""
    return {
        "kind": _KIND,
        "version": build()[0],
        "seed": plan.seed,
        "n": plan.n,
        "chunk": plan.chunk,
        "t": plan.t.tolist(),
        "inputs": fingerprint(plan),
    }


class NpzStore:
    """A directory with a file for every chunk.

    Parameters
    ----------
    path : pathlib.Path
    plan : Plan
    is_new : bool
        Whether it is made now; else it is one of this ensemble.
    """

    def __init__(self, path: Path, plan: Plan, *, is_new: bool) -> None:
        self.path, self.plan = path, plan
        if is_new:
            _check_new(path)
            path.mkdir(parents=True, exist_ok=True)
            write_bytes(path / _HEADER, json.dumps(header(plan), indent=1).encode())
        else:
            check_same(path, _header_in(path), header(plan))
            _remove(path.glob(".polhode-*"), r"\.polhode-[0-9a-f]{16}\.npz")

    def pending(self) -> list[int]:
        """Return the chunks that are not there."""
        return [index for index in range(self.plan.chunks) if not self._is_whole(index)]

    def _is_whole(self, index: int) -> bool:
        """Return whether the file of a chunk can be read to its end."""
        try:
            with zipfile.ZipFile(self.file(index)) as archive:
                names = {f"{name}.npy" for name in layout(self.plan)}
                return names <= set(archive.namelist()) and archive.testzip() is None
        except OSError as error:
            if error.errno not in (errno.ENOENT, errno.EINVAL):  # not there, or it points outside itself
                raise
            return False
        except (zipfile.BadZipFile, zlib.error, EOFError, ValueError, RuntimeError):
            return False

    def write(self, index: int, arrays: Arrays) -> None:
        """Write a chunk."""
        # Not by savez, some of whose own arguments a state may be called.
        with writing(self.file(index)) as stream, zipfile.ZipFile(stream, "w") as archive:
            for name, array in arrays.items():
                with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                    np.lib.format.write_array(member, np.asarray(array), allow_pickle=False)

    def file(self, index: int) -> Path:
        """Return the file of a chunk."""
        return self.path / f"chunk-{index:08}.npz"


class ZarrStore:
    """A zarr group that xarray opens, with one piece for every chunk.

    Parameters
    ----------
    path : pathlib.Path
    plan : Plan
    is_new : bool
        Whether it is made now; else it is one of this ensemble.
    """

    def __init__(self, path: Path, plan: Plan, *, is_new: bool) -> None:
        zarr = require("zarr", extra="cluster", purpose="to_zarr")
        self.path, self.plan = path, plan
        if not is_new:
            self.group = zarr.open_group(path, mode="r+")
            check_same(path, dict(self.group.attrs), header(plan))
            _remove(path.rglob("*.partial"), r"[^/]+\.[0-9a-f]{32}\.partial")
            return
        _check_new(path)
        # The second format has fixed-width words, and every reader of today knows it.
        self.group = zarr.open_group(path, mode="w", zarr_format=2)
        for name, (axis, values) in coordinates(plan).items():
            values = np.asarray(values)
            # By default zero stands for what is missing, and a time of zero is read as none.
            missing = np.nan if values.dtype.kind == "f" else ""
            array = self.group.create_array(name, shape=values.shape, dtype=values.dtype, fill_value=missing)
            array[:] = values
            array.attrs["_ARRAY_DIMENSIONS"] = [axis]
        for name, variable in layout(plan).items():
            array = self.group.create_array(
                name,
                shape=(plan.n, *variable.tail),
                chunks=(plan.chunk, *(max(size, 1) for size in variable.tail)),
                dtype=variable.dtype,
                fill_value="" if variable.dtype == "<U8" else np.nan,
                config={"write_empty_chunks": True},  # a piece that is not there is one that was lost
            )
            array.attrs.update({"_ARRAY_DIMENSIONS": list(variable.dims), **variable.attributes})
        self.group.attrs.update(header(plan))  # last: what has no header was never begun
        zarr.consolidate_metadata(self.group.store)

    def pending(self) -> list[int]:
        """Return the chunks that are not there."""
        plan, status = self.plan, self.group["status"]
        return [
            index
            for index in range(plan.chunks)
            if not status[index * plan.chunk] or not all(self._holds(name, index) for name in layout(plan))
        ]

    def _holds(self, name: str, index: int) -> bool:
        """Return whether the piece of an array is there, of a chunk that has been written."""
        array = self.group[name]
        piece = ".".join([str(index), *("0" for _ in array.shape[1:])])
        return (self.path / name / piece).is_file()

    def write(self, index: int, arrays: Arrays) -> None:
        """Write a chunk. Its status comes last and marks it as complete."""
        first, count = self.plan.bounds(index)
        for name in layout(self.plan):
            self.group[name][first : first + count] = arrays[name]


def _remove(files: Iterable[Path], name: str) -> None:
    """Remove incomplete files of a process that was killed: those that match this pattern."""
    for file in files:
        if re.fullmatch(name, file.name):
            file.unlink()


def open_store(path: Path, plan: Plan) -> Store:
    """Open the store of this ensemble that is at a path.

    Parameters
    ----------
    path : pathlib.Path
    plan : Plan

    Returns
    -------
    Store

    Raises
    ------
    FileFormatError
        For what is no ensemble, or another one.
    """
    if (path / _HEADER).is_file():
        return NpzStore(path, plan, is_new=False)
    if (path / ".zgroup").is_file():
        return ZarrStore(path, plan, is_new=False)
    if not path.exists():
        raise FileNotFoundError(f"{path}: there is nothing to go on with; to_zarr and to_npz begin anew")
    raise FileFormatError(f"{path}: holds no ensemble that to_zarr or to_npz has begun; give another path")


def _header_in(path: Path) -> dict[str, Any]:
    """Read the header of the ensemble in a directory."""
    try:
        found = json.loads((path / _HEADER).read_text("utf-8"))
    except ValueError as error:
        found = error
    if not isinstance(found, dict):
        raise FileFormatError(
            f"{path}: {_HEADER} does not say what ensemble this is; begin anew at another path"
        )
    return found


def _check_new(path: Path) -> None:
    if path.is_dir() and not any(path.iterdir()):
        return
    if path.exists():
        raise FileExistsError(f"{path}: is there already; resume goes on with it, another path begins anew")
    for parent in path.parents:
        if parent.exists() and not parent.is_dir():
            raise NotADirectoryError(f"{path}: {parent} is a file, not a directory; give another path")


def check_same(path: Path, found: dict[str, Any], wanted: dict[str, Any]) -> None:
    """Refuse a file without an ensemble, or with another ensemble."""
    if found.get("kind") != wanted["kind"]:
        what = "ensemble that to_zarr or to_npz" if wanted["kind"] == _KIND else "reductions that compute"
        raise FileFormatError(f"{path}: holds no {what} has begun; give another path")
    more = " or an option" if wanted["kind"] == _KIND else ", an option or a reduction"
    for name, here in wanted.items():
        there = found.get(name)
        if there == here:
            continue
        if name == "version":
            way = f"install polhode {there}, or begin anew at another path"
        else:
            way = "go on with the ensemble that it was begun with, or begin anew at another path"
        if name in ("t", "inputs"):
            what = "the times are" if name == "t" else f"the body, the load, the state at the start{more} is"
            raise FileFormatError(f"{path}: holds another ensemble: {what} not the same ({way})")
        raise FileFormatError(
            f"{path}: holds another ensemble: {name} is {there} there and {here} here ({way})"
        )
