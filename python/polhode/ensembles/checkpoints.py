"""Reductions that can be resumed: a file holds the nodes of the tree, and the numbers of their chunks."""

from __future__ import annotations

import errno
import json
import time
import zipfile
import zlib
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode.ensembles.fingerprint import fingerprint
from polhode.ensembles.merge_tree import BLOCK, State
from polhode.ensembles.stores import check_same, header
from polhode.errors import FileFormatError
from polhode.io.writing import writing
from polhode.reductions import BlockState, Moments, QuantileSketch

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from polhode.ensembles.merge_tree import Tree
    from polhode.ensembles.plan import Plan
    from polhode.reductions import Reduction

__all__ = ["Checkpoint"]

_BETWEEN: Final = 5.0
"""Seconds of work that a kill may cost, and a chunk."""
_KIND: Final = "polhode reductions"
_TUPLES: Final[dict[str, Any]] = {
    one.__name__: one for one in (State, BlockState, Moments, QuantileSketch)
} | {"tuple": None}
_BROKEN: Final = (
    zipfile.BadZipFile, zlib.error, EOFError, KeyError, ValueError, TypeError, AttributeError, RuntimeError,
)  # fmt: skip


class Checkpoint:
    """The state of reductions in a file, which is written anew from time to time.

    Parameters
    ----------
    path : pathlib.Path
    plan : Plan
    named : mapping of str to Reduction
    tree : Tree
        Filled with what the file has.
    """

    def __init__(self, path: Path, plan: Plan, named: Mapping[str, Reduction], tree: Tree[State]) -> None:
        self.path, self.plan, self.tree = path, plan, tree
        self.head = header(plan) | {"kind": _KIND, "inputs": fingerprint(plan, dict(named))}
        self.done: set[int] = set()
        self.is_new = False
        """Whether chunks are in the tree that are not in the file."""
        self.written = time.monotonic()
        if not path.parent.is_dir():  # told before anything is run
            raise FileNotFoundError(
                f"checkpoint: {path}: there is no directory {path.parent}; check the path or create it first"
            )
        if path.is_dir():
            raise IsADirectoryError(f"checkpoint: {path} is a directory; give the name of a file in it")
        if path.exists():
            self._load()

    def pending(self) -> list[int]:
        """Return the chunks that are not in it."""
        return [index for index in range(self.plan.chunks) if index not in self.done]

    def add(self, index: int) -> None:
        """Record that a chunk is in the tree."""
        self.done.add(index)
        self.is_new = True
        if time.monotonic() - self.written >= _BETWEEN:
            self.write()

    def write(self) -> None:
        """Write the file, as a whole or not at all."""
        arrays: list[Any] = []
        nodes = [[*place, _plain(state, arrays)] for place, state in self.tree.nodes.items()]
        text = json.dumps(self.head | {"done": sorted(self.done), "nodes": nodes})
        with writing(self.path) as stream, zipfile.ZipFile(stream, "w") as archive:
            archive.writestr("state.json", text)
            for number, array in enumerate(arrays):
                with archive.open(f"{number}.npy", "w", force_zip64=True) as member:
                    np.lib.format.write_array(member, array, allow_pickle=False)
        self.is_new, self.written = False, time.monotonic()

    def close(self) -> None:
        """Write what is new, except for a tree that was interrupted while a chunk was added."""
        if self.is_new and self._is_whole():
            self.write()

    def _is_whole(self) -> bool:
        """Return whether the tree has the blocks of those chunks that are done, and no others."""
        bounds = [self.plan.bounds(index) for index in self.done]
        chunks = [(first // BLOCK, -(-(first + count) // BLOCK)) for first, count in bounds]
        return _merge_spans(self.tree.spans()) == _merge_spans(chunks)

    def _load(self) -> None:
        try:
            with zipfile.ZipFile(self.path) as archive:
                found = json.loads(archive.read("state.json"))
                check_same(self.path, found, self.head)
                for level, index, state in found["nodes"]:
                    self.tree.nodes[level, index] = _restore(state, archive)
                self.done = set(found["done"])
                if not self._is_whole():
                    raise ValueError("its chunks are not those of its nodes")
        except FileFormatError:
            raise
        except (OSError, *_BROKEN) as error:
            if isinstance(error, OSError) and error.errno != errno.EINVAL:  # it points outside itself
                raise
            raise FileFormatError(
                f"{self.path}: holds no reductions that compute has begun ({error}); give another path, or "
                "delete it"
            ) from None


def _merge_spans(spans: Iterable[tuple[int, int]]) -> list[tuple[int, int]]:
    """Merge spans that follow each other."""
    found: list[tuple[int, int]] = []
    for begin, end in sorted(spans):
        if found and found[-1][1] == begin:
            begin = found.pop()[0]
        found.append((begin, end))
    return found


def _plain(value: Any, arrays: list[Any]) -> Any:
    """Return a state as JSON has it, its arrays in a list."""
    match value:
        case None | bool() | int() | float():
            return value
        case np.ndarray():
            arrays.append(value)
            return {"array": len(arrays) - 1}
        case np.generic():
            return value.item()
        case dict():
            return {"dict": [[key, _plain(one, arrays)] for key, one in value.items()]}
        case tuple():
            return {type(value).__name__: [_plain(one, arrays) for one in value]}
    raise TypeError(f"{type(value).__name__} is no part of a state")


def _restore(value: Any, archive: zipfile.ZipFile) -> Any:
    if not isinstance(value, dict):
        return value
    ((kind, parts),) = value.items()
    if kind == "array":
        with archive.open(f"{int(parts)}.npy") as member:
            return np.lib.format.read_array(member, allow_pickle=False)
    if kind == "dict":
        return {key: _restore(one, archive) for key, one in parts}
    made, found = _TUPLES[kind], [_restore(one, archive) for one in parts]
    return tuple(found) if made is None else made(*found)
