"""What a trajectory derives from its arrays, held against the sum over its particles."""

from __future__ import annotations

import copy
import csv
import pickle
import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from numpy.typing import NDArray
from polhode import RigidBody, Trajectory, euler_angles, loads
from polhode.errors import SingularAttitudeError
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from pathlib import Path

Floats = NDArray[np.float64]


class Swarm:
    """Particles that move as rigid bodies, and the trajectory that describes them."""

    def __init__(
        self, rng: np.random.Generator, shape: tuple[int, ...], times: int = 5, particles: int = 6
    ) -> None:
        self.masses = rng.uniform(0.1, 2.0, (*shape, particles))
        self.places = rng.normal(size=(*shape, particles, 3))
        stack = (*shape, times)
        quaternion = rng.normal(size=(*stack, 4))
        self.about = rng.normal(size=(*shape, 3))
        self.trajectory = Trajectory(
            body=RigidBody.from_particles(self.masses, self.places),
            t=np.linspace(0.0, 1.0, times),
            omega=rng.normal(size=(*stack, 3)),
            quaternion=quaternion / np.linalg.norm(quaternion, axis=-1, keepdims=True),
            position=rng.normal(size=(*stack, 3)),
            velocity=rng.normal(size=(*stack, 3)),
            about=self.about,
            steps=np.zeros(shape, dtype=np.int64),
            evaluations=np.zeros(shape, dtype=np.int64),
        )

    def in_space(self) -> tuple[Floats, Floats, Floats]:
        """Masses (..., 1, n), and positions and velocities (..., T, n, 3) of every particle in space."""
        trajectory = self.trajectory
        arm = (self.places - self.about[..., None, :])[..., None, :, :]
        spin = np.cross(trajectory.omega[..., None, :], arm)
        turn = Rotation.from_quat(trajectory.quaternion).as_matrix()[..., None, :, :]
        position = trajectory.position[..., None, :] + (turn @ arm[..., None])[..., 0]
        velocity = trajectory.velocity[..., None, :] + (turn @ spin[..., None])[..., 0]
        return self.masses[..., None, :], position, velocity


SHAPES: list[tuple[int, ...]] = [(), (4,), (2, 3)]


@pytest.mark.parametrize("shape", SHAPES)
def test_kinetic_energy_is_the_sum_over_the_particles(
    shape: tuple[int, ...], rng: np.random.Generator
) -> None:
    swarm = Swarm(rng, shape)
    masses, _, velocity = swarm.in_space()
    expected = 0.5 * (masses * (velocity**2).sum(axis=-1)).sum(axis=-1)
    energy = swarm.trajectory.kinetic_energy()
    assert energy.total.shape == (*shape, 5)
    np.testing.assert_allclose(energy.total, expected, rtol=1e-13)


@pytest.mark.parametrize("shape", SHAPES)
def test_angular_momentum_is_the_sum_over_the_particles(
    shape: tuple[int, ...], rng: np.random.Generator
) -> None:
    swarm = Swarm(rng, shape)
    masses, position, velocity = swarm.in_space()
    expected = (masses[..., None] * np.cross(position, velocity)).sum(axis=-2)
    momentum = swarm.trajectory.angular_momentum()
    assert momentum.total.shape == (*shape, 5, 3)
    np.testing.assert_allclose(momentum.total, expected, rtol=0, atol=1e-13 * np.abs(expected).max())
    in_body = swarm.trajectory.angular_momentum(frame="body").total
    turned = Rotation.from_quat(swarm.trajectory.quaternion).apply if not shape else None
    if turned is not None:
        np.testing.assert_allclose(
            turned(in_body), momentum.total, rtol=0, atol=1e-13 * np.abs(expected).max()
        )
    np.testing.assert_allclose(
        np.linalg.norm(in_body, axis=-1), np.linalg.norm(momentum.total, axis=-1), rtol=1e-13
    )


