"""Ways through meshes that are there for speed, against the plain ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from polhode.io.collada import _FaultError, _integers
from polhode.io.hull import _outward, _wound_alike
from polhode.io.mesh import equal_rows, used_vertices

spatial = pytest.importorskip("scipy.spatial")


class Somewhere:
    where = "line 1"


@given(st.integers(0, 40), st.integers(0, 2**32))
def test_equal_rows(count: int, seed: int) -> None:
    """As `numpy.unique` tells them, in the order of their first ones; -0 is 0 and NaN equals nothing."""
    rng = np.random.default_rng(seed)
    rows = rng.choice([0.0, -0.0, 0.1, 1e300, np.nan], size=(count, 3), p=[0.3, 0.2, 0.3, 0.15, 0.05])
    first, of = equal_rows(rows)
    _, index = np.unique(rows, axis=0, return_index=True) if count else (None, np.empty(0))
    assert first.tolist() == sorted(index.tolist())
    for k, kind in enumerate(of.tolist()):
        same = (rows[: k + 1] == rows[k]).all(axis=1)
        assert first[kind] == (np.argmax(same) if same.any() else k)


@given(st.lists(st.tuples(*[st.integers(0, 9)] * 3), max_size=20))
def test_used_vertices(rows: list[tuple[int, int, int]]) -> None:
    faces = np.array(rows, dtype=np.int64).reshape(-1, 3)
    assert used_vertices(faces, 10).tolist() == np.unique(faces).tolist()


@pytest.mark.parametrize(
    "text", ["", "  ", " 1\n2\t3 ", "1 -2", "+4", "9223372036854775806 1", "0007 1\r\n12"]
)
def test_numbers_of_dae(text: str) -> None:
    element: Any = Somewhere()
    found = _integers(text, element)
    assert found.dtype == np.int64
    assert found.tolist() == [int(word) for word in text.split()]


@pytest.mark.parametrize("text", ["99999999999999999999 1", "1 x", "1.5", "1,2", "1 2-3"])
def test_numbers_of_dae_that_are_none(text: str) -> None:
    element: Any = Somewhere()
    with pytest.raises(_FaultError, match="line 1: "):
        _integers(text, element)


@pytest.mark.parametrize("seed", range(8))
def test_faces_of_a_hull_are_turned_as_by_their_neighbours(seed: int) -> None:
    rng = np.random.default_rng(seed)
    found = spatial.ConvexHull(rng.normal(size=(4 + 20 * seed, 3)), qhull_options="Qt")
    by_planes = _outward(found.simplices, found.points, found.equations)
    assert by_planes.tolist() == _wound_alike(found.simplices, found.neighbors).tolist()
