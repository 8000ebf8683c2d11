"""Symmetric 3×3 matrices on which eigensolvers fail, and their eigenvalues to more than 50 digits.

Every class is rebuilt from a fixed seed. The reference is mpmath's ``eigsy`` on the exact float64
elements, at a working precision that leaves more than 50 digits of the smallest eigenvalue of the most
graded matrix.

``python -m oracles.eigen_cases`` in the folder ``tests`` prints, for every class, how NumPy fares.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import permutations, product
from typing import TYPE_CHECKING, Any, NamedTuple

import mpmath
import numpy as np
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["CLASSES", "TINY", "Errors", "errors", "matrices", "reference", "symmetric"]

SEED = 20261121
DIGITS = 120
"""Working precision: the elements of a graded matrix span 30 decades, those of its square 60."""
TINY = 2.0**-1074
"""The smallest positive double: what rounding a denormal result costs, whatever the method."""
SCALES = (1e-300, 1e-150, 1e-47, 1e37, 1e150, 1e300)


class Errors(NamedTuple):
    """How far a computed decomposition is from the truth, each in the unit of its bar.

    Attributes
    ----------
    values : float
        Largest error of an eigenvalue beyond 1·2⁻¹⁰⁷⁴, relative to the largest eigenvalue.
    residual : float
        Largest norm of A v − λ v beyond 3·2⁻¹⁰⁷⁴, relative to the norm of A.
    orthonormality : float
        Largest element of VᵀV − 1.
    spread : float
        Largest off-diagonal element of VᵀBV relative to the largest element of B, the deviator of A.
    relative : float
        Largest error of an eigenvalue relative to itself.
    """

    values: float
    residual: float
    orthonormality: float
    spread: float
    relative: float


def symmetric(a: Floats) -> Floats:
    """The stack with its upper triangles copied from the lower ones."""
    return np.asarray(np.tril(a) + np.swapaxes(np.tril(a, -1), -1, -2))


def _uniform(rng: np.random.Generator, n: int) -> Floats:
    return symmetric(rng.uniform(-1.0, 1.0, (n, 3, 3)))


def _rotated(rng: np.random.Generator, values: Floats) -> Floats:
    """Matrices with eigenvalues close to these, in random axes."""
    v = Rotation.random(len(values), rng).as_matrix()
    return symmetric(np.einsum("nij,nj,nkj->nik", v, values, v))


def _near(rng: np.random.Generator, n: int, values: tuple[float, float, float]) -> Floats:
    """Eigenvalues near these, drawn apart by relative gaps of 1e-15…1e-6."""
    gap = 10.0 ** rng.uniform(-15.0, -6.0, (n, 1))
    size = np.exp(rng.uniform(-1.0, 1.0, (n, 1)))
    return _rotated(rng, np.array(values) * size * (1.0 + gap * rng.uniform(-1.0, 1.0, (n, 3))))


def _near_spheres(rng: np.random.Generator, n: int) -> Floats:
    """Multiples of the unit matrix plus a small general one: spreads of 1e-15…1e-6."""
    size = np.exp(rng.uniform(-1.0, 1.0, (n, 1, 1)))
    return size * np.eye(3) + 10.0 ** rng.uniform(-15.0, -6.0, (n, 1, 1)) * _uniform(rng, n)


def _graded(rng: np.random.Generator, n: int) -> Floats:
    """D S D with κ(S) ≤ 10 and the elements of D spread over 15 decades."""
    s = _rotated(rng, rng.uniform(0.1, 1.0, (n, 3)))
    d = 10.0 ** rng.uniform(-15.0, 0.0, (n, 3))
    return s * d[:, :, None] * d[:, None, :]


def _bodies(rng: np.random.Generator, n: int) -> Floats:
    """Tensors of inertia of a few random particles."""
    x = rng.normal(size=(n, 6, 3)) * np.exp(rng.normal(size=(n, 1, 3)))
    s = np.einsum("nki,nkj->nij", x, x)
    return symmetric(np.trace(s, axis1=1, axis2=2)[:, None, None] * np.eye(3) - s)


def _rods(rng: np.random.Generator, n: int) -> Floats:
    thin = rng.choice([1e-3, 1e-8, 1e-12, 0.0], n)
    return _rotated(rng, np.stack([thin, np.ones(n), np.ones(n)], axis=1))


def _diagonal(rng: np.random.Generator, n: int) -> Floats:
    elements = rng.choice([0.0, 1.0, 1.0, 2.0, 3.0, -1.0, 0.1, 1e-20, 1e-300], (n, 3))
    return elements[:, :, None] * np.eye(3)


def _one_off_diagonal(rng: np.random.Generator, n: int) -> Floats:
    a = rng.choice([1.0, 1.0 + 2.0**-52, 2.0, 3.0, -1.0], (n, 3))[:, :, None] * np.eye(3)
    row, column = np.array([(1, 0), (2, 0), (2, 1)])[rng.integers(0, 3, n)].T
    a[np.arange(n), row, column] = 10.0 ** rng.uniform(-30.0, 0.0, n) * rng.choice([-1.0, 1.0], n)
    return symmetric(a)


def _of_rank(rng: np.random.Generator, n: int, rank: int) -> Floats:
    x = rng.integers(-9, 10, (n, rank, 3)).astype(float)
    return np.asarray(np.einsum("nki,nkj->nij", x, x))


def _small_integers() -> Floats:
    """All symmetric matrices of −1, 0 and 1 with ascending diagonals: every coincidence there is."""
    numbers = (-1.0, 0.0, 1.0)
    rows = [
        ((a, d, e), (d, b, f), (e, f, c)) for a, b, c, d, e, f in product(numbers, repeat=6) if a <= b <= c
    ]
    return np.array(rows)


def _permuted(a: Floats) -> Floats:
    """The same matrices with rows and columns in every order."""
    return np.concatenate([a[:, p][:, :, p] for p in map(list, permutations(range(3)))])


@lru_cache(maxsize=1)
def _classes() -> dict[str, Floats]:
    rng = np.random.default_rng(SEED)
    mixed = np.concatenate(
        [
            _uniform(rng, 12),
            _bodies(rng, 12),
            _near(rng, 6, (1.0, 1.0, 2.0)),
            _graded(rng, 6),
            _of_rank(rng, 4, 1),
        ]
    )
    base = {
        "random": _uniform(rng, 150),
        "bodies": _bodies(rng, 150),
        "positive definite": _rotated(rng, rng.uniform(0.1, 1.0, (60, 3))),
        "indefinite": _rotated(rng, rng.uniform(-1.0, 1.0, (60, 3))),
        "double": _rotated(rng, rng.uniform(0.3, 2.0, (60, 1)) * np.array([1.0, 1.0, 2.0])),
        "double above": _rotated(rng, rng.uniform(0.3, 2.0, (60, 1)) * np.array([1.0, 2.0, 2.0])),
        "triple": _rotated(rng, np.repeat(rng.uniform(0.3, 2.0, (40, 1)), 3, axis=1)),
        "near double": _near(rng, 100, (1.0, 1.0, 2.0)),
        "near double above": _near(rng, 100, (1.0, 2.0, 2.0)),
        "near triple": _near(rng, 100, (1.0, 1.0, 1.0)),
        "near spheres": _near_spheres(rng, 150),
        "unit": np.array([1.0, -1.0, 3e-7])[:, None, None] * np.eye(3),
        "zero": np.zeros((1, 3, 3)),
        "diagonal": _diagonal(rng, 80),
        "one off-diagonal": _one_off_diagonal(rng, 150),
        "graded": _graded(rng, 250),
        "rods": _rods(rng, 60),
        "rank 1": _of_rank(rng, 60, 1),
        "rank 2": _of_rank(rng, 60, 2),
        "small integers": _small_integers(),
        "permuted": _permuted(mixed),
        "largest": _uniform(rng, 40) * 5e307,
        "denormal": np.concatenate([mixed * 1e-310, mixed * 3e-322, mixed * 2e-323]),
    }
    return base | {f"scale {scale:g}": mixed * scale for scale in SCALES}


CLASSES = tuple(_classes())
DRAWN = ("random", "bodies", "near double", "near double above", "near triple", "near spheres", "graded")
"""Classes of many random matrices, each of which is like the others."""


def matrices(name: str) -> Floats:
    """The matrices of one class, (n, 3, 3), exactly symmetric."""
    return _classes()[name]


def reference(a: Floats) -> list[list[Any]]:
    """Ascending eigenvalues of each of the matrices, as mpmath numbers."""
    with mpmath.workdps(DIGITS):
        return [_eigenvalues(one) for one in a]


def _eigenvalues(a: Floats) -> list[Any]:
    # Divided by a power of two, so that no threshold of the method is absolute.
    largest = float(np.abs(a).max())
    scale = mpmath.ldexp(1, int(np.frexp(largest)[1]))
    values = mpmath.eigsy(mpmath.matrix(a.tolist()) / scale, eigvals_only=True)
    return [x * scale for x in values]


def errors(a: Floats, values: Floats, vectors: Floats, exact: Sequence[Any]) -> Errors:
    """Errors of one computed decomposition, themselves computed to `DIGITS` digits."""
    with mpmath.workdps(DIGITS):
        one = mpmath.eye(3)
        matrix, v = mpmath.matrix(a.tolist()), mpmath.matrix(vectors.tolist())
        w = [mpmath.mpf(x) for x in values.tolist()]
        largest = max(abs(x) for x in exact)

        def relative(error: Any, beside: Any) -> float:
            return float(error / beside) if beside else float(mpmath.inf if error > 0 else 0)

        off = [abs(x - y) for x, y in zip(w, exact, strict=True)]
        residual = max(mpmath.norm(matrix * v[:, k] - w[k] * v[:, k]) for k in range(3))
        deviator = matrix - one * ((matrix[0, 0] + matrix[1, 1] + matrix[2, 2]) / 3)
        turned = v.T * deviator * v
        crossed = max(abs(turned[i, j]) for i in range(3) for j in range(i))
        return Errors(
            values=relative(max(max(off) - TINY, 0), largest),
            residual=relative(max(residual - 3 * mpmath.mpf(TINY), 0), largest),
            orthonormality=float(max(abs(x) for x in v.T * v - one)),
            spread=relative(crossed, max(abs(x) for x in deviator)),
            relative=max(relative(e, abs(x)) for e, x in zip(off, exact, strict=True)),
        )


def _main() -> None:
    print(f"{'':>20} {'values':>9} {'residual':>9} {'orthonorm':>9} {'spread':>9} {'relative':>9}")
    for name in CLASSES:
        a = matrices(name)
        rows = zip(a, *np.linalg.eigh(a), reference(a), strict=True)
        worst = np.max([errors(*row) for row in rows], axis=0)
        print(f"{name:>20} " + " ".join(f"{x:9.1e}" for x in worst))


if __name__ == "__main__":
    _main()
