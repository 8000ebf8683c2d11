"""A ledger of parts: mass properties of every level of a tree of parts, with uncertainties.

A table gives mass, centre of mass and tensor of each part with their standard deviations, and the assembly
that the part belongs to. All centres are in one frame, that of the whole. The parts are summed up (*rolled
up*) to every level of the tree. Errors are propagated to first order with all their correlations: the moments
of an assembly depend on the same masses and centres, so that their errors are correlated.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from polhode.errors import PolhodeError
from polhode.uncertainty._covariances import Covariances
from polhode.uncertainty._of_bodies import parts_of_bodies
from polhode.uncertainty._parts import COLUMNS, read_parts
from polhode.uncertainty._results import Ledger, Part, Sigmas, frozen, tensors
from polhode.uncertainty._rollup import roll_values
from polhode.uncertainty._shares import Shares
from polhode.uncertainty._table import read_table
from polhode.uncertainty._tree import Tree, make_tree

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray

    from polhode._core import RigidBody
    from polhode.uncertainty._parts import Parts
    from polhode.uncertainty._table import Table

    Floats = NDArray[np.float64]

__all__ = ["Ledger", "Part", "Shares", "Sigmas", "ledger", "ledger_of_bodies"]


def ledger(
    table: Any,
    tree: Any = None,
    *,
    overwrite: bool = False,
    ignore: Collection[str] = (),
    rtol: float | None = None,
) -> Ledger:
    """Sum up a tree of parts to every level, with covariances.

    Parameters
    ----------
    table : path, mapping or iterable of mappings
        A file of comma- or tab-separated text, columns by name, or rows; see the notes for the columns.
    tree : path, mapping or iterable of mappings, optional
        The edges, with the columns ``child`` (or ``id``) and ``parent``, where the table has no column
        ``parent``.
    overwrite : bool, optional
        Whether numbers in the row of an assembly are ignored, as in the R package massProps. By default they
        are an error.
    ignore : collection of str, optional
        Unknown columns that are ignored. Other unknown columns are an error.
    rtol : float, optional
        Tolerance for the tests of a tensor, relative to its largest moment; see `polhode.RigidBody`.

    Returns
    -------
    Ledger

    Raises
    ------
    PolhodeError
        If the table has a bad row, or the rows are not a tree. The message names the line, the law and the
        number.

    Notes
    -----
    Columns, of which all but the first two may be absent:

    - ``id``, ``parent``: empty for the root. ``name``, ``comment``: words for the reader.
    - ``mass``, ``Cx`` ``Cy`` ``Cz``, ``Ixx`` ``Iyy`` ``Izz`` ``Ixy`` ``Ixz`` ``Iyz``, and ``sigma_mass`` …
      ``sigma_Iyz``: empty for rows with children. Standard deviations that are not stated are zero; the ten
      errors of a part are independent.
    - ``POIconv``: ``+`` for products of inertia ∫ x y dm, ``-`` for minus that, the element of the tensor.
    - ``about``: ``center_of_mass`` (the default) or ``origin``, about which the tensor is stated.
    - ``Ipoint``: TRUE takes a part as a point, whatever tensor it states.
    - ``source``: parts with the same word in it share their ten draws (made to one drawing, weighed on one
      scale): each of their errors is the same multiple of its sigma.
    - ``growth``: mass growth allowance, a fraction of the basic mass (0.15 or 15%), as in AIAA S-120A.
    - ``file`` or ``solid``, its ``arguments`` (``radius=0.1 height=0.3``), and ``mass`` or ``density`` with
      ``sigma_mass`` or ``sigma_density``, with which the tensor grows in proportion; ``Cx`` ``Cy`` ``Cz``
      move its centre there.

    Examples
    --------
    >>> from polhode.uncertainty import ledger
    >>> craft = ledger(
    ...     {
    ...         "id": ["craft", "bus", "wheel"],
    ...         "parent": ["", "craft", "craft"],
    ...         "mass": [None, 50.0, 5.0],
    ...         "Cx": [None, 0.0, 0.4],
    ...         "Cy": [None, 0.0, 0.0],
    ...         "Cz": [None, 0.0, 0.1],
    ...         "Ixx": [None, 4.0, 0.02],
    ...         "Iyy": [None, 5.0, 0.02],
    ...         "Izz": [None, 6.0, 0.03],
    ...         "Ixy": [None, 0.0, 0.0],
    ...         "Ixz": [None, 0.0, 0.0],
    ...         "Iyz": [None, 0.0, 0.0],
    ...         "sigma_mass": [None, 0.2, 0.01],
    ...     }
    ... )
    >>> craft
    <Ledger of 'craft': 2 parts, 2 levels, mass 55.00 ± 0.20>
    >>> craft.variance_shares("mass")
    <Shares of the variance of mass of 'craft': bus 99.8% (mass), wheel 0.2% (mass)>
    """
    read = read_table(table, COLUMNS, ignore=ignore)
    rows, parents = _edges(read, tree)

    def where(row: int) -> str:
        return f"{read.where(row)} ({rows[row]!r})"

    made = make_tree(rows, parents, where)
    is_part = np.empty(len(rows), np.bool_)
    is_part[made.order] = made.is_leaf
    parts = read_parts(read, is_part, where, overwrite=overwrite, rtol=rtol)
    words = {name: tuple(read.words(name)) for name in ("name", "comment") if name in read}
    return _rolled(made, tuple(parents), is_part, parts, words, rtol)


def ledger_of_bodies(
    ids: Sequence[str], parents: Sequence[str], bodies: Sequence[RigidBody | None], comments: Sequence[str]
) -> Ledger:
    """Roll up a tree whose leaves are bodies in the frame of the whole.

    Errors that bodies share stay shared, by the variables that they depend on.

    Parameters
    ----------
    ids, parents : sequence of str
        The parent of the root is "".
    bodies : sequence of (RigidBody or None)
        None for nodes with children.
    comments : sequence of str
        For the reader.
    """
    made = make_tree(ids, parents, lambda row: repr(ids[row]))
    is_part = np.array([body is not None for body in bodies])
    parts = parts_of_bodies(ids, bodies)
    return _rolled(made, tuple(parents), is_part, parts, {"comment": tuple(comments)}, None)


def _rolled(
    made: Tree,
    parents: tuple[str, ...],
    is_part: NDArray[np.bool_],
    parts: Parts,
    words: dict[str, tuple[str, ...]],
    rtol: float | None,
) -> Ledger:
    """Roll the parts up to every level."""
    is_uncertain = parts.sigma[:, is_part].any() or parts.correlated[1].any()
    with np.errstate(over="ignore", invalid="ignore"):
        values = roll_values(made, *map(made.by_place, (parts.mass, parts.center, parts.inertia)))
        covariances = Covariances(made, values, parts) if is_uncertain else None
    _refuse_infinite(made, (values.mass[None], values.center, values.inertia), "numbers")
    if covariances is not None:
        _refuse_infinite(made, (covariances.sigma,), "sigmas")
    growing = made.by_place(parts.mass * (1.0 + parts.growth))
    predicted = _rolled_sum(made, growing) if parts.growth[is_part].any() else values.mass
    return Ledger(
        ids=made.ids,
        parents=parents,
        root=made.ids[int(made.order[0])],
        depth=frozen(made.depth()),
        is_part=frozen(is_part),
        mass=frozen(made.by_row(values.mass)),
        center_of_mass=frozen(made.by_row(values.center).T),
        inertia=frozen(tensors(made.by_row(values.inertia))),
        predicted_mass=frozen(made.by_row(predicted)),
        unstated=parts.unstated,
        _tree=made,
        _values=values,
        _covariances=covariances,
        _sources=tuple(parts.source),
        _words=words,
        _rtol=rtol,
    )


def _edges(table: Table, tree: Any) -> tuple[list[str], list[str]]:
    """Give ids and parents of the rows."""
    if "id" not in table:
        raise PolhodeError(f"{table.name or 'table'}: there is no column 'id'")
    ids = table.words("id")
    if tree is None:
        if "parent" not in table:
            raise PolhodeError(
                f"{table.name or 'table'}: there is no column 'parent'; add one, or pass the edges as tree="
            )
        return ids, table.words("parent")
    edges = read_table(tree, ("child", "id", "parent"), argument="tree")
    name = "child" if "child" in edges else "id"
    if name not in edges or "parent" not in edges:
        raise PolhodeError(f"{edges.name or 'tree'}: a tree has the columns 'child' and 'parent'")
    known, parent = set(ids), dict.fromkeys(ids, "")
    for row, (child, above) in enumerate(zip(edges.words(name), edges.words("parent"), strict=True)):
        if child not in known:
            raise PolhodeError(f"{edges.where(row)}: the table has no row of {child!r}; add one")
        if parent[child] and above:
            raise PolhodeError(
                f"{edges.where(row)}: {child!r} has two parents, {parent[child]!r} and {above!r}; leave one"
            )
        parent[child] = above
    if "parent" in table:
        for row, (one, other) in enumerate(zip(ids, table.words("parent"), strict=True)):
            if other and other != parent[one]:
                raise PolhodeError(
                    f"{table.where(row)} ({one!r}): its parent is {other!r} here, but {parent[one]!r} in the "
                    "tree; leave one out"
                )
    return ids, [parent[name] for name in ids]


def _refuse_infinite(tree: Tree, numbers: tuple[Floats, ...], what: str) -> None:
    """Name the lowest node whose numbers are beyond the range of floats; so are those of all above it."""
    if all(np.isfinite(rows[:, 0]).all() for rows in numbers):
        return
    bad = np.flatnonzero(~np.isfinite(np.concatenate(numbers)).all(axis=0))
    name = tree.ids[int(tree.order[bad[-1]])]
    raise PolhodeError(f"the {what} of {name!r} are beyond the range of numbers; check its exponents")


def _rolled_sum(tree: Tree, amounts: Floats) -> Floats:
    """Roll up a sum, by place."""
    amounts = np.where(tree.is_leaf, amounts, 0.0)
    for places in reversed(tree.levels[1:]):
        np.add.at(amounts, tree.above[places], amounts[places])
    return amounts
