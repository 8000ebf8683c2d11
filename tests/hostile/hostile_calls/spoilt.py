"""Arguments spoilt: other forms of the same numbers, other shapes, types, numbers, objects."""

from __future__ import annotations

import datetime
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np

EXTREMES = (
    np.nan, np.inf, -np.inf, 0.0, -0.0, -1.0, 1e308, -1e308, 1.7976931348623157e308, 5e-324, 1e-310,
    2.2250738585072014e-308, 1e154, 1.4e154, 1e-160, 1e16, 1e100, 1e-100, 1.0 + 2**-52,
)  # fmt: skip


class Sub(np.ndarray[Any, Any]):
    """A subclass that does nothing."""


class HasArray:
    """Something that says it is an array."""

    def __init__(self, values: Any) -> None:
        self.values = values

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        return np.asarray(self.values, dtype=dtype)


class LiesAboutLength:
    """A sequence that says it is longer than it is."""

    def __len__(self) -> int:
        return 2**62

    def __getitem__(self, k: int) -> float:
        raise IndexError(k)


class Planned(Exception):  # noqa: N818 - it is what was planned, not a fault
    """What a callback raises on purpose."""


def _raises(*_: Any) -> Any:
    raise Planned


def _grows(*_: Any) -> Any:
    return np.zeros((5, 5))


def objects(rng: np.random.Generator) -> Any:
    """Something that is no number at all, or one of another kind."""
    choices: tuple[Any, ...] = (
        None, "text", "", b"bytes", object(), {}, {"a": 1}, set(), (), [], [[]], [[], []], True, False, ...,
        10**400, -(10**400), 2**63, 2**62, -1, 0, Decimal("1.5"), Decimal("NaN"),
        Fraction(1, 3), 1j, complex("nan"),
        np.float16(1.5), np.longdouble(1.5), np.datetime64("2020-01-01"), np.timedelta64(1, "s"),
        datetime.datetime(2020, 1, 1),
        float, len, lambda *_: None, lambda *_: np.nan, _raises, _grows, iter([1.0, 2.0]),
        (x for x in (1.0, 2.0, 3.0)),
        range(3), slice(0, 3), slice(None, None, -1), memoryview(b"abc"), bytearray(8), np.array(None),
        np.array("a"), "\ud800", "\0", "é" * 1000,
        LiesAboutLength(), HasArray([1.0, 2.0, 3.0]),
        type("Odd", (), {"as_quat": lambda *_: [1.0, 0.0, 0.0, 0.0]})(),
        type("Bad", (), {"as_quat": _raises})(), type("None_", (), {"as_quat": None})(),
        np.array([1.0, None, 3.0], dtype=object),
        [1.0, [2.0, 3.0]], "center_of_mass", "origin", "ZYX", "space",
    )  # fmt: skip
    return choices[rng.integers(len(choices))]


def forms(values: Any) -> dict[str, Callable[[], Any]]:
    """The same numbers in other forms, which must give the same bits."""
    plain = np.asarray(values)
    result: dict[str, Callable[[], Any]] = {
        "list": plain.tolist,
        "array": plain.copy,
        "read-only": lambda: _read_only(plain.copy()),
        "big-endian": lambda: plain.astype(plain.dtype.newbyteorder(">")),
    }
    if plain.dtype.kind == "f":
        result["float32"] = lambda: plain.astype(np.float32) if _exact(plain, np.float32) else plain
        result["float16"] = lambda: plain.astype(np.float16) if _exact(plain, np.float16) else plain
        if _exact(plain, np.int64):
            result["int64"] = lambda: plain.astype(np.int64)
            result["int8"] = lambda: plain.astype(np.int8) if _exact(plain, np.int8) else plain
    else:
        result["int32"] = lambda: plain.astype(np.int32) if _exact(plain, np.int32) else plain
        result["int16"] = lambda: plain.astype(np.int16) if _exact(plain, np.int16) else plain
    if plain.ndim:
        result["subclass"] = lambda: plain.copy().view(Sub)
        result["has-array"] = lambda: HasArray(plain.copy())
        result["tuple"] = lambda: tuple(plain.tolist())
        result["strided"] = lambda: np.repeat(plain, 2, axis=-1)[..., ::2]
        result["reversed"] = lambda: plain[..., ::-1].copy()[..., ::-1]
        result["fortran"] = lambda: np.asfortranarray(plain)
        result["unaligned"] = lambda: _unaligned(plain)
    if plain.ndim > 1:
        result["transposed"] = lambda: plain.T.copy().T
        result["rows"] = lambda: list(plain.copy())
    return result


def _read_only(array: Any) -> Any:
    array.setflags(write=False)
    return array


def _exact(array: Any, dtype: Any) -> bool:
    with np.errstate(all="ignore"):
        return bool(np.all(array.astype(dtype).astype(array.dtype) == array))


def _unaligned(array: Any) -> Any:
    raw = np.zeros(array.nbytes + 1, dtype=np.uint8)
    view = raw[1:].view(array.dtype).reshape(array.shape)
    view[...] = array
    return view


