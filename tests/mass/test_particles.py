"""Bodies of point masses, against exact rational sums."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import ulp_errors, worst_error
from oracles.bodies import attitudes, matrix, vectors
from oracles.exact_particles import Particles, moments
from polhode import RigidBody


def assert_exact(body: RigidBody, masses: np.ndarray, positions: np.ndarray, bar: float) -> None:
    """Mass, C and I_C within `bar` of the exact sums over these very float64 values."""
    exact = Particles(masses, positions)
    size = max(
        float(abs(x - c)) for row in exact.positions for x, c in zip(row, exact.center_of_mass, strict=True)
    )
    assert worst_error(body.mass, exact.mass) <= bar
    reach = max(size, float(np.spacing(np.abs(positions)).max()) / bar)
    assert worst_error(body.center_of_mass, exact.center_of_mass, scale=reach) <= bar
    if size:
        assert worst_error(body.inertia, exact.inertia) <= bar


@pytest.mark.parametrize("count", [1, 2, 3, 10, 1000, 20_000])
def test_a_cloud_has_its_exact_inertia(count: int, rng: np.random.Generator) -> None:
    masses, positions = rng.uniform(0.1, 1, count), rng.normal(size=(count, 3))
    assert_exact(RigidBody.from_particles(masses, positions), masses, positions, 4e-15)


@pytest.mark.parametrize("distance", [1e3, 1e6, 1e8, 1e12])
def test_a_cloud_far_away_has_its_exact_inertia(distance: float, rng: np.random.Generator) -> None:
    masses = rng.uniform(0.1, 1, 500)
    positions = rng.normal(size=(500, 3)) + distance * np.array([1.0, -0.7, 0.3])
    body = RigidBody.from_particles(masses, positions)
    exact = Particles(masses, positions)
    assert worst_error(body.inertia, exact.inertia) <= 4e-15
    assert max(ulp_errors(body.center_of_mass, exact.center_of_mass)) <= 1.0


@pytest.mark.parametrize("scale", [1e-150, 1e-47, 1e-10, 1e21, 1e150])
def test_no_scale_is_special(scale: float, rng: np.random.Generator) -> None:
    masses, positions = rng.uniform(0.1, 1, 20), rng.normal(size=(20, 3))
    body = RigidBody.from_particles(masses, scale * positions)
    assert worst_error(body.inertia, Particles(masses, scale * positions).inertia) <= 4e-15
    assert RigidBody.from_particles(1e30 * masses, positions).mass == pytest.approx(
        1e30 * masses.sum(), rel=1e-14
    )


@given(
    points=st.lists(vectors(), min_size=2, max_size=12),
    masses=st.lists(st.floats(0.01, 100), min_size=12, max_size=12),
    shift=vectors(1e4),
)
def test_the_inertia_is_exact_wherever_the_body_stands(
    points: list[np.ndarray], masses: list[float], shift: np.ndarray
) -> None:
    positions, weights = np.array(points) + shift, np.array(masses[: len(points)])
    assert_exact(RigidBody.from_particles(weights, positions), weights, positions, 8e-15)


clouds = st.lists(vectors(), min_size=3, max_size=12)


class TestLaws:
    @given(points=clouds, attitude=attitudes(), shift=vectors(10.0))
    def test_moments_depend_neither_on_place_nor_on_attitude(
        self, points: list[np.ndarray], attitude: np.ndarray, shift: np.ndarray
    ) -> None:
        positions = np.array(points)
        masses = np.arange(1.0, 1 + len(points))
        here = RigidBody.from_particles(masses, positions)
        there = RigidBody.from_particles(masses, positions @ matrix(attitude).T + shift)
        # A coordinate rounded by ε·reach changes I = Σ m r² by 2 m r ε·reach.
        rounding = np.finfo(float).eps * (np.abs(positions).max() + np.abs(shift).max())
        bar = 16 * masses.sum() * rounding * (np.ptp(positions, axis=0).max() + rounding)
        assert np.abs(there.principal_moments - here.principal_moments).max() <= bar
        assert np.abs(np.trace(there.inertia) - np.trace(here.inertia)) <= 2 * bar

    @given(points=clouds)
    def test_triangle_inequalities_and_trace(self, points: list[np.ndarray]) -> None:
        body = RigidBody.from_particles(np.ones(len(points)), np.array(points))
        small, middle, large = body.principal_moments
        assert 0 <= small <= middle <= large
        assert small + middle >= large * (1 - 4e-16)
        assert np.trace(body.inertia) == pytest.approx(small + middle + large, rel=2e-15, abs=0)

    @given(points=clouds, cut=st.integers(1, 2))
    def test_the_parts_of_a_cloud_add_up_to_the_cloud(self, points: list[np.ndarray], cut: int) -> None:
        positions = np.array(points)
        masses = np.arange(1.0, 1 + len(points))
        parts = [RigidBody.from_particles(masses[s], positions[s]) for s in (slice(cut), slice(cut, None))]
        whole, total = RigidBody.from_particles(masses, positions), parts[0] + parts[1]
        rounding = np.finfo(float).eps * np.abs(positions).max()
        size = np.ptp(positions, axis=0).max() + rounding
        assert total.mass == whole.mass
        assert np.abs(total.center_of_mass - whole.center_of_mass).max() <= 8 * rounding
        assert np.abs(total.inertia - whole.inertia).max() <= 16 * masses.sum() * rounding * size


def test_a_single_particle_is_a_point() -> None:
    body = RigidBody.from_particles([2.0], [[0.1, 0.2, 0.3]])
    assert np.array_equal(body.center_of_mass, [0.1, 0.2, 0.3])
    assert not body.inertia.any()
    assert body.principal.top == "point"


def test_a_dumbbell_is_linear_in_any_attitude(rng: np.random.Generator) -> None:
    for _ in range(20):
        body = RigidBody.from_particles([1.0, 2.0], rng.normal(size=(2, 3)))
        assert body.principal_moments[0] <= 1e-15 * body.principal_moments[2]
        assert body.principal.top == "linear"


def test_a_flat_body_obeys_the_perpendicular_axis_theorem(rng: np.random.Generator) -> None:
    positions = rng.normal(size=(30, 3)) * [1.0, 1.0, 0.0]
    inertia = RigidBody.from_particles(np.ones(30), positions).inertia
    assert inertia[2, 2] == pytest.approx(inertia[0, 0] + inertia[1, 1], rel=1e-15)


def test_zero_masses_are_allowed_and_change_nothing(rng: np.random.Generator) -> None:
    positions = rng.normal(size=(5, 3))
    with_ghosts = RigidBody.from_particles([1.0, 2.0, 3.0, 0.0, 0.0], positions)
    without = RigidBody.from_particles([1.0, 2.0, 3.0], positions[:3])
    assert bool(with_ghosts.isclose(without, rtol=1e-15, atol=1e-15))


def test_masses_broadcast_against_frames(rng: np.random.Generator) -> None:
    frames = rng.normal(size=(4, 5, 3))
    masses = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    stack = RigidBody.from_particles(masses, frames)
    assert stack.shape == (4,)
    for row, frame in zip(stack, frames, strict=True):
        assert row == RigidBody.from_particles(masses, frame)
    assert RigidBody.from_particles(np.ones((4, 1, 5)), rng.normal(size=(2, 5, 3))).shape == (4, 2)


@pytest.mark.parametrize("distance", [0.0, 1e3])
@pytest.mark.parametrize("thickness", 10.0 ** -np.arange(2, 13))
def test_thin_bodies_keep_their_smallest_moment(
    thickness: float, distance: float, rng: np.random.Generator
) -> None:
    """Tilted rods: I₁ is up to 24 decades below I₃, which no tensor of float64 numbers could hold."""
    masses = rng.uniform(0.1, 1, 300)
    positions = rng.uniform(-0.5, 0.5, (300, 3)) * [thickness, thickness, 1.0]
    turn = rng.normal(size=4)
    positions = positions @ matrix(turn / np.linalg.norm(turn)).T + distance * np.array([0.6, -0.5, 0.7])
    body = RigidBody.from_particles(masses, positions)
    exact = moments(Particles(masses, positions).inertia)
    assert body.principal_moments == pytest.approx(exact, rel=3e-15, abs=0)


class TestSampling:
    """The sums are about a point that a few of the particles are asked for: it may be a bad one."""

    def test_a_few_heavy_particles_that_the_sample_misses(self, rng: np.random.Generator) -> None:
        masses, positions = np.full(10_000, 1e-9), rng.normal(size=(10_000, 3))
        masses[[1234, 7777]], positions[[1234, 7777]] = 1e3, [(1e7, 0.5, 0), (1e7, 0, 0.25)]
        assert_exact(RigidBody.from_particles(masses, positions), masses, positions, 4e-15)

    def test_light_particles_far_away_that_it_meets(self, rng: np.random.Generator) -> None:
        masses, positions = rng.uniform(0.1, 1, 10_000), rng.normal(size=(10_000, 3))
        masses[::25], positions[::25] = 1e-25, 1e9
        assert_exact(RigidBody.from_particles(masses, positions), masses, positions, 4e-15)


def stack_of(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Bodies of twenty particles, every third one thin."""
    masses, positions = rng.uniform(0.1, 1, (200, 20)), rng.normal(size=(200, 20, 3))
    positions[::3, :, 1:] *= 1e-7
    return masses, positions @ matrix(np.array([0.1, 0.5, -0.7, 0.5])).T


