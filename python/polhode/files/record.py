"""Files of named fields, of which ``format`` tells what they describe: JSON for people, npz for NumPy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode.errors import FileFormatError
from polhode.files.fields import read_json, read_npz
from polhode.files.writing import writing

if TYPE_CHECKING:
    from collections.abc import Collection
    from pathlib import Path

__all__ = [
    "WORDS",
    "array_schema",
    "check_names",
    "in_json",
    "read_record",
    "record_suffix",
    "required",
    "write_npz",
]

WORDS: Final = ("format", "comment")
"""Fields of every format that hold no numbers."""


def array_schema(text: str) -> dict[str, object]:
    """Describe a field of numbers in a JSON Schema."""
    return {"description": text, "type": ["number", "array"]}


def record_suffix(file: Path) -> str:
    """Give the suffix of a record, ``.json`` or ``.npz``."""
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
    """Give the way out where the file is of the same kind, but newer."""
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


def required(fields: dict[str, Any], name: str, file: Path) -> Any:
    """Give a field that every file of the format has."""
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
