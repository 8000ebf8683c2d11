"""Velocities, accelerations and rates in moving frames, against exact arithmetic and Newton's second law."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from oracles import rational, worst_error
from oracles.bodies import Body, bodies, vectors
from oracles.exact_particles import cross
from polhode import RigidBody, kinematics, solids

ABOUT: list[Any] = ["center_of_mass", "origin", (0.5, -1.0, 0.25)]


def add(*vectors: Any) -> list[Any]:
    return [sum(parts) for parts in zip(*vectors, strict=True)]


def point_of(body: RigidBody, about: Any) -> Any:
    words = {"center_of_mass": body.center_of_mass, "origin": np.zeros(3)}
    return rational(words[about] if isinstance(about, str) else about)


@pytest.mark.parametrize("about", ABOUT)
def test_velocity_and_acceleration_of_a_point(about: Any, rng: np.random.Generator) -> None:
    body = solids.box((1.0, 2.0, 3.0), mass=2.0).translated((0.25, 1.0, -0.5))
    for _ in range(50):
        r, omega, rate, v, a = rng.normal(size=(5, 3))
        arm = [x - p for x, p in zip(rational(r), point_of(body, about), strict=True)]
        w = rational(omega)
        velocity = add(rational(v), cross(w, arm))
        got = body.point_velocity(r, omega, v, about=about)
        size = np.linalg.norm(v) + 10 * np.linalg.norm(omega)
        assert worst_error(got, velocity, scale=float(size)) < 1e-15
        acceleration = add(rational(a), cross(rational(rate), arm), cross(w, cross(w, arm)))
        got = body.point_acceleration(r, omega, rate, a, about=about)
        size = np.linalg.norm(a) + 10 * (np.linalg.norm(rate) + omega @ omega)
        assert worst_error(got, acceleration, scale=float(size)) < 1e-15


def test_the_words_name_points_too() -> None:
    body = solids.cube(1.0, mass=1.0).translated((0.0, 2.0, 0.0))
    assert body.point_velocity("center_of_mass", (0, 0, 3.0), about="origin").tolist() == [-6.0, 0.0, 0.0]
    assert body.point_velocity("origin", (0, 0, 3.0)).tolist() == [6.0, 0.0, 0.0]
    assert body.point_acceleration("origin", (0, 0, 3.0)).tolist() == [0.0, 18.0, 0.0]


def test_newton_for_every_particle_is_newton_and_euler_for_the_body(rng: np.random.Generator) -> None:
    """mln24: with ΣF = m a_C and ΣN = I ω̇ + ω×Iω the body has six degrees of freedom."""
    masses, places = rng.uniform(0.5, 2.0, (30, 7)), rng.normal(size=(30, 7, 3))
    body = RigidBody.from_particles(masses, places)
    omega, rate, a = rng.normal(size=(3, 30, 3))
    of_each = body[:, None].point_acceleration(
        places, omega[:, None], rate[:, None], a[:, None], about="origin"
    )
    forces = masses[..., None] * of_each
    of_center = body.point_acceleration("center_of_mass", omega, rate, a, about="origin")
    size = np.abs(forces).sum(axis=(1, 2))[:, None]
    assert (np.abs(forces.sum(axis=1) - body.mass[:, None] * of_center) / size).max() < 1e-14
    arms = places - body.center_of_mass[:, None]
    torque = np.cross(arms, forces).sum(axis=1)
    assert (np.abs(torque - body.torque(omega, rate)) / size).max() < 1e-13


@given(body=bodies(decades=3), omega=vectors(), offset=vectors())
def test_a_rigid_body_does_not_stretch(body: Body, omega: np.ndarray, offset: np.ndarray) -> None:
    made = RigidBody.from_principal(*body)
    r = body.center_of_mass + offset * body.gyration
    arm = r - body.center_of_mass
    velocity = made.point_velocity(r, omega)
    assert abs(velocity @ arm) <= 1e-15 * np.linalg.norm(omega) * (arm @ arm) * 4


class TestTransport:
    @given(rate=vectors(), vector=vectors(), omega=vectors())
    def test_it_is_exact(self, rate: np.ndarray, vector: np.ndarray, omega: np.ndarray) -> None:
        exact = add(rational(rate), cross(rational(omega), rational(vector)))
        size = np.linalg.norm(rate) + np.linalg.norm(omega) * np.linalg.norm(vector)
        if size > 0:
            got = kinematics.transport(rate, vector, omega)
            assert worst_error(got, exact, scale=float(size)) < 1e-15

    @given(rate=vectors(), vector=vectors(), omega=vectors())
    def test_there_and_back(self, rate: np.ndarray, vector: np.ndarray, omega: np.ndarray) -> None:
        there = kinematics.transport(rate, vector, omega)
        back = kinematics.transport(there, vector, -omega)
        size = np.linalg.norm(rate) + np.linalg.norm(omega) * np.linalg.norm(vector)
        assert np.abs(back - rate).max() <= 1e-15 * size

    @given(body=bodies(decades=3), omega=vectors(), rate=vectors())
    def test_of_the_angular_momentum_it_gives_eulers_equations(
        self, body: Body, omega: np.ndarray, rate: np.ndarray
    ) -> None:
        """mln27: (dL/dt)_N = (dL/dt)_B + ω×L = N."""
        made = RigidBody.from_principal(*body)
        momentum = made.angular_momentum(omega).total
        got = kinematics.transport(made.inertia @ rate, momentum, omega)
        size = body.moments[2] * (np.linalg.norm(rate) + omega @ omega)
        assert np.abs(got - made.torque(omega, rate)).max() <= 1e-14 * size

    def test_coriolis_and_centripetal(self) -> None:
        """Twice, of a place that stays in the frame: the acceleration Ω×(Ω×r)."""
        place, omega = np.array([2.0, 0.0, 0.0]), np.array([0.0, 0.0, 3.0])
        velocity = kinematics.transport(np.zeros(3), place, omega)
        assert kinematics.transport(np.zeros(3), velocity, omega).tolist() == [-18.0, 0.0, 0.0]

    def test_stacks_broadcast_and_a_nan_stays_in_its_row(self) -> None:
        rate = np.zeros((4, 1, 3))
        rate[2] = np.nan
        got = kinematics.transport(rate, np.ones((5, 3)), (0.0, 0.0, 1.0))
        assert got.shape == (4, 5, 3)
        assert np.isnan(got[2]).all()
        assert np.isfinite(np.delete(got, 2, axis=0)).all()
        with pytest.raises(ValueError, match=r"frame_omega: expected shape"):
            kinematics.transport(rate, rate, 1.0)


class TestEdgeMill:
    """mex175: the wheel presses on the ground with m g + ½ m R ω², by either frame."""

    @pytest.fixture
    def mill(self, rng: np.random.Generator) -> dict[str, np.ndarray]:
        """Body z along the axle, outward from the vertical axis that it meets at O; x up for the moment."""
        mass, radius, axle, turning = rng.uniform(0.3, 3.0, (4, 20))
        up = np.array([1.0, 0.0, 0.0])
        frame = turning[:, None] * up
        omega = frame - (turning * axle / radius)[:, None] * np.array([0.0, 0.0, 1.0])
        center = axle[:, None] * np.array([0.0, 0.0, 1.0])
        return {
            "mass": mass,
            "radius": radius,
            "axle": axle,
            "turning": turning,
            "frame": frame,
            "omega": omega,
            "center": center,
            "contact": center - radius[:, None] * up,
        }

    def test_it_rolls(self, mill: dict[str, np.ndarray]) -> None:
        wheel = solids.cylinder(mill["radius"], 0.2, mass=mill["mass"]).translated(mill["center"])
        slip = wheel.point_velocity(mill["contact"], mill["omega"], about="origin")
        assert np.abs(slip).max() < 1e-14 * (mill["turning"] * mill["axle"]).max()

    def test_its_pressure(self, mill: dict[str, np.ndarray]) -> None:
        wheel = solids.cylinder(mill["radius"], 0.2, mass=mill["mass"]).translated(mill["center"])
        omega, frame, weight = mill["omega"], mill["frame"], mill["mass"] * 9.81
        rate = kinematics.transport(np.zeros(3), omega, frame)  # ω stands still in the turning frame
        inertial = wheel.torque(omega, rate, about="origin")
        momentum = wheel.angular_momentum(omega, about="origin").total
        turning = kinematics.transport(np.zeros(3), momentum, frame)
        want = weight + 0.5 * mill["mass"] * mill["radius"] * mill["turning"] ** 2
        size = np.linalg.norm(momentum, axis=1) * mill["turning"] / mill["axle"] + want
        for torque in (inertial, turning):
            assert (np.abs(torque[:, 1] / mill["axle"] + weight - want) / size).max() < 1e-13


def test_shapes_broadcast() -> None:
    stack = solids.cube([1.0, 2.0], mass=1.0)
    points = np.zeros((5, 1, 3))
    assert stack.point_velocity(points, (1.0, 2.0, 3.0)).shape == (5, 2, 3)
    assert stack.point_acceleration("origin", np.ones((7, 1, 3)), np.ones(3)).shape == (7, 2, 3)
    assert stack[0].point_velocity(np.zeros((0, 3)), (1.0, 2.0, 3.0)).shape == (0, 3)
    with pytest.raises(ValueError, match=r"point: expected .*\"somewhere\""):
        stack.point_velocity("somewhere", (1.0, 2.0, 3.0))
    with pytest.raises(ValueError, match=r"acceleration: expected shape"):
        stack.point_acceleration((0, 0, 0), (1.0, 2.0, 3.0), acceleration=1.0)
