"""Principal axes: accuracy on adversarial matrices, conventions, the same bits for a row in any company."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from oracles import eigen_cases, rational
from polhode import principal_axes, principal_moments
from polhode.errors import InvalidInertiaError
from scipy.spatial.transform import Rotation

# Processors with fused multiply-add; elsewhere the same bars hold in practice but are not promised.
EIGENVALUE = 6e-16
RESIDUAL = 1.2e-15
ORTHONORMALITY = 2e-15
SPREAD = 3e-15
RELATIVE = 3e-15

MILLION = 1_000_000


@pytest.fixture(scope="module")
def million() -> np.ndarray:
    """Half uniform random matrices, half the tensors of random bodies, some of them thin."""
    rng = np.random.default_rng(7)
    uniform = rng.uniform(-1.0, 1.0, (MILLION // 2, 3, 3))
    x = rng.normal(size=(MILLION // 2, 5, 3)) * np.exp(rng.normal(size=(MILLION // 2, 1, 3)))
    s = np.einsum("nki,nkj->nij", x, x)
    bodies = np.trace(s, axis1=1, axis2=2)[:, None, None] * np.eye(3) - s
    return eigen_cases.symmetric(np.concatenate([uniform, bodies]))


@pytest.mark.parametrize("name", eigen_cases.CLASSES)
@pytest.mark.parametrize("most", [60, pytest.param(None, marks=pytest.mark.long)])
def test_adversarial_matrices(name: str, most: int | None) -> None:
    """Of classes that are drawn at random the first 60 are enough, and all are for a long test."""
    a = eigen_cases.matrices(name)[: most if name in eigen_cases.DRAWN else None]
    found = principal_axes(a)
    rows = zip(a, found.moments, found.axes, eigen_cases.reference(a), strict=True)
    worst = eigen_cases.Errors(*np.max([eigen_cases.errors(*row) for row in rows], axis=0))
    assert worst.values <= EIGENVALUE
    assert worst.residual <= RESIDUAL
    assert worst.orthonormality <= ORTHONORMALITY
    if name in {"near spheres", "near triple", "triple"}:
        assert worst.spread <= SPREAD
    if name == "graded":
        assert worst.relative <= RELATIVE


@pytest.mark.skipif(
    bool(np.finfo(np.longdouble).eps > 1e-18), reason="no extended precision on this platform"
)
def test_a_million_random_matrices_are_as_accurate(million: np.ndarray) -> None:
    found = principal_axes(million)
    for start in range(0, MILLION, 100_000):
        rows = slice(start, start + 100_000)
        a, v = million[rows].astype(np.longdouble), found.axes[rows].astype(np.longdouble)
        w = found.moments[rows].astype(np.longdouble)
        norm = np.abs(w).max(axis=1)
        av = np.stack([sum(a[:, :, j] * v[:, j, None, k] for j in range(3)) for k in range(3)], axis=2)
        residual = np.sqrt(((av - v * w[:, None, :]) ** 2).sum(axis=1))
        assert (residual.max(axis=1) <= RESIDUAL * norm).all()
        gram = np.stack(
            [(v[:, :, i] * v[:, :, j]).sum(axis=1) for i in range(3) for j in range(i + 1)], axis=1
        )
        assert np.abs(gram - np.array([1, 0, 1, 0, 0, 1])).max() <= ORTHONORMALITY
        # The Rayleigh quotient of a vector with residual r is an eigenvalue to r²/gap: here 1e-24 at most.
        quotient = (v * av).sum(axis=1) / (v * v).sum(axis=1)
        gap = np.diff(w, axis=1).min(axis=1)
        assert (residual.max(axis=1) ** 2 / gap <= 1e-20 * norm).all()
        assert (np.abs(w - quotient).max(axis=1) <= EIGENVALUE * norm).all()


def test_order_handedness_and_signs_never_fail(million: np.ndarray) -> None:
    found = principal_axes(million)
    assert (np.diff(found.moments, axis=1) >= 0).all()
    v0, v1, v2 = np.moveaxis(found.axes, -1, 0)
    assert np.abs(np.cross(v0, v1) - v2).max() <= 4e-15
    for v in (v0, v1):
        size = np.abs(v)
        first = (size >= (1 - 1e-8) * size.max(axis=1, keepdims=True)).argmax(axis=1)
        assert (v[np.arange(len(v)), first] > 0).all()


def test_a_row_has_the_same_bits_in_any_company(million: np.ndarray) -> None:
    rng = np.random.default_rng(8)
    rows = np.concatenate([million, *(eigen_cases.matrices(name) for name in eigen_cases.CLASSES)])
    whole = principal_axes(rows)
    order = rng.permutation(len(rows))
    permuted = principal_axes(rows[order])
    np.testing.assert_array_equal(permuted.moments, whole.moments[order])
    np.testing.assert_array_equal(permuted.axes, whole.axes[order])
    for i in [*rng.integers(0, len(rows), 1000), *range(len(rows) - 1000, len(rows))]:
        alone = principal_axes(rows[i])
        np.testing.assert_array_equal(alone.moments, whole.moments[i])
        np.testing.assert_array_equal(alone.axes, whole.axes[i])


def test_the_moments_alone_have_the_same_bits(million: np.ndarray) -> None:
    rows = np.concatenate([million, *(eigen_cases.matrices(name) for name in eigen_cases.CLASSES)])
    np.testing.assert_array_equal(principal_moments(rows), principal_axes(rows).moments)
    np.testing.assert_array_equal(principal_moments(rows[3]), principal_axes(rows[3]).moments)
    assert principal_moments(np.zeros((2, 0, 3, 3))).shape == (2, 0, 3)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_is_nan_for_its_own_row_alone(million: np.ndarray, bad: float) -> None:
    expected = principal_axes(million)
    rows = million.copy()
    rows[123_456, 1, 0] = rows[123_456, 0, 1] = bad
    rows[7, 2, 2] = bad
    found = principal_axes(rows)
    assert np.isnan(found.moments[[7, 123_456]]).all()
    assert np.isnan(found.axes[[7, 123_456]]).all()
    others = np.delete(np.arange(MILLION), [7, 123_456])
    np.testing.assert_array_equal(found.moments[others], expected.moments[others])
    np.testing.assert_array_equal(found.axes[others], expected.axes[others])


def test_diagonal_tensors_are_exact() -> None:
    found = principal_axes(np.diag([3.0, 5e-324, 2.0]))
    assert found.moments.tolist() == [5e-324, 2.0, 3.0]
    assert found.axes.tolist() == [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    assert not np.signbit(found.axes).any()


def test_the_axes_are_the_columns() -> None:
    turn = Rotation.from_euler("ZXZ", [0.3, 0.8, -0.4]).as_matrix()
    tensor = eigen_cases.symmetric(turn @ np.diag([1.0, 2.0, 2.5]) @ turn.T)
    found = principal_axes(tensor)
    np.testing.assert_allclose(found.axes @ np.diag(found.moments) @ found.axes.T, tensor, atol=4e-15)
    np.testing.assert_allclose(tensor @ found.axes[:, 0], found.moments[0] * found.axes[:, 0], atol=4e-15)


def test_the_quaternion_is_the_rotation_of_the_axes() -> None:
    found = principal_axes(eigen_cases.matrices("bodies"))
    matrix = Rotation.from_quat(found.quaternion).as_matrix()
    np.testing.assert_allclose(matrix, found.axes, atol=4e-15)


def test_an_asymmetric_tensor_is_an_error_that_names_its_row(rng: np.random.Generator) -> None:
    stack = np.tile(np.eye(3), (50, 1, 1))
    stack[31, 0, 1] = 1e-14
    with pytest.raises(InvalidInertiaError, match="31"):
        principal_axes(stack)
    stack[31, 0, 1] = 2.0**-50  # 4 ε: rounding
    assert principal_axes(stack).moments.shape == (50, 3)
    stack[31] = rng.normal(size=(3, 3))
    with pytest.raises(InvalidInertiaError, match="31"):
        principal_axes(stack)


def characteristic(tensor: np.ndarray, root: Fraction) -> Fraction:
    """det(I − λ 1), exactly."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = rational(tensor)
    p, q, r = xx - root, yy - root, zz - root
    determinant: Fraction = p * (q * r - yz * yz) - xy * (xy * r - yz * xz) + xz * (xy * yz - q * xz)
    return determinant


