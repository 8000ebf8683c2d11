"""Which bodies exist: positive moments and triangle inequalities, relative to the body's own scale."""

from __future__ import annotations

import numpy as np
import pytest
from polhode import RigidBody
from polhode.errors import InvalidInertiaError

DIAGONAL = np.diag([1.0, 2.0, 2.5])
TALOS = np.array([[1.15e-4, 5.2e-5, 2.5e-5], [5.2e-5, 1.53e-4, 3.4e-5], [2.5e-5, 3.4e-5, 1.9e-4]])


def test_a_broken_triangle_inequality_is_told_with_its_deficit() -> None:
    with pytest.raises(InvalidInertiaError, match=r"(?i)triangle") as caught:
        RigidBody(mass=0.1, inertia=TALOS)
    assert "5.75" in str(caught.value)


def test_the_deficit_of_a_finger_of_the_mia_hand() -> None:
    with pytest.raises(InvalidInertiaError, match=r"4\.5(5|49)\d*e-0?7"):
        RigidBody(mass=0.01, inertia=np.diag([1.486e-6, 2e-7, 8.31e-7]))


def test_a_negative_moment_is_told() -> None:
    with pytest.raises(InvalidInertiaError, match=r"(?i)negative.*-6\.36|-6\.36.*negative"):
        RigidBody(mass=1.0, inertia=np.diag([-6.36e-7, 1.96e-7, -6.35e-7]))


def test_an_asymmetric_tensor_is_told() -> None:
    tensor = DIAGONAL.copy()
    tensor[0, 1] = 0.125
    with pytest.raises(InvalidInertiaError, match=r"(?i)symmetric.*0\.125"):
        RigidBody(mass=1.0, inertia=tensor)


def test_a_tensor_valid_about_the_origin_may_be_impossible_about_the_center_of_mass() -> None:
    with pytest.raises(InvalidInertiaError):
        RigidBody(mass=1.0, inertia_about_origin=np.eye(3), center_of_mass=(2.0, 0.0, 0.0))
    RigidBody(mass=1.0, inertia_about_origin=np.eye(3))


@pytest.mark.parametrize("scale", [1e-300, 1e-47, 1e-12, 1.0, 1e12, 1e37, 1e300])
def test_the_verdict_does_not_depend_on_the_unit(scale: float) -> None:
    RigidBody(mass=1.0, inertia=scale * np.diag([1.0, 1.0, 1.9999]))
    RigidBody(mass=1.0, inertia=scale * np.diag([0.0, 1.0, 1.0]))
    with pytest.raises(InvalidInertiaError):
        RigidBody(mass=1.0, inertia=scale * np.diag([1.0, 1.0, 2.0001]))


def test_violations_of_rounding_size_pass_and_larger_ones_do_not() -> None:
    eps = np.finfo(float).eps
    RigidBody(1.0, np.diag([1.0, 1.0, 2.0 + 32 * eps]))  # 16 ε tr(I) is 64 ε
    with pytest.raises(InvalidInertiaError):
        RigidBody(1.0, np.diag([1.0, 1.0, 2.0 + 128 * eps]))
    with pytest.raises(InvalidInertiaError):
        RigidBody.from_principal(1.0, [1.0, 1.0, 2.0 + 128 * eps])


def test_a_moment_of_rounding_size_is_kept_as_zero() -> None:
    assert RigidBody(1.0, np.diag([-1e-17, 1.0, 1.0])).principal_moments[0] == 0.0
    assert RigidBody(1.0, np.diag([1e-17, 1.0, 1.0])).principal_moments[0] == 0.0


@pytest.mark.parametrize("moments", [[-1e-17, 1.0, 1.0], [1.0, -1e-16, 1.0]])
def test_a_negative_moment_of_rounding_size_is_zero_too_when_the_moments_are_given(
    moments: list[float],
) -> None:
    body = RigidBody.from_principal(1.0, moments)
    assert body.principal_moments.tolist() == [0.0, 1.0, 1.0]
    assert body.radii_of_gyration.tolist() == [0.0, 1.0, 1.0]


def test_what_a_table_admits_has_no_negative_moment() -> None:
    """Within rtol of zero is zero; what is stored is a body with real radii of gyration."""
    tensor = np.diag([-0.005, 1.0, 1.0])
    for body in (
        RigidBody(1.0, tensor, rtol=1e-2),
        RigidBody.from_principal(1.0, [-0.005, 1, 1], rtol=1e-2),
    ):
        assert (body.principal_moments >= 0).all()
        assert (body.radii_of_gyration >= 0).all()


def test_bodies_from_tables_still_add_and_move() -> None:
    body = RigidBody(1.0, np.diag([1.00, 1.00, 2.01]), rtol=1e-2)
    assert np.array_equal((body + body).inertia, 2 * body.inertia)
    assert np.array_equal(body.translated((1.0, 0, 0)).inertia, body.inertia)
    assert np.array_equal(body.scaled(mass=2.0).inertia, 2 * body.inertia)


@pytest.mark.parametrize("rtol", [-1e-3, 1.0, np.nan, np.inf])
def test_rtol_is_a_small_number(rtol: float) -> None:
    with pytest.raises(ValueError, match="rtol"):
        RigidBody(1.0, DIAGONAL, rtol=rtol)
    with pytest.raises(ValueError, match="rtol"):
        RigidBody.from_principal(1.0, [1.0, 2.0, 2.5], rtol=rtol)


def test_rtol_admits_tables_printed_to_few_digits() -> None:
    printed = np.diag([1.00, 1.00, 2.01])
    with pytest.raises(InvalidInertiaError):
        RigidBody(1.0, printed)
    assert np.array_equal(RigidBody(1.0, printed, rtol=1e-2).inertia, printed)
    RigidBody.from_principal(1.0, [1.00, 1.00, 2.01], rtol=1e-2)


def test_rtol_does_not_admit_what_is_far_off() -> None:
    with pytest.raises(InvalidInertiaError):
        RigidBody(1.0, TALOS, rtol=1e-3)


def test_the_row_of_a_stack_is_named() -> None:
    tensors = np.array([np.eye(3)] * 5)
    tensors[3, 2, 2] = 2.5
    with pytest.raises(InvalidInertiaError, match=r"\b3\b"):
        RigidBody(np.ones(5), tensors)
    with pytest.raises(InvalidInertiaError, match=r"\(1, 2\)|\[1, 2\]"):
        RigidBody(np.ones((2, 4)), np.array([[np.eye(3)] * 5, tensors])[:, 1:])


def test_principal_axes_must_be_a_rotation() -> None:
    for axes in (np.diag([1.0, 1.0, -1.0]), 2 * np.eye(3), np.ones((3, 3))):
        with pytest.raises(ValueError, match="axes"):
            RigidBody.from_principal(1.0, [1.0, 1.0, 1.0], axes=axes)
