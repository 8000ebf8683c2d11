"""Assemblies with wrong values in every place: read, or refused by name; nothing else happens."""

from __future__ import annotations

import copy
import math
import random
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from polhode import assembly, samples
from polhode.errors import PolhodeError

MORE: list[dict[str, Any]] = [
    {
        "name": "m",
        "file": "t.obj",
        "mass": 1,
        "weld": 0.1,
        "orient": True,
        "closure": "hull",
        "index_base": 1,
    },
    {"name": "pg", "solid": "polygon", "vertices": [[0, 0], [1, 0], [0, 1]], "mass": 1},
    {"name": "pr", "solid": "prism", "sides": 5, "radius": 1, "height": 2, "mass": 1},
    {"name": "ar", "solid": "arc", "radius": 5, "angle": 1, "mass": 1},
    {"name": "q", "solid": "cube", "side": 1, "mass": 1, "rotation": {"quaternion_xyzw": [0, 0, 0, 1]}},
    {
        "name": "x",
        "solid": "cube",
        "side": 1,
        "mass": 1,
        "rotation": {"matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},
    },
    {
        "name": "e",
        "solid": "cube",
        "side": 1,
        "mass": 1,
        "rotation": {"sequence": "ZXZ", "degrees": [1, 2, 3]},
    },
]
WRONG: list[Any] = [
    None, True, 0, -1, 1e308, 1e-320, math.nan, math.inf, 10**400, "", "x", "1 kg", "5 mm", "1 ± 2", "±",
    "nan", "1e999 m", [], [1], [1, 2, 3], [[1, 2], [3]], [[]], ["a", "b", "c"], {}, {"a": 1},
    {"axis": [0, 0, 1], "degrees": "x"}, "../x", "\0", "a\nb", "/etc", [1, [2], 3], "1 2 3 mm", "1,2,3",
    [True, 1, 2], b"x", object(), (1, 2, 3), "wheel.toml", "t.obj",
]  # fmt: skip
ADDED = (
    "mass",
    "density",
    "count",
    "step",
    "turn",
    "rotation",
    "position",
    "solid",
    "file",
    "assembly",
    "inertia",
)


def places(table: Any, so_far: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    inner = table.items() if isinstance(table, dict) else enumerate(table) if isinstance(table, list) else ()
    for key, value in inner:
        yield (*so_far, key)
        yield from places(value, (*so_far, key))


def spoiled(table: dict[str, Any], rng: random.Random) -> None:
    *path, last = rng.choice(list(places(table)))
    inner = table
    for key in path:
        inner = inner[key]
    act = rng.random()
    if act < 0.6:
        inner[last] = rng.choice(WRONG)
    elif act < 0.8:
        del inner[last]
    elif isinstance(inner, dict):
        inner[rng.choice(ADDED)] = rng.choice(WRONG)


def check(seed: int, count: int, folder: Path) -> None:
    (folder / "t.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    for name in ("rover.toml", "wheel.toml"):
        (folder / name).write_bytes(samples.path(name).read_bytes())
    whole = tomllib.loads((folder / "rover.toml").read_text("utf-8"))
    whole["part"] += MORE
    assembly.read(whole, folder=folder)
    rng = random.Random(seed)
    read, told = 0, []
    for _ in range(count):
        table = copy.deepcopy(whole)
        table["part"] = rng.sample(table["part"], k=2)
        spoiled(table, rng)
        try:
            made = assembly.read(table, folder=folder)
            assert made.body.mass > 0.0
            read += 1
        except PolhodeError as error:
            told.append(str(error))
    assert all(10 < len(message) < 600 for message in told)
    assert 0 < read < count


def test_wrong_values(tmp_path: Path) -> None:
    check(1, 400, tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(2, 8))
def test_more_wrong_values(seed: int, tmp_path: Path) -> None:
    check(seed, 10_000, tmp_path)
