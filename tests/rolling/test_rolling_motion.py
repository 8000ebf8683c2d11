"""Balls, cylinders and cones that roll in closed form, against Newton and Euler and against simulations."""

from __future__ import annotations

import pickle
from functools import cache
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf
from oracles.lying import DIGITS, LyingBody
from oracles.lying import motion as lying_motion
from oracles.rolling import motions
from polhode import RigidBody, RollingMotion, loads, rolling, solids
from polhode._core import rotate
from polhode.errors import ContactError, PolhodeError

RADIUS, MASS = 0.4, 1.5
BALL, SPHERE = solids.sphere(RADIUS, mass=MASS), rolling.sphere(RADIUS)
LEVEL, SLOPE = (0.0, 0.0, -9.81), (1.5, -0.8, -9.6)
PLANES = [(LEVEL, 0.0), (SLOPE, 0.0), (LEVEL, 1.7), (SLOPE, 1.7), (SLOPE, -0.02)]
OMEGA, ATTITUDE = (1.0, -2.0, 0.7), (0.1, 0.3, -0.2, 0.9273618495495703)


def ball(gravity: Any, turntable: float) -> RollingMotion:
    return BALL.rolling_motion(SPHERE, OMEGA, ATTITUDE, gravity, turntable)


def off(found: Any, exact: Any, sizes: Any = 1.0) -> float:
    """Return the largest difference of states (q, ω in space, C), relative to sizes."""
    exact = np.array(exact, dtype=float)
    sign = np.sign(exact[:4] @ found[:4])
    return float(np.max(np.abs(found - np.concatenate([sign * exact[:4], exact[4:]])) / sizes))


def flat(motion: Any) -> Any:
    omega = rotate(motion.quaternion, motion.omega)
    return np.concatenate([motion.quaternion, omega, motion.position], axis=-1)


# The ball


@cache
def balls_by_equations() -> Any:
    """Return the states after 3 s on each plane; more steps change no digit above 1e-15."""
    case = {
        "surface": {"kind": "sphere", "radius": RADIUS},
        "mass": MASS,
        "inertia": BALL.inertia.tolist(),
        "center_of_mass": [0.0, 0.0, 0.0],
        "normal": [0.0, 0.0, 1.0],
        "point": [0.0, 0.0, 0.0],
        "omega": OMEGA,
        "attitude": ATTITUDE,
        "t": 3.0,
    }
    return motions([case | {"gravity": gravity, "turntable": turntable} for gravity, turntable in PLANES], 24)


@pytest.mark.parametrize("number", range(len(PLANES)))
def test_a_ball_by_newtons_and_eulers_equations(number: int) -> None:
    sizes = np.array([1.0] * 4 + [15.0] * 3 + [10.0] * 3)
    assert off(flat(ball(*PLANES[number]).at(3.0)), balls_by_equations()[number], sizes) < 1e-14


@pytest.mark.parametrize(("gravity", "turntable"), PLANES)
def test_a_ball_by_a_simulation(gravity: Any, turntable: float) -> None:
    t = np.linspace(0, 12, 25)
    motion = ball(gravity, turntable)
    found: Any = motion.at(t)
    contact = rolling.plane(SPHERE, turntable=turntable)
    load = loads.uniform_gravity(gravity)
    run: Any = BALL.simulate(t, OMEGA, ATTITUDE, load=load, contact=contact, rtol=2.3e-15)
    far = 1 + np.max(np.abs(run.position))
    fast = 1 + np.max(np.abs(run.omega))
    assert np.max(np.abs(found.position - run.position)) < 1e-13 * far
    assert np.max(np.abs(found.velocity - run.velocity)) < 1e-13 * far
    turned = fast * t[-1]
    assert np.max(np.abs(found.quaternion - run.quaternion)) < 1e-14 * turned
    assert np.max(np.abs(found.omega - run.omega)) < 1e-14 * turned * fast
    assert np.max(np.abs(motion.force(t) - run.contact.force)) < 1e-12 * MASS * fast
    assert np.allclose(motion.pressure_at(t), run.contact.point, rtol=0, atol=1e-13 * far)
    assert not motion.tips(t).any()
    # The contact of the closed form is that of the simulation, with its extremes.
    assert np.allclose(found.contact.force, run.contact.force, rtol=0, atol=1e-12 * MASS * fast)
    most, least = found.contact.largest_friction_needed, found.contact.smallest_normal_force
    assert most.value == pytest.approx(run.contact.largest_friction_needed.value, rel=1e-12, abs=1e-14)
    assert most.value >= found.contact.friction_needed.max() - 1e-14
    assert least.value == pytest.approx(-MASS * gravity[2], rel=1e-13)
    if not turntable:
        assert found.invariants().energy_drift < 1e-14
    assert np.allclose(found.angular_acceleration(), run.angular_acceleration(), rtol=0, atol=1e-11 * fast)


