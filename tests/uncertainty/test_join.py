"""Lists among whose numbers some are uncertain, wherever numbers with a sigma are taken."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from polhode import Uncertain
from polhode.uncertainty import join
from scipy.spatial.transform import Rotation
from uncertain_bodies import RigidBody, laminae, rods, solids
from uncertainties import ufloat

EDGE = Uncertain(2.0, 0.02, source="edge")
PLACE = Uncertain((1.0, 2.0, 3.0), 0.1)
THEIRS = ufloat(3.0, 0.03)


class TestNumbers:
    def test_of_one_source_stay_correlated(self) -> None:
        found = join([EDGE, 2.0, THEIRS, EDGE])
        assert found.value.tolist() == [2.0, 2.0, 3.0, 2.0]
        expected = np.diag([4e-4, 0.0, 9e-4, 4e-4])
        expected[0, 3] = expected[3, 0] = 4e-4
        assert found.covariance == pytest.approx(expected, rel=1e-14)

    def test_arrays_and_tuples_are_rows(self) -> None:
        found = join([PLACE, (0.0, EDGE, 1.0), np.array([7.0, 8.0, 9.0])])
        assert found.value.tolist() == [[1.0, 2.0, 3.0], [0.0, 2.0, 1.0], [7.0, 8.0, 9.0]]
        assert found.sigma == pytest.approx(np.array([[0.1] * 3, [0.0, 0.02, 0.0], [0.0] * 3]), rel=1e-14)
        nested = join([[[EDGE]], [[1.0]]])
        assert nested.value.shape == (2, 1, 1)
        assert join(EDGE).sigma == pytest.approx(0.02, rel=1e-15)
        assert join(THEIRS).value == 3.0
        for true in (True, np.True_):  # as in a list without numbers that have a sigma
            assert join([EDGE, true]).value.tolist() == [2.0, 1.0]
            assert join([EDGE, true]).sigma.tolist() == [pytest.approx(0.02, rel=1e-15), 0.0]

    def test_none_is_none(self) -> None:
        for plain in ([1.0, 2.0], np.eye(3), "text", None, [[1.0], [2.0, 3.0]], []):
            assert join(plain) is None

    def test_refused(self) -> None:
        with pytest.raises(ValueError, match="different lengths"):
            join([[EDGE, 1.0], [2.0]])
        with pytest.raises(ValueError, match="different lengths"):
            join([EDGE, PLACE])
        with pytest.raises(TypeError, match="rotation"):
            join([EDGE, Uncertain(Rotation.identity(), 0.1)])
        for other in ("2", "a", None, 1j):
            with pytest.raises(TypeError, match="no number"):
                join([EDGE, other])
        itself: list[Any] = [EDGE]
        itself.append(itself)
        with pytest.raises(ValueError, match="itself"):
            join(itself)


class TestArguments:
    def test_lengths_of_shapes(self) -> None:
        one = solids.box([EDGE, EDGE, 3.0], density=1.0)
        both = Uncertain((2.0, 2.0, 3.0), covariance=4e-4 * np.array([[1, 1, 0], [1, 1, 0], [0, 0, 0]]))
        assert one.covariance == pytest.approx(solids.box(both, density=1.0).covariance, rel=1e-12, abs=1e-18)
        stack = solids.sphere([EDGE, 1.0], density=1.0)
        assert stack.sigma.mass == pytest.approx([4 * np.pi * 4.0 * 0.02, 0.0], rel=1e-14)
        assert rods.rod([EDGE, EDGE], mass=1.0).covariance_with(rods.rod(EDGE, mass=1.0)).shape == (2, 10, 10)
        corner = laminae.triangle([(0.0, 0.0), (EDGE, 0.0), (0.0, 1.0)], density=1.0)
        assert corner.sigma.mass == pytest.approx(0.01, rel=1e-14)

    def test_numbers_of_bodies(self) -> None:
        masses = [Uncertain(1.0, 0.1), 2.0]
        pair = RigidBody.from_particles(masses, [(0, 0, 0), (0, 0, EDGE)])
        assert pair.sigma.mass == pytest.approx(0.1, rel=1e-15)
        assert pair.sigma.center_of_mass[2] == pytest.approx(np.hypot(2 / 3 * 0.02, 4 / 9 * 0.1), rel=1e-14)
        tensor = [[3.0, EDGE, 0.0], [EDGE, 8.0, 0.0], [0.0, 0.0, 9.0]]
        assert RigidBody(1.0, tensor).sigma.inertia[0, 1] == pytest.approx(0.02, rel=1e-14)
        other = Uncertain(2.0, 0.02)
        with pytest.raises(ValueError, match=r"symmetric|twice"):
            RigidBody(1.0, [[3.0, EDGE, 0.0], [other, 8.0, 0.0], [0.0, 0.0, 9.0]])
        moved = pair.translated([0.0, EDGE, 0.0])
        assert moved.sigma.center_of_mass[1] == pytest.approx(0.02, rel=1e-14)
        principal = RigidBody.from_principal(1.0, [EDGE, 3.0, 4.0])
        assert principal.sigma.principal_moments == pytest.approx([0.02, 0.0, 0.0], abs=1e-17)

    def test_vertices_of_a_mesh(self) -> None:
        faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
        corners: list[Any] = [(0.0, 0.0, 0.0), (EDGE, 0.0, 0.0), (0.0, 1.0, 0.0), np.array([0.0, 0.0, 1.0])]
        body = RigidBody.from_mesh(corners, faces, density=6.0)
        assert body.sigma.mass == pytest.approx(0.02, rel=1e-12)
