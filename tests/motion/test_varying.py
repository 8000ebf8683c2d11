"""Bodies that change with time, against closed forms and SciPy's integrators."""

from __future__ import annotations

import itertools
import pickle
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from polhode import RigidBody, Trajectory, Uncertain, loads, solids
from polhode.errors import IntegrationError
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

Floats = NDArray[np.float64]
TIMES = np.linspace(0.0, 4.0, 5)
FINE = np.linspace(0.0, 4.0, 41)


def turned(motion: Trajectory) -> Any:
    """Return the angle about z that a body has turned by, without jumps."""
    return np.unwrap(2.0 * np.arctan2(motion.quaternion[..., 2], motion.quaternion[..., 3]), period=2 * np.pi)


def close(found: Any, exact: Any, bar: float = 1e-12) -> None:
    size = np.abs(exact).max()
    assert np.abs(found - exact).max() <= bar * (size or 1.0)


def run(body: Any, omega: Any, **options: Any) -> Trajectory:
    motion: Trajectory = body.simulate(FINE, omega, rtol=1e-13, **options)
    return motion


def about_z(moment: Any) -> RigidBody:
    """Return bodies with these moments about z."""
    moment = np.asarray(moment)
    side = 0.7 * moment
    return RigidBody.from_principal(2.0, np.stack([side, side, moment], axis=-1))


def test_a_rod_that_shrinks() -> None:
    length, speed = 2.0, 0.3
    rods = solids.cylinder(0.05, length - speed * TIMES, mass=3.0)
    rod = RigidBody.varying(TIMES, rods)
    motion = run(rod, (1.5, 0.0, 0.0))
    moment = rod.at(FINE).inertia[:, 0, 0]
    close(moment, 3.0 * (3 * 0.05**2 + (length - speed * FINE) ** 2) / 12.0)
    close(motion.omega[:, 0], 1.5 * moment[0] / moment)
    close(motion.angular_momentum().spin, motion.angular_momentum().spin[0])
    thin = np.sqrt(3.0) * 0.05  # ∫ dt/(a² + l²), with l falling
    arc = np.arctan(length / thin) - np.arctan((length - speed * FINE) / thin)
    angle = 1.5 * moment[0] * 12.0 / 3.0 * arc / (speed * thin)
    close(Rotation.from_rotvec(np.outer(angle, [1, 0, 0])).as_quat(), motion.quaternion * np.sign(
        np.sum(motion.quaternion * Rotation.from_rotvec(np.outer(angle, [1, 0, 0])).as_quat(), axis=1)
    )[:, None])  # fmt: skip


def test_a_skater_draws_the_arms_in() -> None:
    moment = 3.0 - 0.4 * FINE
    motion = run(RigidBody.varying([0, 4], about_z([3.0, 1.4])), (0, 0, 2.0))
    close(motion.omega[:, 2], 6.0 / moment)
    close(turned(motion), 6.0 / 0.4 * np.log(3.0 / moment))


@pytest.mark.parametrize("backward", [False, True])
def test_a_tumbling_cylinder_is_damped_by_its_jet(backward: bool) -> None:
    grain = solids.cylinder(0.1, 1.0, mass=10.0 - TIMES)
    rocket = RigidBody.varying(TIMES, grain, outlet=(0, 0, -0.5))
    power = 0.25 / ((3 * 0.1**2 + 1.0) / 12.0) - 1.0
    share = (10.0 - FINE) / 10.0
    exact = 0.8 * share**power
    if backward:
        motion = rocket.simulate(FINE[::-1], (0.0, exact[-1], 0.0), rtol=1e-13)
        close(motion.omega[::-1, 1], exact)
    else:
        motion = run(rocket, (0.0, 0.8, 0.0))
        close(motion.omega[:, 1], exact)
        angle = 8.0 / (power + 1.0) * (1.0 - share ** (power + 1.0))
        close(2.0 * np.arctan2(motion.quaternion[:, 1], motion.quaternion[:, 3]), angle)


