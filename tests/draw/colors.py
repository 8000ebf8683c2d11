"""Colours as eyes see them: contrast, distance, and what is left where one kind of cones is missing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

# From linear red, green and blue (sRGB) to what long, middle and short cones answer: to XYZ after Judd and
# Vos (Viénot, Brettel, Mollon, Color Research & Application 24 (1999) 243,
# doi:10.1002/(SICI)1520-6378(199908)24:4<243::AID-COL5>3.0.CO;2-3), then to cones after Smith and Pokorny,
# Vision Research 15 (1975) 161.
CONES = np.array([[0.15514, 0.54312, -0.03286], [-0.15514, 0.45684, 0.03286], [0.0, 0.0, 0.00801]]) @ (
    np.array([[40.9568, 35.5041, 17.9167], [21.3389, 70.6743, 7.98680], [1.86297, 11.4620, 91.2367]])
)


def without(missing: int, kept: tuple[float, float, float]) -> NDArray[np.float64]:
    """What is seen without one kind of cones, as Viénot, Brettel and Mollon: white and one colour stay."""
    others = [kind for kind in range(3) if kind != missing]
    stay = CONES @ np.array([(1.0, 1.0, 1.0), kept]).T
    answer = np.eye(3)
    answer[missing] = 0.0
    answer[missing, others] = np.linalg.solve(stay[others].T, stay[missing])
    seen: NDArray[np.float64] = np.linalg.inv(CONES) @ answer @ CONES
    return seen


BLUE, RED = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
SEEN = {"all": np.eye(3), "protan": without(0, BLUE), "deutan": without(1, BLUE), "tritan": without(2, RED)}
"""Nothing amiss, and without long, middle and short cones."""


def linear(color: str) -> NDArray[np.float64]:
    parts = np.array([int(color[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    return np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)


def luminance(color: str) -> float:
    return float(linear(color) @ (0.2126, 0.7152, 0.0722))


def lab(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """CIE L*a*b* under D65."""
    to_xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
    x, y, z = np.cbrt(np.maximum(to_xyz @ rgb, 0.0) / (0.9505, 1.0, 1.089))
    return np.array([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)])
