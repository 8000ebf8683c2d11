"""How soon Ctrl-C ends a call, in processor time, so that a busy machine does not count.

Each call is struck by a signal after some time of its own, and the time is taken until the exception is
there. Prints for each its name and the longest of these times in seconds; null where it was over before.
"""

from __future__ import annotations

import json
import pickle
import signal
import sys
import time
from typing import TYPE_CHECKING, Any

import numpy as np
from polhode import (
    MassAccumulator,
    RigidBody,
    Uncertain,
    _core,
    equimomental,
    laminae,
    loads,
    orbits,
    principal_axes,
    principal_moments,
    regions,
    rods,
    solids,
    tops,
    validity,
)
from polhode.molecules import planar_moments

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

#: No call is struck before this, in seconds.
SOON = 0.02

#: Rows of the stacks, and of those whose rows take longer.
ROWS, DEAR, DEAREST = 1_600_000, 150_000, 3_000


def calls() -> dict[str, Callable[[], object]]:
    """Give every call that can last longer than a fifth of a second, at a size at which it does."""
    rng = np.random.default_rng(20261122)
    numbers = rng.uniform(1.0, 2.0, ROWS)
    vectors = rng.normal(size=(ROWS, 3))
    quaternions = rng.normal(size=(ROWS, 4))
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    moments = np.sort(rng.uniform(1.0, 1.5, (ROWS, 3)), axis=1)
    tensors = moments[:, :, None] * np.eye(3) + 0.01
    bodies = RigidBody.from_principal(numbers, moments)
    few, some = bodies[:DEAREST], bodies[:DEAR]
    rates = vectors[:DEAR]
    one = RigidBody.from_principal(1.0, (1.0, 1.2, 1.5))
    top = RigidBody.from_principal(1.0, (0.2, 0.2, 0.1), center_of_mass=(0.0, 0.0, 0.3))
    tilted = (np.sin(0.2), 0.0, 0.0, np.cos(0.2))
    many = np.linspace(0.0, 1e4, 3 * ROWS)
    spin, weight = (1.0, 0.1, 1.0), (0.0, 0.0, -9.81)
    motions = some.free_motion(rates)
    free = one.free_motion(spin)
    heavy = top.heavy_top(rates, tilted, weight)
    states = motions.at([0.0, 1.0, 2.0, 3.0])
    drag, push = loads.damping(0.1), loads.constant_torque((0.0, 0.0, 0.1), "space")
    pushes = loads.constant_torque(vectors)
    pseudo, parameters = _core.to_pseudo_inertia(bodies), _core.to_parameters(bodies)
    logarithms = _core.to_log_cholesky(bodies)
    found = principal_axes(tensors)
    vertices, faces = sphere(1000)
    doubted = Uncertain(vertices, 1e-3)
    nodes, cells = 30.0 * vectors, rng.integers(0, ROWS, (ROWS, 4))
    accumulator = MassAccumulator()
    pickled = pickle.dumps(bodies)
    windows = np.arange(2.0 * ROWS).reshape(-1, 2)
    teeth = np.column_stack([np.tile([0.0, 1.0], 20_000), np.arange(40_000.0)])
    comb = np.vstack([teeth, [(2.0, 39_999.0), (2.0, -1.0), (0.0, -1.0)]])
    rows, columns = numbers.tolist(), vectors.tolist()
    near = np.column_stack([1e-3 * vectors, np.ones(ROWS)])
    near /= np.linalg.norm(near, axis=1, keepdims=True)
    heavy_ones, long = np.tile(numbers, 5), np.tile(vectors, (5, 1))
    turned = np.asfortranarray(long)

    def waves(points: NDArray[np.float64]) -> NDArray[np.float64]:
        return 1.0 + np.sin(40.0 * points[:, 0]) ** 2

    return {
        "RigidBody": lambda: RigidBody(numbers, tensors),
        "from_principal": lambda: RigidBody.from_principal(numbers, moments, quaternions, vectors),
        "slice": lambda: bodies[::-1],
        "new axis": lambda: bodies[:, None],
        "iteration": lambda: list(bodies),
        "stack": lambda: RigidBody.stack([bodies, bodies]),
        "translated": lambda: bodies.translated(vectors),
        "rotated": lambda: bodies.rotated(quaternions),
        "scaled": lambda: bodies.scaled(2.0),
        "sum": lambda: bodies + bodies,
        "difference": lambda: bodies - bodies.scaled(1.0, 0.1),
        "combined": bodies.combined,
        "principal_about": lambda: bodies.principal_about((1.0, 2.0, 3.0)),
        "pickled": lambda: pickle.dumps(bodies),
        "unpickled": lambda: pickle.loads(pickled),
        "provenance": lambda: bodies.provenance,
        "equimomental": bodies.equimomental_particles,
        "free_motion": lambda: bodies.free_motion(vectors),
        "free_motion.at": lambda: motions.at(np.linspace(0.0, 1.0, 40)),
        "many times": lambda: free.at(many),
        "periods": lambda: bodies.free_motion(vectors).periods,
        "polhode": lambda: free.polhode(10 * ROWS),
        "polhodes": lambda: motions.polhode(200),
        "herpolhode": lambda: free.herpolhode(many),
        "sensitivity": lambda: free.sensitivity(many[:ROWS]),
        "error_bar": lambda: free.error_bar(many[:ROWS]),
        "heavy_top": lambda: top.heavy_top(vectors, tilted, weight),
        "heavy_top.at": lambda: heavy.at(np.linspace(0.0, 1.0, 20)),
        "effective_potential": lambda: heavy.effective_potential(np.linspace(0.0, 1.0, 200)),
        "exact runs": lambda: bodies.simulate([0.0, 1.0], vectors),
        "taylor runs": lambda: some.simulate([0.0, 30.0], rates, load=drag),
        "dop853 runs": lambda: some.simulate([0.0, 1.0], rates, load=drag, method="dop853"),
        "radau runs": lambda: few.simulate([0.0, 1.0], rates[:DEAREST], load=drag, method="radau"),
        "splitting runs": lambda: few.simulate([0.0, 9.0], rates[:DEAREST], load=push, method="splitting"),
        "one exact run": lambda: one.simulate(many, spin),
        "one run of taylor": lambda: one.simulate(many, spin, load=push),
        "one precise run": lambda: one.simulate([0.0, 1e4], spin, load=push, rtol=1e-28),
        "callback": lambda: one.simulate(
            [0.0, 1e5], spin, load=loads.torque_callback(lambda *_: (0.0, 0.0, 0.0))
        ),
        "variations": lambda: _core.motion_sensitivity(
            few, [0.0, 9.0], rates[:DEAREST], (0, 0, 0, 1), drag, "center_of_mass"
        ),
        "a load": lambda: loads.gravity_gradient(1.0, vectors + 9.0, vectors),
        "a load negative": lambda: -(pushes + pushes),
        "a load picked": lambda: pushes[::-1] + pushes[::2][:1],
        "torque": lambda: pushes.torque(0.0, vectors, quaternions),
        "schedule": lambda: loads.schedule(loads.schedule(push, windows), windows + 0.5),
        "sampled": lambda: loads.sampled(np.arange(float(ROWS)), vectors),
        "sampled field": lambda: loads.magnetic((0.0, 0.0, 1.0), vectors, times=np.arange(float(ROWS))),
        "sampled light": lambda: loads.panels(
            ([(0, 0, 0)], [1.0], [(0, 0, 1)]),
            coefficients=(0, 0),
            direction=vectors + 9.0,
            pressure=1.0,
            times=np.arange(float(ROWS)),
        ),
        "sampled orbit": lambda: loads.gravity_gradient(
            orbits.sampled(1.0, np.arange(float(ROWS)), vectors + 9.0)
        ),
        "sampled target": lambda: loads.feedback(1.0, 1.0, near, times=np.arange(float(ROWS))),
        "kinetic energy": lambda: states.kinetic_energy().total,
        "euler angles": lambda: states.euler_angles(singular="nan", unwrap=True),
        "invariants": states.invariants,
        "principal_axes": lambda: principal_axes(tensors, canonical=True),
        "principal_moments": lambda: principal_moments(tensors),
        "derivative": lambda: found.derivative(tensors),
        "classify": lambda: (found.classify(), found.canonical(), found.quaternion),
        "euler": lambda: _core.euler_angles_from_quaternion(
            _core.quaternion_from_euler_angles(vectors), "ZXZ", "nan"
        ),
        "euler rates": lambda: _core.euler_rates(
            vectors, _core.angular_velocity_from_euler_rates(vectors, vectors), "ZXZ", "body", "nan"
        ),
        "rotate": lambda: _core.rotate(quaternions, _core.rotate(quaternions, vectors)),
        "pseudo inertia": lambda: _core.from_pseudo_inertia(pseudo),
        "parameters": lambda: _core.from_parameters(parameters),
        "log Cholesky": lambda: _core.from_log_cholesky(logarithms),
        "nearest_valid": lambda: validity.nearest_valid(tensors),
        "fit_in_box": lambda: validity.fit_in_box(bodies, (-5, -5, -5), (5, 5, 5)),
        "free_precession": lambda: tops.free_precession(solids.cylinder(1.0, 2.0, mass=numbers), vectors),
        "solids": lambda: solids.prism(6, numbers, numbers, mass=1.0),
        "laminae": lambda: laminae.triangle(vectors.reshape(-1, 3, 1) * vectors[:, None, :2], mass=1.0),
        "polygon": lambda: laminae.polygon(comb, mass=1.0),
        "rods": lambda: rods.arc(numbers, numbers, mass=1.0),
        "stick": lambda: equimomental.stick(numbers, numbers, numbers, numbers),
        "from_curve": lambda: RigidBody.from_curve(long, mass=1.0),
        "from_particles": lambda: RigidBody.from_particles(heavy_ones, long),
        "from_labelled": lambda: RigidBody.from_labelled_particles(numbers, vectors, np.arange(ROWS) // 5),
        "from_voxels": lambda: RigidBody.from_voxels(np.ones((DEAR, 3, 3, 3)), 1.0),
        "accumulator": lambda: accumulator.add(heavy_ones, long),
        "from_mesh": lambda: RigidBody.from_mesh(vertices, faces, mass=1.0, orient=True),
        "uncertain vertices": lambda: RigidBody.from_mesh(doubted, faces, mass=1.0),
        "from_surface": lambda: RigidBody.from_surface(vertices, faces, mass=1.0, thickness=1e-4),
        "thin surface": lambda: RigidBody.from_surface(vertices, faces, mass=1.0),
        "from_tetrahedra": lambda: RigidBody.from_tetrahedra(nodes, cells, density=1.0),
        "region": lambda: regions.mesh(vertices, faces),
        "from_density": lambda: RigidBody.from_density(
            waves, regions.ball(1.0), rtol=1e-12, max_evaluations=10**10
        ),
        "a list of numbers": lambda: solids.sphere(rows * 5, mass=1.0),
        "a list of rows": lambda: _core.transport(columns * 2, (0, 0, 0), (0, 0, 0)),
        "another order": lambda: _core.transport(turned, (0, 0, 0), (0, 0, 0)),
        "planar moments": lambda: planar_moments(columns * 2),
    }


def sphere(parts: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Give a sphere of about `parts`² faces."""
    rows = parts // 2
    around = np.linspace(0.0, 2.0 * np.pi, parts, endpoint=False)
    down = np.linspace(0.0, np.pi, rows + 1)[1:-1, None]
    ring = np.stack(
        np.broadcast_arrays(np.sin(down) * np.cos(around), np.sin(down) * np.sin(around), np.cos(down)), -1
    )
    vertices = np.vstack([ring.reshape(-1, 3), [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]])
    index = np.arange(ring.size // 3).reshape(ring.shape[:2])
    right = np.roll(index, -1, axis=1)
    a, b, c, d = index[:-1].ravel(), right[:-1].ravel(), index[1:].ravel(), right[1:].ravel()
    north, south = np.full(parts, len(vertices) - 2), np.full(parts, len(vertices) - 1)
    faces = [(a, c, d), (a, d, b), (north, index[0], right[0]), (south, right[-1], index[-1])]
    return vertices, np.vstack([np.column_stack(three) for three in faces])


def latency(call: Callable[[], object], delay: float) -> float | None:
    """Strike a call after `delay` of its own processor time; give the time until it is over, if it ran on."""
    start = time.process_time()
    try:
        signal.setitimer(signal.ITIMER_PROF, delay)
        call()
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        after = time.process_time() - start - delay
        return after if after > 0.0 else None
    except KeyboardInterrupt:
        return time.process_time() - start - delay


def strike(_signal: int, _frame: Any) -> None:
    """Do what Ctrl-C does."""
    raise KeyboardInterrupt


def main(delays: list[float], names: list[str]) -> None:
    """Strike each call after each of the delays, twice where it took long: the better one counts.

    What is over before it is struck, on a fast machine, is struck earlier.
    """
    signal.signal(signal.SIGPROF, strike)
    for name, call in calls().items():
        if names and name not in names:
            continue
        worst = None
        for longest in delays:
            delay = longest
            taken = latency(call, delay)
            while taken is None and delay > SOON:
                delay /= 2.0
                taken = latency(call, delay)
            if taken is not None and taken > 0.1:
                taken = min(taken, latency(call, delay) or taken)
            if taken is not None:
                worst = max(taken, worst or 0.0)
        print(json.dumps([name, worst]), flush=True)


if __name__ == "__main__":
    main(json.loads(sys.argv[1]), sys.argv[2:])
