"""Random bodies under feedback and schedules: every method that serves them against a model in NumPy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.many_motions import Motions
from polhode import RigidBody, loads
from polhode.errors import IntegrationError

Floats = NDArray[np.float64]
KINDS = ("body_torque", "space_torque", "linear", "quadratic", "feedback")
STEP = 0.04
"""Of the reference; rates are near one, so that order 8 leaves rounding alone."""
HALVINGS = 6
"""Of that step at most, where two references are too far apart."""
STRICTEST, LOOSEST = 1e-11, 1e-6
"""The tolerances."""
MOVED = 1e-10
DIRECTIONS = 3
"""How far a start is moved, and in how many directions, to see what becomes of small changes."""


def _unit(rng: np.random.Generator, count: int, size: int) -> Floats:
    v = rng.normal(size=(count, size))
    return np.asarray(v / np.linalg.norm(v, axis=1)[:, None])


def draw(rng: np.random.Generator, n: int) -> tuple[Motions, Floats, Floats]:
    """Bodies and loads, states to start from, and the lengths of the runs."""
    second = rng.uniform(0.1, 1.0, (n, 3))
    second[rng.random(n) < 0.2, 1:] = 0.5  # symmetric ones
    moments = second.sum(1)[:, None] - second
    axes = np.linalg.qr(rng.normal(size=(n, 3, 3)))[0]
    axes[rng.random(n) < 0.5] = np.eye(3)
    inertia = axes * moments[:, None, :] @ axes.transpose(0, 2, 1)
    has = {kind: rng.random(n) < 0.3 for kind in KINDS}
    has["feedback"] = rng.random(n) < 0.8
    eye = np.eye(3)

    def gain(kind: str, low: float, high: float) -> Floats:
        size = np.exp(rng.uniform(np.log(low), np.log(high), n)) * has[kind]
        shape = eye + 0.3 * rng.normal(size=(n, 3, 3)) * (rng.random(n) < 0.3)[:, None, None]
        return np.asarray(size[:, None, None] * shape @ shape.transpose(0, 2, 1))

    lightly = (10.0 ** rng.uniform(-4, -0.5, n) * (rng.random(n) < 0.5) * has["feedback"])[:, None, None]
    end = rng.uniform(5.0, 30.0, n)
    windows = {}
    for kind in KINDS:
        window = np.sort(rng.uniform(0.0, 1.0, (n, 2)), 1) * end[:, None]
        always = rng.random(n) < 0.5
        windows[kind] = np.where(always[:, None], [[-1e3, 1e3]], window)
    target = _unit(rng, n, 4)
    motions = Motions(
        inertia=0.5 * (inertia + inertia.transpose(0, 2, 1)),
        body_torque=0.1 * rng.normal(size=(n, 3)) * has["body_torque"][:, None],
        space_torque=0.3 * rng.normal(size=(n, 3)) * has["space_torque"][:, None],
        linear=gain("linear", 1e-3, 0.3),
        quadratic=gain("quadratic", 1e-3, 0.3),
        stiffness=gain("feedback", 0.2, 3.0),
        damping=lightly * eye,
        target=target,
        windows=windows,
    )
    states = np.concatenate([_unit(rng, n, 4), rng.normal(size=(n, 3))], 1)
    # Many come close to half a turn from the target, or just past it: that state is taken back in time.
    e = np.concatenate([_unit(rng, n, 3), np.zeros((n, 1))], 1)
    depth = 10.0 ** rng.uniform(-6, -2, n) * rng.choice([-1.0, 1.0], n)
    e[:, 3] = depth
    across = np.cross(e[:, :3], states[:, 4:]) + 1e-3 * rng.normal(size=(n, 1)) * e[:, :3]
    graze = np.concatenate([_times(target, e), across], 1)
    graze[:, :4] /= np.linalg.norm(graze[:, :4], axis=1)[:, None]
    at = rng.uniform(0.3, 4.0, n)
    # Backward in time damping drives: where it is strong there is no such start.
    is_weak = has["feedback"] & ~has["quadratic"] & ~has["linear"]
    chosen = np.flatnonzero(is_weak & (rng.random(n) < 0.6))
    states[chosen] = motions.rows(chosen).run(graze[chosen], at[chosen], np.zeros(chosen.size), STEP)
    states[has["feedback"] & (rng.random(n) < 0.05), 4:] = 0.0
    return motions, states, end


def _times(p: Floats, q: Floats) -> Floats:
    vector = p[:, 3:] * q[:, :3] + q[:, 3:] * p[:, :3] + np.cross(p[:, :3], q[:, :3])
    return np.concatenate([vector, (p[:, 3] * q[:, 3] - (p[:, :3] * q[:, :3]).sum(1))[:, None]], 1)


def load_of(motions: Motions, row: int) -> Any:
    parts: list[Any] = []

    def add(kind: str, *numbers: Floats, load: Any) -> None:
        if not any(number[row].any() for number in numbers):
            return
        window = motions.windows[kind][row]
        parts.append(load if window[1] == 1e3 else loads.schedule(load, [tuple(window)]))

    m = motions
    add("body_torque", m.body_torque, load=loads.constant_torque(m.body_torque[row], "body"))
    add("space_torque", m.space_torque, load=loads.constant_torque(m.space_torque[row], "space"))
    add("linear", m.linear, load=loads.damping(m.linear[row]))
    add("quadratic", m.quadratic, load=loads.damping(np.zeros((3, 3)), m.quadratic[row]))
    feedback = loads.feedback(m.stiffness[row], m.damping[row], m.target[row])
    add("feedback", m.stiffness, load=feedback)
    if not parts:
        return None
    total = parts[0]
    for part in parts[1:]:
        total = total + part
    return total


def apart(a: Floats, b: Floats, scale: Any) -> Any:
    """Half an angle, or how far ω are apart in parts of its scale."""
    tilts = [np.linalg.norm(a[..., :4] + sign * b[..., :4], axis=-1) for sign in (-1, 1)]
    tilt = np.minimum(*tilts)
    return np.maximum(tilt, np.linalg.norm(a[..., 4:] - b[..., 4:], axis=-1) / scale)


def serving(motions: Motions, row: int) -> list[Any]:
    rates = (motions.linear, motions.quadratic, motions.damping)
    return ["taylor", "dop853", "radau"] + (["splitting"] if not any(x[row].any() for x in rates) else [])


def compare(n: int, seed: int) -> dict[str, float]:
    """The worst error of each method in units of what is allowed, 100 rtol κ."""
    rng = np.random.default_rng(seed)
    motions, states, end = draw(rng, n)
    start = np.zeros(n)
    scale = np.maximum(np.linalg.norm(states[:, 4:], axis=1), 1.0)
    # The starts, and beside them those that are moved, in one run.
    starts = np.concatenate([states, *(states + _unit(rng, n, 7) * MOVED for _ in range(DIRECTIONS))])
    starts[n:, :4] /= np.linalg.norm(starts[n:, :4], axis=1)[:, None]
    copies = np.tile(np.arange(n), 1 + DIRECTIONS)
    ends = motions.rows(copies).run(starts, start[copies], end[copies], STEP).reshape(1 + DIRECTIONS, n, 7)
    want = ends[0]
    kappa = np.maximum(apart(ends[1:], want, scale).max(0) / MOVED, 1.0)
    doubt = np.full(n, np.inf)
    rows, step = np.arange(n), STEP
    for _ in range(HALVINGS):
        step *= 0.5
        fine = motions.rows(rows).run(states[rows], start[rows], end[rows], step)
        doubt[rows] = apart(fine, want[rows], scale[rows])
        want[rows] = fine
        rows = np.flatnonzero((doubt >= 10 * STRICTEST * kappa) & (kappa <= 1e8))
    worst: dict[str, float] = {}
    left_out = 0
    wrong: list[str] = []
    for row in range(n):
        if kappa[row] > 1e8:
            left_out += 1
            continue
        body = RigidBody(1.0, motions.inertia[row])
        rtol = float(np.exp(rng.uniform(np.log(STRICTEST), np.log(LOOSEST))))
        for method in serving(motions, row):
            tolerance = max(rtol, 1e-9) if method == "radau" else rtol
            run = body.simulate(
                [0.0, end[row]],
                states[row, 4:],
                states[row, :4],
                load=load_of(motions, row),
                method=method,
                rtol=tolerance,
            )
            got = np.concatenate([run.quaternion[-1], run.omega[-1]])
            allowed = 100 * tolerance * kappa[row]
            assert doubt[row] < 0.1 * allowed, f"{seed=} {row=}: the reference is off by {doubt[row]:.2e}"
            ratio = float(apart(got, want[row], scale[row]) / allowed)
            worst[method] = max(worst.get(method, 0.0), ratio)
            if ratio >= 1.0:
                where = f"{seed=} {row=} {method} rtol={tolerance:.2e} κ={kappa[row]:.2e}"
                wrong.append(f"{where}: {ratio:.2e} of what is allowed")
    assert not wrong, "\n".join(wrong)
    assert left_out <= max(1, 0.01 * n)
    return worst


def test_random_feedbacks_and_schedules() -> None:
    assert set(compare(4, 1)) == {"taylor", "dop853", "radau", "splitting"}


@pytest.mark.long
@pytest.mark.timeout(7200)
def test_two_thousand_random_feedbacks_and_schedules() -> None:
    print(compare(20, 1))
    for seed in range(10):
        print(seed, compare(200, 100 + seed))


METHODS = ("taylor", "dop853", "radau", "splitting")
BALL = RigidBody.from_principal(1.0, (1.0, 1.0, 1.0))


@pytest.mark.parametrize("method", METHODS)
def test_a_flip_twice_within_a_step(method: Any) -> None:
    """A ball that turns about one axis has w = cos(θ/2), and dips below zero for a moment on its way."""
    run = BALL.simulate([0, 20], (0, 0, 2.002), load=loads.feedback(1.0, 0.0), method=method, rtol=1e-12)
    assert run.omega[-1, 2] == pytest.approx(1.96575271182971, abs=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_a_load_that_begins_late(method: Any) -> None:
    """A ball at rest under a torque from t = 10 to 20 has ω = 3 (t − 10), then 30."""
    load = loads.schedule(loads.constant_torque((0, 0, 3.0), frame="space"), [(10, 20)])
    run = BALL.simulate([0, 5, 15, 30], (0, 0, 0), load=load, method=method, rtol=1e-9)
    assert run.omega[:, 2] == pytest.approx([0, 0, 15, 30], abs=1e-6)
    angle = np.array([0.0, 0.0, 37.5, 450.0])
    turned = np.abs(run.quaternion[:, 2] * np.cos(angle / 2) - run.quaternion[:, 3] * np.sin(angle / 2))
    assert turned.max() < 1e-5


@pytest.mark.parametrize("method", METHODS)
def test_a_law_that_holds_the_body_where_it_changes(method: Any) -> None:
    """A feedback of negative stiffness drives to half a turn from its target, from both sides."""
    ends = "cannot go on at t = |a run takes 1e9 at most"
    with pytest.raises(IntegrationError, match=ends) as caught:
        BALL.simulate([0, 5], (0, 0, 0), (0, 0, 1, 0), load=loads.feedback(-1.0, 0.0), method=method)
    assert 0.0 <= caught.value.time < 1e-6


@pytest.mark.parametrize("method", METHODS)
def test_a_run_that_cannot_end(method: Any) -> None:
    """It stops after a limit of steps with what was computed; a run of 1e8 turns is none of these."""
    load = loads.uniform_gravity((0, 0, -1.0)) if method == "splitting" else None
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5), center_of_mass=(0, 0, 0.1))
    about: Any = "origin" if load else "center_of_mass"
    with pytest.raises(IntegrationError, match="a run takes 1e9 at most") as caught:
        body.simulate([0, 1, 1e40], (0.3, 0.2, 0.5), load=load, about=about, method=method, rtol=1e-6)
    if method != "splitting":
        assert caught.value.time > 1e3
        assert caught.value.partial is not None
        assert np.isfinite(caught.value.partial.omega[1]).all()
