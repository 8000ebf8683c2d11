"""Sigmas of molecules, against NumPy alone: masses of isotopes, bond lengths, rotational constants."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
import pytest
from command_line import run
from polhode import _bonds, molecules
from polhode.errors import PolhodeError
from polhode.molecules import bonds, isotopes, rotational_constants_sigma, uncertain_masses

if TYPE_CHECKING:
    from pathlib import Path

RigidBody: Any = polhode.RigidBody
uncertain_positions: Any = molecules.uncertain_positions
DRAWS = 40_000
WATER = np.array([(0.0, 0.0, 0.0), (0.757, 0.0, 0.587), (-0.757, 0.0, 0.587)])
# h/(8 π² u) in MHz u angstrom² and the relative sigma of u, of CODATA 2022.
FACTOR = 6.62607015e-34 / (8 * np.pi**2 * 1.66053906892e-27 * 1e-20) / 1e6
SIGMA_OF_U = 0.00000000052e-27 / 1.66053906892e-27


def tree(rng: np.random.Generator, count: int) -> tuple[Any, list[tuple[int, int]]]:
    """Atoms that hang on earlier ones at random, a bond each, in random order and direction."""
    places, pairs = [np.zeros(3)], []
    for atom in range(1, count):
        on = int(rng.integers(atom))
        along = rng.normal(size=3)
        places.append(places[on] + rng.uniform(0.9, 1.6) * along / np.linalg.norm(along))
        pairs.append((on, atom) if rng.integers(2) else (atom, on))
    order = rng.permutation(len(pairs))
    return np.array(places), [pairs[k] for k in order]


def built(places: Any, pairs: list[tuple[int, int]], lengths: Any) -> Any:
    """Positions of other lengths of the bonds, built outward from atom 0, shape (..., n, 3)."""
    out = np.zeros((*lengths.shape[:-1], *places.shape))
    out[..., 0, :] = places[0]
    known, rest = {0}, list(range(len(pairs)))
    while rest:
        for k in list(rest):
            ends = pairs[k] if pairs[k][0] in known else pairs[k][::-1]
            if ends[0] in known:
                along = places[ends[1]] - places[ends[0]]
                along /= np.linalg.norm(along)
                out[..., ends[1], :] = out[..., ends[0], :] + lengths[..., k, None] * along
                known.add(ends[1])
                rest.remove(k)
    return out


def tensor(masses: Any, places: Any) -> Any:
    """Tensors about the centre of mass, shape (..., 3, 3)."""
    m = np.broadcast_to(masses, places.shape[:-1])
    center = (m[..., None] * places).sum(axis=-2) / m.sum(axis=-1)[..., None]
    d = places - center[..., None, :]
    spread = np.einsum("...n,...ni,...nj->...ij", m, d, d)
    return np.trace(spread, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) - spread


def lengths_of(places: Any, pairs: list[tuple[int, int]]) -> Any:
    return np.array([np.linalg.norm(places[j] - places[i]) for i, j in pairs])


# Bond lengths ---------------------------------------------------------------------------------------------


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
        ({"bonds": [0, 1]}, "pairs of indices"),
        ({"bonds": [(0, 1)], "sigma": [0.1, 0.1]}, "one for each of 1 bonds"),
        ({"sigma": -0.1}, "not negative"),
        ({"sigma": np.nan}, "finite"),
        ({"positions": WATER[:2]}, r"expected shape \(3, 3\)"),
        ({"positions": WATER * 0.0, "bonds": [(0, 1)]}, "no direction"),
        ({"positions": WATER + np.inf}, "not finite"),
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
        monkeypatch.setattr(_bonds, "_BLOCK", block)
        assert bonds(labels, places) == expected
    assert bonds(["D", "18O"], [(0, 0, 0), (0, 0, 1)]) == [(0, 1)]
    with pytest.raises(PolhodeError, match="no covalent radius of Fm"):
        bonds(["Fm"], [(0, 0, 0)])


def test_bonds_of_known_molecules(shared_data: Path) -> None:
    from polhode.io import read_xyz

    counts = {"h2o": 2, "co2": 2, "nh3": 3, "h2co": 3, "ch4": 4, "sf6": 6, "c6h6_re": 12, "c6h6_r0": 12}
    for name, count in counts.items():
        molecule = read_xyz(shared_data / "molecules" / f"{name}.xyz")
        assert len(bonds(molecule.labels, molecule.positions)) == count


# Masses ---------------------------------------------------------------------------------------------------


def test_sigmas_of_masses() -> None:
    """Those of the Atomic Mass Evaluation 2020, within the rounding of the table that is installed."""
    evaluated = {
        "1H": (1.4e-11, 5e-12),
        "2H": (1.5e-11, 5e-12),
        "13C": (2.5e-10, 5e-12),
        "16O": (3.2e-10, 5e-11),
    }
    for name, (sigma, rounding) in evaluated.items():
        assert isotopes([name])[0].sigma == pytest.approx(sigma, abs=1.001 * rounding)
    assert isotopes(["12C"])[0].sigma == 0.0  # by the definition of u
    assert isotopes(["C"], "average")[0].sigma == pytest.approx(0.002)
    assert isotopes(["Tc"], "average")[0].sigma is None
    with pytest.raises(PolhodeError, match="no sigma of the mass of Tc"):
        uncertain_masses(["Tc"], "average")
    with pytest.raises(TypeError, match="labels"):
        uncertain_masses("CO")


def test_equal_nuclides_are_one_source() -> None:
    """In one call and in several, as labels and as what `isotopes` gave."""
    sigma: Any = {isotope.name: isotope.sigma for isotope in isotopes(["H", "O", "D"])}
    light = RigidBody.from_particles(uncertain_masses(["O", "H", "H"]), WATER)
    heavy = RigidBody.from_particles(uncertain_masses(isotopes(["O", "D", "H"])), WATER)
    hydrogen, oxygen, deuterium = (sigma[name] for name in ("1H", "16O", "2H"))
    assert light.covariance[0, 0] == pytest.approx(4 * hydrogen**2 + oxygen**2, rel=1e-12)
    assert heavy.covariance[0, 0] == pytest.approx(hydrogen**2 + deuterium**2 + oxygen**2, rel=1e-12)
    assert light.covariance_with(heavy)[0, 0] == pytest.approx(2 * hydrogen**2 + oxygen**2, rel=1e-12)
    assert isotopes(["D"]) == isotopes(["2H"])


def test_masses_and_bond_lengths_against_draws() -> None:
    """Both at once, with masses made as uncertain as lengths."""
    rng = np.random.default_rng(11)
    places, pairs = tree(rng, 5)
    atoms = [atom._replace(sigma=0.01 * atom.mass) for atom in isotopes(["C", "H", "O", "H", "N"])]
    body = RigidBody.from_particles(uncertain_masses(atoms), uncertain_positions(atoms, places, 0.004, pairs))
    relative = rng.normal(size=(DRAWS, 4)) * 0.01  # the two hydrogens are one number
    drawn = np.array([atom.mass for atom in atoms]) * (1.0 + relative[:, [0, 1, 2, 1, 3]])
    lengths = lengths_of(places, pairs) + 0.004 * rng.normal(size=(DRAWS, 4))
    moments = np.linalg.eigvalsh(tensor(drawn, built(places, pairs, lengths)))
    np.testing.assert_allclose(body.sigma.mass, drawn.sum(axis=1).std(), rtol=0.015)
    assert all(body.sigma.linear.principal_moments)
    np.testing.assert_allclose(body.sigma.principal_moments, moments.std(axis=0), rtol=0.015)


# Rotational constants -------------------------------------------------------------------------------------


def test_sigmas_of_constants(rng: np.random.Generator) -> None:
    moments, sigma = np.sort(rng.uniform(1.0, 9.0, (20, 3))), rng.uniform(0.0, 0.01, (20, 3))
    expected = FACTOR / moments * np.sqrt((sigma / moments) ** 2 + SIGMA_OF_U**2)
    np.testing.assert_allclose(rotational_constants_sigma(moments, sigma), expected, rtol=1e-12)
    waves = rotational_constants_sigma(moments, sigma, "cm^-1")
    np.testing.assert_allclose(waves, expected / 29979.2458, rtol=1e-12)
    assert np.isnan(rotational_constants_sigma([0.0, 1.0, 1.0], [0.0, 0.1, 0.1])).tolist() == [
        True,
        False,
        False,
    ]
    exact = rotational_constants_sigma([1.0, 2.0, 3.0], np.zeros(3))
    np.testing.assert_allclose(exact, FACTOR / np.array([1.0, 2.0, 3.0]) * SIGMA_OF_U, rtol=1e-12)
    with pytest.raises(ValueError, match="sigma: expected shape"):
        rotational_constants_sigma([1.0, 2.0, 3.0], 0.1)


@pytest.fixture
def water(tmp_path: Path) -> Path:
    path = tmp_path / "water.xyz"
    path.write_text("3\nwater\nO 0 0 0\nH 0.757 0 0.587\nH -0.757 0 0.587\n", "utf-8")
    return path


def drawn_water(masses: Any, sigma: float, seed: int = 2) -> Any:
    """Principal moments of water with other bond lengths, drawn."""
    rng = np.random.default_rng(seed)
    pairs = [(0, 1), (0, 2)]
    lengths = lengths_of(WATER, pairs) + sigma * rng.normal(size=(DRAWS, 2))
    return np.linalg.eigvalsh(tensor(masses, built(WATER, pairs, lengths)))


def read(*arguments: object) -> dict[str, Any]:
    code, out, err = run(*arguments, "--format", "json")
    assert (code, err) == (0, "")
    report: dict[str, Any] = json.loads(out)
    return report


@pytest.mark.parametrize("command", ["report", "molecule"])
def test_reports_of_a_molecule(water: Path, command: str) -> None:
    """Constants, moments, radii and kappa against draws."""
    report = read(command, water, "--bond-sigma", "0.003")
    masses = [atom.mass for atom in isotopes(["O", "H", "H"])]
    moments = drawn_water(masses, 0.003)
    constants = FACTOR / moments
    sigma, linear = report["sigma"], report["linear"]
    np.testing.assert_allclose(sigma["principal_moments"], moments.std(axis=0), rtol=0.015)
    np.testing.assert_allclose(sigma["rotational_constants_MHz"], constants.std(axis=0), rtol=0.015)
    assert all(linear["principal_moments"] + linear["rotational_constants_MHz"])
    # By symmetry kappa does not change to first order, but it does change: never told as linear.
    assert sigma["ray_kappa"] < 1e-12
    a, b, c = constants.T
    assert ((2 * b - a - c) / (a - c)).std() > 1e-6
    assert linear["ray_kappa"] is False
    if command == "report":
        gyration = np.sqrt(moments / sum(masses))
        np.testing.assert_allclose(sigma["radii_of_gyration"], gyration.std(axis=0), rtol=0.015)
    else:
        np.testing.assert_allclose(
            sigma["planar_moments"], [moments[:, 1].std(), moments[:, 0].std(), 0.0], rtol=0.015, atol=1e-12
        )
        assert sigma["inertial_defect"] < 1e-12
        assert linear["inertial_defect"] is True
        assert all(linear["planar_moments"])


def test_kappa_of_a_molecule_without_symmetry(water: Path) -> None:
    report = read("molecule", water, "--bond-sigma", "0.3 pm", "--isotopes", "2=D")
    row = report["isotopologues"][1]
    moments = drawn_water([atom.mass for atom in isotopes(["O", "D", "H"])], 0.003)
    a, b, c = (FACTOR / moments).T
    assert row["linear"]["ray_kappa"] is True
    assert row["sigma"]["ray_kappa"] == pytest.approx(((2 * b - a - c) / (a - c)).std(), rel=0.015)
    np.testing.assert_allclose(
        row["sigma"]["rotational_constants_MHz"], np.std([a, b, c], axis=1), rtol=0.015
    )


def test_a_linear_molecule(tmp_path: Path) -> None:
    """I = m r² of the reduced mass: sigma_B / B = 2 sigma_r / r, and no constant about the axis."""
    path = tmp_path / "co.xyz"
    path.write_text("2\nco\nC 0 0 0\nO 0 0 1.128\n", "utf-8")
    report = read("molecule", path, "--bond-sigma", "0.001")
    b = report["rotational_constants_MHz"][1]
    expected = [None, pytest.approx(2 * b * 0.001 / 1.128), pytest.approx(2 * b * 0.001 / 1.128)]
    assert report["sigma"]["rotational_constants_MHz"] == expected
    assert report["linear"]["rotational_constants_MHz"] == [True] * 3
    assert report["sigma"]["axes"][0] is None
    table = run("molecule", path, "--bond-sigma", "0.001")[1]
    assert "not determined" in table
    assert "*" not in table


def test_sigmas_of_masses_in_reports(water: Path) -> None:
    for command in ("report", "molecule"):
        report = read(command, water, "--mass-sigmas")
        hydrogen, oxygen = (isotope.sigma for isotope in isotopes(["H", "O"]))
        assert report["sigma"]["isotope_masses"] == {"16O": oxygen, "1H": hydrogen}
        assert report["sigma"]["mass"] == pytest.approx(np.hypot(2 * (hydrogen or 0), oxygen or 0))
        a = report["rotational_constants_MHz"][0]
        # What the masses add is less than the sigma of u, which each constant has.
        assert SIGMA_OF_U * a <= report["sigma"]["rotational_constants_MHz"][0] < 1.1 * SIGMA_OF_U * a


def test_the_unit_of_the_file_is_that_of_a_bare_sigma(tmp_path: Path, water: Path) -> None:
    path = tmp_path / "nm.xyz"
    path.write_text("3\nwater\nO 0 0 0\nH 0.0757 0 0.0587\nH -0.0757 0 0.0587\n", "utf-8")
    expected = read("report", water, "--bond-sigma", "0.003")["sigma"]["principal_moments"]
    for text in ("0.0003", "0.3 pm", "0.003 angstrom"):
        report = read("report", path, "--length-unit", "nm", "--bond-sigma", text)
        np.testing.assert_allclose(report["sigma"]["principal_moments"], expected, rtol=1e-9)


def test_notes_tell_the_bonds_and_the_parts(tmp_path: Path, water: Path) -> None:
    notes = " ".join(read("report", water, "--bond-sigma", "0.003")["notes"])
    assert "16O(1)-1H(2), 16O(1)-1H(3)" in notes
    pair = tmp_path / "pair.xyz"
    pair.write_text("4\ntwo\nH 0 0 0\nH 0 0 0.74\nH 0 9 0\nH 0 9 0.74\n", "utf-8")
    assert "no bonds join 2 parts" in " ".join(read("report", pair, "--bond-sigma", "0.003")["notes"])
