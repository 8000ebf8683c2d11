"""Classes of tops, decided on relative gaps."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.bodies import attitudes, matrix, principal_moments
from polhode import RigidBody, principal_axes, solids

CLASSES = {
    "spherical": [2.0, 2.0, 2.0],
    "oblate": [1.0, 1.0, 1.5],
    "prolate": [1.0, 2.0, 2.0],
    "asymmetric": [1.0, 2.0, 2.5],
    "linear": [0.0, 2.0, 2.0],
    "point": [0.0, 0.0, 0.0],
}


@pytest.mark.parametrize("scale", [1e-300, 1e-47, 1.0, 1e37, 1e300])
@pytest.mark.parametrize("name", CLASSES)
def test_the_class_does_not_depend_on_the_unit(name: str, scale: float) -> None:
    principal = principal_axes(np.diag(CLASSES[name]) * scale)
    assert principal.top == name
    assert RigidBody.from_principal(1.0, np.array(CLASSES[name]) * scale).principal.top == name


@pytest.mark.parametrize("moments", [[1.0, 1.0, 3.0], [-1.0, 1.0, 1.0], [np.nan, 1.0, 1.0], [0.0, 1.0, 2.0]])
def test_what_is_no_body_is_no_top(moments: list[float]) -> None:
    assert principal_axes(np.diag(moments)).top == "none"


@given(moments=principal_moments(), attitude=attitudes())
def test_the_class_does_not_depend_on_the_attitude(moments: np.ndarray, attitude: np.ndarray) -> None:
    turn = matrix(attitude)
    gaps = np.diff(moments) / moments[2]
    if (np.abs(gaps - 1e-6) < 1e-9).any() or abs(moments[0] / moments[2] - 1e-6) < 1e-9:
        return  # on the edge of the tolerance
    tensor = (turn * moments) @ turn.T
    assert principal_axes((tensor + tensor.T) / 2).top == principal_axes(np.diag(moments)).top


def test_gaps() -> None:
    gaps = principal_axes(np.diag([1.0, 3.0, 4.0])).gaps
    assert gaps.tolist() == [0.5, 0.25]
    assert principal_axes(np.zeros((3, 3))).gaps.tolist() == [0.0, 0.0]


def test_the_tolerance_is_relative_and_may_be_chosen() -> None:
    nearly = principal_axes(np.diag([1.0, 1.0 + 1e-4, 1.5]))
    assert nearly.top == "asymmetric"
    assert nearly.classify(1e-3) == "oblate"
    assert nearly.classify(rtol=1e-6) == "asymmetric"
    assert principal_axes(np.diag([1.0, 1.0 + 1e-8, 1.5])).top == "oblate"
    assert principal_axes(np.diag([1.0, 1.0 + 1e-8, 1.5])).classify(1e-12) == "asymmetric"


@pytest.mark.parametrize("rtol", [-1.0, np.nan])
def test_a_tolerance_is_not_negative(rtol: float) -> None:
    with pytest.raises(ValueError, match="rtol"):
        principal_axes(np.eye(3)).classify(rtol)


def test_stacks_give_arrays_of_names() -> None:
    moments = np.array(list(CLASSES.values()))
    tops = principal_axes(moments[:, :, None] * np.eye(3)).top
    assert list(tops) == list(CLASSES)
    assert np.shape(principal_axes(np.zeros((2, 4, 3, 3))).top) == (2, 4)
    assert isinstance(principal_axes(np.eye(3)).top, str)


def test_solids_have_the_class_their_shape_promises() -> None:
    assert solids.cube(1.0, mass=1.0).principal.top == "spherical"
    assert solids.cylinder(1.0, 0.1, mass=1.0).principal.top == "oblate"
    assert solids.cylinder(0.1, 1.0, mass=1.0).principal.top == "prolate"
    assert solids.box((1.0, 2.0, 3.0), mass=1.0).principal.top == "asymmetric"


@given(seed=st.integers(0, 10_000))
def test_turned_symmetric_bodies_keep_their_class(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q = rng.normal(size=4)
    body = solids.cylinder(1.0, rng.uniform(0.1, 0.9), mass=1.0).rotated(matrix(q / np.linalg.norm(q)))
    assert body.principal.top == "oblate"
