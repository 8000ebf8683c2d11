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

    Each contribution comes from one part, or from all parts that share a source.

    Attributes
    ----------
    of : str
        The number: mass, a coordinate of the centre, or an element of the tensor.
    at : str
        The id of the node whose number it is.
    names : tuple of str
        Name of each part; for parts that share a source, the name of the source.
    is_source : numpy.ndarray of bool, shape (n,)
        Whether the name is that of a shared source.
    fraction : numpy.ndarray, shape (n,)
        Share of each in the variance; the shares add up to 1.
    by_number : numpy.ndarray, shape (n, 10)
        The same shares, split by the number of the part whose error causes them: mass, Cx, Cy, Cz, Ixx, Iyy,
        Izz, Ixy, Ixz, Iyz, as the row of the part states them. A stated density counts as mass.
    sigma : float
        Standard deviation of the number; its square is the variance that is shared out.
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
        """Give the name of the number that contributes most, of the part with this place in `names`."""
        return NUMBERS[int(np.argmax(self.by_number[row]))]

    def __repr__(self) -> str:
        told = ", ".join(
            f"{name} {fraction:.1%} ({self.largest(row)})"
            for row, (name, fraction) in enumerate(zip(self.names[:3], self.fraction, strict=False))
        )
        more = f", and {len(self) - 3} more" if len(self) > 3 else ""
        return f"<Shares of the variance of {self.of} of {self.at!r}: {told}{more}>"
