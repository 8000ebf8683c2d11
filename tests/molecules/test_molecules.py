"""Isotope masses and rotational constants against published values; ``polhode molecule``."""

from __future__ import annotations

import doctest
import json
import sys
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import pytest
from command_line import run
from polhode import RigidBody, molecules, units
from polhode.errors import PolhodeError
from polhode.molecules import inertial_defect, isotopes, planar_moments, ray_kappa, rotational_constants

if TYPE_CHECKING:
    from pathlib import Path

if TYPE_CHECKING:
    from pathlib import Path

# Atomic Mass Evaluation 2020 (Wang et al., Chinese Physics C 45, 030003), in u.
AME2020 = {
    "1H": 1.007825031898,
    "2H": 2.014101777844,
    "12C": 12.0,
    "13C": 13.00335483534,
    "14N": 14.00307400425,
    "16O": 15.99491461926,
    "18O": 17.99915961214,
    "19F": 18.99840316207,
    "32S": 31.97207117354,
    "35Cl": 34.968852694,
}

# Constants in cm^-1 with most-abundant-isotope masses, by an independent computation; Ray's kappa.
CONSTANTS = {
    "h2o": ((27.374531, 14.586502, 9.515940), "asymmetric", -0.43214),
    "nh3": ((9.966451, 9.966451, 6.340830), "oblate", None),
    "h2co": ((9.406977, 1.295030, 1.138321), "asymmetric", -0.96210),
    "ch4": ((5.240925, 5.240925, 5.240925), "spherical", None),
    "sf6": ((0.091036, 0.091036, 0.091036), "spherical", None),
    "c6h6_re": ((0.191204, 0.191204, 0.095602), "oblate", None),
    "c6h6_r0": ((0.189692, 0.189692, 0.094846), "oblate", None),
    "co2": ((np.inf, 0.391623, 0.391623), "linear", None),
}


@pytest.mark.parametrize("name", AME2020)
def test_isotope_masses(name: str) -> None:
    (isotope,) = isotopes([name])
    assert isotope.name == name
    # The sixth decimal of a rotational constant moves at relative changes of 1e-8 and more.
    assert isotope.mass == pytest.approx(AME2020[name], rel=5e-9)


def test_labels() -> None:
    labels = ["C", "c", "6", "Cl", "CL", "H", "D", "T", "2H", "13C", "235U"]
    names = ["12C", "12C", "12C", "35Cl", "35Cl", "1H", "2H", "3H", "2H", "13C", "235U"]
    assert [isotope.name for isotope in isotopes(labels)] == names


@pytest.mark.parametrize(
    ("label", "message"),
    [
        ("Xx", "'Xx' is not an element"),
        ("0", "'0' is not an element"),
        ("200", "'200' is not an element"),
        ("2D", "'2D' is not an element"),
        ("C1", "'C1' is not an element"),
        ("", "'' is not an element"),
        ("99C", "no isotope 99 of C"),
        ("Tc", "Tc has no natural abundance .* as in 98Tc"),
    ],
)
def test_label_that_names_nothing(label: str, message: str) -> None:
    with pytest.raises(PolhodeError, match=message):
        isotopes([label])


def test_without_periodictable_the_remedy_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "periodictable", None)
    with pytest.raises(ModuleNotFoundError, match=r'pip install "polhode\[chem\]"'):
        isotopes(["H"])


def test_conversion_factor() -> None:
    # h/(8 pi^2 u angstrom^2) = 505 379.0 MHz, the spectroscopists' factor; 16.857629 cm^-1.
    moments = [1.0, 1.0, 2.0]
    np.testing.assert_allclose(rotational_constants(moments), np.array([1, 1, 0.5]) * 505379.0, rtol=2e-7)
    np.testing.assert_allclose(rotational_constants(moments, "cm^-1")[0], 16.857629, rtol=2e-8)
    assert rotational_constants([1e-310, 1.0, 1.0])[0] == np.inf  # as of zero, without a warning


def test_zero_moment_is_an_infinite_constant() -> None:
    constants = rotational_constants([[0.0, 1.0, 1.0], [0.0, 0.0, 0.0]])
    assert constants[0, 0] == np.inf
    assert np.isfinite(constants[0, 1:]).all()
    assert (constants[1] == np.inf).all()


def test_arguments_are_checked() -> None:
    with pytest.raises(ValueError, match=r"expected shape \(\.\.\., 3\), got \(2,\)"):
        rotational_constants([1.0, 2.0])
    with pytest.raises(ValueError, match=r"expected 'MHz' or 'cm\^-1', got 'GHz'"):
        rotational_constants([1.0, 1.0, 1.0], "GHz")  # type: ignore[arg-type]


def test_kappa_of_the_limits() -> None:
    assert ray_kappa([3.0, 1.0, 1.0]) == -1.0
    assert ray_kappa([3.0, 3.0, 1.0]) == 1.0
    assert np.isnan(ray_kappa([1.0, 1.0, 1.0]))
    assert np.isnan(ray_kappa([np.inf, 1.0, 1.0]))
    # Water, from experimental constants.
    assert ray_kappa([27.877, 14.512, 9.285]) == pytest.approx(-0.43772, abs=1e-5)