def test_a_body_has_the_same_bits_alone_and_in_a_stack(rng: np.random.Generator) -> None:
    masses, positions = stack_of(rng)
    stack = RigidBody.from_particles(masses, positions)
    assert stack.shape == (200,)
    for row, body in enumerate(stack):
        assert body == RigidBody.from_particles(masses[row], positions[row])
    shuffled = RigidBody.from_particles(masses[::-7], positions[::-7])
    assert shuffled == stack[::-7]


class TestLabels:
    def test_bodies_have_the_bits_of_their_particles_alone(self, rng: np.random.Generator) -> None:
        sizes = [1, 3, 20, 5000, 4096, 150_000, 2]
        labels = rng.permutation(np.repeat(np.arange(-1, 7), [50, *sizes]))
        masses, positions = rng.uniform(0.1, 1, len(labels)), rng.normal(size=(len(labels), 3))
        positions[labels == 3] *= [1e-6, 1.0, 1e-6]
        for order in (slice(None), np.argsort(labels, kind="stable")):
            m, r, k = masses[order], positions[order], labels[order]
            bodies = RigidBody.from_labelled_particles(m, r, k.astype(np.int16))
            assert bodies.shape == (7,)
            for label, body in enumerate(bodies):
                assert body == RigidBody.from_particles(m[k == label], r[k == label])

    def test_no_label_at_all_is_a_stack_of_none(self) -> None:
        assert RigidBody.from_labelled_particles([1.0], [(0, 0, 0)], [-1]).shape == (0,)
        assert RigidBody.from_labelled_particles([], np.zeros((0, 3)), []).shape == (0,)

    @pytest.mark.parametrize(
        ("masses", "labels", "words"),
        [
            ([1.0, 1.0], [0, -2], r"labels\[1\] is -2.*counted from 0|counted from 0.*labels\[1\] is -2"),
            (
                [1.0, 1.0],
                [0, 2],
                r"label 1: .*0 particles.*; .*return_labels=True takes labels with gaps",
            ),
            ([1.0, 1.0], [2**62, 0], r"label 1: .*0 particles.*return_labels"),
            (
                [1.0, 0.0],
                [0, 1],
                r"label 1: .*1 particles.*positive.*; give its particles their masses, or the label -1",
            ),
            ([1.0, -3.0], [1, 0], r"label 0: .*-3\.0"),
            ([1.0, 1.0], [0, 1, 2], r"labels.*shape \(2,\).*got \(3,\)"),
        ],
    )
    def test_errors_name_the_label(self, masses: list[float], labels: list[int], words: str) -> None:
        with pytest.raises(ValueError, match=words):
            RigidBody.from_labelled_particles(masses, np.zeros((2, 3)), labels)

    def test_labels_must_be_integers(self) -> None:
        with pytest.raises(TypeError, match=r"labels.*integers.*float64"):
            RigidBody.from_labelled_particles([1.0], [(0, 0, 0)], [0.0])