def test_frame_is_checked(rng: np.random.Generator) -> None:
    with pytest.raises(ValueError, match="'inertial' is not 'space' or 'body'"):
        Swarm(rng, ()).trajectory.angular_momentum(frame="inertial")  # type: ignore[arg-type]


@pytest.mark.parametrize("shape", SHAPES)
def test_rotation_is_scipy_s(shape: tuple[int, ...], rng: np.random.Generator) -> None:
    trajectory = Swarm(rng, shape).trajectory
    matrices = trajectory.rotation.as_matrix()
    assert matrices.shape == (*shape, 5, 3, 3)
    x, y, z, w = np.moveaxis(trajectory.quaternion, -1, 0)
    np.testing.assert_allclose(matrices[..., 0, 0], w**2 + x**2 - y**2 - z**2, atol=1e-15)
    np.testing.assert_allclose(matrices[..., 1, 0], 2 * (x * y + z * w), atol=1e-15)
    assert trajectory.rotation is trajectory.rotation


@pytest.mark.parametrize("sequence", ["ZXZ", "ZYX", "xyz"])
def test_euler_angles_are_scipy_s(sequence: str, rng: np.random.Generator) -> None:
    trajectory = Swarm(rng, ()).trajectory
    expected = Rotation.from_quat(trajectory.quaternion).as_euler(sequence)
    np.testing.assert_allclose(trajectory.euler_angles(sequence), expected, atol=1e-13)


def test_singular_attitude_raises_or_is_nan() -> None:
    trajectory = RigidBody(1.0, np.diag([1.0, 2.0, 2.5])).simulate([0.0, 1.0, 2.0], [0.0, 0.0, 1.0])
    with pytest.raises(SingularAttitudeError):
        trajectory.euler_angles()
    angles = trajectory.euler_angles(singular="nan")
    assert angles.shape == (3, 3)
    assert np.isnan(angles).any()
    with pytest.raises(SingularAttitudeError):
        trajectory.euler_rates()
    assert np.isnan(trajectory.euler_rates(singular="nan")).any()


@pytest.mark.parametrize("shape", SHAPES)
def test_points_go_where_the_particles_go(shape: tuple[int, ...], rng: np.random.Generator) -> None:
    swarm = Swarm(rng, shape)
    masses, position, _ = swarm.in_space()
    trajectory = swarm.trajectory
    for k in range(3):
        got = trajectory.point(swarm.places[..., k, :])
        np.testing.assert_allclose(got, position[..., k, :], rtol=0, atol=1e-14)
    center = (masses[..., None] * position).sum(axis=-2) / masses.sum(axis=-1)[..., None]
    np.testing.assert_allclose(trajectory.point("center_of_mass"), center, rtol=0, atol=1e-14)
    assert trajectory.point("origin").shape == (*shape, 5, 3)
    with pytest.raises(ValueError, match="point: 'here' is not"):
        trajectory.point("here")
    with pytest.raises(ValueError, match=r"point: expected shape \(\.\.\., 3\), got \(2,\)"):
        trajectory.point((1.0, 2.0))


def test_euler_rates_are_those_of_the_angles(rng: np.random.Generator) -> None:
    trajectory = Swarm(rng, (4,)).trajectory
    rates = trajectory.euler_rates("ZYX")
    again = euler_angles.angular_velocity(trajectory.euler_angles("ZYX"), rates, "ZYX")
    np.testing.assert_allclose(again, trajectory.omega, rtol=0, atol=1e-13)


def test_length_and_repr(rng: np.random.Generator) -> None:
    one, many = Swarm(rng, ()).trajectory, Swarm(rng, (2, 3)).trajectory
    assert len(one) == 5
    assert repr(one) == "Trajectory(5 times from 0 to 1)"
    assert repr(many) == "Trajectory(2x3 bodies, 5 times from 0 to 1)"


