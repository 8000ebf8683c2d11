"""Shapes of uniform density: symbolic tensors, from one table of sizes and second moments."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from polhode.symbolic.laws import parallel_axis
from polhode.symbolic.symbols import function, positive, real, symbols, sympy

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

__all__ = [
    "SHAPES",
    "Row",
    "Shape",
    "names",
    "polygon",
    "shape",
]


@dataclass(frozen=True, repr=False)
class Shape:
    """Formulas of a solid, lamina or rod of uniform density.

    Attributes
    ----------
    name : str
    room : str
        ``"solids"``, ``"laminae"`` or ``"rods"``: the module with a function that has the name of the shape
        and makes it from numbers.
    sizes : dict of str and Symbol or tuple of Symbol
        Symbols of the sizes, by the names of the arguments of that function.
    mass : Symbol
        M.
    measure : Expr
        Volume, area or length; M is the product of this and the density.
    center_of_mass : Matrix, shape (3, 1)
        Centre of mass in the axes of that function.
    inertia : Matrix, shape (3, 3)
        Tensor about the centre of mass.
    """

    name: str
    room: str
    sizes: dict[str, Any]
    measure: Any
    center_of_mass: Any
    inertia: Any
    mass: Any = symbols.mass

    def __repr__(self) -> str:
        letters = ", ".join(f"{name}={value}" for name, value in self.sizes.items())
        return f"<Shape {self.room}.{self.name}({letters}, mass={self.mass})>"

    @property
    def arguments(self) -> tuple[Any, ...]:
        """The symbols: M, then the sizes."""
        flat: list[Any] = [self.mass]
        for size in self.sizes.values():
            flat += sympy.flatten([size])
        return tuple(flat)

    @property
    def moments(self) -> tuple[Any, Any, Any]:
        """Principal moments about the centre of mass, in the order of the columns of `axes`."""
        pair = self._pair()
        diagonal: list[Any] = [self.inertia[k, k] for k in range(3)]
        if pair is not None:
            i, j = pair
            mean = _tidy((diagonal[i] + diagonal[j]) / 2)
            half = sympy.sqrt(_tidy(((diagonal[i] - diagonal[j]) / 2) ** 2 + self.inertia[i, j] ** 2))
            diagonal[i], diagonal[j] = mean + half, mean - half
        return diagonal[0], diagonal[1], diagonal[2]

    @property
    def axes(self) -> Any:
        """Principal axes, as the columns of a right-handed matrix; the body axes if possible."""
        pair, axes = self._pair(), sympy.eye(3)
        if pair is not None:
            i, j = pair
            difference = self.inertia[i, i] - self.inertia[j, j]
            angle = sympy.atan2(2 * self.inertia[i, j], difference) / 2
            axes[i, i] = axes[j, j] = sympy.cos(angle)
            axes[j, i], axes[i, j] = sympy.sin(angle), -sympy.sin(angle)
        return axes

    def inertia_about(self, point: Any) -> Any:
        """Compute the tensor about a point.

        Parameters
        ----------
        point : sequence of three Expr
            Point in the axes of `center_of_mass`.

        Returns
        -------
        Matrix, shape (3, 3)

        Examples
        --------
        >>> from polhode import symbolic
        >>> cone = symbolic.shape("cone")
        >>> h = cone.sizes["height"]
        >>> cone.inertia_about((0, 0, 3 * h / 4))[0, 0].factor()
        3*M*(R**2 + 4*h**2)/20
        """
        place = [point] if isinstance(point, str) else list(point)
        if len(place) != 3:
            raise ValueError(
                f"point: expected three expressions or numbers, got {point!r}; the axes are those of "
                f"center_of_mass, {tuple(self.center_of_mass)}"
            )
        away = sympy.Matrix(place) - self.center_of_mass
        return parallel_axis(self.inertia, self.mass, away)

    def function(self) -> Callable[..., NDArray[Any]]:
        """Return the tensor as a numeric function of arrays; it takes values of `arguments`."""
        return function(self.inertia, self.arguments)

    def latex(self) -> str:
        r"""Return measure and moments in LaTeX.

        Examples
        --------
        >>> from polhode import symbolic
        >>> print(symbolic.shape("sphere").latex())
        V = \frac{4 \pi R^{3}}{3}, \quad I_1 = I_2 = I_3 = \frac{2 M R^{2}}{5}
        """
        letter = {"solids": "V", "laminae": "A", "rods": "s"}[self.room]
        told: dict[str, str] = {}
        for k, moment in enumerate(self.moments, 1):
            written = sympy.latex(moment)
            told[written] = f"{told[written]} = I_{k}" if written in told else f"I_{k}"
        parts = [f"{letter} = {sympy.latex(self.measure)}"]
        parts += [f"{names} = {written}" for written, names in told.items()]
        return r", \quad ".join(parts)

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.latex()}$"

    def _pair(self) -> tuple[int, int] | None:
        """Find which two axes have a product of inertia."""
        return next((pair for pair in ((0, 1), (0, 2), (1, 2)) if self.inertia[pair] != 0), None)


def names() -> tuple[str, ...]:
    """Return the names of the shapes: all of `solids`, `laminae` and `rods`."""
    return tuple(SHAPES)


def shape(name: str, *, corners: int | None = None) -> Shape:
    """Return the formulas of a shape by its name.

    Parameters
    ----------
    name : str
        One of :func:`names`, for example ``"cone"``.
    corners : int, optional
        Number of corners of a polygon.

    Returns
    -------
    Shape

    Examples
    --------
    >>> from polhode import symbolic
    >>> cylinder = symbolic.shape("cylinder")
    >>> cylinder.moments
    (M*(3*R**2 + h**2)/12, M*(3*R**2 + h**2)/12, M*R**2/2)
    >>> cylinder
    <Shape solids.cylinder(radius=R, height=h, mass=M)>
    """
    if name not in SHAPES:
        near = get_close_matches(str(name), SHAPES, 1)
        way_out = f"did you mean {near[0]}?" if near else f"there are {', '.join(SHAPES)}"
        raise ValueError(f"name: {name!r} is no shape; {way_out}")
    if (name == "polygon") != (corners is not None):
        raise ValueError(
            "corners: a polygon, and nothing else, needs their number: shape('polygon', corners=5)"
        )
    row = SHAPES[name] if corners is None else polygon(corners)
    second = row.second_moment
    tensor = (symbols.mass * (sympy.trace(second) * sympy.eye(3) - second)).applyfunc(_tidy)
    return Shape(name, row.room, row.sizes, row.measure, row.center, tensor)


def _tidy(expression: Any) -> Any:
    """Factor an expression with few symbols; sums over the corners of a polygon stay unchanged."""
    return sympy.factor(expression) if len(expression.free_symbols) <= 4 else expression


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
    """Return a polygon with so many corners: sums over its edges, from its first corner."""
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
"""Shapes by the name of the numeric function."""
