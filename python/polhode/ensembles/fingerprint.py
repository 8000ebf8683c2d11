"""Digests of an ensemble, so that only the same ensemble is resumed, and of the compiled core."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from polhode import _core

if TYPE_CHECKING:
    from collections.abc import Iterator

    from polhode.ensembles.plan import Plan

__all__ = ["build", "fingerprint"]


@cache
def build() -> tuple[str, str]:
    """Return the version of polhode and a digest of its compiled core."""
    data = Path(str(_core.__file__)).read_bytes()
    return _core.__version__, hashlib.blake2b(data, digest_size=16).hexdigest()


def fingerprint(plan: Plan, *more: Any) -> str:
    """Return a digest of all inputs of an ensemble, except its seed, its size and its chunks.

    Parameters
    ----------
    plan : Plan
    *more : object
        What else decides them.

    Returns
    -------
    str
        The same in every process, unlike a hash of Python or the bytes of a pickle.
    """
    digest = hashlib.blake2b(digest_size=16)
    parts = (plan.recipe, plan.t, plan.options, sorted(plan.outputs.items()), *more)
    for word in _words(parts, ()):
        digest.update(len(word).to_bytes(8, "little"))
        digest.update(word)
    return digest.hexdigest()


def _words(value: Any, above: tuple[int, ...]) -> Iterator[bytes]:
    """Yield the bytes of a nested value; an object met again as its position, so that cycles end."""
    yield type(value).__qualname__.encode()
    match value:
        case None | bool() | int() | str():
            yield repr(value).encode()
        case float():
            yield value.hex().encode()
        case bytes():
            yield value
        case np.ndarray() | np.generic():
            array = np.asarray(value)
            yield f"{array.dtype.str}{array.shape}".encode()
            if array.dtype.kind == "O":
                for item in array.ravel():
                    yield from _words(item, above)
            else:
                yield np.ascontiguousarray(array).tobytes()
        case _ if id(value) in above:
            yield b"above"
        case _:
            yield from _inner(value, (*above, id(value)))


def _is_own(value: Any) -> bool:
    """Return whether what a function reads of its module is part of it: data, and functions of the user's."""
    if isinstance(value, FunctionType):
        return not value.__module__.startswith("polhode")
    plain = (bool, int, float, complex, str, bytes, tuple, list, dict, set, frozenset)
    return isinstance(value, (*plain, np.ndarray, np.generic))


def _names(code: CodeType) -> list[str]:
    """Return the names that a function and those within it read from outside."""
    within = [name for inner in code.co_consts if isinstance(inner, CodeType) for name in _names(inner)]
    return sorted({*code.co_names, *within})


def _inner(value: Any, above: tuple[int, ...]) -> Iterator[bytes]:
    match value:
        case tuple() | list():
            yield str(len(value)).encode()
            for item in value:
                yield from _words(item, above)
        case dict():
            for key in sorted(value, key=repr):
                yield from _words(key, above)
                yield from _words(value[key], above)
        case set() | frozenset():
            for item in sorted(value, key=repr):
                yield from _words(item, above)
        case FunctionType():
            # What a function does, not where it was read: two notebooks define the same one.
            yield value.__qualname__.encode()
            cells = [cell.cell_contents for cell in value.__closure__ or ()]
            read = {name: value.__globals__.get(name) for name in _names(value.__code__)}
            read = {name: one for name, one in read.items() if _is_own(one)}
            yield from _words((value.__code__, value.__defaults__, value.__kwdefaults__, cells, read), above)
        case CodeType():
            yield value.co_code
            yield from _words((value.co_names, value.co_varnames, value.co_consts), above)
        case type() | BuiltinFunctionType() | ModuleType():
            name = getattr(value, "__qualname__", value.__name__)
            yield f"{getattr(value, '__module__', '')}.{name}".encode()
        case _:
            called = vars(type(value)).get("__call__")
            if isinstance(called, FunctionType):
                yield from _words(called, above)
            try:
                reduced = value.__reduce_ex__(2)
            except TypeError as error:
                raise TypeError(
                    f"a function or a value of the ensemble cannot be told from another one in files: {error}"
                    "; make locks, open files and the like within the function that uses them"
                ) from error
            yield from _words(reduced if isinstance(reduced, str) else tuple(reduced[:3]), above)
