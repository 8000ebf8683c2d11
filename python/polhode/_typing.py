"""Types that signatures speak of."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["SupportsQuaternion", "SupportsSigma"]


class SupportsQuaternion(Protocol):
    """A rotation of another library, such as SciPy's ``Rotation``."""

    def as_quat(self) -> NDArray[np.float64]:
        """Return unit quaternions (x, y, z, w), shape (..., 4)."""


class SupportsSigma(Protocol):
    """A number with a standard deviation of another library, such as a ``ufloat`` of `uncertainties`."""

    @property
    def nominal_value(self) -> float:
        """Its value."""

    @property
    def std_dev(self) -> float:
        """Its standard deviation."""
