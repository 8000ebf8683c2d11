"""The table of shapes: sizes, measure, and second moments per unit mass about the centre of mass."""

from __future__ import annotations

from itertools import pairwise
from typing import Any, Final, NamedTuple

from polhode.symbolic.symbols import positive, real, sympy

__all__ = ["SHAPES", "Row", "polygon"]


class Row(NamedTuple):
    """A shape: ``∫ r rᵀ dm/M`` with r from the centre of mass."""

    room: str
    sizes: dict[str, Any]
    measure: Any
    second_moment: Any
    center: Any


_pi: Final = sympy.pi
_R, _r, _h, _L, _a, _b, _c = positive("R r h L a b c")
_n: Final = sympy.Symbol("n", integer=True, positive=True)
_alpha: Final = positive("alpha")
_ORIGIN: Final = sympy.zeros(3, 1)


def _row(room: str, sizes: dict[str, Any], measure: Any, *second: Any, xz: Any = 0) -> Row:
    x, y, z = map(sympy.sympify, second)
    matrix = sympy.Matrix([[x, 0, xz], [0, y, 0], [xz, 0, z]])
    return Row(room, sizes, measure, matrix, _ORIGIN)


def _frustum() -> Row:
    q = _R**2 + _R * _r + _r**2
    across = 3 * (_R**4 + _R**3 * _r + _R**2 * _r**2 + _R * _r**3 + _r**4) / (20 * q)
    along = 3 * _h**2 * (_R**4 + 4 * _R**3 * _r + 10 * _R**2 * _r**2 + 4 * _R * _r**3 + _r**4) / (80 * q**2)
    sizes = {"bottom_radius": _R, "top_radius": _r, "height": _h}
    return _row("solids", sizes, _pi * _h * q / 3, across, across, along)


def _capsule() -> Row:
    whole = _L + 4 * _R / 3
    across = (_R**2 * _L / 4 + 4 * _R**3 / 15) / whole
    along = (_L**3 / 12 + 4 * _R / 3 * (_R**2 / 5 + 3 * _R * _L / 8 + _L**2 / 4)) / whole
    return _row("solids", {"radius": _R, "length": _L}, _pi * _R**2 * whole, across, across, along)


def _hollow_sphere() -> Row:
    q = _R**2 + _R * _r + _r**2
    each = (_R**4 + _R**3 * _r + _R**2 * _r**2 + _R * _r**3 + _r**4) / (5 * q)
    sizes = {"inner_radius": _r, "outer_radius": _R}
    return _row("solids", sizes, 4 * _pi * (_R - _r) * q / 3, each, each, each)


def _prism() -> Row:
    across = _R**2 * (2 + sympy.cos(2 * _pi / _n)) / 12
    area = _n * _R**2 * sympy.sin(2 * _pi / _n) / 2
    sizes = {"sides": _n, "radius": _R, "height": _h}
    return _row("solids", sizes, area * _h, across, across, _h**2 / 12)


def _arc() -> Row:
    center = sympy.sin(_alpha / 2) / (_alpha / 2)
    ratio = sympy.sin(_alpha) / _alpha
    along = _R**2 * ((1 + ratio) / 2 - center**2)
    return _row("rods", {"radius": _R, "angle": _alpha}, _R * _alpha, along, _R**2 * (1 - ratio) / 2, 0)


def polygon(corners: int) -> Row:
    """Give a polygon with so many corners: sums over its edges, from its first corner."""
    if corners < 3:
        raise ValueError(f"corners: a polygon has at least 3, got {corners}")
    points = [real(f"x_{k} y_{k}") for k in range(1, corners + 1)]
    first = sympy.Matrix(points[0])
    arms = [sympy.Matrix(point) - first for point in points[1:]]
    area, arm, second = sympy.S.Zero, sympy.zeros(2, 1), sympy.zeros(2, 2)
    for a, b in pairwise(arms):
        twice = a[0] * b[1] - a[1] * b[0]
        area += twice / 2
        arm += twice * (a + b) / 6
        second += twice * (a * a.T + b * b.T + (a + b) * (a + b).T) / 24
    middle = arm / area
    inner = second / area - middle * middle.T
    if corners == 3:  # the edges alone
        edges = [arms[0], arms[1] - arms[0], -arms[1]]
        middle, inner = (arms[0] + arms[1]) / 3, sum((e * e.T for e in edges), sympy.zeros(2, 2)) / 36
    matrix = sympy.zeros(3, 3)
    matrix[:2, :2] = inner
    center = sympy.Matrix([*(first + middle), 0])
    sizes = {"vertices": tuple(points)}
    return Row("laminae", sizes, sympy.Abs(area), matrix, center)