def test_states_do_not_depend_on_the_others_and_go_back() -> None:
    for gravity, turntable in PLANES:
        motion = ball(gravity, turntable)
        t = np.array([[5.0, -3.0, 0.0], [20.0, 0.25, -11.0]])
        all_of_them = motion.at(t)
        assert all_of_them.omega.shape == (2, 3, 3)
        for index in np.ndindex(t.shape):
            one = motion.at(t[index])
            assert np.array_equal(one.quaternion, all_of_them.quaternion[index])
            assert np.array_equal(one.omega, all_of_them.omega[index])
        # Back from a later state: the plane there moves, unless it rests.
        if not turntable:
            last = motion.at(5.0)
            back = BALL.rolling_motion(SPHERE, last.omega, last.quaternion, gravity).at(-5.0)
            assert off(flat(back)[:7], flat(motion.at(0.0))[:7]) < 1e-13


def test_a_ball_on_a_turntable_after_a_million_circles() -> None:
    """ω comes back after 2π/(kΩ); the rotation of a period, to a power, is that of many periods."""
    motion = ball(LEVEL, 1.7)
    period = 2 * np.pi / (2 / 7 * 1.7)
    one, two, far = motion.at(period), motion.at(2 * period), motion.at(1e6 * period)
    assert np.allclose(two.position, (0, 0, RADIUS), rtol=0, atol=1e-14)
    assert np.allclose(far.position, (0, 0, RADIUS), rtol=0, atol=1e-8)
    turn = one.rotation * motion.at(0.0).rotation.inv()
    assert (two.rotation * (turn * turn * motion.at(0.0).rotation).inv()).magnitude() < 1e-14
    # The quaternion is continuous.
    many = motion.at(np.linspace(0, 5 * period, 12001)).quaternion
    assert np.min(np.sum(many[1:] * many[:-1], axis=1)) > 0.999


def test_a_time_beyond_reach_is_refused() -> None:
    with pytest.raises(PolhodeError, match=r"t = 100000\.0 is beyond the reach of this motion"):
        ball(SLOPE, 0.0).at([1.0, 1e5])
    assert np.isnan(ball(SLOPE, 0.0).at([np.nan, np.inf]).omega).all()


def test_stacks_of_balls() -> None:
    balls = RigidBody.stack([BALL, solids.sphere(RADIUS, mass=0.5)])
    motion = balls.rolling_motion(SPHERE, OMEGA, gravity=[LEVEL, SLOPE], turntable=0.5)
    found = motion.at([0.0, 1.0, 2.0])
    assert found.omega.shape == (2, 3, 3)
    assert found.contact is not None
    assert found.contact.largest_friction_needed.value.shape == (2,)
    one = balls[1].rolling_motion(SPHERE, OMEGA, gravity=SLOPE, turntable=0.5).at([0.0, 1.0, 2.0])
    assert np.array_equal(found.quaternion[1], one.quaternion)
    again = pickle.loads(pickle.dumps(motion))
    assert np.array_equal(again.at(1.0).omega, motion.at(1.0).omega)


# Cylinder and cone

SKEW = [[0.11, 0.01, 0.008], [0.01, 0.13, -0.012], [0.008, -0.012, 0.06]]
CONE = [[0.06, 0, 0], [0, 0.06, 0], [0, 0, 0.04]]
LYING = [
    ("cylinder", LEVEL, SKEW, 0.4, 3.0),
    ("cylinder", SLOPE, SKEW, 0.7, -2.0),
    ("cone", LEVEL, CONE, 0.6, 4.0),
    ("cone", SLOPE, CONE, 0.6, 1.0),
    ("cone", SLOPE, CONE, 0.5, 9.0),
]


def lying(kind: str, gravity: Any, inertia: Any, from_top: float, rate: float) -> tuple[Any, RollingMotion]:
    """Make a case and its motion; the top is at z = `from_top` of the body, whose C is at the origin."""
    radius, height = 0.35, 0.9
    middle = from_top - (0.5 if kind == "cylinder" else 0.75) * height
    body = RigidBody(2.0, inertia=inertia)
    surface = getattr(rolling, kind)(radius, height, center=(0, 0, middle))
    first, last = surface.line_of_contact((0.6, 0.8, 0.0))
    line = (last - first) / np.linalg.norm(last - first)
    # The line of contact along x of space, the normal along z.
    normal = np.array([0.6, 0.8, 0.0])
    normal -= (normal @ line) * line
    normal /= np.linalg.norm(normal)
    frame = np.array([line, np.cross(normal, line), normal])
    from scipy.spatial.transform import Rotation

    along = line if kind == "cone" else np.array([0.0, 0.0, 1.0])
    motion = body.rolling_motion(surface, rate * along, Rotation.from_matrix(frame), gravity)
    case = {"kind": kind, "mass": 2.0, "inertia": inertia, "radius": radius, "height": height}
    return case | {"from_top": from_top, "gravity": gravity}, motion