INTERRUPT = """
import os, signal, threading, time
import numpy as np
from polhode import MassAccumulator, RigidBody
masses, frames = np.ones(200_000), np.random.default_rng(1).normal(size=(1, 200_000, 3))
frames = np.broadcast_to(frames, (60, 200_000, 3)).copy()
flat, weights, density = frames.reshape(-1, 3), np.ones(12_000_000), frames.reshape(300, 300, 400) ** 2
particles = MassAccumulator()
struck = []
def strike():
    struck.append(time.perf_counter())
    os.kill(os.getpid(), signal.SIGINT)
threading.Timer(0.5, strike).start()
try:
    while not struck or time.perf_counter() < struck[0] + 5:
        {call}
except KeyboardInterrupt:
    print(time.perf_counter() - struck[0])
"""


@pytest.mark.alone
@pytest.mark.parametrize(
    "call",
    [
        "RigidBody.from_particles(masses, frames)",
        "particles.add(weights, flat)",
        "RigidBody.from_voxels(density, 1.0)",
    ],
)
def test_ctrl_c_is_heard_within_a_fifth_of_a_second(call: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPT.format(call=call)],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) < 0.2


LARGE = """
import hashlib, numpy as np
from polhode import MassAccumulator, RigidBody
rng = np.random.default_rng(1)
masses, positions = rng.uniform(0.1, 1, 3_000_017), rng.normal(size=(3_000_017, 3))
stream = MassAccumulator()
stream.add(masses, positions)
bodies = [
    RigidBody.from_particles(masses, positions),
    RigidBody.from_particles(masses, positions * [1e-5, 1.0, 1e-5]),
    RigidBody.from_particles(masses[:3_000_000].reshape(-1, 20), positions[:3_000_000].reshape(-1, 20, 3)),
    RigidBody.from_voxels(masses[:2_985_984].reshape(144, 144, 144), 1.0),
    stream.finish(),
]
numbers = b"".join(x.tobytes() for b in bodies for x in (b.center_of_mass, b.inertia, b.principal.axes))
print(hashlib.sha256(numbers).hexdigest())
"""


