"""Bodies of tetrahedra with uniform, cellwise and linear density, against exact rational arithmetic."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import ulp_errors, worst_error
from oracles.bodies import matrix
from oracles.exact_shapes import tetrahedra
from polhode import RigidBody, solids
from polhode.errors import MeshError

CORNER = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
CELL = [(0, 1, 2, 3)]


def grid(n: int, size: Any = (1.0, 1.0, 1.0)) -> tuple[np.ndarray, np.ndarray]:
    """A box of n³ cubes, each cut in six tetrahedra around its diagonal."""
    axis = np.arange(n + 1)
    nodes = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3) / n
    strides = np.array([(n + 1) ** 2, n + 1, 1])
    corners = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) @ strides
    cells = [
        np.stack([corners + offset for offset in np.cumsum([0, *strides[list(order)]])], axis=-1)
        for order in ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0))
    ]
    return nodes * np.asarray(size), np.concatenate(cells)


class TestExact:
    @pytest.mark.parametrize("distance", [0.0, 1e3, 1e6, 1e8])
    @pytest.mark.parametrize("kind", ["uniform", "cells", "nodes"])
    def test_random_density_anywhere(self, kind: str, distance: float, rng: np.random.Generator) -> None:
        nodes, cells = grid(2, (1.0, 2.0, 0.5))
        nodes = nodes + 0.05 * rng.normal(size=nodes.shape) + distance * np.array([0.6, -0.8, 0.1])
        rho: Any = {
            "uniform": 2.5,
            "cells": rng.uniform(0, 3, len(cells)),
            "nodes": rng.uniform(0, 3, len(nodes)),
        }[kind]
        corners = np.broadcast_to(rho, (4, len(cells))).T if kind != "nodes" else np.asarray(rho)[cells]
        exact = tetrahedra(nodes, cells, corners)
        body = RigidBody.from_tetrahedra(nodes, cells, density=rho)
        assert worst_error(body.mass, exact.mass) <= 1e-15
        assert worst_error(body.inertia, exact.inertia) <= 4e-15
        if distance:
            assert max(ulp_errors(body.center_of_mass, exact.center)) <= 1
        else:
            assert worst_error(body.center_of_mass, exact.center) <= 1e-15

    @given(
        data=st.lists(st.floats(-1, 1), min_size=12, max_size=12),
        rho=st.lists(st.floats(0, 5), min_size=4, max_size=4),
    )
    def test_one_cell(self, data: list[float], rho: list[float]) -> None:
        nodes = np.array(data).reshape(4, 3)
        if abs(np.linalg.det(nodes[1:] - nodes[0])) < 1e-9 or max(rho) < 1e-3:
            return
        exact = tetrahedra(nodes, CELL, [rho])
        body = RigidBody.from_tetrahedra(nodes, CELL, density=rho, at="nodes")
        assert worst_error(body.mass, exact.mass) <= 2e-15
        assert worst_error(body.inertia, exact.inertia) <= 8e-15

    @pytest.mark.parametrize("thickness", [1e-3, 1e-6, 1e-9])
    def test_needles_and_plates_keep_their_smallest_moment(self, thickness: float) -> None:
        """Whole, half and quarter lattice points turned exactly: a permutation of the axes and 3-4-5."""
        turn = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]]) @ matrix(np.full(4, 0.5))
        for size in ((1.0, thickness, 0.5 * thickness), (1.0, 0.75, thickness)):
            nodes, cells = grid(2, size)
            nodes = nodes @ turn.T
            exact = tetrahedra(nodes, cells, np.ones((len(cells), 4)))
            body = RigidBody.from_tetrahedra(nodes, cells, density=1.0)
            want = smallest_moment(exact.second)
            assert body.principal_moments[0] == pytest.approx(want, rel=1e-14)
            assert worst_error(body.mass, exact.mass) <= 2e-15

    def test_a_box_of_cells_is_a_box(self) -> None:
        nodes, cells = grid(3, (1.0, 2.0, 3.0))
        body = RigidBody.from_tetrahedra(nodes, cells, density=2.0).translated((-0.5, -1.0, -1.5))
        assert body.isclose(solids.box((1.0, 2.0, 3.0), density=2.0), rtol=1e-14)

    def test_the_order_of_the_nodes_does_not_matter(self) -> None:
        rho = [1.0, 2.0, 3.0, 4.0]
        one = RigidBody.from_tetrahedra(CORNER, CELL, density=rho)
        for order in ((1, 0, 2, 3), (3, 2, 1, 0), (1, 2, 3, 0)):
            other = RigidBody.from_tetrahedra(CORNER, [order], density=rho)
            assert one.isclose(other, rtol=1e-15)

    @pytest.mark.parametrize("scale", [1e-15, 1e-6, 1e8, 1e21])
    def test_no_scale_is_special(self, scale: float) -> None:
        nodes, cells = grid(1, (scale, 2 * scale, 3 * scale))
        body = RigidBody.from_tetrahedra(nodes, cells, density=1.0)
        assert body.principal_moments == pytest.approx(
            6 * scale**5 / 12 * np.array([5.0, 10.0, 13.0]), rel=4e-15, abs=0
        )


def smallest_moment(second: Any) -> float:
    """Sum of the two smaller eigenvalues of an exact second moment, in sixty digits."""
    from mpmath import eigsy, mp, mpf
    from mpmath import matrix as mp_matrix

    with mp.workdps(60):
        rows = [[mpf(x.numerator) / x.denominator for x in row] for row in second]
        values = sorted(eigsy(mp_matrix(rows), eigvals_only=True))
        return float(values[0] + values[1])


class TestArguments:
    def test_as_many_cells_as_nodes_must_be_told_apart(self) -> None:
        cells = [(0, 1, 2, 3)] * 4
        with pytest.raises(ValueError, match=r"as many cells as nodes, 4.*at="):
            RigidBody.from_tetrahedra(CORNER, cells, density=np.ones(4))
        assert RigidBody.from_tetrahedra(CORNER, cells, density=[0, 0, 0, 6], at="cells").mass == 1.0
        by_node = RigidBody.from_tetrahedra(CORNER, cells, density=[0, 0, 0, 6], at="nodes")
        assert by_node.mass == pytest.approx(1.0)
        assert by_node.center_of_mass[2] == pytest.approx(0.4)

    @pytest.mark.parametrize(
        ("changes", "message"),
        [
            ({"cells": [(0, 1, 2, 4)]}, r"cells\[0\] names node 4, but there are 4 nodes"),
            ({"cells": [(0, 1, 2, 3), (0, 1, -1, 2)]}, r"cells\[1\] names node -1"),
            ({"cells": np.zeros((0, 4), int)}, r"cells must not be empty"),
            ({"cells": [(0, 1, 2, 2)]}, r"no mass.*flat"),
            ({"nodes": CORNER * [1, 1, np.nan]}, r"nodes\[0\] is not finite"),
            ({"density": [0.0, 0.0, -1.0, 0.0]}, r"density\[2\] is -1\.0"),
            ({"density": [0.0] * 4}, r"no mass"),
        ],
    )
    def test_what_is_at_fault_is_named(self, changes: dict[str, Any], message: str) -> None:
        arguments: dict[str, Any] = {"nodes": CORNER, "cells": CELL, "density": 1.0} | changes
        with pytest.raises(MeshError, match=message):
            RigidBody.from_tetrahedra(arguments["nodes"], arguments["cells"], density=arguments["density"])

    @pytest.mark.parametrize(
        ("changes", "message"),
        [
            ({"density": -1.0}, r"density must be positive, got -1"),
            ({"density": np.nan}, r"density.*NaN"),
            ({"density": np.ones(3)}, r"density: expected one number, shape \(1,\).*\(4,\).*got \(3,\)"),
            ({"at": "corners"}, r"at: expected \"cells\" or \"nodes\""),
            ({"cells": [(0, 1, 2)]}, r"cells: expected shape \(n, 4\), got \(1, 3\)"),
            ({"nodes": CORNER[:, :2]}, r"nodes: expected shape \(n, 3\), got \(4, 2\)"),
        ],
    )
    def test_wrong_arguments_are_named(self, changes: dict[str, Any], message: str) -> None:
        arguments: dict[str, Any] = {"nodes": CORNER, "cells": CELL, "density": 1.0, "at": None} | changes
        with pytest.raises(ValueError, match=message):
            RigidBody.from_tetrahedra(
                arguments["nodes"], arguments["cells"], density=arguments["density"], at=arguments["at"]
            )

    def test_indices_are_integers(self) -> None:
        with pytest.raises(TypeError, match="cells: expected integers"):
            RigidBody.from_tetrahedra(CORNER, np.array([[0.0, 1, 2, 3]]), density=1.0)
