"""Random bodies, states and loads over twelve decades, by every method: finite, or refused with a reason."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest
from polhode import RigidBody, loads

SEED = 20261121
METHODS = ("auto", "exact", "taylor", "dop853", "radau", "splitting")
KINDS = (
    "none",
    "torque in the body",
    "torque in space",
    "force in space",
    "weight",
    "damping",
    "quadratic damping",
    "feedback",
    "gravity gradient",
    "sampled",
    "magnetic",
    "B-dot",
    "sum",
)


def scale(rng: np.random.Generator, decades: float = 12.0) -> float:
    """A number whose logarithm is uniform over so many decades around one."""
    return float(10.0 ** rng.uniform(-decades / 2, decades / 2))


def some_body(rng: np.random.Generator) -> tuple[RigidBody, float]:
    """A body, thin ones, flat ones and near-spheres among them, and its largest moment."""
    second = 10.0 ** rng.uniform(-rng.choice([0.01, 1.0, 6.0]), 0.0, 3)
    if rng.random() < 0.1:
        second[0] = 0.0
    if rng.random() < 0.1:
        second[1:] = second[2]
    mass, length = scale(rng), scale(rng)
    moments = np.sort(second.sum() - second) * mass * length**2
    center = rng.normal(size=3) * length * rng.choice([0.0, 1.0])
    if rng.random() < 0.5:
        return RigidBody.from_principal(mass, moments, center_of_mass=center), float(moments[2])
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    tensor = turn @ np.diag(moments) @ turn.T
    return RigidBody(mass, 0.5 * (tensor + tensor.T), center), float(moments[2])


def some_load(rng: np.random.Generator, kind: str, size: float, rate: float, span: float) -> Any:
    """A load of a kind whose torques are about `size`, or nothing."""
    vector = size * rng.normal(size=3)
    matrix = np.diag(rng.uniform(0.0, 1.0, 3)) * size / rate
    match kind:
        case "none":
            return None
        case "torque in the body" | "torque in space":
            return loads.constant_torque(vector, "body" if kind.endswith("body") else "space")
        case "force in space":
            return loads.constant_force(vector, "space", point=rng.normal(size=3))
        case "weight":
            return loads.uniform_gravity(vector)
        case "damping":
            return loads.damping(matrix)
        case "quadratic damping":
            return loads.damping(matrix, matrix / rate)
        case "feedback":
            return loads.feedback(size, size / rate)
        case "gravity gradient":
            distance = scale(rng)
            position, velocity = distance * rng.normal(size=(2, 3))
            return loads.gravity_gradient(rate**2 * distance**3, position, rate * velocity)
        case "magnetic":
            return loads.magnetic(vector, rng.normal(size=3))
        case "B-dot":
            return loads.magnetic(vector, rng.normal(size=3), gain=size / rate)
        case "sampled":
            return loads.sampled(np.linspace(0.0, span, 6), size * rng.normal(size=(6, 3)), "body")
    parts = rng.choice(KINDS[1:-1], 2)
    return some_load(rng, parts[0], size, rate, span) + some_load(rng, parts[1], size, rate, span)


def outcome(rng: np.random.Generator, method: Any) -> str:
    """One run: "done" with its states checked, or the reason why it was refused."""
    body, moment = some_body(rng)
    attitude = rng.normal(size=4)
    omega = rng.normal(size=3) * scale(rng) * rng.choice([0.0, 1.0], p=[0.05, 0.95])
    rate = float(np.linalg.norm(omega)) or 1.0
    # A torque that turns the body as fast as it turns already, or a million times slower or faster.
    strength = scale(rng)
    size = moment * rate**2 * strength
    span = rng.uniform(0.01, 1.0) / (rate * max(1.0, strength))
    kind = str(rng.choice(KINDS))
    path: dict[str, Any] = (
        {"position": rng.normal(size=3), "velocity": rng.normal(size=3)} if rng.random() < 0.3 else {}
    )
    about: Literal["origin", "center_of_mass"] = (
        "origin" if kind == "weight" or (not path and rng.random() < 0.3) else "center_of_mass"
    )
    if about == "origin":
        path = {}
    try:
        load = some_load(rng, kind, size, rate, span)
        run = body.simulate(
            [0.0, 0.5 * span, span],
            omega,
            attitude / np.linalg.norm(attitude),
            load=load,
            about=about,
            method=method,
            rtol=float(10.0 ** rng.uniform(-14.0, -3.0)),
            **path,
        )
    except ValueError as error:
        return str(error)
    for values in (run.omega, run.quaternion, run.position, run.velocity):
        assert np.isfinite(values).all()
    assert np.abs(np.linalg.norm(run.quaternion, axis=-1) - 1.0).max() < 1e-14
    return "done"


def assert_runs(count: int, seed: int) -> None:
    """So many runs of each method; most are done, and each of the others says why not."""
    for method in METHODS:
        rng = np.random.default_rng([seed, METHODS.index(method)])
        reasons = [outcome(rng, method) for _ in range(count)]
        assert min(map(len, reasons)) >= 4
        refused = [reason for reason in reasons if reason != "done"]
        assert all(len(reason.split()) > 5 for reason in refused)
        if method in ("auto", "dop853"):
            assert len(refused) < 0.2 * count


def test_five_hundred_random_runs() -> None:
    assert_runs(90, SEED)


@pytest.mark.long
@pytest.mark.timeout(10_800)
def test_a_hundred_thousand_random_runs() -> None:
    assert_runs(17_000, SEED + 1)