@pytest.mark.parametrize("radius", [0.0, 0.04, 0.1 / np.sqrt(2.0), 0.1])
def test_the_spin_of_a_burning_cylinder(radius: float) -> None:
    # Nozzles on a ring take a² of each kilogram; the radius of gyration leaves the spin as it is.
    grain = solids.cylinder(0.1, 1.0, mass=10.0 - TIMES)
    ring = [
        (radius * np.cos(a), radius * np.sin(a), -0.5)
        for a in (0.3, 0.3 + 2 * np.pi / 3, 0.3 - 2 * np.pi / 3)
    ]
    motion = run(RigidBody.varying(TIMES, grain, outlet=ring), (0, 0, 5.0))
    power = radius**2 / (0.1**2 / 2.0) - 1.0
    close(motion.omega[:, 2], 5.0 * ((10.0 - FINE) / 10.0) ** power)
    close(turned(motion)[-1], 5.0 * quad(lambda t: ((10.0 - t) / 10.0) ** power, 0, 4, epsabs=1e-14)[0])


def test_a_motor_spins_up_a_boom() -> None:
    reach = 0.5 + 0.25 * TIMES
    boom = RigidBody.varying(TIMES, about_z(2.0 + 2 * 0.3 * reach**2))
    motion = run(boom, (0, 0, 0.1), load=loads.constant_torque((0, 0, 0.7)))
    moment = 2.0 + 0.6 * (0.5 + 0.25 * FINE) ** 2
    close(motion.omega[:, 2], (moment[0] * 0.1 + 0.7 * FINE) / moment)
    spent = motion.angular_momentum().spin[:, 2] - 0.7 * FINE
    close(spent, spent[0])


def test_a_body_that_contracts_alike_in_all_directions() -> None:
    # With I = s I₀ and u = s ω: I₀ u' + u × I₀ u = 0 in the time τ = ∫ dt/s.
    first = RigidBody.from_principal(2.0, (1.0, 1.6, 2.1), Rotation.from_rotvec([0.3, -0.8, 0.5]).as_matrix())
    start, attitude = (0.4, 1.1, -0.6), Rotation.from_rotvec([1.0, 0.2, -0.4]).as_quat()
    rate = -0.15
    sizes = 1.0 + rate * TIMES
    body = RigidBody.varying(TIMES, RigidBody(2.0, first.inertia * sizes[:, None, None]))
    motion = run(body, start, attitude=attitude)
    size = 1.0 + rate * FINE
    free = first.free_motion(start, attitude).at(np.log(size) / rate)
    close(motion.omega, free.omega / size[:, None])
    close(motion.quaternion, free.quaternion)


def test_mass_that_leaves_everywhere_leaves_the_motion_as_it_is() -> None:
    # Outlets with the second moment of the body: each kilogram takes what it has.
    body = RigidBody.from_principal(3.0, (1.0, 1.6, 2.1))
    second = 0.5 * np.trace(body.inertia) * np.eye(3) - body.inertia
    places = [sign * np.sqrt(3.0 * second[k, k] / 3.0) * np.eye(3)[k] for k in range(3) for sign in (1, -1)]
    shares = 1.0 - 0.12 * TIMES
    melting = RigidBody.varying(
        TIMES, RigidBody(3.0 * shares, body.inertia * shares[:, None, None]), outlet=places
    )
    motion = run(melting, (0.4, 1.1, -0.6))
    free = body.free_motion((0.4, 1.1, -0.6)).at(FINE)
    close(motion.omega, free.omega)
    close(motion.quaternion, free.quaternion)


def test_a_symmetric_top_whose_side_grows() -> None:
    across, along, spin = 1.0 + 0.5 * TIMES, 1.5, 2.0
    tops = RigidBody.from_principal(1.0, np.stack([across, across, np.full(5, along)], axis=-1))
    motion = run(RigidBody.varying(TIMES, tops), (0.3, 0.0, spin))
    now = 1.0 + 0.5 * FINE
    # ω turns in the body at (I_s − I_t) ω₃/I_t: a moment that changes alone takes no angular momentum.
    phase = spin * (along * np.log(now) / 0.5 - FINE)
    close(motion.omega[:, 2], np.full(41, spin))
    close(motion.omega[:, 0], 0.3 / now * np.cos(phase))
    close(motion.omega[:, 1], 0.3 / now * np.sin(phase))