SHAPES: Final[dict[str, Row]] = {
    "box": _row("solids", {"size": (_a, _b, _c)}, _a * _b * _c, _a**2 / 12, _b**2 / 12, _c**2 / 12),
    "cube": _row("solids", {"side": _a}, _a**3, *[_a**2 / 12] * 3),
    "sphere": _row("solids", {"radius": _R}, 4 * _pi * _R**3 / 3, *[_R**2 / 5] * 3),
    "hollow_sphere": _hollow_sphere(),
    "hemisphere": _row("solids", {"radius": _R}, 2 * _pi * _R**3 / 3, _R**2 / 5, _R**2 / 5, 19 * _R**2 / 320),
    "ellipsoid": _row(
        "solids", {"semi_axes": (_a, _b, _c)}, 4 * _pi * _a * _b * _c / 3, _a**2 / 5, _b**2 / 5, _c**2 / 5
    ),
    "cylinder": _row(
        "solids", {"radius": _R, "height": _h}, _pi * _R**2 * _h, _R**2 / 4, _R**2 / 4, _h**2 / 12
    ),
    "tube": _row(
        "solids",
        {"inner_radius": _r, "outer_radius": _R, "height": _h},
        _pi * (_R - _r) * (_R + _r) * _h,
        (_R**2 + _r**2) / 4,
        (_R**2 + _r**2) / 4,
        _h**2 / 12,
    ),
    "cone": _row(
        "solids", {"radius": _R, "height": _h}, _pi * _R**2 * _h / 3, *[3 * _R**2 / 20] * 2, 3 * _h**2 / 80
    ),
    "frustum": _frustum(),
    "capsule": _capsule(),
    "torus": _row(
        "solids",
        {"major_radius": _R, "minor_radius": _r},
        2 * _pi**2 * _R * _r**2,
        *[(_R**2 + 3 * _r**2 / 4) / 2] * 2,
        _r**2 / 4,
    ),
    "tetrahedron": _row("solids", {"side": _a}, _a**3 / (6 * sympy.sqrt(2)), *[_a**2 / 40] * 3),
    "prism": _prism(),
    "pyramid": _row(
        "solids", {"size": (_a, _b, _c)}, _a * _b * _c / 3, _a**2 / 20, _b**2 / 20, 3 * _c**2 / 80
    ),
    "wedge": _row(
        "solids",
        {"size": (_a, _b, _c)},
        _a * _b * _c / 2,
        _a**2 / 18,
        _b**2 / 12,
        _c**2 / 18,
        xz=-_a * _c / 36,
    ),
    "disk": _row("laminae", {"radius": _R}, _pi * _R**2, _R**2 / 4, _R**2 / 4, 0),
    "annulus": _row(
        "laminae",
        {"inner_radius": _r, "outer_radius": _R},
        _pi * (_R - _r) * (_R + _r),
        *[(_R**2 + _r**2) / 4] * 2,
        0,
    ),
    "ellipse": _row("laminae", {"semi_axes": (_a, _b)}, _pi * _a * _b, _a**2 / 4, _b**2 / 4, 0),
    "rectangle": _row("laminae", {"size": (_a, _b)}, _a * _b, _a**2 / 12, _b**2 / 12, 0),
    "triangle": polygon(3),
    "polygon": polygon(4),
    "rod": _row("rods", {"length": _L}, _L, 0, 0, _L**2 / 12),
    "ring": _row("rods", {"radius": _R}, 2 * _pi * _R, _R**2 / 2, _R**2 / 2, 0),
    "arc": _arc(),
}
"""By the name of the function that gives the numbers."""