def shapes(values: Any, rng: np.random.Generator) -> Any:
    """Another shape: an axis more, less, of length 0, broadcast, cut."""
    plain = np.asarray(values)
    choices: list[Callable[[], Any]] = [
        lambda: plain[None],
        lambda: plain[..., None],
        lambda: np.broadcast_to(plain, (2, *plain.shape)),
        lambda: np.broadcast_to(plain, (3, 1, *plain.shape)),
        lambda: np.broadcast_to(plain, (0, *plain.shape)),
        lambda: np.stack([plain, plain]),
        lambda: np.zeros((0,)),
        lambda: np.zeros((3, 0)),
        lambda: np.ones((2, 3, 4)),
        lambda: np.float64(1.5),
        lambda: plain.reshape(-1),
        lambda: np.ones((1,) * 33 if hasattr(np, "exceptions") else (1,) * 32),
        lambda: np.lib.stride_tricks.as_strided(np.ones(1), (3,), (0,)),
        lambda: plain.reshape((1,) * 8 + plain.shape),
    ]
    if plain.ndim:
        choices += [
            lambda: plain[..., :-1],
            lambda: plain[:0],
            lambda: np.concatenate([plain, plain]),
            lambda: plain[0] if len(plain) else plain[None],
            lambda: plain.tolist()[:-1],
            lambda: [*plain.tolist(), [1.0]],
        ]
    return choices[rng.integers(len(choices))]()


def types(values: Any, rng: np.random.Generator) -> Any:
    """Another type of its elements."""
    plain = np.asarray(values)
    choices: list[Callable[[], Any]] = [
        lambda: plain.astype(complex),
        lambda: plain + 1j,
        lambda: plain.astype(bool),
        lambda: plain.astype(object),
        lambda: plain.astype(str),
        lambda: plain.astype("S"),
        lambda: plain.astype(int).astype("datetime64[s]"),
        lambda: plain.astype(int).astype("timedelta64[s]"),
        lambda: np.ma.masked_array(plain, mask=rng.integers(2, size=plain.shape).astype(bool)),
        lambda: np.zeros(plain.shape, dtype=[("a", float), ("b", int)]),
        lambda: plain.astype(np.longdouble),
        lambda: plain.astype(np.uint64) if np.all(plain >= 0) else plain.astype(np.int8),
        lambda: np.full(plain.shape, None, dtype=object),
        lambda: np.array([str(x) for x in plain.ravel()], dtype=object).reshape(plain.shape),
        lambda: np.array([Fraction(float(x)) for x in plain.ravel()], dtype=object).reshape(plain.shape),
        lambda: np.array([10**400] * plain.size, dtype=object).reshape(plain.shape),
        lambda: plain.view(np.recarray) if plain.ndim else plain,
        lambda: np.asmatrix(plain) if plain.ndim == 2 else plain,
    ]  # fmt: skip
    return choices[rng.integers(len(choices))]()


def numbers(values: Any, rng: np.random.Generator) -> Any:
    """Other numbers: one at the ends of float64, all of them larger or smaller, none at all."""
    plain = np.array(values)
    kind = rng.integers(8)
    if plain.dtype.kind in "iu":
        if plain.ndim and plain.size and kind < 5:
            plain.flat[rng.integers(plain.size)] = rng.choice([-1, -2, 99, 2**62, -(2**62), 2**31, 0])
            return plain
        return (
            int(rng.choice([-1, 0, 1, 2, 3, 2**31, 2**62, -(2**63), 10**6])) if not plain.ndim else plain * 0
        )
    if plain.dtype.kind != "f":
        return plain
    with np.errstate(all="ignore"):
        match kind:
            case 0 | 1 | 2:
                if plain.size:
                    plain.flat[rng.integers(plain.size)] = rng.choice(EXTREMES)
            case 3:
                plain = plain * 10.0 ** rng.integers(-320, 308)
            case 4:
                plain = plain * 10.0 ** rng.integers(-12, 12)
            case 5:
                plain = plain * 0.0
            case 6:
                plain = -plain
            case _:
                plain = rng.standard_normal(plain.shape) * 10.0 ** rng.integers(-3, 4)
    return plain if plain.ndim else float(plain)


def words(value: str, rng: np.random.Generator) -> Any:
    """Other words for an option."""
    choices = (
        "", value.upper(), value + " ", value[:-1], value * 1000, value.encode(), None, 0, 1.5, [value],
        (value,), "\0", "\ud800", "é", True,
        np.str_(value), np.array(value), np.array([value]), "origin", "center_of_mass", "space", "nan",
        "ZYX", "zyz", "exact", "splitting",
        "radau", "dop853", "taylor", "keep", "short-axis", "caps", "hull", "nodes", "linear-angular",
    )  # fmt: skip
    return choices[rng.integers(len(choices))]


def is_numeric(value: Any) -> bool:
    """Whether the value is numbers in a form that arrays are made of."""
    return isinstance(value, int | float | list) and not isinstance(value, bool) and _kind(value) in "fiu"


def _kind(value: Any) -> str:
    try:
        return np.asarray(value).dtype.kind
    except ValueError:
        return "O"
