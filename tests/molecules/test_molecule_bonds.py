"""Bond lengths with a sigma, against NumPy alone; which bonds there are; what is refused."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
import pytest
from oracles.stretched import WATER, built, lengths_of, tensor, tree
from polhode import molecules
from polhode.errors import PolhodeError
from polhode.molecules import bonding, bonds

if TYPE_CHECKING:
    from pathlib import Path

RigidBody: Any = polhode.RigidBody
uncertain_positions: Any = molecules.uncertain_positions
DRAWS = 40_000


def test_bond_lengths_against_differences() -> None:
    """Derivatives of tensor and moments by each bond length, of random trees of atoms."""
    rng = np.random.default_rng(3)
    for _ in range(25):
        count = int(rng.integers(2, 12))
        places, pairs = tree(rng, count)
        masses = rng.uniform(1.0, 20.0, count)
        sigma = rng.uniform(0.001, 0.004, len(pairs))
        body = RigidBody.from_particles(masses, uncertain_positions(["C"] * count, places, sigma, pairs))
        at, h = lengths_of(places, pairs), 1e-4
        steps = h * np.eye(len(pairs))
        slopes = (
            tensor(masses, built(places, pairs, at + steps))
            - tensor(masses, built(places, pairs, at - steps))
        ) / (2 * h)
        expected = np.sqrt(np.einsum("bij,b->ij", slopes**2, sigma**2))
        np.testing.assert_allclose(body.sigma.inertia, expected, rtol=1e-7, atol=1e-9)
        axes = body.principal.axes
        by_moments = np.einsum("ik,bij,jk->bk", axes, slopes, axes)
        np.testing.assert_allclose(
            body.sigma.principal_moments, np.sqrt(sigma**2 @ by_moments**2), rtol=1e-7, atol=1e-9
        )


@pytest.mark.parametrize("n", [DRAWS, pytest.param(400_000, marks=pytest.mark.long)])
def test_bond_lengths_against_draws(n: int) -> None:
    """Sigmas of tensor and moments within 1 % and three times what so many draws leave open, or flagged."""
    rng = np.random.default_rng(5)
    flagged = total = 0
    for _ in range(8):
        count = int(rng.integers(3, 8))
        places, pairs = tree(rng, count)
        masses, sigma = rng.uniform(1.0, 20.0, count), rng.uniform(0.002, 0.006, len(pairs))
        body = RigidBody.from_particles(masses, uncertain_positions(["C"] * count, places, sigma, pairs))
        draws = lengths_of(places, pairs) + sigma * rng.normal(size=(n, len(pairs)))
        tensors = tensor(masses, built(places, pairs, draws))
        found = body.sigma
        for drawn, name in ((tensors, "inertia"), (np.linalg.eigvalsh(tensors), "principal_moments")):
            flags, deviations = getattr(found.linear, name), drawn.std(axis=0)
            allowed = (0.01 + 3 / np.sqrt(2 * n)) * deviations + 1e-12
            close = np.abs(getattr(found, name) - deviations) <= allowed
            assert (close | ~flags).all()
            flagged, total = flagged + int((~flags).sum()), total + flags.size
    assert flagged <= 0.1 * total


def test_either_side_may_move(rng: np.random.Generator) -> None:
    """Moments about C change by the same; the centre does not."""
    for _ in range(20):
        count = int(rng.integers(2, 9))
        places, pairs = tree(rng, count)
        masses = rng.uniform(1.0, 20.0, count)
        turned = [pair[::-1] if rng.integers(2) else pair for pair in pairs]
        one, other = (
            RigidBody.from_particles(masses, uncertain_positions(["C"] * count, places, 0.003, which))
            for which in (pairs, turned)
        )
        scale = np.abs(one.covariance[4:, 4:]).max()
        np.testing.assert_allclose(one.covariance[4:, 4:], other.covariance[4:, 4:], atol=1e-12 * scale)
        if turned != pairs:
            assert not np.allclose(one.covariance[1:4, 1:4], other.covariance[1:4, 1:4], rtol=1e-3)


def test_each_bond_is_a_source_of_its_own() -> None:
    places = uncertain_positions(["O", "H", "H"], WATER, 0.003)
    again = uncertain_positions(["O", "H", "H"], WATER, 0.003)
    light, heavy, other = (
        RigidBody.from_particles(masses, at)
        for masses, at in (((16.0, 1.0, 1.0), places), ((16.0, 2.0, 2.0), places), ((16.0, 2.0, 2.0), again))
    )
    assert np.abs(light.covariance_with(heavy)).max() > 0.0
    assert not light.covariance_with(other).any()
    # The hydrogens move apart from one another: their places are not correlated.
    covariance = places.covariance
    assert not covariance[3:6, 6:9].any()
    assert covariance[3, 3] == pytest.approx((0.003 * 0.757) ** 2 / (0.757**2 + 0.587**2))


def test_sigma_of_zero_is_the_body_as_it_was() -> None:
    masses = [16.0, 1.0, 1.0]
    exact = RigidBody.from_particles(masses, WATER)
    found = RigidBody.from_particles(masses, uncertain_positions(["O", "H", "H"], WATER, 0.0))
    assert (found.inertia == exact.inertia).all()
    assert (found.center_of_mass == exact.center_of_mass).all()
    assert not found.covariance.any()


def test_rings_are_refused() -> None:
    angles = np.arange(6) * np.pi / 3
    ring = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=-1)
    benzene, labels = np.concatenate([1.39 * ring, 2.48 * ring]), ["C"] * 6 + ["H"] * 6
    pairs = bonds(labels, benzene)
    assert len(pairs) == 12
    with pytest.raises(
        PolhodeError, match=r"\(0, 1\) from C to C is in a ring of 6 atoms.*covariance of their own"
    ):
        uncertain_positions(labels, benzene, 0.003)
    # The way out: bonds of the ring as exact, those to the hydrogens not.
    sigma = [0.0 if j < 6 else 0.003 for _, j in pairs]
    body = RigidBody.from_particles([12.0] * 6 + [1.0] * 6, uncertain_positions(labels, benzene, sigma))
    # Izz = Σ m r², each hydrogen at 2.48 by itself: six sources, and C moves to second order alone.
    assert body.sigma.inertia[2, 2] == pytest.approx(np.sqrt(6) * 2 * 2.48 * 0.003, rel=1e-12)
    # Spiro: two rings that share an atom, and a bond between two rings, which is in none.
    two = [(0, 1), (1, 2), (2, 0), (2, 3), (3, 4), (4, 5), (5, 3)]
    places = np.random.default_rng(1).normal(size=(6, 3))
    sigma = [0.003 if bond == (2, 3) else 0.0 for bond in two]
    moved = uncertain_positions(["C"] * 6, places, sigma, two)
    assert moved.sigma[:3].tolist() == [[0.0] * 3] * 3
    np.testing.assert_allclose(np.linalg.norm(moved.sigma[3:], axis=1), 0.003)
    for k, bond in enumerate(two):
        if bond != (2, 3):
            sigma = [0.003 if place == k else 0.0 for place in range(7)]
            with pytest.raises(PolhodeError, match="in a ring of 3 atoms"):
                uncertain_positions(["C"] * 6, places, sigma, two)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"bonds": [(0, 3)]}, "no atom 3"),
        ({"bonds": [(-1, 0)]}, "no atom -1"),
        ({"bonds": [(1, 1)]}, "to itself"),
        ({"bonds": [(0, 1), (1, 0)]}, "stands twice"),
        ({"bonds": [(0, 0.5)]}, "whole number"),
        ({"bonds": [(0, np.inf)]}, "whole number"),
        ({"bonds": [0, 1]}, "pairs of indices"),
        ({"bonds": [(0, 1)], "sigma": [0.1, 0.1]}, "one for each of 1 bonds"),
        ({"sigma": -0.1}, "expected finite standard deviations"),
        ({"sigma": np.nan}, "finite"),
        ({"positions": WATER[:2]}, r"expected shape \(3, 3\)"),
        ({"positions": WATER * 0.0, "bonds": [(0, 1)]}, "no direction"),
        ({"positions": WATER + np.inf}, "expected finite coordinates"),
        ({"labels": ["O", "H", "Xx"]}, "not an element"),
    ],
)
def test_what_is_no_molecule_is_refused(given: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        uncertain_positions(**{"labels": ["O", "H", "H"], "positions": WATER, "sigma": 0.003, **given})


def test_bonds_are_found(monkeypatch: pytest.MonkeyPatch, rng: np.random.Generator) -> None:
    """By the rule itself, pair by pair, of Cordero's radii, however many pairs are looked at together."""
    radii = {"H": 0.31, "C": 0.76, "N": 0.71, "O": 0.66, "F": 0.57}
    labels = rng.choice(list(radii), 40).tolist()
    places = rng.uniform(0.0, 6.0, (40, 3))
    expected = [
        (i, j)
        for i in range(40)
        for j in range(i + 1, 40)
        if np.linalg.norm(places[j] - places[i]) < radii[labels[i]] + radii[labels[j]] + 0.45
    ]
    assert expected
    for block in (1, 100, 1 << 20):
        monkeypatch.setattr(bonding, "_BLOCK", block)
        assert bonds(labels, places) == expected
    assert bonds(["D", "18O"], [(0, 0, 0), (0, 0, 1)]) == [(0, 1)]
    with pytest.raises(PolhodeError, match="no covalent radius of Fm"):
        bonds(["Fm"], [(0, 0, 0)])


def test_bonds_of_known_molecules(eight_molecules: Path) -> None:
    from polhode.io import read_xyz

    counts = {"h2o": 2, "co2": 2, "nh3": 3, "h2co": 3, "ch4": 4, "sf6": 6, "c6h6_re": 12, "c6h6_r0": 12}
    for name, count in counts.items():
        molecule = read_xyz(eight_molecules / f"{name}.xyz")
        assert len(bonds(molecule.labels, molecule.positions)) == count
