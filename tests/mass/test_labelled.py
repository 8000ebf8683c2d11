"""Particles with labels that have gaps, at once and in chunks."""

from __future__ import annotations

import numpy as np
import pytest
from polhode import RigidBody, labelled
from polhode.errors import InvalidInertiaError


def cloud(rng: np.random.Generator, n: int = 3000) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    names = np.array([-(2**62), -7, -1, 0, 3, 1007, 2**62])
    return rng.random(n), rng.normal(size=(n, 3)) + 10.0, names[rng.integers(0, len(names), n)]


def test_each_label_has_the_body_of_its_particles(rng: np.random.Generator) -> None:
    masses, positions, labels = cloud(rng)
    found = labelled.bodies(masses, positions, labels)
    assert found.labels.tolist() == [-(2**62), -7, 0, 3, 1007, 2**62]
    for name, body in zip(found.labels, found.bodies, strict=True):
        own = labels == name
        assert body == RigidBody.from_particles(masses[own], positions[own])


def test_without_gaps_it_is_the_stack(rng: np.random.Generator) -> None:
    masses, positions, _ = cloud(rng)
    labels = rng.integers(-1, 9, len(masses))
    assert labelled.bodies(masses, positions, labels).bodies == RigidBody.from_labelled_particles(
        masses, positions, labels
    )
    unsigned = rng.integers(0, 9, len(masses)).astype(np.uint16)
    assert labelled.bodies(masses, positions, unsigned).labels.tolist() == list(range(9))


@pytest.mark.parametrize("cuts", [1, 2, 13])
def test_chunks_give_the_same_bodies(cuts: int, rng: np.random.Generator) -> None:
    masses, positions, labels = cloud(rng)
    whole = labelled.bodies(masses, positions, labels)
    one, other = labelled.Accumulator(), labelled.Accumulator()
    for k, part in enumerate(np.array_split(np.arange(len(masses)), cuts)):
        (one if k < cuts // 2 + 1 else other).add(masses[part], positions[part], labels[part])
    one.merge(other)
    found = one.finish()
    assert len(one) == 6
    assert np.array_equal(found.labels, whole.labels)
    assert np.allclose(found.bodies.inertia, whole.bodies.inertia, rtol=1e-13, atol=1e-10)
    assert np.allclose(found.bodies.center_of_mass, whole.bodies.center_of_mass, rtol=1e-14)
    one.add([1.0], [(0, 0, 0)], [5])  # going on after that
    assert 5 in one.finish().labels


def test_nothing_and_no_body() -> None:
    empty = labelled.bodies([], np.zeros((0, 3)), [])
    assert empty.bodies.shape == labelled.Accumulator().finish().bodies.shape == (0,)
    assert labelled.bodies([1.0], [(0, 0, 0)], [-1]).labels.tolist() == []


def test_a_label_without_mass_is_named() -> None:
    masses, positions, labels = [0.0, 1.0, 0.0], np.eye(3), [40, 50, 60]
    with pytest.raises(InvalidInertiaError, match=r"label 40: the total mass"):
        labelled.bodies(masses, positions, labels)
    sums = labelled.Accumulator()
    sums.add(masses, positions, labels)
    with pytest.raises(InvalidInertiaError, match=r"label 40: "):
        sums.finish()
    sums.add([2.0, 1.0], positions[:2], [40, 60])  # in a later chunk it has some
    assert sums.finish().bodies.mass.tolist() == [2.0, 1.0, 1.0]


def test_refused() -> None:
    with pytest.raises(TypeError, match="labels: expected whole numbers, got float64"):
        labelled.bodies([1.0], [(0, 0, 0)], [1.0])
    with pytest.raises(ValueError, match=r"expected shapes \(n,\), \(n, 3\) and \(n,\), got"):
        labelled.bodies([1.0, 2.0], [(0, 0, 0)], [1, 2])
    with pytest.raises(ValueError, match="beyond the whole numbers of 64 bits"):
        labelled.bodies([1.0], [(0, 0, 0)], np.array([2**63], np.uint64))