def test_free_motion_conserves() -> None:
    body = RigidBody(2.0, np.diag([1.0, 2.0, 2.5]), center_of_mass=(0.1, 0.2, 0.3))
    trajectory = body.simulate(
        np.linspace(0.0, 20.0, 50), [0.1, 2.0, 0.1], position=[1.0, 2.0, 3.0], velocity=[0.3, 0.0, -0.2]
    )
    energy, momentum = trajectory.kinetic_energy().total, trajectory.angular_momentum().total
    np.testing.assert_allclose(energy, energy[0], rtol=1e-9)
    np.testing.assert_allclose(momentum, np.tile(momentum[0], (50, 1)), atol=1e-8)
    assert energy[0] == pytest.approx(0.5 * (0.01 + 2.0 * 4.0 + 2.5 * 0.01) + 0.13, rel=1e-14)


# files ------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", SHAPES)
def test_npz_holds_every_bit(shape: tuple[int, ...], rng: np.random.Generator, tmp_path: Path) -> None:
    trajectory = Swarm(rng, shape).trajectory
    path = tmp_path / "motion.NPZ"
    trajectory.save(path)
    with np.load(path) as file:
        for name in ("t", "omega", "quaternion", "position", "velocity", "about", "steps", "evaluations"):
            np.testing.assert_array_equal(file[name], getattr(trajectory, name))
        for name in ("mass", "inertia", "center_of_mass"):
            np.testing.assert_array_equal(file[name], getattr(trajectory.body, name))


@pytest.mark.parametrize("shape", SHAPES)
def test_csv_holds_every_bit(shape: tuple[int, ...], rng: np.random.Generator, tmp_path: Path) -> None:
    trajectory = Swarm(rng, shape).trajectory
    path = tmp_path / "motion.csv"
    trajectory.save(str(path))
    with path.open(newline="") as file:
        records = list(csv.DictReader(file))
    assert len(records) == int(np.prod(shape, dtype=int)) * 5
    indices = {0: [], 1: ["body"], 2: ["body_0", "body_1"]}[len(shape)]
    assert list(records[0])[: len(indices) + 1] == [*indices, "t"]
    for record in records:
        place = tuple(int(record[name]) for name in indices)
        row = int(np.flatnonzero(trajectory.t == float(record["t"]))[0])
        for name, components in {
            "omega": "xyz",
            "quaternion": "xyzw",
            "position": "xyz",
            "velocity": "xyz",
        }.items():
            values = [float(record[f"{name}_{component}"]) for component in components]
            assert values == getattr(trajectory, name)[(*place, row)].tolist()


def columns_of(path: Path) -> dict[str, np.ndarray[Any, Any]]:
    with path.open(newline="") as file:
        names, *rows = csv.reader(file)
    return dict(zip(names, np.array(rows, float).T, strict=True))


def test_tables_have_euler_angles_and_torques(tmp_path: Path) -> None:
    # A spin about z under a constant torque along it: ψ = ω t + N t²/2I, and the torque is what was put in.
    body, path = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5)), tmp_path / "motion.csv"
    t = np.linspace(0.0, 1.0, 5)
    tilt = euler_angles.to_quaternion((0.2, 0.5, 0.0))
    run = body.simulate(t, (0.0, 0.0, 0.3), tilt, load=loads.constant_torque((0.0, 0.0, 0.1)))
    run.save(path)
    held = columns_of(path)
    assert np.allclose(held["euler_phi"], 0.2, atol=1e-12)
    assert np.allclose(held["euler_theta"], 0.5, atol=1e-12)
    assert np.allclose(held["euler_psi"], 0.3 * t + 0.05 * t * t / 2.5, atol=1e-10)
    assert np.array_equal([held[f"torque_{x}"] for x in "xyz"], run.torque().T)
    assert np.allclose(held["torque_z"], 0.1, rtol=1e-15)
    assert not held["torque_x"].any()


