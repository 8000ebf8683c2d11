"""Make an ensemble. All arguments are checked before anything is run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from polhode import _core
from polhode._format import Argument
from polhode.distributions import Distribution, FunctionOfDraws, per_member
from polhode.ensembles.cluster import check_client
from polhode.ensembles.merge_tree import BLOCK
from polhode.ensembles.plan import VECTORS, Plan, draws, is_each_alone, resolve_draws
from polhode.ensembles.result import Ensemble
from polhode.ensembles.trial import choose_method, outputs_of, trial_of
from polhode.errors import PolhodeError
from polhode.reductions import Reduction

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from polhode._progress import Progress

__all__ = ["Ensemble", "ensemble"]


def ensemble(
    body: Any,
    t: ArrayLike,
    omega: Any,
    attitude: Any = None,
    load: Any = None,
    *,
    n: int,
    seed: int,
    chunk: int = 4096,
    position: Any = None,
    velocity: Any = None,
    about: Literal["center_of_mass", "com", "origin"] = "center_of_mass",
    method: str = "auto",
    rtol: float = 1e-10,
    atol: float | None = None,
    states: Mapping[str, Any] | None = None,
    max_steps: int | None = None,
    outputs: Sequence[str] | None = None,
    on_failure: Literal["keep", "raise"] = "keep",
    reduce: Reduction | Mapping[str, Reduction] | None = None,
    client: Any = None,
    progress: Progress = None,
) -> Ensemble:
    """Make an ensemble: many simulations of one motion, each with randomly drawn numbers.

    Every argument of :meth:`RigidBody.simulate` that describes the body, the load or the start may be a
    distribution of :mod:`polhode.distributions`, or a function of a random generator. The numbers of member k
    depend only on `seed`, on the name of the argument and on k.

    Parameters
    ----------
    body : RigidBody or distribution
    t : array_like, shape (T,)
        Output times, as of :meth:`RigidBody.simulate`.
    omega, attitude, position, velocity : array_like or distribution
        Values at the start, for each member.
    load : Load or distribution, optional
    n : int
        How many members.
    seed : int
        Seed of all draws, from 0 to 2**64 - 1.
    chunk : int, optional
        Number of members that are run, written or sent to a worker together. With `reduce` it must be a
        multiple of 4096.
    about, method, rtol, atol, states, max_steps
        As of :meth:`RigidBody.simulate`. If loads are drawn, the first members decide which method "auto"
        takes. A member that takes more than `max_steps` steps fails.
    outputs : sequence of str, optional
        States that are kept: ``"omega"``, ``"quaternion"``, ``"position"``, ``"velocity"`` and the names of
        the states of the load. By default the first two and the states of the load, and also position and
        velocity if one of these is given at the start.
    on_failure : {"keep", "raise"}, optional
        What happens if the numbers of a member make no body, or its integration fails. ``"keep"``: its
        ``status`` says so, and its states are NaN. ``"raise"``: an error ends the ensemble.
    reduce : Reduction or dict of str to Reduction, optional
        Statistics that are kept in place of the states, from :mod:`polhode.reductions`.
    client : distributed.Client, optional
        Client of a dask cluster that runs the chunks; by default the threads of this machine do.
    progress : bool or callable, optional
        A function that is called with the fraction done, or whether to show a progress bar. By default a bar
        appears on a terminal after two seconds.

    Returns
    -------
    Ensemble

    Examples
    --------
    >>> from polhode import RigidBody, distributions, ensemble
    >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    >>> spin = distributions.normal((0.0, 0.0, 1.0), sigma=0.1)
    >>> many = ensemble(body, [0, 10], spin, distributions.uniform_rotation(), n=1000, seed=1)
    >>> many
    Ensemble(1000 members, 2 times, seed=1, draws omega, attitude, 1 chunk of 1000, 1.03 MB a chunk)
    >>> many.compute().omega.shape
    (1000, 2, 3)
    """
    size, cut = _count(n, "n"), _count(chunk, "chunk")
    about = "center_of_mass" if about == "com" else about  # one recipe, one fingerprint
    if on_failure not in ("keep", "raise"):
        raise ValueError(f'on_failure: expected "keep" or "raise", got {on_failure!r}')
    given = {
        "body": body, "omega": omega, "attitude": attitude, "load": load, "position": position,
        "velocity": velocity,
    }  # fmt: skip
    if states is not None and not isinstance(states, Mapping):
        raise TypeError(f"states: expected a dict of names to numbers, got {type(states).__name__}")
    given |= {f"states.{name}": value for name, value in sorted((states or {}).items())}
    arguments = {place: _argument(place, value) for place, value in given.items()}
    times = _core.real_numbers(t, "t").copy()
    steps = {} if max_steps is None else {"max_steps": _count(max_steps, "max_steps")}
    # Times and tolerances that make no run are refused now, by one that costs nothing.
    _core.RigidBody.from_principal(1.0, (1.0, 1.0, 1.0)).simulate(times, (0, 0, 0), rtol=rtol, atol=atol)
    times.setflags(write=False)
    plan = Plan(
        recipe=resolve_draws(arguments, seed),
        t=times,
        options={"about": about, "method": method, "rtol": rtol, "atol": atol} | steps,
        n=size,
        seed=int(seed),
        chunk=min(cut, size),
        outputs={},
        raises=on_failure == "raise",
    )
    for place, draw in plan.draws().items():
        draw.distribution.check(size, place)
    if about == "origin" and method == "auto" and any(draws(plan.recipe["body"])):
        raise ValueError(
            'method: "auto" would choose by the bodies of a chunk, and bodies are drawn; with about="origin" '
            'name one: "exact" where all are symmetric tops under gravity, else "taylor" or "dop853"'
        )
    _check_reduce(reduce, plan)
    if client is not None:
        check_client(client)
    begun, trial = trial_of(plan)
    plan = replace(
        plan,
        outputs=outputs_of(plan, trial, outputs),
        options=plan.options | {"method": choose_method(plan, begun)},
    )
    kept = dict(reduce) if reduce is not None and not isinstance(reduce, Reduction) else reduce
    return Ensemble(plan, kept, client, progress)


def _count(number: Any, name: str) -> int:
    if isinstance(number, bool) or not isinstance(number, int | np.integer):
        raise TypeError(f"{name}: expected a positive integer, got {number!r}")
    if number <= 0:
        raise PolhodeError(Argument(name), f": expected a positive integer, got {number}")
    if number >= 2**62:
        raise PolhodeError(Argument(name), f": expected an integer below 2**62, got {number}")
    return int(number)


def _argument(place: str, value: Any) -> Any:
    """Return a distribution; an argument that is the same for all members as a read-only copy."""
    if isinstance(value, Distribution | FunctionOfDraws) or value is None:
        return value
    if place == "body" and isinstance(value, _core.RigidBody):
        return _one(value, place)
    if place == "load" and isinstance(value, _core.Load):
        return _one(value, place)
    if place in VECTORS and hasattr(value, "as_quat"):
        value = value.as_quat()
    if callable(value):
        return per_member(value)
    if place in ("body", "load"):
        kind = "RigidBody" if place == "body" else "Load"
        raise TypeError(
            f"{place}: expected a {kind}, a distribution, distributions.apply(...) or a function of a "
            f"generator, got {type(value).__name__}"
        )
    array = _core.real_numbers(value, place).copy()
    if array.ndim != 1 or array.shape != (VECTORS.get(place, array.size),):
        raise ValueError(
            f"{place}: expected {VECTORS.get(place, 'some')} numbers for all members, got shape "
            f"{array.shape}; a row for each goes in distributions.samples"
        )
    array.setflags(write=False)
    return array


def _one(value: Any, place: str) -> Any:
    if value.shape:
        raise ValueError(
            f"{place}: expected one for all members, got a stack of shape {value.shape}; "
            "distributions.apply makes one for each of what is drawn"
        )
    if isinstance(value, _core.RigidBody) and value.covariance is not None:
        raise ValueError(
            "body: carries a covariance, and an ensemble draws distributions alone; draw the body's numbers "
            "by distributions.apply(RigidBody, ...), or give the body without sigmas"
        )
    return value


def _check_reduce(reduce: Any, plan: Plan) -> None:
    if reduce is None:
        return
    if not isinstance(reduce, Reduction):
        if not isinstance(reduce, dict) or not reduce:
            what = "an empty dict" if reduce == {} else type(reduce).__name__
            raise TypeError(
                f"reduce: expected a reduction or a dict of them, got {what}; polhode.reductions has them"
            )
        for name, one in reduce.items():
            if not isinstance(one, Reduction):
                raise TypeError(f"reduce: {name!r} is no reduction but {type(one).__name__}")
    if plan.chunk % BLOCK and plan.chunks > 1:
        raise ValueError(
            f"chunk: with reduce= it must be a multiple of {BLOCK}, the blocks that are merged in a fixed "
            f"tree so that bits are the same for every chunk; got {plan.chunk}, and the next one is "
            f"{-(-plan.chunk // BLOCK) * BLOCK}"
        )
    if is_each_alone(plan):
        raise ValueError(
            "load: a function gives one load for each member, and members that are run one by one are not "
            "reduced; make loads of what is drawn by distributions.apply"
        )