@pytest.mark.parametrize("row", LYING)
def test_force_and_pressure_of_lying_bodies(row: Any) -> None:
    """Each is that of the equations in 25 digits at the same state."""
    case, motion = lying(*row)
    for t in (0.0, 0.8, -1.7):
        with mp.workdps(DIGITS):
            state = [mpf(float(x)) for x in flat(motion.at(t))]
            force, pressure = LyingBody(case).pressure_from(state)
            rates, _, _ = LyingBody(case).solve(state)
        size = np.linalg.norm(motion.force(t))
        assert np.max(np.abs(motion.force(t) - np.array(force, dtype=float))) < 1e-13 * size
        assert np.max(np.abs(motion.pressure_at(t) - np.array(pressure, dtype=float))) < 2e-13
        assert np.allclose(motion.at(t).velocity, np.array(rates[7:], dtype=float), rtol=0, atol=1e-13)


@pytest.mark.parametrize(("row", "steps"), list(zip(LYING, (4, 4, 8, 6, 12), strict=True)))
def test_motions_of_lying_bodies(row: Any, steps: int) -> None:
    """The oracle takes the steps that it needs for errors of 1e-15, or 1e-12 for the cone that turns most."""
    case, motion = lying(*row)
    exact = lying_motion(case, flat(motion.at(0.0)), 1.0, steps)
    assert off(flat(motion.at(1.0)), exact, 10.0) < 1e-12


@pytest.mark.long
@pytest.mark.parametrize("row", LYING)
def test_motions_of_lying_bodies_for_longer(row: Any) -> None:
    case, motion = lying(*row)
    exact = lying_motion(case, flat(motion.at(0.0)), 5.0, 120)
    assert off(flat(motion.at(5.0)), exact, 10.0) < 1e-12


def test_a_cylinder_rolls_down_with_two_thirds() -> None:
    body = solids.cylinder(0.2, 1.0, mass=3.0)
    motion = body.rolling_motion(rolling.cylinder(0.2, 1.0), (0, 0, 0), gravity=(0, 6.0, -8.0))
    found = motion.at([0.0, 3.0])
    assert np.allclose(found.position[1], (0, 0.5 * 2 / 3 * 6.0 * 9, 0.2), rtol=0, atol=1e-14)
    assert np.allclose(motion.force(0.0), (0, -3.0 * 6.0 / 3, 24.0), rtol=0, atol=1e-13)
    assert np.allclose(motion.pressure_at(0.0), (0, 0, 0), rtol=0, atol=1e-15)
    # Along a slope it is held by friction, until its weight is beyond its end: tan α = h/(2 a).
    for lean, tips in ((2.49, False), (2.51, True)):
        motion = body.rolling_motion(rolling.cylinder(0.2, 1.0), (0, 0, 1), gravity=(lean, 0, -1.0))
        assert motion.tips(1.0) is tips or bool(motion.tips(1.0)) is tips
        assert motion.pressure_at(0.0)[0] == pytest.approx(0.2 * lean)


@pytest.mark.parametrize("ratio", [0.3, 1.0])
def test_where_a_cone_tips(ratio: float) -> None:
    """The centre of pressure s = d cos α + θ̇² cot α I_e/(m g) is at the rim, √(R² + h²) from the apex."""
    height, g = 0.4, 9.81
    radius = ratio * height
    body, surface = solids.cone(radius, height, mass=1.3), rolling.cone(radius, height)
    slant = np.hypot(radius, height)
    sin, cos, d = radius / slant, height / slant, 0.75 * height
    axial, across = body.inertia[2, 2], body.inertia[0, 0]
    about_line = axial * cos**2 + (across + body.mass * d**2) * sin**2
    turn = np.sqrt((slant - d * cos) * body.mass * g / (about_line * cos / sin))
    apex, rim = surface.line_of_contact((1, 0, 0))
    along = (rim - apex) / slant
    for factor, tips in ((1 - 1e-9, False), (1 + 1e-9, True)):
        motion = body.rolling_motion(surface, factor * turn * cos / sin * along, gravity=(0, 0, -g))
        found = motion.at([0.0, 5.0])
        assert found.position[0, 2] == pytest.approx(d * sin)
        assert bool(motion.tips(3.0)) is tips


