"""Where ``polhode ensemble --save`` writes: a zarr group, or one file of NumPy."""

from __future__ import annotations

import json
import shutil
import zipfile
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._extras import require
from polhode.ensembles.layout import coordinates, layout
from polhode.ensembles.stores import check_same, header
from polhode.errors import FileFormatError, PolhodeError
from polhode.files.writing import writing

if TYPE_CHECKING:
    from pathlib import Path

    from polhode.ensembles.result import Ensemble

__all__ = ["check_place", "saved"]

_NPZ, _ZARR = ".npz", ".zarr"
_HEADER: Final = "ensemble.json"
"""In the file: what ensemble it is, so that no other one is taken for it."""


def check_place(path: Path, *, resume: bool) -> None:
    """Refuse what cannot be begun or gone on with there, before anything is computed.

    Parameters
    ----------
    path : pathlib.Path
    resume : bool
        Whether to go on.
    """
    if path.suffix.lower() not in (_NPZ, _ZARR):
        raise PolhodeError(
            f"--save: {path.name!r} has a suffix that is not written; use one of {_NPZ}, {_ZARR}"
        )
    begun = next((place for place in (path, _parts(path)) if _is_there(place)), None)
    if begun is not None and not resume:
        raise PolhodeError(
            f"--save: {begun} is there already; add --resume to go on with it, or give another name"
        )
    if begun is None and resume:
        raise PolhodeError(
            f"--resume: there is nothing at {path} to go on with; leave --resume out to begin it"
        )


def saved(many: Ensemble, path: Path) -> dict[str, int]:
    """Run members that are missing there, and count how all of them ended.

    Parameters
    ----------
    many : Ensemble
    path : pathlib.Path

    Returns
    -------
    dict of str to int
        By the status.
    """
    if path.suffix.lower() == _ZARR:
        many.resume(path) if _is_there(path) else many.to_zarr(path)
        zarr = require("zarr", extra="cluster", purpose="--save")
        group: Any = zarr.open_group(path, mode="r")
        status = group["status"][:]
    else:
        parts = _parts(path)
        if path.exists():  # it was put together, and ended before its parts were removed
            _check_whole(path, many)
        else:
            many.resume(parts) if _is_there(parts) else many.to_npz(parts)
            _put_together(parts, path, many)
        if parts.exists():
            shutil.rmtree(parts)
        with np.load(path) as found:
            status = found["status"]
    names, counts = np.unique(np.asarray(status), return_counts=True)
    return dict(zip(map(str, names), counts.tolist(), strict=True))


def _parts(path: Path) -> Path:
    """Give the folder of the chunks of a file, until all are there."""
    return path.with_name(f"{path.name}.parts")


def _is_there(path: Path) -> bool:
    return path.exists() and not (path.is_dir() and not any(path.iterdir()))


def _put_together(parts: Path, path: Path, many: Ensemble) -> None:
    """Write one file, a chunk in memory at a time."""
    plan = many.plan
    chunks = [parts / f"chunk-{index:08}.npz" for index in range(plan.chunks)]
    with writing(path) as stream, zipfile.ZipFile(stream, "w") as archive:
        archive.writestr(_HEADER, json.dumps(header(plan)))
        for name, variable in layout(plan).items():
            with _member(archive, name) as member:
                words: Any = {
                    "descr": variable.dtype, "fortran_order": False, "shape": (plan.n, *variable.tail)
                }  # fmt: skip
                np.lib.format.write_array_header_1_0(member, words)
                for chunk in chunks:
                    with np.load(chunk) as found:
                        member.write(np.ascontiguousarray(found[name], variable.dtype).tobytes())
        for name, (_, values) in coordinates(plan).items():
            with _member(archive, name) as member:
                np.lib.format.write_array(member, np.asarray(values), allow_pickle=False)


def _member(archive: zipfile.ZipFile, name: str) -> Any:
    return archive.open(f"{name}.npy", "w", force_zip64=True)


def _check_whole(path: Path, many: Ensemble) -> None:
    """Refuse a file that is not this ensemble's."""
    try:
        with zipfile.ZipFile(path) as archive:
            found = json.loads(archive.read(_HEADER))
    except (zipfile.BadZipFile, KeyError, ValueError) as error:
        raise FileFormatError(
            f"{path}: holds no ensemble that --save has written ({error}); give another name, or delete it"
        ) from None
    check_same(path, found, header(many.plan))
