"""Who contributes what to the variance of a number."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from polhode.uncertainty._rollup import NUMBERS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["Shares"]


@dataclass(frozen=True, eq=False, repr=False)
class Shares:
    """Contributions to the variance of one number, the largest first.

    Attributes
    ----------
    of : str
        Which of the ten numbers, of `at`.
    at : str
        The id of the node.
    names : tuple of str
        Name of the part; for parts that share a source, the name of the source.
    is_source : numpy.ndarray of bool
        Whether the name is that of a shared source.
    fraction : numpy.ndarray
        Share of each in the variance; the shares add up to 1.
    by_number : numpy.ndarray
        The same shares, divided by the ten numbers of the part, shape (n, 10): mass, Cx, Cy, Cz, Ixx, Iyy,
        Izz, Ixy, Ixz, Iyz. If the table states a tensor about the origin, a shape with its mass, or a
        density, the numbers are those that it states; a density counts as mass.
    sigma : float
        Standard deviation whose square is divided into these shares.
    """

    of: str
    at: str
    names: tuple[str, ...]
    is_source: NDArray[np.bool_]
    fraction: Floats
    by_number: Floats
    sigma: float

    def __len__(self) -> int:
        return len(self.names)

    def largest(self, row: int) -> str:
        """Give the name of that number of the part in a row which contributes most."""
        return NUMBERS[int(np.argmax(self.by_number[row]))]

    def __repr__(self) -> str:
        told = ", ".join(
            f"{name} {fraction:.1%} ({self.largest(row)})"
            for row, (name, fraction) in enumerate(zip(self.names[:3], self.fraction, strict=False))
        )
        more = f", and {len(self) - 3} more" if len(self) > 3 else ""
        return f"<Shares of the variance of {self.of} of {self.at!r}: {told}{more}>"
