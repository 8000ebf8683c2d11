"""Files of named fields, read strictly: JSON for people, npz for NumPy."""

from __future__ import annotations

import errno
import io
import json
import math
import zipfile
from collections import Counter
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode.errors import FileFormatError
from polhode.io.budget import MOST_TEXT, Budget, LimitError, check_ordinary, naming, read_text, with_way_out
from polhode.io.writing import write_bytes, writing

if TYPE_CHECKING:
    from collections.abc import Collection
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = [
    "WORDS",
    "array_schema",
    "check_names",
    "counts",
    "in_json",
    "numbers",
    "read_json",
    "read_npz",
    "read_record",
    "record_suffix",
    "require_field",
    "write_json",
    "write_npz",
]

_EXACT: Final = 2**53
"""Whole numbers up to here are the same as float64."""


def read_json(file: Path) -> dict[str, Any]:
    """Read an object of fields from JSON.

    Raises
    ------
    FileFormatError
        If it is damaged, not an object, names a field twice or holds numbers that JSON does not have.
    """
    text = read_text(file, "JSON")
    try:
        fields = json.loads(text, parse_constant=_refuse_constant, object_pairs_hook=_once)
    except RecursionError:
        raise FileFormatError(
            f"{file}: not JSON: its parts are nested beyond reason; save it again"
        ) from None
    except ValueError as error:
        raise FileFormatError(f"{file}: not JSON: {with_way_out(error, 'save it again')}") from None
    if not isinstance(fields, dict):
        raise FileFormatError(f"{file}: not an object of fields; save it again")
    return fields


def write_json(file: Path, fields: dict[str, Any]) -> None:
    """Write an object of fields as JSON."""
    # Python writes the shortest decimal that gives the same float64 back.
    text = json.dumps(fields, indent=1, allow_nan=False) + "\n"
    if len(text) > MOST_TEXT:
        raise ValueError(
            f"path: {file}: {len(text)} bytes of JSON are more than the {MOST_TEXT} that are read; use .npz"
        )
    write_bytes(file, text.encode())


def read_npz(file: Path) -> dict[str, NDArray[Any]]:
    """Read the arrays of an npz file; the checksum of each is verified first.

    Parameters
    ----------
    file : pathlib.Path

    Raises
    ------
    FileFormatError
        If it is damaged, or not an npz file.
    OSError
        If it cannot be read.
    """
    check_ordinary(file)
    arrays: dict[str, NDArray[Any]] = {}
    budget = Budget(str(file), file.stat().st_size)
    try:
        with naming(file), zipfile.ZipFile(file) as archive:
            for member in archive.infolist():
                name = member.filename.removesuffix(".npy")
                if name in arrays:
                    raise ValueError(f"{name[:40]!r} stands there twice; save it again")
                budget.spend("unpacked bytes", member.file_size)
                arrays[name] = _array(archive.read(member))
    except (MemoryError, LimitError):
        raise
    except OSError as error:
        if error.errno != errno.EINVAL:  # which is a place in the file that there is not
            raise
        raise FileFormatError(
            f"{file}: not a whole npz file: it points outside itself; save it again"
        ) from None
    except Exception as error:  # zipfile, zlib and numpy raise nearly anything over a damaged file
        reason = " ".join(str(error).split()) or type(error).__name__
        raise FileFormatError(
            f"{file}: not a whole npz file: {with_way_out(reason[:200], 'save it again')}"
        ) from None
    return arrays


def numbers(value: Any, name: str, file: Path, *, with_holes: bool = False) -> NDArray[np.float64]:
    """Return a field as float64.

    Parameters
    ----------
    value : list, number or numpy.ndarray
        Of real numbers.
    name : str
    file : pathlib.Path
    with_holes : bool
        Whether null, or what is not a number, may stand in it.
    """
    array = value if isinstance(value, np.ndarray) else _listed_numbers(value, name, file, with_holes)
    if array.dtype.kind not in "fiu" or array.dtype.itemsize > 8:
        raise FileFormatError(f"{file}: {name} holds {array.dtype}, expected real numbers (float64)")
    if array.dtype.kind in "iu" and array.size and max(abs(int(array.min())), int(array.max())) > _EXACT:
        raise FileFormatError(
            f"{file}: {name} holds whole numbers beyond 2^53, which float64 does not keep; save them as "
            "float64"
        )
    result = array.astype(np.float64)
    if not with_holes and not np.isfinite(result).all():
        raise FileFormatError(
            f"{file}: {name} holds {result[~np.isfinite(result)][0]}, expected finite numbers"
        )
    return result


def counts(value: Any, name: str, file: Path, shape: tuple[int, ...]) -> NDArray[np.int64]:
    """Return a field as counts of a shape."""
    exact = numbers(value, name, file)
    if exact.shape != shape:
        raise FileFormatError(f"{file}: {name} has shape {exact.shape}, expected {shape}")
    if (exact < 0).any() or (exact != np.floor(exact)).any() or (exact > _EXACT).any():
        raise FileFormatError(f"{file}: {name} holds numbers that are no counts; save it again")
    return exact.astype(np.int64)


