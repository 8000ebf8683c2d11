"""Every solid, lamina and rod as a mean of squares: textbook integrals in plain arithmetic.

A shape is its measure (volume, area or length), its centre, and the means of xx, yy, zz, xy, xz, yz over it
about the centre. The formulas ask for little but + − × ÷, so that the same lines serve floats, arrays of
draws and numbers of fifty digits.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import mpmath
import numpy as np

__all__ = ["FLOATS", "SHAPES", "Field", "Shape", "fifty_digits"]


class Field(NamedTuple):
    """What a kind of number knows beyond arithmetic."""

    number: Callable[[float], Any]
    sqrt: Callable[[Any], Any]
    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    pi: Any


FLOATS = Field(float, np.sqrt, np.sin, np.cos, np.pi)


def fifty_digits() -> Field:
    """Numbers of mpmath at the precision that holds where it is called."""
    return Field(lambda x: mpmath.mpf(float(x)), mpmath.sqrt, mpmath.sin, mpmath.cos, +mpmath.pi)


class Shape(NamedTuple):
    """Measure, centre and central means of xx, yy, zz, xy, xz, yz."""

    measure: Any
    center: tuple[Any, Any, Any]
    means: tuple[Any, Any, Any, Any, Any, Any]


def _centred(measure: Any, xx: Any, yy: Any, zz: Any, xz: Any = 0) -> Shape:
    return Shape(measure, (0, 0, 0), (xx, yy, zz, 0, xz, 0))


def box(f: Field, x: Any, y: Any, z: Any) -> Shape:  # noqa: ARG001
    return _centred(x * y * z, x * x / 12, y * y / 12, z * z / 12)


def cube(f: Field, a: Any) -> Shape:
    return box(f, a, a, a)


def ellipsoid(f: Field, a: Any, b: Any, c: Any) -> Shape:
    return _centred(4 * f.pi / 3 * a * b * c, a * a / 5, b * b / 5, c * c / 5)


def sphere(f: Field, r: Any) -> Shape:
    return ellipsoid(f, r, r, r)


def hollow_sphere(f: Field, r: Any, R: Any) -> Shape:
    """∫x² dV = (4π/15) (R⁵ − r⁵)."""
    volume = 4 * f.pi / 3 * (R**3 - r**3)
    mean = 4 * f.pi / 15 * (R**5 - r**5) / volume
    return _centred(volume, mean, mean, mean)


def tube(f: Field, r: Any, R: Any, h: Any) -> Shape:
    """∫x² dA = (π/4) (R⁴ − r⁴) over a slice."""
    area = f.pi * (R * R - r * r)
    mean = f.pi / 4 * (R**4 - r**4) / area
    return _centred(area * h, mean, mean, h * h / 12)


def cylinder(f: Field, R: Any, h: Any) -> Shape:
    return _centred(f.pi * R * R * h, R * R / 4, R * R / 4, h * h / 12)


def frustum(f: Field, R: Any, r: Any, h: Any) -> Shape:
    """Slices of radius R + (r − R) t at the height h t."""
    volume = f.pi * h / 3 * (R * R + R * r + r * r)
    across = f.pi * h / 20 * (R**4 + R**3 * r + R * R * r * r + R * r**3 + r**4) / volume
    first = f.pi * h * h / 12 * (R * R + 2 * R * r + 3 * r * r) / volume
    along = f.pi * h**3 / 30 * (R * R + 3 * R * r + 6 * r * r) / volume
    return _centred(volume, across, across, along - first * first)


def cone(f: Field, R: Any, h: Any) -> Shape:
    return frustum(f, R, 0, h)


def hemisphere(f: Field, R: Any) -> Shape:
    """A ball's means about the middle of the flat face, less the square of 3R/8."""
    return _centred(2 * f.pi / 3 * R**3, R * R / 5, R * R / 5, R * R / 5 - 9 * R * R / 64)


def capsule(f: Field, R: Any, L: Any) -> Shape:
    """A cylinder, and half balls whose means about the end of the cylinder are R²/5 and 3R/8."""
    middle, ball = f.pi * R * R * L, 4 * f.pi / 3 * R**3
    across = middle * R * R / 4 + ball * R * R / 5
    along = middle * L * L / 12 + ball * (R * R / 5 + 2 * (L / 2) * (3 * R / 8) + L * L / 4)
    return _centred(
        middle + ball, across / (middle + ball), across / (middle + ball), along / (middle + ball)
    )


def torus(f: Field, R: Any, r: Any) -> Shape:
    """Pappus: the mean of the distance squared is R² + ¾ r², that of z² is r²/4."""
    across = (R * R + 3 * r * r / 4) / 2
    return _centred(2 * f.pi**2 * R * r * r, across, across, r * r / 4)


def _simplex(corners: Any, measure: Any, parts: int) -> Shape:
    """A mean over a simplex of k corners is Σ dᵢ dᵢᵀ/(k (k + 1)) about its centroid."""
    n = len(corners)
    center = tuple(sum(p[i] for p in corners) / n for i in range(3))
    arms = [[p[i] - center[i] for i in range(3)] for p in corners]
    pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    xx, yy, zz, xy, xz, yz = (sum(d[i] * d[j] for d in arms) / parts for i, j in pairs)
    return Shape(measure, (center[0], center[1], center[2]), (xx, yy, zz, xy, xz, yz))


def tetrahedron(f: Field, a: Any) -> Shape:
    low = -a / f.sqrt(f.number(24.0))
    corners = [
        (0 * a, 0 * a, a * f.sqrt(f.number(6.0)) / 4),
        (a / f.sqrt(f.number(3.0)), 0 * a, low),
        (-a / f.sqrt(f.number(12.0)), a / 2, low),
        (-a / f.sqrt(f.number(12.0)), -a / 2, low),
    ]
    return _simplex(corners, a**3 / (6 * f.sqrt(f.number(2.0))), 20)


