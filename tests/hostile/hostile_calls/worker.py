"""Hostile calls, each a function of a seed and its number alone, in a process that may die of them.

``python -m hostile_calls.worker SEED FROM TO [PROGRESS]`` makes the calls and prints one line of JSON for
each that went wrong; the search path is that of the tests, `places.IMPORTED`. The number of the call under
way stands in the file PROGRESS, so that whoever waits knows which one hung or killed the process.
``python -m hostile_calls.worker SEED NUMBER`` makes one call and tells what it was.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import struct
import sys
import time
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from . import spoilt, valid, verdict

ROOM = 4 << 30
"""Bytes of address space for a worker: what asks for more gets a MemoryError."""
LONGEST, SLACK = 1.0, 2.0
"""Seconds that a call may last, and those it may take to hear that it is over, on a busy machine."""
MAY_BE_UNKNOWN = frozenset({
    "HeavyTop", "RigidBody.heavy_top", "ray_kappa", "molecules.ray_kappa", "molecules.rotational_constants",
    "molecules.rotational_constants_sigma",
    "PrincipalAxes.kappa",
    "steady_precession", "validity.nearest_valid", "nearest_valid", "free_precession",
    "FreeMotion.sensitivity",
    "FreeMotion.error_bar", "FreeMotion.poinsot", "FreeMotion.herpolhode", "Trajectory.sensitivity",
    "motion_sensitivity", "principal_gaps",
    "Trajectory.invariants", "RigidBody.stability", "molecules.isotopes",
    "oblate_states",
})  # fmt: skip
"""Whose results say NaN where a quantity is not defined, as their docstrings tell."""


def spoil(value: Any, rng: np.random.Generator) -> tuple[str, Any]:
    """Something instead of the value, and in one word what was done."""
    if isinstance(value, str) and rng.integers(4):
        return "words", spoilt.words(value, rng)
    if not spoilt.is_numeric(value) or not rng.integers(6):
        return "object", spoilt.objects(rng)
    match rng.integers(8):
        case 0 | 1:
            found = spoilt.forms(value)
            name = list(found)[rng.integers(len(found))]
            return f"form:{name}", found[name]()
        case 2 | 3:
            return "shape", spoilt.shapes(value, rng)
        case 4:
            return "type", spoilt.types(value, rng)
        case _:
            return "numbers", spoilt.numbers(value, rng)


class Made:
    """One hostile call."""

    def __init__(self, calls: list[valid.Call], seed: int, number: int) -> None:
        rng = np.random.default_rng([seed, number])
        self.call = calls[rng.integers(len(calls))]
        call = self.call
        self.receiver = call.receivers[rng.integers(len(call.receivers))] if call.receivers else None
        self.done: dict[str, str] = {}
        arguments = dict(call.arguments)
        for name in call.optional:
            if rng.integers(3) == 0:
                arguments.pop(name, None)
        self.plain = dict(arguments)
        names = list(arguments)
        for name in rng.permutation(names)[: rng.integers(1, 3)] if names else ():
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of making the argument, not of the call
                self.done[str(name)], arguments[str(name)] = spoil(arguments[str(name)], rng)
        self.extra: tuple[Any, ...] = ()
        match rng.integers(60):
            case 0:
                arguments["no_such_argument"] = 1.0
                self.done["no_such_argument"] = "extra"
            case 1 if names:
                arguments.pop(names[0], None)
                self.done[names[0]] = "missing"
            case 2:
                self.extra = tuple(1.0 for _ in range(12))
                self.done["extra"] = "positional"
        self.arguments = arguments

    def make(self, arguments: dict[str, Any]) -> Any:
        """Make the call."""
        keywords = dict(arguments)
        first = () if self.receiver is None else (self.receiver,)
        placed = tuple(keywords.pop(name) for name in list(keywords) if name in self.call.positional)
        return self.call.function(*first, *placed, *self.extra, **keywords)

    def __str__(self) -> str:
        shown = {name: repr(value)[:200] for name, value in self.arguments.items()}
        return f"{self.call.name} on {self.receiver!r:.60} with {shown}; {self.done}"


def judge(made: Made) -> str:
    """Make the call and say what came of it; raise Wrong, or whatever it raised that it must not."""
    before = [(array, array.tobytes()) for array in verdict.arrays(list(made.arguments.values()))]
    try:
        result = made.make(made.arguments)
    except Warning as told:
        if not str(told).startswith(verdict.TOLD_BY_NUMPY):
            raise
        outcome, result = "warned", None
    except verdict.ERRORS as error:
        if not isinstance(error, spoilt.Planned | MemoryError) and not str(error):
            raise verdict.Wrong("an error without a word") from error
        if isinstance(error, UnicodeError):
            raise verdict.Wrong("an error of the encoding, not of the argument") from error
        outcome = type(error).__name__
        result = None
    else:
        outcome = "value"
        verdict.obeys(result)
    for array, held in before:
        if array.tobytes() != held:
            raise verdict.Wrong("an argument was changed")
    if set(made.done.values()) and all(how.startswith("form:") for how in made.done.values()):
        try:
            plain = verdict.fingerprint(made.make(made.plain))
        except verdict.ERRORS as error:
            plain = type(error).__name__
        mine = verdict.fingerprint(result) if outcome == "value" else outcome
        if plain != mine:
            raise verdict.Wrong(f"another result for the same numbers in another form: {outcome}")
    if outcome == "value" and made.call.name not in MAY_BE_UNKNOWN and verdict.unknown(result):
        given = [verdict.finite_floats(value) for value in made.arguments.values()]
        words = {value for value in made.arguments.values() if isinstance(value, str)}
        if False not in given and not words & {"nan", "keep"} and "object" not in made.done.values():
            raise verdict.Wrong("NaN from finite numbers")
    return outcome


class TooLong(Exception):  # noqa: N818 - Ctrl-C, as it were
    """A call has lasted long enough."""


def interrupt(*_: object) -> None:
    """End the call under way, as Ctrl-C would."""
    raise TooLong


def limited(made: Made) -> str:
    """Judge the call, and interrupt it after a second: work may last, but not without a way out."""
    signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, LONGEST)
    start = time.monotonic()
    try:
        return judge(made)
    except TooLong:
        lasted = time.monotonic() - start
        if lasted > LONGEST + SLACK:
            raise verdict.Wrong(f"deaf to an interrupt for {lasted - LONGEST:.1f} s") from None
        return "interrupted"
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)


def _recorded(unraised: list[str]) -> Callable[[Any], None]:
    return lambda hook: unraised.append(f"unraisable {hook.exc_value!r}")


def run(seed: int, numbers: range, progress: str | None = None) -> dict[str, int]:
    """Make the calls; print what went wrong."""
    calls = valid.all_calls()
    counts: dict[str, int] = {}
    unraised: list[str] = []
    sys.unraisablehook = _recorded(unraised)
    file = os.open(progress, os.O_WRONLY) if progress else None
    warnings.simplefilter("error")
    for number in numbers:
        if file is not None:
            os.pwrite(file, struct.pack("<q", number), 0)
        made = Made(calls, seed, number)
        try:
            outcome = limited(made)
        except (Exception, BaseExceptionGroup) as error:
            outcome = _told(seed, number, made, error)
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt | SystemExit):
                raise
            outcome = _told(seed, number, made, error)
        if unraised:
            outcome = _told(seed, number, made, RuntimeError(unraised.pop()))
            unraised.clear()
        counts[outcome] = counts.get(outcome, 0) + 1
    return counts


def _told(seed: int, number: int, made: Made, error: BaseException) -> str:
    told = {
        "seed": seed,
        "number": number,
        "error": f"{type(error).__name__}: {error}"[:400],
        "call": str(made),
    }
    print(json.dumps(told), flush=True)
    return "wrong"


def main() -> None:
    """Run from the command line."""
    resource.setrlimit(resource.RLIMIT_AS, (ROOM, ROOM))
    seed, first, *rest = (int(word) for word in sys.argv[1:4])
    if not rest:
        made = Made(valid.all_calls(), seed, first)
        print(made, flush=True)
        print(judge(made))
        return
    counts = run(seed, range(first, rest[0]), sys.argv[4] if len(sys.argv) > 4 else None)
    print(json.dumps({"counts": counts}), flush=True)


if __name__ == "__main__":
    main()
