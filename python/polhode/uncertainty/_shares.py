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
    """Who contributes what to the variance of one number: the largest first.

    Attributes
    ----------
    of : str
        Which of the ten numbers, of `at`.
    at : str
        The id of the node.
    names : tuple of str
        The part, or of parts that share a source its name.
    is_source : numpy.ndarray of bool
        Whether a name is that of a shared source.
    fraction : numpy.ndarray
        The share of each in the variance; they sum to 1.
    by_number : numpy.ndarray
        The same split by the ten numbers of the part whose error it is, shape (n, 10): mass, Cx, Cy, Cz, Ixx,
        Iyy, Izz, Ixy, Ixz, Iyz. Of a part of which a tensor about the origin, a mass of a shape or a density
        is stated, the numbers as they are stated; a density counts as mass.
    sigma : float
        The standard deviation whose square is shared.
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
        """Give which of the ten numbers of the part in a row contributes most."""
        return NUMBERS[int(np.argmax(self.by_number[row]))]

    def __repr__(self) -> str:
        told = ", ".join(
            f"{name} {fraction:.1%} ({self.largest(row)})"
            for row, (name, fraction) in enumerate(zip(self.names[:3], self.fraction, strict=False))
        )
        more = f", and {len(self) - 3} more" if len(self) > 3 else ""
        return f"<Shares of the variance of {self.of} of {self.at!r}: {told}{more}>"
