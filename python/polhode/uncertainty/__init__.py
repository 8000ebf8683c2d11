"""Uncertainty beyond a body's own sigma: of any function of a body, and of a whole tree of parts."""

from polhode.uncertainty.ledger import Ledger, Part, Shares, Sigmas, ledger
from polhode.uncertainty.propagation import Propagated, propagate
from polhode.uncertainty.ufloats import TenNumbers, from_ufloats, to_ufloats

__all__ = [
    "Ledger",
    "Part",
    "Propagated",
    "Shares",
    "Sigmas",
    "TenNumbers",
    "from_ufloats",
    "ledger",
    "propagate",
    "to_ufloats",
]
