"""Uncertainty of any function of a body, probabilities of axes and modes, and ledgers of parts.

`RigidBody.sigma` gives the standard deviations of a body itself.
"""

from polhode.uncertainty.joined import joined
from polhode.uncertainty.ledger import Ledger, Part, Shares, Sigmas, ledger
from polhode.uncertainty.motions import PeriodsLinear, PeriodsSigma
from polhode.uncertainty.probabilities import (
    AxisProbabilities,
    ModeProbabilities,
    axis_probabilities,
    mode_probabilities,
)
from polhode.uncertainty.propagation import Propagated, propagate
from polhode.uncertainty.ufloats import TenNumbers, to_ufloats

__all__ = [
    "AxisProbabilities",
    "Ledger",
    "ModeProbabilities",
    "Part",
    "PeriodsLinear",
    "PeriodsSigma",
    "Propagated",
    "Shares",
    "Sigmas",
    "TenNumbers",
    "axis_probabilities",
    "joined",
    "ledger",
    "mode_probabilities",
    "propagate",
    "to_ufloats",
]
