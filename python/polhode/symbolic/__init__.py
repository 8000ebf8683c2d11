"""Formulas instead of numbers, as expressions of SymPy (extra ``symbolic``).

Shapes with their tensors, moments and axes by :func:`shape`; the theorems as functions; :func:`function`
makes of any expression a function of arrays, whose numbers are those of the numeric core.
"""

from __future__ import annotations

from polhode.symbolic.functions import function
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
from polhode.symbolic.symbols import Symbols, symbols

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
