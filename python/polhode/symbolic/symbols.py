"""The letters of the formulas, and functions of arrays made from expressions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode._optional import require

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Symbols",
    "function",
    "positive",
    "real",
    "symbols",
    "sympy",
]

sympy: Final[Any] = require("sympy", extra="symbolic", purpose="polhode.symbolic")


def positive(names: str) -> Any:
    """Return symbols of positive numbers."""
    return sympy.symbols(names, positive=True)


def real(names: str) -> Any:
    """Return symbols of real numbers."""
    return sympy.symbols(names, real=True)


class Symbols(NamedTuple):
    """The symbols that the theorems use by default: ``polhode.symbolic.symbols`` is the object.

    Attributes
    ----------
    mass : Symbol
        M.
    moments : tuple of Symbol
        I1, I2, I3: principal moments.
    tensor : Matrix, shape (3, 3)
        Symmetric, with the elements Ixx … Iyz.
    center : Matrix, shape (3, 1)
        c, from the reference point to the centre of mass.
    displacement : Matrix, shape (3, 1)
        d, from the centre of mass to a point.
    omega, angular_acceleration, torque : Matrix, shape (3, 1)
        ω, its derivative and N, components in the body.
    velocity, position : Matrix, shape (3, 1)
        Velocity and position of the reference point, components in the body.
    angles, rates : tuple of Symbol
        φ, θ, ψ and their derivatives.
    axial, transverse, gravity, arm : Symbol
        Symbols of a top: I_s along its axis and I_t across it, both about the pivot, g, and l from the pivot
        to the centre of mass.
    vertical_momentum, axial_momentum : Symbol
        L_z about the upward vertical and L_s about the axis.
    """

    mass: Any
    moments: Any
    tensor: Any
    center: Any
    displacement: Any
    omega: Any
    angular_acceleration: Any
    torque: Any
    velocity: Any
    position: Any
    angles: Any
    rates: Any
    axial: Any
    transverse: Any
    gravity: Any
    arm: Any
    vertical_momentum: Any
    axial_momentum: Any


def _vector(names: str) -> Any:
    return sympy.Matrix(real(names))


_XX, _YY, _ZZ, _XY, _XZ, _YZ = real("I_xx I_yy I_zz I_xy I_xz I_yz")
symbols: Final = Symbols(
    mass=positive("M"),
    moments=positive("I_1:4"),
    tensor=sympy.Matrix([[_XX, _XY, _XZ], [_XY, _YY, _YZ], [_XZ, _YZ, _ZZ]]),
    center=_vector("c_x c_y c_z"),
    displacement=_vector("d_x d_y d_z"),
    omega=_vector("omega_1:4"),
    angular_acceleration=_vector(r"\dot{\omega}_1 \dot{\omega}_2 \dot{\omega}_3"),
    torque=_vector("N_1:4"),
    velocity=_vector("v_x v_y v_z"),
    position=_vector("X Y Z"),
    angles=real("varphi theta psi"),
    rates=real(r"\dot{\varphi} \dot{\theta} \dot{\psi}"),
    axial=positive("I_s"),
    transverse=positive("I_t"),
    gravity=positive("g"),
    arm=positive("l"),
    vertical_momentum=real("L_z"),
    axial_momentum=real("L_s"),
)
"""The symbols of the theorems."""


def function(expression: Any, arguments: Iterable[Any]) -> Callable[..., NDArray[np.float64]]:
    """Turn an expression, a vector or a matrix into a numeric function of arrays.

    Parameters
    ----------
    expression : sympy.Expr or sympy.Matrix
    arguments : iterable of sympy.Symbol
        Symbols in the order in which the function takes their values. They must include every symbol of the
        expression.

    Returns
    -------
    callable
        Function of array_like values that broadcast to a shape (...). It returns an array of shape (...) for
        an expression, (..., 3) for a vector and (..., 3, 3) for a matrix.

    Examples
    --------
    >>> from polhode import symbolic
    >>> cone = symbolic.shape("cone")
    >>> tensor = symbolic.function(cone.inertia, cone.arguments)
    >>> tensor(2.0, 1.0, [2.0, 4.0]).diagonal(axis1=1, axis2=2)
    array([[0.6, 0.6, 0.6],
           [1.5, 1.5, 0.6]])
    """
    if not hasattr(expression, "free_symbols"):
        raise TypeError(
            f"expression: expected an expression or a matrix of SymPy, got {type(expression).__name__}; "
            "sympy.sympify makes one"
        )
    given = list(arguments)
    is_matrix = hasattr(expression, "shape")
    unknown = expression.free_symbols - set(given)
    if unknown:
        names = ", ".join(sorted(map(str, unknown)))
        raise ValueError(
            f"arguments: the expression also holds {names}; name them, or put numbers in their place"
        )
    elements = list(expression) if is_matrix else [expression]
    made = sympy.lambdify(given, elements, modules="numpy", cse=True)
    shape = [side for side in expression.shape if side > 1] if is_matrix else []

    def evaluate(*values: ArrayLike) -> NDArray[np.float64]:
        if len(values) != len(given):
            raise TypeError(f"it takes {len(given)} values ({', '.join(map(str, given))}), got {len(values)}")
        numbers = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in values))
        outer = numbers[0].shape if numbers else ()
        found = [np.broadcast_to(element, outer) for element in made(*numbers)]
        stacked: NDArray[np.float64] = np.stack(found, axis=-1).astype(float)
        return stacked.reshape(*outer, *shape)

    return evaluate
