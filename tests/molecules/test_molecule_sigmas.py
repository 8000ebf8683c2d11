"""Sigmas of molecules, against NumPy alone: masses of isotopes, rotational constants, reports."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
import pytest
from command_line import run
from oracles.stretched import WATER, built, lengths_of, tensor, tree
from polhode import molecules
from polhode.errors import PolhodeError
from polhode.molecules import isotopes, rotational_constants_sigma, uncertain_masses

if TYPE_CHECKING:
    from pathlib import Path

RigidBody: Any = polhode.RigidBody
uncertain_positions: Any = molecules.uncertain_positions
DRAWS = 40_000
# h/(8 π² u) in MHz u angstrom² and the relative sigma of u, of CODATA 2022.
FACTOR = 6.62607015e-34 / (8 * np.pi**2 * 1.66053906892e-27 * 1e-20) / 1e6
SIGMA_OF_U = 0.00000000052e-27 / 1.66053906892e-27


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


def test_sigmas_of_constants_that_are_none() -> None:
    for wrong in (-0.1, np.nan):
        with pytest.raises(PolhodeError, match="0 or more"):
            rotational_constants_sigma((1.0, 2.0, 3.0), (wrong, 0.1, 0.1))


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
