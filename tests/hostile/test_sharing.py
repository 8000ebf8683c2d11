"""Objects shared by threads and processes, and memory given back."""

from __future__ import annotations

import gc
import multiprocessing
import os
import sys
import threading
import warnings
import weakref
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from polhode import MassAccumulator, RigidBody, _core, loads, solids
from shared_objects import (
    BODIES,
    CALLED,
    HEAVY,
    LOAD,
    MOMENTS,
    ONE,
    RATES,
    REGION,
    RNG,
    digest,
    some_of_everything,
)

if TYPE_CHECKING:
    from collections.abc import Callable


def same(one: list[Any], other: list[Any]) -> bool:
    return all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


def test_eight_threads_share_objects() -> None:
    """All get the bits that one gets."""
    alone = some_of_everything()
    results: list[list[Any]] = []

    def work() -> None:
        results.append(some_of_everything())

    threads = [threading.Thread(target=work) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 8
    assert all(same(alone, result) for result in results)


def test_eight_threads_add_to_one_accumulator() -> None:
    """In any order: the sums are of numbered particles."""
    masses, positions = RNG.uniform(1.0, 2.0, 80_000), RNG.normal(size=(80_000, 3))
    alone = MassAccumulator()
    alone.add(masses, positions)
    shared = MassAccumulator()

    def add(first: int) -> None:
        for start in range(first, 80_000, 8 * 1000):
            part = slice(start, start + 1000)
            shared.add(masses[part], positions[part], start)

    threads = [threading.Thread(target=add, args=(1000 * k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert shared.count == 80_000
    assert shared.finish() == alone.finish()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
def test_a_fork_after_threads_goes_on() -> None:
    """No thread of ours outlives its call, so that a child lacks none."""
    here = digest()
    reader, writer = os.pipe()
    with warnings.catch_warnings():
        # Python warns where other threads run; those of ours do not.
        warnings.simplefilter("ignore", DeprecationWarning)
        child = os.fork()
    if child == 0:
        try:
            os.write(writer, b"same" if digest() == here else b"other")
        finally:
            os._exit(0)
    os.close(writer)
    with os.fdopen(reader, "rb") as told:
        assert told.read() == b"same"
    os.waitpid(child, 0)


def test_a_spawned_process_has_the_same_bits() -> None:
    context = multiprocessing.get_context("spawn")
    some_of_everything()
    with ProcessPoolExecutor(1, mp_context=context) as pool:
        assert pool.submit(digest).result() == digest()


class TestCollection:
    """Cycles through loads are found by the garbage collector."""

    @pytest.mark.parametrize("make", [loads.torque_callback, loads.callback])
    @pytest.mark.parametrize(
        "change",
        [
            lambda load: load,
            lambda load: -2.0 * load,
            lambda load: load + loads.damping(0.1),
            lambda load: loads.schedule(load, [(0.0, 1.0)]),
        ],
        ids=["itself", "scaled", "in a sum", "scheduled"],
    )
    def test_a_function_that_knows_its_load(
        self, make: Callable[[Any], Any], change: Callable[[Any], Any]
    ) -> None:
        class Controller:
            load: Any = None

            def __call__(self, *_: Any) -> tuple[float, float, float]:
                return (0.0, 0.0, 0.0)

        controller = Controller()
        controller.load = change(make(controller))
        gone = weakref.ref(controller)
        del controller
        gc.collect()
        assert gone() is None

    def test_a_closure_that_knows_its_load(self) -> None:
        def cycle() -> weakref.ref[Any]:
            class Witness:
                pass

            witness = Witness()

            def torque(*_: Any) -> tuple[float, float, float]:
                return (0.0, 0.0, 0.0) if load and witness else (1.0, 0.0, 0.0)

            load = loads.torque_callback(torque)
            assert ONE.simulate([0.0, 0.1], RATES[0], load=load).status == "complete"
            return weakref.ref(witness)

        gone = cycle()
        gc.collect()
        assert gone() is None

    def test_the_owner_of_a_compiled_function(self) -> None:
        class Owner:
            address = id(None)  # never called
            load: Any = None

        owner = Owner()
        owner.load = loads.compiled(owner)
        gone = weakref.ref(owner)
        del owner
        gc.collect()
        assert gone() is None

    def test_loads_in_use_stay(self) -> None:
        load = loads.torque_callback(lambda *_: (0.0, 0.0, 0.1))
        gc.collect()
        assert np.array_equal(load.torque(0.0, RATES[0], (0.0, 0.0, 0.0, 1.0)), [0.0, 0.0, 0.1])
        assert gc.is_tracked(load)


SMALL = np.diag([1.0, 1.2, 1.5])


def refused() -> None:
    with pytest.raises(ValueError, match="mass"):
        RigidBody(-1.0, SMALL)


STICK = solids.box((1.0, 2.0, 3.0), mass=1.0)
CALLS: dict[str, Callable[[], object]] = {
    "body": lambda: RigidBody(1.0, SMALL).principal_moments,
    "stack": lambda: (BODIES[:40] + BODIES[40:80]).inertia,
    "lists": lambda: RigidBody.from_particles([1.0, 2.0], [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]).provenance,
    "errors": lambda: refused(),
    "free motion": lambda: ONE.free_motion((1.0, 0.1, 1.0)).at([0.0, 1.0]),
    "heavy top": lambda: HEAVY.at([0.0, 1.0]).omega,
    "taylor": lambda: ONE.simulate([0.0, 0.1], (1.0, 0.1, 1.0), load=LOAD).events,
    "callback": lambda: ONE.simulate([0.0, 0.1], (1.0, 0.1, 1.0), load=CALLED).steps,
    "loads": lambda: repr(-1.0 * loads.schedule(LOAD, [(0.0, 1.0)]) + CALLED),
    "density": lambda: RigidBody.from_density(lambda r: r[:, 0] * 0 + 1.0, REGION, rtol=1e-3),
    "words": lambda: _core.classify_tops(MOMENTS[:5], 1e-6),
    "hash": lambda: hash(BODIES[:5]) == hash(STICK),
}


def leak(name: str, count: int) -> float:
    """Give the bytes that a call leaves behind, by the memory of the process: the least of three slopes."""
    call = CALLS[name]

    def resident() -> int:
        gc.collect()
        told = Path("/proc/self/statm").read_text(encoding="ascii")
        return int(told.split()[1]) * os.sysconf("SC_PAGE_SIZE")

    for _ in range(max(20, count // 10)):
        call()
    gc.collect()
    gc.freeze()  # what other tests left takes seconds to look through, and is not what grows here
    slopes = []
    for _ in range(3):
        before = resident()
        for _ in range(count):
            call()
        slopes.append((resident() - before) / count)
    return min(slopes)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux tells the memory so cheaply")
@pytest.mark.parametrize("name", CALLS)
def test_calls_leave_nothing_behind(name: str) -> None:
    """Less than a page for each: what 1e5 calls leave is tested at length."""
    assert leak(name, 20 if name == "density" else 300) < 4000.0


@pytest.mark.long
@pytest.mark.timeout(7200)
@pytest.mark.parametrize("name", CALLS)
def test_very_many_calls_leave_nothing_behind(name: str) -> None:
    """1e5 calls, of the density that takes milliseconds 3e3."""
    assert leak(name, 1000 if name == "density" else 33_334) < 16.0
