"""The force in the pivot, against Newton's second law for the centre of mass and for every particle."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from polhode import RigidBody, loads, solids
from polhode._core import rotate
from scipy.spatial.transform import Rotation

G = np.array([0.0, 0.0, -9.81])


def weight_about_pivot(body: RigidBody) -> loads.Load:
    """Torque of the weight about the origin of the body frame."""
    return loads.torque_callback(
        lambda _t, _omega, q: np.cross(body.mass * body.center_of_mass, rotate(q, G, inverse=True))
    )


def test_it_is_what_the_particles_need_beyond_gravity(rng: np.random.Generator) -> None:
    masses, places = rng.uniform(0.5, 2.0, (40, 6)), rng.normal(size=(40, 6, 3))
    body = RigidBody.from_particles(masses, places)
    omega, rate, force, gravity = rng.normal(size=(4, 40, 3))
    turn = Rotation.from_quat(rng.normal(size=(40, 4)))
    of_each = np.cross(rate[:, None], places) + np.cross(omega[:, None], np.cross(omega[:, None], places))
    in_space = np.einsum("nij,nkj->nki", turn.as_matrix(), of_each) - gravity[:, None]
    want = (masses[..., None] * in_space).sum(axis=1) - force
    got = body.pivot_reaction(omega, rate, turn, gravity, force)
    size = (masses[..., None] * np.abs(in_space)).sum(axis=(1, 2)) + np.abs(force).sum(axis=1)
    assert (np.abs(got - want) / size[:, None]).max() < 1e-14


def test_a_body_at_rest_weighs_what_it_weighs() -> None:
    body = solids.cube(1.0, mass=2.0).translated((0.0, 0.0, -3.0))
    assert body.pivot_reaction((0, 0, 0), gravity=G).tolist() == [0.0, 0.0, 2.0 * 9.81]
    assert body.pivot_reaction((0, 0, 0), gravity=G, force=(1, 0, 0)).tolist() == [-1.0, 0.0, 2.0 * 9.81]
    assert not body.pivot_reaction((1, 2, 3), about="center_of_mass").any()


class TestTrajectory:
    def test_a_pendulum(self) -> None:
        """Along the rod m g cos φ + m ω² l, across it m g sin φ − m l φ̈."""
        m, length = 1.5, 0.8
        bob = solids.sphere(0.0, mass=m).translated((0.0, 0.0, -length))
        t = np.linspace(0.0, 3.0, 61)
        load = loads.torque_callback(
            # A point on a rod has no moment about it, nor the weight a torque along it.
            lambda _t, _omega, q: np.cross((0, 0, -m * length), rotate(q, G, inverse=True)) * (1, 1, 0)
        )
        motion = bob.simulate(
            t, (0.0, 0.0, 0.0), Rotation.from_rotvec((1.2, 0, 0)), load=load, about="origin"
        )
        phi = 2 * np.arctan2(motion.quaternion[:, 0], motion.quaternion[:, 3])
        along = m * 9.81 * np.cos(phi) + m * length * motion.omega[:, 0] ** 2
        rod = np.column_stack([np.zeros(61), -np.sin(phi), np.cos(phi)])  # toward the pivot
        force = motion.pivot_reaction(gravity=G)
        assert force.shape == (61, 3)
        assert np.abs(force - along[:, None] * rod).max() < 1e-12 * along.max()

    def test_newton_for_the_center_of_mass(self, rng: np.random.Generator) -> None:
        """m d²x_C/dt² = m g + reaction, with the second derivative by differences of the path."""
        body = solids.box((1.0, 2.0, 3.0), mass=2.0).translated((0.3, -0.2, 1.0))
        h = 1e-2
        t = 1.0 + h * np.arange(-4, 5)
        load = weight_about_pivot(body) + loads.constant_torque((0.1, 0.2, -0.3), "space")
        start = body.simulate([0.0, *t], rng.normal(size=3), load=load, about="origin", rtol=1e-14)
        path = start.point("center_of_mass")[1:]
        weights = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])
        acceleration = weights @ path / h**2
        want = body.mass * (acceleration - G)
        assert np.abs(start.pivot_reaction(gravity=G)[5] - want).max() < 1e-8 * np.abs(want).max()

    def test_stacks(self, rng: np.random.Generator) -> None:
        stack = solids.box(rng.uniform(1, 2, (2, 3, 3)), mass=1.0).translated((0.0, 0.0, 1.0))
        load = loads.constant_torque((0.1, 0.0, 0.2), "space")
        motion = stack.simulate(np.linspace(0, 1, 5), (1.0, 2.0, 3.0), load=load, about="origin")
        assert motion.torque().shape == motion.angular_acceleration().shape == (2, 3, 5, 3)
        force = motion.pivot_reaction(gravity=G, force=rng.normal(size=(2, 3, 1, 3)))
        assert force.shape == (2, 3, 5, 3)
        alone = stack[1, 2].simulate(motion.t, (1.0, 2.0, 3.0), load=load, about="origin")
        assert np.array_equal(alone.pivot_reaction(gravity=G), motion.pivot_reaction(gravity=G)[1, 2])

    def test_without_a_pivot_there_is_no_reaction(self) -> None:
        body = solids.cube(1.0, mass=1.0).translated((1.0, 0.0, 0.0))
        with pytest.raises(ValueError, match=r'simulate it with about="origin"'):
            body.simulate([0.0, 1.0], (1.0, 2.0, 3.0)).pivot_reaction()
        flying = solids.cube(1.0, mass=1.0).simulate([0.0, 1.0], (1.0, 2.0, 3.0), velocity=(1.0, 0.0, 0.0))
        with pytest.raises(ValueError, match="pivot"):
            flying.pivot_reaction()

    def test_a_trajectory_keeps_its_load_and_is_pickled_with_it(self) -> None:
        load = loads.constant_torque((0.0, 0.0, 1.0)) + loads.constant_torque((0.5, 0.0, 0.0), "space")
        body = solids.box((1.0, 2.0, 3.0), mass=1.0)
        motion = body.simulate([0.0, 1.0, 2.0], (0.0, 1.0, 0.0), load=load)
        again = pickle.loads(pickle.dumps(motion))
        assert np.array_equal(again.torque(), motion.torque())
        assert np.array_equal(again.torque()[0], [0.5, 0.0, 1.0])
        free = body.simulate([0.0, 1.0], (0.0, 1.0, 0.0))
        assert free.load is None
        assert not free.torque().any()
        assert np.array_equal(free.angular_acceleration(), body.angular_acceleration(free.omega))


def test_broadcasting_and_names() -> None:
    stack = solids.cube([1.0, 2.0], mass=1.0).translated((0, 0, 1))
    assert stack.pivot_reaction(np.ones((5, 1, 3)), gravity=G).shape == (5, 2, 3)
    rows = np.array([[0, 0, 0, 1.0], [np.nan] * 4])
    got = stack.pivot_reaction((1, 2, 3), attitude=rows)
    assert np.isfinite(got[0]).all()
    assert np.isnan(got[1]).all()
    for arguments, word in (
        ({"omega": (1.0, 2.0)}, "omega"),
        ({"omega": (1, 2, 3), "gravity": 9.81}, "gravity"),
        ({"omega": (1, 2, 3), "attitude": (1, 2, 3)}, "attitude"),
        ({"omega": (1, 2, 3), "attitude": (0, 0, 0, 2)}, "attitude"),
        ({"omega": (1, 2, 3), "about": "pivot"}, "about"),
    ):
        with pytest.raises(ValueError, match=word):
            stack.pivot_reaction(**arguments)
