"""What results print: one short line each, whatever their size."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from polhode import RigidBody, loads, solids
from polhode.io import Mesh

if TYPE_CHECKING:
    from collections.abc import Callable

BODY = RigidBody.from_principal(2.0, (1.0, 2.0, 2.5))
STACK = RigidBody.stack([BODY, BODY])
TOP = RigidBody.from_principal(1.0, (2.0, 2.0, 3.0), center_of_mass=(0.0, 0.0, 0.5))
WEIGHT = loads.uniform_gravity((0.0, 0.0, -9.81))
DAMPING = loads.damping(np.eye(3))

PRINTED: list[tuple[Callable[[], object], str]] = [
    (
        lambda: BODY.principal,
        "PrincipalAxes(moments=[1.0, 2.0, 2.5], axes=[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "
        "top='asymmetric')",
    ),
    (lambda: STACK.principal, "<PrincipalAxes stack of shape (2,)>"),
    (
        lambda: BODY.provenance,
        "Provenance(source='principal moments', elements=1, checked='finite, tensor', welded=0, "
        "closure='', volume_change=0.0, moments='given', rounded_to_zero=0)",
    ),
    (lambda: STACK.provenance, "<Provenance stack of shape (2,)>"),
    (lambda: BODY.error_bound, "ErrorBound(mass=0.0, center_of_mass=0.0, inertia=1.95"),
    (
        lambda: BODY.kinetic_energy((1, 0, 0), velocity=(0, 1 / 3, 0)),
        "KineticEnergy(translational=0.11111111, mixed=0.0, rotational=0.5)",
    ),
    (
        lambda: BODY.kinetic_energy(np.ones((100, 3))),
        "KineticEnergy(translational=<shape (100,)>, mixed=<shape (100,)>, rotational=<shape (100,)>)",
    ),
    (
        lambda: BODY.angular_momentum((1, -1, 0)),
        "AngularMomentum(orbital=[0.0, 0.0, 0.0], mixed=[0.0, 0.0, 0.0], spin=[1.0, -2.0, 0.0])",
    ),
    (
        lambda: BODY.simulate([0, 1], (0, 0, 1)).state(0),
        "State(omega=[0.0, 0.0, 1.0], attitude=[0.0, 0.0, 0.0, 1.0], position=[0.0, 0.0, 0.0], "
        "velocity=[0.0, 0.0, 0.0])",
    ),
    (lambda: BODY.simulate([0, 1], (0, 0, 1)), "Trajectory(2 times from 0 to 1)"),
    (
        lambda: BODY.simulate([0, 9], (0, 1, 1e-3), events=_third).events,
        "<Events: none>",
    ),
    (
        lambda: BODY.free_motion((0, 0, 2)).poinsot([0.0]),
        "Poinsot(semi_axes=[3.1622777, 2.236068, 2.0], normal=[0.0, 0.0, 1.0], distance=2.0, "
        "radii=[0.0, 0.0], contact=[[0.0, 0.0, 2.0]])",
    ),
    (
        lambda: BODY.free_motion((0, 0, 2)).sensitivity(1.0),
        "Sensitivity(state=<shape (6, 6)>, moments=<shape (6, 3)>)",
    ),
    (lambda: BODY.free_motion((0, 0, 2)), "<FreeMotion: steady, omega=[0.0, 0.0, 2.0]>"),
    (lambda: TOP.heavy_top((0, 0, 9), None, (0, 0, -1)), "<HeavyTop: steady, omega=[0.0, 0.0, 9.0]>"),
    (lambda: WEIGHT, "<Load: uniform_gravity>"),
    (lambda: WEIGHT - 2 * DAMPING, "<Load: uniform_gravity + -1.0 * 2.0 * damping>"),
    (lambda: loads.schedule(DAMPING, [(0, 1)]), "<Load: schedule(damping)>"),
    (lambda: loads.torque_callback(lambda _t, w, _q: -w), "<Load: torque_callback>"),
    (
        lambda: loads.uniform_gravity(np.ones((3, 3))),
        "<Load stack of shape (3,): uniform_gravity>",
    ),
    (lambda: loads.uniform_gravity(np.ones((3, 3)))[1], "<Load: uniform_gravity>"),
    (
        lambda: solids.box((2, 2, 2), mass=4.0).equimomental_particles(),
        "Particles(masses=[1.0, 1.0, 1.0, 1.0], positions=[[",
    ),
    (
        lambda: Mesh(np.zeros((5, 3)), np.zeros((2, 3), dtype=np.int64), "PLY"),
        "Mesh(vertices=<shape (5, 3)>, faces=[[0, 0, 0], [0, 0, 0]], format='PLY')",
    ),
]


def _third(_t: float, omega: np.ndarray, *_: np.ndarray) -> float:
    return float(omega[1]) + 5.0


@pytest.mark.parametrize(("make", "line"), PRINTED, ids=[line[:40] for _, line in PRINTED])
def test_it_prints_on_one_line(make: Callable[[], object], line: str) -> None:
    printed = repr(make())
    assert printed.startswith(line)
    assert "\n" not in printed
    assert len(printed) < 260


def test_a_run_that_ended_early_says_so() -> None:
    class Stop:
        terminal = True

        def __call__(self, t: float, *_: np.ndarray) -> float:
            return t - 0.5

    motion = BODY.simulate([0, 1], (0, 0, 1), events=Stop())
    assert repr(motion) == "Trajectory(2 times from 0 to 1, event)"
    assert repr(motion.events) == "<Events: 1 at 0.5>"
