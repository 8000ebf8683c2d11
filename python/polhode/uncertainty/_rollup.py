"""The roll-up: mass, centre and tensor of every node from its children, and the covariance of the ten.

Definition: m = Σ m_k, C = Σ m_k c_k / m, I = Σ I_k + m_k (d² 1 − d dᵀ) with d = c_k − C; all tensors about
their own centres. What makes the covariances simple are other variables than these: the errors of mass, of
the first moment about a fixed point, and of the tensor about that point. About the node's C they are z = (δm,
m δC, δI), since there the first moment itself is zero; under a shift of the point by d they change by the
matrix S(d):

    δs ← δs + d δm,     δI ← δI + A(d) δm + B(d) δs,     A = d² 1 − d dᵀ,     B δs = 2 (d·δs) 1 − δs dᵀ − d
    δsᵀ

and those of the children about one point add up. So z of a node is Σ S(d_k) z_k, its covariance Σ S(d_k) Q_k
S(d_k)ᵀ for parts that are independent; S(d) S(e) = S(d + e): rolling up in one step or in many gives the
same. Source: first-order propagation of SAWE paper 3360 (Zimmerman, Nakai 2005), with the correlations that
it leaves out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode.uncertainty._tree import Tree

    Floats = NDArray[np.float64]
    Integers = NDArray[np.intp]
    Column = dict[int, Floats | float]

__all__ = [
    "NUMBERS",
    "PAIRS",
    "Values",
    "groups",
    "own_moment",
    "pack",
    "roll_covariances",
    "roll_values",
    "shift",
    "shift_row",
    "unpack",
]

NUMBERS: Final = ("mass", "Cx", "Cy", "Cz", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
"""The ten numbers of a body, in the order of covariances; tensor elements, so minus the products."""

PAIRS: Final = [(a, b) for a in range(10) for b in range(a, 10)]
"""The 55 elements of a symmetric matrix that are kept."""
_PLACE: Final = np.zeros((10, 10), np.intp)
for _k, (_a, _b) in enumerate(PAIRS):
    _PLACE[_a, _b] = _PLACE[_b, _a] = _k
_ROWS: Final = np.array([a for a, _ in PAIRS])
_COLUMNS: Final = np.array([b for _, b in PAIRS])

_CHUNK: Final = 8192
"""Leaves at once, and eight times as many as dense nodes: their arrays fit into the cache."""


class Values(NamedTuple):
    """By place: mass (n,), centre (3, n), tensor about it (6, n), and d = c − C of the parent (3, n)."""

    mass: Floats
    center: Floats
    inertia: Floats
    arm: Floats


def own_moment(d: Floats) -> Floats:
    """Give A(d) = d² 1 − d dᵀ as (6, n) for d of shape (3, n)."""
    x, y, z = d
    return np.stack([y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z])


def roll_values(tree: Tree, mass: Floats, center: Floats, inertia: Floats) -> Values:
    """Fill in the values of every node that has children.

    Parameters
    ----------
    tree : Tree
    mass, center, inertia : numpy.ndarray
        By place, shapes (n,), (3, n) and (6, n); what stands at nodes with children is written over.
    """
    arm = np.zeros_like(center)
    for places in reversed(tree.levels[1:]):
        parents, starts, counts = groups(tree.above[places])
        m = mass[places]
        total = np.add.reduceat(m, starts)
        # From the first child on, so that a tree far from the origin loses no digits.
        first = center[:, places][:, starts]
        d = center[:, places] - np.repeat(first, counts, axis=1)
        mean = np.add.reduceat(m * d, starts, axis=1) / total
        d -= np.repeat(mean, counts, axis=1)
        arm[:, places] = d
        mass[parents] = total
        center[:, parents] = first + mean
        inertia[:, parents] = np.add.reduceat(inertia[:, places] + m * own_moment(d), starts, axis=1)
    return Values(mass, center, inertia, arm)


def roll_covariances(
    tree: Tree, values: Values, sigma: Floats, is_dense: NDArray[np.bool_], covariances: Floats
) -> Floats:
    """Roll up the covariances of z for parts that are independent.

    Parameters
    ----------
    tree : Tree
    values : Values
    sigma : numpy.ndarray
        Shape (10, n), by place: standard deviations of the leaves whose ten errors are independent; else
        unused.
    is_dense : numpy.ndarray of bool
        By place: nodes with children, and leaves whose errors are correlated.
    covariances : numpy.ndarray
        Shape (55, number of dense nodes): covariances of z of dense leaves, zero elsewhere; filled in place.

    Returns
    -------
    numpy.ndarray
        `covariances`.
    """
    slot = np.cumsum(is_dense) - 1
    leaves = np.flatnonzero(~is_dense)
    if len(tree.order) > 1:
        for start in range(0, len(leaves), _CHUNK):
            _add_leaves(tree, values, sigma, leaves[start : start + _CHUNK], slot, covariances)
    for places in reversed(tree.levels[1:]):
        level = np.flatnonzero(is_dense[places]) + places.start
        for start in range(0, len(level), _CHUNK // 8):
            dense = level[start : start + _CHUNK // 8]
            parents, starts, _ = groups(tree.above[dense])
            moved = _shifted(unpack(covariances[:, slot[dense]]), values.arm[:, dense])
            covariances[:, slot[parents]] += np.add.reduceat(pack(moved), starts, axis=1)
    return covariances


def shift(z: Floats, d: Floats) -> Floats:
    """Give S(d) z: first index of `z` the ten numbers, last one the nodes, as of `d`, shape (3, n)."""
    moved = z.copy()
    for j, column in enumerate(_columns(d)):
        for a, factor in column.items():
            if a != j:
                moved[a] += factor * z[j]
    return moved


def shift_row(a: int, d: Floats) -> Floats:
    """Give row `a` of S(d), shape (10, n): what each error of a part does to number `a` of the whole."""
    row = np.zeros((10, d.shape[1]))
    row[a] = 1.0
    for j, column in enumerate(_columns(d)):
        row[j] = column.get(a, row[j])
    return row


def pack(matrices: Floats) -> Floats:
    """Keep the 55 elements: (10, 10, n) to (55, n)."""
    packed: Floats = matrices[_ROWS, _COLUMNS]
    return packed


def unpack(packed: Floats) -> Floats:
    """Write out symmetric matrices: (55, n) to (10, 10, n)."""
    return packed[_PLACE]


def _shifted(matrices: Floats, d: Floats) -> Floats:
    """Give S Q Sᵀ for Q of shape (10, 10, n)."""
    return shift(shift(matrices, d).swapaxes(0, 1), d)


def _columns(d: Floats) -> tuple[Column, Column, Column, Column]:
    """Give the columns of S(d) beyond those of the unit matrix: the effect of δm and of the three δs."""
    x, y, z = d
    xx, yy, zz, xy, xz, yz = own_moment(d)
    return (
        {0: 1.0, 1: x, 2: y, 3: z, 4: xx, 5: yy, 6: zz, 7: xy, 8: xz, 9: yz},
        {1: 1.0, 5: 2.0 * x, 6: 2.0 * x, 7: -y, 8: -z},
        {2: 1.0, 4: 2.0 * y, 6: 2.0 * y, 7: -x, 9: -z},
        {3: 1.0, 4: 2.0 * z, 5: 2.0 * z, 8: -x, 9: -y},
    )


def _add_leaves(
    tree: Tree, values: Values, sigma: Floats, leaves: Integers, slot: Integers, covariances: Floats
) -> None:
    """Add S diag(v) Sᵀ of leaves to their parents, element by element: most of those of S are zero."""
    parents, starts, _ = groups(tree.above[leaves])
    sums = np.empty((len(PAIRS), len(parents)))
    v = sigma[:, leaves] ** 2
    v[1:4] *= values.mass[leaves] ** 2
    columns = _columns(values.arm[:, leaves])
    weighted = [{a: factor * v[j] for a, factor in column.items()} for j, column in enumerate(columns)]
    for k, (a, b) in enumerate(PAIRS):
        terms = [w[a] * c[b] for w, c in zip(weighted, columns, strict=True) if a in w and b in c]
        if a == b and a > 3:
            terms.append(v[a])
        np.add.reduceat(sum(terms[1:], terms[0]), starts, out=sums[k])
    covariances[:, slot[parents]] += sums


def groups(above: Integers) -> tuple[Integers, Integers, Integers]:
    """Give the parents, where the children of each begin, and how many they are."""
    starts = np.flatnonzero(np.diff(above, prepend=-2))
    return above[starts], starts, np.diff(starts, append=len(above))