def test_a_cone_on_a_slope_swings_with_the_period_of_its_pendulum() -> None:
    """For small angles 2π √(I_e cot²α/(m g_t d cos α)); it turns over and comes back after many rounds."""
    _, motion = lying("cone", (0.7, 0.0, -9.7), CONE, 0.6, 1e-4)
    sin, cos = 0.35 / np.hypot(0.35, 0.9), 0.9 / np.hypot(0.35, 0.9)
    about_line = 0.04 * cos**2 + (0.06 + 2.0 * 0.36) * sin**2
    rate = np.sqrt(2.0 * 0.7 * 0.6 * cos / (about_line * (cos / sin) ** 2))
    t = np.linspace(0, 10, 101)
    angle = np.arctan2(motion.at(t).position[:, 1], motion.at(t).position[:, 0])
    turn = -1e-4 * sin / cos
    assert np.max(np.abs(angle - turn / rate * np.sin(rate * t))) < 1e-6 * abs(turn / rate)
    _, motion = lying("cone", SLOPE, CONE, 0.6, 30.0)
    many = motion.at(np.linspace(-40, 40, 40001))
    assert np.min(np.sum(many.quaternion[1:] * many.quaternion[:-1], axis=1)) > 0.99
    energy = many.kinetic_energy().total - 2.0 * many.position @ np.array(SLOPE)
    assert np.ptp(energy) < 1e-11 * np.max(energy)


def test_what_a_line_of_contact_does_not_tell() -> None:
    _, motion = lying(*LYING[0])
    found = motion.at([0.0, 1.0])
    assert found.contact is None
    assert found.invariants().energy is None
    for call in (found.torque, found.angular_acceleration):
        with pytest.raises(ValueError, match="a plane acts on this motion along a line of contact"):
            call()
    with pytest.raises(ValueError, match="a plane acts"):
        found.resume([1.0, 2.0])


# What is refused


@pytest.mark.parametrize(
    ("error", "words", "given"),
    [
        (ContactError, "three moments of a ball are equal", {"body": solids.box((1, 2, 3), mass=1.0)}),
        (
            ContactError,
            "centre of mass of a ball is at its centre",
            {"surface": rolling.sphere(0.4, (0.1, 0, 0))},
        ),
        (ContactError, "known of a sphere, a cylinder and a cone", {"surface": rolling.disk(0.4)}),
        (PolhodeError, "third component is negative", {"gravity": (0, 0, 1.0)}),
        (PolhodeError, "turntable must be zero for", {"surface": rolling.cylinder(1, 1), "turntable": 1.0}),
        (PolhodeError, "omega must be along the line", {"surface": rolling.cylinder(1, 1)}),
        (
            PolhodeError,
            "attitude must be one in which",
            {"surface": rolling.cone(1, 1), "attitude": (0, 0, 0, 1)},
        ),
        (ContactError, "on its axis", {"surface": rolling.cylinder(1, 1, center=(0.1, 0, 0))}),
        (
            ContactError,
            "moments of a cone across its axis",
            {"body": solids.box((1, 2, 3), mass=1.0), "surface": rolling.cone(1, 1), "omega": (0, 0, 0)},
        ),
        (ValueError, "surface: expected rolling.sphere", {"surface": 0.5}),
    ],
)
def test_motions_without_closed_form_are_refused(error: Any, words: str, given: dict[str, Any]) -> None:
    arguments: dict[str, Any] = {"surface": SPHERE, "omega": OMEGA} | given
    body = arguments.pop("body", BALL)
    with pytest.raises(error, match=words):
        body.rolling_motion(**arguments)


def test_ruled_surfaces() -> None:
    for surface in (rolling.cylinder(0.5, 2, (1, 0, 0)), rolling.cone(0.5, 2, center=(0, 0, 1))):
        again = pickle.loads(pickle.dumps(surface))
        assert repr(again) == repr(surface)
    lines = rolling.cone(0.5, 2).line_of_contact(np.ones((4, 5, 3)))
    assert lines.shape == (4, 5, 2, 3)
    assert np.isnan(rolling.cone(0.5, 2).line_of_contact((0, 0, 1))).any()
    cone: Any = rolling.cone(0.5, 2)
    with pytest.raises(ValueError, match="touches a plane along a line"):
        rolling.plane(cone)
    with pytest.raises(PolhodeError, match="height must be a positive length"):
        rolling.cylinder(1.0, -1.0)
