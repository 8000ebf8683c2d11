"""Shapes of uniform density: their tensors in letters."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

from polhode.symbolic import table
from polhode.symbolic.functions import function
from polhode.symbolic.laws import parallel_axis
from polhode.symbolic.symbols import symbols, sympy

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

__all__ = ["Shape", "names", "shape"]


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
        """Tensor about a point.

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
        """Give the tensor as a numeric function of arrays; it takes values of `arguments`."""
        return function(self.inertia, self.arguments)

    def latex(self) -> str:
        r"""Give measure and moments in LaTeX.

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
        """Which two axes have a product of inertia."""
        return next((pair for pair in ((0, 1), (0, 2), (1, 2)) if self.inertia[pair] != 0), None)


def names() -> tuple[str, ...]:
    """Give the names of the shapes: all of `solids`, `laminae` and `rods`."""
    return tuple(table.SHAPES)


def shape(name: str, *, corners: int | None = None) -> Shape:
    """Give the formulas of a shape by its name.

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
    if name not in table.SHAPES:
        near = get_close_matches(str(name), table.SHAPES, 1)
        way_out = f"did you mean {near[0]}?" if near else f"there are {', '.join(table.SHAPES)}"
        raise ValueError(f"name: {name!r} is no shape; {way_out}")
    if (name == "polygon") != (corners is not None):
        raise ValueError(
            "corners: a polygon, and nothing else, needs their number: shape('polygon', corners=5)"
        )
    row = table.SHAPES[name] if corners is None else table.polygon(corners)
    second = row.second_moment
    tensor = (symbols.mass * (sympy.trace(second) * sympy.eye(3) - second)).applyfunc(_tidy)
    return Shape(name, row.room, row.sizes, row.measure, row.center, tensor)


def _tidy(expression: Any) -> Any:
    """Factor it where it has few letters: sums over the corners of a polygon stay as they are."""
    return sympy.factor(expression) if len(expression.free_symbols) <= 4 else expression