def test_the_rocket_equation() -> None:
    rocket = RigidBody.varying(TIMES, solids.sphere(0.2, mass=10.0 - 2.0 * TIMES), outlet=(0, 0, 0))
    motion = run(rocket, (0, 0, 0), load=loads.constant_force((6.0, 0, 0)), velocity=(1.0, 0, 0))
    mass = 10.0 - 2.0 * FINE
    close(motion.velocity[:, 0], 1.0 + 3.0 * np.log(10.0 / mass))
    close(motion.position[:, 0], FINE + 3.0 * (FINE - mass / 2.0 * np.log(10.0 / mass)))
    close(motion.force()[:, 0], np.full(41, 6.0))


def test_what_burns_falls_no_faster() -> None:
    rocket = RigidBody.varying(TIMES, solids.sphere(0.2, mass=10.0 - 2.0 * TIMES), outlet=(0, 0, -0.2))
    motion = run(rocket, (0, 0, 1.0), load=loads.uniform_gravity((0, 0, -9.81)))
    close(motion.position[:, 2], -0.5 * 9.81 * FINE**2)
    close(motion.force()[:, 2], -9.81 * (10.0 - 2.0 * FINE))


@pytest.mark.parametrize("frame", ["body", "space"])
def test_the_arm_of_a_force_begins_at_the_present_centre(frame: Any) -> None:
    # The centre moves along x; a force along y of the body at the origin has the arm −c(t).
    center = np.stack([0.1 + 0.05 * TIMES, 0 * TIMES, 0 * TIMES], axis=-1)
    bodies = RigidBody(2.0, np.diag([1.0, 1.5, 1.8]), center)
    push = loads.constant_force((0, 0.9, 0), frame=frame, point=(0, 0, 0))
    if frame == "space":
        motion = RigidBody.varying(TIMES, bodies).simulate([0, 1e-4], (0, 0, 0), load=push, rtol=1e-13)
        close(motion.torque()[0], [0, 0, -0.09], 1e-14)
        return
    motion = run(RigidBody.varying(TIMES, bodies), (0, 0, 0.2), load=push)
    turn = -0.9 * (0.1 * FINE + 0.025 * FINE**2)
    close(motion.omega[:, 2], 0.2 + turn / 1.8)
    close(motion.about[:, 0], 0.1 + 0.05 * FINE)
    close(motion.point("center_of_mass"), motion.position)
    close(motion.point("origin"), motion.position - in_space(motion, motion.about))


def in_space(motion: Trajectory, vectors: Floats) -> Floats:
    return np.asarray(Rotation.from_quat(motion.quaternion).apply(vectors))


def test_a_pendulum_that_is_drawn_in() -> None:
    length = 1.0 - 0.1 * TIMES
    bobs = RigidBody(2.0, np.diag([1e-3, 1e-3, 1e-3]), np.stack([0 * length, 0 * length, -length], axis=-1))
    weight = loads.uniform_gravity((0, 0, -9.81))
    tilted = Rotation.from_rotvec([0.6, 0, 0]).as_quat()
    motion = run(RigidBody.varying(TIMES, bobs), (0, 0, 0), attitude=tilted, load=weight, about="origin")

    def equations(t: float, y: Floats) -> list[float]:
        drawn = 1.0 - 0.1 * t
        return [y[1] / (1e-3 + 2.0 * drawn**2), -2.0 * 9.81 * drawn * np.sin(y[0])]

    exact = solve_ivp(equations, (0, 4), (0.6, 0.0), "DOP853", FINE, rtol=1e-13, atol=1e-13)
    close(2.0 * np.arctan2(motion.quaternion[:, 0], motion.quaternion[:, 3]), exact.y[0], 1e-10)
    close(motion.angular_momentum().spin[:, 0], exact.y[1], 1e-10)
    # Without weight the angular momentum about the fixed point is kept.
    still = run(RigidBody.varying(TIMES, bobs), (0.8, 0, 0), about="origin")
    close(still.omega[:, 0] * (1e-3 + 2.0 * (1.0 - 0.1 * FINE) ** 2), np.full(41, 0.8 * 2.001))


