"""Particles in chunks: the same body however they are cut, and thin bodies without a second pass."""

from __future__ import annotations

import itertools
import pickle
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import errors as errors_of
from oracles import worst_error
from oracles.bodies import matrix
from oracles.exact_particles import Particles, moments
from polhode import MassAccumulator, RigidBody, errors

BLOCK = 4096


def summed(*chunks: tuple[Any, Any]) -> RigidBody:
    particles = MassAccumulator()
    for masses, positions in chunks:
        particles.add(masses, positions)
    return particles.finish()


@pytest.fixture(scope="module")
def cloud() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(5)
    count = 5 * BLOCK + 1234
    return rng.uniform(0, 2, count), rng.normal((1e3, 0, -1e3), size=(count, 3))


@given(cuts=st.lists(st.integers(0, 5 * BLOCK + 1234), max_size=12))
@settings(max_examples=25)
def test_the_bits_do_not_depend_on_the_cuts(cloud: Any, cuts: list[int]) -> None:
    masses, positions = cloud
    edges = [0, *sorted(cuts), len(masses)]
    chunks = [(masses[a:b], positions[a:b]) for a, b in itertools.pairwise(edges)]
    assert summed(*chunks) == summed((masses, positions))


@given(order=st.permutations(range(7)), step=st.sampled_from([BLOCK, 3 * BLOCK, 3100]))
@settings(max_examples=25)
def test_nor_on_the_order_of_chunks_with_a_place(cloud: Any, order: list[int], step: int) -> None:
    masses, positions = cloud
    workers = [MassAccumulator() for _ in range(3)]
    starts = range(0, len(masses), step)
    for turn, start in enumerate(sorted(starts, key=lambda s: order[s // step % 7])):
        chunk = slice(start, start + step)
        workers[turn % 3].add(masses[chunk], positions[chunk], start=start)
    for worker in workers[1:]:
        workers[0].merge(worker)
    assert workers[0].count == len(masses)
    assert workers[0].finish() == summed(cloud)


def test_accumulators_without_places_are_appended(cloud: Any) -> None:
    masses, positions = cloud
    left, right, empty = MassAccumulator(), MassAccumulator(), MassAccumulator()
    left.add(masses[:5000], positions[:5000])
    right.add(masses[5000:], positions[5000:])
    left.merge(empty)
    left.merge(right)
    whole = summed(cloud)
    assert left.count == len(masses)
    assert bool(left.finish().isclose(whole, rtol=1e-15))
    assert right.count == len(masses) - 5000
    # Appended where a block ends, the particles are summed as if they had been added there.
    left, right = MassAccumulator(), MassAccumulator()
    left.add(masses[: 4 * BLOCK], positions[: 4 * BLOCK])
    right.add(masses[4 * BLOCK :], positions[4 * BLOCK :])
    left.merge(right)
    assert left.finish() == whole


def test_it_agrees_with_the_body_of_all_particles(cloud: Any) -> None:
    body, whole = summed(cloud), RigidBody.from_particles(*cloud)
    assert bool(body.isclose(whole, rtol=2e-15))


@pytest.mark.parametrize("distance", [0.0, 1e3, 1e8])
def test_a_stream_has_its_exact_inertia(distance: float, rng: np.random.Generator) -> None:
    masses = rng.uniform(0.1, 1, 5000)
    positions = rng.normal(size=(5000, 3)) + distance * np.array([1.0, -0.7, 0.3])
    body = summed((masses[:1234], positions[:1234]), (masses[1234:], positions[1234:]))
    exact = Particles(masses, positions)
    assert worst_error(body.inertia, exact.inertia) <= 1e-15
    reach = max(1.0, distance)
    assert worst_error(body.center_of_mass, exact.center_of_mass, scale=reach) <= 2.3e-16


@pytest.mark.parametrize("distance", [0.0, 1e3])
@pytest.mark.parametrize("thickness", [1e-2, 1e-4, 1e-6, 1e-7, 1e-8])
def test_thin_bodies_keep_their_smallest_moment_without_a_second_pass(
    thickness: float, distance: float, rng: np.random.Generator
) -> None:
    turn = rng.normal(size=4)
    masses = rng.uniform(0.1, 1, 6000)
    positions = rng.uniform(-0.5, 0.5, (6000, 3)) * [thickness, thickness, 1.0]
    positions = positions @ matrix(turn / np.linalg.norm(turn)).T + distance * np.array([0.6, -0.5, 0.7])
    body = summed(*zip(np.array_split(masses, 7), np.array_split(positions, 7), strict=True))
    exact = moments(Particles(masses, positions).inertia)
    assert body.principal_moments == pytest.approx(exact, rel=1e-14, abs=0)


@pytest.mark.parametrize("thickness", 10.0 ** -np.arange(1, 13))
def test_bounds_hold_at_any_thickness(thickness: float, rng: np.random.Generator) -> None:
    for count, scale in ((7, 1e-10), (500, 1.0), (5000, 1e8)):
        masses = rng.uniform(0.1, 1, count)
        positions = rng.uniform(-0.5, 0.5, (count, 3)) * [thickness, thickness, 1.0] * scale
        turn = rng.normal(size=4)
        positions = positions @ matrix(turn / np.linalg.norm(turn)).T + scale
        particles = MassAccumulator()
        particles.add(masses, positions)
        bounds, found = particles.moment_bounds(), particles.finish().principal_moments
        whole = Particles(masses, positions)
        exact = moments(whole.inertia)
        assert (np.abs(found - exact) <= bounds).all()
        body = particles.finish()
        assert max(errors_of(body.mass, whole.mass)) <= body.error_bound.mass
        assert max(errors_of(body.center_of_mass, whole.center_of_mass)) <= body.error_bound.center_of_mass
        assert max(errors_of(body.inertia, whole.inertia)) <= body.error_bound.inertia
        # Worst cases, but not idle: the smallest moment has known digits down to a thickness of 1e-10.
        if thickness >= 1e-10:
            assert bounds[0] <= 1e-4 * found[0]


def test_it_reads_memory_maps_and_iterators(cloud: Any, tmp_path: Path) -> None:
    masses, positions = cloud
    rows = np.column_stack([masses, positions])
    rows.tofile(tmp_path / "particles")
    mapped = np.memmap(tmp_path / "particles", dtype=np.float64).reshape(-1, 4)
    chunks = (mapped[start : start + 3000] for start in range(0, len(mapped), 3000))
    assert summed(*((chunk[:, 0], chunk[:, 1:]) for chunk in chunks)) == summed(cloud)


def test_it_pickles_with_every_bit(cloud: Any) -> None:
    masses, positions = cloud
    particles = MassAccumulator()
    particles.add(masses[:9000], positions[:9000])
    copy = pickle.loads(pickle.dumps(particles))
    assert copy.count == 9000
    for each in (particles, copy):
        each.add(masses[9000:], positions[9000:])
    assert copy.finish() == particles.finish() == summed(cloud)
    accumulator: Any = MassAccumulator  # the method is pickle's own, and in no stub
    with pytest.raises(ValueError, match="MassAccumulator"):
        accumulator._from_bytes(b"anything else")


def test_several_threads_may_add(cloud: Any) -> None:
    masses, positions = cloud
    particles = MassAccumulator()

    def add(start: int) -> None:
        particles.add(masses[start : start + 1000], positions[start : start + 1000], start=start)

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(add, range(0, len(masses), 1000)))
    assert particles.finish() == summed(cloud)


def test_finish_may_be_asked_for_again() -> None:
    particles = MassAccumulator()
    particles.add([1.0], [(0, 0, 0)])
    assert particles.finish().principal.top == "point"
    particles.add([0.0, 3.0], [(1e300, 0, 0), (4, 0, 0)])
    assert particles.finish().principal_moments.tolist() == [0.0, 12.0, 12.0]
    assert repr(particles) == "<MassAccumulator of 3 particles>"


@pytest.mark.parametrize(
    ("masses", "positions", "start", "words"),
    [
        ([1.0, -1.0], np.zeros((2, 3)), None, r"masses\[1\].*-1"),
        ([1.0] * 9999 + [-2.0], np.zeros((10_000, 3)), None, r"masses\[9999\].*-2"),
        ([1.0], [[0.0, np.nan, 0.0]], None, r"(?i)positions.*nan"),
        ([1.0] * 9000, np.full((9000, 3), np.inf), None, r"(?i)positions.*inf"),
        ([1.0], np.zeros((2, 3)), None, r"n = 1 and n = 2"),
        (1.0, np.zeros((2, 3)), None, r"masses.*shape \(n\), got \(\)"),
        ([1.0, 2.0], np.zeros((2, 3)), 2, r"2 to 3 meet the particles 0 to 2.*leave start out"),
        ([1.0], np.zeros((1, 3)), -1, r"start.*-1"),
        ([1.0], np.zeros((1, 3)), 2**64 - 1, r"start.*2\^64"),
    ],
)
def test_errors_leave_it_as_it_was(masses: Any, positions: Any, start: Any, words: str) -> None:
    particles = MassAccumulator()
    particles.add(np.ones(3), np.eye(3))
    before = particles.finish()
    with pytest.raises(ValueError, match=words):
        particles.add(masses, positions, start)
    assert (particles.count, particles.finish()) == (3, before)


def test_what_was_never_added_is_told() -> None:
    particles = MassAccumulator()
    with pytest.raises(errors.InvalidInertiaError, match="0 particles"):
        particles.finish()
    particles.add([1.0], [(0, 0, 0)], start=5)
    with pytest.raises(errors.PolhodeError, match="particles 0 to 4 have not been added"):
        particles.finish()
    other = MassAccumulator()
    other.add(np.ones(6), np.zeros((6, 3)), start=0)
    with pytest.raises(errors.PolhodeError, match="meet"):
        particles.merge(other)
    assert particles.count == 1
