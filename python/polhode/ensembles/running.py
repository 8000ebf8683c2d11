"""Run members, a chunk at a time. Members that cannot start are left out and reported."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, TypeVar

import numpy as np

from polhode import _core
from polhode.ensembles.plan import is_each_alone, short_name
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from polhode.ensembles.plan import Inputs, Plan
    from polhode.motion.trajectory import Trajectory

    Floats = NDArray[np.float64]
    Rows = NDArray[np.intp]

__all__ = ["REFUSED", "Run", "arrays_of_chunk", "run_members"]

T = TypeVar("T")

REFUSED: Final = "refused"
"""The status of a member that has no motion: its numbers make no body, load or state."""
FAILED: Final = ("failed", REFUSED)


@dataclass(frozen=True, eq=False)
class Run:
    """Results of a run of some members."""

    inputs: Inputs
    rows: Rows
    """The members that were run."""
    trajectories: list[Trajectory]
    """One trajectory of all of them, or one for each."""
    faults: dict[int, str]
    """Errors of the other members, by their numbers in the ensemble."""

    @property
    def status(self) -> NDArray[np.str_]:
        """How each member ended."""
        found = np.full(self.inputs.count, REFUSED, dtype="U8")
        if self.trajectories:
            found[self.rows] = np.concatenate([np.atleast_1d(one.status) for one in self.trajectories])
        return found

    def array(self, name: str) -> Floats:
        """Return an array of the trajectories with a row for every member.

        Of those that were not run it has what they drew, at the start, and NaN.
        """
        parts = [output(trajectory, name) for trajectory in self.trajectories]
        if len(parts) == 1 and len(parts[0]) == self.inputs.count:
            return parts[0]
        plan = self.inputs.plan
        found = np.full((self.inputs.count, len(plan.t), plan.outputs[name]), np.nan)
        for row, start in self.inputs.starts("attitude" if name == "quaternion" else name):
            found[row, 0] = start
        if parts:
            found[self.rows] = np.concatenate(parts)
        return found


def output(trajectory: Trajectory, name: str) -> Floats:
    """Return an array of a trajectory, that of a state of the load as ``states.NAME``."""
    if name.startswith("states."):
        return trajectory.states[name.removeprefix("states.")]
    found: Floats = getattr(trajectory, name)
    return found


def run_members(plan: Plan, first: int, count: int, progress: Callable[[float], object] | None = None) -> Run:
    """Run members of an ensemble.

    Parameters
    ----------
    plan : Plan
    first, count : int
    progress : callable, optional
        Called with the fraction that is done.

    Returns
    -------
    Run

    Raises
    ------
    IntegrationError
        Where the plan says so, for the first member that fails.
    """
    inputs = plan.inputs(first, count)
    able, faults = find_runnable(inputs)
    rows, found = [], []
    size = 1 if is_each_alone(plan) else max(len(able), 1)
    for start in range(0, len(able), size):

        def tell(fraction: float, start: int = start) -> None:
            if progress is not None:
                progress((start + fraction * size) / len(able))

        def attempt(some: Rows, tell: Callable[[float], object] = tell) -> Trajectory:
            return inputs.run(some, plan.t, tell if progress is not None else None)

        ran, trajectory, refused = _each(able[start : start + size], attempt, is_run=True)
        faults |= refused
        if trajectory is not None:
            rows.append(ran)
            found.append(trajectory)
    taken = np.concatenate(rows) if rows else np.arange(0)
    run = Run(inputs, taken, found, {first + row: str(fault) for row, fault in sorted(faults.items())})
    if plan.raises:
        _raise_first(run, faults)
    return run


def select_rows(trajectory: Trajectory, rows: Rows) -> Trajectory:
    """Return the motions of some rows of a stack, with read-only arrays.

    Parameters
    ----------
    trajectory : Trajectory
    rows : numpy.ndarray of int

    Returns
    -------
    Trajectory
    """
    count = len(trajectory.omega)

    def part(value: Any, depth: int) -> Any:
        """Pick of what has a first axis for the members: so many axes, where it is an array."""
        if isinstance(value, np.ndarray) and value.ndim == depth:
            found = value[rows] if len(rows) < count else value.view()
            found.setflags(write=False)
            return found
        return value[rows] if isinstance(value, _core.RigidBody | _core.Load) and value.shape else value

    depths = {"omega": 3, "quaternion": 3, "position": 3, "velocity": 3, "about": 2}
    depths |= dict.fromkeys(("body", "load", "steps", "evaluations", "status"), 1)
    known = {name: part(getattr(trajectory, name), depth) for name, depth in depths.items()}
    known["states"] = {name: part(value, 3) for name, value in trajectory.states.items()}
    shared = ("t", "events", "pivoted", "uncertain_start")
    known |= {name: getattr(trajectory, name) for name in shared} | {"failures": ()}
    known["_origin"] = replace(trajectory._origin, motion=None, states=(), start=None)
    return type(trajectory)._of_run(known)


def find_runnable(inputs: Inputs) -> tuple[Rows, dict[int, PolhodeError]]:
    """Return the members with a valid body, load and state at the start, and the errors of the others."""
    size = 1 if is_each_alone(inputs.plan) else max(inputs.count, 1)
    every = np.arange(inputs.count)
    able: list[Rows] = [every[:0]]
    faults: dict[int, PolhodeError] = {}

    def is_made(some: Rows) -> None:
        inputs.make_arguments(some)

    for start in range(0, inputs.count, size):
        rows, _, refused = _each(every[start : start + size], is_made)
        able.append(rows)
        faults |= refused
    return np.concatenate(able), faults


def _each(
    rows: Rows, attempt: Callable[[Rows], T], *, is_run: bool = False
) -> tuple[Rows, T | None, dict[int, PolhodeError]]:
    """Run all members at once; if that is refused, run halves, down to the members that cause the error.

    Only refusals of values count: wrong types and shapes are mistakes of the whole call, and so is what a run
    refuses without naming a row.
    """
    try:
        return rows, attempt(rows), {}
    except PolhodeError as error:
        if is_run and error.stack_row is None:
            raise
        if len(rows) == 1:
            error.leave_row_out()
            return rows[:0], None, {int(rows[0]): error}
    half = len(rows) // 2
    able: Rows = rows[:0]
    faults: dict[int, PolhodeError] = {}
    for part in (rows[:half], rows[half:]):
        # What comes of a part is not kept: all that are able go together in the end.
        some, refused = _each(part, attempt, is_run=is_run)[::2]
        able = np.concatenate([able, some])
        faults |= refused
    return able, attempt(able) if len(able) else None, faults


def _raise_first(run: Run, faults: dict[int, PolhodeError]) -> None:
    """Raise what ended the first member that failed."""
    failed = np.flatnonzero(np.isin(run.status, FAILED))
    if not len(failed):
        return
    row = int(failed[0])
    member = run.inputs.first + row
    fault = faults[row] if row in faults else _failure(run, row)
    told = copy(fault)
    told.leave_row_out()
    told.args = (f"member {member}: ", *told.args)
    raise told


def _failure(run: Run, row: int) -> PolhodeError:
    """Return the failure of a member that was run."""
    place = int(np.flatnonzero(run.rows == row)[0])
    if len(run.trajectories) > 1:  # each of one member
        return run.trajectories[place].failures[0]
    failures = run.trajectories[0].failures
    return next(fault for fault in failures if getattr(fault, "row", 0) == place)


def arrays_of_chunk(
    plan: Plan, index: int, progress: Callable[[float], object] | None = None
) -> dict[str, NDArray[np.generic]]:
    """Run a chunk and return its arrays: states, drawn numbers, and the status at the end."""
    run = run_members(plan, *plan.bounds(index), progress)
    states = {short_name(name): run.array(name) for name in plan.outputs}
    drawn = {short_name(place): array for place, array in run.inputs.arrays().items()}
    return states | drawn | {"status": run.status}