def prism(f: Field, n: int, R: Any, h: Any) -> Shape:
    """n triangles with a corner on the axis: ∫x² + y² is R² (2 + cos 2π/n)/6 of the area."""
    angle = 2 * f.pi / n
    across = R * R * (2 + f.cos(angle)) / 12
    return _centred(n * R * R * f.sin(angle) / 2 * h, across, across, h * h / 12)


def pyramid(f: Field, x: Any, y: Any, z: Any) -> Shape:  # noqa: ARG001
    """Slices that shrink as 1 − t: ∫(1 − t)⁴/∫(1 − t)² = 3/5 of the base's x²/12."""
    return _centred(x * y * z / 3, x * x / 20, y * y / 20, z * z / 10 - z * z / 16)


def wedge(f: Field, x: Any, y: Any, z: Any) -> Shape:  # noqa: ARG001
    """A right triangle in x and z: x²/18, z²/18 and −x z/36 about its centroid."""
    return _centred(x * y * z / 2, x * x / 18, y * y / 12, z * z / 18, -x * z / 36)


def annulus(f: Field, r: Any, R: Any) -> Shape:
    area, mean = f.pi * (R * R - r * r), (R * R + r * r) / 4
    return _centred(area, mean, mean, 0)


def ellipse(f: Field, a: Any, b: Any) -> Shape:
    return _centred(f.pi * a * b, a * a / 4, b * b / 4, 0)


def disk(f: Field, R: Any) -> Shape:
    return ellipse(f, R, R)


def rectangle(f: Field, x: Any, y: Any) -> Shape:  # noqa: ARG001
    return _centred(x * y, x * x / 12, y * y / 12, 0)


def triangle(f: Field, *xy: Any) -> Shape:  # noqa: ARG001
    (ax, ay), (bx, by), (cx, cy) = corners = [(xy[i], xy[i + 1]) for i in (0, 2, 4)]
    area = ((bx - ax) * (cy - ay) - (cx - ax) * (by - ay)) / 2
    return _simplex([(x, y, 0) for x, y in corners], abs(area), 12)


def polygon(f: Field, *xy: Any) -> Shape:  # noqa: ARG001
    """Triangles from the origin with their signs."""
    corners = [(xy[i], xy[i + 1]) for i in range(0, len(xy), 2)]
    area: Any = 0
    first: list[Any] = [0, 0]
    second: list[Any] = [0, 0, 0]
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
        d = (ax * by - bx * ay) / 2
        area += d
        first[0] += d * (ax + bx) / 3
        first[1] += d * (ay + by) / 3
        second[0] += d * (ax * ax + ax * bx + bx * bx) / 6
        second[1] += d * (ay * ay + ay * by + by * by) / 6
        second[2] += d * (2 * ax * ay + 2 * bx * by + ax * by + bx * ay) / 12
    x, y = first[0] / area, first[1] / area
    xx, yy, xy_ = (s / area for s in second)
    return Shape(abs(area), (x, y, 0), (xx - x * x, yy - y * y, 0, xy_ - x * y, 0, 0))


def rod(f: Field, L: Any) -> Shape:  # noqa: ARG001
    return _centred(L, 0, 0, L * L / 12)


def ring(f: Field, R: Any) -> Shape:
    return _centred(2 * f.pi * R, R * R / 2, R * R / 2, 0)


def arc(f: Field, R: Any, a: Any) -> Shape:
    """About the circle's centre ∫cos² over the arc is (1 + sin α/α)/2."""
    middle, share = R * f.sin(a / 2) / (a / 2), f.sin(a) / a
    return _centred(R * a, R * R * (1 + share) / 2 - middle * middle, R * R * (1 - share) / 2, 0)


SHAPES: dict[str, tuple[Callable[..., Shape], tuple[str, ...], str]] = {
    "box": (box, ("size:3",), "solids"),
    "cube": (cube, ("side",), "solids"),
    "sphere": (sphere, ("radius",), "solids"),
    "ellipsoid": (ellipsoid, ("semi_axes:3",), "solids"),
    "hollow_sphere": (hollow_sphere, ("inner_radius", "outer_radius"), "solids"),
    "cylinder": (cylinder, ("radius", "height"), "solids"),
    "tube": (tube, ("inner_radius", "outer_radius", "height"), "solids"),
    "cone": (cone, ("radius", "height"), "solids"),
    "frustum": (frustum, ("bottom_radius", "top_radius", "height"), "solids"),
    "capsule": (capsule, ("radius", "length"), "solids"),
    "torus": (torus, ("major_radius", "minor_radius"), "solids"),
    "hemisphere": (hemisphere, ("radius",), "solids"),
    "tetrahedron": (tetrahedron, ("side",), "solids"),
    "prism": (prism, ("sides", "radius", "height"), "solids"),
    "pyramid": (pyramid, ("size:3",), "solids"),
    "wedge": (wedge, ("size:3",), "solids"),
    "disk": (disk, ("radius",), "laminae"),
    "annulus": (annulus, ("inner_radius", "outer_radius"), "laminae"),
    "ellipse": (ellipse, ("semi_axes:2",), "laminae"),
    "rectangle": (rectangle, ("size:2",), "laminae"),
    "triangle": (triangle, ("vertices:3x2",), "laminae"),
    "polygon": (polygon, ("vertices:5x2",), "laminae"),
    "rod": (rod, ("length",), "rods"),
    "ring": (ring, ("radius",), "rods"),
    "arc": (arc, ("radius", "angle"), "rods"),
}
"""Name: formula, arguments (with their shape where they are arrays) and the package's module."""
