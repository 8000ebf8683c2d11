"""A ledger of parts: mass properties of every level of a tree of parts, with uncertainties.

The parts and assemblies of a body form a tree. Each of them is a *node*, and each node has one row in a
table. The *root* is the node of the whole. Every other row names its parent, the assembly that it belongs to.
A node that other rows name as their parent is an assembly; a node without such rows is a part. The row of a
part gives its mass, centre of mass and tensor, with their standard deviations. All centres are in one frame,
that of the whole.

The parts are summed up (*rolled up*) to every level of the tree. Errors are propagated to first order with
all their correlations: the moments of an assembly depend on the same masses and centres, so that their errors
are correlated.

Import all names of this page from the package above: ``from polhode.uncertainty import ledger, Ledger``.
There ``ledger`` is the function. ``made["bus"]`` is the :class:`Part` with the id "bus" of a ledger
``made``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from polhode._format import Argument
from polhode.errors import PolhodeError
from polhode.uncertainty.ledgers.parts import COLUMNS, parts_of_bodies, read_parts
from polhode.uncertainty.ledgers.results import Ledger, Part, Sigmas, frozen, tensors
from polhode.uncertainty.ledgers.rollup import Covariances, Shares, roll_values
from polhode.uncertainty.ledgers.table import Tree, make_tree, read_table

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray

    from polhode._core import RigidBody
    from polhode.uncertainty.ledgers.parts import Parts
    from polhode.uncertainty.ledgers.table import Table

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
        The table: a file of comma- or tab-separated text; a mapping of the names of columns to lists; or one
        mapping for each row. The notes explain the columns.
    tree : path, mapping or iterable of mappings, optional
        A second table that says which node belongs to which. Its columns are ``child`` (or ``id``) and
        ``parent``. It is needed if the first table has no column ``parent``.
    overwrite : bool, optional
        Whether mass, centre and tensor in the row of an assembly are replaced by the sums of its parts, as in
        the R package massProps. By default such numbers are an error.
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
    The columns of the table. ``id`` is required, and so is ``parent``, unless `tree` is given. All other
    columns may be absent, if no part needs them.

    - ``id``: the name of the node.
    - ``parent``: the id of the assembly that the node belongs to; empty for the root.
    - ``name``, ``comment``: words for the reader.
    - ``mass``, ``Cx`` ``Cy`` ``Cz``, ``Ixx`` ``Iyy`` ``Izz`` ``Ixy`` ``Ixz`` ``Iyz``: the ten numbers of a
      part; empty for an assembly.
    - ``sigma_mass`` … ``sigma_Iyz``: their standard deviations; empty for an assembly. One that is not stated
      is zero. The ten errors of a part are independent of each other.
    - ``POIconv``: ``+`` if the products of inertia are ∫ x y dm, ``-`` if they are minus that, the elements
      of the tensor.
    - ``about``: the point that the tensor refers to, ``center_of_mass`` (the default) or ``origin``.
    - ``Ipoint``: TRUE if the part is a point mass; a tensor in its row is then ignored.
    - ``source``: parts with the same word here have the same errors, for example because they were weighed on
      one scale. If the mass of one of them is wrong by 0.7 of its sigma, so are the masses of the others,
      each by 0.7 of its own sigma. The same holds for the other nine numbers; of a product of inertia it is
      the error of the element of the tensor that is shared, whatever ``POIconv`` says of each row, see
      `Ledger.opposite_signs`.
    - ``growth``: mass growth allowance, a fraction of the basic mass (0.15 or 15%), as in AIAA S-120A.
    - ``solid`` with its ``arguments`` (``radius=0.1 height=0.3``), or ``file``: a shape that gives the
      tensor, in place of the six numbers. It needs ``mass`` or ``density``, which may have ``sigma_mass`` or
      ``sigma_density``; an error of it changes mass and tensor by the same factor. ``Cx`` ``Cy`` ``Cz`` say
      where the centre of mass of the shape is placed.

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
    return _roll_up(made, tuple(parents), is_part, parts, words, rtol, read.name or "table")


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
    return _roll_up(made, tuple(parents), is_part, parts, {"comment": tuple(comments)}, None, "assembly")


def _roll_up(
    made: Tree,
    parents: tuple[str, ...],
    is_part: NDArray[np.bool_],
    parts: Parts,
    words: dict[str, tuple[str, ...]],
    rtol: float | None,
    name: str,
) -> Ledger:
    """Roll the parts up to every level."""
    is_uncertain = parts.sigma[:, is_part].any() or parts.correlated[1].any()
    with np.errstate(over="ignore", invalid="ignore"):
        values = roll_values(made, *map(made.by_place, (parts.mass, parts.center, parts.inertia)))
        covariances = Covariances(made, values, parts, name) if is_uncertain else None
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
        opposite_signs=parts.opposite_signs,
        _tree=made,
        _values=values,
        _covariances=covariances,
        _sources=tuple(parts.source),
        _words=words,
        _rtol=rtol,
    )


def _edges(table: Table, tree: Any) -> tuple[list[str], list[str]]:
    """Return ids and parents of the rows."""
    if "id" not in table:
        raise PolhodeError(f"{table.name or 'table'}: there is no column 'id'")
    ids = table.words("id")
    if tree is None:
        if "parent" not in table:
            raise PolhodeError(
                f"{table.name or 'table'}: there is no column 'parent'; add one, or pass the edges as ",
                Argument("tree"),
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
    """Refuse numbers beyond the range of floats; the error names the lowest node that has them."""
    if all(np.isfinite(rows[:, 0]).all() for rows in numbers):
        return
    bad = np.flatnonzero(~np.isfinite(np.concatenate(numbers)).all(axis=0))
    name = tree.ids[int(tree.order[bad[-1]])]
    raise PolhodeError(f"the {what} of {name!r} are beyond the range of numbers; check its exponents")


def _rolled_sum(tree: Tree, amounts: Floats) -> Floats:
    """Roll up a sum; the numbers are ordered by place."""
    amounts = np.where(tree.is_leaf, amounts, 0.0)
    for places in reversed(tree.levels[1:]):
        np.add.at(amounts, tree.above[places], amounts[places])
    return amounts
