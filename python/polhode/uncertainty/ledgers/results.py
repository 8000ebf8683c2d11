"""Results of a ledger: nodes with sums and uncertainties, contributions of the parts, and files."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode._format import short, with_sigma
from polhode.errors import PolhodeError
from polhode.io.records import in_json, write_json
from polhode.io.writing import write_bytes
from polhode.uncertainty.ledgers.parts import SIGMAS, bodies_of
from polhode.uncertainty.ledgers.rollup import NUMBERS, Shares

if TYPE_CHECKING:
    from collections.abc import Iterator
    from os import PathLike

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from polhode._core import RigidBody
    from polhode.uncertainty.ledgers.rollup import Covariances, Values
    from polhode.uncertainty.ledgers.table import Tree

    Floats = NDArray[np.float64]

__all__ = [
    "Ledger",
    "Part",
    "Sigmas",
    "frozen",
    "tensors",
    "write_csv",
    "write_json_ledger",
]

_SHOWN: Final = 20
"""Lines of a ledger that is printed."""


class Sigmas(NamedTuple):
    """Standard deviations of masses, centres (..., 3) and elements of the tensors about them (..., 3, 3)."""

    mass: Any
    center_of_mass: Floats
    inertia: Floats

    def __repr__(self) -> str:
        return short(self)


@dataclass(frozen=True, eq=False, repr=False)
class Ledger:
    """A tree of parts rolled up to every level; made by `ledger`.

    A node is a part or an assembly. Each array has one entry for each node, in the order of the rows of the
    table.

    Attributes
    ----------
    ids, parents : tuple of str
        Name of each node, and name of its parent; "" as the parent of the root.
    root : str
        The id of the whole.
    depth : numpy.ndarray of int, shape (n,)
        Number of steps from the root down to the node; 0 for the root.
    is_part : numpy.ndarray of bool, shape (n,)
        Whether the node is a part, that is, has no children.
    mass : numpy.ndarray, shape (n,)
        Basic mass, without growth allowance.
    center_of_mass : numpy.ndarray, shape (n, 3)
        Centre of mass, in the frame of the whole.
    inertia : numpy.ndarray, shape (n, 3, 3)
        Tensor of each node about its own centre of mass, along the axes of the whole.
    predicted_mass : numpy.ndarray, shape (n,)
        Basic mass plus mass growth allowance, rolled up.
    unstated : int
        Number of parts without standard deviations; these count as exact.
    opposite_signs : dict of str to tuple of str
        For each source whose parts state uncertain products of inertia with both signs (``POIconv``): the
        names of these numbers. The parts share the error of the element of the tensor. So where a number that
        is stated with ``-`` is too large by 0.7 of its sigma, one that is stated with ``+`` is too small by
        0.7 of its own.
    """

    ids: tuple[str, ...]
    parents: tuple[str, ...]
    root: str
    depth: NDArray[np.intp]
    is_part: NDArray[np.bool_]
    mass: Floats
    center_of_mass: Floats
    inertia: Floats
    predicted_mass: Floats
    unstated: int
    opposite_signs: dict[str, tuple[str, ...]]
    _tree: Tree
    _values: Values
    _covariances: Covariances | None
    _sources: tuple[str, ...]
    _words: dict[str, tuple[str, ...]]
    _rtol: float | None

    @cached_property
    def bodies(self) -> RigidBody:
        """All nodes as a stack of bodies, without uncertainties."""
        values = np.concatenate([self._values.mass[None], self._values.center, self._values.inertia])
        return bodies_of(values[:, self._tree.place], self._rtol)

    @cached_property
    def covariance(self) -> Floats | None:
        """Covariances of the ten numbers, shape (n, 10, 10); None where no part states a standard deviation.

        The order is mass, Cx, Cy, Cz, Ixx, Iyy, Izz, Ixy, Ixz, Iyz. Tensors are about the centre of mass of
        the node; Ixy, Ixz, Iyz are elements of the tensor (minus the products of inertia).
        """
        if self._covariances is None:
            return None
        covariance: Floats = frozen(self._covariances.matrices(self._tree.place))
        return covariance

    @cached_property
    def sigma(self) -> Sigmas | None:
        """Standard deviations; None where no part states one."""
        if self._covariances is None:
            return None
        sigma = self._tree.by_row(self._covariances.sigma)
        return Sigmas(frozen(sigma[0]), frozen(sigma[1:4].T), frozen(tensors(sigma[4:])))

    @property
    def growth(self) -> Floats:
        """Mass growth allowance as a fraction of the basic mass; for an assembly that of all parts."""
        return self.predicted_mass / self.mass - 1.0

    def variance_shares(self, of: str = "mass", at: str | None = None) -> Shares:
        """Compute the contribution of each part to the variance of a number.

        The part with the largest share is the one to measure more accurately.

        Parameters
        ----------
        of : str, optional
            The number: ``"mass"``, ``"Cx"`` … ``"Iyz"``.
        at : str, optional
            The id of the node whose number it is; the root by default.

        Returns
        -------
        Shares

        Raises
        ------
        PolhodeError
            If there is no such number or node, or the number is exact.
        """
        if of not in NUMBERS:
            raise PolhodeError(f"of: {of!r} is none of {', '.join(NUMBERS)}")
        node = self[self.root if at is None else at]
        if self._covariances is None:
            raise PolhodeError(
                f"of: {of} of {node.id!r} has no variance: no part states a standard deviation"
            )
        found = self._covariances.contributions(NUMBERS.index(of), node.row)
        each = found.variances.sum(axis=1)
        total = float(each.sum())
        if total == 0.0:
            raise PolhodeError(
                f"of: {of} of {node.id!r} has no variance: all that it depends on counts as exact"
            )
        order = np.argsort(-each, kind="stable")
        names = [
            source or self.ids[row] for row, source in zip(found.rows.tolist(), found.sources, strict=True)
        ]
        is_source = np.array([bool(source) for source in found.sources])
        return Shares(
            of=of,
            at=node.id,
            names=tuple(names[k] for k in order.tolist()),
            is_source=frozen(is_source[order]),
            fraction=frozen(each[order] / total),
            by_number=frozen(found.variances[order] / total),
            sigma=float(np.sqrt(total)),
        )

    def to_csv(self, path: str | PathLike[str]) -> None:
        """Write all rows as a table that `ledger` reads with ``overwrite=True``.

        It contains standard deviations but no correlations; `to_json` writes these too.

        Parameters
        ----------
        path : str or os.PathLike
        """
        write_csv(self, path)

    def to_json(self, path: str | PathLike[str], *, covariance: bool = True) -> None:
        """Write all rows as arrays by name.

        Parameters
        ----------
        path : str or os.PathLike
        covariance : bool, optional
            Whether covariances are written too: 100 numbers a row.
        """
        write_json_ledger(self, path, covariance=covariance)

    def plot(
        self,
        ax: Axes | None = None,
        *,
        of: str = "mass",
        at: str | None = None,
        number: str = "mass",
        mass_label: str | None = None,
    ) -> Axes:
        """Draw the contributions of the parts: to the mass as a sunburst, or to a variance as bars.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; a new figure by default.
        of : str, optional
            ``"mass"`` or ``"variance"``.
        at : str, optional
            The id of a node; the root by default.
        number : str, optional
            The number whose variance is shared, see `variance_shares`.
        mass_label : str, optional
            Word for the unit of the masses; it converts no number. Without it the picture says that the unit
            is that of the table.

        Returns
        -------
        matplotlib.axes.Axes
        """
        from polhode.uncertainty.ledgers.picture import bars, sunburst

        if of == "variance":
            return bars(self.variance_shares(number, at), ax)
        if of != "mass":
            raise PolhodeError(f'of: expected "mass" or "variance", got {of!r}')
        return sunburst(self[self.root if at is None else at], ax, mass_label=mass_label)

    def __getitem__(self, name: str) -> Part:
        row = self._tree.row_of.get(name) if isinstance(name, str) else None
        if row is None:
            raise KeyError(f"no part has the id {name!r}")
        return Part(self, row)

    def __contains__(self, name: object) -> bool:
        return name in self._tree.row_of

    def __len__(self) -> int:
        return len(self.ids)

    def __iter__(self) -> Iterator[Part]:
        return (Part(self, row) for row in range(len(self)))

    def walk(self, depth: int | None = None, at: str | None = None) -> Iterator[Part]:
        """Iterate over the nodes from the root down, each before its children.

        Parameters
        ----------
        depth : int, optional
            Lowest level to visit, counted from the root; all levels by default.
        at : str, optional
            Id of the first node; the root by default.
        """
        waiting = [self[self.root if at is None else at]]
        while waiting:
            node = waiting.pop()
            yield node
            if depth is None or node.depth < depth:
                waiting.extend(reversed(node.children))

    def __repr__(self) -> str:
        parts, levels = int(self.is_part.sum()), int(self.depth.max()) + 1
        mass = with_sigma(*self[self.root].with_sigma("mass"))
        exact = f", {self.unstated} without sigmas" if self.unstated and self._covariances is not None else ""
        return f"<Ledger of {self.root!r}: {parts} parts{exact}, {levels} levels, mass {mass}>"

    def __str__(self) -> str:
        lines = [repr(self)]
        for node in self.walk():
            if len(lines) > _SHOWN:
                lines.append(f"  and {len(self) - _SHOWN} more")
                break
            lines.append(f"{'  ' * (node.depth + 1)}{node.id}  {with_sigma(*node.with_sigma('mass'))}")
        return "\n".join(lines)


@dataclass(frozen=True, eq=False, repr=False)
class Part:
    """One node of a ledger: a part, or an assembly of parts. ``made[id]`` of a ledger ``made`` is one.

    Attributes
    ----------
    ledger : Ledger
        The ledger that the node belongs to.
    row : int
        Its place in the arrays of the ledger, counted from 0.
    """

    ledger: Ledger
    row: int

    @property
    def id(self) -> str:
        """Name of the node."""
        return self.ledger.ids[self.row]

    @property
    def parent(self) -> Part | None:
        """Parent of the node; None for the root."""
        name = self.ledger.parents[self.row]
        return self.ledger[name] if name else None

    @property
    def children(self) -> tuple[Part, ...]:
        """Children of the node, in the order of the table."""
        return tuple(Part(self.ledger, row) for row in self.ledger._tree.children(self.row))

    @property
    def depth(self) -> int:
        """Number of steps from the root down to the node."""
        return int(self.ledger.depth[self.row])

    @property
    def mass(self) -> float:
        """Basic mass."""
        return float(self.ledger.mass[self.row])

    @property
    def predicted_mass(self) -> float:
        """Basic mass plus mass growth allowance."""
        return float(self.ledger.predicted_mass[self.row])

    @property
    def center_of_mass(self) -> Floats:
        """Centre of mass, in the frame of the whole."""
        center: Floats = self.ledger.center_of_mass[self.row]
        return center

    @property
    def inertia(self) -> Floats:
        """Tensor about its own centre of mass, along the axes of the whole."""
        tensor: Floats = self.ledger.inertia[self.row]
        return tensor

    @property
    def body(self) -> RigidBody:
        """The body, without its uncertainty."""
        return self.ledger.bodies[self.row]

    @property
    def covariance(self) -> Floats | None:
        """Covariance of the ten numbers, shape (10, 10); see `Ledger.covariance`."""
        covariances = self.ledger._covariances
        if covariances is None:
            return None
        covariance: Floats = frozen(covariances.matrices(self.ledger._tree.place[[self.row]])[0])
        return covariance

    @property
    def sigma(self) -> Sigmas | None:
        """Standard deviations."""
        sigma = self.ledger.sigma
        return None if sigma is None else Sigmas(*(values[self.row] for values in sigma))

    def with_sigma(self, number: str) -> tuple[float, float | None]:
        """Return one of the ten numbers and its standard deviation, which is None if no part states one.

        Parameters
        ----------
        number : str
            ``"mass"``, ``"Cx"`` … ``"Iyz"``.
        """
        k = NUMBERS.index(number)
        value = _ten(self.mass, self.center_of_mass, self.inertia)[k]
        return value, None if self.sigma is None else _ten(*self.sigma)[k]

    def __repr__(self) -> str:
        kind = "Part" if self.ledger.is_part[self.row] else "Assembly"
        told = ", ".join(f"{name} {with_sigma(*self.with_sigma(name))}" for name in NUMBERS)
        return f"<{kind} {self.id!r}: {told}>"


def tensors(elements: Floats) -> Floats:
    """Write out symmetric tensors: (6, n) to (n, 3, 3)."""
    xx, yy, zz, xy, xz, yz = elements
    return np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=-1).reshape(-1, 3, 3)


def _ten(mass: Any, center: Floats, inertia: Floats) -> list[float]:
    elements = [inertia[a, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    return [float(x) for x in (mass, *center, *elements)]


def frozen(array: Any) -> Any:
    """Make an array read-only."""
    array.flags.writeable = False
    return array


_FORMAT: Final = "polhode.Ledger/1"
_ELEMENTS: Final = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def write_csv(ledger: Ledger, path: str | PathLike[str]) -> None:
    """Write a table: what ``Ledger.to_csv`` does."""
    columns: dict[str, Any] = {"id": ledger.ids, "parent": ledger.parents}
    columns |= ledger._words
    columns |= dict(
        zip(NUMBERS, _columns_of_ten(ledger.mass, ledger.center_of_mass, ledger.inertia), strict=True)
    )
    columns["POIconv"] = ["-"] * len(ledger)
    if ledger.sigma is not None:
        columns |= dict(zip(SIGMAS, _columns_of_ten(*ledger.sigma), strict=True))
    if any(ledger._sources):
        columns["source"] = ledger._sources
    if np.any(ledger.predicted_mass != ledger.mass):
        columns["growth"] = ledger.growth.tolist()
        columns["predicted_mass"] = ledger.predicted_mass.tolist()
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))
    write_bytes(path, text.getvalue().encode())


def write_json_ledger(ledger: Ledger, path: str | PathLike[str], *, covariance: bool) -> None:
    """Write arrays by name: what ``Ledger.to_json`` does."""
    file = Path(path)
    sigma = ledger.sigma
    fields: dict[str, Any] = {
        "format": _FORMAT,
        "root": ledger.root,
        "id": list(ledger.ids),
        "parent": list(ledger.parents),
        "depth": ledger.depth,
        "mass": ledger.mass,
        "center_of_mass": ledger.center_of_mass,
        "inertia": ledger.inertia,
        "growth": ledger.growth,
        "predicted_mass": ledger.predicted_mass,
        "sigma": None if sigma is None else in_json(sigma._asdict(), file),
    }
    if covariance:
        fields["covariance_of"] = list(NUMBERS)
        fields["covariance"] = ledger.covariance
    write_json(file, in_json(fields, file))


def _columns_of_ten(mass: Any, center: Any, inertia: Any) -> list[list[float]]:
    """Return the ten columns as lists of floats, which print with all their digits."""
    return [column.tolist() for column in (mass, *center.T, *(inertia[:, a, b] for a, b in _ELEMENTS))]