def test_a_wheel_in_a_boom_that_opens() -> None:
    wheel = loads.wheel((0, 0, 1), inertia=0.2, torque=0.05)  # the torque on the wheel
    motion = run(RigidBody.varying(TIMES, about_z(2.0 + 0.5 * TIMES)), (0, 0, 0.3), load=wheel)
    momentum = motion.states["wheel"][:, 0]
    close(momentum, 0.2 * 0.3 + 0.05 * FINE)
    total = 1.8 * 0.3 + momentum[0]
    close(motion.omega[:, 2], (total - momentum) / (2.0 + 0.5 * FINE - 0.2))
    close(motion.angular_momentum().spin[:, 2], np.full(41, total))


@cache
def by_scipy(seed: int, about: Any) -> tuple[Any, Any, Floats, Floats, Floats]:
    """Return a body and a load, the start, and by SciPy the state at 3 s and its slope."""
    draw = np.random.default_rng(seed)
    knots = np.sort(np.concatenate([[0.0, 3.0], draw.uniform(0.3, 2.7, 4)]))
    points = draw.normal(size=(6, 3)) * 0.4 + [0.5, 0.2, -0.3]
    masses = 1.5 - 0.2 * knots + 0.05 * np.cos(draw.uniform(0, 6, 6)[:, None] + 0.7 * knots)
    moving = points[:, None] + 0.1 * np.sin(knots)[:, None] * draw.normal(size=(6, 1, 3))
    bodies = RigidBody.stack([RigidBody.from_particles(masses[:, k], moving[:, k]) for k in range(6)])
    outlet = draw.normal(size=3)
    torque, push, damping = draw.normal(size=3), draw.normal(size=3), 0.2
    load = (
        loads.constant_torque(torque)
        + loads.constant_force(push, frame="body", point=(0.1, -0.2, 0.3))
        + loads.damping(damping)
    )
    # The additive moments about another origin than ours, by SciPy's spline.
    place = np.array([0.3, -0.1, 0.2])
    away = moving - place
    parts = np.concatenate([
        masses.sum(axis=0)[:, None],
        np.einsum("nk,nki->ki", masses, away),
        np.einsum("nk,nki,nkj->kij", masses, away, away).reshape(6, 9),
    ], axis=1)  # fmt: skip
    spline = CubicSpline(knots, parts)

    def tensor(numbers: Floats, point: Any) -> Any:
        second = numbers[4:].reshape(3, 3)
        first, shift = numbers[1:4], point - place
        about_point = (
            second - np.outer(first, shift) - np.outer(shift, first) + numbers[0] * np.outer(shift, shift)
        )
        return np.trace(about_point) * np.eye(3) - about_point

    def equations(t: float, y: Floats) -> Floats:
        numbers, rates = spline(t), spline(t, 1)
        center = place + numbers[1:4] / numbers[0]
        point = center if about == "center_of_mass" else np.zeros(3)
        inertia = tensor(numbers, point)
        rate = tensor(rates, point)  # of a centre that moves too: about it the tensor is the least
        omega, r = y[4:7], outlet - point
        turn = torque + np.cross(np.array([0.1, -0.2, 0.3]) - point, push) - damping * omega
        turn += rates[0] * np.cross(r, np.cross(omega, r)) - rate @ omega - np.cross(omega, inertia @ omega)
        q = Rotation.from_quat(y[:4])
        x, w = y[:3], y[3]
        slope = 0.5 * np.concatenate([w * omega + np.cross(x, omega), [-x @ omega]])
        return np.concatenate([slope, np.linalg.solve(inertia, turn), y[10:13], q.apply(push) / numbers[0]])

    start = np.concatenate([[0, 0, 0, 1], draw.normal(size=3), np.zeros(6)])
    varying = RigidBody.varying(knots, bodies, outlet=outlet)
    y = start
    for a, b in itertools.pairwise(knots):
        y = solve_ivp(equations, (a, b), y, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    return varying, load, start, y, equations(3.0, y)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("about", ["center_of_mass", "origin"])
@pytest.mark.parametrize("method", ["dop853", "radau"])
def test_random_bodies_against_scipy(seed: int, about: Any, method: Any) -> None:
    varying, load, start, y, slope = by_scipy(seed, about)
    rtol = 1e-13 if method == "dop853" else 1e-11
    motion = varying.simulate([0, 1.1, 3], start[4:7], load=load, about=about, method=method, rtol=rtol)
    bar = 1e-9 if method == "dop853" else 1e-7
    close(motion.omega[-1], y[4:7], bar)
    close(motion.quaternion[-1], y[:4] / np.linalg.norm(y[:4]), bar)
    if about == "center_of_mass":
        close(motion.position[-1], y[7:10], bar)
    acceleration = motion.angular_acceleration()[-1]
    close(acceleration, slope[4:7], 1e-6)


def test_angular_acceleration_is_the_slope_of_omega() -> None:
    grain = RigidBody(10.0 - TIMES, np.diag([2.0, 2.5, 1.0]) * (1.0 - 0.1 * TIMES)[:, None, None])
    motion = RigidBody.varying(TIMES, grain, outlet=(0, 0, -0.5)).simulate(
        np.linspace(0, 4, 4001), (0.3, 0.5, 2.0), load=loads.constant_torque((0.1, 0, 0)), rtol=1e-13
    )
    slope = np.gradient(motion.omega, motion.t, axis=0, edge_order=2)
    close(motion.angular_acceleration(), slope, 1e-5)


def test_a_stack_of_starts_has_the_bits_of_each() -> None:
    body = RigidBody.varying(TIMES, about_z(2.0 + 0.5 * TIMES))
    starts = np.random.default_rng(1).normal(size=(3, 3))
    many = body.simulate(FINE, starts)
    for k in range(3):
        assert np.array_equal(many.omega[k], body.simulate(FINE, starts[k]).omega)
    assert many.angular_momentum().spin.shape == (3, 41, 3)


def test_it_goes_on() -> None:
    body = RigidBody.varying(TIMES, about_z(2.0 + 0.5 * TIMES))
    first = body.simulate([0, 2], (0.3, 0.2, 1.0), rtol=1e-13)
    second = first.resume([2, 4], rtol=1e-13)
    whole = body.simulate([0, 2, 4], (0.3, 0.2, 1.0), rtol=1e-13)
    close(second.omega[-1], whole.omega[-1])
    assert pickle.loads(pickle.dumps(second)).body == body


def test_what_is_conserved() -> None:
    closed = RigidBody.varying(TIMES, about_z(2.0 + 0.5 * TIMES)).simulate(FINE, (0.3, 0.2, 1.0), rtol=1e-13)
    kept = closed.invariants()
    assert kept.energy is None
    assert kept.angular_momentum_drift < 1e-11
    open_one = RigidBody.varying(TIMES, solids.sphere(1.0, mass=10.0 - TIMES), outlet=(0, 0, 1))
    assert open_one.simulate(FINE, (0, 0, 1.0)).invariants().angular_momentum is None


def test_a_body_that_does_not_change_moves_as_it_does() -> None:
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5), center_of_mass=(0.1, 0.2, 0.3))
    same = RigidBody.varying([0, 4], RigidBody.stack([body, body]))
    load = loads.constant_torque((0.1, 0.2, 0.3)) + loads.constant_force((1, 0, 0), point=(0, 0, 1))
    one, two = (run(it, (0.1, 1.0, 0.2), load=load) for it in (body, same))
    close(two.omega, one.omega)
    close(two.position, one.position)
    close(two.kinetic_energy().total, one.kinetic_energy().total)
    assert same.at(4.0).isclose(body)


