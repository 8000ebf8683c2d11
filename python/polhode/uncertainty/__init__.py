"""Uncertainty of any function of a body, probabilities of axes and modes, and ledgers of parts.

The standard deviations of a body itself, its moments and axes, are `RigidBody.sigma` and
`PrincipalAxes.sigma`: the compiled core computes them (``rust/core/src/uncertainty/sigma.rs``).
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from polhode.uncertainty.ledgers import Ledger, Part, Shares, Sigmas, ledger
    from polhode.uncertainty.motion import PeriodsLinear, PeriodsSigma
    from polhode.uncertainty.probabilities import (
        AxisProbabilities,
        ModeProbabilities,
        axis_probabilities,
        mode_probabilities,
    )
    from polhode.uncertainty.propagation import PropagationResult, propagate
    from polhode.uncertainty.uncertain import InertialParameters, join, to_ufloats
else:

    def __getattr__(name):
        """Import a name when it is first used: the rooms below import single files of this one."""
        from importlib import import_module

        home = _HOMES.get(name)
        if home is None:
            raise import_module("polhode._hints").no_name(__name__, name, __all__)
        value = globals()[name] = getattr(import_module(f"{__name__}.{home}"), name)
        return value

    def __dir__():
        return __all__


_HOMES = {
    **dict.fromkeys(("Ledger", "Part", "Shares", "Sigmas", "ledger"), "ledgers"),
    **dict.fromkeys(("PeriodsLinear", "PeriodsSigma"), "motion"),
    **dict.fromkeys(
        ("AxisProbabilities", "ModeProbabilities", "axis_probabilities", "mode_probabilities"),
        "probabilities",
    ),
    **dict.fromkeys(("PropagationResult", "propagate"), "propagation"),
    **dict.fromkeys(("InertialParameters", "join", "to_ufloats"), "uncertain"),
}
"""The file of this room in which each public name stands."""

__all__ = [
    "AxisProbabilities",
    "InertialParameters",
    "Ledger",
    "ModeProbabilities",
    "Part",
    "PeriodsLinear",
    "PeriodsSigma",
    "PropagationResult",
    "Shares",
    "Sigmas",
    "axis_probabilities",
    "join",
    "ledger",
    "mode_probabilities",
    "propagate",
    "to_ufloats",
]