def test_any_number_of_threads_gives_the_same_bits() -> None:
    digests = {
        subprocess.run(
            [sys.executable, "-c", LARGE],
            env={**os.environ, "POLHODE_NUM_THREADS": count},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for count in ("1", "2", "5")
    }
    assert len(digests) == 1


@pytest.mark.parametrize(
    ("masses", "positions", "words"),
    [
        ([1.0, -1.0], np.zeros((2, 3)), r"masses\[1\].*-1"),
        ([0.0, 0.0], np.zeros((2, 3)), r"(?i)positive"),
        ([1.0, np.nan], np.zeros((2, 3)), r"(?i)masses.*nan"),
        ([1.0, 1.0], [[0.0, 0, 0], [0, np.inf, 0]], r"(?i)positions.*inf"),
        ([1.0, 1.0], np.zeros((3, 3)), r"shape"),
        ([1.0, 1.0], np.zeros((2, 2)), r"positions.*shape \(\.\.\., n, 3\), got \(2, 2\)"),
        ([], np.zeros((0, 3)), r"(?i)particle|positive|empty"),
    ],
)
def test_errors_name_the_argument_and_the_number(
    masses: list[float], positions: np.ndarray, words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        RigidBody.from_particles(masses, positions)


def test_errors_name_the_row_of_the_stack() -> None:
    masses = np.ones((6, 2))
    masses[4, 1] = -2.5
    with pytest.raises(ValueError, match=r"\b4\b.*-2\.5"):
        RigidBody.from_particles(masses, np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]))
