"""Bodies of particles beside NumPy's recipes, and beside a plain sum over the same arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from harness import Row
from polhode import MassAccumulator, RigidBody

if TYPE_CHECKING:
    from collections.abc import Iterator

COUNT = 10_000_000
BODIES, ATOMS = 10_000, 20


def central_inertia(masses: Any, positions: Any) -> Any:
    """NumPy's fastest recipe for one body, by matrix products; leading axes stack."""
    total = masses.sum(-1)[..., None]
    center = (masses[..., None, :] @ positions)[..., 0, :] / total
    arms = positions - center[..., None, :]
    second = (arms * masses[..., None]).swapaxes(-1, -2) @ arms
    return np.trace(second, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) - second


def streamed(masses: Any, positions: Any) -> RigidBody:
    """The body of all particles, a million at a time."""
    particles = MassAccumulator()
    for start in range(0, len(masses), 1 << 20):
        particles.add(masses[start : start + (1 << 20)], positions[start : start + (1 << 20)])
    return particles.finish()


def same_body(ours: RigidBody, theirs: RigidBody) -> None:
    """Both to rounding."""
    assert bool(ours.isclose(theirs, rtol=1e-13))


def same_mass(ours: RigidBody, theirs: RigidBody) -> None:
    """Of the same particles in other places only the mass is the same."""
    assert ours.mass == theirs.mass
    assert ours.principal_moments[0] < 1e-5 * ours.principal_moments[2]


def rows() -> Iterator[Row]:
    """Yield the comparisons of this file."""
    rng = np.random.default_rng(1)
    masses, positions = rng.uniform(0.5, 1.0, COUNT), rng.normal(size=(COUNT, 3))
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    thin = np.ascontiguousarray(positions * [1.0, 1e-3, 1e-3] @ turn)

    def same_inertia(ours: RigidBody, theirs: Any) -> None:
        assert np.abs(ours.inertia - theirs).max() < 1e-12 * np.abs(theirs).max()

    def same_sums(ours: RigidBody, theirs: tuple[float, float]) -> None:
        assert abs(ours.mass / theirs[0] - 1) < 1e-12
        scale = np.abs(positions[0]).max() * COUNT
        assert abs(float((masses @ positions).sum()) - ours.mass * ours.center_of_mass.sum()) < 1e-9 * scale

    yield Row(
        name="inertia of 1e7 particles",
        peer="numpy: a plain sum",
        ours=lambda: RigidBody.from_particles(masses, positions),
        theirs=lambda: (masses.sum(), positions.sum()),
        compare=same_sums,
        items=COUNT,
        at_least=0.7,
    )
    yield Row(
        name="inertia of 1e7 particles",
        peer="the memory: BLAS ddot",
        ours=lambda: RigidBody.from_particles(masses, positions),
        theirs=lambda: (masses @ masses, positions.ravel() @ positions.ravel()),
        compare=lambda *_: None,
        items=COUNT,
        at_most=1.2,
    )
    yield Row(
        name="inertia of 1e7 particles",
        peer="numpy: matrix products",
        ours=lambda: RigidBody.from_particles(masses, positions),
        theirs=lambda: central_inertia(masses, positions),
        compare=same_inertia,
        items=COUNT,
        at_least=15,
    )
    yield Row(
        name="a thin body of 1e7 particles",
        peer="polhode: an ordinary one",
        ours=lambda: RigidBody.from_particles(masses, thin),
        theirs=lambda: RigidBody.from_particles(masses, positions),
        compare=same_mass,
        items=COUNT,
        at_most=5,
    )
    yield Row(
        name="1e7 particles through a stream",
        peer="polhode: at once",
        ours=lambda: streamed(masses, positions),
        theirs=lambda: RigidBody.from_particles(masses, positions),
        compare=same_body,
        items=COUNT,
    )

    labels = rng.integers(0, 1000, 1_000_000)
    some = slice(1_000_000)

    def by_label() -> Any:
        order = np.argsort(labels, kind="stable")
        ends = np.cumsum(np.bincount(labels))[:-1]
        pairs = zip(np.split(masses[some][order], ends), np.split(positions[some][order], ends), strict=True)
        return np.stack([central_inertia(m, r) for m, r in pairs])

    yield Row(
        name="1e6 particles with 1e3 labels",
        peer="numpy: sorted, body by body",
        ours=lambda: RigidBody.from_labelled_particles(masses[some], positions[some], labels),
        theirs=by_label,
        compare=same_inertia,
        items=1_000_000,
    )

    small_masses = masses[: BODIES * ATOMS].reshape(BODIES, ATOMS)
    frames = positions[: BODIES * ATOMS].reshape(BODIES, ATOMS, 3)

    def same_moments(ours: Any, theirs: Any) -> None:
        assert np.abs(ours.moments / theirs.eigenvalues - 1).max() < 1e-12

    for name, weights in (
        ("1e4 bodies x 20 particles, moments and axes", small_masses),
        ("1e4 frames of 20 particles, moments and axes", small_masses[0]),
    ):
        yield Row(
            name=name,
            peer="numpy: products, eigh",
            ours=lambda weights=weights: RigidBody.from_particles(weights, frames).principal,
            theirs=lambda weights=weights: np.linalg.eigh(central_inertia(weights, frames)),
            compare=same_moments,
            items=BODIES,
            at_least=5,
        )
