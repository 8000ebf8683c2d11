"""Particles with labels that have gaps, at once and in chunks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from polhode import LabelledMassAccumulator, RigidBody
from polhode.errors import InvalidInertiaError


def cloud(rng: np.random.Generator, n: int = 3000) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    names = np.array([-(2**62), -7, -1, 0, 3, 1007, 2**62])
    return rng.random(n), rng.normal(size=(n, 3)) + 10.0, names[rng.integers(0, len(names), n)]


def test_each_label_has_the_body_of_its_particles(rng: np.random.Generator) -> None:
    masses, positions, labels = cloud(rng)
    names, bodies = RigidBody.from_labelled_particles(masses, positions, labels, return_labels=True)
    assert names.tolist() == [-(2**62), -7, 0, 3, 1007, 2**62]
    for name, body in zip(names, bodies, strict=True):
        own = labels == name
        assert body == RigidBody.from_particles(masses[own], positions[own])


def test_without_gaps_it_is_the_stack(rng: np.random.Generator) -> None:
    masses, positions, _ = cloud(rng)
    labels = rng.integers(-1, 9, len(masses))
    _, bodies = RigidBody.from_labelled_particles(masses, positions, labels, return_labels=True)
    assert bodies == RigidBody.from_labelled_particles(masses, positions, labels)
    unsigned = rng.integers(0, 9, len(masses)).astype(np.uint16)
    names, _ = RigidBody.from_labelled_particles(masses, positions, unsigned, return_labels=True)
    assert names.tolist() == list(range(9))


@pytest.mark.parametrize("cuts", [1, 2, 13])
def test_chunks_give_the_same_bodies(cuts: int, rng: np.random.Generator) -> None:
    masses, positions, labels = cloud(rng)
    names, whole = RigidBody.from_labelled_particles(masses, positions, labels, return_labels=True)
    one, other = LabelledMassAccumulator(), LabelledMassAccumulator()
    for k, part in enumerate(np.array_split(np.arange(len(masses)), cuts)):
        (one if k < cuts // 2 + 1 else other).add(masses[part], positions[part], labels[part])
    one.merge(other)
    found_names, found = one.finish()
    assert len(one) == 6
    assert np.array_equal(found_names, names)
    assert np.allclose(found.inertia, whole.inertia, rtol=1e-13, atol=1e-10)
    assert np.allclose(found.center_of_mass, whole.center_of_mass, rtol=1e-14)
    one.add([1.0], [(0, 0, 0)], [5])  # going on after that
    assert 5 in one.finish()[0]


def test_nothing_and_no_body() -> None:
    _, empty = RigidBody.from_labelled_particles([], np.zeros((0, 3)), [], return_labels=True)
    assert empty.shape == LabelledMassAccumulator().finish()[1].shape == (0,)
    names, _ = RigidBody.from_labelled_particles([1.0], [(0, 0, 0)], [-1], return_labels=True)
    assert names.tolist() == []


def test_a_label_without_mass_is_named() -> None:
    masses, positions, labels = [0.0, 1.0, 0.0], np.eye(3), [40, 50, 60]
    with pytest.raises(InvalidInertiaError, match=r"label 40: the total mass") as caught:
        RigidBody.from_labelled_particles(masses, positions, labels, return_labels=True)
    assert caught.value.label == 40
    sums = LabelledMassAccumulator()
    sums.add(masses, positions, labels)
    with pytest.raises(InvalidInertiaError, match=r"label 40: "):
        sums.finish()
    sums.add([2.0, 1.0], positions[:2], [40, 60])  # in a later chunk it has some
    assert sums.finish()[1].mass.tolist() == [2.0, 1.0, 1.0]


@pytest.mark.parametrize(
    "bodies",
    [
        lambda *given: RigidBody.from_labelled_particles(*given, return_labels=True),
        LabelledMassAccumulator().add,
    ],
)
def test_refused(bodies: Callable[..., object]) -> None:
    with pytest.raises(TypeError, match="labels: expected integers, got dtype float64"):
        bodies([1.0], [(0, 0, 0)], [1.0])
    with pytest.raises(ValueError, match=r"expected shape"):
        bodies([1.0, 2.0], [(0, 0, 0)], [1, 2])
    with pytest.raises(ValueError, match=r"labels: .*expected shape"):
        bodies([1.0], [(0, 0, 0)], [1, 2])
    with pytest.raises(
        ValueError, match="labels: 9223372036854775808 is beyond the whole numbers of 64 bits"
    ):
        bodies([1.0], [(0, 0, 0)], np.array([2**63], np.uint64))
