"""What an assembly is once it is read: its parts in the axes of the whole, their tree and their sum."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from polhode._core import RigidBody
from polhode.assembly.tables import suggest_name
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    import numpy as np
    from mpl_toolkits.mplot3d.axes3d import Axes3D
    from numpy.typing import NDArray

    from polhode.uncertainty import Ledger, Part

    Floats = NDArray[np.float64]

__all__ = ["Assembly", "Member", "Overlap"]


class Overlap(NamedTuple):
    """Two parts of an assembly that share space, so that matter counts twice.

    Attributes
    ----------
    kind : str
        ``"across"``; ``"inside"`` where the other lies within the one; ``"same"`` where it is the same part
        at the same place.
    one, other : str
        Their names, the larger one first.
    volume : float
        What they share, in m^3; not a number where that was not computed.
    """

    kind: str
    one: str
    other: str
    volume: float


class Member(NamedTuple):
    """One part of an assembly, in its position.

    Attributes
    ----------
    id : str
        Names on the way from the whole, which is left out, to the part, with / between them. A copy has its
        number, from 1 on, as the last name: ``"leg/2"``.
    body : RigidBody
        The body in the axes of the whole, in kg and m.
    solid : str
        Name of its shape; "" if it comes from a file or from numbers.
    arguments : dict
        Arguments of that shape, lengths in metres.
    file : pathlib.Path or None
        File from which the part was read.
    metres : float
        Metres in one unit of length of that file.
    rotation, displacement : numpy.ndarray, shapes (3, 3) and (3,)
        Position of the part: ``r = rotation @ r_part + displacement``. The rotation of a mirror image has the
        determinant -1.
    """

    id: str
    body: RigidBody
    solid: str
    arguments: dict[str, Any]
    file: Path | None
    metres: float
    rotation: Floats
    displacement: Floats


@dataclass(frozen=True, eq=False, repr=False)
class Assembly:
    """A body of many parts.

    Attributes
    ----------
    name : str
    parts : tuple of Member
        Parts without parts of their own, in the order of the file.
    ledger : Ledger
        The tree of parts with the sums at every level, see :mod:`polhode.uncertainty.ledgers`.
    notes : tuple of str
        Remarks, for example about copies at the same place.
    overlaps : tuple of Overlap
        Parts that share space, the largest volume first. Compared are solids and closed meshes of up to
        50,000 triangles, not solids of CAD.
    """

    name: str
    parts: tuple[Member, ...]
    ledger: Ledger
    notes: tuple[str, ...] = ()
    overlaps: tuple[Overlap, ...] = ()

    @cached_property
    def body(self) -> RigidBody:
        """The whole as one body, with its uncertainty."""
        return RigidBody.stack([part.body for part in self.parts]).combined()

    def __getitem__(self, name: str) -> Part:
        """Return a node of the tree by its names with / between them, as ``"arm/motor"``."""
        if name not in self.ledger:
            raise PolhodeError(
                f"there is no part {name!r} in {self.name!r}; {suggest_name(name, self.ledger.ids)}"
            )
        return self.ledger[name]

    def __len__(self) -> int:
        return len(self.parts)

    def __repr__(self) -> str:
        count = f"{len(self.parts)} parts" if len(self.parts) != 1 else "1 part"
        return f"<Assembly {self.name!r}: {count}, mass {float(self.body.mass):.6g}>"

    def plot(self, ax: Axes3D | None = None, **options: Any) -> Axes3D:
        """Draw the parts in their positions, with the principal axes of the whole; needs matplotlib.

        Parameters
        ----------
        ax : mpl_toolkits.mplot3d.axes3d.Axes3D, optional
            Where to draw; a new figure by default.
        **options
            `length_label`, see :func:`polhode.plot.body`.

        Returns
        -------
        mpl_toolkits.mplot3d.axes3d.Axes3D
        """
        from polhode.assembly.picture import draw

        return draw(self, ax, **options)
