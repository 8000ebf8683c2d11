"""Euler angles in all sequences, against SciPy's Rotation and against the rotation itself."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from euler_sequences import INTRINSIC, SEQUENCES
from hypothesis import given
from hypothesis import strategies as st
from oracles.bodies import matrix
from polhode import euler_angles
from polhode.errors import SingularAttitudeError
from scipy.spatial.transform import Rotation


def same_rotation(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Distance of unit quaternions up to their common sign."""
    distance: np.ndarray = np.minimum(np.abs(a - b).max(axis=-1), np.abs(a + b).max(axis=-1))
    return distance


def turn(axis: str, angle: float) -> np.ndarray:
    """Rotation matrix about one axis."""
    q = np.zeros(4)
    q["xyz".index(axis)], q[3] = np.sin(angle / 2), np.cos(angle / 2)
    return matrix(q)


def test_there_are_24_sequences() -> None:
    assert len(SEQUENCES) == 24


@pytest.mark.parametrize("sequence", SEQUENCES)
class TestEverySequence:
    def test_to_quaternion_agrees_with_scipy(self, sequence: str, rng: np.random.Generator) -> None:
        angles = rng.uniform(-2 * np.pi, 2 * np.pi, size=(200, 3))
        want = Rotation.from_euler(sequence, angles).as_quat()
        assert same_rotation(euler_angles.to_quaternion(angles, sequence), want).max() < 2e-15

    def test_from_quaternion_agrees_with_scipy(self, sequence: str, rng: np.random.Generator) -> None:
        q = rng.normal(size=(300, 4))
        q /= np.linalg.norm(q, axis=1, keepdims=True)
        want = Rotation.from_quat(q).as_euler(sequence)
        middle = np.sin(want[:, 1]) if sequence[0] == sequence[2] else np.cos(want[:, 1])
        regular = np.abs(middle) > 0.05
        assert regular.sum() > 250
        assert np.abs(euler_angles.from_quaternion(q, sequence) - want)[regular].max() < 1e-13

    def test_there_and_back(self, sequence: str, rng: np.random.Generator) -> None:
        outer = rng.uniform(-np.pi, np.pi, size=(200, 2))
        proper = sequence[0] == sequence[2]
        middle = rng.uniform(0.01, np.pi - 0.01, 200) - (0 if proper else np.pi / 2)
        angles = np.column_stack([outer[:, 0], middle, outer[:, 1]])
        again = euler_angles.from_quaternion(euler_angles.to_quaternion(angles, sequence), sequence)
        assert np.abs(again - angles).max() < 1e-13

    def test_near_the_pole_the_rotation_is_kept(self, sequence: str) -> None:
        """Each angle is ill-determined there, the rotation that they make is not."""
        for offset in (1e-3, 1e-6, 1e-9, 1e-11):
            pole = 0.0 if sequence[0] == sequence[2] else np.pi / 2
            angles = np.array([0.3, pole - offset if pole else offset, -1.1])
            q = euler_angles.to_quaternion(angles, sequence)
            again = euler_angles.to_quaternion(euler_angles.from_quaternion(q, sequence), sequence)
            assert same_rotation(again, q).max() < 1e-14

    @pytest.mark.parametrize("far", [False, True])
    def test_at_the_pole_it_is_an_error_or_not_a_number(self, sequence: str, far: bool) -> None:
        pole = (0.0, np.pi)[far] if sequence[0] == sequence[2] else (np.pi / 2, -np.pi / 2)[far]
        q = Rotation.from_euler(sequence, [0.4, pole, 0.3]).as_quat()
        with pytest.raises(SingularAttitudeError, match="middle angle"):
            euler_angles.from_quaternion(q, sequence)
        stack = np.array([[0.0, 0.6, 0.0, 0.8], [0.1, 0.2, 0.3, 0.4], q])
        stack /= np.linalg.norm(stack, axis=1, keepdims=True)
        regular = euler_angles.from_quaternion(stack[1], sequence)
        angles = euler_angles.from_quaternion(stack, sequence, singular="nan")
        assert np.isnan(angles[2, [0, 2]]).all()
        assert abs(angles[2, 1] - pole) < 1e-7, "the middle angle is defined"
        assert np.array_equal(angles[1], regular)


