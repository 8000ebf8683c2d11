"""The colours of the tests: eyes without one kind of cones, against matrices that others publish."""

from __future__ import annotations

import numpy as np
from colors import SEEN


def test_matrices_are_those_of_daltonlens() -> None:
    """DaltonLens and its ports give five decimals of "Viénot 1999", without long and without middle cones."""
    red = [[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]]
    green = [[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]]
    assert np.abs(SEEN["protan"] - red).max() < 5.1e-6
    assert np.abs(SEEN["deutan"] - green).max() < 5.1e-6


def test_white_and_two_primaries_are_seen_alike() -> None:
    for kind, color in (("protan", (0, 0, 1)), ("deutan", (0, 0, 1)), ("tritan", (1, 0, 0))):
        for stays in ((1, 1, 1), color):
            assert np.allclose(SEEN[kind] @ stays, stays, atol=1e-12)
        assert np.linalg.matrix_rank(SEEN[kind], tol=1e-9) == 2