def test_moments_are_the_roots_of_the_characteristic_polynomial(rng: np.random.Generator) -> None:
    """mln80: det(I − λ 1), in exact arithmetic, changes its sign at each of them."""
    for body in range(40):
        x = rng.normal(size=(4, 3)) * [1.0, 10.0 ** -(body % 4), 1.0]
        a = eigen_cases.symmetric((np.trace(x.T @ x) * np.eye(3) - x.T @ x)[None])[0]
        moments = rational(principal_axes(a).moments)
        bar = Fraction(EIGENVALUE) * moments[2]
        assert all(characteristic(a, root - bar) * characteristic(a, root + bar) < 0 for root in moments)


@pytest.mark.parametrize("shape", [(), (0,), (1,), (7,), (2, 5), (3, 0, 2)])
def test_shapes(shape: tuple[int, ...]) -> None:
    found = principal_axes(np.broadcast_to(np.diag([3.0, 2.0, 1.0]), (*shape, 3, 3)))
    assert found.moments.shape == (*shape, 3)
    assert found.axes.shape == (*shape, 3, 3)
    assert found.gaps.shape == (*shape, 2)
    assert found.quaternion.shape == (*shape, 4)


@pytest.mark.parametrize("shape", [(3,), (3, 4), (4, 3), (9,), (5, 3, 2)])
def test_a_wrong_shape_is_an_error(shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=r"expected shape \(\.\.\., 3, 3\)"):
        principal_axes(np.zeros(shape))


def test_memory_layouts(million: np.ndarray) -> None:
    rows = million[:1000]
    expected = principal_axes(rows)
    frozen = rows.copy()
    frozen.flags.writeable = False
    padded = np.zeros((2000, 4, 4))
    padded[::2, :3, :3] = rows
    for same in (frozen, np.asfortranarray(rows), padded[::2, :3, :3], rows.astype(">f8"), rows.tolist()):
        found = principal_axes(same)
        np.testing.assert_array_equal(found.moments, expected.moments)
        np.testing.assert_array_equal(found.axes, expected.axes)
    single = principal_axes(rows.astype(np.float32))
    assert single.moments.dtype == np.float64


def test_the_input_is_left_alone(million: np.ndarray) -> None:
    rows = million[:100].copy()
    principal_axes(rows)
    np.testing.assert_array_equal(rows, million[:100])
