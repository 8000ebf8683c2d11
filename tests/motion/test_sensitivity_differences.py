"""Derivatives by differences of motions, for loads without series: against series and closed forms."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from oracles.wheels import ATTITUDE, BODY, OMEGA
from polhode import MotionSensitivity, RigidBody, loads
from polhode.errors import PolhodeError
from polhode.motion.finite_differences import CENTRAL, _Row

T = np.array([0.0, 1.0, 3.0])
I3, J = 3.0, 0.5
PLAIN = RigidBody.from_principal(1.0, (1.0, 2.0, I3))
ALONG = (0.0, 0.0, 1.0)
LESS = I3 - J


def near(got: np.ndarray, exact: np.ndarray, allowed: float = 1e-9) -> None:
    """Relative to the largest."""
    assert got.shape == exact.shape
    assert np.abs(got - exact).max() <= allowed * np.abs(exact).max()


def assert_alike(found: MotionSensitivity, exact: MotionSensitivity) -> None:
    for name in ("state", "moments", "products"):
        near(getattr(found, name), getattr(exact, name))
    np.testing.assert_allclose(found.begins, exact.begins, atol=1e-14)
    assert np.abs(found.mass - exact.mass).max() < 1e-9
    assert np.abs(found.center_of_mass - exact.center_of_mass).max() < 1e-9


def test_where_there_are_series() -> None:
    """Wheels of every kind, a slug, torques; rows of a stack."""
    feedback = loads.feedback(0.9 * np.eye(3), np.diag((0.4, 0.5, 0.6)))
    load = (
        loads.wheel((1, 2, -2), 0.2, 3.0, friction=0.1, torque=0.05)
        + loads.wheel((0, 1, 0), 0.1, torque=feedback, name="motor")
        + loads.wheel((0, 1, 1), 0.1, speed=[1.0, 4.0], times=[0.0, 5.0], name="known")
        + loads.slug(0.3, 0.4)
        + loads.constant_torque((0.1, -0.2, 0.3), "space")
    )
    run = BODY.simulate(T, OMEGA * [[1.0], [0.8]], ATTITUDE, load=load)
    found, exact = run.sensitivity("differences"), run.sensitivity()
    assert found.state.shape == (2, 3, 12, 12)
    assert_alike(found, exact)
    assert len(found.load) == len(exact.load)
    for got, series in zip(found.load, exact.load, strict=True):
        for name in got:
            near(got[name], series[name])
    assert set(found.load[0]) == {"axis", "inertia", "rate", "friction", "torque"}
    assert set(found.load[1]) == {"axis", "inertia", "K", "D"}
    assert set(found.load[2]) == {"axis", "inertia", "speed"}


def test_a_pivoted_body() -> None:
    top = RigidBody.from_principal(1.0, (0.8, 1.0, 1.3), center_of_mass=(0.1, -0.2, 0.5))
    load = loads.uniform_gravity((0.0, 0.0, -2.0)) + loads.wheel(ALONG, 0.2, 5.0)
    run = top.simulate(T, OMEGA, ATTITUDE, load=load, about="origin")
    found, exact = run.sensitivity("differences"), run.sensitivity()
    for name in ("state", "moments", "products", "center_of_mass", "mass"):
        near(getattr(found, name), getattr(exact, name))
    near(found.load[0]["gravity"], exact.load[0]["gravity"])


def test_loads_in_windows() -> None:
    load = loads.damping(0.3) + loads.constant_torque((0.1, -0.2, 0.3), "space")
    load = loads.schedule(loads.schedule(load, [(0.5, 2.0)]), [(0.0, 1.5)])
    run = BODY.simulate(T, OMEGA, ATTITUDE, load=load)
    found, exact = run.sensitivity("differences"), run.sensitivity()
    for got, series in zip(found.load, exact.load, strict=True):
        assert set(got) == set(series)
        for name in got:
            near(got[name], series[name])
    # Of what was multiplied by a factor the numbers are not varied.
    twice = BODY.simulate(T, OMEGA, ATTITUDE, load=2.0 * loads.damping(0.3)).sensitivity("differences")
    assert twice.load == ({},)


def test_functions_with_states() -> None:
    """A slug in Python: its derivatives are those of the slug of the package."""

    def rates(_t: float, w: Any, _q: Any, _r: Any, _v: Any, states: Any) -> Any:
        return -0.4 / 0.3 * (states["own"] - w) - np.cross(w, states["own"])

    def wrench(_t: float, w: Any, _q: Any, _r: Any, _v: Any, states: Any) -> Any:
        return (0, 0, 0), 0.4 * (states["own"] - w)

    times = [0.0, 1.0]
    load = loads.with_states(rates, OMEGA, wrench, "own") + loads.wheel(ALONG, 0.2, 2.0)
    run = BODY.simulate(times, OMEGA, ATTITUDE, load=load)
    with pytest.raises(PolhodeError, match=r'sensitivity\(method="differences"\)'):
        run.sensitivity()
    found = run.sensitivity("differences")
    exact = BODY.simulate(
        times, OMEGA, ATTITUDE, load=loads.wheel(ALONG, 0.2, 2.0) + loads.slug(0.3, 0.4)
    ).sensitivity()
    near(found.state, exact.state)
    near(found.moments, exact.moments)
    assert found.load[0] == {}
    near(found.load[1]["rate"], exact.load[0]["rate"])
    # The states of a function do not begin with ω.
    near(found.begins[0], exact.begins[0], 1e-14)
    assert not found.begins[1:].any()


def test_through_the_stop_of_a_wheel() -> None:
    """Ω falls at c₀ (1/J + 1/(I − J)) to its stop; then all turn as one, at L/I, whatever c₀ is."""
    rate, friction = 10.0, 0.25
    stop = rate / (friction * (1 / J + 1 / LESS))
    times = np.array([0.0, 0.5 * stop, 2 * stop])
    load = loads.wheel(ALONG, J, rate, dry_friction=friction)
    run = PLAIN.simulate(times, (0, 0, 0), load=load)
    found = run.sensitivity("differences")
    (wheel,) = found.load
    # While it turns ḣ = −c₀ and (I − J) ω̇ = c₀, h beginning with J Ω; at rest ω = J Ω/I and h = J ω.
    near(wheel["dry_friction"][:, 5], np.array([0.0, 0.5 * stop / LESS, 0.0]))
    near(wheel["dry_friction"][:, 6], np.array([0.0, -0.5 * stop, 0.0]))
    near(wheel["rate"][:, 5], np.array([0.0, 0.0, J / I3]))
    near(wheel["rate"][:, 6], np.array([J, J, J * J / I3]))
    near(wheel["inertia"][:, 5], np.array([0.0, 0.5 * stop * friction / LESS**2, rate / I3]))
    near(found.moments[:, 5, 2], np.array([0.0, -0.5 * stop * friction / LESS**2, -J * rate / I3**2]))
    # ω grows at c₀/(I − J) to its end, the earlier the stronger the friction: the angle keeps it.
    end = J * rate / I3
    assert wheel["dry_friction"][2, 2] == pytest.approx(end**2 * LESS / (2 * friction**2), rel=1e-8)


def test_through_saturation() -> None:
    """While the motor is at its limit, ω̇ is limit/(I − J): from where it saturates, by energy."""
    speed, limit = 0.4, 0.3
    load = loads.wheel(ALONG, J, torque=loads.feedback(1.0, 0.0), max_torque=limit)
    run = PLAIN.simulate([0.0, 3.0], (0, 0, speed), load=load)
    found = run.sensitivity("differences")
    phi, omega = 2 * np.arctan2(run.quaternion[-1, 2], run.quaternion[-1, 3]), run.omega[-1, 2]
    edge = 2 * np.arcsin(limit)
    assert phi > edge
    # ½ (I − J) ω² + V(φ) is constant, V' = −limit beyond the edge: (I − J) (ω dω − ω₀ dω₀) + limit dφ = 0.
    by_speed = found.state[-1][:, 5]
    left = LESS * (omega * by_speed[5] - speed) + limit * by_speed[2]
    assert abs(left) < 1e-8
    # By the limit the potential changes too: V = V(edge) + limit (φ − edge).
    by_limit = found.load[0]["max_torque"][-1]
    left = LESS * omega * by_limit[5] + limit * by_limit[2] + (phi - edge)
    assert abs(left) < 1e-8


@pytest.mark.parametrize("name", ["damping", "torque", "sampled", "feedback", "magnetic", "motor", "wheel"])
@pytest.mark.parametrize(
    ("moment", "speed"),
    [(1.0, 1.0), pytest.param(2e-3, 0.1, marks=pytest.mark.long), (1e8, 1e-3), (1e-46, 1e12)],
)
@pytest.mark.parametrize("at_rest", [False, True])
def test_numbers_that_are_zero(name: str, moment: float, speed: float, at_rest: bool) -> None:
    """Nothing tells their scale: neither a molecule nor a space station is moved too far or too little."""
    body = RigidBody.from_principal(moment, moment * np.array([1.0, 1.4, 1.9]))
    times = T / speed
    load = {
        "damping": loads.damping(0.1 * moment * speed),
        "torque": loads.constant_torque((0, 0, 0), "space"),
        "sampled": loads.sampled([0.0, *times[1:], 2 * times[2]], np.zeros((4, 3)), "body"),
        "feedback": loads.feedback(0.0, 0.0),
        "magnetic": loads.magnetic((0, 0, 0), (0, 1e-5, 3e-5)),
        "motor": loads.wheel((0, 0.6, 0.8), 0.1 * moment, 0.0, torque=0.0),
        "wheel": loads.wheel((0, 0.6, 0.8), 0.1 * moment, 0.0),
    }[name]
    omega = np.zeros(3) if at_rest else speed * np.array([0.3, -0.2, 0.5])
    run = body.simulate(times, omega, load=load)
    found, exact = run.sensitivity("differences").load[0], run.sensitivity().load[0]
    assert found
    for number, got in found.items():
        series = exact[number].reshape(*got.shape[:2], -1)
        for part in (slice(0, 3), slice(3, 6), slice(6, None)):
            one, other = got.reshape(series.shape)[:, part], series[:, part]
            if other.any():
                near(one, other)
            else:  # of no effect
                unit = {"field": 3e-5, "inertia": 0.1 * moment}.get(number, 1.0)
                large = (1.0, speed, moment * speed)[part.start // 3]
                assert np.abs(one).max(initial=0.0) * unit < 1e-12 * large


@pytest.mark.parametrize("at", [0.0, 1e-3])
def test_numbers_that_must_not_be_negative(at: float) -> None:
    """Where they are zero their derivatives are by more of them."""
    for load, number in (
        (loads.wheel(ALONG, 0.2, 3.0, friction=at), "friction"),
        (loads.slug(0.3, at), "damping"),
    ):
        run = BODY.simulate(T, OMEGA, ATTITUDE, load=load)
        found, exact = run.sensitivity("differences").load[0], run.sensitivity().load[0]
        near(found[number], exact[number])
    # Of dry friction c₀ there is no series: (I − J) ω̇ = c₀ while the wheel turns.
    run = PLAIN.simulate([0.0, 2.0], (0, 0, 0), load=loads.wheel(ALONG, J, 10.0, dry_friction=at))
    (wheel,) = run.sensitivity("differences").load
    near(wheel["dry_friction"][:, 5], np.array([0.0, 2.0 / LESS]))
    near(wheel["dry_friction"][:, 6], np.array([0.0, -2.0]))


def test_what_does_not_settle_is_refused() -> None:
    """At the stop itself h has a corner by the rate of the wheel."""
    rate, friction = 10.0, 0.25
    stop = rate / (friction * (1 / J + 1 / LESS))
    load = loads.wheel(ALONG, J, rate, dry_friction=friction)
    run = PLAIN.simulate([0.0, stop], (0, 0, 0), load=load)
    with pytest.raises(PolhodeError, match=r"do not agree at t = 16\.6666.*a change of the law is too close"):
        run.sensitivity("differences")
    with pytest.raises(ValueError, match="'series' or 'differences'"):
        run.sensitivity("exact")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("at_limit", "within", "number", "slope"),
    [
        # A thruster: duties below zero are zero.
        (
            loads.thrusters([(1, 0, 0)], [(0, 1, 0)], [0.1], command=[0.0], period=0.5),
            loads.thrusters([(1, 0, 0)], [(0, 1, 0)], [0.1], command=[-0.5], period=0.5),
            "command",
            0.0,
        ),
        # A motor: (I − J) ω̇ = −τ.
        (
            loads.wheel(ALONG, J, torque=0.1, max_torque=0.1),
            loads.wheel(ALONG, J, torque=0.05, max_torque=0.1),
            "torque",
            -1.9 / LESS,
        ),
    ],
    ids=["thruster", "motor"],
)
def test_a_number_at_a_limit_of_the_law_has_no_derivative(
    at_limit: Any, within: Any, number: str, slope: float
) -> None:
    """There the slopes on the two sides differ, and central differences of every order have their mean."""
    times = [0.0, 1.9]
    (found,) = PLAIN.simulate(times, (0, 0, 0.02), load=at_limit).sensitivity("differences").load
    assert np.isnan(found[number][-1]).all()
    assert all(
        np.isfinite(values).all() for name, values in found.items() if name not in (number, "max_torque")
    )
    (found,) = PLAIN.simulate(times, (0, 0, 0.02), load=within).sensitivity("differences").load
    assert found[number][-1, 5] == pytest.approx(slope, abs=1e-8)


@pytest.mark.parametrize(
    ("corner", "is_smooth"), [(1.5e-5, True), (2e-5, False), (-1.5e-5, True), (-2e-5, False)]
)
def test_from_which_corner_on_there_is_no_derivative(corner: float, is_smooth: bool) -> None:
    """The sixth difference of a corner is six times that of the slopes; it may be 1e-4 of the derivative."""
    row: Any = SimpleNamespace(run=SimpleNamespace(t=np.array([1.0])), unmoved=np.zeros((1, 6)))

    def moved(steps: Any) -> Any:
        return ((steps + 0.5 * corner * np.abs(steps))[:, None, None]) * np.ones((1, 6))

    found = _Row.combine_differences(row, CENTRAL, moved, 1.0, "number")
    if is_smooth:
        assert found == pytest.approx(np.ones((1, 6)), rel=1e-12)
    else:
        assert np.isnan(found).all()
