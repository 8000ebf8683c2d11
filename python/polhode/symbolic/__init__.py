"""Formulas instead of numbers, as expressions of SymPy (extra ``symbolic``).

:func:`shape` gives tensor, moments and axes of a shape. The theorems of rigid-body mechanics are functions of
this module. :func:`function` turns an expression into a numeric function of arrays.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from polhode.symbolic.laws import (
    angular_acceleration,
    angular_momentum,
    angular_velocity,
    effective_potential,
    euler_rates,
    kinetic_energy,
    parallel_axis,
    particles,
    rotation,
    torque,
)
from polhode.symbolic.shapes import Shape, names, shape
from polhode.symbolic.symbols import Symbols, function, symbols

__all__ = [
    "Shape",
    "Symbols",
    "angular_acceleration",
    "angular_momentum",
    "angular_velocity",
    "effective_potential",
    "euler_rates",
    "function",
    "kinetic_energy",
    "names",
    "parallel_axis",
    "particles",
    "rotation",
    "shape",
    "symbols",
    "torque",
]

if not TYPE_CHECKING:

    def __getattr__(name):
        """Refuse a name of others with the one here."""
        from polhode._hints import no_name

        raise no_name(__name__, name, __all__)