class TestConventions:
    def test_the_default_is_goldsteins_zxz(self) -> None:
        phi, theta, psi = 0.3, 0.7, -1.1
        want = turn("z", phi) @ turn("x", theta) @ turn("z", psi)
        q = euler_angles.to_quaternion((phi, theta, psi))
        assert np.abs(matrix(q) - want).max() < 1e-15
        assert euler_angles.from_quaternion(q) == pytest.approx([phi, theta, psi], rel=1e-14)

    def test_aliases(self) -> None:
        angles = (0.3, 0.7, -1.1)
        for alias, sequence in (("goldstein", "ZXZ"), ("landau", "ZXZ"), ("aerospace", "ZYX")):
            q = euler_angles.to_quaternion(angles, alias)
            assert np.array_equal(q, euler_angles.to_quaternion(angles, sequence))
            assert np.array_equal(
                euler_angles.from_quaternion(q, alias), euler_angles.from_quaternion(q, sequence)
            )

    @pytest.mark.parametrize("sequence", ["", "ZZX", "XYY", "ZXz", "ABC", "XY", "XYZX", "Goldstein2", "zX"])
    def test_other_sequences_are_refused(self, sequence: str) -> None:
        with pytest.raises(ValueError, match="sequence"):
            euler_angles.to_quaternion((0.1, 0.2, 0.3), sequence)
        with pytest.raises(ValueError, match="sequence"):
            euler_angles.from_quaternion((0.0, 0.6, 0.0, 0.8), sequence)

    def test_the_sign_and_length_of_the_quaternion_do_not_matter(self, rng: np.random.Generator) -> None:
        q = rng.normal(size=(50, 4))
        q /= np.linalg.norm(q, axis=1, keepdims=True)
        angles = euler_angles.from_quaternion(q)
        assert np.abs(euler_angles.from_quaternion(-q) - angles).max() < 1e-14

    @pytest.mark.parametrize("wrong", [(0, 0, 0, 0), (0, 0, 0, 2), (0.6, 0, 0, 0.81), (np.inf, 0, 0, 1)])
    def test_what_is_no_unit_quaternion_is_refused(self, wrong: tuple[float, ...]) -> None:
        with pytest.raises(ValueError, match="quaternion"):
            euler_angles.from_quaternion(wrong)

    @pytest.mark.parametrize("sense", [1.0, -1.0])
    @pytest.mark.parametrize("sequence", ["ZYX", "xyz", "YXZ", "yzx"])
    def test_half_a_turn_keeps_its_sign(self, sequence: str, sense: float) -> None:
        """π and −π are the same attitude; which of them is told is SciPy's choice too."""
        for axis in (sequence[0], sequence[2]):
            q = sense * np.eye(4)["xyz".index(axis.lower())]
            want = Rotation.from_quat(q).as_euler(sequence)
            assert np.abs(euler_angles.from_quaternion(q, sequence) - want).max() < 1e-15

    def test_scipys_rotation_is_taken_as_it_is(self, rng: np.random.Generator) -> None:
        turn = Rotation.from_rotvec(rng.normal(size=(5, 3)))
        assert np.array_equal(
            euler_angles.from_quaternion(turn), euler_angles.from_quaternion(turn.as_quat())
        )

    def test_stacks_keep_their_shape(self) -> None:
        assert euler_angles.to_quaternion(np.zeros((2, 5, 3))).shape == (2, 5, 4)
        assert euler_angles.to_quaternion(np.zeros((0, 3))).shape == (0, 4)
        assert euler_angles.from_quaternion(np.full((2, 5, 4), 0.5)).shape == (2, 5, 3)

    def test_the_singular_row_of_a_stack_is_named(self) -> None:
        stack = np.array([[0.5, 0.5, 0.5, 0.5], [0.0, 0.6, 0.0, 0.8], [0.0, 0.0, 0.0, 1.0]])
        with pytest.raises(SingularAttitudeError, match=r"\b2\b"):
            euler_angles.from_quaternion(stack)
        unknown: Any = "ignore"
        with pytest.raises(ValueError, match="singular"):
            euler_angles.from_quaternion(stack, singular=unknown)

    def test_shapes_are_checked(self) -> None:
        with pytest.raises(ValueError, match=r"angles.*shape \(\.\.\., 3\), got \(2,\)"):
            euler_angles.to_quaternion((0.1, 0.2))
        with pytest.raises(ValueError, match=r"quaternion.*shape \(\.\.\., 4\), got \(3,\)"):
            euler_angles.from_quaternion((0.1, 0.2, 0.3))


@given(
    angles=st.tuples(st.floats(-3.1, 3.1), st.floats(0.01, 3.13), st.floats(-3.1, 3.1)),
    sequence=st.sampled_from(INTRINSIC),
)
def test_extrinsic_angles_are_intrinsic_ones_reversed(
    angles: tuple[float, float, float], sequence: str
) -> None:
    one = euler_angles.to_quaternion(angles, sequence)
    two = euler_angles.to_quaternion(angles[::-1], sequence[::-1].lower())
    assert same_rotation(one, two) < 4e-16
