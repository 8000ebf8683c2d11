"""A trial start of the first members of an ensemble, so that an error of all members is raised at once."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from polhode.ensembles.plan import draws, is_each_alone
from polhode.ensembles.running import find_runnable, output
from polhode.errors import IntegrationError, PolhodeError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from polhode.ensembles.plan import Plan
    from polhode.motion.trajectory import Trajectory

    Floats = NDArray[np.float64]
    Rows = NDArray[np.intp]

__all__ = ["choose_method", "outputs_of", "trial_of"]

_PROBED: Final = 16
"""If this many members cannot start, the call is wrong, and not only their random numbers."""
_STATES: Final = ("omega", "quaternion", "position", "velocity")
_CHOSEN: Final = ("exact", "taylor")
"""The methods of which "auto" takes the first that can serve; the next can always."""


def trial_of(plan: Plan) -> tuple[Rows, Trajectory]:
    """Start the first members.

    Parameters
    ----------
    plan : Plan

    Returns
    -------
    tuple of numpy.ndarray and Trajectory
        Those that can begin, and the start of the first of these.

    Raises
    ------
    PolhodeError
        Where none can.
    """
    inputs = plan.inputs(0, min(plan.n, _PROBED))
    able, faults = find_runnable(inputs)
    begun, first = [], None
    for row in able.tolist():
        try:
            trial = inputs.run(np.array([row]), _beginning(plan.t))
        except PolhodeError as error:
            faults[row] = error
            continue
        if trial.failures and not isinstance(trial.failures[0], IntegrationError):
            faults[row] = trial.failures[0]
            continue
        begun.append(row)
        if first is None:
            first = trial
    if first is None:
        row, fault = min(faults.items())
        fault.leave_row_out()
        begin = f"none of the first {inputs.count} members can begin; member {row}: "
        raise type(fault)(begin, *fault.args)
    return np.array(begun), first


def _beginning(t: Floats) -> Floats:
    """Return the start and a time soon after: enough for all checks of a run."""
    return t if len(t) == 1 else np.array([t[0], t[0] + 1e-6 * (t[1] - t[0])])


def choose_method(plan: Plan, begun: Rows) -> str:
    """Return the method of all members, where "auto" would choose by the loads of a chunk.

    Parameters
    ----------
    plan : Plan
    begun : numpy.ndarray of int
        Members that can begin.

    Returns
    -------
    str
    """
    method: str = plan.options["method"]
    if method != "auto" or is_each_alone(plan) or not any(draws(plan.recipe["load"])):
        return method
    for tried in _CHOSEN:
        trial = replace(plan, options=plan.options | {"method": tried})
        try:
            trial.inputs(0, min(plan.n, _PROBED)).run(begun, plan.t[:1])
        except PolhodeError:
            continue
        return tried
    return "dop853"


def _check_names(plan: Plan, own: Mapping[str, str]) -> None:
    """Refuse states of the load whose names mean something else in the results, or nothing in a file."""
    taken = {"member", "time", "axis", "quaternion_component", "status", *_STATES}
    taken |= {place for place in plan.draws() if not place.startswith("states.")}
    for name in own:
        if name in taken or "/" in name or name in (".", ".."):
            raise ValueError(
                f"load: a state has the name {name!r}, which means something else in the results; give it "
                "another one by name="
            )


def outputs_of(plan: Plan, trial: Trajectory, outputs: Sequence[str] | None) -> dict[str, int]:
    """Return the names of the states that are kept, with their components.

    Parameters
    ----------
    plan : Plan
    trial : Trajectory
        Of one member.
    outputs : sequence of str or None
        Those that were asked for.

    Returns
    -------
    dict of str to int
    """
    own = {name: f"states.{name}" for name in trial.states}
    _check_names(plan, own)
    known = {place: output(trial, place).shape[-1] for place in (*_STATES, *own.values())}
    if outputs is None:
        moves = plan.recipe["position"] is not None or plan.recipe["velocity"] is not None
        names = [*(_STATES if moves else _STATES[:2]), *own.values()]
        return {name: known[name] for name in names}
    if isinstance(outputs, str):
        raise TypeError(f"outputs: expected a sequence of names, got the word {outputs!r}")
    for name in outputs:
        if name not in _STATES and name not in own:
            words = ", ".join(map(repr, (*_STATES, *own)))
            raise ValueError(f"outputs: {name!r} is not one of {words}")
    names = [own.get(name, name) for name in outputs]
    return {name: known[name] for name in names}
