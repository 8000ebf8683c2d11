"""Uncertainty beyond a body's own sigma: of any function of a body, and of a whole tree of parts."""

from polhode.uncertainty.propagation import Propagated, propagate
from polhode.uncertainty.ufloats import from_ufloats, to_ufloats

__all__ = ["Propagated", "from_ufloats", "propagate", "to_ufloats"]
