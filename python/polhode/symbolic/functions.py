"""From expressions to functions of arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from polhode.symbolic.symbols import sympy

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import ArrayLike, NDArray

__all__ = ["function"]


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