def test_what_a_table_cannot_tell_is_left_out(tmp_path: Path) -> None:
    body, path = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5)), tmp_path / "motion.csv"
    load = loads.wheel(axis=(0, 0, 1), inertia=0.1, rate=2.0)
    run = body.simulate([0.0, 1.0], (0.1, 0.2, 0.3), load=load)
    run.save(path)
    held = columns_of(path)
    assert {"torque_x", "states_wheel_0"} <= held.keys()
    assert np.array_equal(held["states_wheel_0"], run.states["wheel"][:, 0])
    run.save(tmp_path / "motion.json")
    Trajectory.from_file(tmp_path / "motion.json").save(path)  # the file does not hold the load
    assert "torque_x" not in columns_of(path)
    assert np.isnan(columns_of(path)["euler_phi"][0])  # upright at first: theta is 0
    free = body.free_motion((0.1, 0.2, 0.3)).at([0.0, 1.0])
    free.save(path)
    assert not columns_of(path)["torque_x"].any()


@pytest.mark.parametrize("shape", SHAPES)
def test_pandas_holds_the_same_columns(
    shape: tuple[int, ...], rng: np.random.Generator, tmp_path: Path
) -> None:
    pytest.importorskip("pandas")
    trajectory = Swarm(rng, shape).trajectory
    table = trajectory.to_pandas()
    trajectory.save(tmp_path / "motion.csv")
    held = columns_of(tmp_path / "motion.csv")
    index = {0: ["t"], 1: ["body", "t"], 2: ["body_0", "body_1", "t"]}[len(shape)]
    assert list(table.index.names) == index
    assert [*index, *table.columns] == list(held)
    for name in table.columns:
        assert np.array_equal(table[name], held[name], equal_nan=True)
    for name in index:
        assert np.array_equal(table.index.get_level_values(name), held[name])


def test_save_refuses_other_suffixes(rng: np.random.Generator, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"motion\.txt does not end in \.csv, \.json or \.npz"):
        Swarm(rng, ()).trajectory.save(tmp_path / "motion.txt")


# optional libraries ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("module", "call", "remedy"),
    [
        ("scipy", lambda trajectory: trajectory.rotation, "pip install scipy"),
        ("matplotlib", lambda trajectory: trajectory.plot(), r'pip install "polhode\[plot\]"'),
    ],
)
def test_missing_library_is_named_with_its_remedy(
    module: str, call: Any, remedy: str, rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [name for name in sys.modules if name.partition(".")[0] == module]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ModuleNotFoundError, match=remedy):
        call(Swarm(rng, ()).trajectory)


class TestWhatARunHasReady:
    """Arrays that a run does not make until they are asked for."""

    RACKET = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5), center_of_mass=(0.1, 0.0, 0.3))
    NAMES = ("t", "omega", "quaternion", "position", "velocity", "about", "steps", "evaluations", "status")

    def motion(self) -> Trajectory:
        starts = [[0.1, 1.0, 0.2], [0.3, -1.0, 0.1]]
        return self.RACKET.simulate(
            [0, 2.5, 5], starts, velocity=(1, 0, 0), method="dop853", events=lambda _t, w, *_: w[0]
        )

    @pytest.mark.parametrize(
        "copied", [copy.copy, copy.deepcopy, lambda motion: pickle.loads(pickle.dumps(motion))]
    )
    def test_copies_have_all_of_it(self, copied: Any) -> None:
        motion, other = self.motion(), copied(self.motion())
        for name in self.NAMES:
            assert np.array_equal(getattr(other, name), getattr(motion, name)), name
        for ours, theirs in zip(motion.events, other.events, strict=True):
            assert len(ours) > 0
            assert np.array_equal(ours, theirs)
        assert other.body == motion.body
        assert (other.load, other.failures, other.pivoted) == (None, (), False)

    def test_each_is_made_once(self) -> None:
        motion = self.motion()
        for name in ("t", "about", "steps", "evaluations", "events"):
            assert getattr(motion, name) is getattr(motion, name)
        assert motion.steps.shape == motion.evaluations.shape == motion.status.shape == (2,)
        assert motion.status.dtype == np.dtype("<U8")

    def test_no_others(self) -> None:
        with pytest.raises(AttributeError, match="'Trajectory' object has no attribute 'omegas'"):
            self.motion().omegas  # type: ignore[attr-defined]  # noqa: B018
