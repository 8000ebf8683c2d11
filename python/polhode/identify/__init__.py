"""Identification: the body that fits measurements best, and what they do not tell of it.

:func:`from_tumble` takes a log of a gyro, :func:`from_pendulum` periods of pendulums, :func:`from_wrench` a
log of a force and torque sensor. :func:`design` and :func:`best_throw` say what a throw would tell.
Each result is an :class:`Identified`: a body with its covariance, how well it fits, whether it lies at the
edge of what is possible, and every direction that the data hardly determine. :func:`labellings` explains the
frequencies in the light curve of a tumbling body.
"""

from polhode.identify.labellings import Labellings, labellings
from polhode.identify.pendulum import Pendulum, bifilar, compound, from_pendulum, torsional, trifilar
from polhode.identify.results import Direction, Identified
from polhode.identify.tumble import best_throw, design, from_tumble
from polhode.identify.wrench import from_wrench

__all__ = [
    "Direction",
    "Identified",
    "Labellings",
    "Pendulum",
    "best_throw",
    "bifilar",
    "compound",
    "design",
    "from_pendulum",
    "from_tumble",
    "from_wrench",
    "labellings",
    "torsional",
    "trifilar",
]
