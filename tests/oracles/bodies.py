"""Random rigid bodies that exist: needles, plates, near-spheres, over twelve decades of scale.

A body is drawn as the second moments d of its mass along three perpendicular axes, so that its
principal moments d₂+d₃, d₁+d₃, d₁+d₂ obey the triangle inequalities by construction.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]

__all__ = ["Body", "attitudes", "bodies", "matrix", "principal_moments", "vectors"]


class Body(NamedTuple):
    """What defines a body, in the order of the arguments of ``RigidBody.from_principal``."""

    mass: float
    moments: Floats
    axes: Floats
    center_of_mass: Floats

    @property
    def inertia(self) -> Floats:
        """Tensor about the centre of mass, symmetric to the last bit."""
        tensor = (self.axes * self.moments) @ self.axes.T
        return (tensor + tensor.T) / 2

    @property
    def gyration(self) -> float:
        """Largest radius of gyration: the body's own length."""
        return float(np.sqrt(self.moments[2] / self.mass))


def matrix(quaternion: Floats) -> Floats:
    """Rotation matrix of the unit quaternion (x, y, z, w)."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _numbers(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_subnormal=False)


@st.composite
def attitudes(draw: st.DrawFn) -> Floats:
    """Unit quaternions (x, y, z, w)."""
    q = np.array([draw(_numbers(-1, 1)) for _ in range(4)])
    norm = float(np.linalg.norm(q))
    unit: Floats = q / norm if norm > 0.1 else np.array([0.5, 0.5, 0.5, 0.5])
    return unit


@st.composite
def vectors(draw: st.DrawFn, length: float = 1.0) -> Floats:
    """Vectors of about the given length, over four decades; single components may be far smaller, or zero."""
    scale = length * 10.0 ** draw(st.integers(-2, 2))
    component = st.floats(-1, 1, width=32, allow_subnormal=False)  # above 1e-38: squares do not underflow
    return scale * np.array([draw(component) for _ in range(3)])


@st.composite
def principal_moments(draw: st.DrawFn, thinnest: int = 6) -> Floats:
    """Ascending principal moments, the smaller second moments down to 10^-thinnest of the largest."""
    thin = 10.0 ** -draw(st.integers(1, thinnest))
    shape = draw(st.sampled_from(["generic", "needle", "plate", "near-sphere", "symmetric"]))
    a, b = draw(_numbers(0.1, 1)), draw(_numbers(0.1, 1))
    second = {
        "generic": (a, b, 1.0),
        "needle": (a * thin, b * thin, 1.0),
        "plate": (thin, b, 1.0),
        "near-sphere": (1 - a * thin, 1 - b * thin, 1.0),
        "symmetric": (a, a, 1.0),
    }[shape]
    x, y, z = second
    return np.sort(np.array([x + y, y + z, z + x]))


@st.composite
def bodies(draw: st.DrawFn, thinnest: int = 6, decades: int = 6) -> Body:
    """Bodies of any mass and size from 10^-decades to 10^decades, anywhere, in any attitude."""
    mass = draw(_numbers(1, 10)) * 10.0 ** draw(st.integers(-decades, decades))
    length = 10.0 ** draw(st.integers(-decades, decades))
    moments = draw(principal_moments(thinnest)) * mass * length**2
    return Body(mass, moments, matrix(draw(attitudes())), draw(vectors(length)))