@pytest.mark.parametrize("name", CONSTANTS)
def test_published_geometries(eight_molecules: Path, name: str) -> None:
    expected, top, kappa = CONSTANTS[name]
    body = RigidBody.from_file(eight_molecules / f"{name}.xyz")
    constants = rotational_constants(body.principal_moments, "cm^-1")
    assert np.isinf(constants).tolist() == np.isinf(expected).tolist()
    finite = np.isfinite(constants)
    np.testing.assert_allclose(constants[finite], np.array(expected)[finite], rtol=0, atol=1.0e-6)
    assert body.principal.top == top
    if kappa is not None:
        assert ray_kappa(constants) == pytest.approx(kappa, abs=6e-6)


def test_docstring_examples() -> None:
    for module in (molecules, units):
        result = doctest.testmod(module)
        assert result.attempted > 0
        assert result.failed == 0


# ``polhode molecule``: constants, class, kappa, inertial defect, planar moments, isotopologues.

# CODATA 2022 and Atomic Mass Evaluation 2020.
FACTOR = 6.62607015e-34 / (8 * np.pi**2 * 1.66053906892e-27 * 1e-20) / 1e6
LIGHT = 29979.2458
MASSES = {"1H": 1.007825031898, "2H": 2.014101777844, "16O": 15.99491461926, "18O": 17.99915961214}


@pytest.mark.parametrize("name", CONSTANTS)
def test_eight_molecules(name: str, eight_molecules: Path) -> None:
    constants, top, kappa = CONSTANTS[name]
    code, out, err = run("molecule", eight_molecules / f"{name}.xyz", "--format", "json")
    assert (code, err) == (0, "")
    report = json.loads(out)
    assert report["top"] == top
    for found, megahertz, known in zip(
        report["rotational_constants_cm^-1"], report["rotational_constants_MHz"], constants, strict=True
    ):
        if np.isinf(known):
            assert found == megahertz == "Infinity"
        else:
            assert abs(Fraction(round(found, 6)).limit_denominator(10**6) - Fraction(str(known))) <= Fraction(
                1, 10**6
            )
            assert megahertz == pytest.approx(found * LIGHT, rel=1e-12)
    assert report.get("ray_kappa") == (None if kappa is None else pytest.approx(kappa, abs=6e-6))
    a, b, c = report["principal_moments"]
    assert report["inertial_defect"] == pytest.approx(c - a - b, abs=1e-12 * c)
    np.testing.assert_allclose(
        report["planar_moments"], [(b + c - a) / 2, (a + c - b) / 2, (a + b - c) / 2], atol=1e-12 * c
    )
    if name in {"h2o", "h2co", "c6h6_re", "c6h6_r0", "co2"}:  # matter in a plane
        assert abs(report["inertial_defect"]) < 1e-8 * c


def test_isotopologues_of_water(eight_molecules: Path) -> None:
    path = eight_molecules / "h2o.xyz"
    words = ("--isotopes", "D", "--isotopes", "18O", "--isotopes", "2=D", "--isotopes", "18O,3=D")
    report = json.loads(run("molecule", path, *words, "--format", "json")[1])
    names = [row["isotopes"] for row in report["isotopologues"]]
    assert names == ["as above", "1 16O, 2 2H", "1 18O, 2 1H", "1 16O, 1 2H, 1 1H", "1 18O, 1 1H, 1 2H"]
    x, z = 0.757207835, 0.586529739  # a symmetric bent molecule, by hand
    for row, hydrogen, oxygen in (
        (report["isotopologues"][0], "1H", "16O"),
        (report["isotopologues"][1], "2H", "16O"),
        (report["isotopologues"][2], "1H", "18O"),
    ):
        m, M = MASSES[hydrogen], MASSES[oxygen]
        across, along = 2 * m * x**2, 2 * m * M / (2 * m + M) * z**2
        moments = np.sort([across, along, across + along])
        np.testing.assert_allclose(row["principal_moments"], moments, rtol=1e-8)
        np.testing.assert_allclose(row["rotational_constants_MHz"], FACTOR / moments, rtol=2e-8)
        assert row["mass"] == pytest.approx(2 * m + M, rel=1e-8)
        assert row["top"] == "asymmetric"


def test_defect_and_planar_moments_of_particles(rng: np.random.Generator) -> None:
    """Their definitions as sums over particles on the principal axes."""
    masses, points = rng.uniform(1, 2, 8), rng.normal(size=(8, 3)) * [3, 2, 1]
    points = np.concatenate([points, points * [-1, 1, 1]])
    points = np.concatenate([points, points * [1, -1, 1]])
    points = np.concatenate([points, points * [1, 1, -1]])
    spread = np.tile(masses, 8) @ points**2
    order = np.argsort(-spread)
    moments = (spread.sum() - spread)[order]
    np.testing.assert_allclose(planar_moments(moments), spread[order], rtol=1e-12)
    assert inertial_defect(moments) == pytest.approx(-2 * spread.min(), rel=1e-12)
    with pytest.raises(ValueError, match=r"expected shape \(\.\.\., 3\)"):
        planar_moments([1.0, 2.0])
