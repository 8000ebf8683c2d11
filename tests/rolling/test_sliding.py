"""Bodies that slip on a plane: a ball in closed form, laws of friction, Painlevé's paradox, resistance."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from polhode import Event, RigidBody, loads, rolling, solids
from polhode.errors import ContactError, PolhodeError

WEIGHT = 9.81
G = loads.uniform_gravity((0, 0, -WEIGHT))
RADIUS, MASS = 0.2, 3.0
BALL = solids.sphere(RADIUS, mass=MASS)
SPHERE = rolling.sphere(RADIUS)
OMEGA, VELOCITY = np.array([3.0, -8.0, 5.0]), np.array([4.0, 1.5, 0.0])
SLIP = VELOCITY + np.cross(OMEGA, [0, 0, -RADIUS])


def slide(t: Any, omega: Any = OMEGA, velocity: Any = VELOCITY, body: Any = BALL, **law: Any) -> Any:
    surface = law.pop("surface", SPHERE)
    options = {name: law.pop(name) for name in ("attitude", "events", "rtol", "position") if name in law}
    contact = rolling.plane(surface, **({"law": "sliding"} | law))
    given: Any = {"load": G, "contact": contact, "rtol": 1e-14} | options
    return body.simulate(t, omega, velocity=velocity, **given)


# A ball: the slip keeps its direction and falls with 7/2 of the acceleration of friction.


def test_coulombs_friction_stops_the_slip() -> None:
    mu, speed = 0.1, np.linalg.norm(SLIP)
    end = 2 * speed / (7 * mu * WEIGHT)
    t = np.linspace(0, 2 * end, 21)
    found = slide(t, friction=mu)
    assert found.status == "roll"
    assert found.events.kind.tolist() == ["roll"]
    assert found.events.t[0] == pytest.approx(end, abs=1e-13)
    before = t < end
    along = SLIP / speed
    velocity = VELOCITY - mu * WEIGHT * t[before, None] * along
    place = np.array([0, 0, RADIUS]) + t[before, None] * (VELOCITY + velocity) / 2
    assert np.max(np.abs(found.velocity[before] - velocity)) < 1e-13
    assert np.max(np.abs(found.position[before] - place)) < 1e-13
    slip = SLIP - 3.5 * mu * WEIGHT * t[before, None] * along
    assert np.max(np.abs(found.contact.slip[before] - slip)) < 1e-13
    force = MASS * WEIGHT * (np.array([0, 0, 1.0]) - mu * along)
    assert np.max(np.abs(found.contact.force[before] - force)) < 1e-12
    assert np.max(np.abs(found.contact.power[before] - slip @ force)) < 1e-11
    work = np.cumsum([0, *(slip[1:] + slip[:-1]) @ force / 2 * t[1]])
    assert np.max(np.abs(found.contact.work[before] - work)) < 1e-12
    assert found.contact.phase.tolist() == ["sliding" if one else "" for one in before]
    assert found.contact.largest_friction_needed.value == pytest.approx(mu, rel=1e-13)
    assert np.isnan(found.omega[~before]).all()


@pytest.mark.parametrize(("viscous", "rate"), [(("normal", 0.03), 0.03 * WEIGHT), (0.9, 0.9 / MASS)])
def test_viscous_friction_damps_the_slip(viscous: Any, rate: float) -> None:
    t = np.linspace(0, 6, 13)
    found = slide(t, viscous=viscous)
    assert found.status == "complete"
    exact = SLIP * np.exp(-3.5 * rate * t)[:, None]
    assert np.max(np.abs(found.contact.slip - exact)) < 1e-13
    # Of the slip that is lost, C loses 2/7 in speed.
    assert np.max(np.abs(found.velocity - VELOCITY - 2 / 7 * (exact - SLIP))) < 1e-13
    assert np.max(np.abs(found.contact.force[:, :2] + MASS * rate * exact[:, :2])) < 1e-12
    assert found.invariants().energy_drift < 1e-14


def test_a_smooth_plane_pushes_along_its_normal_alone() -> None:
    body = RigidBody.from_principal(1.0, (0.02, 0.03, 0.04), center_of_mass=(0.02, 0.01, -0.03))
    t = np.linspace(0, 5, 51)
    found = slide(t, (2.0, 1.0, 3.0), (1.0, -2.0, 0.0), body, friction=0.0, lift="hold", position=None)
    assert np.max(np.abs(found.velocity[:, :2] - [1.0, -2.0])) < 1e-13
    assert np.max(np.abs(found.contact.force[:, :2])) < 1e-14
    assert np.max(np.abs(found.contact.work)) < 1e-13
    assert found.invariants().energy_drift < 1e-14
    assert np.max(np.abs(found.contact.residual)) < 1e-14


@pytest.mark.parametrize("friction", [{"friction": 0.05}, {"viscous": ("normal", 0.4)}, {"viscous": 0.3}])
def test_friction_of_any_kind_keeps_jelletts_constant(friction: Any) -> None:
    top = RigidBody.from_principal(1.0, (0.08, 0.08, 0.13), center_of_mass=(0, 0, -0.05))
    given: dict[str, Any] = {"attitude": (np.sin(0.2), 0, 0, np.cos(0.2)), "surface": rolling.sphere(0.5)}
    t = np.linspace(0, 2, 41)
    omega, velocity = np.array([0.3, 0.2, 30.0]), np.array([2.0, 0.0, 0.0])
    start = top.simulate([0, 1e-9], omega, given["attitude"], load=G, contact=rolling.plane(given["surface"]))
    found = slide(t, omega, start.velocity[0] + velocity, top, **given, **friction)
    kept = found.invariants()
    last = found.status == "complete"
    assert last or found.status == "roll"
    assert kept.jellett_drift < 1e-13
    assert kept.energy_drift < 1e-14


def test_sliding_goes_back_on_and_in_stacks() -> None:
    found = slide([0, 1, 2], friction=0.02)
    both = slide([0, 1, 2], np.array([OMEGA, 2 * OMEGA]), friction=0.02)
    assert np.array_equal(both.omega[0], found.omega)
    assert both.contact.phase.shape == (2, 3)
    again = slide([0, 1], friction=0.02).resume([1, 2], rtol=1e-14)
    assert np.allclose(again.position[-1], found.position[-1], rtol=0, atol=1e-13)
    last = found.state()
    back = slide(
        [2, 0], last.omega, last.velocity, friction=0.02, attitude=last.attitude, position=last.position
    )
    assert np.allclose(back.velocity[-1], VELOCITY, rtol=0, atol=1e-12)
    assert np.allclose(back.omega[-1], OMEGA, rtol=0, atol=1e-12)


def test_events_of_functions_come_before_that_of_the_contact() -> None:
    def at(_: float, *state: Any) -> float:
        return float(np.linalg.norm(state[3] - VELOCITY) - 0.1 * WEIGHT)

    found = slide([0, 9], friction=0.1, events=Event(at))
    assert found.events.kind.tolist() == ["function", "roll"]
    assert found.events.t[0] == pytest.approx(1.0, abs=1e-12)
    found = slide([0, 9], friction=0.1, events=Event(at, terminal=True))
    assert found.status == "event"
    assert found.events.event.tolist() == [0]


# Painlevé's paradox: a rod that slips on its end, 1 + 3 cos θ (cos θ − μ sin θ) for one without thickness.


def rod(angle: float, mu: float, turning: float, end: float, **given: Any) -> Any:
    """Simulate a rod of length 2 on a small ball at its end, which slips toward +x and leans back."""
    body = RigidBody.from_principal(1.0, (1 / 3, 1 / 3, 1e-3))
    radius = 1e-6
    surface = rolling.sphere(radius, center=(0, 0, -1.0))
    half = (np.pi / 2 - angle) / 2
    attitude = (0, np.sin(half), 0, np.cos(half))
    omega = (0, turning, 0)
    contact = rolling.plane(surface, law="sliding", friction=mu)
    at_rest = body.simulate([0, 1e-9], omega, attitude, load=G, contact=rolling.plane(surface, lift="hold"))
    velocity = at_rest.velocity[0] + given.pop("slip", np.array([-20.0, 0, 0]))
    return body.simulate([0, end], omega, attitude, velocity=velocity, load=G, contact=contact, **given)


def test_where_no_force_keeps_the_body_it_says_so() -> None:
    # tan θ = 2 is the worst angle: there the paradox begins at μ = 4/3.
    angle = float(np.arctan(2))
    assert rod(angle, 1.3, 0.0, 1e-6).status == "complete"
    with pytest.raises(ContactError, match=r"no unique force at t = 0\.0: .*Painleve"):
        rod(angle, 1.4, 0.0, 1e-6)
    # With the slip the other way friction helps.
    assert rod(angle, 1.4, 0.0, 1e-6, slip=np.array([20.0, 0, 0])).status == "complete"


def test_a_rod_falls_into_the_paradox_or_lifts_off_before() -> None:
    for turning in (0.0, 0.5, 1.0, 2.0):
        try:
            found = rod(1.4, 1.6, turning, 2.0)
        except ContactError as error:
            assert "no unique force at t = 0." in str(error)  # noqa: PT017
        else:
            assert found.status in ("lift-off", "roll")


# What is refused


def test_laws_that_are_refused() -> None:
    plane: Any = rolling.plane
    cases: list[tuple[dict[str, Any], str]] = [
        ({"friction": 0.1}, "takes whatever friction it needs"),
        ({"law": "sliding"}, "exactly one of friction and viscous"),
        ({"law": "sliding", "friction": 0.1, "viscous": 1.0}, "exactly one of friction and viscous"),
        ({"law": "dry"}, "needs the coefficient friction"),
        ({"law": "dry", "friction": 0.1, "viscous": 1.0}, "no viscous one"),
        ({"law": "slippery"}, 'law: expected "rolling", "sliding" or "dry"'),
        ({"law": "sliding", "viscous": ("along", 1.0)}, "viscous: expected a number"),
        ({"law": "sliding", "viscous": "thick"}, "viscous: expected a number"),
    ]
    for given, words in cases:
        with pytest.raises(ValueError, match=words):
            plane(SPHERE, **given)
    for given in (
        {"friction": -0.1},
        {"friction": np.nan},
        {"viscous": -1.0},
        {"viscous": ("normal", np.inf)},
    ):
        with pytest.raises(PolhodeError, match=r"friction|viscous"):
            plane(SPHERE, law="sliding", **given)
    with pytest.raises(ContactError, match="has no cone of friction"):
        plane(SPHERE, law="dry", friction=0.1, lift="hold")


def test_starts_that_are_refused() -> None:
    with pytest.raises(ContactError, match=r"the contact moves off the plane with 0\.1"):
        slide([0, 1], velocity=(1, 0, 0.1), friction=0.1)
    with pytest.raises(ContactError, match=r"the contact moves into the plane with 0\.1"):
        slide([0, 1], velocity=(1, 0, -0.1), viscous=1.0)
    with pytest.raises(ContactError, match="has no direction without a velocity of slip"):
        slide([0, 1], velocity=None, friction=0.1)
    with pytest.raises(ContactError, match="hovers"):
        slide([0, 1], position=(0, 0, 1), friction=0.1)
    flat = RigidBody.from_principal(1.0, (0.1, 0.1, 0.0))
    with pytest.raises(ContactError, match="a body with three moments"):
        slide([0, 1], body=flat, friction=0.1)


@pytest.mark.parametrize(
    "law",
    [
        {"law": "sliding", "friction": 0.25},
        {"law": "sliding", "viscous": 0.5},
        {"law": "sliding", "viscous": ("normal", 0.5)},
        {"law": "dry", "friction": 0.25},
    ],
)
def test_contacts_with_a_law_are_pickled_and_printed(law: Any) -> None:
    contact = rolling.plane(SPHERE, **law)
    again = pickle.loads(pickle.dumps(contact))
    assert repr(again) == repr(contact)
    assert (again.law, again.friction, again.viscous) == (contact.law, contact.friction, contact.viscous)
    assert again.law == law["law"]
    assert eval(repr(contact), {"rolling": rolling}).friction == contact.friction


# Resistance to rolling and pivoting, of a ball


def test_an_arm_stops_a_ball() -> None:
    """The couple e N slows a ball that rolls with 5 e g/(7 a)."""
    arm, rate = 0.01, 20.0
    contact = rolling.plane(SPHERE, resistance=rolling.resistance(arm=arm))
    slower = 5 * arm * WEIGHT / (7 * RADIUS)
    speed = rate * RADIUS
    found: Any = BALL.simulate(np.linspace(0, 30, 31), (0, rate, 0), load=G, contact=contact, rtol=2.3e-15)
    assert found.status == "rest"
    assert found.events.kind.tolist() == ["rest"]
    assert found.events.t[0] == pytest.approx(speed / slower, abs=1e-12)
    assert found.events.position[0] == pytest.approx([speed**2 / (2 * slower), 0, RADIUS], abs=1e-12)
    assert found.contact.couple[0] == pytest.approx([0, -arm * MASS * WEIGHT, 0], abs=1e-13)
    there = ~np.isnan(found.omega[:, 0])
    assert found.contact.power[there] == pytest.approx(
        found.contact.couple[there, 1] * found.velocity[there, 0] / RADIUS, abs=1e-12
    )
    assert found.invariants().energy_drift < 1e-14


def test_viscous_resistance_and_pivoting_decay() -> None:
    viscous, pivoting, t = 0.03, 0.002, np.linspace(0, 5, 11)
    contact = rolling.plane(SPHERE, resistance=rolling.resistance(viscous, pivoting))
    found: Any = BALL.simulate(t, (3.0, 20.0, 7.0), load=G, contact=contact, rtol=2.3e-15)
    moment = 0.4 * MASS * RADIUS**2
    slow = np.exp(-viscous * t / (moment + MASS * RADIUS**2))
    exact = np.outer(slow, RADIUS * np.array([20.0, -3.0]))
    assert np.max(np.abs(found.velocity[:, :2] - exact)) < 1e-13
    spin = moment * 7.0 * np.exp(-pivoting * t / moment)
    assert np.max(np.abs(found.angular_momentum().spin[:, 2] - spin)) < 1e-13
    assert found.invariants().energy_drift < 1e-14


def test_an_arm_turns_a_ball_that_slips() -> None:
    """I ω̇ = m g (μ a − e) while its slip lasts."""
    mu, arm = 0.2, 0.03
    found = slide([0, 0.2], (0, 5.0, 0), (4.0, 0, 0), friction=mu, resistance=rolling.resistance(arm=arm))
    rate = 5.0 + WEIGHT * (mu * RADIUS - arm) / (0.4 * RADIUS**2) * 0.2
    assert found.omega[-1] == pytest.approx([0, rate, 0], abs=1e-12)
    assert found.velocity[-1] == pytest.approx([4 - mu * WEIGHT * 0.2, 0, 0], abs=1e-13)
    assert found.invariants().energy_drift < 1e-14


def test_resistances_that_are_refused() -> None:
    with pytest.raises(PolhodeError, match="arm"):
        rolling.plane(SPHERE, resistance=rolling.resistance(arm=-0.1))
    with pytest.raises(PolhodeError, match="pivoting"):
        rolling.plane(SPHERE, resistance=rolling.resistance(pivoting=np.nan))
    plane: Any = rolling.plane
    with pytest.raises(ValueError, match=r"resistance: expected one of rolling\.resistance"):
        plane(SPHERE, resistance=0.1)
    contact = rolling.plane(SPHERE, resistance=rolling.resistance(arm=0.1))
    with pytest.raises(ContactError, match="an omega with a part along the plane"):
        BALL.simulate([0, 1], (0, 0, 3), load=G, contact=contact)
    again = pickle.loads(pickle.dumps(contact))
    assert again.resistance == contact.resistance == rolling.resistance(arm=0.1)
    assert repr(again) == repr(contact)
    assert rolling.plane(SPHERE).resistance is None
