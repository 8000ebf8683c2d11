"""Functions of Python that call the package again without end: an error that says so, on any stack."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from polhode import RigidBody, loads, regions

if TYPE_CHECKING:
    from collections.abc import Callable

BODY = RigidBody.from_principal(1.0, (1.0, 1.2, 1.5))
STACK = RigidBody.from_principal(np.ones(2000), (1.0, 1.2, 1.5))
TIMES, SPIN = [0.0, 1.0], (1.0, 0.1, 1.0)
DRAG = loads.damping(0.1)


def callback(method: Any) -> Callable[[], object]:
    def torque(*_: Any) -> tuple[float, float, float]:
        again()
        return (0.0, 0.0, 0.0)

    load = loads.torque_callback(torque)

    def again() -> object:
        return BODY.simulate(TIMES, SPIN, load=load, method=method)

    return again


def evaluated() -> Any:
    load = loads.torque_callback(lambda *_: evaluated())
    return load.torque(0.0, SPIN, (0.0, 0.0, 0.0, 1.0))


def event(*_: Any) -> float:
    BODY.simulate(TIMES, SPIN, events=event, load=DRAG)
    return 1.0


def progress(_: float) -> object:
    return STACK.simulate(TIMES, SPIN, progress=progress, load=DRAG, method="dop853")


def density(points: Any) -> Any:
    RigidBody.from_density(density, regions.ball(1.0))
    return points[:, 0]


def radial(radii: Any) -> Any:
    RigidBody.from_radial_density(radial, 1.0)
    return radii


class Array:
    """An argument that makes a body of itself on its way to an array."""

    def __array__(self, *_: Any, **__: Any) -> Any:
        return RigidBody(self, np.eye(3)).inertia


class Rotation:
    """A rotation that turns a body by itself."""

    def as_quat(self) -> Any:
        return BODY.rotated(self)


CALLS: dict[str, Callable[[], object]] = {
    "callback of dop853": callback("dop853"),
    "callback of radau": callback("radau"),
    "torque asked for": evaluated,
    "event": lambda: event(),
    "progress": lambda: progress(0.0),
    "density": lambda: RigidBody.from_density(density, regions.ball(1.0)),
    "radial density": lambda: RigidBody.from_radial_density(radial, 1.0),
    "array": lambda: RigidBody(Array(), np.eye(3)),
    "array in a list": lambda: RigidBody([Array()], np.eye(3)),
    "rotation": lambda: BODY.rotated(Rotation()),
}


@pytest.mark.parametrize("name", CALLS)
def test_calls_within_calls_end(name: str) -> None:
    with pytest.raises(RecursionError, match=r"8 (runs are under way within each other|times so far)"):
        CALLS[name]()


@pytest.mark.parametrize("name", CALLS)
def test_a_small_stack_suffices(name: str) -> None:
    """256 kB: less than any system gives a thread unasked. A stack that overflows would end this process."""
    told: list[str] = []

    def go() -> None:
        try:
            CALLS[name]()
        except RecursionError as error:
            told.append(str(error))

    before = threading.stack_size(256 * 1024)
    try:
        thread = threading.Thread(target=go)
        thread.start()
        thread.join()
    finally:
        threading.stack_size(before)
    assert told


def test_the_depth_is_of_what_is_under_way() -> None:
    """Neither errors nor many calls one after the other use it up; a few within each other are allowed."""
    depth: list[int] = []

    def nested(levels: int) -> None:
        def torque(*_: Any) -> tuple[float, float, float]:
            if len(depth) < levels:
                depth.append(levels)
                nested(levels)
            return (0.0, 0.0, 0.0)

        BODY.simulate([0.0, 0.1], SPIN, load=loads.torque_callback(torque))

    nested(7)
    assert len(depth) == 7
    for _ in range(20):
        with pytest.raises(RecursionError):
            CALLS["callback of dop853"]()
        with pytest.raises(RecursionError):
            CALLS["array"]()
    assert (
        BODY.simulate(TIMES, SPIN, load=loads.torque_callback(lambda *_: (0.0, 0.0, 0.0))).status
        == "complete"
    )


def test_loads_made_of_very_many_steps() -> None:
    """No function calls itself for each of them."""
    load = loads.constant_torque((0.0, 0.0, 1.0))
    for _ in range(5000):
        load = -load
    assert repr(load).count("-1.0 * ") == 5000
    reduced: Any = load.__reduce__()
    restore, parts = reduced
    assert np.array_equal(restore(*parts).torque(0.0, SPIN, (0.0, 0.0, 0.0, 1.0)), np.array([0.0, 0.0, 1.0]))
    timed = loads.schedule(2.0 * loads.schedule(load, [(0.0, 1.0)]), [(0.0, 0.5)])
    assert repr(timed).startswith("<Load: schedule(2.0 * schedule(-1.0 * ")
