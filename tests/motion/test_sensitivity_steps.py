"""Derivatives of random motions do not depend on where the steps end."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

import numpy as np
import pytest
from polhode import MotionSensitivity, RigidBody, loads
from polhode.errors import IntegrationError
from scipy.spatial.transform import Rotation

RUNS = 60
MANY = 2_000
CUTS = 60


class Case(NamedTuple):
    """A motion under a sum of terms."""

    body: RigidBody
    omega: np.ndarray
    attitude: Rotation
    load: Any
    time: float
    about: Literal["origin", "center_of_mass"]

    def sensitivity(self, *more: Any) -> MotionSensitivity:
        """Derivatives at a third of the time and at its end, under further loads too."""
        times = [0.0, self.time / 3, self.time]
        load = sum(more, self.load)
        run = self.body.simulate(
            times, self.omega, self.attitude, load=load, about=self.about, method="taylor"
        )
        return run.sensitivity()


def random_case(rng: np.random.Generator) -> Case:
    """A body of any class, free or pivoted, under one to three terms, some of them scaled or switched."""
    pivoted = bool(rng.integers(2))
    unit = 10.0 ** rng.uniform(-8, 8) if rng.random() < 0.3 else 1.0
    moments = [(1.0, 1.3, 1.9), (0.7, 0.7, 1.2), (0.6, 1.1, 1.1), (1.0, 1.0, 1.0), (0.5, 1.5, 1.9)]
    body = RigidBody.from_principal(
        float(rng.uniform(0.5, 3)) * unit,
        np.array(moments[rng.integers(5)]) * unit,
        center_of_mass=rng.normal(size=3) * 0.1 if pivoted else (0, 0, 0),
        axes=Rotation.random(random_state=rng).as_matrix(),
    )
    omega = rng.normal(size=3) * rng.choice([0.1, 1.0, 5.0])
    kinds = rng.integers(0, 7, rng.integers(1, 4)).tolist()
    # Backward in time damping drives a body without end.
    way = 1 if {3, 4} & set(kinds) else rng.choice([1, -1])
    time = float(rng.uniform(1, 15)) / max(float(np.linalg.norm(omega)), 0.5) * way
    ends = min(0.0, time), max(0.0, time)

    def gain(size: float) -> np.ndarray:
        root = rng.normal(size=(3, 3))
        return size * unit * (root @ root.T)

    def term(kind: int) -> Any:
        frame: Literal["body", "space"] = "body" if rng.random() < 0.5 else "space"
        vector = rng.normal(size=3) * 0.5 * unit
        target = Rotation.random(random_state=rng)
        if kind == 0:
            return loads.constant_torque(vector, frame=frame)
        if kind == 1:
            return loads.constant_force(vector, frame=frame, point=rng.normal(size=3))
        if kind == 2:
            return loads.uniform_gravity(rng.normal(size=3))
        if kind == 3:
            return loads.damping(gain(0.05), gain(0.05) if rng.random() < 0.6 else None)
        if kind == 4:
            return loads.feedback(gain(0.5), gain(0.1), target=target)
        if kind == 5 and not pivoted:
            place = target.apply((rng.uniform(0.7, 3), 0, 0))
            velocity = rng.normal(size=3) * rng.uniform(0.2, 1.2)
            epoch = float(rng.choice([0.0, -0.5, -40.0]))
            return loads.gravity_gradient(float(rng.uniform(0.3, 2)), place, velocity, epoch=epoch)
        knots = np.sort([ends[0] - 1e-3, *rng.uniform(*ends, rng.integers(6)), ends[1] + 1e-3])
        return loads.sampled(knots, rng.normal(size=(len(knots), 3)) * 0.3 * unit, frame=frame)

    load: Any = None
    for kind in kinds:
        made = term(kind)
        if rng.random() < 0.3:
            made = made * float(rng.uniform(0.1, 2))
        if rng.random() < 0.3:
            made = loads.schedule(made, [tuple(np.sort(rng.uniform(*ends, 2)))])
        load = made if load is None else load + made
    return Case(
        body, omega, Rotation.random(random_state=rng), load, time, "origin" if pivoted else "center_of_mass"
    )


def parts(found: MotionSensitivity, terms: int) -> list[np.ndarray]:
    """All derivatives, kind by kind; those by the load for its first terms."""
    own = [found.state, found.moments, found.products, found.center_of_mass, found.mass]
    return own + [by for term in found.load[:terms] for by in term.values()]


def excess(case: Case) -> float:
    """How much cutting the steps changes the derivatives, over what rounding may."""
    times = np.linspace(min(0.0, case.time), max(0.0, case.time), 2 * CUTS + 1)[1:]
    windows = list(zip(times[::2].tolist(), times[1::2].tolist(), strict=True))
    nothing = loads.schedule(loads.constant_torque((0, 0, 0)), windows)
    whole = case.sensitivity()
    cut = case.sensitivity(nothing)
    terms = len(whole.load)
    allowed = 2e-12 + 4e-15 * float(np.linalg.norm(whole.state))
    return max(
        float(np.linalg.norm(a - b)) / (allowed * max(float(np.linalg.norm(a)), 1e-300))
        for a, b in zip(parts(whole, terms), parts(cut, terms), strict=True)
    )


def worst(runs: int, seed: int) -> tuple[float, int]:
    """The largest excess, and how many motions could go on to their end."""
    rng = np.random.default_rng(seed)
    largest, done = 0.0, 0
    for _ in range(runs):
        case = random_case(rng)
        try:
            largest = max(largest, excess(case))
        except IntegrationError:  # a feedback that holds the body where its sign changes
            continue
        done += 1
    return largest, done


def test_steps_may_end_anywhere() -> None:
    largest, done = worst(RUNS, 20261122)
    assert done > 0.9 * RUNS
    assert largest <= 1.0


@pytest.mark.long
def test_steps_may_end_anywhere_in_many_motions() -> None:
    largest, done = worst(MANY, 1)
    assert done > 0.9 * MANY
    assert largest <= 1.0