def test_masses_that_differ_by_rounding_need_no_outlet() -> None:
    tensor = np.eye(3)
    for part, is_refused in ((4 * np.finfo(float).eps, False), (6 * np.finfo(float).eps, True)):
        bodies = RigidBody(np.array([1.0, 1.0 + part]), np.stack([tensor, tensor]))
        if is_refused:
            with pytest.raises(ValueError, match="outlet: the mass is"):
                RigidBody.varying([0, 1], bodies)
        else:
            RigidBody.varying([0, 1], bodies)


def test_refusals() -> None:
    spheres = solids.sphere(1.0, mass=10.0 - TIMES)
    with pytest.raises(ValueError, match=r"outlet: the mass is 10.0 at first and 9.0 at t = 1.0"):
        RigidBody.varying(TIMES, spheres)
    with pytest.raises(ValueError, match=r"t, bodies: expected as many times as bodies.*\(4,\) and \(5,\)"):
        RigidBody.varying(TIMES[1:], spheres)
    no_bodies: Any = [1, 2]
    with pytest.raises(ValueError, match="bodies: expected a stack of bodies"):
        RigidBody.varying(TIMES, no_bodies)
    with pytest.raises(ValueError, match="ascend"):
        RigidBody.varying(TIMES[::-1], spheres, outlet=(0, 0, 0))
    with pytest.raises(ValueError, match="outlet: expected shape"):
        RigidBody.varying(TIMES, spheres, outlet=[[[0, 0, 0]]])
    sudden = about_z([1.0, 1.0, 1.0, 100.0, 100.0])
    with pytest.raises(ValueError, match="give bodies at more times around it"):
        RigidBody.varying(TIMES, sudden)
    body = RigidBody.varying(TIMES, spheres, outlet=(0, 0, 1))
    for t in ([0, 4.1], [-0.1, 2], [4, -1]):
        with pytest.raises(ValueError, match=r"the bodies are known from t = 0.0 to t = 4.0"):
            body.simulate(t, (0, 0, 1))
    with pytest.raises(ValueError, match="the bodies are known"):
        body.at(4.0001)
    methods: tuple[Any, ...] = ("taylor", "exact", "splitting")
    for method in methods:
        with pytest.raises(ValueError, match="serve a varying body"):
            body.simulate([0, 1], (0, 0, 1), method=method)
    limits: list[dict[str, Any]] = [{"dry_friction": 0.1}, {"max_rate": 10.0}, {"max_momentum": 10.0}]
    for options in limits:
        wheel = loads.wheel((0, 0, 1), inertia=0.1, torque=0.1, **options)
        with pytest.raises((ValueError, IntegrationError), match="for a body that varies"):
            body.simulate([0, 1], (0, 0, 1), load=wheel)
    unknown: Any = body
    with pytest.raises(AttributeError, match=r"body.at\(t\).inertia is that"):
        _ = unknown.inertia
    uncertain = RigidBody(Uncertain(1.0, 0.1), np.eye(3))
    with pytest.raises(ValueError, match="bodies: the uncertainty"):
        RigidBody.varying([0, 1], RigidBody.stack([uncertain, uncertain]))
    motion = body.simulate([0, 1], (0, 0, 1))
    with pytest.raises(ValueError, match="sensitivity"):
        motion.sensitivity()


def test_a_rod_without_a_moment_about_its_axis_is_refused_where_it_is_needed() -> None:
    rods = RigidBody.from_particles([1.0, 1.0], [[(0, 0, -1.0), (0, 0, 1.0)], [(0, 0, -2.0), (0, 0, 2.0)]])
    body = RigidBody.varying([0, 1], rods)
    with pytest.raises(ValueError, match="no body can have"):
        body.simulate([0, 1], (1.0, 0, 0))