def _listed_numbers(value: Any, name: str, file: Path, with_holes: bool) -> NDArray[np.float64]:
    held = np.array(value, dtype=object)
    others = set(map(type, held.reshape(-1).tolist())) - {int, float}
    if with_holes:
        others.discard(type(None))
    if others:
        found = (
            "lists of different lengths" if list in others else " and ".join(sorted(map(_in_json, others)))
        )
        raise FileFormatError(f"{file}: {name} is not an array of numbers: it holds {found}; save it again")
    try:
        return held.astype(np.float64)  # None becomes NaN
    except OverflowError:
        raise FileFormatError(
            f"{file}: {name} is not an array of numbers: one is beyond float64; save it again"
        ) from None


def _in_json(kind: type) -> str:
    return {bool: "true or false", str: "text", dict: "an object", type(None): "null"}.get(
        kind, kind.__name__
    )


def _array(data: bytes) -> NDArray[Any]:
    """Make the array of an npy file."""
    stream = io.BytesIO(data)
    version = np.lib.format.read_magic(stream)
    if version == (1, 0):
        shape, is_fortran, dtype = np.lib.format.read_array_header_1_0(stream)
    else:
        shape, is_fortran, dtype = np.lib.format.read_array_header_2_0(stream)
    if dtype.hasobject or dtype.names is not None or dtype.subdtype is not None:
        raise ValueError(f"an array holds {dtype}, expected plain numbers")
    start = stream.tell()
    if min(shape, default=0) < 0 or math.prod(shape) * dtype.itemsize != len(data) - start:
        raise ValueError(
            f"an array says {dtype} of shape {shape}, but {len(data) - start} bytes are there; is the "
            "file cut short?"
        )
    flat = np.frombuffer(data, dtype=dtype, offset=start) if len(data) > start else np.empty(0, dtype=dtype)
    return flat.reshape(shape, order="F" if is_fortran else "C")


def _refuse_constant(word: str) -> Any:
    raise ValueError(f"{word} is no number of JSON; write null for what is not a number")


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    fields = dict(pairs)
    if len(fields) < len(pairs):
        often = Counter(name for name, _ in pairs)
        twice = next(name for name, _ in pairs if often[name] > 1)
        raise ValueError(f"{twice[:40]!r} stands there twice; remove one of them")
    return fields


WORDS: Final = ("format", "comment")
"""Fields of every format that hold no numbers."""


def array_schema(text: str) -> dict[str, object]:
    """Describe a field of numbers in a JSON Schema."""
    return {"description": text, "type": ["number", "array"]}


def record_suffix(file: Path) -> str:
    """Return the suffix of a record, ``.json`` or ``.npz``."""
    suffix = file.suffix.lower()
    if suffix not in (".json", ".npz"):
        raise ValueError(f"path: {file} does not end in .json or .npz; name it so")
    return suffix


def read_record(
    file: Path,
    expected: str,
    known_in_json: Collection[str],
    known_in_npz: Collection[str] | None = None,
    prefixes_in_npz: tuple[str, ...] = (),
) -> dict[str, Any]:
    """Read the fields of a file; an error where it has another format or a field that the format lacks."""
    fields: dict[str, Any]
    if record_suffix(file) == ".json":
        known = {*known_in_json, *WORDS}
        fields = read_json(file)
    else:
        known = {*(known_in_npz or known_in_json), *WORDS}
        fields = dict(read_npz(file))
    found = fields.get("format")
    found = str(found) if isinstance(found, np.ndarray) else found
    if found != expected:
        told = f"{file}: its format is {found!r}, expected {expected!r}"
        raise FileFormatError(f"{told}{_of_later(found, expected)}")
    if file.suffix.lower() == ".npz":
        known |= {name for name in fields if prefixes_in_npz and name.startswith(prefixes_in_npz)}
    check_names(fields, known, str(file))
    return fields


def _of_later(found: object, expected: str) -> str:
    """Return the way out where the file is of the same kind, but newer."""
    kind, _, number = str(found).partition("/")
    known, _, ours = expected.partition("/")
    if kind == known and number.isdecimal() and int(number) > int(ours):
        return ": a later version of polhode has written it; pip install --upgrade polhode"
    return ""


def check_names(fields: dict[str, Any], known: Collection[str], where: str) -> None:
    """Refuse a field that the format does not have."""
    other = next((name for name in fields if name not in known), None)
    if other is not None:
        raise FileFormatError(
            f"{where}: {other[:40]!r} is no field of this format; words for the reader may stand in 'comment'"
        )


def require_field(fields: dict[str, Any], name: str, file: Path) -> Any:
    """Return a field that every file of the format has."""
    if name not in fields:
        raise FileFormatError(f"{file}: {name} is missing; save it again")
    return fields[name]


def write_npz(file: Path, name: str, arrays: dict[str, Any]) -> None:
    """Write arrays under the name of their format as npz."""
    with writing(file) as stream:  # given a path, numpy would add its suffix to one that ends in .NPZ
        np.savez(stream, format=np.array(name), **arrays)


def in_json(fields: dict[str, Any], file: Path) -> dict[str, Any]:
    """Turn arrays into lists, with null in place of NaN."""
    for name, value in fields.items():
        if isinstance(value, np.ndarray) and value.dtype.kind == "f" and np.isinf(value).any():
            raise ValueError(
                f"path: {file}: {name} is infinite somewhere, which JSON does not have; save it as .npz"
            )
    return {name: _plain(value) for name, value in fields.items()}


def _plain(value: Any) -> Any:
    if not isinstance(value, np.ndarray | np.generic):
        return value
    if value.dtype.kind != "f" or np.isfinite(value).all():
        return value.tolist()
    return [_plain(part) for part in np.asarray(value)] if value.ndim else None
